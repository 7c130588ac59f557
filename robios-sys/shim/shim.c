/* Shim of a C program's library: its entry point, its RoBIOS functions, and the interposed functions of the C library.
 *
 * Compiled once for every library, with the files that it includes: each copy has its own globals.
 *   robios6.c, robios7.c          the RoBIOS functions that follow from the lists (generated); eyebot.h selects one of them
 *   robios6_own.c, robios7_own.c  the RoBIOS functions whose signature in C differs from that of the call
 *   libc.c     the interposed functions of the C library
 *   getopt.c   getopt, whose state all copies of a library would share
 *   pthread.c  threads, which are tasks of the robot
 * Programs with parts in C++ (EYESIM_CPP) have cpp.cpp beside it.
 *
 * All functions are weak: a program's own function of the same name wins. None of them calls a function that libc.c
 * interposes. Calls made outside of the program's run (constructors, other threads) do nothing and return 0. */
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
#define MOST_IGNORED_CALLS 10000

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

/* Target of a jump that leaves the program: the start of its task, or of the running timer function. */
struct frame {
    jmp_buf place;
    struct frame *outer;
    struct task *task;
    const void *thread; /* which runs it */
    int is_left; /* by unwinding, which runs destructors */
    int jump_value; /* what unwinding brings to it in the end; 0 is LEAVES */
    uintptr_t mark; /* MARK_OF(frame) unless the stack was overwritten */
};

#define MARK_OF(frame) ((uintptr_t)(frame) ^ (uintptr_t)0x5AFEF4A3E5EEDull)

/* Values that longjmp passes to a frame. */
enum { LEAVES = 1, TASK_ENDS = 2 };

/* A function to be called when the program ends. */
struct at_end {
    struct at_end *before;
    void (*plain)(void);
    void (*with_data)(void *data);
    void (*with_code)(int code, void *data);
    void *data;
};

static struct {
    const struct eyesim_host *host; /* NULL while the program does not run */
    void *robot;
    struct frame *frame;
    struct at_end *at_end;
    struct at_end *at_quick_exit;
    int is_leaving;
    int exit_code;
    int ignored_calls; /* of destructors of a program that is being left */
    int stop_pending; /* the host has stopped the program while it could not be left */
    struct eyesim_console consoles[2]; /* standard output and standard error, which the host reads if the program breaks */
    const void *reader; /* where the program has called the function that reads standard input */
    int has_told_reader; /* see tell_reader */
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
#error "how does a thread know itself here?"
#endif
    return thread;
}

/* True if the program may call the host: it is running, and the caller is on the thread of its current task, not on one of OpenMP. */
static inline int may_call(void)
{
    return self.host != NULL && self.frame != NULL && self.frame->thread == this_thread();
}

/* ---- leaving the program ---- */

/* Functions that fault where the program cannot be left any more. The host tells the reason by the function's name:
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

/* Stops here if the frame that is the target of the way out has been overwritten. */
static inline void check_frame(void)
{
    if (self.frame != NULL && self.frame->mark != MARK_OF(self.frame))
        eyesim_trap_stack_smashed();
}

#ifdef EYESIM_CPP
/* In cpp.cpp: runs the destructors between here and `frame`, and jumps there. Returns if it cannot. */
HIDDEN void eyesim_unwind(struct frame *frame);

/* In cpp.cpp: stores the return addresses of the calls in progress, the innermost first; returns their number. */
HIDDEN size_t eyesim_stack(const void **addresses, size_t room);

/* In cpp.cpp: reports exceptions that the program does not catch, those of constructors included. */
HIDDEN void eyesim_report_uncaught(void);

/* Jumps to a frame at the end of unwinding. */
HIDDEN _Noreturn void eyesim_jump(struct frame *frame)
{
    _longjmp(frame->place, frame->jump_value);
}
#else
#define eyesim_unwind(frame) ((void)(frame))
#endif

/* Ends the program from any call depth; the first exit code counts. */
static _Noreturn void leave(int exit_code)
{
    if (!self.is_leaving) {
        self.is_leaving = 1;
        self.exit_code = exit_code;
    }
    check_frame();
    if (self.frame == NULL || self.frame->thread != this_thread())
        eyesim_trap_off_task();
    if (exit_code == EYESIM_EXIT_STOPPED && !self.frame->is_left) {
        self.frame->is_left = 1;
        eyesim_unwind(self.frame);
    }
    _longjmp(self.frame->place, LEAVES);
}

