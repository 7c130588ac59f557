/* Drives a square of 0.4 m and comes back to its start. */
#include <math.h>
#include "eyebot.h"

#define SIDE  0.4  /* m */
#define SPEED 0.2  /* m/s */
#define RATE  1.0  /* rad/s */

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PositionType position;
  int corner;

  if (!vw)
    return OSError("no drive", 1, TRUE);

  for (corner = 1; corner <= 4; corner++) {
    VWDriveStraight(vw, SIDE, SPEED);
    VWDriveWait(vw);
    VWDriveTurn(vw, M_PI / 2, RATE);
    VWDriveWait(vw);
    VWGetPosition(vw, &position);
    LCDPrintf("%d: %.3f %.3f\n", corner, position.x, position.y);
  }
  VWRelease(vw);
  return 0;
}
