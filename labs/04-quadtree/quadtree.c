/* Plans with a quadtree and drives to the goal: complete it. Arguments: the goal, then the pillars, X Y each, in mm. */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

int main(int argc, char *argv[])
{
  int x, y, z, phi, i;

  SIMGetRobot(0, &x, &y, &z, &phi); /* true pose of the robot, read once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry gives the pose */
  LCDPrintf("goal %d %d\n", atoi(argv[1]), atoi(argv[2]));
  for (i = 3; i + 1 < argc; i += 2)
    LCDPrintf("pillar %d %d\n", atoi(argv[i]), atoi(argv[i + 1]));
  return 0;
}
