/* Drives along a spline through waypoints: the robot drives arcs to the point of the spline at the look-ahead distance (pure pursuit).
 * Arguments: the waypoints, X Y each, in mm. */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define MAX_POINTS  20   /* waypoints */
#define PARTS 50   /* number of points of the spline between two waypoints */
#define AHEAD 100  /* look-ahead distance, mm */
#define SPEED 200  /* mm/s */

typedef struct { double x, y; } Point;

/* A coordinate of the spline of Catmull and Rom between a and b, at t from 0 to 1. */
static double spline(double before, double a, double b, double behind, double t)
{
  double t2 = t * t, t3 = t2 * t, from = (b - before) / 2, to = (behind - a) / 2; /* tangents at a and b */
  return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * from + (-2 * t3 + 3 * t2) * b + (t3 - t2) * to;
}

int main(int argc, char *argv[])
{
  static Point points[MAX_POINTS + 1], line[MAX_POINTS * PARTS + 1];
  int x, y, z, phi, i, part, last = 0, count = 0, next = 0;

  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  points[0] = (Point){ x, y };
  for (i = 1; i + 1 < argc && last < MAX_POINTS; i += 2)
    points[++last] = (Point){ atof(argv[i]), atof(argv[i + 1]) };
  for (i = 0; i < last; i++)
    for (part = 0; part < PARTS; part++) {
      Point p = points[i > 0 ? i - 1 : 0], a = points[i], b = points[i + 1], q = points[i + 2 <= last ? i + 2 : last];
      double t = (double)part / PARTS;
      line[count++] = (Point){ spline(p.x, a.x, b.x, q.x, t), spline(p.y, a.y, b.y, q.y, t) };
    }
  line[count] = points[last];

  for (;;) {
    double angle, distance, curvature, to_end;
    int speed;
    VWGetPosition(&x, &y, &phi);
    while (next < count && hypot(line[next].x - x, line[next].y - y) < AHEAD)
      next++;
    to_end = hypot(line[count].x - x, line[count].y - y);
    angle = remainder(atan2(line[next].y - y, line[next].x - x) - phi * M_PI / 180, 2 * M_PI);
    if (next == count && (to_end < 10 || fabs(angle) > M_PI / 2))
      break; /* there, or past it */
    if (fabs(angle) > M_PI / 6) { /* at the start the spline may lead elsewhere */
      VWTurn((int)lround(angle * 180 / M_PI), 90);
      VWWait();
      continue;
    }
    distance = hypot(line[next].x - x, line[next].y - y);
    curvature = 2 * sin(angle) / distance; /* of the arc, 1/mm */
    speed = to_end < SPEED ? 20 + (int)to_end / 2 : SPEED;
    VWSetSpeed(speed, (int)lround(speed * curvature * 180 / M_PI));
    OSWait(20);
  }
  VWSetSpeed(0, 0);
  return 0;
}
