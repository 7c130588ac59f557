/* Reads the counts of both wheels during a drive. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  ENCODERReset(1);
  ENCODERReset(2);
  VWStraight(300, 200); /* mm, mm/s */
  VWWait();
  printf("left %d, right %d counts\n", ENCODERRead(1), ENCODERRead(2));
  return 0;
}

/* Prints
 * left 1591, right 1591 counts
 */
