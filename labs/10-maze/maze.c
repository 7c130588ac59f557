/* Finds a path through the maze: complete it. */
#include "eyebot.h"

#define CELL 360 /* mm */

int main(void)
{
  VWSetPosition(CELL / 2, CELL / 2, 90); /* the start: in the lower left cell, looking up */
  LCDPrintf("front %d, left %d, right %d mm\n", PSDGet(PSD_FRONT), PSDGet(PSD_LEFT), PSDGet(PSD_RIGHT));
  return 0;
}
