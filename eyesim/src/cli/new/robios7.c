/* Drives to each of four walls and turns left before it. */
#include "eyebot.h"

#define NEAR_MM 300

int main(void)
{
  int wall, x, y, phi;

  LCDMenu("", "", "", "END");
  LCDSetColor(GREEN, BLACK);
  LCDPrintf("@NAME@\n");

  for (wall = 1; wall <= 4; wall++) {
    VWSetSpeed(300, 0); /* mm/s, degrees/s */
    while (PSDGet(PSD_FRONT) > NEAR_MM)
      OSWait(50);
    VWSetSpeed(0, 0);
    LCDPrintf("wall %d: %d mm\n", wall, PSDGet(PSD_FRONT));

    VWTurn(90, 60);
    VWWait();
  }

  VWGetPosition(&x, &y, &phi);
  LCDPrintf("x %d y %d mm\n", x, y);
  return 0;
}
