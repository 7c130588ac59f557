/* Drives straight, turns, and drives in an arc. */
#include <math.h>
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PositionType position;

  VWDriveStraight(vw, 0.4, 0.2); /* m, m/s */
  VWDriveWait(vw);
  VWDriveTurn(vw, M_PI / 2, M_PI / 3); /* rad, rad/s */
  VWDriveWait(vw);
  VWDriveCurve(vw, 0.3, -M_PI / 2, 0.2); /* m, rad, m/s */
  VWDriveWait(vw);
  VWGetPosition(vw, &position);
  printf("x %.3f m, y %.3f m, heading %.3f rad\n", position.x, position.y, position.phi);
  VWRelease(vw);
  return 0;
}

/* Prints
 * x 0.591 m, y 0.191 m, heading 0.000 rad
 */
