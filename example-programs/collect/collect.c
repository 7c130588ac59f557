/* A swarm collects balls: each robot drives to the nearest ball outside the depot to which no other robot is nearer, picks it up,
 * and brings it to the depot. The simulation has no gripper: SIMSetObject moves a ball that a robot carries. */
#include <math.h>
#include <stdlib.h>

#include "eyebot.h"

#define DEPOT_X 400     /* mm; balls lie in rows from here */
#define DEPOT_Y 400
#define DEPOT 900       /* side of the depot, a square in the corner, mm */
#define REACH 160       /* reach of the gripper from the robot's centre, mm */
#define SPEED 300       /* mm/s */
#define CLEAR 320       /* distance from walls and other robots, mm */

typedef struct { int x, y, phi; } Pose;

static int scan[360];

static Pose robot_pose(int id)
{
  Pose pose = {0, 0, 0};
  int z;
  SIMGetRobot(id, &pose.x, &pose.y, &z, &pose.phi);
  return pose;
}

static Pose object_pose(int id)
{
  Pose pose = {0, 0, 0};
  int z;
  SIMGetObject(id, &pose.x, &pose.y, &z, &pose.phi);
  return pose;
}

static double distance(Pose a, Pose b)
{
  return hypot(a.x - b.x, a.y - b.y);
}

static int is_in_depot(Pose pose)
{
  return pose.x < DEPOT && pose.y < DEPOT;
}

/* Returns the nearest ball outside the depot to which no other robot is nearer (ties: the lower robot number); 0 if there is none. */
static int choose(void)
{
  int robots = SIMGetRobotCount(), balls = SIMGetObjectCount(), me = OSMachineID(), best = 0, ball, other;
  Pose own = robot_pose(0);
  for (ball = robots + 1; ball <= robots + balls; ball++) {
    Pose at = object_pose(ball);
    int is_mine = !is_in_depot(at);
    for (other = 1; other <= robots && is_mine; other++)
      is_mine = other == me || distance(robot_pose(other), at) > distance(own, at)
                || (distance(robot_pose(other), at) == distance(own, at) && other > me);
    if (is_mine && (best == 0 || distance(own, at) < distance(own, object_pose(best))))
      best = ball;
  }
  return best;
}

/* Returns the distance of the nearest obstacle ahead, by the laser scanner, and sets its direction. The target of the robot,
 * `target_distance` mm away at `goal` degrees, is no obstacle. */
static int obstacle(int goal, double target_distance, int *direction)
{
  int at, best = 9999;
  LIDARGet(scan);
  for (at = -70; at <= 70; at++)
    if (scan[180 - at] < best && (abs(at - goal) > 30 || scan[180 - at] < target_distance - 100)) {
      best = scan[180 - at];
      *direction = at;
    }
  return best;
}

/* Drives one step towards a place, clear of walls and other robots. Returns 1 if the place is within `tolerance` mm. */
static int step_to(Pose to, int tolerance)
{
  Pose own = robot_pose(0);
  double target_distance = distance(own, to);
  int turn = (int)lround(remainder(atan2(to.y - own.y, to.x - own.x) * 180 / M_PI - own.phi, 360));
  int direction = 0, ahead = obstacle(turn, target_distance, &direction);
  int speed = SPEED, rate = turn * 2 > 90 ? 90 : turn * 2 < -90 ? -90 : turn * 2;

  if (target_distance < tolerance) {
    VWSetSpeed(0, 0);
    return 1;
  }
  if (abs(turn) > 30)
    speed = 0;
  if (ahead < CLEAR) { /* all robots pass each other at the right */
    rate = direction > -40 ? -80 : 80;
    speed = ahead < CLEAR - 80 ? 0 : 120;
  }
  VWSetSpeed(speed, rate);
  OSWait(50);
  return 0;
}

/* Drives to a place for at most `time` ms. Returns 1 if the robot has arrived. */
static int go(Pose to, int tolerance, int time)
{
  int end = OSGetCount() + time;
  while (OSGetCount() < end)
    if (step_to(to, tolerance))
      return 1;
  VWSetSpeed(0, 0);
  return 0;
}

/* Number of balls outside the depot. */
static int balls_left(void)
{
  int robots = SIMGetRobotCount(), ball, count = 0;
  for (ball = robots + 1; ball <= robots + SIMGetObjectCount(); ball++)
    count += !is_in_depot(object_pose(ball));
  return count;
}

int main(void)
{
  int robots = SIMGetRobotCount(), balls = SIMGetObjectCount(), collected = 0;
  Pose depot = {DEPOT_X + 300, DEPOT_Y + 300, 0}, home = robot_pose(0);

  while (balls_left() > 0) {
    int ball = choose(), slot = ball - robots - 1;
    Pose at;
    if (ball == 0) { /* no ball for this robot, so it gets out of the way of the others */
      go(home, 100, 1000);
      OSWait(200);
      continue;
    }
    at = object_pose(ball);
    if (!go(at, REACH, 1000) || distance(robot_pose(0), object_pose(ball)) > REACH + 20)
      continue;
    LCDPrintf("ball %d of %d\n", slot + 1, balls);
    /* While the robot carries the ball, the ball is at the wall, out of sight of the other robots. */
    SIMSetObject(ball, 60 + 60 * slot, 60, 0, 0);
    go(depot, 250, 20000);
    SIMSetObject(ball, DEPOT_X + slot % 4 * 90, DEPOT_Y - 120 + slot / 4 * 90, 0, 0);
    collected++;
  }
  VWSetSpeed(0, 0);
  LCDClear();
  LCDPrintf("collected %d\n", collected);
  return 0;
}
