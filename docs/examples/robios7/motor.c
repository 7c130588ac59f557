/* Drives for a second with both motors at a tenth of their speed. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  MOTORDrive(1, 10); /* percent */
  MOTORDrive(2, 10);
  OSWait(1000);
  MOTORDrive(1, 0);
  MOTORDrive(2, 0);
  printf("no such motor: %d\n", MOTORDrive(5, 10));
  return 0;
}

/* Prints
 * no such motor: 1
 */
