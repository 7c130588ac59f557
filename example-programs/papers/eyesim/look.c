/* Section 8: takes an image and prints its number of different levels. */
#include <stdio.h>
#include "eyebot.h"

int main(void)
{
  static image picture;
  unsigned char seen[256] = { 0 };
  int levels = 0, x, y;

  CAMInit(NORMAL);
  CAMGetFrame(&picture);
  for (y = 0; y < imagerows; y++)
    for (x = 0; x < imagecolumns; x++) {
      levels += !seen[picture[y][x]];
      seen[picture[y][x]] = 1;
    }
  printf("%d\n", levels);
  return 0;
}
