/* A mistake: the robot drives straight lines between the waypoints and turns on the spot at each. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

int main(int argc, char *argv[])
{
  int x, y, z, phi, i;

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  for (i = 1; i + 1 < argc; i += 2) {
    double to_x = atof(argv[i]), to_y = atof(argv[i + 1]), distance = 0;
    do {
      VWGetPosition(&x, &y, &phi);
      distance = hypot(to_x - x, to_y - y);
      VWTurn((int)lround(remainder(atan2(to_y - y, to_x - x) * 180 / M_PI - phi, 360)), 90);
      VWWait();
      VWStraight((int)lround(fmin(distance, 500)), 300);
      VWWait();
    } while (distance > 500);
  }
  return 0;
}
