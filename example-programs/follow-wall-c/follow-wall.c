/* Follows the wall at its left for a minute.
 *
 * The diagonal sensor sees the wall a little ahead of the robot. Its reading depends on the distance and on the heading, so one factor
 * is enough to steer. */
#include "eyebot.h"

#define KEPT_MM  300   /* the distance that the diagonal sensor keeps */
#define LOST_MM  500   /* a farther wall is not the one being followed */
#define AHEAD_MM 250   /* the minimum distance to a wall ahead */
#define SPEED    0.2   /* m/s */
#define RATE     1.2   /* rad/s, maximum turn rate */
#define CORNER   0.55  /* rad/s, around a corner: at SPEED a circle of 0.36 m */
#define FACTOR   0.006 /* rad/s for a millimetre */

static double limit(double value, double max)
{
  return value > max ? max : value < -max ? -max : value;
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle front = PSDInit(PSD_FRONT), diagonal = PSDInit(PSD_LEFTDIAG);

  if (!vw || !front || !diagonal)
    return OSError("device missing", 1, TRUE);
  PSDStart(front | diagonal, TRUE);
  while (!PSDCheck())  /* the first values take 60 ms */
    OSWait(1);

  while (OSGetCount() < 60 * 100) {
    int wall = PSDGet(diagonal);

    if (PSDGet(front) < AHEAD_MM)
      VWSetSpeed(vw, 0, -RATE);      /* a wall ahead: turn away from it */
    else if (wall > LOST_MM)
      VWSetSpeed(vw, SPEED, CORNER); /* the wall ends: around its corner */
    else
      VWSetSpeed(vw, SPEED, limit(FACTOR * (wall - KEPT_MM), RATE));
    LCDSetPrintf(0, 0, "wall at %4d mm", wall);
    OSWait(5);
  }
  PSDRelease();
  VWRelease(vw);
  return 0;
}
