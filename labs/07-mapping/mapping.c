/* Maps a room: complete it. */
#include <stdio.h>
#include "eyebot.h"

#define COLUMNS 16
#define ROWS    12

int main(void)
{
  int distances[360], x, y, z, phi, row, column;

  SIMGetRobot(0, &x, &y, &z, &phi); /* true pose of the robot in the room, read once, at the start */
  VWSetPosition(x, y, phi);         /* from here on odometry gives the pose */
  LIDARGet(distances);              /* from left to right; distances[180] is ahead */
  for (row = 0; row < ROWS; row++) {
    for (column = 0; column < COLUMNS; column++)
      putchar('?');
    putchar('\n');
  }
  return 0;
}
