/* Mows the lawn: complete it. */
#include "eyebot.h"

int main(void)
{
  int x, y, z, phi;

  SIMGetRobot(0, &x, &y, &z, &phi); /* true pose of the robot on the lawn, read once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry gives the pose */
  VWStraight(100, 300);
  VWWait();
  return 0;
}
