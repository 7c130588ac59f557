/* Two robots: the one with the odd number sends, the other one receives. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  char text[100];
  int sender;

  RADIOInit();
  if (RADIOGetID() % 2 == 1) {
    OSWait(100); /* until the other radio is on */
    RADIOSend(0, "hello");
    OSWait(100); /* until the message is out */
  } else {
    RADIOReceive(&sender, text, sizeof text);
    printf("from robot %d: %s\n", sender, text);
  }
  RADIORelease();
  return 0;
}

/* Prints
 * from robot 17: hello
 */
