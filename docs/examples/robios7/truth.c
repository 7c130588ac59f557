/* Reads the true depth and the true label of the pixel in the middle. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  static QQVGAcol image;
  static float depth[QQVGA_PIXELS];
  static int label[QQVGA_PIXELS];
  int middle = 60 * QQVGA_X + QQVGA_X / 2;

  CAMInit(QQVGA);
  CAMGet(image);
  CAMGetDepth(depth);
  CAMGetLabels(label);
  printf("ahead: %s in %.0f mm\n", label[middle] == CAM_WALL ? "wall" : "no wall", depth[middle]);
  return 0;
}

/* Prints
 * ahead: wall in 1320 mm
 */
