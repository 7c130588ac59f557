/* Explores the maze by flood fill and races to the goal on a shortest path.
 *
 * Each cell holds its number of steps to the goal, assuming no walls other than those seen so far. The robot goes to a neighbour that is
 * one step nearer. It goes to the goal and back until no shorter path through unknown sides can exist; then it races.
 *
 * Directions are quarter turns to the left from the x axis: 0 right, 1 up, 2 left, 3 down. */
#include <math.h>
#include "eyebot.h"

#define SIZE 6       /* cells in a row */
#define CELL 360     /* mm */
#define NEAR 250     /* distance below which a wall belongs to the robot's own cell, mm */
#define FAR  9999    /* more steps than there are cells */

typedef enum { UNKNOWN, WALL, OPEN } Side;
typedef struct { int x, y; } Cell;

static const Cell START = { 0, 0 }, GOAL = { SIZE - 1, SIZE - 1 };
static const int dx[4] = { 1, 0, -1, 0 }, dy[4] = { 0, 1, 0, -1 };

static Side side[SIZE][SIZE][4];
static int steps[SIZE][SIZE];
static Cell at;           /* the robot's cell */
static int direction = 1; /* in which it looks */

static int is_inside(int x, int y)
{
  return 0 <= x && x < SIZE && 0 <= y && y < SIZE;
}

/* Records one side of the robot's cell, which is also the opposite side of its neighbour. */
static void note(int d, int distance)
{
  Side seen = distance < NEAR ? WALL : OPEN;
  side[at.x][at.y][d] = seen;
  if (is_inside(at.x + dx[d], at.y + dy[d]))
    side[at.x + dx[d]][at.y + dy[d]][(d + 2) % 4] = seen;
}

static void look(void)
{
  note(direction, PSDGet(PSD_FRONT));
  note((direction + 1) % 4, PSDGet(PSD_LEFT));
  note((direction + 3) % 4, PSDGet(PSD_RIGHT));
}

static int is_free(int x, int y, int d, int hopeful)
{
  int free = side[x][y][d] == OPEN || (hopeful && side[x][y][d] == UNKNOWN);
  return free && is_inside(x + dx[d], y + dy[d]);
}

/* Counts the steps from every cell to the goal; unknown sides are open if `hopeful`, else walls. Returns the steps from the start. */
static int flood(Cell goal, int hopeful)
{
  Cell queue[SIZE * SIZE];
  int first = 0, last = 0, x, y, d;

  for (x = 0; x < SIZE; x++)
    for (y = 0; y < SIZE; y++)
      steps[x][y] = FAR;
  steps[goal.x][goal.y] = 0;
  queue[last++] = goal;
  while (first < last) {
    Cell cell = queue[first++];
    for (d = 0; d < 4; d++) {
      Cell next = { cell.x + dx[d], cell.y + dy[d] };
      if (is_free(cell.x, cell.y, d, hopeful) && steps[next.x][next.y] == FAR) {
        steps[next.x][next.y] = steps[cell.x][cell.y] + 1;
        queue[last++] = next;
      }
    }
  }
  return steps[START.x][START.y];
}

/* Direction of a neighbour that is nearer to the goal, straight on if possible; -1 at the goal. */
static int downhill(int hopeful)
{
  int turn;
  for (turn = 0; turn < 4; turn++) {
    int d = (direction + turn) % 4;
    if (is_free(at.x, at.y, d, hopeful) && steps[at.x + dx[d]][at.y + dy[d]] < steps[at.x][at.y])
      return d;
  }
  return -1;
}

static void turn_to(int heading)
{
  int x, y, phi, turn;
  VWGetPosition(&x, &y, &phi);
  turn = (int)lround(remainder(heading - phi, 360));
  if (turn != 0) {
    VWTurn(turn, 90);
    VWWait();
  }
}

/* Drives to the neighbour in a direction. The target is the middle of its cell by odometry, so errors do not add up. */
static void go(int d, int speed)
{
  int x, y, phi, to_x, to_y;
  at.x += dx[d];
  at.y += dy[d];
  direction = d;
  to_x = at.x * CELL + CELL / 2;
  to_y = at.y * CELL + CELL / 2;
  VWGetPosition(&x, &y, &phi);
  turn_to((int)lround(atan2(to_y - y, to_x - x) * 180 / M_PI));
  VWStraight((int)lround(hypot(to_x - x, to_y - y)), speed);
  VWWait();
}

static void explore(Cell goal)
{
  int d;
  for (look(); flood(goal, 1), (d = downhill(1)) >= 0; look())
    go(d, 300);
}

int main(void)
{
  int d;
  VWSetPosition(CELL / 2, CELL / 2, 90);
  do {
    explore(GOAL);
    explore(START);
  } while (flood(GOAL, 1) < flood(GOAL, 0));
  LCDPrintf("race: %d steps\n", steps[START.x][START.y]);
  while ((d = downhill(0)) >= 0)
    go(d, 400);
  return 0;
}
