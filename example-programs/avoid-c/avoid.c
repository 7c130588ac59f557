/* Drives about at random for a minute and turns away from what comes near. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define NEAR_MM   200
#define SPEED     0.3  /* m/s */
#define RATE      2.0  /* rad/s */
#define SECONDS   60

static PSDHandle front, left, right;

static int is_near(PSDHandle psd)
{
  return PSDGet(psd) < NEAR_MM;
}

/* An angle between a quarter and half a turn, to the side with more room. */
static double angle_away(void)
{
  double angle = M_PI / 4 * (1.0 + 3.0 * rand() / RAND_MAX);
  return PSDGet(left) < PSDGet(right) ? -angle : angle;
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  int turns = 0;

  front = PSDInit(PSD_FRONT);
  left = PSDInit(PSD_FRONTLEFT);
  right = PSDInit(PSD_FRONTRIGHT);
  if (!vw || !front || !left || !right)
    return OSError("device missing", 1, TRUE);
  PSDStart(front | left | right, TRUE);
  while (!PSDCheck())  /* the first values take 60 ms */
    OSWait(1);

  while (OSGetCount() < SECONDS * 100) {
    if (is_near(front) || is_near(left) || is_near(right)) {
      VWDriveTurn(vw, angle_away(), RATE);
      VWDriveWait(vw);
      OSWait(6);  /* what the sensors show now is seen from here */
      LCDSetPrintf(0, 0, "%d turns", ++turns);
    } else {
      VWSetSpeed(vw, SPEED, 0);
      OSWait(5);
    }
  }
  PSDRelease();
  VWRelease(vw);
  return 0;
}
