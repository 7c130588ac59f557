// Shows what its user does: keys, distance, drive.
#include "eyebot.h"

int main(void) {
    int step = 0;
    LCDPrintf("ready\n");
    LCDMenu("GO", "STOP", "", "END");
    for (;;) {
        int key = KEYRead();
        if (key == KEY1) { LCDPrintf("go\n"); VWSetSpeed(100, 0); }
        if (key == KEY2) { LCDPrintf("stop\n"); VWSetSpeed(0, 0); }
        if (key == KEY3) LCDPrintf("third\n");
        if (key == KEY4) return 0;
        LCDSetPrintf(9, 0, "front %d mm, %d ", PSDGet(PSD_FRONT), step++);
        OSWait(50);
    }
}
