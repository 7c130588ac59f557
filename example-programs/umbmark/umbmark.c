/* Drives once around a square of 1 m and compares odometry with ground truth.
   After the benchmark UMBmark of Borenstein and Feng (1996). */
#include "eyebot.h"
#include <stdio.h>

#define SIDE 1000   /* mm */
#define SPEED 300   /* mm/s */
#define RATE 90     /* degrees/s */

int main(void)
{
  int start_x, start_y, x, y, z, phi, corner;

  SIMGetRobot(0, &start_x, &start_y, &z, &phi);
  for (corner = 0; corner < 4; corner++) {
    VWStraight(SIDE, SPEED);
    VWWait();
    VWTurn(90, RATE);
    VWWait();
  }
  VWGetPosition(&x, &y, &phi);
  printf("believes to be off by %d %d mm, %d degrees\n", x, y, phi);
  SIMGetRobot(0, &x, &y, &z, &phi);
  printf("is off by %d %d mm, %d degrees\n", x - start_x, y - start_y, phi);
  return 0;
}
