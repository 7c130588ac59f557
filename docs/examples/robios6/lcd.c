/* Writes text, a menu and a frame to the display. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int row, column;

  LCDClear();
  LCDPrintf("Hello\n");
  LCDSetPrintf(2, 4, "%d mm", 120);
  LCDGetPos(&row, &column);
  LCDMenu("GO", "", "", "END");
  LCDLine(0, 40, 127, 40, 1);
  printf("cursor in row %d, column %d; pixel %d\n", row, column, LCDGetPixel(40, 64));
  return 0;
}

/* Prints
 * cursor in row 2, column 10; pixel 1
 */
