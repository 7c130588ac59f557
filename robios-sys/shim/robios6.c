/* The RoBIOS 6 functions as a program calls them; part of shim.c.
 * Written from the lists of functions and constants of eyesim. */

WEAK int OSError(const char *message, int number, BOOL dead)
{
    int32_t result = 0;
    ROBIOS(OSError, text_of(message), number, dead, &result);
    return result;
}

WEAK int OSMachineType(void)
{
    int32_t result = 0;
    ROBIOS(OSMachineType, &result);
    return result;
}

WEAK int OSMachineSpeed(void)
{
    int32_t result = 0;
    ROBIOS(OSMachineSpeed, &result);
    return result;
}

WEAK BYTE OSMachineID(void)
{
    uint8_t result = 0;
    ROBIOS(OSMachineID, &result);
    return result;
}

WEAK int OSEnable(void)
{
    int32_t result = 0;
    ROBIOS(OSEnable, &result);
    return result;
}

WEAK int OSDisable(void)
{
    int32_t result = 0;
    ROBIOS(OSDisable, &result);
    return result;
}

WEAK int OSGetVar(int num)
{
    int32_t result = 0;
    ROBIOS(OSGetVar, num, &result);
    return result;
}

WEAK int OSPutVar(int num, int value)
{
    int32_t result = 0;
    ROBIOS(OSPutVar, num, value, &result);
    return result;
}

WEAK int HDT_Validate(void)
{
    int32_t result = 0;
    ROBIOS(HDT_Validate, &result);
    return result;
}

WEAK int HDT_FindTable(TypeID type_id, int index, HDT_entry_type *entry)
{
    int32_t result = 0;
    ROBIOS(HDT_FindTable, type_id, index, entry, &result);
    return result;
}

WEAK int HDT_TypeCount(TypeID type_id)
{
    int32_t result = 0;
    ROBIOS(HDT_TypeCount, type_id, &result);
    return result;
}

WEAK int LCDClear(void)
{
    int32_t result = 0;
    ROBIOS(LCDClear, &result);
    return result;
}

WEAK int LCDPutChar(char c)
{
    int32_t result = 0;
    ROBIOS(LCDPutChar, (uint8_t)c, &result);
    return result;
}

WEAK int LCDSetChar(int row, int column, char c)
{
    int32_t result = 0;
    ROBIOS(LCDSetChar, row, column, (uint8_t)c, &result);
    return result;
}

WEAK int LCDPutString(const char *s)
{
    int32_t result = 0;
    ROBIOS(LCDPutString, text_of(s), &result);
    return result;
}

WEAK int LCDSetString(int row, int column, const char *s)
{
    int32_t result = 0;
    ROBIOS(LCDSetString, row, column, text_of(s), &result);
    return result;
}

WEAK int LCDPutHex(int v)
{
    int32_t result = 0;
    ROBIOS(LCDPutHex, v, &result);
    return result;
}

WEAK int LCDPutHex1(int v)
{
    int32_t result = 0;
    ROBIOS(LCDPutHex1, v, &result);
    return result;
}

WEAK int LCDPutInt(int v)
{
    int32_t result = 0;
    ROBIOS(LCDPutInt, v, &result);
    return result;
}

WEAK int LCDPutIntS(int v, int spaces)
{
    int32_t result = 0;
    ROBIOS(LCDPutIntS, v, spaces, &result);
    return result;
}

WEAK int LCDPutFloat(float v)
{
    int32_t result = 0;
    ROBIOS(LCDPutFloat, v, &result);
    return result;
}

WEAK int LCDPutFloatS(float v, int spaces, int decimals)
{
    int32_t result = 0;
    ROBIOS(LCDPutFloatS, v, spaces, decimals, &result);
    return result;
}

