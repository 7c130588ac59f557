/* Takes a grey and a colour image. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  image grey;
  colimage colour;

  if (CAMInit(NORMAL) >= INITERROR)
    return 1;
  CAMGetFrame(&grey);
  CAMGetColFrame(&colour, 0);
  printf("the floor ahead: grey %d, red %d\n", grey[55][40], colour[55][40][0]);
  CAMRelease();
  return 0;
}

/* Prints
 * the floor ahead: grey 168, red 173
 */
