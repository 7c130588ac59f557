/* Plans with the brushfire algorithm: a fire starts at all walls at once; fronts from different sides meet on the Voronoi diagram,
 * which has the maximum clearance from all walls. The robot drives along it. Optional arguments: the goal, X Y in mm. */
#define WORLD "../../worlds/small.maz"
#include "../plan/plan.h"

#define RADIUS 105      /* radius of the robot with a margin, mm */
#define OFF_RIDGE 10.0  /* cost factor of a step beside the diagram */

typedef struct { int row, column; } Cell;

static Cell origin[GRID][GRID];          /* occupied cell from which the fire came */
static unsigned char is_ridge[GRID][GRID];
static Cell queue[GRID * GRID * 8];

static int is_inside(int row, int column)
{
  return row >= 0 && row < GRID && column >= 0 && column < GRID;
}

static double way_to(Cell from, int row, int column)
{
  return hypot(from.row - row, from.column - column);
}

/* Burns from all occupied cells outwards; a cell keeps the nearest origin that reaches it. */
static void burn(void)
{
  int head = 0, tail = 0, row, column, i, j;
  for (row = 0; row < GRID; row++)
    for (column = 0; column < GRID; column++) {
      origin[row][column] = occupied[row][column] ? (Cell){row, column} : (Cell){-GRID * 4, -GRID * 4};
      if (occupied[row][column])
        queue[tail++] = (Cell){row, column};
    }
  while (head < tail) {
    Cell at = queue[head++], from = origin[at.row][at.column];
    for (i = at.row - 1; i <= at.row + 1; i++)
      for (j = at.column - 1; j <= at.column + 1; j++)
        if (is_inside(i, j) && way_to(from, i, j) < way_to(origin[i][j], i, j)
            && tail < (int)(sizeof queue / sizeof queue[0])) {
          origin[i][j] = from;
          queue[tail++] = (Cell){i, j};
        }
  }
}

/* Marks the cells at which fronts meet: the fire of a neighbour has another origin. The origins must be farther apart than at a
 * right-angled corner, so corners do not count. */
static void find_ridges(void)
{
  int row, column, i, j;
  for (row = 1; row < GRID - 1; row++)
    for (column = 1; column < GRID - 1; column++) {
      Cell from = origin[row][column];
      double clearance = way_to(from, row, column);
      if (occupied[row][column])
        continue;
      for (i = row; i <= row + 1; i++)
        for (j = column; j <= column + 1; j++)
          if (way_to(from, origin[i][j].row, origin[i][j].column) > 1.6 * clearance + 1)
            is_ridge[row][column] = 1;
    }
}

/* Finds the cheapest path, cell by cell. Returns the number of cells, 0 if there is no path or an
 * end is outside the grid. */
static int find_route(Cell start, Cell goal, Cell *route)
{
  static double cost[GRID][GRID];
  static Cell before[GRID][GRID];
  static unsigned char is_queued[GRID][GRID];
  int head = 0, tail = 0, waiting = 1, count = 0, row, column, i, j, k;
  const int room = sizeof queue / sizeof queue[0];

  if (!is_inside(start.row, start.column) || !is_inside(goal.row, goal.column))
    return 0;
  for (row = 0; row < GRID; row++)
    for (column = 0; column < GRID; column++)
      cost[row][column] = INFINITY;
  cost[start.row][start.column] = 0;
  queue[tail++] = start;
  while (waiting > 0) {
    Cell at = queue[head];
    head = (head + 1) % room;
    waiting--;
    is_queued[at.row][at.column] = 0;
    for (i = at.row - 1; i <= at.row + 1; i++)
      for (j = at.column - 1; j <= at.column + 1; j++) {
        double step;
        if (!is_inside(i, j) || occupied[i][j])
          continue;
        step = hypot(i - at.row, j - at.column) * (is_ridge[i][j] ? 1 : OFF_RIDGE);
        if (cost[at.row][at.column] + step < cost[i][j]) {
          cost[i][j] = cost[at.row][at.column] + step;
          before[i][j] = at;
          if (!is_queued[i][j]) {
            is_queued[i][j] = 1;
            queue[tail] = (Cell){i, j};
            tail = (tail + 1) % room;
            waiting++;
          }
        }
      }
  }
  if (cost[goal.row][goal.column] == INFINITY)
    return 0;
  for (i = goal.row, j = goal.column; ; ) {
    Cell last;
    route[count++] = (Cell){i, j};
    if (i == start.row && j == start.column)
      break;
    last = before[i][j];
    i = last.row;
    j = last.column;
  }
  for (k = 0; k < count / 2; k++) {
    Cell swap = route[k];
    route[k] = route[count - 1 - k];
    route[count - 1 - k] = swap;
  }
  return count;
}

/* Simplifies a path to its corners: the cells between two corners lie within 1.5 cells of the straight line (Douglas and Peucker).
 * Leaves room for the goal. */
static int corners(const Cell *route, int first, int last, Point *path, int count)
{
  double dx = route[last].column - route[first].column, dy = route[last].row - route[first].row, length = hypot(dx, dy);
  double farthest = 0;
  int i, at = first;
  for (i = first + 1; i < last; i++) {
    double x = route[i].column - route[first].column, y = route[i].row - route[first].row;
    double off = length > 0 ? fabs(dx * y - dy * x) / length : hypot(x, y);
    if (off > farthest) {
      farthest = off;
      at = i;
    }
  }
  if (farthest > 1.5) {
    count = corners(route, first, at, path, count);
    return corners(route, at, last, path, count);
  }
  if (count < MAX_POINTS - 1)
    path[count++] = cell_centre(route[last].row, route[last].column);
  return count;
}

static Cell cell_at(Point p)
{
  return (Cell){(int)floor(p.y / CELL), (int)floor(p.x / CELL)};
}

int main(int argc, char *argv[])
{
  static Cell route[GRID * GRID];
  static Point path[MAX_POINTS];
  Point goal = {1260, 1260}, start = start_in_world();
  int count, points, row, column, i;

  if (argc == 3)
    goal = (Point){atof(argv[1]), atof(argv[2])};
  LCDSetColor(YELLOW, BLACK);
  read_world(RADIUS);
  burn();
  find_ridges();
  for (row = 0; row < GRID; row++)
    for (column = 0; column < GRID; column++)
      if (is_ridge[row][column])
        LCDPixel(pixel_x(column * CELL), pixel_y(row * CELL), YELLOW);
  count = find_route(cell_at(start), cell_at(goal), route);
  if (count == 0) {
    LCDPrintf("no way\n");
    return 1;
  }
  points = corners(route, 0, count - 1, path, 0);
  path[points++] = goal;
  draw_path(path, points, RED);
  for (i = 0; i < points; i++)
    drive_to(path[i], 200);
  LCDSetPrintf(0, 0, "goal, %d corners\n", points);
  return 0;
}
