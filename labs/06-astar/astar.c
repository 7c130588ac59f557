/* Finds a shortest path by A* and drives along it: complete it. Arguments: eight places, then the pillars, X Y each, in mm. */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define PLACES 8

int main(int argc, char *argv[])
{
  int x, y, z, phi, i;

  SIMGetRobot(0, &x, &y, &z, &phi); /* true pose of the robot, read once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry gives the pose */
  for (i = 0; 2 * i + 2 < argc; i++)
    LCDPrintf("%s at %s %s\n", i < PLACES ? "place" : "pillar", argv[2 * i + 1], argv[2 * i + 2]);
  return 0;
}
