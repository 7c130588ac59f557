/* A token goes round a ring of robots over a radio that loses messages: stop-and-wait. Who has the token sends it to the next
   one until that acknowledges it. A token has the number of its hop, so that a repeated one is known as such.
   Arguments: how many robots, how many rounds. */
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"

#define TOKEN    'T'   /* and the number of the hop, 4 bytes, the lowest first */
#define ACK      'A'   /* the same */
#define LENGTH   5
#define TIMEOUT  6     /* 1/100 s without an answer: send again */
#define LINGER   300   /* 1/100 s at the end: the other's last acknowledgement may be lost */

static int me, previous, next;
static int repeats;

static void send(int to, char kind, unsigned hop)
{
  BYTE message[LENGTH] = { kind, hop, hop >> 8, hop >> 16, hop >> 24 };

  while (RADIOSend(to, LENGTH, message) != 0)
    OSWait(1);  /* the buffer is full */
}

static char receive(unsigned *hop)
{
  BYTE sender, message[MAXMSGLEN];
  int length = 0;

  if (RADIORecv(&sender, &length, message) != 0 || length != LENGTH)
    return 0;
  *hop = message[1] | message[2] << 8 | message[3] << 16 | (unsigned)message[4] << 24;
  return message[0];
}

/* Waits for a message, no longer than a time; 0 if none has come. */
static char receive_until(int end, unsigned *hop)
{
  while (!RADIOCheck()) {
    if (OSGetCount() >= end)
      return 0;
    OSWait(1);
  }
  return receive(hop);
}

static void take(unsigned hop)
{
  unsigned number;
  char kind;

  do {
    kind = receive(&number);
    if (kind == TOKEN && number <= hop)
      send(previous, ACK, number);  /* also an old one: its acknowledgement was lost */
  } while (kind != TOKEN || number != hop);
}

static void pass(unsigned hop)
{
  unsigned number;
  char kind;
  int end;

  for (;; repeats++) {
    send(next, TOKEN, hop);
    end = OSGetCount() + TIMEOUT;
    while ((kind = receive_until(end, &number)) != 0) {
      if (kind == ACK && number == hop)
        return;
      if (kind == TOKEN)
        send(previous, ACK, number);
    }
  }
}

int main(int argc, char *argv[])
{
  unsigned robots = argc > 1 ? atoi(argv[1]) : 2, rounds = argc > 2 ? atoi(argv[2]) : 10;
  unsigned round, number;

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

  while (receive_until(OSGetCount() + LINGER, &number) == TOKEN)
    send(previous, ACK, number);
  RADIOTerm();
  return 0;
}
