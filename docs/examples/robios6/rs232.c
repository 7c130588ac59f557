/* Sends text over a serial interface whose output is connected to its input. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  char letter;

  OSInitRS232(SER9600, NONE, SERIAL1);
  OSSendRS232("Hi", SERIAL1);
  OSRecvRS232(&letter, SERIAL1);
  printf("received %c", letter);
  OSRecvRS232(&letter, SERIAL1);
  printf("%c\n", letter);
  return 0;
}

/* Prints
 * received Hi
 */
