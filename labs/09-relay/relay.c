/* Passes words from robot 1 to robot 4: complete it. The same program runs on each of the four robots. */
#include <stdio.h>
#include "eyebot.h"

int main(int argc, char *argv[])
{
  int me, i;

  RADIOInit();
  me = RADIOGetID();
  for (i = 1; i < argc; i++)
    printf("robot %d knows %s\n", me, argv[i]);
  RADIORelease();
  return 0;
}
