/* Measures the distances ahead and to the left. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  printf("front %d mm, left %d mm\n", PSDGet(PSD_FRONT), PSDGet(PSD_LEFT));
  return 0;
}

/* Prints
 * front 1300 mm, left 900 mm
 */
