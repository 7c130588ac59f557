/* What crosses between a program's library and the host: see docs/abi.md.
 * Generated from the lists in robios-sys/src; change them, then: cargo run -p robios-sys --bin generate */
#ifndef EYESIM_ABI_H
#define EYESIM_ABI_H

#include <stddef.h>
#include <stdint.h>

#define EYESIM_ABI_VERSION 1
#define EYESIM_STOP 1
#define EYESIM_EXIT_STOPPED INT32_MIN
#define EYESIM_EXIT_ABORTED 134
#define EYESIM_LANGUAGE_C 1
#define EYESIM_FLAG_VOID_MAIN 1

struct eyesim_bytes { const void *data; size_t len; };
struct eyesim_room { void *data; size_t len; };
struct eyesim_callback { int32_t (*code)(void *data); void *data; };

/* Version 1. */
struct eyesim_support {
    uint32_t size;
    uint32_t version;
    int32_t (*console)(void *robot, int32_t stream, struct eyesim_bytes bytes, int32_t *result);
    int32_t (*random)(void *robot, uint32_t purpose, uint64_t *result);
    int32_t (*seed)(void *robot, uint32_t purpose, uint64_t seed, int32_t *result);
    int32_t (*time_us)(void *robot, int64_t *result);
    int32_t (*sleep_us)(void *robot, int64_t span_us, int32_t *result);
    int32_t (*failed)(void *robot, int32_t kind, struct eyesim_bytes text, int32_t *result);
    int32_t (*program_name)(void *robot, struct eyesim_room name, int32_t *result);
};

