/* The classic example of multi-tasking, pre-emptive: the master spawns three tasks. Two of the same priority take turns every 10 ms;
   the third has a higher priority and runs as soon as its sleep is over. The master has the lowest priority and runs when no other
   task is ready. */
#include <stdio.h>
#include "eyebot.h"

#define TASKS  3
#define STEPS  6

static struct sem console;
static int running = TASKS;

static void say(const char *what, int step)
{
  OSSemP(&console);
  printf("task %d: %s %d\n", OSGetUID(0), what, step);
  OSSemV(&console);
}

static void work(void)
{
  int step;

  for (step = 1; step <= STEPS; step++) {
    say("step", step);
    OSWait(1);  /* busy wait: the other task of the same priority gets its turns, the master does not */
  }
  running--;
}

static void watch(void)
{
  int step;

  for (step = 1; step <= STEPS / 2; step++) {
    say("looks", step);
    OSSleep(4);  /* lets the others run */
  }
  running--;
}

int main(void)
{
  struct tcb *task[TASKS];
  int i;

  OSMTInit(PREEMPT);
  OSSemInit(&console, 1);
  task[0] = OSSpawn("worker 1", work, SMALL_STACKSIZE, 3, 1);
  task[1] = OSSpawn("worker 2", work, SMALL_STACKSIZE, 3, 2);
  task[2] = OSSpawn("watcher", watch, SMALL_STACKSIZE, 5, 3);
  for (i = 0; i < TASKS; i++)
    OSReady(task[i]);
  printf("master: ready\n");
  OSPermit();  /* pre-emption begins here */
  while (running > 0)
    OSWait(1);
  printf("master: done\n");
  return 0;
}
