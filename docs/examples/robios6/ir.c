/* Drives until the infrared switch sees the wall. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  IRHandle front = IRInit(IR_FRONT);
  PositionType position;

  VWSetSpeed(vw, 0.3, 0.0); /* m/s, rad/s */
  while (IRRead(front) == 0)
    OSWait(1);
  VWSetSpeed(vw, 0.0, 0.0);
  VWGetPosition(vw, &position);
  printf("near a wall after %.2f m\n", position.x);
  return 0;
}

/* Prints
 * near a wall after 1.15 m
 */
