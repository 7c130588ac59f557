/* Finds edges in a camera image. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  static QQVGAgray gray, edges;
  int pixel, count = 0;

  CAMInit(QQVGA);
  CAMGetGray(gray);
  IPSobel(gray, edges);
  for (pixel = 0; pixel < QQVGA_PIXELS; pixel++)
    if (edges[pixel] > 100)
      count++;
  printf("%d edge pixels\n", count);
  return 0;
}

/* Prints
 * 632 edge pixels
 */
