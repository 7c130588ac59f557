/* Section 5: drives 0.3 m ahead and back, again and again; prints a line when each drive has ended. */
#include <stdio.h>
#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  int i;

  for (i = 0; i < 400; i++) {
    VWDriveStraight(vw, i % 2 ? -0.3 : 0.3, 0.3);
    VWDriveWait(vw);
    OSWait(10);
    printf("%d\n", i);
  }
  return 0;
}
