/* Brushfire: a fire starts at all obstacles at once and burns from cell to cell; the number of a cell is its distance from the obstacles.
 * The robot drives along the cells with the maximum numbers. Arguments: the goal, then the pillars, X Y each, in mm. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define SIDE 16   /* cells in a row */
#define CELL 250  /* mm */

typedef struct { int row, column; } Cell;

static const Cell NEIGHBOURS[4] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
static int number[SIDE][SIDE]; /* [row][column], row 0 at y = 0; 1 is occupied, 0 not yet burnt */

static int is_inside(Cell cell)
{
  return cell.row >= 0 && cell.row < SIDE && cell.column >= 0 && cell.column < SIDE;
}

static Cell neighbour(Cell cell, int i)
{
  return (Cell){ cell.row + NEIGHBOURS[i].row, cell.column + NEIGHBOURS[i].column };
}

/* Number of a cell; cells beyond the floor are occupied. */
static int number_of(Cell cell)
{
  return is_inside(cell) ? number[cell.row][cell.column] : 1;
}

/* Burns one front after the other. A front is the cells without a number beside a cell of the previous front. */
static void burn(void)
{
  int value, has_burnt = 1, row, column, i;
  for (value = 2; has_burnt; value++)
    for (has_burnt = 0, row = 0; row < SIDE; row++)
      for (column = 0; column < SIDE; column++)
        for (i = 0; i < 4 && number[row][column] == 0; i++)
          if (number_of(neighbour((Cell){ row, column }, i)) == value - 1) {
            number[row][column] = value;
            has_burnt = 1;
          }
}

static void print_numbers(void)
{
  int row, column;
  for (row = SIDE - 1; row >= 0; row--)
    for (column = 0; column < SIDE; column++)
      printf("%2d%c", number[row][column], column < SIDE - 1 ? ' ' : '\n');
}

/* Finds the shortest path over cells with a number of at least `min_number`. Returns its length in cells, 0 if there is none. */
static int find_route(Cell start, Cell goal, int min_number, Cell *route)
{
  static Cell queue[SIDE * SIDE], before[SIDE][SIDE];
  int is_found[SIDE][SIDE] = { { 0 } }, first = 0, last = 0, count = 0, i;
  Cell cell;

  queue[last++] = goal; /* starts at the goal, so the path leads from cell to cell towards it */
  is_found[goal.row][goal.column] = 1;
  while (first < last) {
    cell = queue[first++];
    for (i = 0; i < 4; i++) {
      Cell next = neighbour(cell, i);
      if (is_inside(next) && number_of(next) >= min_number && !is_found[next.row][next.column]) {
        is_found[next.row][next.column] = 1;
        before[next.row][next.column] = cell;
        queue[last++] = next;
      }
    }
  }
  if (!is_found[start.row][start.column])
    return 0;
  for (cell = start; cell.row != goal.row || cell.column != goal.column; cell = before[cell.row][cell.column])
    route[count++] = cell;
  route[count++] = goal;
  return count;
}

static void drive_to(double to_x, double to_y)
{
  int x, y, phi, turn;
  VWGetPosition(&x, &y, &phi);
  turn = (int)lround(remainder(atan2(to_y - y, to_x - x) * 180 / M_PI - phi, 360));
  if (turn != 0) {
    VWTurn(turn, 90);
    VWWait();
  }
  VWStraight((int)lround(hypot(to_x - x, to_y - y)), 300);
  VWWait();
}

int main(int argc, char *argv[])
{
  static Cell route[SIDE * SIDE];
  int x, y, z, phi, i, min_number, count = 0, goal_x = atoi(argv[1]), goal_y = atoi(argv[2]);
  Cell start, goal = { goal_y / CELL, goal_x / CELL };

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  start = (Cell){ y / CELL, x / CELL };
  for (i = 3; i + 1 < argc; i += 2) {
    int column = atoi(argv[i]) / CELL, row = atoi(argv[i + 1]) / CELL;
    number[row][column] = number[row][column - 1] = number[row - 1][column] = number[row - 1][column - 1] = 1;
  }
  burn();
  print_numbers();
  for (min_number = number_of(start); min_number > 1 && count == 0; min_number--)
    count = find_route(start, goal, min_number, route);
  for (i = 0; i < count; i++)
    drive_to((route[i].column + 0.5) * CELL, (route[i].row + 0.5) * CELL);
  drive_to(goal_x, goal_y);
  return 0;
}
