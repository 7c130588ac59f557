/* Parks a car backwards between two others at its right.
 *
 * It drives along the row until the sensor at its right has passed a gap that is long enough, drives on to where the
 * manoeuvre begins, and turns in on two arcs of equal radius: backwards to the right, then backwards to the left. */
#include <math.h>
#include "eyebot.h"

#define SPEED   0.2   /* m/s */
#define FREE_MM 300   /* the sensor sees farther into a gap */
#define GAP     0.8   /* m, minimum length of a gap */
#define RADIUS  0.4   /* m, of the arcs */
#define SIDE    0.38  /* m, lateral displacement of the manoeuvre */
#define SENSOR  0.09  /* m, from the rear axle (the origin of odometry) ahead to the sensor */

static VWHandle vw;
static PSDHandle right;

/* Drives on until the sensor at the right sees a gap, or its end if `gap` is FALSE. Returns the place, in m along the row. */
static double find(int gap)
{
  PositionType position;

  while ((PSDGet(right) > FREE_MM) != gap)
    OSWait(1);
  VWGetPosition(vw, &position);
  return position.x + SENSOR;
}

int main(void)
{
  double begin, end, angle, length;
  PositionType position;

  vw = VWInit(VW_DRIVE, 1);
  right = PSDInit(PSD_RIGHT);
  if (!vw || !right)
    return OSError("device missing", 1, TRUE);
  PSDStart(right, TRUE);
  OSWait(10);

  VWSetSpeed(vw, SPEED, 0);
  find(FALSE);
  do {
    begin = find(TRUE);
    end = find(FALSE);
    LCDPrintf("gap of %.2f m\n", end - begin);
  } while (end - begin < GAP);

  /* Two arcs of this angle move it by SIDE to the right, and backwards by twice the radius times the sine. */
  angle = acos(1 - SIDE / (2 * RADIUS));
  length = 2 * RADIUS * sin(angle);
  VWGetPosition(vw, &position);
  VWDriveStraight(vw, (begin + end) / 2 - SENSOR + length - position.x, SPEED);
  VWDriveWait(vw);
  VWDriveCurve(vw, -RADIUS * angle, angle, SPEED);
  VWDriveWait(vw);
  VWDriveCurve(vw, -RADIUS * angle, -angle, SPEED);
  VWDriveWait(vw);
  LCDPrintf("parked\n");
  AUBeep();
  PSDRelease();
  VWRelease(vw);
  return 0;
}
