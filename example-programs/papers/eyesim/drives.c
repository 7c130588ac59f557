/* Section 2: drives by the v-omega interface. Prints kind, length in m and angle in rad of each drive when it has ended. */
#include <math.h>
#include <stdio.h>
#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  int i;

  VWStartControl(vw, 7.0, 0.3, 7.0, 0.1);
  for (i = 0; i < 12; i++) {
    float length = 0.25 + 0.11 * i, angle = (i % 2 ? -1 : 1) * (0.3 + 0.21 * i); /* as RoBIOS takes them */
    switch (i % 3) {
    case 0: VWDriveStraight(vw, length, 0.4); angle = 0; break;
    case 1: VWDriveTurn(vw, angle, 1.5); length = 0; break;
    default: VWDriveCurve(vw, length, angle, 0.3);
    }
    VWDriveWait(vw);
    OSWait(20);
    printf("%.17g %.17g\n", length, angle);
  }
  return 0;
}
