/* Says what machine this is, and keeps a number in a system variable. */
#include <stdio.h>

#include "eyebot.h"

int main(void)
{
  printf("RoBIOS %s on %s, robot %d\n", OSVersion(), OSMachineName(), OSMachineID());
  OSPutVar(3, 42);
  printf("variable 3 is %d\n", OSGetVar(3));
  return 0;
}

/* Prints
 * RoBIOS 6.5 on Lab, robot 1
 * variable 3 is 42
 */
