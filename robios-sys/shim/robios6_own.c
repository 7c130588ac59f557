/* RoBIOS 6 functions whose signature in C differs from that of the call; part of shim.c. */
#include "hdt.h"

static int32_t task_of(const struct tcb *task)
{
    /* A zeroed struct of the program is not a task, and must not stand for the current task, whose number is 0. */
    return task == NULL ? 0 : task->id == 0 ? -1 : task->id;
}

WEAK char *OSVersion(void)
{
    struct results *own = own_results();
    int32_t result;
    if (own == NULL)
        return NULL;
    memset(own->version, 0, sizeof own->version);
    ROBIOS(OSVersion, room_of(own->version, sizeof own->version - 1), &result);
    return own->version;
}

WEAK char *OSMachineName(void)
{
    struct results *own = own_results();
    int32_t result;
    if (own == NULL)
        return NULL;
    memset(own->machine_name, 0, sizeof own->machine_name);
    ROBIOS(OSMachineName, room_of(own->machine_name, sizeof own->machine_name - 1), &result);
    return own->machine_name;
}

WEAK void *HDT_FindEntry(TypeID type_id, DeviceSemantics semantics)
{
    struct results *own = own_results();
    int32_t is_found = 0;
    if (own == NULL)
        return NULL;
    ROBIOS(HDT_FindEntry, type_id, semantics, &own->entry, &is_found);
    return is_found ? &own->entry : NULL;
}

static struct tcb *all_tasks;
static int is_multitasking;

WEAK int OSMTInit(BYTE mode)
{
    int32_t result = -1;
    ROBIOS(OSMTInit, mode, &result);
    is_multitasking |= result == 0;
    return result;
}

WEAK struct tcb *OSSpawn(const char *name, void (*code)(void), int stksiz, int pri, int uid)
{
    struct eyesim_callback callback = {NULL, NULL};
    int32_t id = 0;
    struct tcb *handle = calloc(1, sizeof *handle);
    struct task *task = calloc(1, sizeof *task);
    if (code != NULL) {
        callback.code = run_task;
        callback.data = task;
    }
    if (handle != NULL && task != NULL) {
        task->start_plain = code;
        task->is_detached = 1;
        /* The new task cannot run yet: another call must make it ready first. */
        ROBIOS(OSSpawn, text_of(name), callback, stksiz, pri, uid, &id);
    }
    if (id == 0) {
        free(handle);
        free(task);
        return NULL;
    }
    add_task(task, id);
    handle->id = id;
    handle->uid = uid;
    handle->pri = pri;
    handle->stksiz = stksiz;
    if (name != NULL)
        memcpy(handle->name, name, strnlen(name, sizeof handle->name - 1));
    handle->next = all_tasks;
    all_tasks = handle;
    return handle;
}

/* Marks a task to end when the host stops it, if it can be ended. */
static void mark_as_killed(struct task *task)
{
    if (is_multitasking && task != NULL && task != &main_task && !task->is_ending)
        task->is_killed = 1;
}

WEAK int OSKill(struct tcb *thread)
{
    int32_t result = -1;
    struct task *task = thread == NULL ? this_task() : task_numbered((pthread_t)thread->id);
    mark_as_killed(task);
    ROBIOS(OSKill, task_of(thread), &result);
    /* A task that has run has removed itself by now, unless the call was refused. */
    task = thread == NULL ? this_task() : task_numbered((pthread_t)thread->id);
    if (task != NULL && result != 0)
        task->is_killed = 0;
    else if (task != NULL && thread != NULL && !task->has_begun)
        remove_task(task);
    return result;
}

WEAK int OSExit(int code)
{
    int32_t result = 0;
    mark_as_killed(this_task());
    ROBIOS(OSExit, code, &result);
    if (result != 0) { /* the scene forbids the call */
        this_task()->is_killed = 0;
        return result;
    }
    if (is_multitasking && this_task() != &main_task)
        unwind_task(this_task()); /* the task is ending already, and this call is from its own handler */
    end_program(code);
}

WEAK int OSPanic(const char *message)
{
    int32_t result = 0;
    ROBIOS(OSPanic, text_of(message), &result);
    if (result != 0) /* the scene forbids the call */
        return result;
    fail(1, message);
}

WEAK int OSSemInit(struct sem *sem, int val)
{
    int32_t result = 0;
    ROBIOS(OSSemInit, sem == NULL ? NULL : &sem->id, val, &result);
    if (sem != NULL && result == 0)
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
    /* One byte more than allowed is enough for the host to reject the message. */
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

WEAK int LEGGetLink(int leg, int link, float pose[6])
{
    int32_t result = 0;
    ROBIOS(LEGGetLink, leg, link, room_of(pose, 6), &result);
    return result;
}

WEAK int VWDriveReady(VWHandle handle)
{
    int32_t result = 0;
    ROBIOS(VWDriveDone, handle, &result);
    return result;
}

/* A program may pass an `image` for the grey form, which the call writes to the start of a `colimage`. */
WEAK int CAMGetColFrame(colimage *buf, int convert)
{
    colimage grey;
    int32_t result = -1;
    colimage *target = convert && buf != NULL ? &grey : buf;
    ROBIOS(CAMGetColFrame, target, convert, &result);
    if (target == &grey && result == 0)
        memcpy(buf, grey, sizeof(image));
    return result;
}
