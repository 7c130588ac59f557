/* The classic example of multi-tasking, cooperative: the master spawns three tasks; each runs until it calls OSReschedule, which lets
   the next one run. When all have ended, the master continues. */
#include <stdio.h>
#include "eyebot.h"

#define TASKS  3
#define STEPS  4

static int sum;  /* needs no semaphore: tasks switch only at OSReschedule */

static void work(void)
{
  int step, uid = OSGetUID(0);

  for (step = 1; step <= STEPS; step++) {
    sum += uid;
    printf("task %d: step %d, sum %d\n", uid, step, sum);
    OSWait(uid);  /* keeps the processor */
    OSReschedule();
  }
  printf("task %d: done\n", uid);
}

int main(void)
{
  static const int priorities[TASKS] = { 4, 4, 2 };
  static const char *const names[TASKS] = { "first", "second", "third" };
  struct tcb *task[TASKS];
  int i;

  OSMTInit(COOP);
  for (i = 0; i < TASKS; i++) {
    task[i] = OSSpawn(names[i], work, SMALL_STACKSIZE, priorities[i], i + 1);
    OSReady(task[i]);
  }
  printf("master: ready\n");
  OSReschedule();
  printf("master: done, sum %d\n", sum);
  return 0;
}