WEAK int LCDMode(int mode)
{
    int32_t result = 0;
    ROBIOS(LCDMode, mode, &result);
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

WEAK int LCDPutGraphic(image *buf)
{
    int32_t result = 0;
    ROBIOS(LCDPutGraphic, buf, &result);
    return result;
}

WEAK int LCDPutColorGraphic(colimage *buf)
{
    int32_t result = 0;
    ROBIOS(LCDPutColorGraphic, buf, &result);
    return result;
}

WEAK int LCDPutImage(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(LCDPutImage, buf, &result);
    return result;
}

WEAK int LCDMenu(const char *s1, const char *s2, const char *s3, const char *s4)
{
    int32_t result = 0;
    ROBIOS(LCDMenu, text_of(s1), text_of(s2), text_of(s3), text_of(s4), &result);
    return result;
}

WEAK int LCDMenuI(int pos, const char *s)
{
    int32_t result = 0;
    ROBIOS(LCDMenuI, pos, text_of(s), &result);
    return result;
}

WEAK int LCDSetPixel(int row, int col, int val)
{
    int32_t result = 0;
    ROBIOS(LCDSetPixel, row, col, val, &result);
    return result;
}

WEAK int LCDInvertPixel(int row, int col)
{
    int32_t result = 0;
    ROBIOS(LCDInvertPixel, row, col, &result);
    return result;
}

WEAK int LCDGetPixel(int row, int col)
{
    int32_t result = 0;
    ROBIOS(LCDGetPixel, row, col, &result);
    return result;
}

WEAK int LCDLine(int x1, int y1, int x2, int y2, int col)
{
    int32_t result = 0;
    ROBIOS(LCDLine, x1, y1, x2, y2, col, &result);
    return result;
}

WEAK int LCDArea(int x1, int y1, int x2, int y2, int col)
{
    int32_t result = 0;
    ROBIOS(LCDArea, x1, y1, x2, y2, col, &result);
    return result;
}

WEAK int KEYGetBuf(char *buf)
{
    int32_t result = 0;
    ROBIOS(KEYGetBuf, buf, &result);
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

WEAK int KEYWait(int excode)
{
    int32_t result = 0;
    ROBIOS(KEYWait, excode, &result);
    return result;
}

WEAK int CAMInit(int mode)
{
    int32_t result = 0;
    ROBIOS(CAMInit, mode, &result);
    return result;
}

WEAK int CAMRelease(void)
{
    int32_t result = 0;
    ROBIOS(CAMRelease, &result);
    return result;
}

WEAK int CAMGetFrame(image *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGetFrame, buf, &result);
    return result;
}

WEAK int CAMGetFrameMono(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGetFrameMono, buf, &result);
    return result;
}

WEAK int CAMGetFrameColor(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGetFrameColor, buf, &result);
    return result;
}

WEAK int CAMGetFrameRGB(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGetFrameRGB, buf, &result);
    return result;
}

WEAK int CAMGetFrameBayer(BYTE *buf)
{
    int32_t result = 0;
    ROBIOS(CAMGetFrameBayer, buf, &result);
    return result;
}

WEAK int CAMSet(int p1, int p2, int p3)
{
    int32_t result = 0;
    ROBIOS(CAMSet, p1, p2, p3, &result);
    return result;
}

WEAK int CAMGet(int *p1, int *p2, int *p3)
{
    int32_t result = 0;
    ROBIOS(CAMGet, p1, p2, p3, &result);
    return result;
}

WEAK int CAMMode(int mode)
{
    int32_t result = 0;
    ROBIOS(CAMMode, mode, &result);
    return result;
}

WEAK int IPLaplace(image *src, image *dest)
{
    int32_t result = 0;
    ROBIOS(IPLaplace, src, dest, &result);
    return result;
}

WEAK int IPSobel(image *src, image *dest)
{
    int32_t result = 0;
    ROBIOS(IPSobel, src, dest, &result);
    return result;
}

WEAK int IPDither(image *src, image *dest)
{
    int32_t result = 0;
    ROBIOS(IPDither, src, dest, &result);
    return result;
}

WEAK int IPDiffer(image *current, image *last, image *dest)
{
    int32_t result = 0;
    ROBIOS(IPDiffer, current, last, dest, &result);
    return result;
}

WEAK int IPColor2Grey(colimage *src, image *dest)
{
    int32_t result = 0;
    ROBIOS(IPColor2Grey, src, dest, &result);
    return result;
}

WEAK int OSMTStatus(void)
{
    int32_t result = 0;
    ROBIOS(OSMTStatus, &result);
    return result;
}

