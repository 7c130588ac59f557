/* Sections 5 and 6.1: reads one PSD 3000 times. With an argument it computes between the calls, which costs no virtual time. */
#include "eyebot.h"

int main(int argc, char *argv[])
{
  PSDHandle psd = PSDInit(PSD_FRONT);
  volatile int sum = 0;
  int i, k;

  (void)argv;
  PSDStart(psd, TRUE);
  OSWait(10);
  for (i = 0; i < 3000; i++) {
    PSDGet(psd);
    if (argc == 1)
      OSWait(6);
    else
      for (k = 0; k < 100 * (i % 7); k++)
        sum += k;
  }
  return 0;
}
