/* Shim of a C program's library: its entry point, its RoBIOS functions, and the interposed functions of the C library.
 *
 * Compiled once for every library, with the files that it includes: each copy has its own globals.
 *   robios6.c, robios7.c          the RoBIOS functions that follow from the lists (generated); eyebot.h selects one of them
 *   robios6_own.c, robios7_own.c  the RoBIOS functions whose signature in C differs from that of the call
 *   libc.c     the interposed functions of the C library
 *   getopt.c   getopt, whose state all copies of a library would share
 *   pthread.c  threads, which are tasks of the robot
 *   layer.c    layers of the window
 * Programs with parts in C++ (EYESIM_CPP) also link cpp.cpp.
 *
 * All functions are weak: a program's own function of the same name takes precedence. None of them calls a function
 * that libc.c interposes. Calls outside of the program's run (by constructors and destructors that the dynamic linker
 * runs), or on other threads, do nothing and return 0. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <link.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <malloc.h>
#include <stdlib.h>
#include <string.h>

#include "abi.h"
#include "eyebot.h"

#define WEAK __attribute__((weak))
#define HIDDEN __attribute__((visibility("hidden")))
#define MAX_IGNORED_CALLS 10000

/* Marks a function as the outermost frame: unwinding, also in search of exception handlers, stops there. */
#if defined __x86_64__
#define OUTERMOST __asm__ volatile(".cfi_undefined rip")
#elif defined __i386__
#define OUTERMOST __asm__ volatile(".cfi_undefined eip")
#elif defined __aarch64__
#define OUTERMOST __asm__ volatile(".cfi_undefined x30")
#elif defined __riscv
#define OUTERMOST __asm__ volatile(".cfi_undefined ra")
#else
#define OUTERMOST ((void)0)
#endif

/* longjmp target that exits the program or a task: the start of the task, or of the running timer function. */
struct exit_point {
    jmp_buf jump_buffer;
    struct exit_point *outer;
    struct task *task;
    const void *thread; /* the thread that runs it */
    int is_unwinding; /* destructors are running */
    int jump_value; /* value passed to longjmp after unwinding; 0 stands for EXIT_PROGRAM */
    uintptr_t canary; /* CANARY_OF(exit_point) unless the stack was overwritten */
};

#define CANARY_OF(exit_point) ((uintptr_t)(exit_point) ^ (uintptr_t)0x5AFEF4A3E5EEDull)

/* Values that longjmp passes to an exit point. */
enum { EXIT_PROGRAM = 1, EXIT_TASK = 2 };

/* A function to be called when the program ends. */
struct at_end {
    struct at_end *previous;
    void (*without_data)(void);
    void (*with_data)(void *data);
    void (*with_code)(int code, void *data);
    void *data;
};

static struct {
    const struct eyesim_host *host; /* NULL while the program does not run */
    void *robot;
    struct exit_point *exit_point;
    struct at_end *at_end;
    struct at_end *at_quick_exit;
    int is_exiting;
    int exit_code;
    int ignored_calls; /* calls from destructors of a program that is exiting */
    int stop_pending; /* the host has stopped the program while unwinding was not possible */
    struct eyesim_console consoles[2]; /* standard output and standard error, which the host reads if the program crashes */
    const void *reader; /* call site of the function that reads standard input */
    int reader_reported; /* true once report_reader has reported it */
    struct eyesim_call_site call_site;
} self = {.consoles = {{.stream = 1}, {.stream = 2}}};

#define OUT (&self.consoles[0])
#define ERR (&self.consoles[1])

/* The calling thread. A flow (the program's main, or a task) stays on one thread, which it may share with others. */
static inline const void *this_thread(void)
{
    const void *thread;
#if defined __x86_64__
    __asm__("mov %%fs:0, %0" : "=r"(thread));
#elif defined __aarch64__
    __asm__("mrs %0, tpidr_el0" : "=r"(thread));
#else
#error "no thread pointer for this architecture"
#endif
    return thread;
}

/* True if the program may call the host: it is running, and the caller is on the thread of its current task, not on a thread of OpenMP. */
static inline int may_call(void)
{
    return self.host != NULL && self.exit_point != NULL && self.exit_point->thread == this_thread();
}

/* ---- exit from the program ---- */

/* Traps for a stack that cannot be unwound. The host maps the name of the trap to its message:
 * sim-host/src/executive/program_status.rs. */
