/* Drives one lap in the right lane of a road, between the line at the road's edge and the dashed line in its middle.
 *
 * The camera looks down. In each of a few rows of the image the markings are the short runs of bright pixels; the height and the tilt
 * of the camera give the place on the floor of each pixel. The lane's middle lies halfway between both markings or, if the robot sees
 * only one, half a lane beside it. The robot drives an arc through the middle of the lane at the farthest of these rows (pure
 * pursuit). */
#include <math.h>
#include <stdlib.h>

#include "eyebot.h"

#define LANE 370       /* width, mm */
#define TILT -10       /* tilt of the camera, degrees */
#define CAMERA_X 62    /* of the S4, mm */
#define CAMERA_Z 60
#define CONTRAST 50    /* minimum contrast between road and marking */
#define WIDEST 60      /* maximum width of a marking, mm */
#define SPEED 300      /* mm/s */
#define ROUND (360 + 90) /* degrees: a lap turns the robot by 360; 90 more, since it may have started before a bend */

#define ROWS 5
static const int rows[ROWS] = {66, 62, 58, 54, 50}; /* of the image, from near to far */

static BYTE image[QQVGA_PIXELS];

typedef struct { double x, y; } Point; /* on the floor: mm ahead of the robot's middle and to its left */

static double radians(double degrees)
{
  return degrees * M_PI / 180;
}

/* Point on the floor that a pixel shows, if it shows the floor. The camera has a field of view of 60 degrees. */
static Point place_of(double column, int row)
{
  double focal = QQVGA_X / 2 / tan(radians(30)), tilt = radians(TILT);
  double left = (QQVGA_X / 2 - 0.5 - column) / focal, up = (QQVGA_Y / 2 - 0.5 - row) / focal;
  double ahead = cos(tilt) - up * sin(tilt), down = -sin(tilt) - up * cos(tilt);
  Point point = {CAMERA_X + ahead * CAMERA_Z / down, left * CAMERA_Z / down};
  return point;
}

static int middle_of(int a, int b, int c)
{
  return a < b ? (b < c ? b : a < c ? c : a) : (a < c ? a : b < c ? c : b);
}

/* Reads a row of the image as the median of three rows, which removes single wrong pixels. */
static void read_row(int row, int levels[QQVGA_X])
{
  int x;
  for (x = 0; x < QQVGA_X; x++) {
    const BYTE *pixel = image + row * QQVGA_X + x;
    levels[x] = middle_of(pixel[-QQVGA_X], *pixel, pixel[QQVGA_X]);
  }
}

/* Finds the markings of the lane whose middle is expected `middle` mm to the left, and sets their places in mm to the left.
 * Returns 1 if only the left one is found, 2 if only the right one, 3 if both, else 0. */
static int markings(int row, double middle, double *left, double *right)
{
  int levels[QQVGA_X], darkest = 255, brightest = 0, found = 0, x, start = -1;

  read_row(row, levels);
  for (x = 0; x < QQVGA_X; x++) {
    darkest = levels[x] < darkest ? levels[x] : darkest;
    brightest = levels[x] > brightest ? levels[x] : brightest;
  }
  if (brightest - darkest < CONTRAST)
    return 0;
  for (x = 0; x <= QQVGA_X; x++) {
    int is_bright = x < QQVGA_X && levels[x] > (darkest + brightest) / 2;
    if (is_bright && start < 0)
      start = x;
    if (!is_bright && start >= 0) {
      double first = place_of(start - 0.5, row).y, last = place_of(x - 0.5, row).y, at = (first + last) / 2;
      start = -1;
      if (first - last > WIDEST || fabs(at - middle) > 0.8 * LANE) /* no marking, or one of another lane */
        continue;
      if (at > middle) {
        *left = at; /* the last one before the middle is the nearest */
        found |= 1;
      } else if (!(found & 2)) {
        *right = at;
        found |= 2;
      }
    }
  }
  return found;
}

/* Finds the middle of the lane, row by row from near to far, and marks it on the display. Returns the number of rows that show it.
 * `target` becomes the middle in the last of these rows; `middle`, in mm to the left, that in the first, kept from image to image. */
static int find_lane(double *middle, Point *target)
{
  double at = *middle, left = 0, right = 0;
  int i, seen = 0;
  for (i = 0; i < ROWS; i++) {
    int found = markings(rows[i], at, &left, &right);
    Point first = place_of(0, rows[i]), second = place_of(1, rows[i]);
    int column;
    if (found == 0)
      continue;
    at = found == 3 ? (left + right) / 2 : found == 2 ? right + LANE / 2 : left - LANE / 2;
    if (seen++ == 0)
      *middle = at;
    target->x = first.x;
    target->y = at;
    column = (int)((first.y - at) / (first.y - second.y));
    LCDLine(column - 4, rows[i], column + 4, rows[i], RED);
    LCDLine(column, rows[i] - 4, column, rows[i] + 4, RED);
  }
  return seen;
}

int main(void)
{
  int x, y, phi, last, turned = 0, lost = 0;
  double middle = 0;

  if (CAMInit(QQVGA) != 0)
    return 1;
  SERVOSet(2, 255 * (TILT + 90) / 180);
  OSWait(500);
  VWGetPosition(&x, &y, &last);
  while (abs(turned) < ROUND && lost < 50) {
    Point target;
    CAMGetGray(image);
    LCDImageGray(image);
    if (find_lane(&middle, &target) > 0) {
      double curvature = 2 * target.y / (target.x * target.x + target.y * target.y);
      VWSetSpeed(SPEED, (int)lround(curvature * SPEED * 180 / M_PI));
      lost = 0;
    } else {
      lost++;
    }
    VWGetPosition(&x, &y, &phi);
    turned += (phi - last + 540) % 360 - 180;
    last = phi;
    LCDSetPrintf(10, 0, "turned %4d degrees", turned);
  }
  VWSetSpeed(0, 0);
  CAMRelease();
  LCDSetPrintf(11, 0, abs(turned) < ROUND ? "the lane is lost" : "once around");
  return abs(turned) < ROUND ? 2 : 0;
}
