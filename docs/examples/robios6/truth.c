/* Compares the image with the true depth and the true label of a pixel. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  static float depth[60][80];
  static int label[60][80];
  image grey;

  CAMInit(NORMAL);
  CAMGetFrame(&grey);
  CAMGetDepth(&depth[0][0]);
  CAMGetLabels(&label[0][0]);
  printf("ahead: %s in %.0f mm\n", label[30][40] == CAM_WALL ? "wall" : "no wall", depth[30][40]);
  return 0;
}

/* Prints
 * ahead: wall in 1320 mm
 */
