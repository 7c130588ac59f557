/* A convoy. Robot 1 drives a figure of eight and half a circle; every other robot follows the trail of the robot with the next lower
   number. Each robot broadcasts its position ten times a second, and ends when the robot ahead has been silent for two seconds.
   Arguments: the start pose, in mm and degrees, so that all robots share one frame. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define RADIUS    0.8    /* m, radius of each half of the eight */
#define SPEED     0.2    /* m/s */
#define GAP       0.35   /* m, to the robot ahead, along its trail */
#define AHEAD     0.12   /* m, to the target point on the trail */
#define GAIN      1.5    /* 1/s, from the error of the gap in m to m/s */
#define FASTEST   0.35   /* m/s */
#define PERIOD    10     /* 1/100 s */
#define SILENCE   200    /* 1/100 s without a message after which the robot ahead counts as ended */
#define POINTS    1024   /* a power of 2 */
#define LENGTH    4      /* bytes of a message: x and y in mm, two bytes each, the lower one first */

static VWHandle vw;
static double trail_x[POINTS], trail_y[POINTS];  /* trail of the robot ahead, from first to end */
static unsigned first, end;

static void broadcast_pose(void)
{
  PositionType at;
  int x, y;
  BYTE message[LENGTH];

  VWGetPosition(vw, &at);
  x = (int)lround(1000 * at.x);
  y = (int)lround(1000 * at.y);
  message[0] = x;
  message[1] = x >> 8;
  message[2] = y;
  message[3] = y >> 8;
  RADIOSend(BROADCAST, LENGTH, message);
}

static void lead(void)
{
  static const double angles[] = { 2 * M_PI, -2 * M_PI, M_PI };
  int i;

  for (i = 0; i < 3; i++) {
    VWDriveCurve(vw, fabs(angles[i]) * RADIUS, angles[i], SPEED);
    while (!VWDriveDone(vw)) {
      broadcast_pose();
      OSWait(PERIOD);
    }
  }
}

/* Adds the positions received from robot `leader` to the trail. Returns TRUE if there were any. */
static int listen(int leader)
{
  BYTE sender, message[MAXMSGLEN];
  int length, heard = FALSE;

  while (RADIOCheck() > 0)
    if (RADIORecv(&sender, &length, message) == 0 && sender == leader && length == LENGTH) {
      trail_x[end % POINTS] = (short)(message[0] | message[1] << 8) / 1000.0;
      trail_y[end % POINTS] = (short)(message[2] | message[3] << 8) / 1000.0;
      end++;
      heard = TRUE;
    }
  return heard;
}

/* Steers along the trail: faster if more of the trail lies ahead. */
static void steer(void)
{
  PositionType at;
  double x, y, distance, trail_length, speed, angle;
  unsigned i;

  VWGetPosition(vw, &at);
  for (;; first++) {
    if (first == end)
      return;
    x = trail_x[first % POINTS] - at.x;
    y = trail_y[first % POINTS] - at.y;
    distance = hypot(x, y);
    if (distance > AHEAD)
      break;
  }
  trail_length = distance;
  for (i = first + 1; i < end; i++)
    trail_length += hypot(trail_x[i % POINTS] - trail_x[(i - 1) % POINTS], trail_y[i % POINTS] - trail_y[(i - 1) % POINTS]);
  speed = fmin(fmax(GAIN * (trail_length - GAP), 0), FASTEST);
  angle = remainder(atan2(y, x) - at.phi, 2 * M_PI);
  VWSetSpeed(vw, speed, speed * 2 * sin(angle) / distance);  /* an arc through the target point */
}

static void follow(int leader)
{
  int last = OSGetCount() + 1000;

  while (OSGetCount() < last + SILENCE) {
    if (listen(leader))
      last = OSGetCount();
    steer();
    broadcast_pose();
    OSWait(PERIOD);
  }
}

int main(int argc, char *argv[])
{
  int me = OSMachineID();

  vw = VWInit(VW_DRIVE, 1);
  if (!vw || argc < 4 || RADIOInit() != 0)
    return OSError("convoy", argc, TRUE);
  VWSetPosition(vw, atof(argv[1]) / 1000, atof(argv[2]) / 1000, atof(argv[3]) * M_PI / 180);
  if (me == 1)
    lead();
  else
    follow(me - 1);
  VWSetSpeed(vw, 0, 0);
  RADIOTerm();
  return 0;
}
