/* Drives until it bumps into something, backs off, turns away and continues; stops after a minute. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define SPEED   0.25  /* m/s */
#define RATE    1.5   /* rad/s */
#define SECONDS 60

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  BumpHandle left = BUMPInit(BUMP_LEFT), front = BUMPInit(BUMP_FRONT), right = BUMPInit(BUMP_RIGHT);
  int bumps = 0, stalls = 0, when;

  if (!vw || !left || !front || !right)
    return OSError("device missing", 1, TRUE);

  VWSetSpeed(vw, SPEED, 0);
  while (OSGetCount() < SECONDS * 100) {
    int is_left = BUMPCheck(left, &when) == 0;
    int is_front = BUMPCheck(front, &when) == 0;
    int is_right = BUMPCheck(right, &when) == 0;

    if (is_left || is_front || is_right) {
      /* Turn away from the side of the contact, by 60 to 120 degrees. */
      double angle = M_PI / 3 * (1.0 + (double)rand() / RAND_MAX);

      if (is_left || (!is_right && rand() % 2))
        angle = -angle;
      bumps++;
      stalls += VWStalled(vw) == 1;
      LCDSetPrintf(0, 0, "%d bumps", bumps);
      LCDSetPrintf(1, 0, "%d stalled", stalls);
      LCDSetPrintf(2, 0, "last at %d.%02d s", when / 100, when % 100);
      VWDriveStraight(vw, -0.1, SPEED);
      VWDriveWait(vw);
      VWDriveTurn(vw, angle, RATE);
      VWDriveWait(vw);
      VWSetSpeed(vw, SPEED, 0);
    }
    OSWait(2);
  }
  BUMPRelease(left | front | right);
  VWRelease(vw);
  return 0;
}
