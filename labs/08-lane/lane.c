/* Drives in the right lane of a road: complete it. */
#include "eyebot.h"

static BYTE image[QQVGA_PIXELS];

int main(void)
{
  CAMInit(QQVGA);
  SERVOSet(2, 113); /* tilts the camera down by 10 degrees */
  OSWait(500);
  CAMGetGray(image);
  LCDImageGray(image);
  VWSetSpeed(100, 0);
  OSWait(2000);
  VWSetSpeed(0, 0);
  return 0;
}
