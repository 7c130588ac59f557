/* Waits, drives past, waits and drives back. */
#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);

  OSWait(300);
  VWDriveStraight(vw, 2.4, 0.3);
  VWDriveWait(vw);
  OSWait(300);
  VWDriveStraight(vw, -2.4, 0.3);
  VWDriveWait(vw);
  VWRelease(vw);
  return 0;
}
