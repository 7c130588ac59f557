/* Turns the camera to the left and back. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  printf("left: %d\n", SERVOSet(1, 255));
  printf("too far: %d\n", SERVOSet(1, 256));
  SERVOSet(1, 128);
  return 0;
}

/* Prints
 * left: 0
 * too far: 1
 */
