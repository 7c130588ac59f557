/* Drives about forever and turns away from near obstacles: reads eight PSDs and sets the speed every 50 ms. */
#include "eyebot.h"

#define SENSORS 8
#define FAR_MM  2000
#define NEAR_MM 300
#define SPEED   0.3  /* m/s */
#define RATE    1.5  /* rad/s */
#define TICKS   5    /* of 10 ms in a period */

static const DeviceSemantics places[SENSORS] = {  /* from the left over the front to the right, then the back */
  PSD_LEFT, PSD_LEFTDIAG, PSD_FRONTLEFT, PSD_FRONT, PSD_FRONTRIGHT, PSD_RIGHTDIAG, PSD_RIGHT, PSD_BACK
};
static PSDHandle psd[SENSORS];
static int distance_mm[SENSORS];
static double turn;       /* rate of the turn in progress, 0 for none */
static unsigned periods;

static void read_sensors(void)
{
  int i;

  for (i = 0; i < SENSORS; i++) {
    distance_mm[i] = PSDGet(psd[i]);
    if (distance_mm[i] > FAR_MM)
      distance_mm[i] = FAR_MM;
  }
}

static int ahead_mm(void)
{
  int i, least = FAR_MM;

  for (i = 1; i <= 5; i++)
    if (distance_mm[i] < least)
      least = distance_mm[i];
  return least;
}

static double away(void)
{
  int left = distance_mm[0] + distance_mm[1] + distance_mm[2];
  int right = distance_mm[4] + distance_mm[5] + distance_mm[6];

  return left > right ? RATE : -RATE;
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle all = 0;
  int i;

  for (i = 0; i < SENSORS; i++)
    all |= psd[i] = PSDInit(places[i]);
  if (!vw || !all)
    return OSError("device missing", 0, TRUE);
  PSDStart(all, TRUE);
  for (;;) {
    read_sensors();
    if (ahead_mm() > 2 * NEAR_MM)
      turn = 0;
    else if (turn == 0 && ahead_mm() < NEAR_MM)
      turn = away();
    VWSetSpeed(vw, turn == 0 ? SPEED * ahead_mm() / FAR_MM : 0, turn == 0 ? 0.2 * away() : turn);
    periods++;
    OSWait(TICKS - OSGetCount() % TICKS);
  }
}
