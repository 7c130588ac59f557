/* Moves this robot to another place and reads its true pose. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int x, y, z, phi;

  SIMGetRobot(0, &x, &y, &z, &phi);
  SIMSetRobot(0, x + 200, y, z, 90);
  OSWait(100);
  SIMGetRobot(0, &x, &y, &z, &phi);
  printf("%d robots, %d object; x %d mm, heading %d degrees\n", SIMGetRobotCount(), SIMGetObjectCount(), x, phi);
  return 0;
}

/* Prints
 * 23 robots, 1 object; x 6800 mm, heading 90 degrees
 */
