/* Lists the distance sensors of the device table. */
#include <stdio.h>

#include "eyebot.h"
#include "hdt.h"

int main(void)
{
  HDT_entry_type entry;
  int index;

  for (index = 0; index < HDT_TypeCount(HDT_PSD); index++)
    if (HDT_FindTable(HDT_PSD, index, &entry) == 0)
      printf("%s\n", entry.device_name);
  return 0;
}

/* Prints
 * PSD_FRONT
 * PSD_LEFT
 * PSD_RIGHT
 * SONAR
 */
