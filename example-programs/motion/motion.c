/* Watches a place and reports when something moves there, and where in the image, by the difference of two successive images.
   Ends with key 4 or after 25 s; an argument sets other seconds: motion 60 */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define DIFFERENCE 30 /* between grey levels; noise makes smaller ones */
#define PIXELS     4  /* minimum number of differing pixels */
#define QUIET      100 /* 1/100 s without motion, after which motion is reported again */

static image frames[2], differences;

/* Counts the pixels that differ and finds their centre. Noise changes single pixels, so only pairs count. */
static int moving(int *x, int *y)
{
  int row, column, count = 0, sum_x = 0, sum_y = 0;

  for (row = 1; row < imagerows - 1; row++)
    for (column = 1; column < imagecolumns - 2; column++)
      if (differences[row][column] > DIFFERENCE && differences[row][column + 1] > DIFFERENCE) {
        count++;
        sum_x += column;
        sum_y += row;
      }
  if (count > 0) {
    *x = sum_x / count;
    *y = sum_y / count;
  }
  return count;
}

/* Shows the image without its border, with a cross on the moving object. */
static void show(image *frame, int is_moving, int x, int y)
{
  LCDPutGraphic(frame);
  if (is_moving) {
    LCDLine(x - 1, 0, x - 1, 53, 2);
    LCDLine(0, y - 1, imagecolumns - 3, y - 1, 2);
  }
}

int main(int argc, char *argv[])
{
  int end = 100 * (argc > 1 ? atoi(argv[1]) : 25), last_motion = -QUIET, times = 0, current = 0, version = CAMInit(NORMAL);

  if (version >= INITERROR)
    return OSError("no camera", version, TRUE);
  LCDMenu("", "", "", "END");
  CAMGetFrame(&frames[1]);
  while (KEYRead() != KEY4 && OSGetCount() < end) {
    int x = 0, y = 0, is_moving;

    CAMGetFrame(&frames[current]);
    IPDiffer(&frames[current], &frames[!current], &differences);
    is_moving = moving(&x, &y) >= PIXELS;
    show(&frames[current], is_moving, x, y);
    LCDSetPrintf(0, 11, is_moving ? "%2d %2d" : "     ", x, y);
    if (is_moving && OSGetCount() - last_motion >= QUIET) {
      printf("motion at %.2f s, column %d, row %d\n", OSGetCount() / 100.0, x, y);
      LCDSetPrintf(2, 11, "n %d", ++times);
    }
    if (is_moving)
      last_motion = OSGetCount();
    current = !current;
  }
  CAMRelease();
  return 0;
}
