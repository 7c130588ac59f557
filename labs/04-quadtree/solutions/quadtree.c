/* Plans with a quadtree: splits the floor into free squares, finds the shortest path from square to square with A*, and drives along their
 * centres. Arguments: the goal, then the pillars, X Y each, in mm. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define SIDE  16   /* cells in a row */
#define CELL  250  /* mm */
#define MAX_SQUARES  (SIDE * SIDE)
#define PIECE 500  /* maximum drive between two readings of odometry, mm */

typedef struct { int row, column, size; } Square; /* in cells */
typedef struct { double x, y; } Point;            /* mm */

static char occupied[SIDE][SIDE]; /* [row][column], row 0 at y = 0 */
static Square squares[MAX_SQUARES];
static int square_count;

/* Keeps a square that is free, drops one that is occupied, and splits one that is partly occupied. */
static void split(int row, int column, int size)
{
  int i, j, half = size / 2, count = 0;
  for (i = row; i < row + size; i++)
    for (j = column; j < column + size; j++)
      count += occupied[i][j];
  if (count == 0) {
    squares[square_count++] = (Square){ row, column, size };
    printf("free %d %d %d\n", row, column, size);
  } else if (count < size * size) {
    split(row, column, half);
    split(row, column + half, half);
    split(row + half, column, half);
    split(row + half, column + half, half);
  }
}

static Point centre(int square)
{
  Square s = squares[square];
  return (Point){ (s.column + s.size / 2.0) * CELL, (s.row + s.size / 2.0) * CELL };
}

static double distance(int a, int b)
{
  Point p = centre(a), q = centre(b);
  return hypot(p.x - q.x, p.y - q.y);
}

/* Returns 1 if two squares share a part of a side. */
static int are_neighbours(int a, int b)
{
  Square s = squares[a], t = squares[b];
  int rows = s.row < t.row + t.size && t.row < s.row + s.size;
  int columns = s.column < t.column + t.size && t.column < s.column + s.size;
  int beside = s.column + s.size == t.column || t.column + t.size == s.column;
  int above = s.row + s.size == t.row || t.row + t.size == s.row;
  return (rows && beside) || (columns && above);
}

static int square_at(Point p)
{
  int row = (int)(p.y / CELL), column = (int)(p.x / CELL), i;
  for (i = 0; i < square_count; i++) {
    Square s = squares[i];
    if (row >= s.row && row < s.row + s.size && column >= s.column && column < s.column + s.size)
      return i;
  }
  return -1;
}

/* A*: finds the squares from `start` to `goal`, both included. Returns their number, 0 if there is no path. */
static int find_route(int start, int goal, int route[MAX_SQUARES])
{
  static double cost[MAX_SQUARES];
  static int before[MAX_SQUARES], is_done[MAX_SQUARES];
  int i, best, count = 0;

  for (i = 0; i < square_count; i++)
    cost[i] = INFINITY;
  cost[start] = 0;
  before[start] = -1;
  for (;;) {
    best = -1;
    for (i = 0; i < square_count; i++)
      if (!is_done[i] && cost[i] < INFINITY && (best < 0 || cost[i] + distance(i, goal) < cost[best] + distance(best, goal)))
        best = i;
    if (best < 0)
      return 0;
    if (best == goal)
      break;
    is_done[best] = 1;
    for (i = 0; i < square_count; i++)
      if (are_neighbours(best, i) && cost[best] + distance(best, i) < cost[i]) {
        cost[i] = cost[best] + distance(best, i);
        before[i] = best;
      }
  }
  for (i = goal; i >= 0; i = before[i])
    count++;
  for (best = count, i = goal; i >= 0; i = before[i])
    route[--best] = i;
  return count;
}

/* Drives to a point in parts. Before each part, odometry gives the end of the previous one. */
static void drive_to(Point to)
{
  for (;;) {
    int x, y, phi, turn, route;
    VWGetPosition(&x, &y, &phi);
    route = (int)lround(hypot(to.x - x, to.y - y));
    if (route < 20)
      return;
    turn = (int)lround(remainder(atan2(to.y - y, to.x - x) * 180 / M_PI - phi, 360));
    if (turn != 0) {
      VWTurn(turn, 90);
      VWWait();
    }
    VWStraight(route < PIECE ? route : PIECE, 300);
    VWWait();
  }
}

int main(int argc, char *argv[])
{
  static int route[MAX_SQUARES];
  int x, y, z, phi, i, count;
  Point start, goal = { atof(argv[1]), atof(argv[2]) };

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  start = (Point){ x, y };
  for (i = 3; i + 1 < argc; i += 2) {
    int column = atoi(argv[i]) / CELL, row = atoi(argv[i + 1]) / CELL;
    occupied[row][column] = occupied[row][column - 1] = occupied[row - 1][column] = occupied[row - 1][column - 1] = 1;
  }
  split(0, 0, SIDE);
  count = find_route(square_at(start), square_at(goal), route);
  for (i = 1; i + 1 < count; i++)
    drive_to(centre(route[i]));
  drive_to(goal);
  return 0;
}
