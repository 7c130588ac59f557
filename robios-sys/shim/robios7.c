/* The RoBIOS-7 functions as a program calls them; part of shim.c.
 * Written from the lists of functions and constants of eyesim. */

WEAK int LCDClear(void)
{
    int32_t result = 0;
    ROBIOS(LCDClear, &result);
    return result;
}

WEAK int LCDSetPos(int row, int column)
{
    int32_t result = 0;
    ROBIOS(LCDSetPos, row, column, &result);
    return result;
}

WEAK int LCDGetPos(int *row, int *column)
{
    int32_t result = 0;
    ROBIOS(LCDGetPos, row, column, &result);
    return result;
}

WEAK int LCDSetColor(COLOR fg, COLOR bg)
{
    int32_t result = 0;
    ROBIOS(LCDSetColor, fg, bg, &result);
    return result;
}

WEAK int LCDSetFont(int font, int variation)
{
    int32_t result = 0;
    ROBIOS(LCDSetFont, font, variation, &result);
    return result;
}

WEAK int LCDSetFontSize(int fontsize)
{
    int32_t result = 0;
    ROBIOS(LCDSetFontSize, fontsize, &result);
    return result;
}

WEAK int LCDSetMode(int mode)
{
    int32_t result = 0;
    ROBIOS(LCDSetMode, mode, &result);
    return result;
}

WEAK int LCDMenu(const char *st1, const char *st2, const char *st3, const char *st4)
{
    int32_t result = 0;
    ROBIOS(LCDMenu, text_of(st1), text_of(st2), text_of(st3), text_of(st4), &result);
    return result;
}

WEAK int LCDMenuI(int pos, const char *string, COLOR fg, COLOR bg)
{
    int32_t result = 0;
    ROBIOS(LCDMenuI, pos, text_of(string), fg, bg, &result);
    return result;
}

WEAK int LCDListLine(int line, int key, const char *text, COLOR fg, COLOR bg)
{
    int32_t result = 0;
    ROBIOS(LCDListLine, line, key, text_of(text), fg, bg, &result);
    return result;
}

WEAK int LCDGetSize(int *x, int *y)
{
    int32_t result = 0;
    ROBIOS(LCDGetSize, x, y, &result);
    return result;
}

WEAK int LCDPixel(int x, int y, COLOR col)
{
    int32_t result = 0;
    ROBIOS(LCDPixel, x, y, col, &result);
    return result;
}

WEAK COLOR LCDGetPixel(int x, int y)
{
    int32_t result = 0;
    ROBIOS(LCDGetPixel, x, y, &result);
    return result;
}

WEAK int LCDLine(int x1, int y1, int x2, int y2, COLOR col)
{
    int32_t result = 0;
    ROBIOS(LCDLine, x1, y1, x2, y2, col, &result);
    return result;
}

WEAK int LCDArea(int x1, int y1, int x2, int y2, COLOR col, int fill)
{
    int32_t result = 0;
    ROBIOS(LCDArea, x1, y1, x2, y2, col, fill, &result);
    return result;
}

WEAK int LCDCircle(int x1, int y1, int size, COLOR col, int fill)
{
    int32_t result = 0;
    ROBIOS(LCDCircle, x1, y1, size, col, fill, &result);
    return result;
}

WEAK int LCDPixelInvert(int x, int y)
{
    int32_t result = 0;
    ROBIOS(LCDPixelInvert, x, y, &result);
    return result;
}

WEAK int LCDLineInvert(int x1, int y1, int x2, int y2)
{
    int32_t result = 0;
    ROBIOS(LCDLineInvert, x1, y1, x2, y2, &result);
    return result;
}

WEAK int LCDAreaInvert(int x1, int y1, int x2, int y2)
{
    int32_t result = 0;
    ROBIOS(LCDAreaInvert, x1, y1, x2, y2, &result);
    return result;
}

WEAK int LCDCircleInvert(int x1, int y1, int size)
{
    int32_t result = 0;
    ROBIOS(LCDCircleInvert, x1, y1, size, &result);
    return result;
}

WEAK int LCDRefresh(void)
{
    int32_t result = 0;
    ROBIOS(LCDRefresh, &result);
    return result;
}

WEAK int KEYGet(void)
{
    int32_t result = 0;
    ROBIOS(KEYGet, &result);
    return result;
}

WEAK int KEYRead(void)
{
    int32_t result = 0;
    ROBIOS(KEYRead, &result);
    return result;
}

WEAK int KEYWait(int key)
{
    int32_t result = 0;
    ROBIOS(KEYWait, key, &result);
    return result;
}

WEAK int KEYGetXY(int *x, int *y)
{
    int32_t result = 0;
    ROBIOS(KEYGetXY, x, y, &result);
    return result;
}