#define TRAP(name)                                                                                                      \
    static __attribute__((noinline, noclone, noreturn, cold)) void name(void)                                           \
    {                                                                                                                   \
        __asm__ volatile("/* " #name " */"); /* keeps the compiler from merging them */                                 \
        __builtin_trap();                                                                                               \
    }
TRAP(eyesim_trap_stack_smashed)
TRAP(eyesim_trap_off_task)
TRAP(eyesim_trap_heap_lost)

/* Traps if the exit point on the stack has been overwritten. */
static inline void check_exit_point(void)
{
    if (self.exit_point != NULL && self.exit_point->canary != CANARY_OF(self.exit_point))
        eyesim_trap_stack_smashed();
}

#ifdef EYESIM_CPP
/* In cpp.cpp: runs the destructors between here and `exit_point`, and jumps there. Returns if it cannot. */
HIDDEN void eyesim_unwind(struct exit_point *exit_point);

/* In cpp.cpp: stores the return addresses of the calls in progress, the innermost first; returns their number. */
HIDDEN size_t eyesim_stack(const void **addresses, size_t room);

/* In cpp.cpp: reports exceptions that the program does not catch, those of constructors included. */
HIDDEN void eyesim_report_uncaught(void);

/* Jumps to an exit point at the end of unwinding. */
HIDDEN _Noreturn void eyesim_jump(struct exit_point *exit_point)
{
    _longjmp(exit_point->jump_buffer, exit_point->jump_value);
}
#else
#define eyesim_unwind(exit_point) ((void)(exit_point))
#endif

/* Ends the program from any call depth; the first exit code counts. */
static _Noreturn void exit_program(int exit_code)
{
    if (!self.is_exiting) {
        self.is_exiting = 1;
        self.exit_code = exit_code;
    }
    check_exit_point();
    if (self.exit_point == NULL || self.exit_point->thread != this_thread())
        eyesim_trap_off_task();
    if (exit_code == EYESIM_EXIT_STOPPED && !self.exit_point->is_unwinding) {
        self.exit_point->is_unwinding = 1;
        eyesim_unwind(self.exit_point);
    }
    _longjmp(self.exit_point->jump_buffer, EXIT_PROGRAM);
}

/* Handles a stop by the host: the running task was killed or cancelled, or else the program must end. */
static _Noreturn void stop(void);

static int is_cancelled(void);
static int is_own_stop(void);
static struct exit_point *exit_point_of_flow(void);
static void yield_if_due(void);
static _Noreturn void cancel_self(void);

/* True if a call reaches the host. Calls outside of the run, and calls from destructors while the program ends, do not.
 * A destructor that waits in a loop is abandoned after MAX_IGNORED_CALLS calls. */
static int reaches_host(void)
{
    if (!may_call() || !self.is_exiting)
        return may_call();
    if (++self.ignored_calls > MAX_IGNORED_CALLS)
        _longjmp(self.exit_point->jump_buffer, EXIT_PROGRAM);
    return 0;
}

/* Call site after the call: within the call instruction, so that no return address left on the stack passes for the call
 * in progress. */
#define AFTER_CALL(site) ((const char *)(site) - 1)

/* Runs after each call. Tasks switch only inside calls, so `exit_point` belongs to the task that continues. */
static void returned(int32_t status, struct exit_point *exit_point, const void *site)
{
    self.exit_point = exit_point;
    self.call_site.address = AFTER_CALL(site);
    if (status == EYESIM_STOP || is_cancelled())
        stop();
}

#define CALL(table, name, ...)                                                                                          \
    do {                                                                                                                \
        if (reaches_host()) {                                                                                           \
            struct exit_point *exit_point_ = self.exit_point;                                                           \
            self.call_site.address = __builtin_return_address(0);                                                       \
            returned(self.host->table->name(self.robot, __VA_ARGS__), exit_point_, __builtin_return_address(0));        \
        }                                                                                                               \
    } while (0)
#if EYESIM_ROBIOS == 7
#define ROBIOS(name, ...) CALL(robios7, name, __VA_ARGS__)
#else
#define ROBIOS(name, ...) CALL(robios6, name, __VA_ARGS__)
#endif
#define SUPPORT(name, ...) CALL(support, name, __VA_ARGS__)

/* ---- conversions ---- */

static struct eyesim_bytes bytes_of(const void *data, size_t len)
{
    struct eyesim_bytes bytes = {data, len};
    return bytes;
}

static struct eyesim_bytes text_of(const char *text)
{
    return bytes_of(text, text == NULL ? 0 : strlen(text));
}

static struct eyesim_room room_of(void *data, size_t len)
{
    struct eyesim_room room = {data, len};
    return room;
}

static size_t size_at(const unsigned char *bytes)
{
    return bytes[0] | (size_t)bytes[1] << 8 | (size_t)bytes[2] << 16 | (size_t)bytes[3] << 24;
}

/* Maximum size of the chunks before the sample in a WAV file. */
enum { MAX_WAV_HEADER = 1 << 16 };

/* The header of a WAV file in memory, up to the sample, or else the bytes of a text. The host reads only the header, and
 * a streamed file states no length. */
static struct eyesim_bytes sample_of(const void *sample)
{
    const unsigned char *file = sample;
    size_t size, end, at = 12;
    if (sample == NULL || strncmp(sample, "RIFF", 4) != 0 || strncmp((const char *)file + 8, "WAVE", 4) != 0)
        return text_of(sample);
    size = size_at(file + 4);
    end = size == 0 || size > MAX_WAV_HEADER ? MAX_WAV_HEADER : 8 + size;
    while (at + 8 <= end && memcmp(file + at, "data", 4) != 0)
        at += 8 + size_at(file + at + 4) + size_at(file + at + 4) % 2;
    return bytes_of(sample, at + 8 <= end ? at + 8 : 12);
}

static __attribute__((noinline)) void call_outermost(TimerFnc function)
{
    OUTERMOST;
    function();
    __asm__ volatile("");
}

/* Calls a function of the program for the host. Unwinding of the program stops here, because frames of the host lie below. */
static int32_t called_back(void *data)
{
    TimerFnc function;
    struct exit_point exit_point;
    const struct eyesim_call_site outer_site = self.call_site;
    memcpy(&function, &data, sizeof function);
    exit_point.outer = exit_point_of_flow();
    exit_point.task = exit_point.outer->task;
    exit_point.thread = this_thread();
    exit_point.is_unwinding = exit_point.jump_value = 0;
    exit_point.canary = CANARY_OF(&exit_point);
    self.exit_point = &exit_point;
    if (setjmp(exit_point.jump_buffer) == 0) {
        call_outermost(function);
        self.exit_point = exit_point.outer;
        self.call_site = outer_site;
        return self.stop_pending ? EYESIM_STOP : 0;
    }
    self.exit_point = exit_point.outer;
    return EYESIM_STOP;
}

static struct eyesim_callback callback_of(TimerFnc function)
{
    struct eyesim_callback callback = {NULL, NULL};
    if (function != NULL) {
        callback.code = called_back;
        memcpy(&callback.data, &function, sizeof function);
    }
    return callback;
}

#include "libc.c"
#include "getopt.c"
#include "pthread.c"
#include "layer.c"

/* Formats as printf does. Returns `local`, or a buffer to be freed if `local` is too short; NULL without a format or on failure. */
static char *formatted(char *local, size_t room, const char *format, va_list arguments)
{
    va_list again;
    char *text = local;
    int len;
    if (format == NULL)
        return NULL;
    va_copy(again, arguments);
    len = vsnprintf(local, room, format, arguments);
    if (len < 0)
        text = NULL;
    else if ((size_t)len >= room && (text = malloc((size_t)len + 1)) != NULL)
        vsnprintf(text, (size_t)len + 1, format, again);
    va_end(again);
    return text;
}

WEAK int LCDPrintf(const char *format, ...)
{
    char local[512];
    char *text;
    int32_t result = 0;
    va_list arguments;
    va_start(arguments, format);
    text = formatted(local, sizeof local, format, arguments);
    va_end(arguments);
    ROBIOS(LCDPrintf, text_of(text), &result);
    if (text != local)
        free(text);
    return result;
}

WEAK int LCDSetPrintf(int row, int column, const char *format, ...)
{
    char local[512];
    char *text;
    int32_t result = 0;
    va_list arguments;
    va_start(arguments, format);
    text = formatted(local, sizeof local, format, arguments);
    va_end(arguments);
    ROBIOS(LCDSetPrintf, row, column, text_of(text), &result);
    if (text != local)
        free(text);
    return result;
}

#if EYESIM_ROBIOS == 7
#include "robios7_own.c"
#include "robios7.c"
#else
#include "robios6_own.c"
#include "robios6.c"
#endif

/* ---- for cpp.cpp ---- */

#ifdef EYESIM_CPP
/* Ends the program by an uncaught exception, or silently (NULL) while the program is ending anyway. */
HIDDEN _Noreturn void eyesim_uncaught(const char *text, const void *const *stack, size_t depth)
{
    if (text != NULL)
        fail_in(stack, depth, FAILED_EXCEPTION, text);
    if (!self.is_exiting && self.exit_point->jump_value == EXIT_TASK)
        _longjmp(self.exit_point->jump_buffer, EXIT_TASK);
    exit_program(EYESIM_EXIT_STOPPED);
}

HIDDEN _Bool eyesim_is_unwinding(void) { return self.exit_point != NULL && self.exit_point->is_unwinding; }

HIDDEN uint32_t eyesim_entropy(void) { return (uint32_t)random_bits(ENTROPY); }
#endif

/* ---- entry ---- */

extern int main(int argc, char **argv, char **environment);
extern const char __ehdr_start HIDDEN;
extern ElfW(Dyn) _DYNAMIC[] HIDDEN;

/* Copy of the arguments, which `main` may change. It lives as long as the library. */
static __attribute__((noinline)) char **copied_arguments(int argc, const char *const *argv)
{
    int i;
    char **copy = calloc((size_t)argc + 1, sizeof *copy);
    for (i = 0; copy != NULL && i < argc; i++)
        if ((copy[i] = strdup(argv[i])) == NULL)
            return NULL;
    return copy;
}

static char *environment[1];

/* Runs the library's constructors, which are hidden from the dynamic linker, as a part of the program. */
static void construct(int argc, char **argv)
{
    static int is_constructed;
    typedef void constructor(int, char **, char **);
    const ElfW(Dyn) *entry;
    constructor *const *constructors = NULL;
    size_t i, count = 0;
    if (is_constructed)
        return;
    is_constructed = 1;
    for (entry = _DYNAMIC; entry->d_tag != DT_NULL; entry++) {
        if (entry->d_tag == EYESIM_CONSTRUCTORS)
            constructors = (constructor *const *)(const void *)((const char *)&__ehdr_start + entry->d_un.d_ptr);
        else if (entry->d_tag == EYESIM_CONSTRUCTORS_SIZE)
            count = entry->d_un.d_val / sizeof *constructors;
    }
    for (i = 0; i < count; i++)
        constructors[i](argc, argv, environment);
}

/* Runs the whole program; no exception is propagated beyond this frame. */
static __attribute__((noinline)) _Noreturn void run_program(int argc, char **argv)
{
    int exit_code = 0;
    OUTERMOST;
#ifdef EYESIM_CPP
    eyesim_report_uncaught();
#endif
#if EYESIM_ROBIOS == 7
    if (LIDAR_RESOLUTION == 0) /* otherwise it is the program's own */
        set_lidar_resolution();
#endif
    errno = 0;
    construct(argc, argv);
#ifdef EYESIM_VOID_MAIN
    main(argc, argv, environment);
#else
    exit_code = main(argc, argv, environment);
#endif
    end_program(exit_code);
}

static int run(const struct eyesim_host *host, void *robot, int argc, const char *const *argv)
{
    struct exit_point exit_point;
    char **arguments = copied_arguments(argc, argv);
    exit_point.outer = NULL;
    exit_point.task = &main_task;
    exit_point.thread = main_task.thread = this_thread();
    exit_point.is_unwinding = exit_point.jump_value = 0;
    exit_point.canary = CANARY_OF(&exit_point);
    main_task.base = &exit_point;
    self.is_exiting = self.stop_pending = self.ignored_calls = 0;
    self.reader = NULL;
    self.reader_reported = 0;
    self.host = host;
    self.robot = robot;
    self.exit_point = &exit_point;
    switch (setjmp(exit_point.jump_buffer)) {
    case 0:
        if (arguments == NULL)
            fail(1, "no memory for the arguments");
        run_program(argc, arguments);
    case EXIT_TASK:
        end_main_task();
        end_program(0);
    }
#ifdef EYESIM_CPP
    if (exit_point.is_unwinding && setjmp(exit_point.jump_buffer) == 0)
        destroy_at_end();
#endif
    self.exit_point = NULL;
    flush_console();
    self.host = NULL;
    return self.exit_code;
}

#ifdef EYESIM_VOID_MAIN
#define FLAGS EYESIM_FLAG_VOID_MAIN
#else
#define FLAGS 0
#endif

__attribute__((visibility("default"))) const struct eyesim_program eyesim_program = {
    .size = sizeof(struct eyesim_program),
    .abi = EYESIM_ABI_VERSION,
    .generation = EYESIM_ROBIOS,
    .flags = FLAGS,
#ifdef EYESIM_CPP
    .language = EYESIM_LANGUAGE_CPP,
#else
    .language = EYESIM_LANGUAGE_C,
#endif
    .support_size = sizeof(struct eyesim_support),
#if EYESIM_ROBIOS == 7
    .robios_size = sizeof(struct eyesim_robios7),
#else
    .robios_size = sizeof(struct eyesim_robios6),
#endif
    .run = run,
    .call_site = &self.call_site,
    .consoles = self.consoles,
};
