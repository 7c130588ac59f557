/* A token goes round a ring of robots over a radio that loses messages: stop-and-wait. The holder sends the token to the next robot
   until that robot acknowledges it. A token carries the number of its hop, so receivers recognise duplicates.
   Arguments: number of robots, at least 2, and number of rounds. */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define TOKEN    'T'   /* followed by the number of the hop, 4 bytes, the lowest first */
#define ACK      'A'   /* the same */
#define LENGTH   5
#define TIMEOUT  6     /* 1/100 s without an answer until a message is sent again */
#define LINGER   300   /* 1/100 s of silence before the end: until then it answers, since the last acknowledgement may be lost */

static int me, previous, next;
static unsigned taken;  /* number of the last hop received here */
static int repeats;

static void send(int to, char kind, unsigned hop)
{
  BYTE message[LENGTH] = { kind, hop, hop >> 8, hop >> 16, hop >> 24 };

  while (RADIOSend(to, LENGTH, message) != 0)
    OSWait(1);  /* the buffer is full */
}

/* Waits for a message and takes the token if it is one. Returns the hop of an acknowledgement, else 0. */
static unsigned receive(void)
{
  BYTE sender, message[MAXMSGLEN];
  unsigned hop;
  int length = 0;

  if (RADIORecv(&sender, &length, message) != 0 || length != LENGTH)
    return 0;
  hop = message[1] | message[2] << 8 | message[3] << 16 | (unsigned)message[4] << 24;
  if (message[0] == ACK)
    return hop;
  if (message[0] != TOKEN)
    return 0;
  send(previous, ACK, hop);  /* also for a duplicate, whose acknowledgement was lost */
  if (hop > taken)
    taken = hop;
  return 0;
}

/* Returns TRUE if a message arrives before the time `end`. */
static int is_message(int end)
{
  while (!RADIOCheck()) {
    if (OSGetCount() >= end)
      return FALSE;
    OSWait(1);
  }
  return TRUE;
}

static void take(unsigned hop)
{
  while (taken < hop)
    receive();
}

static void pass(unsigned hop)
{
  int end;

  for (;; repeats++) {
    send(next, TOKEN, hop);
    end = OSGetCount() + TIMEOUT;
    while (is_message(end))
      if (receive() == hop || taken > hop)  /* the token may return before our own transmission is acknowledged */
        return;
  }
}

int main(int argc, char *argv[])
{
  int robots = argc > 1 ? atoi(argv[1]) : 2;
  unsigned rounds = argc > 2 ? atoi(argv[2]) : 10;
  unsigned round;

  if (robots < 2) {
    fprintf(stderr, "`%s` robots: expected a number of at least 2\n", argv[1]);
    return 1;
  }
  me = OSMachineID();
  next = me % robots + 1;
  previous = (me + robots - 2) % robots + 1;
  RADIOInit();
  for (round = 0; round < rounds; round++) {
    if (me == 1) {
      pass(round * robots + 1);
      take((round + 1) * robots);
    } else {
      take(round * robots + me - 1);
      pass(round * robots + me);
    }
  }
  printf("%u rounds, %d repeats\n", rounds, repeats);

  while (is_message(OSGetCount() + LINGER))
    receive();
  RADIOTerm();
  return 0;
}
