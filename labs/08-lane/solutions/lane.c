/* Drives a lap in the right lane of a road: follows the line at the road's edge, half a lane beside it.
 *
 * In one row of the camera's image the line is a short run of bright pixels. Height and tilt of the camera give the point on the floor
 * that a pixel shows. The robot drives an arc to the middle of the lane in that row (pure pursuit). */
#include <math.h>
#include <stdlib.h>
#include "eyebot.h"

#define LANE     370  /* width, mm */
#define TILT     -10  /* of the camera, degrees */
#define CAMERA_X 62   /* of the S4, mm */
#define CAMERA_Z 60
#define ROW      52   /* of the image, about 0.55 m ahead */
#define CONTRAST 40   /* minimum difference of brightness between road and line */
#define WIDEST   60   /* maximum width of the line, mm */
#define SPEED    300  /* mm/s */
#define ROUND    450  /* degrees: a lap turns the robot by 360; 90 more, since it may have started before a bend */

static BYTE image[QQVGA_PIXELS];
static double ahead, per_column; /* distance of the row on the floor, and width that a pixel shows there, mm */

/* Computes the distances of the row. The camera has a field of view of 60 degrees. */
static void measure_row(void)
{
  double focal = QQVGA_X / 2 / tan(M_PI / 6), tilt = TILT * M_PI / 180, up = (QQVGA_Y / 2 - 0.5 - ROW) / focal;
  double down = -sin(tilt) - up * cos(tilt);
  ahead = CAMERA_X + (cos(tilt) - up * sin(tilt)) * CAMERA_Z / down;
  per_column = CAMERA_Z / down / focal;
}

/* Position on the floor that a column shows, in mm to the left. */
static double left_of(double column)
{
  return (QQVGA_X / 2 - 0.5 - column) * per_column;
}

/* Mean of three rows, so that single wrong pixels have less effect. */
static int brightness(int column)
{
  const BYTE *pixel = image + ROW * QQVGA_X + column;
  return (pixel[-QQVGA_X] + *pixel + pixel[QQVGA_X]) / 3;
}

/* Finds the line nearest to its last position. Returns 1 if there is one; `line` becomes its position, in mm to the left. */
static int find_line(double *line)
{
  int x, start = -1, darkest = 255, brightest = 0, is_found = 0;
  double nearest = 0.4 * LANE, offset = *line;

  for (x = 0; x < QQVGA_X; x++) {
    darkest = brightness(x) < darkest ? brightness(x) : darkest;
    brightest = brightness(x) > brightest ? brightness(x) : brightest;
  }
  if (brightest - darkest < CONTRAST)
    return 0;
  for (x = 0; x <= QQVGA_X; x++) {
    int is_bright = x < QQVGA_X && brightness(x) > (darkest + brightest) / 2;
    if (is_bright && start < 0)
      start = x;
    if (!is_bright && start >= 0) {
      double at = left_of((start + x - 1) / 2.0), width = (x - start) * per_column;
      start = -1;
      if (width <= WIDEST && fabs(at - *line) < nearest) {
        nearest = fabs(at - *line);
        offset = at;
        is_found = 1;
      }
    }
  }
  *line = offset;
  return is_found;
}

int main(void)
{
  int x, y, phi, last, turned = 0, lost = 0;
  double line = -LANE / 2; /* of the road's edge, mm to the left */

  if (CAMInit(QQVGA) != 0)
    return 1;
  measure_row();
  SERVOSet(2, 255 * (TILT + 90) / 180);
  OSWait(500);
  VWGetPosition(&x, &y, &last);
  while (turned < ROUND && lost < 50) {
    CAMGetGray(image);
    if (find_line(&line)) {
      double left = line + LANE / 2;
      double curvature = 2 * left / (ahead * ahead + left * left);
      VWSetSpeed(SPEED, (int)lround(SPEED * curvature * 180 / M_PI));
      lost = 0;
    } else {
      lost++;
    }
    VWGetPosition(&x, &y, &phi);
    turned += (phi - last + 540) % 360 - 180;
    last = phi;
  }
  VWSetSpeed(0, 0);
  return 0;
}