WEAK int KEYReadXY(int *x, int *y)
{
    int32_t result = 0;
    ROBIOS(KEYReadXY, x, y, &result);
    return result;
}

WEAK int CAMRelease(void)
{
    int32_t result = 0;
    ROBIOS(CAMRelease, &result);
    return result;
}

WEAK COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b)
{
    int32_t result = 0;
    ROBIOS(IPPRGB2Col, r, g, b, &result);
    return result;
}

WEAK void IPPCol2RGB(COLOR col, BYTE *r, BYTE *g, BYTE *b)
{
    ROBIOS(IPPCol2RGB, col, r, g, b, NULL);
}

WEAK void IPPCol2HSI(COLOR c, BYTE *h, BYTE *s, BYTE *i)
{
    ROBIOS(IPPCol2HSI, c, h, s, i, NULL);
}

WEAK BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b)
{
    uint8_t result = 0;
    ROBIOS(IPPRGB2Hue, r, g, b, &result);
    return result;
}

WEAK void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE *h, BYTE *s, BYTE *i)
{
    ROBIOS(IPPRGB2HSI, r, g, b, h, s, i, NULL);
}

WEAK int OSMachineSpeed(void)
{
    int32_t result = 0;
    ROBIOS(OSMachineSpeed, &result);
    return result;
}

WEAK int OSMachineType(void)
{
    int32_t result = 0;
    ROBIOS(OSMachineType, &result);
    return result;
}

WEAK int OSMachineID(void)
{
    int32_t result = 0;
    ROBIOS(OSMachineID, &result);
    return result;
}

WEAK int OSError(const char *message, int number, int dead)
{
    int32_t result = 0;
    ROBIOS(OSError, text_of(message), number, dead, &result);
    return result;
}

WEAK int OSWait(int n)
{
    int32_t result = 0;
    ROBIOS(OSWait, n, &result);
    return result;
}

WEAK TIMER OSAttachTimer(int scale, TimerFnc fct)
{
    int32_t result = 0;
    ROBIOS(OSAttachTimer, scale, callback_of(fct), &result);
    return result;
}

WEAK int OSDetachTimer(TIMER t)
{
    int32_t result = 0;
    ROBIOS(OSDetachTimer, t, &result);
    return result;
}

WEAK int OSSetTime(int hrs, int mins, int secs)
{
    int32_t result = 0;
    ROBIOS(OSSetTime, hrs, mins, secs, &result);
    return result;
}

WEAK int OSGetTime(int *hrs, int *mins, int *secs, int *ticks)
{
    int32_t result = 0;
    ROBIOS(OSGetTime, hrs, mins, secs, ticks, &result);
    return result;
}

WEAK int OSShowTime(void)
{
    int32_t result = 0;
    ROBIOS(OSShowTime, &result);
    return result;
}

WEAK int OSGetCount(void)
{
    int32_t result = 0;
    ROBIOS(OSGetCount, &result);
    return result;
}

WEAK int SERInit(int interface, int baud, int handshake)
{
    int32_t result = 0;
    ROBIOS(SERInit, interface, baud, handshake, &result);
    return result;
}

WEAK int SERSendChar(int interface, char ch)
{
    int32_t result = 0;
    ROBIOS(SERSendChar, interface, (uint8_t)ch, &result);
    return result;
}

WEAK char SERReceiveChar(int interface)
{
    uint8_t result = 0;
    ROBIOS(SERReceiveChar, interface, &result);
    return result;
}

WEAK bool SERCheck(int interface)
{
    uint8_t result = 0;
    ROBIOS(SERCheck, interface, &result);
    return result;
}

WEAK int SERFlush(int interface)
{
    int32_t result = 0;
    ROBIOS(SERFlush, interface, &result);
    return result;
}

WEAK int SERClose(int interface)
{
    int32_t result = 0;
    ROBIOS(SERClose, interface, &result);
    return result;
}

WEAK int AUBeep(void)
{
    int32_t result = 0;
    ROBIOS(AUBeep, &result);
    return result;
}

WEAK int AUDone(void)
{
    int32_t result = 0;
    ROBIOS(AUDone, &result);
    return result;
}

WEAK int AUMicrophone(void)
{
    int32_t result = 0;
    ROBIOS(AUMicrophone, &result);
    return result;
}

WEAK int AUTone(int freq_hz, int time_ms)
{
    int32_t result = 0;
    ROBIOS(AUTone, freq_hz, time_ms, &result);
    return result;
}

WEAK int AUCheckTone(void)
{
    int32_t result = 0;
    ROBIOS(AUCheckTone, &result);
    return result;
}

WEAK int AUCheckPlay(void)
{
    int32_t result = 0;
    ROBIOS(AUCheckPlay, &result);
    return result;
}

