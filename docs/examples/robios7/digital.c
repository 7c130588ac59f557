/* Reads an input line and sets an output line. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  DIGITALSetup(1, 'i');
  DIGITALSetup(2, 'o');
  DIGITALWrite(2, 1);
  printf("line 1: %d, all lines: %d\n", DIGITALRead(1), DIGITALReadAll());
  return 0;
}

/* Prints
 * line 1: 1, all lines: 3
 */
