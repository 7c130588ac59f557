/* A metronome: a timer beats, the keys make it slower and faster, the display shows the beats. */
#include "eyebot.h"

#define FASTEST 1    /* limits of the period, hundredths of a second */
#define SLOWEST 400

static volatile int beats;

/* Callback of the timer. It runs inside whatever call the program is making: it must be short and must not wait. */
static void beat(void)
{
  beats++;
  AUTone(beats % 4 == 1 ? 880 : 440, 50);
}

int main(void)
{
  int period = 50;  /* hundredths of a second */
  TimerHandle timer = OSAttachTimer(period, beat);

  LCDMenu("SLOW", "FAST", "", "END");
  for (;;) {
    int key = KEYRead();

    if (key == KEY4)
      break;
    if (key == KEY1 || key == KEY2) {
      int changed = key == KEY1 ? period * 2 : period / 2;

      if (changed >= FASTEST && changed <= SLOWEST)
        period = changed;
      OSDetachTimer(timer);
      timer = OSAttachTimer(period, beat);
    }
    LCDSetPrintf(0, 0, "every %d ms ", period * 10);
    LCDSetPrintf(1, 0, "%d beats", beats);
    OSWait(2);
  }
  OSDetachTimer(timer);
  AUBeep();
  LCDSetPrintf(2, 0, "end");
  return 0;
}
