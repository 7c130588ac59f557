/* Drives about at random for a minute and turns away from near obstacles. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define SENSORS 5
#define NEAR_MM 200
#define SPEED   0.3  /* m/s */
#define RATE    2.0  /* rad/s */
#define SECONDS 60

static const DeviceSemantics mounts[SENSORS] = {  /* from left to right */
  PSD_LEFTDIAG, PSD_FRONTLEFT, PSD_FRONT, PSD_FRONTRIGHT, PSD_RIGHTDIAG
};
static PSDHandle psd[SENSORS];

static int is_free(void)
{
  int i;

  for (i = 0; i < SENSORS; i++)
    if (PSDGet(psd[i]) < NEAR_MM)
      return FALSE;
  return TRUE;
}

/* Random angle between an eighth of a turn and half a turn, to the side with more room. */
static double angle_away(void)
{
  double angle = M_PI / 4 * (1.0 + 3.0 * rand() / RAND_MAX);

  return PSDGet(psd[0]) < PSDGet(psd[SENSORS - 1]) ? -angle : angle;
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle all = 0;
  int i, turns = 0;

  for (i = 0; i < SENSORS; i++) {
    psd[i] = PSDInit(mounts[i]);
    if (!vw || !psd[i])
      return OSError("device missing", i, TRUE);
    all |= psd[i];
  }
  PSDStart(all, TRUE);
  while (!PSDCheck())  /* the first values take 60 ms */
    OSWait(1);

  while (OSGetCount() < SECONDS * 100) {
    if (is_free()) {
      VWSetSpeed(vw, SPEED, 0);
      OSWait(5);
    } else {
      VWDriveTurn(vw, angle_away(), RATE);
      VWDriveWait(vw);
      OSWait(6);  /* one cycle of the sensors after the turn */
      LCDSetPrintf(0, 0, "%d turns", ++turns);
    }
  }
  PSDRelease();
  VWRelease(vw);
  return 0;
}
