/* Section 6.2: robots send the present time to all others at random instants; each prints how many messages it received, and how many of
   them were sent later than they were received. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "eyebot.h"

int main(void)
{
  BYTE sender, message[MAXMSGLEN];
  int received = 0, future = 0, length, end = 2000;

  RADIOInit();
  while (OSGetCount() < end) {
    int now = OSGetCount(), wait = rand() % 7;
    RADIOSend(BROADCAST, sizeof now, (BYTE *)&now);
    if (wait)
      OSWait(wait);
    while (RADIOCheck()) {
      int sent;
      RADIORecv(&sender, &length, message);
      memcpy(&sent, message, sizeof sent);
      received++;
      future += sent > OSGetCount();
    }
  }
  printf("%d %d\n", received, future);
  return 0;
}
