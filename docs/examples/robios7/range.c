/* Reads a sonar's distance and the energy of its echo. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  printf("sonar %d mm, echo %.3f\n", PSDGet(4), PSDGetSignal(4)); /* 4: the id in the companion */
  return 0;
}

/* Prints
 * sonar 1300 mm, echo 0.592
 */
