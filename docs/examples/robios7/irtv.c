/* Waits for a key of the remote control. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  int key = IRTVGet();

  printf("code %d%s\n", key, key == IRTV_OK ? ", the key OK" : "");
  return 0;
}

/* Prints
 * code 79, the key OK
 */
