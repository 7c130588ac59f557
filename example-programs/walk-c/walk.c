/* Walks ahead, to the side and on the spot, and prints the posture of its legs. For any robot with legs. */
#include <stdio.h>
#include "eyebot.h"

#define STEP_MM 60
#define PITCH 3 /* joints, from the body to the foot */
#define KNEE 4
#define SHANK 2 /* link */

/* Prints the height of the body, and a line for each leg: angles of hip and knee in degrees, position and height of the knee in mm,
 * and contact of the foot. */
static void show(const char *what)
{
  float height, hip, knee, shank[6];
  int leg;

  LEGGetHeight(&height);
  printf("%s: body at %.1f mm\n", what, height);
  for (leg = 1; leg <= LEGCount(); leg++) {
    LEGGetJoint(leg, PITCH, &hip);
    LEGGetJoint(leg, KNEE, &knee);
    LEGGetLink(leg, SHANK, shank);
    printf("  leg %d: hip %6.2f knee %6.2f, knee %6.1f mm ahead and %5.1f mm high, %s\n", leg, hip, knee, shank[0],
           height + shank[2], LEGGetFoot(leg) ? "on the ground" : "in the air");
  }
}

/* Walks for 3 s, prints the posture every second, stops, and shows the odometry on the display, in mm and degrees. */
static void walk(const char *what, int vx, int vy, int omega)
{
  int i, x, y, phi;

  LEGSetSpeed(vx, vy, omega);
  for (i = 1; i <= 3; i++) {
    OSWait(1000);
    show(what);
  }
  LEGSetSpeed(0, 0, 0);
  OSWait(1000);
  VWGetPosition(&x, &y, &phi);
  LCDPrintf("%s: %d %d %d\n", what, x, y, phi);
}

int main(void)
{
  if (LEGCount() == 0) {
    LCDPrintf("no legs\n");
    return 1;
  }
  show("standing");
  LEGSetStep(STEP_MM);
  walk("ahead", 500, 0, 0);
  walk("aside", 0, 50, 0);
  walk("around", 0, 0, 20);
  show("at the end");
  return 0;
}
