/* Drives along a spline through waypoints: complete it. Arguments: the waypoints, X Y each, in mm. */
#include <stdlib.h>
#include "eyebot.h"

int main(int argc, char *argv[])
{
  int x, y, z, phi, i;

  SIMGetRobot(0, &x, &y, &z, &phi); /* true pose of the robot, read once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry gives the pose */
  for (i = 1; i + 1 < argc; i += 2)
    LCDPrintf("waypoint %d %d\n", atoi(argv[i]), atoi(argv[i + 1]));
  return 0;
}
