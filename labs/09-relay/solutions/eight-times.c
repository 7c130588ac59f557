/* A mistake: each word is sent eight times instead of being acknowledged. Words arrive, but the receiver cannot recognise the repeats. */
#include <stdio.h>
#include <string.h>
#include "eyebot.h"

static void send(int to, const char *word)
{
  int i;
  for (i = 0; i < 8; i++) {
    RADIOSend(to, word);
    OSWait(50);
  }
}

int main(int argc, char *argv[])
{
  int i, me, sender, silence = 0;
  char word[64], last[64] = "";

  RADIOInit();
  me = RADIOGetID();
  OSWait(100);
  for (i = 1; i < argc; i++)
    send(2, argv[i]);
  while (silence < 5000) {
    if (!RADIOCheck()) {
      OSWait(10);
      silence += 10;
      continue;
    }
    silence = 0;
    RADIOReceive(&sender, word, sizeof word);
    if (sender != me - 1)
      continue;
    if (me == 4)
      printf("%s\n", word);
    else if (strcmp(word, last) != 0)
      send(me + 1, strcpy(last, word));
  }
  RADIORelease();
  return 0;
}
