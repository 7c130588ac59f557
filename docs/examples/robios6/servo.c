/* Turns the camera to the left and back. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  ServoHandle pan = SERVOInit(SERVO1);

  printf("left: %d\n", SERVOSet(pan, 255));
  printf("too far: %d\n", SERVOSet(pan, 256));
  SERVOSet(pan, 128);
  SERVORelease(pan);
  return 0;
}

/* Prints
 * left: 0
 * too far: -1
 */
