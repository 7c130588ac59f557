/* Explores a micro-mouse maze by flood fill and races to its middle on the shortest path.
 *
 * Each cell holds its number of steps to the goal, assuming no walls but those seen so far. The robot always goes to a neighbour that
 * is one step nearer. It drives to the goal and back until the shortest path that may exist is known to be free; then it races.
 *
 * The robot starts in the lower left cell and looks up. Directions are counted in quarter turns to the left from there:
 * 0 up, 1 left, 2 down, 3 right. */
#include <math.h>
#include "eyebot.h"

#define SIZE    16    /* cells in a row */
#define CELL    0.36  /* side of a cell in m */
#define FREE_MM 280   /* walls of this cell are nearer, those of the next farther away */
#define SEARCH  0.4   /* m/s */
#define RACE    0.6   /* m/s */
#define RATE    3.0   /* rad/s */
#define FAR     9999  /* more steps than there are cells */

static const int dx[4] = { 0, -1, 0, 1 };
static const int dy[4] = { 1, 0, -1, 0 };

typedef enum { UNKNOWN, WALL, OPEN } Side;
typedef enum { START, MIDDLE } Goal;

static Side side[SIZE][SIZE][4];   /* of each cell by x, y, direction */
static int  steps[SIZE][SIZE];     /* to the goal */

static VWHandle  vw;
static PSDHandle front, left, right;
static int x, y, direction;        /* the robot's cell and heading */

static int is_inside(int cx, int cy)
{
  return 0 <= cx && cx < SIZE && 0 <= cy && cy < SIZE;
}

static int is_goal(Goal goal, int cx, int cy)
{
  if (goal == START)
    return cx == 0 && cy == 0;
  return (cx == SIZE / 2 - 1 || cx == SIZE / 2) && (cy == SIZE / 2 - 1 || cy == SIZE / 2);
}

/* Records one side of the robot's cell, which is also the opposite side of the neighbour. */
static void note(int d, PSDHandle psd)
{
  Side seen = PSDGet(psd) > FREE_MM ? OPEN : WALL;

  side[x][y][d] = seen;
  if (is_inside(x + dx[d], y + dy[d]))
    side[x + dx[d]][y + dy[d]][(d + 2) % 4] = seen;
}

static void look(void)
{
  OSWait(12);  /* two cycles of the sensors: one of them lies entirely within the stop */
  note(direction, front);
  note((direction + 1) % 4, left);
  note((direction + 3) % 4, right);
}

/* Counts the steps from every cell to the goal; unknown sides are open if `hopeful`, else walls.
 * Returns the steps from the start. */
static int flood(Goal goal, int hopeful)
{
  int queue[SIZE * SIZE][2], first = 0, last = 0, cx, cy, d;

  for (cx = 0; cx < SIZE; cx++)
    for (cy = 0; cy < SIZE; cy++) {
      steps[cx][cy] = FAR;
      if (is_goal(goal, cx, cy)) {
        steps[cx][cy] = 0;
        queue[last][0] = cx;
        queue[last++][1] = cy;
      }
    }
  for (; first < last; first++) {
    cx = queue[first][0];
    cy = queue[first][1];
    for (d = 0; d < 4; d++) {
      int nx = cx + dx[d], ny = cy + dy[d];
      int passable = side[cx][cy][d] == OPEN || (hopeful && side[cx][cy][d] == UNKNOWN);

      if (passable && is_inside(nx, ny) && steps[nx][ny] == FAR) {
        steps[nx][ny] = steps[cx][cy] + 1;
        queue[last][0] = nx;
        queue[last++][1] = ny;
      }
    }
  }
  return steps[0][0];
}

/* Direction of a neighbour that is nearer to the goal, straight on if possible; -1 if there is none. */
static int downhill(int hopeful)
{
  int turn;

  for (turn = 0; turn < 4; turn++) {
    int d = (direction + turn) % 4, nx = x + dx[d], ny = y + dy[d];
    int passable = side[x][y][d] == OPEN || (hopeful && side[x][y][d] == UNKNOWN);

    if (passable && is_inside(nx, ny) && steps[nx][ny] < steps[x][y])
      return d;
  }
  return -1;  /* the goal, or walled in */
}

static void drive(int d, int cells, double speed)
{
  int turn = (d - direction + 4) % 4;

  if (turn != 0) {
    VWDriveTurn(vw, (turn == 3 ? -1 : turn) * M_PI / 2, RATE);
    VWDriveWait(vw);
  }
  VWDriveStraight(vw, cells * CELL, speed);
  VWDriveWait(vw);
  direction = d;
  x += cells * dx[d];
  y += cells * dy[d];
}

/* Drives to the goal cell by cell and records the walls. Returns the number of cells driven. */
static int explore(Goal goal)
{
  int cells = 0;

  for (;;) {
    int d;

    look();
    flood(goal, TRUE);
    d = downhill(TRUE);
    if (d < 0)
      return cells;
    drive(d, 1, SEARCH);
    cells++;
  }
}

/* Drives to the middle through known cells, each straight in one drive. Returns the number of cells driven. */
static int race(void)
{
  int cells = 0, d;

  flood(MIDDLE, FALSE);
  while ((d = downhill(FALSE)) >= 0) {
    int from_x = x, from_y = y, from = direction, straight = 0;

    for (direction = d; downhill(FALSE) == d; straight++) {
      x += dx[d];
      y += dy[d];
    }
    x = from_x;
    y = from_y;
    direction = from;
    drive(d, straight, RACE);
    cells += straight;
  }
  return cells;
}

int main(void)
{
  int begin, time;

  vw = VWInit(VW_DRIVE, 1);
  front = PSDInit(PSD_FRONT);
  left = PSDInit(PSD_LEFT);
  right = PSDInit(PSD_RIGHT);
  if (!vw || !front || !left || !right)
    return OSError("device missing", 1, TRUE);
  PSDStart(front | left | right, TRUE);

  do {
    LCDPrintf("goal in %d\n", explore(MIDDLE));
    AUBeep();
    LCDPrintf("home in %d\n", explore(START));
  } while (flood(MIDDLE, TRUE) < flood(MIDDLE, FALSE));

  begin = OSGetCount();
  LCDPrintf("race: %d cells\n", race());
  time = OSGetCount() - begin;
  LCDPrintf("%d.%02d s\n", time / 100, time % 100);
  LCDMenu("GOAL", "", "", "");
  AUBeep();
  PSDRelease();
  VWRelease(vw);
  return 0;
}
