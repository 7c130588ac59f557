/* Section 6.2: robots send the current time to all others at random instants. Each robot prints the number of messages that it received,
   and the number of those with a time of sending later than the time of receipt. */
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
