/* Waits for a key under the display. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  LCDMenu("", "GO", "", "");
  KEYWait(KEY2);
  printf("go, after %d ms\n", OSGetCount() * 10);
  return 0;
}

/* Prints
 * go, after 1000 ms
 */
