/* One of four robots whose traces accuracy/peers/noise.py reads: reads a PSD, drives straight ahead, sends or receives messages. */
#include "eyebot.h"
#include <string.h>

static int read_distances(void)
{
    PSDHandle psd = PSDInit(PSD_FRONT);
    PSDStart(psd, TRUE);
    for (;;) {
        OSWait(6);
        PSDGet(psd);
    }
}

static int drive(void)
{
    VWHandle vw = VWInit(VW_DRIVE, 1);
    PositionType position;
    VWSetSpeed(vw, 0.3, 0);
    for (;;) {
        OSWait(5);
        VWGetPosition(vw, &position);
    }
}

static int send(void)
{
    BYTE message[MAXMSGLEN];
    memset(message, 0x5a, sizeof message);
    RADIOInit();
    for (;;) {
        OSWait(5);
        RADIOSend(4, sizeof message, message);
    }
}

static int receive(void)
{
    BYTE message[MAXMSGLEN], sender;
    int length;
    RADIOInit();
    for (;;)
        RADIORecv(&sender, &length, message);
}

int main(void)
{
    switch (OSMachineID()) {
    case 1: return read_distances();
    case 2: return drive();
    case 3: return send();
    default: return receive();
    }
}
