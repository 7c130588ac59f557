/* Library for programs that plan in a known world: its walls as a grid of cells, and driving along a path. RoBIOS-7.
 *
 * A program defines WORLD, the file of its world, before it includes this header. Supported: `floor` and walls of a .wld file (no
 * `push`), and the walls of a .maz file. */
#ifndef PLAN_H
#define PLAN_H

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "eyebot.h"

#define CELL 20      /* mm */
#define GRID 256     /* cells a side, a power of 2: 5.12 m */
#define MAX_WALLS 512
#define MAX_POINTS 1024

typedef struct { double x, y; } Point; /* mm */

static struct { Point a, b; } walls[MAX_WALLS];
static int wall_count;
static unsigned char occupied[GRID][GRID]; /* [row][column], row 0 at y = 0; true outside the floor too */

static inline void add_wall(double x1, double y1, double x2, double y2)
{
  if (wall_count < MAX_WALLS) {
    walls[wall_count].a = (Point){x1, y1};
    walls[wall_count].b = (Point){x2, y2};
    wall_count++;
  }
}

/* Adds the walls of a maze, given as rows from the top: an even column is a side of a cell, an odd one the cell with its lower wall. */
static inline void add_maze(char rows[][128], int count, double size)
{
  int row, column;
  for (row = 0; row < count; row++)
    for (column = 0; rows[row][column]; column++) {
      char c = rows[row][column];
      double x = column / 2 * size, y = (count - 1 - row) * size;
      if (column % 2 == 0 && c == '|')
        add_wall(x, y, x, y + size);
      if (column % 2 == 1 && (c == '_' || isupper((unsigned char)c)))
        add_wall(x, y, x + size, y);
    }
}

static inline double wall_distance(Point p, int wall)
{
  Point a = walls[wall].a, b = walls[wall].b;
  double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  double t = length2 > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length2 : 0;
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

static inline Point cell_centre(int row, int column)
{
  return (Point){(column + 0.5) * CELL, (row + 0.5) * CELL};
}

/* The file WORLD, relative to the program's folder, is built into the program, which so does not depend on the run's current folder. */
__asm__(".pushsection .rodata\nworld_text: .incbin \"" WORLD "\"\n.byte 0\n.popsection");
extern const char world_text[] __attribute__((visibility("hidden")));

/* Reads the world and marks the cells that a robot's centre must not enter; `radius` is the robot's in mm with its margin. */
static inline void read_world(double radius)
{
  static char rows[64][128];
  char line[256];
  const char *at = world_text;
  int is_maze = strstr(WORLD, ".maz") != NULL, count = 0, row, column, wall;
  double width = 0, height = 0, x1, y1, x2, y2, size = 360;

  for (; *at; at += strcspn(at, "\n"), at += *at == '\n') {
    snprintf(line, sizeof line, "%.*s", (int)strcspn(at, "\r\n"), at);
    if (is_maze) {
      if (isdigit((unsigned char)line[0]))
        size = atof(line);
      else if (count < 64)
        snprintf(rows[count++], sizeof rows[0], "%.127s", line);
    } else if (sscanf(line, "floor %lf %lf", &x1, &y1) == 2) {
      width = x1;
      height = y1;
    } else if (sscanf(line, "%lf %lf %lf %lf", &x1, &y1, &x2, &y2) == 4) {
      add_wall(x1, y1, x2, y2);
    }
  }
  if (is_maze && count > 1) { /* the first row is the upper border */
    add_maze(rows + 1, count - 1, size);
    width = size * (strlen(rows[1]) / 2);
    height = size * (count - 1);
    add_wall(0, height, width, height);
  }
  for (row = 0; row < GRID; row++)
    for (column = 0; column < GRID; column++) {
      Point p = cell_centre(row, column);
      occupied[row][column] = p.x > width || p.y > height;
      for (wall = 0; wall < wall_count && !occupied[row][column]; wall++)
        occupied[row][column] = wall_distance(p, wall) < radius;
    }
}

static inline double degrees(double radians)
{
  return radians * 180 / M_PI;
}

/* The angle wrapped to -180 to 180 degrees. */
static inline double wrapped(double angle)
{
  return remainder(angle, 360);
}

/* Sets odometry to the true start pose and returns its position; from then on the robot relies on odometry. */
static inline Point start_in_world(void)
{
  int x, y, z, phi;
  SIMGetRobot(0, &x, &y, &z, &phi);
  VWSetPosition(x, y, phi);
  return (Point){x, y};
}

/* Turns to a point and drives there. */
static inline void drive_to(Point to, int speed)
{
  int x, y, phi, turn, distance;
  VWGetPosition(&x, &y, &phi);
  turn = (int)lround(wrapped(degrees(atan2(to.y - y, to.x - x)) - phi));
  distance = (int)lround(hypot(to.x - x, to.y - y));
  if (turn != 0) {
    VWTurn(turn, 90);
    VWWait();
  }
  if (distance > 0) {
    VWStraight(distance, speed);
    VWWait();
  }
}

/* Pixels of the display: the world's lower left corner at the lower left of a square of 240 pixels. */
static inline int pixel_x(double x)
{
  return (int)(x * 240 / (GRID * CELL));
}

static inline int pixel_y(double y)
{
  return 239 - (int)(y * 240 / (GRID * CELL));
}

static inline void draw_path(const Point *path, int count, COLOR color)
{
  int i;
  for (i = 1; i < count; i++)
    LCDLine(pixel_x(path[i - 1].x), pixel_y(path[i - 1].y), pixel_x(path[i].x), pixel_y(path[i].y), color);
}

#endif