WEAK int OSReady(struct tcb *thread)
{
    int32_t result = 0;
    ROBIOS(OSReady, task_of(thread), &result);
    return result;
}

WEAK int OSSuspend(struct tcb *thread)
{
    int32_t result = 0;
    ROBIOS(OSSuspend, task_of(thread), &result);
    return result;
}

WEAK int OSReschedule(void)
{
    int32_t result = 0;
    ROBIOS(OSReschedule, &result);
    return result;
}

WEAK int OSYield(void)
{
    int32_t result = 0;
    ROBIOS(OSYield, &result);
    return result;
}

WEAK int OSRun(struct tcb *thread)
{
    int32_t result = 0;
    ROBIOS(OSRun, task_of(thread), &result);
    return result;
}

WEAK int OSGetUID(struct tcb *thread)
{
    int32_t result = 0;
    ROBIOS(OSGetUID, task_of(thread), &result);
    return result;
}

WEAK int OSSleep(int n)
{
    int32_t result = 0;
    ROBIOS(OSSleep, n, &result);
    return result;
}

WEAK int OSForbid(void)
{
    int32_t result = 0;
    ROBIOS(OSForbid, &result);
    return result;
}

WEAK int OSPermit(void)
{
    int32_t result = 0;
    ROBIOS(OSPermit, &result);
    return result;
}

WEAK int OSSetTime(int h, int m, int s)
{
    int32_t result = 0;
    ROBIOS(OSSetTime, h, m, s, &result);
    return result;
}

WEAK int OSGetTime(int *h, int *m, int *s, int *ticks)
{
    int32_t result = 0;
    ROBIOS(OSGetTime, h, m, s, ticks, &result);
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

WEAK int OSWait(int n)
{
    int32_t result = 0;
    ROBIOS(OSWait, n, &result);
    return result;
}

WEAK TimerHandle OSAttachTimer(int scale, TimerFnc f)
{
    int32_t result = 0;
    ROBIOS(OSAttachTimer, scale, callback_of(f), &result);
    return result;
}

WEAK int OSDetachTimer(TimerHandle handle)
{
    int32_t result = 0;
    ROBIOS(OSDetachTimer, handle, &result);
    return result;
}

WEAK int OSInitRS232(int baud, int handshake, int interface)
{
    int32_t result = 0;
    ROBIOS(OSInitRS232, baud, handshake, interface, &result);
    return result;
}

WEAK int OSSendCharRS232(char chr, int interface)
{
    int32_t result = 0;
    ROBIOS(OSSendCharRS232, (uint8_t)chr, interface, &result);
    return result;
}

WEAK int OSSendRS232(const char *s, int interface)
{
    int32_t result = 0;
    ROBIOS(OSSendRS232, text_of(s), interface, &result);
    return result;
}

WEAK int OSRecvRS232(char *buf, int interface)
{
    int32_t result = 0;
    ROBIOS(OSRecvRS232, buf, interface, &result);
    return result;
}

WEAK int OSFlushInRS232(int interface)
{
    int32_t result = 0;
    ROBIOS(OSFlushInRS232, interface, &result);
    return result;
}

WEAK int OSFlushOutRS232(int interface)
{
    int32_t result = 0;
    ROBIOS(OSFlushOutRS232, interface, &result);
    return result;
}

WEAK int OSCheckInRS232(int interface)
{
    int32_t result = 0;
    ROBIOS(OSCheckInRS232, interface, &result);
    return result;
}

WEAK int OSCheckOutRS232(int interface)
{
    int32_t result = 0;
    ROBIOS(OSCheckOutRS232, interface, &result);
    return result;
}

WEAK int OSDownload(char *name, int *bytes, int baud, int handshake, int interface)
{
    int32_t result = 0;
    ROBIOS(OSDownload, name, bytes, baud, handshake, interface, &result);
    return result;
}

WEAK int USRStart(void)
{
    int32_t result = 0;
    ROBIOS(USRStart, &result);
    return result;
}

WEAK int USRResident(const char *name, BOOL mode)
{
    int32_t result = 0;
    ROBIOS(USRResident, text_of(name), mode, &result);
    return result;
}

WEAK int AUCheckSample(void)
{
    int32_t result = 0;
    ROBIOS(AUCheckSample, &result);
    return result;
}

WEAK int AUTone(int freq_hz, int span_ms)
{
    int32_t result = 0;
    ROBIOS(AUTone, freq_hz, span_ms, &result);
    return result;
}

WEAK int AUCheckTone(void)
{
    int32_t result = 0;
    ROBIOS(AUCheckTone, &result);
    return result;
}

WEAK int AUBeep(void)
{
    int32_t result = 0;
    ROBIOS(AUBeep, &result);
    return result;
}

WEAK int AUCheckRecord(void)
{
    int32_t result = 0;
    ROBIOS(AUCheckRecord, &result);
    return result;
}

WEAK int AUCaptureMic(void)
{
    int32_t result = 0;
    ROBIOS(AUCaptureMic, &result);
    return result;
}

WEAK PSDHandle PSDInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(PSDInit, semantics, &result);
    return result;
}