WEAK int AUCheckRecord(void)
{
    int32_t result = 0;
    ROBIOS(AUCheckRecord, &result);
    return result;
}

WEAK int PSDGet(int psd)
{
    int32_t result = 0;
    ROBIOS(PSDGet, psd, &result);
    return result;
}

WEAK int PSDGetRaw(int psd)
{
    int32_t result = 0;
    ROBIOS(PSDGetRaw, psd, &result);
    return result;
}

WEAK int SERVOSet(int servo, int angle)
{
    int32_t result = 0;
    ROBIOS(SERVOSet, servo, angle, &result);
    return result;
}

WEAK int SERVOSetRaw(int servo, int angle)
{
    int32_t result = 0;
    ROBIOS(SERVOSetRaw, servo, angle, &result);
    return result;
}

WEAK int SERVORange(int servo, int low, int high)
{
    int32_t result = 0;
    ROBIOS(SERVORange, servo, low, high, &result);
    return result;
}

WEAK int MOTORDrive(int motor, int speed)
{
    int32_t result = 0;
    ROBIOS(MOTORDrive, motor, speed, &result);
    return result;
}

WEAK int MOTORDriveRaw(int motor, int speed)
{
    int32_t result = 0;
    ROBIOS(MOTORDriveRaw, motor, speed, &result);
    return result;
}

WEAK int MOTORPID(int motor, int p, int i, int d)
{
    int32_t result = 0;
    ROBIOS(MOTORPID, motor, p, i, d, &result);
    return result;
}

WEAK int MOTORPIDOff(int motor)
{
    int32_t result = 0;
    ROBIOS(MOTORPIDOff, motor, &result);
    return result;
}

WEAK int MOTORSpeed(int motor, int ticks)
{
    int32_t result = 0;
    ROBIOS(MOTORSpeed, motor, ticks, &result);
    return result;
}

WEAK int ENCODERRead(int quad)
{
    int32_t result = 0;
    ROBIOS(ENCODERRead, quad, &result);
    return result;
}

WEAK int ENCODERReset(int quad)
{
    int32_t result = 0;
    ROBIOS(ENCODERReset, quad, &result);
    return result;
}

WEAK int VWSetSpeed(int linSpeed, int angSpeed)
{
    int32_t result = 0;
    ROBIOS(VWSetSpeed, linSpeed, angSpeed, &result);
    return result;
}

WEAK int VWGetSpeed(int *linSpeed, int *angSpeed)
{
    int32_t result = 0;
    ROBIOS(VWGetSpeed, linSpeed, angSpeed, &result);
    return result;
}

WEAK int VWSetPosition(int x, int y, int phi)
{
    int32_t result = 0;
    ROBIOS(VWSetPosition, x, y, phi, &result);
    return result;
}

WEAK int VWGetPosition(int *x, int *y, int *phi)
{
    int32_t result = 0;
    ROBIOS(VWGetPosition, x, y, phi, &result);
    return result;
}

WEAK int VWStraight(int dist, int lin_speed)
{
    int32_t result = 0;
    ROBIOS(VWStraight, dist, lin_speed, &result);
    return result;
}

WEAK int VWTurn(int angle, int ang_speed)
{
    int32_t result = 0;
    ROBIOS(VWTurn, angle, ang_speed, &result);
    return result;
}

WEAK int VWCurve(int dist, int angle, int lin_speed)
{
    int32_t result = 0;
    ROBIOS(VWCurve, dist, angle, lin_speed, &result);
    return result;
}

WEAK int VWDrive(int dx, int dy, int lin_speed)
{
    int32_t result = 0;
    ROBIOS(VWDrive, dx, dy, lin_speed, &result);
    return result;
}

WEAK int VWRemain(void)
{
    int32_t result = 0;
    ROBIOS(VWRemain, &result);
    return result;
}

WEAK int VWDone(void)
{
    int32_t result = 0;
    ROBIOS(VWDone, &result);
    return result;
}

WEAK int VWWait(void)
{
    int32_t result = 0;
    ROBIOS(VWWait, &result);
    return result;
}

WEAK int VWStalled(void)
{
    int32_t result = 0;
    ROBIOS(VWStalled, &result);
    return result;
}

WEAK int VWControl(int Vv, int Tv, int Vw, int Tw)
{
    int32_t result = 0;
    ROBIOS(VWControl, Vv, Tv, Vw, Tw, &result);
    return result;
}

WEAK int VWControlOff(void)
{
    int32_t result = 0;
    ROBIOS(VWControlOff, &result);
    return result;
}

WEAK int DIGITALSetup(int io, char direction)
{
    int32_t result = 0;
    ROBIOS(DIGITALSetup, io, (uint8_t)direction, &result);
    return result;
}

WEAK int DIGITALRead(int io)
{
    int32_t result = 0;
    ROBIOS(DIGITALRead, io, &result);
    return result;
}

