/* Drives straight, turns, and drives in an arc. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int x, y, phi;

  VWStraight(400, 200); /* mm, mm/s */
  VWWait();
  VWTurn(90, 60); /* degrees, degrees/s */
  VWWait();
  VWCurve(300, -90, 200); /* mm, degrees, mm/s */
  VWWait();
  VWGetPosition(&x, &y, &phi);
  printf("x %d mm, y %d mm, heading %d degrees\n", x, y, phi);
  return 0;
}

/* Prints
 * x 591 mm, y 191 mm, heading 0 degrees
 */
