/* Drives to 300 mm before the wall, turns left, and leaves in an arc. RoBIOS-7: millimetres, degrees, numbers. */
#include "eyebot.h"

int main(void)
{
  int distance, x, y, phi;

  distance = PSDGet(PSD_FRONT);
  LCDPrintf("wall: %d mm\n", distance);

  VWStraight(distance - 300, 200);
  VWWait();
  VWTurn(90, 60);
  VWWait();
  VWCurve(400, -90, 200);
  VWWait();

  VWGetPosition(&x, &y, &phi);
  LCDPrintf("x %d y %d", x, y);
  return 0;
}
