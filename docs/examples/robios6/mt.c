/* Two tasks wait for each other with semaphores. */
#include <stdio.h>

#include "eyebot.h"

static struct sem ping, pong;

static void answer(void)
{
  int round;

  for (round = 0; round < 2; round++) {
    OSSemP(&ping);
    printf("pong\n");
    OSSemV(&pong);
  }
}

int main(void)
{
  int round;

  OSSemInit(&ping, 0);
  OSSemInit(&pong, 0);
  OSMTInit(COOP);
  OSReady(OSSpawn("answer", answer, DEFAULT_STACKSIZE, MIN_PRI, 1));
  for (round = 0; round < 2; round++) {
    printf("ping\n");
    OSSemV(&ping);
    OSSemP(&pong);
  }
  return 0;
}

/* Prints
 * ping
 * pong
 * ping
 * pong
 */
