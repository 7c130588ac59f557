/* Reads a row of switches and an analogue input, and sets an output. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  printf("switches %d, channel 1: %d\n", OSReadInLatch(0), OSGetAD(1));
  OSWriteOutLatch(0, 0xFF, 0x10);
  printf("output %d\n", OSReadOutLatch(0));
  return 0;
}

/* Prints
 * switches 5, channel 1: 820
 * output 16
 */
