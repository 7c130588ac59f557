/* Passes five words from robot 1 to robot 4 over a radio that reaches the next robot only and loses messages: stop-and-wait.
 *
 * A word is sent with its number until the next robot acknowledges this number. The receiver recognises a repeated word by its number.
 * Messages: `3 word` is word 3, `ack 3` acknowledges it. Each robot takes all words before it passes them on. */
#include <stdio.h>
#include <string.h>
#include "eyebot.h"

#define ROBOTS  4
#define WORDS   5
#define LENGTH  32
#define TIMEOUT 100   /* ms without an acknowledgement until a word is sent again */
#define LINGER  3000  /* ms of silence at the end, since the last acknowledgement may be lost */

static int me;
static char words[WORDS + 1][LENGTH];
static int taken, acknowledged; /* numbers of the last word received, and of the last word that the next robot has acknowledged */

/* Waits for a message and handles it. Returns 0 if none arrives in time. */
static int handle(int timeout)
{
  int sender, number, end = OSGetCount() + timeout;
  char text[64], word[LENGTH];

  while (!RADIOCheck()) {
    if (OSGetCount() >= end)
      return 0;
    OSWait(5);
  }
  RADIOReceive(&sender, text, sizeof text);
  if (sscanf(text, "ack %d", &number) == 1 && sender == me + 1) {
    if (number == acknowledged + 1)
      acknowledged = number;
  } else if (sscanf(text, "%d %31s", &number, word) == 2 && sender == me - 1) {
    if (number == taken + 1) {
      taken = number;
      strcpy(words[taken], word);
      if (me == ROBOTS)
        printf("%s\n", word);
    }
    sprintf(text, "ack %d", number); /* also for a repeated word, whose first acknowledgement was lost */
    RADIOSend(me - 1, text);
  }
  return 1;
}

static void pass_on(int number)
{
  char text[64];
  sprintf(text, "%d %s", number, words[number]);
  while (acknowledged < number) {
    RADIOSend(me + 1, text);
    while (acknowledged < number && handle(TIMEOUT))
      ;
  }
}

int main(int argc, char *argv[])
{
  int number;

  RADIOInit();
  me = RADIOGetID();
  OSWait(100); /* wait until all radios are on */
  if (me == 1)
    for (number = 1; number <= WORDS && number < argc; number++)
      snprintf(words[taken = number], LENGTH, "%s", argv[number]);
  while (taken < WORDS)
    handle(TIMEOUT);
  if (me < ROBOTS)
    for (number = 1; number <= WORDS; number++)
      pass_on(number);
  while (handle(LINGER))
    ;
  RADIORelease();
  return 0;
}
