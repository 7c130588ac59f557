/* DistBug: complete it. Arguments: the goal, X Y in mm. */
#include <stdlib.h>
#include "eyebot.h"

int main(int argc, char *argv[])
{
  int x, y, z, phi, scan[360];

  SIMGetRobot(0, &x, &y, &z, &phi); /* true pose of the robot, read once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry gives the pose */
  LIDARGet(scan);                   /* from left to right; scan[180] is ahead */
  LCDPrintf("goal %d %d, free ahead %d mm\n", atoi(argv[1]), atoi(argv[2]), scan[180]);
  return 0;
}
