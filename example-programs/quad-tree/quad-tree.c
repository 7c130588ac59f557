/* Plans with a quad-tree: splits the world into free squares, finds the shortest path from square to square with A*, and drives
 * along their centres. Optional arguments: the goal, X Y in mm. */
#define WORLD "../../worlds/rooms.wld"
#include "../plan/plan.h"

#define RADIUS 130      /* radius of the robot with a margin, mm */
#define MAX_SQUARES 4096

typedef struct { int row, column, size; } Square; /* in cells */

static Square squares[MAX_SQUARES];
static int square_count;

/* Keeps a square that is entirely free, splits one that is partly occupied, and drops one that is entirely occupied. */
static void split(int row, int column, int size)
{
  int i, j, half = size / 2, count = 0;
  for (i = row; i < row + size; i++)
    for (j = column; j < column + size; j++)
      count += occupied[i][j];
  if (count == size * size)
    return;
  if (count == 0) {
    if (square_count < MAX_SQUARES)
      squares[square_count++] = (Square){row, column, size};
    return;
  }
  split(row, column, half);
  split(row, column + half, half);
  split(row + half, column, half);
  split(row + half, column + half, half);
}

static Point centre(int square)
{
  Square s = squares[square];
  return (Point){(s.column + s.size / 2.0) * CELL, (s.row + s.size / 2.0) * CELL};
}

static double distance(int a, int b)
{
  Point p = centre(a), q = centre(b);
  return hypot(p.x - q.x, p.y - q.y);
}

/* Returns 1 if two squares share a part of a side; the line between their centres then passes through that part. */
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
  static int before[MAX_SQUARES];
  static char is_done[MAX_SQUARES];
  int i, best, count;

  for (i = 0; i < square_count; i++)
    cost[i] = INFINITY;
  cost[start] = 0;
  before[start] = -1;
  for (;;) {
    best = -1;
    for (i = 0; i < square_count; i++)
      if (!is_done[i] && cost[i] < INFINITY
          && (best < 0 || cost[i] + distance(i, goal) < cost[best] + distance(best, goal)))
        best = i;
    if (best < 0)
      return 0;
    if (best == goal)
      break;
    is_done[best] = 1;
    for (i = 0; i < square_count; i++)
      if (!is_done[i] && are_neighbours(best, i) && cost[best] + distance(best, i) < cost[i]) {
        cost[i] = cost[best] + distance(best, i);
        before[i] = best;
      }
  }
  for (count = 0, i = goal; i >= 0; i = before[i])
    count++;
  for (best = count, i = goal; i >= 0; i = before[i])
    route[--best] = i;
  return count;
}

static void draw_squares(void)
{
  int i;
  for (i = 0; i < square_count; i++) {
    Square s = squares[i];
    LCDArea(pixel_x(s.column * CELL), pixel_y((s.row + s.size) * CELL), pixel_x((s.column + s.size) * CELL),
            pixel_y(s.row * CELL), TEAL, 0);
  }
}

int main(int argc, char *argv[])
{
  static int route[MAX_SQUARES];
  static Point path[MAX_SQUARES + 1];
  Point goal = {3600, 2600}, start = start_in_world();
  int from, to, count, i;

  if (argc == 3)
    goal = (Point){atof(argv[1]), atof(argv[2])};
  LCDSetColor(YELLOW, BLACK);
  read_world(RADIUS);
  split(0, 0, GRID);
  draw_squares();
  from = square_at(start);
  to = square_at(goal);
  count = from < 0 || to < 0 ? 0 : find_route(from, to, route);
  if (count == 0) {
    LCDPrintf("no way\n");
    return 1;
  }
  for (i = 0; i < count; i++)
    path[i] = centre(route[i]);
  path[count] = goal;
  draw_path(path, count + 1, RED);
  LCDSetPrintf(0, 0, "%d squares, way of %d\n", square_count, count);
  for (i = 0; i <= count; i++)
    drive_to(path[i], 300);
  LCDPrintf("goal\n");
  return 0;
}
