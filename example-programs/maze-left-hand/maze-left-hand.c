/* Finds the middle of a maze of 7 x 7 cells with the left hand on the wall; another goal can be given: COLUMN ROW.
 *
 * The robot starts in the lower left cell and looks up. Directions are counted in quarter turns to the left from there:
 * 0 up, 1 left, 2 down, 3 right. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define CELL    0.36  /* side of a cell in m */
#define FREE_MM 280   /* walls of this cell are nearer, those of the next farther away */
#define SPEED   0.3   /* m/s */
#define RATE    2.0   /* rad/s */

static const int dx[4] = { 0, -1, 0, 1 };
static const int dy[4] = { 1, 0, -1, 0 };

static int is_free(PSDHandle psd)
{
  return PSDGet(psd) > FREE_MM;
}

int main(int argc, char *argv[])
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle front = PSDInit(PSD_FRONT), left = PSDInit(PSD_LEFT), right = PSDInit(PSD_RIGHT);
  int goal_x = argc > 2 ? atoi(argv[1]) : 3, goal_y = argc > 2 ? atoi(argv[2]) : 3;
  int x = 0, y = 0, direction = 0, cells = 0;

  if (!vw || !front || !left || !right)
    return OSError("device missing", 1, TRUE);
  PSDStart(front | left | right, TRUE);

  while (x != goal_x || y != goal_y) {
    int turns;

    OSWait(12);  /* two cycles of the sensors: one of them lies entirely within the stop */
    turns = is_free(left) ? 1 : is_free(front) ? 0 : is_free(right) ? -1 : 2;
    if (turns != 0) {
      VWDriveTurn(vw, turns * M_PI / 2, RATE);
      VWDriveWait(vw);
    }
    VWDriveStraight(vw, CELL, SPEED);
    VWDriveWait(vw);

    direction = (direction + turns + 4) % 4;
    x += dx[direction];
    y += dy[direction];
    LCDSetPrintf(0, 0, "cell %d %d ", x, y);
    cells++;
  }
  LCDSetPrintf(1, 0, "goal: %d cells", cells);
  AUBeep();
  PSDRelease();
  VWRelease(vw);
  return 0;
}
