/* Drives to 300 mm before the wall, turns left, and leaves in an arc. RoBIOS 6: metres, radians, handles. */
#include <math.h>

#include "eyebot.h"

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle front = PSDInit(PSD_FRONT);
  PositionType position;
  int distance;

  PSDStart(front, TRUE);
  OSWait(10); /* hundredths of a second; the first reading takes 60 ms */
  distance = PSDGet(front);
  LCDPrintf("wall: %d mm\n", distance);

  VWDriveStraight(vw, (distance - 300) / 1000.0, 0.2);
  VWDriveWait(vw);
  VWDriveTurn(vw, M_PI / 2, M_PI / 3);
  VWDriveWait(vw);
  VWDriveCurve(vw, 0.4, -M_PI / 2, 0.2);
  VWDriveWait(vw);

  VWGetPosition(vw, &position);
  LCDPrintf("x %.0f y %.0f", position.x * 1000, position.y * 1000);
  PSDRelease();
  VWRelease(vw);
  return 0;
}
