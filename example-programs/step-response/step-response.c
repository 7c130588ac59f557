/* Measures the rise time of a robot's speed, without and with the controller of the driving interface. */
#include "eyebot.h"

#define SPEED 0.3  /* m/s */

static VWHandle vw;

/* Sets the speed from rest. Returns the rise time to 90 % of it, in 1/100 s. */
static int rise(void)
{
  SpeedType now;
  int begin;

  VWSetSpeed(vw, 0, 0);
  OSWait(200);
  begin = OSGetCount();
  VWSetSpeed(vw, SPEED, 0);
  do {
    OSWait(1);
    VWGetSpeed(vw, &now);
  } while (now.v < 0.9 * SPEED);
  return OSGetCount() - begin;
}

int main(void)
{
  PositionType position;

  vw = VWInit(VW_DRIVE, 1);
  if (!vw)
    return OSError("no drive", 1, TRUE);

  LCDPrintf("open loop %3d ms", 10 * rise());
  VWStartControl(vw, 7, 0.3, 10, 0.1);
  LCDPrintf("\ncontrol   %3d ms", 10 * rise());
  VWSetSpeed(vw, 0, 0);
  OSWait(200);

  VWSetPosition(vw, 0, 0, 0);
  VWDriveStraight(vw, 0.5, SPEED);  /* with the controller too, a drive ends at its target */
  VWDriveWait(vw);
  VWGetPosition(vw, &position);
  LCDPrintf("\nat %.3f m", position.x);
  VWStopControl(vw);
  VWRelease(vw);
  return 0;
}