WEAK int PSDRelease(void)
{
    int32_t result = 0;
    ROBIOS(PSDRelease, &result);
    return result;
}

WEAK int PSDStart(PSDHandle bitmask, BOOL cycle)
{
    int32_t result = 0;
    ROBIOS(PSDStart, bitmask, cycle, &result);
    return result;
}

WEAK int PSDStop(void)
{
    int32_t result = 0;
    ROBIOS(PSDStop, &result);
    return result;
}

WEAK BOOL PSDCheck(void)
{
    int32_t result = 0;
    ROBIOS(PSDCheck, &result);
    return result;
}

WEAK int PSDGet(PSDHandle handle)
{
    int32_t result = 0;
    ROBIOS(PSDGet, handle, &result);
    return result;
}

WEAK int PSDGetRaw(PSDHandle handle)
{
    int32_t result = 0;
    ROBIOS(PSDGetRaw, handle, &result);
    return result;
}

WEAK ServoHandle SERVOInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(SERVOInit, semantics, &result);
    return result;
}

WEAK int SERVORelease(ServoHandle handle)
{
    int32_t result = 0;
    ROBIOS(SERVORelease, handle, &result);
    return result;
}

WEAK int SERVOSet(ServoHandle handle, int angle)
{
    int32_t result = 0;
    ROBIOS(SERVOSet, handle, angle, &result);
    return result;
}

WEAK MotorHandle MOTORInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(MOTORInit, semantics, &result);
    return result;
}

WEAK int MOTORRelease(MotorHandle handle)
{
    int32_t result = 0;
    ROBIOS(MOTORRelease, handle, &result);
    return result;
}

WEAK int MOTORDrive(MotorHandle handle, int speed_percent)
{
    int32_t result = 0;
    ROBIOS(MOTORDrive, handle, speed_percent, &result);
    return result;
}

WEAK QuadHandle QUADInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(QUADInit, semantics, &result);
    return result;
}

WEAK int QUADRelease(QuadHandle handle)
{
    int32_t result = 0;
    ROBIOS(QUADRelease, handle, &result);
    return result;
}

WEAK int QUADReset(QuadHandle handle)
{
    int32_t result = 0;
    ROBIOS(QUADReset, handle, &result);
    return result;
}

WEAK int QUADRead(QuadHandle handle)
{
    int32_t result = 0;
    ROBIOS(QUADRead, handle, &result);
    return result;
}

WEAK DeviceSemantics QUADGetMotor(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(QUADGetMotor, semantics, &result);
    return result;
}

WEAK float QUADODORead(QuadHandle handle)
{
    float result = 0;
    ROBIOS(QUADODORead, handle, &result);
    return result;
}

WEAK int QUADODOReset(QuadHandle handle)
{
    int32_t result = 0;
    ROBIOS(QUADODOReset, handle, &result);
    return result;
}

WEAK VWHandle VWInit(DeviceSemantics semantics, int Timescale)
{
    int32_t result = 0;
    ROBIOS(VWInit, semantics, Timescale, &result);
    return result;
}

WEAK int VWRelease(VWHandle handle)
{
    int32_t result = 0;
    ROBIOS(VWRelease, handle, &result);
    return result;
}