/* Version 1. */
struct eyesim_robios6 {
    uint32_t size;
    uint32_t version;
    int32_t (*OSVersion)(void *robot, struct eyesim_room text, int32_t *result);
    int32_t (*OSError)(void *robot, struct eyesim_bytes message, int32_t number, int32_t dead, int32_t *result);
    int32_t (*OSMachineType)(void *robot, int32_t *result);
    int32_t (*OSMachineSpeed)(void *robot, int32_t *result);
    int32_t (*OSMachineName)(void *robot, struct eyesim_room text, int32_t *result);
    int32_t (*OSMachineID)(void *robot, uint8_t *result);
    int32_t (*OSEnable)(void *robot, int32_t *result);
    int32_t (*OSDisable)(void *robot, int32_t *result);
    int32_t (*OSGetVar)(void *robot, int32_t num, int32_t *result);
    int32_t (*OSPutVar)(void *robot, int32_t num, int32_t value, int32_t *result);
    int32_t (*HDT_Validate)(void *robot, int32_t *result);
    int32_t (*HDT_FindEntry)(void *robot, int32_t type_id, int32_t semantics, void *entry, int32_t *result);
    int32_t (*HDT_FindTable)(void *robot, int32_t type_id, int32_t index, void *entry, int32_t *result);
    int32_t (*HDT_TypeCount)(void *robot, int32_t type_id, int32_t *result);
    int32_t (*LCDPrintf)(void *robot, struct eyesim_bytes text, int32_t *result);
    int32_t (*LCDSetPrintf)(void *robot, int32_t row, int32_t column, struct eyesim_bytes text, int32_t *result);
    int32_t (*LCDClear)(void *robot, int32_t *result);
    int32_t (*LCDPutChar)(void *robot, uint8_t c, int32_t *result);
    int32_t (*LCDSetChar)(void *robot, int32_t row, int32_t column, uint8_t c, int32_t *result);
    int32_t (*LCDPutString)(void *robot, struct eyesim_bytes s, int32_t *result);
    int32_t (*LCDSetString)(void *robot, int32_t row, int32_t column, struct eyesim_bytes s, int32_t *result);
    int32_t (*LCDPutHex)(void *robot, int32_t v, int32_t *result);
    int32_t (*LCDPutHex1)(void *robot, int32_t v, int32_t *result);
    int32_t (*LCDPutInt)(void *robot, int32_t v, int32_t *result);
    int32_t (*LCDPutIntS)(void *robot, int32_t v, int32_t spaces, int32_t *result);
    int32_t (*LCDPutFloat)(void *robot, float v, int32_t *result);
    int32_t (*LCDPutFloatS)(void *robot, float v, int32_t spaces, int32_t decimals, int32_t *result);
    int32_t (*LCDMode)(void *robot, int32_t mode, int32_t *result);
    int32_t (*LCDSetPos)(void *robot, int32_t row, int32_t column, int32_t *result);
    int32_t (*LCDGetPos)(void *robot, void *row, void *column, int32_t *result);
    int32_t (*LCDPutGraphic)(void *robot, const void *buf, int32_t *result);
    int32_t (*LCDPutColorGraphic)(void *robot, void *buf, int32_t *result);
    int32_t (*LCDPutImage)(void *robot, const void *buf, int32_t *result);
    int32_t (*LCDMenu)(void *robot, struct eyesim_bytes s1, struct eyesim_bytes s2, struct eyesim_bytes s3, struct eyesim_bytes s4, int32_t *result);
    int32_t (*LCDMenuI)(void *robot, int32_t pos, struct eyesim_bytes s, int32_t *result);
    int32_t (*LCDSetPixel)(void *robot, int32_t row, int32_t col, int32_t val, int32_t *result);
    int32_t (*LCDInvertPixel)(void *robot, int32_t row, int32_t col, int32_t *result);
    int32_t (*LCDGetPixel)(void *robot, int32_t row, int32_t col, int32_t *result);
    int32_t (*LCDLine)(void *robot, int32_t x1, int32_t y1, int32_t x2, int32_t y2, int32_t col, int32_t *result);
    int32_t (*LCDArea)(void *robot, int32_t x1, int32_t y1, int32_t x2, int32_t y2, int32_t col, int32_t *result);
    int32_t (*KEYGetBuf)(void *robot, void *buf, int32_t *result);
    int32_t (*KEYGet)(void *robot, int32_t *result);
    int32_t (*KEYRead)(void *robot, int32_t *result);
    int32_t (*KEYWait)(void *robot, int32_t excode, int32_t *result);
    int32_t (*CAMInit)(void *robot, int32_t mode, int32_t *result);
    int32_t (*CAMRelease)(void *robot, int32_t *result);
    int32_t (*CAMGetFrame)(void *robot, void *buf, int32_t *result);
    int32_t (*CAMGetColFrame)(void *robot, void *buf, int32_t convert, int32_t *result);
    int32_t (*CAMGetFrameMono)(void *robot, void *buf, int32_t *result);
    int32_t (*CAMGetFrameColor)(void *robot, void *buf, int32_t *result);
    int32_t (*CAMGetFrameRGB)(void *robot, void *buf, int32_t *result);
    int32_t (*CAMGetFrameBayer)(void *robot, void *buf, int32_t *result);
    int32_t (*CAMSet)(void *robot, int32_t p1, int32_t p2, int32_t p3, int32_t *result);
    int32_t (*CAMGet)(void *robot, void *p1, void *p2, void *p3, int32_t *result);
    int32_t (*CAMMode)(void *robot, int32_t mode, int32_t *result);
    int32_t (*IPLaplace)(void *robot, const void *src, void *dest, int32_t *result);
    int32_t (*IPSobel)(void *robot, const void *src, void *dest, int32_t *result);
    int32_t (*IPDither)(void *robot, const void *src, void *dest, int32_t *result);
    int32_t (*IPDiffer)(void *robot, const void *current, const void *last, void *dest, int32_t *result);
    int32_t (*IPColor2Grey)(void *robot, const void *src, void *dest, int32_t *result);
    int32_t (*OSMTInit)(void *robot, uint8_t mode, int32_t *result);
    int32_t (*OSSpawn)(void *robot, struct eyesim_bytes name, struct eyesim_callback code, int32_t stksiz, int32_t pri, int32_t uid, int32_t *result);
    int32_t (*OSMTStatus)(void *robot, int32_t *result);
    int32_t (*OSReady)(void *robot, int32_t thread, int32_t *result);
    int32_t (*OSSuspend)(void *robot, int32_t thread, int32_t *result);
    int32_t (*OSReschedule)(void *robot, int32_t *result);
    int32_t (*OSYield)(void *robot, int32_t *result);
    int32_t (*OSRun)(void *robot, int32_t thread, int32_t *result);
    int32_t (*OSGetUID)(void *robot, int32_t thread, int32_t *result);
    int32_t (*OSKill)(void *robot, int32_t thread, int32_t *result);
    int32_t (*OSExit)(void *robot, int32_t code, int32_t *result);
    int32_t (*OSPanic)(void *robot, struct eyesim_bytes message, int32_t *result);
    int32_t (*OSSleep)(void *robot, int32_t n, int32_t *result);
    int32_t (*OSForbid)(void *robot, int32_t *result);
    int32_t (*OSPermit)(void *robot, int32_t *result);
    int32_t (*OSSemInit)(void *robot, void *sem, int32_t val, int32_t *result);
    int32_t (*OSSemP)(void *robot, int32_t sem, int32_t *result);
    int32_t (*OSSemV)(void *robot, int32_t sem, int32_t *result);
    int32_t (*OSSetTime)(void *robot, int32_t h, int32_t m, int32_t s, int32_t *result);
    int32_t (*OSGetTime)(void *robot, void *h, void *m, void *s, void *ticks, int32_t *result);
    int32_t (*OSShowTime)(void *robot, int32_t *result);
    int32_t (*OSGetCount)(void *robot, int32_t *result);
    int32_t (*OSWait)(void *robot, int32_t n, int32_t *result);
    int32_t (*OSAttachTimer)(void *robot, int32_t scale, struct eyesim_callback f, int32_t *result);
    int32_t (*OSDetachTimer)(void *robot, int32_t handle, int32_t *result);
    int32_t (*OSInitRS232)(void *robot, int32_t baud, int32_t handshake, int32_t interface, int32_t *result);
    int32_t (*OSSendCharRS232)(void *robot, uint8_t chr, int32_t interface, int32_t *result);
    int32_t (*OSSendRS232)(void *robot, struct eyesim_bytes s, int32_t interface, int32_t *result);
    int32_t (*OSRecvRS232)(void *robot, void *buf, int32_t interface, int32_t *result);
    int32_t (*OSFlushInRS232)(void *robot, int32_t interface, int32_t *result);
    int32_t (*OSFlushOutRS232)(void *robot, int32_t interface, int32_t *result);
    int32_t (*OSCheckInRS232)(void *robot, int32_t interface, int32_t *result);
    int32_t (*OSCheckOutRS232)(void *robot, int32_t interface, int32_t *result);
    int32_t (*OSDownload)(void *robot, void *name, void *bytes, int32_t baud, int32_t handshake, int32_t interface, int32_t *result);
    int32_t (*USRStart)(void *robot, int32_t *result);
    int32_t (*USRResident)(void *robot, struct eyesim_bytes name, int32_t mode, int32_t *result);
    int32_t (*AUPlaySample)(void *robot, struct eyesim_bytes sample, int32_t *result);
    int32_t (*AUCheckSample)(void *robot, int32_t *result);
    int32_t (*AUTone)(void *robot, int32_t freq_hz, int32_t span_ms, int32_t *result);
    int32_t (*AUCheckTone)(void *robot, int32_t *result);
    int32_t (*AUBeep)(void *robot, int32_t *result);
    int32_t (*AURecordSample)(void *robot, struct eyesim_room buf, int64_t freq_hz, int32_t *result);
    int32_t (*AUCheckRecord)(void *robot, int32_t *result);
    int32_t (*AUCaptureMic)(void *robot, int32_t *result);
    int32_t (*PSDInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*PSDRelease)(void *robot, int32_t *result);
    int32_t (*PSDStart)(void *robot, int32_t bitmask, int32_t cycle, int32_t *result);
    int32_t (*PSDStop)(void *robot, int32_t *result);
    int32_t (*PSDCheck)(void *robot, int32_t *result);
    int32_t (*PSDGet)(void *robot, int32_t handle, int32_t *result);
    int32_t (*PSDGetRaw)(void *robot, int32_t handle, int32_t *result);
    int32_t (*SERVOInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*SERVORelease)(void *robot, int32_t handle, int32_t *result);
    int32_t (*SERVOSet)(void *robot, int32_t handle, int32_t angle, int32_t *result);
    int32_t (*MOTORInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*MOTORRelease)(void *robot, int32_t handle, int32_t *result);
    int32_t (*MOTORDrive)(void *robot, int32_t handle, int32_t speed_percent, int32_t *result);
    int32_t (*QUADInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*QUADRelease)(void *robot, int32_t handle, int32_t *result);
    int32_t (*QUADReset)(void *robot, int32_t handle, int32_t *result);
    int32_t (*QUADRead)(void *robot, int32_t handle, int32_t *result);
    int32_t (*QUADGetMotor)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*QUADODORead)(void *robot, int32_t handle, float *result);
    int32_t (*QUADODOReset)(void *robot, int32_t handle, int32_t *result);
    int32_t (*VWInit)(void *robot, int32_t semantics, int32_t Timescale, int32_t *result);
    int32_t (*VWRelease)(void *robot, int32_t handle, int32_t *result);
    int32_t (*VWSetSpeed)(void *robot, int32_t handle, float v_mps, float w_radps, int32_t *result);
    int32_t (*VWGetSpeed)(void *robot, int32_t handle, void *vw, int32_t *result);
    int32_t (*VWSetPosition)(void *robot, int32_t handle, float x_m, float y_m, float phi_rad, int32_t *result);
    int32_t (*VWGetPosition)(void *robot, int32_t handle, void *pos, int32_t *result);
    int32_t (*VWStartControl)(void *robot, int32_t handle, float Vv, float Tv, float Vw, float Tw, int32_t *result);
    int32_t (*VWStopControl)(void *robot, int32_t handle, int32_t *result);
    int32_t (*VWDriveStraight)(void *robot, int32_t handle, float delta_m, float v_mps, int32_t *result);
    int32_t (*VWDriveTurn)(void *robot, int32_t handle, float delta_rad, float w_radps, int32_t *result);
    int32_t (*VWDriveCurve)(void *robot, int32_t handle, float delta_l_m, float delta_phi_rad, float v_mps, int32_t *result);
    int32_t (*VWDriveRemain)(void *robot, int32_t handle, float *result);
    int32_t (*VWDriveDone)(void *robot, int32_t handle, int32_t *result);
    int32_t (*VWDriveWait)(void *robot, int32_t handle, int32_t *result);
    int32_t (*VWStalled)(void *robot, int32_t handle, int32_t *result);
    int32_t (*BUMPInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*BUMPRelease)(void *robot, int32_t handle, int32_t *result);
    int32_t (*BUMPCheck)(void *robot, int32_t handle, void *timestamp, int32_t *result);
    int32_t (*IRInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*IRRelease)(void *robot, int32_t handle, int32_t *result);
    int32_t (*IRRead)(void *robot, int32_t handle, int32_t *result);
    int32_t (*OSReadInLatch)(void *robot, int32_t n, uint8_t *result);
    int32_t (*OSWriteOutLatch)(void *robot, int32_t n, uint8_t mask, uint8_t value, uint8_t *result);
    int32_t (*OSReadOutLatch)(void *robot, int32_t n, uint8_t *result);
    int32_t (*OSReadParData)(void *robot, uint8_t *result);
    int32_t (*OSWriteParData)(void *robot, uint8_t value, void *result);
    int32_t (*OSReadParSR)(void *robot, uint8_t *result);
    int32_t (*OSWriteParCTRL)(void *robot, uint8_t value, void *result);
    int32_t (*OSReadParCTRL)(void *robot, uint8_t *result);
    int32_t (*OSGetAD)(void *robot, int32_t channel, int32_t *result);
    int32_t (*OSOffAD)(void *robot, int32_t mode, int32_t *result);
    int32_t (*COMPASSInit)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*COMPASSStart)(void *robot, int32_t cycle, int32_t *result);
    int32_t (*COMPASSCheck)(void *robot, int32_t *result);
    int32_t (*COMPASSStop)(void *robot, int32_t *result);
    int32_t (*COMPASSRelease)(void *robot, int32_t *result);
    int32_t (*COMPASSGet)(void *robot, int32_t *result);
    int32_t (*COMPASSCalibrate)(void *robot, int32_t mode, int32_t *result);
    int32_t (*IRTVInitHDT)(void *robot, int32_t semantics, int32_t *result);
    int32_t (*IRTVInit)(void *robot, int32_t type_code, int32_t length, int32_t tog_mask, int32_t inv_mask, int32_t mode, int32_t bufsize, int32_t delay, int32_t *result);
    int32_t (*IRTVTerm)(void *robot, void *result);
    int32_t (*IRTVPressed)(void *robot, int32_t *result);
    int32_t (*IRTVRead)(void *robot, int32_t *result);
    int32_t (*IRTVGet)(void *robot, int32_t *result);
    int32_t (*IRTVFlush)(void *robot, void *result);
    int32_t (*IRTVGetStatus)(void *robot, void *type_code, void *length, void *tog_mask, void *inv_mask, void *mode, void *bufsize, void *delay, void *result);
    int32_t (*RADIOInit)(void *robot, int32_t *result);
    int32_t (*RADIOTerm)(void *robot, int32_t *result);
    int32_t (*RADIOSend)(void *robot, uint8_t id, struct eyesim_bytes buffer, int32_t *result);
    int32_t (*RADIOCheck)(void *robot, int32_t *result);
    int32_t (*RADIORecv)(void *robot, void *id, void *bytesReceived, struct eyesim_room buffer, int32_t *result);
    int32_t (*RADIOGetIoctl)(void *robot, void *p, int32_t *result);
    int32_t (*RADIOSetIoctl)(void *robot, const void *p, int32_t *result);
    int32_t (*RADIOGetStatus)(void *robot, void *s, int32_t *result);
};

struct eyesim_host {
    uint32_t size;
    uint32_t abi;
    const struct eyesim_support *support;
    const struct eyesim_robios6 *robios6;
};

/* Where the program called the function that it is in: an address in its code, or file and line. */
struct eyesim_call_site {
    const void *address;
    const char *file;
    size_t file_len;
    uint32_t line;
};

struct eyesim_program {
    uint32_t size;
    uint32_t abi;
    uint32_t generation;
    uint32_t flags;
    uint32_t language;
    uint32_t support_size;
    uint32_t robios_size;
    int (*run)(const struct eyesim_host *host, void *robot, int argc, const char *const *argv);
    const struct eyesim_call_site *call_site;
};

#endif
