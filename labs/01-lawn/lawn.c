/* Mows the lawn: complete it. */
#include "eyebot.h"

int main(void)
{
  int x, y, z, phi;

  SIMGetRobot(0, &x, &y, &z, &phi); /* the robot's place on the lawn: once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry tells it */
  VWStraight(100, 300);
  VWWait();
  return 0;
}