WEAK int DIGITALReadAll(void)
{
    int32_t result = 0;
    ROBIOS(DIGITALReadAll, &result);
    return result;
}

WEAK int DIGITALWrite(int io, int state)
{
    int32_t result = 0;
    ROBIOS(DIGITALWrite, io, state, &result);
    return result;
}

WEAK int ANALOGRead(int channel)
{
    int32_t result = 0;
    ROBIOS(ANALOGRead, channel, &result);
    return result;
}

WEAK int ANALOGVoltage(void)
{
    int32_t result = 0;
    ROBIOS(ANALOGVoltage, &result);
    return result;
}

WEAK int ANALOGRecord(int channel, int iterations)
{
    int32_t result = 0;
    ROBIOS(ANALOGRecord, channel, iterations, &result);
    return result;
}

WEAK int IRTVGet(void)
{
    int32_t result = 0;
    ROBIOS(IRTVGet, &result);
    return result;
}

WEAK int IRTVRead(void)
{
    int32_t result = 0;
    ROBIOS(IRTVRead, &result);
    return result;
}

WEAK int IRTVFlush(void)
{
    int32_t result = 0;
    ROBIOS(IRTVFlush, &result);
    return result;
}

WEAK int IRTVGetStatus(void)
{
    int32_t result = 0;
    ROBIOS(IRTVGetStatus, &result);
    return result;
}

WEAK int RADIOInit(void)
{
    int32_t result = 0;
    ROBIOS(RADIOInit, &result);
    return result;
}

WEAK int RADIOGetID(void)
{
    int32_t result = 0;
    ROBIOS(RADIOGetID, &result);
    return result;
}

WEAK int RADIOSend(int id, const char *buf)
{
    int32_t result = 0;
    ROBIOS(RADIOSend, id, text_of(buf), &result);
    return result;
}

WEAK int RADIORelease(void)
{
    int32_t result = 0;
    ROBIOS(RADIORelease, &result);
    return result;
}

WEAK void SIMGetRobot(int id, int *x, int *y, int *z, int *phi)
{
    ROBIOS(SIMGetRobot, id, x, y, z, phi, NULL);
}

WEAK void SIMSetRobot(int id, int x, int y, int z, int phi)
{
    ROBIOS(SIMSetRobot, id, x, y, z, phi, NULL);
}

WEAK void SIMGetObject(int id, int *x, int *y, int *z, int *phi)
{
    ROBIOS(SIMGetObject, id, x, y, z, phi, NULL);
}

WEAK void SIMSetObject(int id, int x, int y, int z, int phi)
{
    ROBIOS(SIMSetObject, id, x, y, z, phi, NULL);
}

WEAK int SIMGetRobotCount(void)
{
    int32_t result = 0;
    ROBIOS(SIMGetRobotCount, &result);
    return result;
}

WEAK int SIMGetObjectCount(void)
{
    int32_t result = 0;
    ROBIOS(SIMGetObjectCount, &result);
    return result;
}

WEAK float PSDGetSignal(int psd)
{
    float result = 0;
    ROBIOS(PSDGetSignal, psd, &result);
    return result;
}

WEAK int LEGCount(void)
{
    int32_t result = 0;
    ROBIOS(LEGCount, &result);
    return result;
}

WEAK int LEGSetGait(int gait)
{
    int32_t result = 0;
    ROBIOS(LEGSetGait, gait, &result);
    return result;
}

WEAK int LEGSetSpeed(int vx_mmps, int vy_mmps, int omega_degps)
{
    int32_t result = 0;
    ROBIOS(LEGSetSpeed, vx_mmps, vy_mmps, omega_degps, &result);
    return result;
}

WEAK int LEGSetStep(int height_mm)
{
    int32_t result = 0;
    ROBIOS(LEGSetStep, height_mm, &result);
    return result;
}

WEAK int LEGGetJoint(int leg, int joint, float *degrees)
{
    int32_t result = 0;
    ROBIOS(LEGGetJoint, leg, joint, degrees, &result);
    return result;
}

WEAK int LEGGetHeight(float *mm)
{
    int32_t result = 0;
    ROBIOS(LEGGetHeight, mm, &result);
    return result;
}

WEAK int LEGGetFoot(int leg)
{
    int32_t result = 0;
    ROBIOS(LEGGetFoot, leg, &result);
    return result;
}

WEAK int LEGCorrect(int leg, int dx_mm, int dy_mm, int dz_mm)
{
    int32_t result = 0;
    ROBIOS(LEGCorrect, leg, dx_mm, dy_mm, dz_mm, &result);
    return result;
}

WEAK int SERVOGet(int servo)
{
    int32_t result = 0;
    ROBIOS(SERVOGet, servo, &result);
    return result;
}
