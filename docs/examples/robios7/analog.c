/* Reads an analog input and the battery, and records ten values. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  BYTE values[10];
  int count;

  printf("channel 1: %d, battery %d\n", ANALOGRead(1), ANALOGVoltage());
  ANALOGRecord(1, 10); /* 10 ms at 1 kHz */
  OSWait(20);
  count = ANALOGTransfer(values);
  printf("%d bytes, the first is %d\n", count, values[0]);
  return 0;
}

/* Prints
 * channel 1: 820, battery 720
 * 10 bytes, the first is 205
 */
