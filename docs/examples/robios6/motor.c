/* Drives for a second with both motors at a tenth of their speed. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  MotorHandle left = MOTORInit(MOTOR_LEFT), right = MOTORInit(MOTOR_RIGHT);

  MOTORDrive(left | right, 10);
  OSWait(100);
  printf("released: %d\n", MOTORRelease(left | right));
  return 0;
}

/* Prints
 * released: 0
 */
