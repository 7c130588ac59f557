/* A mistake: the robot never leaves a boundary, and goes around the first obstacle forever. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define POINTS     360
#define NEAR       260 /* distance of an obstacle ahead at which the robot starts to follow, mm */
#define KEEP       220 /* distance that the robot keeps from the boundary, mm */
#define HALF_WIDTH 120 /* half of the width that the robot needs, mm */
#define SPEED      200 /* mm/s */

static int scan[POINTS]; /* mm, from left to right, one a degree */

/* Scanned distance in a direction, in degrees to the left. */
static int distance_at(int direction)
{
  return scan[((POINTS / 2 - direction) % POINTS + POINTS) % POINTS];
}

/* Distance that the robot can drive in a direction, mm. */
static int free_distance(int direction)
{
  int at, room = 9999;
  for (at = -85; at <= 85; at++) {
    double distance = distance_at(direction + at), angle = at * M_PI / 180;
    if (fabs(distance * sin(angle)) < HALF_WIDTH && distance * cos(angle) < room)
      room = (int)(distance * cos(angle));
  }
  return room;
}

static int limited(double value, int limit)
{
  return (int)lround(value > limit ? limit : value < -limit ? -limit : value);
}

/* Drives with the boundary at the left: its nearest point is kept at 90 degrees, at the distance KEEP. */
static void follow(void)
{
  int at, direction = 90, distance = 9999;
  for (at = -45; at <= 170; at++)
    if (distance_at(at) < distance) {
      distance = distance_at(at);
      direction = at;
    }
  double off = direction - 90;
  int speed = limited(SPEED * (1 - fabs(off) / 45), SPEED);
  VWSetSpeed(speed > 0 ? speed : 0, limited(2.5 * off + 0.4 * (distance - KEEP), 90));
}

int main(int argc, char *argv[])
{
  int goal_x = atoi(argv[1]), goal_y = atoi(argv[2]);
  int x, y, z, phi, is_following = 0;
  double to_goal;

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  LIDARSet(360, 0, POINTS);
  for (;;) {
    int turn;
    LIDARGet(scan);
    VWGetPosition(&x, &y, &phi);
    to_goal = hypot(goal_x - x, goal_y - y);
    if (to_goal < 20)
      break;
    turn = (int)lround(remainder(atan2(goal_y - y, goal_x - x) * 180 / M_PI - phi, 360));
    if (!is_following && abs(turn) <= 20 && free_distance(0) < NEAR && free_distance(0) < to_goal)
      is_following = 1;
    if (is_following)
      follow();
    else if (abs(turn) > 20)
      VWSetSpeed(0, limited(3.0 * turn, 90));
    else
      VWSetSpeed(to_goal < 200 ? (int)to_goal / 2 + 20 : SPEED, limited(2.0 * turn, 60));
    OSWait(20);
  }
  VWSetSpeed(0, 0);
  return 0;
}
