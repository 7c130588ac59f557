/* Two robots: the one with the lower number sends, the other one receives. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  BYTE sender, text[MAXMSGLEN];
  int length;

  RADIOInit();
  if (OSMachineID() % 2 == 1) {
    OSWait(10); /* until the other radio is on */
    RADIOSend(BROADCAST, 6, (BYTE *)"hello");
    OSWait(10); /* until the message is out */
  } else {
    RADIORecv(&sender, &length, text);
    printf("%d bytes from robot %d: %s\n", length, sender, (char *)text);
  }
  RADIOTerm();
  return 0;
}

/* Prints
 * 6 bytes from robot 21: hello
 */
