/* Reads back the position of a servo. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  SERVOSet(1, 200);
  printf("position %d\n", SERVOGet(1));
  return 0;
}

/* Prints
 * position 200
 */
