/* Looks at a place and tells when something moves there, and where in the image: what differs between two images, one after
   the other. Ends with key 4, or after 25 s; others may be given: motion 60 */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define DIFFERENCE 30 /* between grey levels; noise makes smaller ones */
#define PIXELS     4  /* that have to differ */
#define QUIET      100 /* hundredths of a second without motion, after which it is told anew */

static image frames[2], differences;

/* How many pixels differ, and around which one. Noise makes single pixels that differ, so they count in pairs alone. */
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

/* The image, and around what moves a cross. */
static void show(image *frame, int is_moving, int x, int y)
{
  LCDPutGraphic(frame);
  if (is_moving) {
    LCDLine(x, 0, x, 53, 2);
    LCDLine(0, y, imagecolumns - 1, y, 2);
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
