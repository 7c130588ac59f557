/* Walks for two seconds and reads a joint. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  float knee, height;

  LEGSetSpeed(100, 0, 0); /* mm/s forward */
  OSWait(200);
  LEGSetSpeed(0, 0, 0);
  LEGGetJoint(1, 4, &knee);
  LEGGetHeight(&height);
  printf("%d legs, knee %.1f degrees, body %.1f mm up\n", LEGCount(), knee, height);
  return 0;
}

/* Prints
 * 2 legs, knee 29.2 degrees, body 1.1 mm up
 */
