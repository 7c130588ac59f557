/* Measures with the wheel encoders how far the robot drives. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  QuadHandle left = QUADInit(QUAD_LEFT);
  VWHandle vw = VWInit(VW_DRIVE, 1);

  VWDriveStraight(vw, 0.3, 0.2); /* m, m/s */
  VWDriveWait(vw);
  printf("%d counts, %.3f m\n", QUADRead(left), QUADODORead(left));
  return 0;
}

/* Prints
 * 1591 counts, 0.300 m
 */
