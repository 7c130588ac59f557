/* Turns a sonar on a servo from the right to the left and prints each echo: direction, distance, energy. */
#include "eyebot.h"
#include <stdio.h>

#define SONAR 5         /* number of the sonar in the robot's companion */
#define STEP 14         /* positions of the servo between two directions */
#define TO_EITHER_SIDE 9

int main(void)
{
  ServoHandle servo = SERVOInit(SERVO1);
  PSDHandle sonar = PSDInit(SONAR);
  int direction, steps, distance;

  if (!servo || !sonar)
    return OSError("no sonar on a servo", 1, TRUE);

  for (direction = -TO_EITHER_SIDE; direction <= TO_EITHER_SIDE; direction++) {
    steps = STEP * direction;
    /* the middle is two positions wide: 127 and 128 */
    SERVOSet(servo, steps > 0 ? 128 + steps : 127 + steps);
    PSDStart(sonar, FALSE);
    while (!PSDCheck())
      OSWait(1);
    distance = PSDGet(sonar);
    if (distance == PSD_OUT_OF_RANGE)
      printf("%.1f degrees: no echo\n", steps * 90.0 / 127);
    else
      printf("%.1f degrees: %d mm, energy %.4f\n", steps * 90.0 / 127, distance, PSDGetSignal(sonar));
  }
  PSDRelease();
  SERVORelease(servo);
  return 0;
}
