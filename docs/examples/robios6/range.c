/* Reads the sonar's echo, and scans with the laser scanner. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int distances[360], points;
  PSDHandle sonar = PSDInit(4); /* the id of the sensor in the companion */

  PSDStart(sonar, FALSE);
  OSWait(10);
  printf("sonar %d mm, echo %.3f\n", PSDGet(sonar), PSDGetSignal(sonar));
  points = LIDARScan(distances, 360);
  printf("%d points, ahead %d mm\n", points, distances[points / 2]);
  return 0;
}

/* Prints
 * sonar 1300 mm, echo 0.592
 * 360 points, ahead 1400 mm
 */
