/* Plays a tone to its end. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  AUTone(440, 300); /* Hz, ms */
  while (!AUCheckTone())
    OSWait(1);
  printf("silence after %d ms\n", OSGetCount() * 10);
  return 0;
}

/* Prints
 * silence after 300 ms
 */
