/* A mistake: the distance between lanes is larger than the mower's width, so strips of grass remain. */
#include <math.h>
#include "eyebot.h"

#define EDGE 300  /* distance of the outermost lanes from the fence, mm */
#define LANE 350  /* distance between lanes */
#define PIECES 2  /* number of parts of a lane */
#define SPEED 300 /* mm/s */

/* Turns to a point of the lawn and drives there. */
static void drive_to(double to_x, double to_y)
{
  int x, y, phi;
  VWGetPosition(&x, &y, &phi);
  VWTurn((int)lround(remainder(atan2(to_y - y, to_x - x) * 180 / M_PI - phi, 360)), 90);
  VWWait();
  VWStraight((int)lround(hypot(to_x - x, to_y - y)), SPEED);
  VWWait();
}

int main(void)
{
  int x, y, z, phi, is_left = 1;

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  drive_to(EDGE, EDGE);
  for (y = EDGE; y <= 2000 - EDGE; y += LANE) {
    double from = is_left ? EDGE : 3000 - EDGE, to = 3000 - from;
    int piece;
    for (piece = 0; piece <= PIECES; piece++) /* part 0 leads from lane to lane */
      drive_to(from + (to - from) * piece / PIECES, y);
    is_left = !is_left;
  }
  return 0;
}
