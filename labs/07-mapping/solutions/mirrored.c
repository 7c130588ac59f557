/* A mistake: the program takes the points of a scan from right to left, so the map is a mixture of mirrored rooms. */
#include <math.h>
#include <stdio.h>
#include "eyebot.h"

#define COLUMNS 16
#define ROWS    12
#define CELL    250  /* mm */
#define POINTS  360
#define STEP    25   /* distance between points on a ray, mm */
#define MARGIN  40   /* distance before the end of a ray up to which the ray counts as free, mm */
#define BEHIND  25   /* distance beyond the end of a ray of a point inside the obstacle, mm */

static int free_count[ROWS][COLUMNS], occupied_count[ROWS][COLUMNS];

static void count(int counts[ROWS][COLUMNS], double x, double y)
{
  int column = (int)floor(x / CELL), row = (int)floor(y / CELL);
  if (column >= 0 && column < COLUMNS && row >= 0 && row < ROWS)
    counts[row][column]++;
}

static void scan(void)
{
  int distances[POINTS], x, y, phi, i;
  double at;

  VWGetPosition(&x, &y, &phi);
  LIDARGet(distances);
  for (i = 0; i < POINTS; i++) {
    double angle = (phi - POINTS / 2 + i) * M_PI / 180;
    double dx = cos(angle), dy = sin(angle);
    if (distances[i] == 9999)
      continue;
    for (at = 0; at < distances[i] - MARGIN; at += STEP)
      count(free_count, x + at * dx, y + at * dy);
    at = distances[i] + BEHIND;
    count(occupied_count, x + at * dx, y + at * dy);
  }
}

static void drive_to(double to_x, double to_y)
{
  int x, y, phi, turn;
  VWGetPosition(&x, &y, &phi);
  turn = (int)lround(remainder(atan2(to_y - y, to_x - x) * 180 / M_PI - phi, 360));
  VWTurn(turn, 90);
  VWWait();
  VWStraight((int)lround(hypot(to_x - x, to_y - y)), 300);
  VWWait();
}

static void print_map(void)
{
  int row, column;
  for (row = ROWS - 1; row >= 0; row--) {
    for (column = 0; column < COLUMNS; column++) {
      int empty = free_count[row][column], full = occupied_count[row][column];
      putchar(empty + full == 0 ? '?' : full > empty ? '#' : '.');
    }
    putchar('\n');
  }
}

int main(void)
{
  static const int corners[5][2] = { { 500, 500 }, { 3500, 500 }, { 3500, 2500 }, { 500, 2500 }, { 500, 500 } };
  int x, y, z, phi, side, step;

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  drive_to(corners[0][0], corners[0][1]);
  for (side = 0; side < 4; side++) {
    const int *from = corners[side], *to = corners[side + 1];
    int steps = (int)hypot(to[0] - from[0], to[1] - from[1]) / 500;
    for (step = 1; step <= steps; step++) {
      scan();
      drive_to(from[0] + (to[0] - from[0]) * step / steps, from[1] + (to[1] - from[1]) * step / steps);
    }
  }
  print_map();
  return 0;
}
