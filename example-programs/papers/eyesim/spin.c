/* Section 4.1: turns on the spot and reads all PSDs. */
#include "eyebot.h"

int main(void)
{
  static const DeviceSemantics names[] = { PSD_FRONT, PSD_LEFT, PSD_RIGHT, PSD_BACK };
  VWHandle vw = VWInit(VW_DRIVE, 1);
  PSDHandle psd[4];
  int i, k;

  for (k = 0; k < 4; k++)
    psd[k] = PSDInit(names[k]);
  PSDStart(psd[0] | psd[1] | psd[2] | psd[3], TRUE);
  VWSetSpeed(vw, 0, 0.5);
  OSWait(20);
  for (i = 0; i < 300; i++) {
    for (k = 0; k < 4; k++)
      PSDGet(psd[k]);
    OSWait(6);
  }
  return 0;
}
