/* Looks for a key of the remote control, without waiting: nobody presses one. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  printf("receiver: %d\n", IRTVInitHDT(IRTV));
  printf("code %d\n", IRTVRead());
  IRTVTerm();
  return 0;
}

/* Prints
 * receiver: 0
 * code 0
 */
