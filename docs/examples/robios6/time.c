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
  TimerHandle timer = OSAttachTimer(10, count); /* every 0.1 s */

  OSWait(105); /* 1.05 s */
  OSDetachTimer(timer);
  printf("%d ticks in %d ms\n", ticks, OSGetCount() * 10);
  return 0;
}

/* Prints
 * 10 ticks in 1050 ms
 */
