// Tells where its display is touched.
#include "eyebot.h"

int main(void) {
    int x, y;
    for (;;) {
        KEYGetXY(&x, &y);
        LCDPrintf("touched %d %d\n", x, y);
    }
}
