/* Measures the distances ahead and to the left. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  PSDHandle front = PSDInit(PSD_FRONT), left = PSDInit(PSD_LEFT);

  PSDStart(front | left, TRUE);
  while (!PSDCheck())
    OSWait(1);
  printf("front %d mm, left %d mm\n", PSDGet(front), PSDGet(left));
  PSDRelease();
  return 0;
}

/* Prints
 * front 1300 mm, left 900 mm
 */
