/* Writes text in colour, a menu and a circle to the display. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int width, height, row, column;

  LCDGetSize(&width, &height);
  LCDSetColor(YELLOW, BLACK);
  LCDPrintf("Hello\n");
  LCDSetPrintf(2, 4, "%d mm", 120);
  LCDGetPos(&row, &column);
  LCDMenu("GO", "", "", "END");
  LCDCircle(width / 2, height / 2, 30, RED, 1);
  printf("%d x %d pixels, cursor in row %d, column %d\n", width, height, row, column);
  printf("middle 0x%06X\n", LCDGetPixel(width / 2, height / 2));
  return 0;
}

/* Prints
 * 480 x 320 pixels, cursor in row 2, column 10
 * middle 0xFF0000
 */
