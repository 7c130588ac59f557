/* Walks straight ahead on legs over the terrain, and prints the height of the body every second. */
#include "eyebot.h"
#include <stdio.h>

#define SPEED 300       /* mm/s */
#define SECONDS 34

int main(void)
{
  float height_mm;
  int second;

  LEGSetSpeed(SPEED, 0, 0);
  for (second = 0; second < SECONDS; second++) {
    OSWait(1000);
    LEGGetHeight(&height_mm);
    printf("%d s: %.0f mm\n", second + 1, height_mm);
  }
  LEGSetSpeed(0, 0, 0);
  OSWait(5000);
  return 0;
}
