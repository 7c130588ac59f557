/* Section 5: prints the numbers of black, white and all pixels of 200 grey images, without the images' borders. */
#include <stdio.h>
#include "eyebot.h"

int main(void)
{
  static image picture;
  int black = 0, white = 0, all = 0, i, x, y;

  CAMInit(NORMAL);
  for (i = 0; i < 200; i++) {
    CAMGetFrame(&picture);
    for (y = 1; y < imagerows - 1; y++)
      for (x = 1; x < imagecolumns - 1; x++) {
        black += picture[y][x] == 0;
        white += picture[y][x] == 255;
        all++;
      }
  }
  printf("%d %d %d\n", black, white, all);
  return 0;
}
