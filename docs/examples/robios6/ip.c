/* Finds edges in a camera image. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  image grey, edges;
  int row, column, count = 0;

  CAMInit(NORMAL);
  CAMGetFrame(&grey);
  IPSobel(&grey, &edges);
  for (row = 1; row < imagerows - 1; row++)
    for (column = 1; column < imagecolumns - 1; column++)
      if (edges[row][column] > 100)
        count++;
  printf("%d edge pixels\n", count);
  return 0;
}

/* Prints
 * 588 edge pixels
 */
