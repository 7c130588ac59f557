/* Swings an arm with three range sensors from the floor upwards over a step, and prints their readings.
   Sensors and sweep are those of France et al. (1999): the laser detects nothing beyond an incidence angle of 45 degrees and
   then reads 2 m, the ultrasonic sensor detects only the face of the step, the reflectance sensor reads too far at oblique
   incidence. */
#include "eyebot.h"
#include <stdio.h>

#define LASER 2         /* numbers in the robot's companion */
#define ULTRASONIC 3
#define REFLECTANCE 4
#define POSITION 12     /* positions of the servo between two readings */

int main(void)
{
  int position;

  printf("position laser ultrasonic reflectance signal\n");
  for (position = 0; position <= 255; position += POSITION) {
    SERVOSet(2, position);
    printf("%d %d %d %d %.3f\n", position, PSDGet(LASER), PSDGet(ULTRASONIC), PSDGet(REFLECTANCE),
           PSDGetSignal(REFLECTANCE));
  }
  return 0;
}
