/* Drives until the bumper touches the wall. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  BumpHandle front = BUMPInit(BUMP_FRONT);
  int time;

  VWSetSpeed(vw, 0.3, 0.0); /* m/s, rad/s */
  while (BUMPCheck(front, &time) != 0)
    OSWait(1);
  VWSetSpeed(vw, 0.0, 0.0);
  printf("touched after %d ms\n", time * 10);
  return 0;
}

/* Prints
 * touched after 4330 ms
 */
