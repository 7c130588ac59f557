/* Scans all around and looks for the nearest wall. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int distances[360], point, nearest = 0;

  LIDARGet(distances);
  for (point = 0; point < 360; point++)
    if (distances[point] < distances[nearest])
      nearest = point;
  printf("ahead %d mm; nearest %d mm at point %d\n", distances[180], distances[nearest], nearest);
  return 0;
}

/* Prints
 * ahead 1400 mm; nearest 600 mm at point 0
 */
