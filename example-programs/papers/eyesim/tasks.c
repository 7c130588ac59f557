/* Section 7: pre-emptive tasks count under a semaphore, and each yields in the middle of a count; another task is suspended, readied and
   killed. Prints the counts. The argument `loose` leaves out the semaphore. */
#include <stdio.h>
#include <string.h>
#include "eyebot.h"

#define TASKS  4
#define COUNTS 50

static struct sem access_count;
static int is_loose, count, running = TASKS, turns;

static void work(void)
{
  int i, read;

  for (i = 0; i < COUNTS; i++) {
    if (!is_loose)
      OSSemP(&access_count);
    read = count;
    OSWait(1);
    count = read + 1;
    if (!is_loose)
      OSSemV(&access_count);
  }
  running--;
  OSKill(0);
}

static void turn(void)
{
  for (;;) {
    turns++;
    OSSleep(1);
  }
}

int main(int argc, char *argv[])
{
  struct tcb *turner, *task[TASKS];
  int i, while_suspended, after_kill;

  is_loose = argc > 1 && strcmp(argv[1], "loose") == 0;
  OSMTInit(PREEMPT);
  OSSemInit(&access_count, 1);
  for (i = 0; i < TASKS; i++)
    OSReady(task[i] = OSSpawn("work", work, DEFAULT_STACKSIZE, 4, i + 1));
  OSReady(turner = OSSpawn("turn", turn, DEFAULT_STACKSIZE, 4, 9));
  OSPermit();
  OSSleep(50);
  OSSuspend(turner);
  while_suspended = turns;
  OSSleep(50);
  while_suspended = turns - while_suspended;
  OSReady(turner);
  OSSleep(50);
  OSKill(turner);
  after_kill = turns;
  OSSleep(50);
  after_kill = turns - after_kill;
  while (running)
    OSSleep(10);
  printf("%d %d %d %d\n", count, turns, while_suspended, after_kill);
  return 0;
}
