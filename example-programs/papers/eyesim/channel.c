/* Section 5.1: robot 1 sends 4000 messages of 32 bytes. Robot 2 prints how many messages arrive and how many of their bits are wrong. */
#include <stdio.h>
#include <string.h>
#include "eyebot.h"

#define MESSAGES 4000
#define BYTES    32

int main(void)
{
  BYTE sender, message[MAXMSGLEN];
  int arrived = 0, wrong = 0, length, i;

  RADIOInit();
  if (OSMachineID() == 1) {
    memset(message, 0x5a, BYTES);
    for (i = 0; i < MESSAGES; i++)
      while (RADIOSend(2, BYTES, message) != 0)
        OSWait(1);
    OSWait(200);
  } else {
    int last = OSGetCount();
    while (OSGetCount() < last + 300) {
      if (!RADIOCheck()) {
        OSWait(1);
        continue;
      }
      RADIORecv(&sender, &length, message);
      last = OSGetCount();
      arrived++;
      for (i = 0; i < length; i++)
        wrong += __builtin_popcount(message[i] ^ 0x5a);
    }
    printf("%d %d\n", arrived, wrong);
  }
  return 0;
}
