/* A mistake: the program moves the robot with a function of the simulator, which a real robot does not have. */
#include "eyebot.h"

int main(void)
{
  SIMSetRobot(0, 1980, 1980, 0, 0);
  OSWait(100);
  SIMSetRobot(0, 180, 180, 0, 90);
  OSWait(100);
  SIMSetRobot(0, 1980, 1980, 0, 0);
  OSWait(100);
  return 0;
}
