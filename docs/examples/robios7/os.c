/* A timer counts while the program waits. */
#include <stdio.h>

#include "eyebot.h"

static int ticks;

static void count(void)
{
  ticks++;
}

int main(void)
{
  TIMER timer = OSAttachTimer(100, count); /* every 100 ms */

  OSWait(1050);
  OSDetachTimer(timer);
  printf("robot %d: %d ticks in %d ms\n", OSMachineID(), ticks, OSGetCount());
  return 0;
}

/* Prints
 * robot 5: 10 ticks in 1050 ms
 */
