/* The RoBIOS 6 functions whose form in C is not that of the call; part of shim.c. */
#include "hdt.h"

static int32_t task_of(const struct tcb *task)
{
    return task == NULL ? 0 : task->id;
}

WEAK char *OSVersion(void)
{
    static char text[64];
    int32_t result;
    memset(text, 0, sizeof text);
    ROBIOS(OSVersion, room_of(text, sizeof text - 1), &result);
    return text;
}

WEAK char *OSMachineName(void)
{
    static char text[64];
    int32_t result;
    memset(text, 0, sizeof text);
    ROBIOS(OSMachineName, room_of(text, sizeof text - 1), &result);
    return text;
}

WEAK void *HDT_FindEntry(TypeID type_id, DeviceSemantics semantics)
{
    static HDT_entry_type entry;
    int32_t is_found = 0;
    ROBIOS(HDT_FindEntry, type_id, semantics, &entry, &is_found);
    return is_found ? &entry : NULL;
}

static struct tcb *all_tasks;

WEAK struct tcb *OSSpawn(const char *name, void (*code)(void), int stksiz, int pri, int uid)
{
    int32_t id = 0;
    struct tcb *task = calloc(1, sizeof *task);
    if (task == NULL)
        return NULL;
    ROBIOS(OSSpawn, text_of(name), callback_of(code), stksiz, pri, uid, &id);
    if (id == 0) {
        free(task);
        return NULL;
    }
    task->id = id;
    task->uid = uid;
    task->pri = pri;
    task->stksiz = stksiz;
    if (name != NULL)
        memcpy(task->name, name, strnlen(name, sizeof task->name - 1));
    task->next = all_tasks;
    all_tasks = task;
    return task;
}

WEAK int OSExit(int code)
{
    int32_t result = 0;
    ROBIOS(OSExit, code, &result);
    /* There is no other task, or this is the first one. */
    end_program(code);
}

WEAK int OSPanic(const char *message)
{
    int32_t result = 0;
    ROBIOS(OSPanic, text_of(message), &result);
    fail(1, message);
}

WEAK int OSSemInit(struct sem *sem, int val)
{
    int32_t result = 0;
    ROBIOS(OSSemInit, sem == NULL ? NULL : &sem->id, val, &result);
    if (sem != NULL)
        sem->count = val;
    return result;
}

WEAK int OSSemP(struct sem *sem)
{
    int32_t result = 0;
    ROBIOS(OSSemP, sem == NULL ? 0 : sem->id, &result);
    return result;
}

WEAK int OSSemV(struct sem *sem)
{
    int32_t result = 0;
    ROBIOS(OSSemV, sem == NULL ? 0 : sem->id, &result);
    return result;
}

WEAK int AUPlaySample(char *sample)
{
    int32_t result = 0;
    ROBIOS(AUPlaySample, sample_of(sample), &result);
    return result;
}

WEAK int AURecordSample(BYTE *buf, long len, long freq)
{
    int32_t result = 0;
    ROBIOS(AURecordSample, room_of(len > 0 ? buf : NULL, len > 0 ? (size_t)len : 0), freq, &result);
    return result;
}

WEAK int RADIOCheck()
{
    int32_t result = 0;
    ROBIOS(RADIOCheck, &result);
    return result;
}

WEAK int RADIOSend(BYTE id, int byteCount, BYTE *buffer)
{
    int32_t result = 0;
    /* One byte more than allowed is enough to be refused. */
    size_t len = byteCount < 0 ? 0 : byteCount > MAXMSGLEN ? MAXMSGLEN + 1 : (size_t)byteCount;
    ROBIOS(RADIOSend, id, bytes_of(byteCount < 0 ? NULL : buffer, len), &result);
    return result;
}

WEAK int RADIORecv(BYTE *id, int *bytesReceived, BYTE *buffer)
{
    int32_t result = 0;
    ROBIOS(RADIORecv, id, bytesReceived, room_of(buffer, MAXMSGLEN), &result);
    return result;
}

WEAK int LIDARScan(int distance[], int size)
{
    int32_t result = 0;
    ROBIOS(LIDARScan, room_of(size > 0 ? distance : NULL, size > 0 ? (size_t)size : 0), &result);
    return result;
}

enum { FRAME_PIXELS = (imagecolumns - 2) * (imagerows - 2) };

WEAK int CAMGetDepth(float *mm)
{
    int32_t result = 0;
    ROBIOS(CAMGetDepth, room_of(mm, FRAME_PIXELS), &result);
    return result;
}

WEAK int CAMGetLabels(int *labels)
{
    int32_t result = 0;
    ROBIOS(CAMGetLabels, room_of(labels, FRAME_PIXELS), &result);
    return result;
}
