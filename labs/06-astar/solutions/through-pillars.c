/* A mistake: the printed matrix also contains distances through pillars. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define PLACES 8
#define GOAL   (PLACES - 1)
#define MAX_PILLARS   20   /* pillars */
#define HALF   250  /* half the side of the square around a pillar, mm */
#define PIECE  500  /* maximum drive between two readings of odometry, mm */

typedef struct { double x, y; } Point; /* mm */

static Point places[PLACES], pillars[MAX_PILLARS];
static int pillar_count;
static double matrix[PLACES][PLACES]; /* mm; -1 if there is no straight path */

/* Shortens the part from `first` to `last` (0 to 1) of a line to the part within HALF of a pillar, on one axis. */
static void cut(double from, double to, double pillar, double *first, double *last)
{
  double delta = to - from, a = (pillar - HALF - from) / delta, b = (pillar + HALF - from) / delta;
  if (delta == 0) {
    if (fabs(pillar - from) >= HALF)
      *last = -1;
    return;
  }
  *first = fmax(*first, fmin(a, b));
  *last = fmin(*last, fmax(a, b));
}

/* Returns 1 if the straight line passes through no square around a pillar. */
static int is_free(Point a, Point b)
{
  int i;
  for (i = 0; i < pillar_count; i++) {
    double first = 0, last = 1;
    cut(a.x, b.x, pillars[i].x, &first, &last);
    cut(a.y, b.y, pillars[i].y, &first, &last);
    if (first < last)
      return 0;
  }
  return 1;
}

static double distance(int a, int b)
{
  return hypot(places[a].x - places[b].x, places[a].y - places[b].y);
}

static void measure(void)
{
  int i, j;
  for (i = 0; i < PLACES; i++) {
    for (j = 0; j < PLACES; j++) {
      matrix[i][j] = i == j || is_free(places[i], places[j]) ? distance(i, j) : -1;
      printf(" %5.0f", distance(i, j));
    }
    printf("\n");
  }
}

/* A*: the cost of a place is the path to it plus the straight distance from it to the goal. Returns the number of places on the path. */
static int find_route(int route[PLACES])
{
  double cost[PLACES];
  int before[PLACES], is_done[PLACES] = { 0 }, i, best, count = 0;

  for (i = 0; i < PLACES; i++)
    cost[i] = INFINITY;
  cost[0] = 0;
  before[0] = -1;
  for (;;) {
    best = -1;
    for (i = 0; i < PLACES; i++)
      if (!is_done[i] && cost[i] < INFINITY && (best < 0 || cost[i] + distance(i, GOAL) < cost[best] + distance(best, GOAL)))
        best = i;
    if (best < 0)
      return 0;
    if (best == GOAL)
      break;
    is_done[best] = 1;
    for (i = 0; i < PLACES; i++)
      if (matrix[best][i] >= 0 && cost[best] + matrix[best][i] < cost[i]) {
        cost[i] = cost[best] + matrix[best][i];
        before[i] = best;
      }
  }
  for (i = GOAL; i >= 0; i = before[i])
    count++;
  for (best = count, i = GOAL; i >= 0; i = before[i])
    route[--best] = i;
  return count;
}

/* Drives to a point in parts. Before each part, odometry gives the end of the previous one. */
static void drive_to(Point to)
{
  for (;;) {
    int x, y, phi, turn, distance_left;
    VWGetPosition(&x, &y, &phi);
    distance_left = (int)lround(hypot(to.x - x, to.y - y));
    if (distance_left < 20)
      return;
    turn = (int)lround(remainder(atan2(to.y - y, to.x - x) * 180 / M_PI - phi, 360));
    if (turn != 0) {
      VWTurn(turn, 90);
      VWWait();
    }
    VWStraight(distance_left < PIECE ? distance_left : PIECE, 300);
    VWWait();
  }
}

int main(int argc, char *argv[])
{
  int x, y, z, phi, i, count, route[PLACES];

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  for (i = 0; 2 * i + 2 < argc && i < PLACES + MAX_PILLARS; i++) {
    Point point = { atof(argv[2 * i + 1]), atof(argv[2 * i + 2]) };
    if (i < PLACES)
      places[i] = point;
    else
      pillars[pillar_count++] = point;
  }
  measure();
  count = find_route(route);
  printf("way");
  for (i = 0; i < count; i++)
    printf(" %d", route[i]);
  printf("\n");
  for (i = 1; i < count; i++)
    drive_to(places[route[i]]);
  return 0;
}