/* Handles a stop by the host: the running task was killed or cancelled, or else the program must end. */
static _Noreturn void stop(void);

static int is_cancelled(void);
static struct frame *frame_of_flow(void);
static void turn(void);
static _Noreturn void cancel_self(void);

/* True if a call reaches the host: not outside of the run, and not from destructors while the program ends.
 * A destructor that waits in a loop is left after MOST_IGNORED_CALLS calls. */
static int reaches_host(void)
{
    if (!may_call() || !self.is_leaving)
        return may_call();
    if (++self.ignored_calls > MOST_IGNORED_CALLS)
        _longjmp(self.frame->place, LEAVES);
    return 0;
}

/* Runs after each call: tasks switch only inside calls, so `frame` is that of the task that continues. */
static void returned(int32_t status, struct frame *frame)
{
    self.frame = frame;
    if (status == EYESIM_STOP || is_cancelled())
        stop();
}

#define CALL(table, name, ...)                                                                                          \
    do {                                                                                                                \
        if (reaches_host()) {                                                                                           \
            struct frame *frame_ = self.frame;                                                                          \
            self.call_site.address = __builtin_return_address(0);                                                       \
            returned(self.host->table->name(self.robot, __VA_ARGS__), frame_);                                          \
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

/* A WAV file in memory, with the length from its header, or else a text. */
static struct eyesim_bytes sample_of(const void *sample)
{
    const unsigned char *size = (const unsigned char *)sample + 4;
    if (sample == NULL || strncmp(sample, "RIFF", 4) != 0)
        return text_of(sample);
    return bytes_of(sample, 8 + (size[0] | (size_t)size[1] << 8 | (size_t)size[2] << 16 | (size_t)size[3] << 24));
}

static __attribute__((noinline)) void call_outermost(TimerFnc function)
{
    OUTERMOST;
    function();
    __asm__ volatile("");
}

/* Calls a function of the program for the host. Leaving the program stops here, because frames of the host lie below. */
static int32_t called_back(void *data)
{
    TimerFnc function;
    struct frame frame;
    const struct eyesim_call_site outer_site = self.call_site;
    memcpy(&function, &data, sizeof function);
    frame.outer = frame_of_flow();
    frame.task = frame.outer->task;
    frame.thread = this_thread();
    frame.is_left = frame.jump_value = 0;
    frame.mark = MARK_OF(&frame);
    self.frame = &frame;
    if (setjmp(frame.place) == 0) {
        call_outermost(function);
        self.frame = frame.outer;
        self.call_site = outer_site;
        return self.stop_pending ? EYESIM_STOP : 0;
    }
    self.frame = frame.outer;
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
    if (!self.is_leaving && self.frame->jump_value == TASK_ENDS)
        _longjmp(self.frame->place, TASK_ENDS);
    leave(EYESIM_EXIT_STOPPED);
}

HIDDEN _Bool eyesim_is_left(void) { return self.frame != NULL && self.frame->is_left; }

HIDDEN uint32_t eyesim_entropy(void) { return (uint32_t)random_bits(ENTROPY); }
#endif

/* ---- entry ---- */

extern int main(int argc, char **argv, char **environment);
extern const char __ehdr_start HIDDEN;
extern ElfW(Dyn) _DYNAMIC[] HIDDEN;

/* Copy of the arguments, which `main` may change; kept as long as the library. */
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
    struct frame frame;
    char **arguments = copied_arguments(argc, argv);
    frame.outer = NULL;
    frame.task = &main_task;
    frame.thread = main_task.thread = this_thread();
    frame.is_left = frame.jump_value = 0;
    frame.mark = MARK_OF(&frame);
    main_task.base = &frame;
    self.is_leaving = self.stop_pending = self.ignored_calls = 0;
    self.reader = NULL;
    self.has_told_reader = 0;
    self.host = host;
    self.robot = robot;
    self.frame = &frame;
    switch (setjmp(frame.place)) {
    case 0:
        if (arguments == NULL)
            fail(1, "no memory for the arguments");
        run_program(argc, arguments);
    case TASK_ENDS:
        end_main_task();
        end_program(0);
    }
#ifdef EYESIM_CPP
    if (frame.is_left && setjmp(frame.place) == 0)
        destroy_at_end();
#endif
    self.frame = NULL;
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
