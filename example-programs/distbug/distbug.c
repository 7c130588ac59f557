/* DistBug: drives towards a goal; at an obstacle, follows its boundary until the free way towards the goal is long enough to bring the
 * robot nearer to the goal than ever before. Source of the method: Kamon and Rivlin, 1997.
 *
 * The goal is given in mm from the start, ahead and to the left: distbug 3000 0 */
#include <math.h>
#include <stdlib.h>

#include "eyebot.h"

#define POINTS 360
#define NEAR 260        /* distance of an obstacle ahead at which the robot starts to follow, mm */
#define KEEP 220        /* distance of the scanner from the boundary, mm */
#define STEP 100        /* gain on the best distance to the goal so far for which the robot leaves the boundary, mm */
#define HALF_WIDTH 120  /* half width of the corridor that the robot needs, mm */
#define SPEED 200       /* mm/s */

static int scan[POINTS]; /* mm, from left to right; one a degree */

/* Scanned distance in a direction, in degrees to the left. */
static int distance_at(int direction)
{
  return scan[((POINTS / 2 - direction) % POINTS + POINTS) % POINTS];
}

/* Returns the shortest scanned distance in the directions from `right` to `left`, and sets its direction. */
static int nearest(int right, int left, int *direction)
{
  int at, best = 99999;
  for (at = right; at <= left; at++)
    if (distance_at(at) < best) {
      best = distance_at(at);
      *direction = at;
    }
  return best;
}

/* Distance that the robot can drive in a direction. */
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
  int direction = 90, distance = nearest(-45, 170, &direction);
  double off = direction - 90;
  int turn = limited(2.5 * off + 0.4 * (distance - KEEP), 90);
  int speed = limited(SPEED * (1 - fabs(off) / 45), SPEED);
  VWSetSpeed(speed > 0 ? speed : 0, turn);
}

int main(int argc, char *argv[])
{
  int goal_x = argc > 1 ? atoi(argv[1]) : 3200, goal_y = argc > 2 ? atoi(argv[2]) : 0;
  int is_following = 0, has_left_hit = 0, x, y, phi, hit_x = 0, hit_y = 0, hits = 0;
  double to_goal, nearest_yet = 1e9;

  LCDPrintf("goal %d %d\n", goal_x, goal_y);
  LIDARSet(360, 0, POINTS);
  for (;;) {
    int turn, room;
    LIDARGet(scan);
    VWGetPosition(&x, &y, &phi);
    to_goal = hypot(goal_x - x, goal_y - y);
    if (to_goal < 20)
      break;
    if (to_goal < nearest_yet)
      nearest_yet = to_goal;
    turn = (int)lround(remainder(atan2(goal_y - y, goal_x - x) * 180 / M_PI - phi, 360));

    if (!is_following) {
      room = free_distance(0);
      if (abs(turn) > 20) {
        VWSetSpeed(0, limited(3.0 * turn, 90));
      } else if (room < NEAR && room < to_goal) {
        is_following = 1;
        has_left_hit = 0;
        hit_x = x;
        hit_y = y;
        LCDPrintf("hit %d: %d mm left\n", ++hits, (int)to_goal);
      } else {
        VWSetSpeed(to_goal < 200 ? (int)to_goal / 2 + 20 : SPEED, limited(2.0 * turn, 60));
      }
    }
    if (is_following) {
      double from_hit = hypot(x - hit_x, y - hit_y);
      has_left_hit |= from_hit > 300;
      if (has_left_hit && from_hit < 120) {
        LCDPrintf("no way\n");
        VWSetSpeed(0, 0);
        return 1;
      }
      /* It leaves only if it will get nearer to the goal than ever before, so it cannot go around in circles. */
      room = free_distance(turn);
      if (room > NEAR && (to_goal - (room - NEAR) <= nearest_yet - STEP || room >= to_goal) && from_hit > 100) {
        is_following = 0;
        LCDPrintf("leave: %d mm left\n", (int)to_goal);
      } else {
        follow();
      }
    }
    OSWait(20);
  }
  VWSetSpeed(0, 0);
  LCDPrintf("goal after %d hits\n", hits);
  return 0;
}