WEAK int VWSetSpeed(VWHandle handle, meterPerSec v_mps, radPerSec w_radps)
{
    int32_t result = 0;
    ROBIOS(VWSetSpeed, handle, v_mps, w_radps, &result);
    return result;
}

WEAK int VWGetSpeed(VWHandle handle, SpeedType *vw)
{
    int32_t result = 0;
    ROBIOS(VWGetSpeed, handle, vw, &result);
    return result;
}

WEAK int VWSetPosition(VWHandle handle, meter x_m, meter y_m, radians phi_rad)
{
    int32_t result = 0;
    ROBIOS(VWSetPosition, handle, x_m, y_m, phi_rad, &result);
    return result;
}

WEAK int VWGetPosition(VWHandle handle, PositionType *pos)
{
    int32_t result = 0;
    ROBIOS(VWGetPosition, handle, pos, &result);
    return result;
}

WEAK int VWStartControl(VWHandle handle, float Vv, float Tv, float Vw, float Tw)
{
    int32_t result = 0;
    ROBIOS(VWStartControl, handle, Vv, Tv, Vw, Tw, &result);
    return result;
}

WEAK int VWStopControl(VWHandle handle)
{
    int32_t result = 0;
    ROBIOS(VWStopControl, handle, &result);
    return result;
}

WEAK int VWDriveStraight(VWHandle handle, meter delta_m, meterPerSec v_mps)
{
    int32_t result = 0;
    ROBIOS(VWDriveStraight, handle, delta_m, v_mps, &result);
    return result;
}

WEAK int VWDriveTurn(VWHandle handle, radians delta_rad, radPerSec w_radps)
{
    int32_t result = 0;
    ROBIOS(VWDriveTurn, handle, delta_rad, w_radps, &result);
    return result;
}

WEAK int VWDriveCurve(VWHandle handle, meter delta_l_m, radians delta_phi_rad, meterPerSec v_mps)
{
    int32_t result = 0;
    ROBIOS(VWDriveCurve, handle, delta_l_m, delta_phi_rad, v_mps, &result);
    return result;
}

WEAK float VWDriveRemain(VWHandle handle)
{
    float result = 0;
    ROBIOS(VWDriveRemain, handle, &result);
    return result;
}

WEAK int VWDriveDone(VWHandle handle)
{
    int32_t result = 0;
    ROBIOS(VWDriveDone, handle, &result);
    return result;
}

WEAK int VWDriveWait(VWHandle handle)
{
    int32_t result = 0;
    ROBIOS(VWDriveWait, handle, &result);
    return result;
}

WEAK int VWStalled(VWHandle handle)
{
    int32_t result = 0;
    ROBIOS(VWStalled, handle, &result);
    return result;
}

WEAK BumpHandle BUMPInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(BUMPInit, semantics, &result);
    return result;
}

WEAK int BUMPRelease(BumpHandle handle)
{
    int32_t result = 0;
    ROBIOS(BUMPRelease, handle, &result);
    return result;
}

WEAK int BUMPCheck(BumpHandle handle, int *timestamp)
{
    int32_t result = 0;
    ROBIOS(BUMPCheck, handle, timestamp, &result);
    return result;
}

WEAK IRHandle IRInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(IRInit, semantics, &result);
    return result;
}

WEAK int IRRelease(IRHandle handle)
{
    int32_t result = 0;
    ROBIOS(IRRelease, handle, &result);
    return result;
}

WEAK int IRRead(IRHandle handle)
{
    int32_t result = 0;
    ROBIOS(IRRead, handle, &result);
    return result;
}

WEAK BYTE OSReadInLatch(int n)
{
    uint8_t result = 0;
    ROBIOS(OSReadInLatch, n, &result);
    return result;
}

WEAK BYTE OSWriteOutLatch(int n, BYTE mask, BYTE value)
{
    uint8_t result = 0;
    ROBIOS(OSWriteOutLatch, n, mask, value, &result);
    return result;
}

WEAK BYTE OSReadOutLatch(int n)
{
    uint8_t result = 0;
    ROBIOS(OSReadOutLatch, n, &result);
    return result;
}

WEAK BYTE OSReadParData(void)
{
    uint8_t result = 0;
    ROBIOS(OSReadParData, &result);
    return result;
}

