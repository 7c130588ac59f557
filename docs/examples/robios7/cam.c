/* Takes a colour image and shows it. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  static QQVGAcol image;
  int middle = 3 * (110 * QQVGA_X + QQVGA_X / 2); /* row 110 of 120 */

  if (CAMInit(QQVGA) != 0)
    return 1;
  CAMGet(image);
  LCDImage(image);
  printf("%d bytes; the floor ahead: red %d\n", CAMSIZE, image[middle]);
  CAMRelease();
  return 0;
}

/* Prints
 * 57600 bytes; the floor ahead: red 173
 */
