/* Reads the compass: the robot looks to the east. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  COMPASSInit(COMPASS);
  COMPASSStart(FALSE);
  while (!COMPASSCheck())
    OSWait(1);
  printf("%d degrees\n", COMPASSGet());
  COMPASSRelease();
  return 0;
}

/* Prints
 * 90 degrees
 */
