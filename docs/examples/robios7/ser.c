/* Sends text over a serial interface whose output is connected to its input. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  unsigned char text[256];

  SERInit(1, 9600, 0); /* interface, baud, no handshake */
  SERSend(1, "Hi", 2);
  OSWait(10);
  printf("received %d bytes: ", SERReceive(1, text));
  printf("%s\n", (char *)text);
  SERClose(1);
  return 0;
}

/* Prints
 * received 2 bytes: Hi
 */
