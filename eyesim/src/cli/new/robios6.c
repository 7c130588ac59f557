/* Drives to each of four walls and turns left before it. */
#include "eyebot.h"

#define NEAR_MM 300

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle front = PSDInit(PSD_FRONT);
  PositionType position;
  int wall;

  LCDPrintf("@NAME@\n");
  PSDStart(front, TRUE);
  OSWait(10); /* the first reading takes 60 ms */

  for (wall = 1; wall <= 4; wall++) {
    VWSetSpeed(vw, 0.3, 0.0);
    while (PSDGet(front) > NEAR_MM)
      OSWait(5);
    VWSetSpeed(vw, 0.0, 0.0);
    LCDPrintf("wall %d: %d mm\n", wall, PSDGet(front));

    VWDriveTurn(vw, 1.5708, 1.0);
    VWDriveWait(vw);
  }

  VWGetPosition(vw, &position);
  LCDPrintf("x %d y %d mm\n", (int)(position.x * 1000), (int)(position.y * 1000));
  PSDRelease();
  VWRelease(vw);
  return 0;
}
