// Shows what its user does (keys) and what it measures, each on a line of its own: a message stays until the next one.
#include "eyebot.h"

static void show(const char* message) {
    LCDSetPrintf(0, 0, "%-8s", message);
}

int main(void) {
    int step = 0;
    show("ready");
    LCDMenu("GO", "STOP", "", "END");
    for (;;) {
        int key = KEYRead();
        if (key == KEY1) { show("go"); VWSetSpeed(100, 0); }
        if (key == KEY2) { show("stop"); VWSetSpeed(0, 0); }
        if (key == KEY3) show("third");
        if (key == KEY4) return 0;
        LCDSetPrintf(9, 0, "front %d mm, %d ", PSDGet(PSD_FRONT), step++);
        OSWait(50);
    }
}
