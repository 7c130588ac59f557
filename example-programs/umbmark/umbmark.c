/* Drives once around a square of 1 m and compares odometry with ground truth.
   After the benchmark UMBmark of Borenstein and Feng (1996). */
#include "eyebot.h"
#include <math.h>
#include <stdio.h>

#define SIDE 1000   /* mm */
#define SPEED 300   /* mm/s */
#define RATE 90     /* degrees/s */

int main(void)
{
  int start_x, start_y, start_phi, x, y, z, phi, corner;
  double dx, dy, angle;

  SIMGetRobot(0, &start_x, &start_y, &z, &start_phi);
  for (corner = 0; corner < 4; corner++) {
    VWStraight(SIDE, SPEED);
    VWWait();
    VWTurn(90, RATE);
    VWWait();
  }
  VWGetPosition(&x, &y, &phi);
  printf("believes to be off by %d %d mm, %d degrees\n", x, y, phi);
  SIMGetRobot(0, &x, &y, &z, &phi);
  dx = x - start_x;
  dy = y - start_y;
  angle = start_phi * M_PI / 180;  /* odometry begins with the heading 0 */
  printf("is off by %ld %ld mm, %d degrees\n", lround(dx * cos(angle) + dy * sin(angle)),
         lround(dy * cos(angle) - dx * sin(angle)), (phi - start_phi + 539) % 360 - 179);
  return 0;
}
