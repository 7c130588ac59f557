// Waits for a key, on the classic display.
#include "eyebot.h"

int main(void) {
    LCDMenu("GO", "", "", "END");
    for (;;) {
        int key = KEYGet();
        LCDPrintf("key %d\n", key);
        if (key == KEY4) return 0;
    }
}
