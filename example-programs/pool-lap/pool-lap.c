/* Drives the submarine Mako one lap around a pool, along the wall at its right, then surfaces.
 *
 * The thrusters give forces, not speeds, and the hull coasts. So all control is proportional to an error and to its rate of change.
 * Two PSD sensors to the right, one behind the other, give the angle to the wall and the distance from it; one that points down gives
 * the height above the floor. At a corner Mako turns to the left until it lines up with the next wall. */
#include <math.h>
#include <stdlib.h>

#include "eyebot.h"

enum { LEFT = 1, FRONT, RIGHT, BACK };                           /* thrusters */
enum { PSD_AHEAD = 1, PSD_FRONT_RIGHT = 3, PSD_BACK_RIGHT = 5, PSD_BELOW = 6 };

#define STEP 100      /* ms between two readings */
#define BASE 800      /* between the sensors to the right, mm */
#define WALL 1500     /* distance to keep from the wall, mm */
#define HEIGHT 900    /* height to keep above the floor, mm */
#define CORNER 2500   /* distance of a wall ahead below which it is a corner, mm */
#define CLEAR 3500    /* minimum free distance ahead after a corner, mm */
#define CRUISE 40     /* thrust along a wall, percent */
#define TURN 25       /* thrust of a turn on the spot */

/* A quantity and its rate of change. */
typedef struct { double value, rate; } Signal;

static void update(Signal *signal, double value)
{
  signal->rate = (value - signal->value) * 1000 / STEP;
  signal->value = value;
}

static int limited(double percent, int max)
{
  return percent > max ? max : percent < -max ? -max : (int)percent;
}

static Signal height; /* m */

/* Sets the thrust that brings Mako to a height above the floor, in mm. */
static void hold_height(int target)
{
  update(&height, PSDGet(PSD_BELOW) / 1000.0);
  int up = limited(60 * (target / 1000.0 - height.value) - 85 * height.rate, 100);
  MOTORDrive(FRONT, up);
  MOTORDrive(BACK, up);
}

static void thrust(int ahead, int to_left)
{
  MOTORDrive(LEFT, ahead - to_left);
  MOTORDrive(RIGHT, ahead + to_left);
}

/* Follows the wall at the right until a wall ahead is nearer than `until` mm. */
static void follow_wall(int until)
{
  Signal angle = {0, 0}; /* between wall and heading, rad to the left */
  int is_first = 1;
  while (PSDGet(PSD_AHEAD) > until) {
    int front = PSDGet(PSD_FRONT_RIGHT), back = PSDGet(PSD_BACK_RIGHT);
    update(&angle, atan2(front - back, BASE));
    if (is_first) {
      angle.rate = is_first = 0;
    }
    double distance = (front + back) / 2 * cos(angle.value);
    double wanted = limited((WALL - distance) / 20, 30) * M_PI / 180;
    thrust(CRUISE, limited(135 * (wanted - angle.value) - 150 * angle.rate, 30));
    hold_height(HEIGHT);
    OSWait(STEP);
  }
}

/* Returns 1 if Mako would approach the right wall by driving ahead. */
static int nears_wall(void)
{
  return PSDGet(PSD_FRONT_RIGHT) < PSDGet(PSD_BACK_RIGHT);
}

static void step_left(void)
{
  thrust(0, TURN);
  hold_height(HEIGHT);
  OSWait(STEP);
}

/* Turns to the left on the spot until the wall that was ahead is at the right, parallel to Mako. */
static void turn_left(void)
{
  while (PSDGet(PSD_AHEAD) < CLEAR || !nears_wall()) {
    step_left();
  }
  while (nears_wall()) {
    step_left();
  }
}

int main()
{
  int x, y, z, phi, corner, i;
  int start = PSDGet(PSD_AHEAD);
  height.value = PSDGet(PSD_BELOW) / 1000.0;
  for (i = 0; i < 100 && abs(PSDGet(PSD_BELOW) - HEIGHT) > 50; i++) {
    hold_height(HEIGHT);
    OSWait(STEP);
  }
  LCDPrintf("dived to %d mm\n", PSDGet(PSD_BELOW));
  for (corner = 1; corner <= 4; corner++) {
    follow_wall(CORNER);
    LCDPrintf("corner %d\n", corner);
    turn_left();
  }
  follow_wall(start);
  thrust(0, 0);
  for (i = 0; i < 100; i++) {
    hold_height(9999);
    OSWait(STEP);
  }
  for (i = LEFT; i <= BACK; i++) {
    MOTORDrive(i, 0);
  }
  SIMGetRobot(0, &x, &y, &z, &phi);
  LCDPrintf("lap done: %d %d %d\n", x, y, z);
  return 0;
}
