/* Soccer: the striker (robot 1) drives behind the ball at the kick-off point, checks that the ball is there and kicks it into
   the opposite goal; the others keep their goals: they drive back and forth in front of them. */
#include <math.h>
#include "eyebot.h"

/* Metres in the field's frame, as in soccer.wld and soccer.sim. */
#define BALL_X   1.4
#define BALL_Y   0.7
#define GOAL_X   2.7
#define GOAL_Y   0.7
#define BEHIND   0.3    /* from the ball to the start of the run-up */
#define NEAR     0.2    /* length of the run-up, on which the ball is kicked */

#define SPEED    0.3
#define KICK     0.49
#define RATE     1.5
#define SECONDS  30

typedef struct { double x, y, phi; } Place;

/* Turns to the direction of a point and drives to it. */
static void go(VWHandle vw, Place *at, double x, double y, double speed)
{
  double direction = atan2(y - at->y, x - at->x);
  double angle = remainder(direction - at->phi, 2 * M_PI);

  VWDriveTurn(vw, angle, RATE);
  VWDriveWait(vw);
  VWDriveStraight(vw, hypot(x - at->x, y - at->y), speed);
  VWDriveWait(vw);
  at->x = x;
  at->y = y;
  at->phi = direction;
}

static int kick_off(VWHandle vw, PSDHandle front)
{
  Place at = { 0.7, 0.35, 0.0 };
  double to_goal = atan2(GOAL_Y - BALL_Y, GOAL_X - BALL_X);
  double angle;
  int distance;

  /* Drive behind the ball, as seen from the goal, and turn to the goal. */
  go(vw, &at, BALL_X - BEHIND * cos(to_goal), BALL_Y - BEHIND * sin(to_goal), SPEED);
  angle = remainder(to_goal - at.phi, 2 * M_PI);
  VWDriveTurn(vw, angle, RATE);
  VWDriveWait(vw);

  PSDStart(front, FALSE);
  while (!PSDCheck())
    OSWait(1);
  distance = PSDGet(front);
  LCDSetPrintf(0, 0, "ball at %d mm", distance);
  if (distance > (int)(1000 * BEHIND))
    return 1;                           /* no ball there */

  VWDriveStraight(vw, NEAR, KICK);
  VWDriveWait(vw);
  LCDSetPrintf(1, 0, "kick");
  VWDriveStraight(vw, -NEAR, SPEED);
  VWDriveWait(vw);
  return 0;
}

/* Drives back and forth in front of the goal, at right angles to the line to the other goal. */
static void keep_goal(VWHandle vw, int robot)
{
  double side = robot == 3 ? -1 : 1;

  VWDriveTurn(vw, side * M_PI / 2, RATE);
  VWDriveWait(vw);
  while (OSGetCount() < SECONDS * 100) {
    VWDriveStraight(vw, 0.15, 0.1);
    VWDriveWait(vw);
    VWDriveStraight(vw, -0.15, 0.1);
    VWDriveWait(vw);
  }
}

int main(void)
{
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle front = PSDInit(PSD_FRONT);
  int robot = OSMachineID(), result = 0;

  if (!vw || !front)
    return OSError("device missing", 1, TRUE);
  if (robot == 1)
    result = kick_off(vw, front);
  else
    keep_goal(vw, robot);
  PSDRelease();
  VWRelease(vw);
  return result;
}
