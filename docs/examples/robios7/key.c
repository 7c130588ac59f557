/* Waits for a key, then for a touch of the display. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int x, y;

  LCDMenu("", "GO", "", "");
  KEYWait(KEY2);
  printf("go, after %d ms\n", OSGetCount());
  KEYGetXY(&x, &y);
  printf("touched at %d, %d\n", x, y);
  return 0;
}

/* Prints
 * go, after 1000 ms
 * touched at 120, 40
 */