WEAK void OSWriteParData(BYTE value)
{
    ROBIOS(OSWriteParData, value, NULL);
}

WEAK BYTE OSReadParSR(void)
{
    uint8_t result = 0;
    ROBIOS(OSReadParSR, &result);
    return result;
}

WEAK void OSWriteParCTRL(BYTE value)
{
    ROBIOS(OSWriteParCTRL, value, NULL);
}

WEAK BYTE OSReadParCTRL(void)
{
    uint8_t result = 0;
    ROBIOS(OSReadParCTRL, &result);
    return result;
}

WEAK int OSGetAD(int channel)
{
    int32_t result = 0;
    ROBIOS(OSGetAD, channel, &result);
    return result;
}

WEAK int OSOffAD(int mode)
{
    int32_t result = 0;
    ROBIOS(OSOffAD, mode, &result);
    return result;
}

WEAK int COMPASSInit(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(COMPASSInit, semantics, &result);
    return result;
}

WEAK int COMPASSStart(BOOL cycle)
{
    int32_t result = 0;
    ROBIOS(COMPASSStart, cycle, &result);
    return result;
}

WEAK int COMPASSCheck(void)
{
    int32_t result = 0;
    ROBIOS(COMPASSCheck, &result);
    return result;
}

WEAK int COMPASSStop(void)
{
    int32_t result = 0;
    ROBIOS(COMPASSStop, &result);
    return result;
}

WEAK int COMPASSRelease(void)
{
    int32_t result = 0;
    ROBIOS(COMPASSRelease, &result);
    return result;
}

WEAK int COMPASSGet(void)
{
    int32_t result = 0;
    ROBIOS(COMPASSGet, &result);
    return result;
}

WEAK int COMPASSCalibrate(int mode)
{
    int32_t result = 0;
    ROBIOS(COMPASSCalibrate, mode, &result);
    return result;
}

WEAK int IRTVInitHDT(DeviceSemantics semantics)
{
    int32_t result = 0;
    ROBIOS(IRTVInitHDT, semantics, &result);
    return result;
}

WEAK int IRTVInit(int type_code, int length, int tog_mask, int inv_mask, int mode, int bufsize, int delay)
{
    int32_t result = 0;
    ROBIOS(IRTVInit, type_code, length, tog_mask, inv_mask, mode, bufsize, delay, &result);
    return result;
}

WEAK void IRTVTerm(void)
{
    ROBIOS(IRTVTerm, NULL);
}

WEAK int IRTVPressed(void)
{
    int32_t result = 0;
    ROBIOS(IRTVPressed, &result);
    return result;
}

WEAK int IRTVRead(void)
{
    int32_t result = 0;
    ROBIOS(IRTVRead, &result);
    return result;
}

WEAK int IRTVGet(void)
{
    int32_t result = 0;
    ROBIOS(IRTVGet, &result);
    return result;
}

WEAK void IRTVFlush(void)
{
    ROBIOS(IRTVFlush, NULL);
}

WEAK void IRTVGetStatus(int *type_code, int *length, int *tog_mask, int *inv_mask, int *mode, int *bufsize, int *delay)
{
    ROBIOS(IRTVGetStatus, type_code, length, tog_mask, inv_mask, mode, bufsize, delay, NULL);
}

WEAK int RADIOInit(void)
{
    int32_t result = 0;
    ROBIOS(RADIOInit, &result);
    return result;
}

WEAK int RADIOTerm(void)
{
    int32_t result = 0;
    ROBIOS(RADIOTerm, &result);
    return result;
}

WEAK int RADIOGetIoctl(RadioIOParameters *p)
{
    int32_t result = 0;
    ROBIOS(RADIOGetIoctl, p, &result);
    return result;
}

WEAK int RADIOSetIoctl(RadioIOParameters *p)
{
    int32_t result = 0;
    ROBIOS(RADIOSetIoctl, p, &result);
    return result;
}

WEAK int RADIOGetStatus(RadioStatus *s)
{
    int32_t result = 0;
    ROBIOS(RADIOGetStatus, s, &result);
    return result;
}

WEAK float PSDGetSignal(PSDHandle handle)
{
    float result = 0;
    ROBIOS(PSDGetSignal, handle, &result);
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
