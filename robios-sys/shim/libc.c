/* Interposed functions of the C library, which confine the program to its robot and to virtual time; part of shim.c.
 *
 * Each has its C library name for the linker and another name in this source, so that it cannot clash with the
 * declarations of the system's headers. docs/c-library.md lists them. */
#include <err.h>
#include <errno.h>
#include <error.h>
#include <poll.h>
#include <stdio_ext.h>
#include <sys/select.h>
#include <sys/time.h>
#include <sys/timeb.h>
#include <sys/times.h>
#include <sys/uio.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>
#include <wchar.h>

#define REPLACES(name) __asm__(#name) WEAK
/* Defines `type name arguments` for the linker. */
#define LIBC(type, name, arguments)                                                                                     \
    type libc_##name arguments REPLACES(name);                                                                          \
    type libc_##name arguments
#define LIBC_NORETURN(name, arguments)                                                                                  \
    _Noreturn void libc_##name arguments REPLACES(name);                                                                \
    _Noreturn void libc_##name arguments

/* A part of interposed functions. It is inlined, so its return address is that of the interposed function. */
#define PART static inline __attribute__((always_inline))

/* The numbers of robios_sys::support. */
enum { RAND = 1, RANDOM = 2, DRAND48 = 3, ENTROPY = 4 };
enum {
    FAILED_ABORT = 1,
    FAILED_ASSERTION = 2,
    FAILED_STACK = 4,
    FAILED_EXCEPTION = 6,
    FAILED_IMAGE = 7,
    FAILED_HEAP = 8
};

/* ---- results in memory of the library, to which functions return pointers ---- */

enum { MAX_OUTPUT = 4096 };

struct results {
    char head[16]; /* zero, so that `free` of a result is recognised */
    struct tm calendar;
    char calendar_text[64];
    char digits[400];
    char version[64];
    char machine_name[64];
#if EYESIM_ROBIOS == 7
    char output[MAX_OUTPUT]; /* of a command */
#else
    HDT_entry_type entry;
#endif
};

static struct results *results;

extern void *__libc_calloc(size_t count, size_t len);

/* The robot's results, NULL without memory. Few programs need them, so they are not among the variables, which are copied whenever
 * another robot has run. */
static struct results *own_results(void)
{
    if (results == NULL)
        results = __libc_calloc(1, sizeof *results);
    return results;
}

/* ---- console: lines go to the host; no text stays in a FILE ---- */

/* The streams of this library, instead of the host's. */
WEAK FILE *stdin;
WEAK FILE *stdout;
WEAK FILE *stderr;

/* Sends the collected text. Never exits the program, since a FILE may be in use. */
static void send_line(struct eyesim_console *console)
{
    int32_t result = 0;
    const size_t used = console->used;
    console->used = 0; /* before the call, which may not return: the host prints the remaining text */
    if (used > 0 && self.host != NULL) {
        struct exit_point *exit_point = self.exit_point;
        const void *site = self.call_site.address;
        int32_t status;
        self.call_site.address = __builtin_return_address(0);
        status = self.host->support->console(self.robot, console->stream, bytes_of(console->line, used), &result);
        self.call_site.address = site;
        self.exit_point = exit_point;
        if (status == EYESIM_STOP)
            self.stop_pending = 1;
    }
}

extern void *__libc_malloc(size_t len);
static void check_newest(void);

static void write_console(struct eyesim_console *console, const char *bytes, size_t len)
{
    size_t i;
    check_newest();
    if (console->line == NULL && (console->line = __libc_malloc(EYESIM_CONSOLE_LINE)) == NULL)
        return;
    for (i = 0; i < len; i++) {
        console->line[console->used++] = bytes[i];
        if (bytes[i] == '\n' || console->used == EYESIM_CONSOLE_LINE)
            send_line(console);
    }
}

static ssize_t cookie_write(void *console, const char *bytes, size_t len)
{
    write_console(console, bytes, len);
    return (ssize_t)len;
}

#ifdef EYESIM_CPP
/* Reports once that a stream of the C++ library has read at the end of input: the program's call site is then further
 * out. */
static void report_reader(void)
{
    const void *stack[24];
    int32_t result;
    size_t depth;
    if (self.reader_reported)
        return;
    self.reader_reported = 1;
    depth = eyesim_stack(stack, sizeof stack / sizeof *stack);
    self.host->support->read_at_end(self.robot, bytes_of(stack, depth * sizeof *stack), &result);
}
#endif

/* Reads standard input. Never exits the program, since a FILE may be in use. */
static ssize_t cookie_read(void *console, char *bytes, size_t len)
{
    int32_t count = 0;
    (void)console;
    if (may_call() && !self.is_exiting) {
        struct exit_point *exit_point = self.exit_point;
        const void *site = self.call_site.address;
        int32_t status;
        send_line(OUT); /* a prompt */
        self.call_site.address = self.reader != NULL ? self.reader : __builtin_return_address(0);
        status = self.host->support->input(self.robot, room_of(bytes, len), &count);
#ifdef EYESIM_CPP
        if (status != EYESIM_STOP && count == 0)
            report_reader();
#endif
        self.call_site.address = site;
        self.exit_point = exit_point;
        if (status == EYESIM_STOP) {
            self.stop_pending = 1;
            count = 0;
        }
    }
    return count;
}

static FILE *opened(struct eyesim_console *console, const char *mode)
{
    cookie_io_functions_t functions = {.read = cookie_read, .write = cookie_write};
    FILE *stream = fopencookie(console, mode, functions);
    if (stream != NULL) {
        if (console != NULL)
            setvbuf(stream, NULL, _IONBF, 0);
        /* A thread that is parked forever after a crash must not hold a lock for which the exit of the process waits. */
        __fsetlocking(stream, FSETLOCKING_BYCALLER);
    }
    return stream;
}

/* Runs before the streams of C++ are constructed from these: with priority 90 from GCC 13 on. */
__attribute__((constructor(50))) static void open_console(void)
{
    stdin = opened(NULL, "r");
    stdout = opened(OUT, "w");
    stderr = opened(ERR, "w");
}

__attribute__((destructor(101))) static void close_console(void)
{
    if (self.host != NULL)
        return; /* parked in the middle of its run */
    if (stdin != NULL)
        fclose(stdin);
    if (stdout != NULL)
        fclose(stdout);
    if (stderr != NULL)
        fclose(stderr);
    stdin = stdout = stderr = NULL;
    free(OUT->line);
    free(ERR->line);
    free(results);
    OUT->line = ERR->line = NULL;
    results = NULL;
}

static void flush_console(void)
{
    /* Empty, unless the program has given the streams buffers. */
    if (stdout != NULL)
        fflush_unlocked(stdout);
    if (stderr != NULL)
        fflush_unlocked(stderr);
    send_line(OUT);
    send_line(ERR);
}

/* Runs after output, with no FILE in use: exits the program if the host has stopped it, and lets other tasks run. */
static int written(int result)
{
    if (self.stop_pending && !self.exit_point->is_unwinding)
        exit_program(EYESIM_EXIT_STOPPED);
    yield_if_due();
    return result;
}

static struct eyesim_console *console_of(int descriptor)
{
    return descriptor == 1 ? OUT : descriptor == 2 ? ERR : NULL;
}

/* Passes the variable arguments on to a function that takes a va_list. */
#define WITH_ARGUMENTS(last, call)                                                                                      \
    do {                                                                                                                \
        int result_;                                                                                                    \
        va_list arguments;                                                                                              \
        va_start(arguments, last);                                                                                      \
        result_ = (call);                                                                                               \
        va_end(arguments);                                                                                              \
        return written(result_);                                                                                        \
    } while (0)

/* Functions with a stream argument are interposed only so that a program that does nothing but print can be stopped. */
LIBC(int, fputc, (int c, FILE *stream))
{
    return written(fputc_unlocked(c, stream));
}
LIBC(int, putc, (int c, FILE *stream)) { return libc_fputc(c, stream); }
LIBC(int, _IO_putc, (int c, FILE *stream)) { return libc_fputc(c, stream); }
LIBC(int, fputs, (const char *text, FILE *stream))
{
    return written(fputs_unlocked(text, stream));
}
LIBC(size_t, fwrite, (const void *bytes, size_t size, size_t count, FILE *stream))
{
    count = fwrite_unlocked(bytes, size, count, stream);
    written(0);
    return count;
}
LIBC(int, fprintf, (FILE *stream, const char *format, ...))
{
    WITH_ARGUMENTS(format, vfprintf(stream, format, arguments));
}
LIBC(int, __fprintf_chk, (FILE *stream, int flag, const char *format, ...))
{
    (void)flag;
    WITH_ARGUMENTS(format, vfprintf(stream, format, arguments));
}

LIBC(int, printf, (const char *format, ...)) { WITH_ARGUMENTS(format, vfprintf(stdout, format, arguments)); }
LIBC(int, vprintf, (const char *format, va_list arguments)) { return written(vfprintf(stdout, format, arguments)); }
LIBC(int, __printf_chk, (int flag, const char *format, ...))
{
    (void)flag;
    WITH_ARGUMENTS(format, vfprintf(stdout, format, arguments));
}
LIBC(int, __vprintf_chk, (int flag, const char *format, va_list arguments))
{
    (void)flag;
    return written(vfprintf(stdout, format, arguments));
}
LIBC(int, wprintf, (const wchar_t *format, ...)) { WITH_ARGUMENTS(format, vfwprintf(stdout, format, arguments)); }
LIBC(int, vwprintf, (const wchar_t *format, va_list arguments)) { return written(vfwprintf(stdout, format, arguments)); }
LIBC(int, __wprintf_chk, (int flag, const wchar_t *format, ...))
{
    (void)flag;
    WITH_ARGUMENTS(format, vfwprintf(stdout, format, arguments));
}
LIBC(int, __vwprintf_chk, (int flag, const wchar_t *format, va_list arguments))
{
    (void)flag;
    return written(vfwprintf(stdout, format, arguments));
}
LIBC(int, puts, (const char *text))
{
    if (libc_fputs(text, stdout) < 0)
        return EOF;
    return libc_fputc('\n', stdout);
}
LIBC(int, putchar, (int c)) { return libc_fputc(c, stdout); }
LIBC(int, putchar_unlocked, (int c)) { return libc_fputc(c, stdout); }
LIBC(wint_t, putwchar, (wchar_t c)) { return fputwc(c, stdout); }
LIBC(void, perror, (const char *text))
{
    int number = errno;
    char description[128];
    const char *said = strerror_r(number, description, sizeof description);
    if (text != NULL && *text != '\0')
        libc_fprintf(stderr, "%s: %s\n", text, said);
    else
        libc_fprintf(stderr, "%s\n", said);
}
LIBC(int, fflush, (FILE *stream))
{
    if (stream != NULL)
        return fflush_unlocked(stream);
    /* Flushes no streams of other robots or of the host. */
    fflush_unlocked(stdout);
    return fflush_unlocked(stderr);
}

static int print_to(int descriptor, const char *format, va_list arguments)
{
    if (console_of(descriptor) == NULL) {
        errno = EBADF;
        return -1;
    }
    return written(vfprintf(descriptor == 2 ? stderr : stdout, format, arguments));
}

LIBC(int, vdprintf, (int descriptor, const char *format, va_list arguments))
{
    return print_to(descriptor, format, arguments);
}
LIBC(int, __vdprintf_chk, (int descriptor, int flag, const char *format, va_list arguments))
{
    (void)flag;
    return print_to(descriptor, format, arguments);
}
LIBC(int, dprintf, (int descriptor, const char *format, ...))
{
    WITH_ARGUMENTS(format, print_to(descriptor, format, arguments));
}
LIBC(int, __dprintf_chk, (int descriptor, int flag, const char *format, ...))
{
    (void)flag;
    WITH_ARGUMENTS(format, print_to(descriptor, format, arguments));
}

/* Reading functions are interposed so that a program at the end of its standard input asks the host again each time, which reports
 * it, and so that it can be stopped there. The outermost one records its call site (READER). */
#define READER (self.reader = self.reader != NULL ? self.reader : __builtin_return_address(0))
static void begin_reading(FILE *stream)
{
    if (stream != NULL && stream == stdin)
        clearerr_unlocked(stream);
}
static void end_reading(FILE *stream)
{
    self.reader = NULL;
    if (stream != NULL && stream == stdin)
        written(0);
}
LIBC(int, fgetc, (FILE *stream))
{
    int c;
    READER;
    begin_reading(stream);
    c = fgetc_unlocked(stream);
    end_reading(stream);
    return c;
}
LIBC(int, getc, (FILE *stream))
{
    READER;
    return libc_fgetc(stream);
}
LIBC(int, _IO_getc, (FILE *stream))
{
    READER;
    return libc_fgetc(stream);
}
LIBC(int, getchar, (void))
{
    READER;
    return libc_fgetc(stdin);
}
LIBC(int, getchar_unlocked, (void))
{
    READER;
    return libc_fgetc(stdin);
}
LIBC(wint_t, getwchar, (void))
{
    wint_t c;
    READER;
    begin_reading(stdin);
    c = fgetwc(stdin);
    end_reading(stdin);
    return c;
}
LIBC(char *, fgets, (char *line, int len, FILE *stream))
{
    READER;
    begin_reading(stream);
    line = fgets_unlocked(line, len, stream);
    end_reading(stream);
    return line;
}
LIBC(char *, gets, (char *line))
{
    int c = EOF;
    char *end = line;
    while ((c = libc_fgetc(stdin)) != EOF && c != '\n')
        *end++ = (char)c;
    *end = '\0';
    return c == EOF && end == line ? NULL : line;
}
LIBC(size_t, fread, (void *to, size_t size, size_t count, FILE *stream))
{
    READER;
    begin_reading(stream);
    count = fread_unlocked(to, size, count, stream);
    end_reading(stream);
    return count;
}
PART void *resized(void *memory, size_t len);

/* As the C library's getdelim, in memory with a guard. */
PART ssize_t read_until(int end, char **line, size_t *room, FILE *stream)
{
    size_t used = 0;
    int c = EOF;
    if (line == NULL || room == NULL || stream == NULL) {
        errno = EINVAL;
        return -1;
    }
    if (*line == NULL)
        *room = 0;
    READER;
    begin_reading(stream);
    do {
        if (used + 2 > *room) {
            const size_t more = *room < 60 ? 120 : 2 * *room;
            char *longer = resized(*line, more);
            if (longer == NULL)
                break;
            *line = longer;
            *room = more;
        }
        if ((c = fgetc_unlocked(stream)) != EOF)
            (*line)[used++] = (char)c;
    } while (c != EOF && c != (unsigned char)end);
    if (*line != NULL)
        (*line)[used] = '\0';
    end_reading(stream);
    return used > 0 ? (ssize_t)used : -1;
}
LIBC(ssize_t, getdelim, (char **line, size_t *room, int end, FILE *stream))
{
    return read_until(end, line, room, stream);
}
/* The name by which the C library's headers replace getline. */
LIBC(ssize_t, __getdelim, (char **line, size_t *room, int end, FILE *stream))
{
    return read_until(end, line, room, stream);
}
LIBC(ssize_t, getline, (char **line, size_t *room, FILE *stream))
{
    return read_until('\n', line, room, stream);
}
static int scan(FILE *stream, const char *format, va_list arguments)
{
    int count;
    begin_reading(stream);
    count = vfscanf(stream, format, arguments);
    end_reading(stream);
    return count;
}
LIBC(int, fscanf, (FILE *stream, const char *format, ...)) { WITH_ARGUMENTS(format, (READER, scan(stream, format, arguments))); }
LIBC(int, __isoc99_fscanf, (FILE *stream, const char *format, ...)) { WITH_ARGUMENTS(format, (READER, scan(stream, format, arguments))); }
LIBC(int, __isoc23_fscanf, (FILE *stream, const char *format, ...)) { WITH_ARGUMENTS(format, (READER, scan(stream, format, arguments))); }
LIBC(int, scanf, (const char *format, ...)) { WITH_ARGUMENTS(format, (READER, scan(stdin, format, arguments))); }
LIBC(int, __isoc99_scanf, (const char *format, ...)) { WITH_ARGUMENTS(format, (READER, scan(stdin, format, arguments))); }
LIBC(int, __isoc23_scanf, (const char *format, ...)) { WITH_ARGUMENTS(format, (READER, scan(stdin, format, arguments))); }
LIBC(int, vscanf, (const char *format, va_list arguments))
{
    READER;
    return scan(stdin, format, arguments);
}
LIBC(int, __isoc99_vscanf, (const char *format, va_list arguments))
{
    READER;
    return scan(stdin, format, arguments);
}
LIBC(int, __isoc23_vscanf, (const char *format, va_list arguments))
{
    READER;
    return scan(stdin, format, arguments);
}

extern FILE *_IO_fopen(const char *name, const char *mode); /* another name of the C library for this function */

/* Reports a missing file to the host, since the program may continue with the null pointer. */
LIBC(FILE *, fopen, (const char *name, const char *mode))
{
    FILE *stream = _IO_fopen(name, mode);
    if (stream == NULL) {
        int error = errno;
        int32_t result = 0;
        SUPPORT(open_failed, text_of(name), error, &result);
        errno = error;
    }
    return stream;
}

#ifdef EYESIM_CPP
/* Opens the files of the C++ library's streams. A program that does not check a stream reads nothing, so a failure is reported immediately. */
LIBC(FILE *, fopen64, (const char *name, const char *mode))
{
    FILE *stream = _IO_fopen(name, mode);
    if (stream == NULL) {
        int error = errno;
        int32_t result = 0;
        const void *stack[16];
        const size_t depth = eyesim_stack(stack, sizeof stack / sizeof *stack);
        SUPPORT(open_failed_at, text_of(name), error, bytes_of(stack, depth * sizeof *stack), &result);
        errno = error;
    }
    return stream;
}
#endif

static ssize_t read_input(void *bytes, size_t len)
{
    ssize_t count = cookie_read(NULL, bytes, len);
    self.reader = NULL;
    written(0);
    return count;
}

/* Other C library names of functions that are interposed here. */
extern ssize_t __write(int descriptor, const void *bytes, size_t len);
extern ssize_t __read(int descriptor, void *bytes, size_t len);
extern int __close(int descriptor);

LIBC(ssize_t, write, (int descriptor, const void *bytes, size_t len))
{
    struct eyesim_console *console = console_of(descriptor);
    if (console == NULL)
        return __write(descriptor, bytes, len);
    write_console(console, bytes, len);
    written(0);
    return (ssize_t)len;
}
LIBC(ssize_t, writev, (int descriptor, const struct iovec *parts, int count))
{
    struct eyesim_console *console = console_of(descriptor);
    ssize_t len = 0;
    int i;
    for (i = 0; i < count; i++) {
        ssize_t part = (ssize_t)parts[i].iov_len;
        if (console != NULL)
            write_console(console, parts[i].iov_base, parts[i].iov_len);
        else if ((part = __write(descriptor, parts[i].iov_base, parts[i].iov_len)) < 0)
            return len > 0 ? len : -1;
        len += part;
        if (part < (ssize_t)parts[i].iov_len)
            break;
    }
    if (console != NULL)
        written(0);
    return len;
}
/* Descriptors of the robot's own streams, which have none in the system. */
LIBC(int, fileno, (FILE *stream))
{
    if (stream == NULL || (stream != stdin && stream != stdout && stream != stderr))
        return fileno_unlocked(stream);
    return stream == stdin ? 0 : stream == stdout ? 1 : 2;
}
LIBC(ssize_t, read, (int descriptor, void *bytes, size_t len))
{
    if (descriptor != 0)
        return __read(descriptor, bytes, len);
    READER;
    return read_input(bytes, len);
}
LIBC(ssize_t, __read_chk, (int descriptor, void *bytes, size_t len, size_t room))
{
    len = len < room ? len : room;
    if (descriptor != 0)
        return __read(descriptor, bytes, len);
    READER;
    return read_input(bytes, len);
}
LIBC(int, close, (int descriptor))
{
    /* The first three descriptors belong to the host. */
    return descriptor >= 0 && descriptor <= 2 ? 0 : __close(descriptor);
}
LIBC(int, isatty, (int descriptor))
{
    (void)descriptor;
    errno = ENOTTY;
    return 0;
}
/* Programs that read single keys set the terminal for it; standard input needs no setting. */
LIBC(int, tcgetattr, (int descriptor, struct termios *settings))
{
    (void)descriptor;
    memset(settings, 0, sizeof *settings);
    return 0;
}
LIBC(int, tcsetattr, (int descriptor, int when, const struct termios *settings))
{
    (void)descriptor, (void)when, (void)settings;
    return 0;
}

/* ---- the end of the program ---- */

static int add_at_end(struct at_end **list, struct at_end function)
{
    struct at_end *added = malloc(sizeof *added);
    if (added == NULL)
        return -1;
    *added = function;
    added->previous = *list;
    *list = added;
    return 0;
}

/* Calls the functions registered for the end, in reverse order; each once, even if one of them ends the program again. */
static void call_at_end(struct at_end **list, int exit_code)
{
    while (*list != NULL) {
        struct at_end function = **list;
        free(*list);
        *list = function.previous;
        if (function.without_data != NULL)
            function.without_data();
        else if (function.with_data != NULL)
            function.with_data(function.data);
        else
            function.with_code(exit_code, function.data);
    }
}

#ifdef EYESIM_CPP
/* Destructors of thread-local objects. */
static __thread struct at_end *at_thread_end;

static void end_thread(void)
{
    call_at_end(&at_thread_end, 0);
}

LIBC(int, __cxa_thread_atexit_impl, (void (*function)(void *), void *data, void *library))
{
    struct at_end added = {.with_data = function, .data = data};
    (void)library;
    return add_at_end(&at_thread_end, added);
}

/* Runs the destructors of static objects, for a program that the host stops. */
static void destroy_at_end(void)
{
    end_thread();
    while (self.at_end != NULL) {
        struct at_end function = *self.at_end;
        free(self.at_end);
        self.at_end = function.previous;
        if (function.with_data != NULL)
            function.with_data(function.data);
    }
}
#else
static void end_thread(void) {}
#endif

static _Noreturn void end_program(int exit_code)
{
    if (self.host != NULL) {
        end_thread();
        call_at_end(&self.at_end, exit_code);
    }
    exit_program(exit_code);
}

/* Reports that the program cannot continue, and exits it without running any more of its code. `stack` has `depth` return
   addresses of the calls in progress, the innermost first. */
static _Noreturn void fail_in(const void *const *stack, size_t depth, int32_t kind, const char *text)
{
    int32_t result;
    flush_console();
    SUPPORT(failed, kind, text_of(text), bytes_of(stack, depth * sizeof *stack), &result);
    exit_program(EYESIM_EXIT_ABORTED);
}
static _Noreturn void fail_at(const void *address, int32_t kind, const char *text) { fail_in(&address, 1, kind, text); }
static _Noreturn void fail(int32_t kind, const char *text) { fail_in(NULL, 0, kind, text); }

LIBC_NORETURN(exit, (int exit_code)) { end_program(exit_code); }
LIBC_NORETURN(_exit, (int exit_code)) { exit_program(exit_code); }
LIBC_NORETURN(_Exit, (int exit_code)) { exit_program(exit_code); }
LIBC_NORETURN(quick_exit, (int exit_code))
{
    if (self.host != NULL)
        call_at_end(&self.at_quick_exit, exit_code);
    exit_program(exit_code);
}
LIBC_NORETURN(abort, (void)) { fail_at(__builtin_return_address(0), FAILED_ABORT, "abort() was called"); }

LIBC(int, atexit, (void (*function)(void)))
{
    struct at_end added = {.without_data = function};
    return add_at_end(&self.at_end, added);
}
LIBC(int, at_quick_exit, (void (*function)(void)))
{
    struct at_end added = {.without_data = function};
    return add_at_end(&self.at_quick_exit, added);
}
LIBC(int, on_exit, (void (*function)(int, void *), void *data))
{
    struct at_end added = {.with_code = function, .data = data};
    return add_at_end(&self.at_end, added);
}
LIBC(int, __cxa_atexit, (void (*function)(void *), void *data, void *library))
{
    struct at_end added = {.with_data = function, .data = data};
    (void)library;
    return add_at_end(&self.at_end, added);
}

static _Noreturn void fail_assertion(const char *said, const char *file, unsigned line, const char *function)
{
    char text[512];
    snprintf(text, sizeof text, "%s:%u: %s%sassertion `%s` failed", file, line, function == NULL ? "" : function,
             function == NULL ? "" : ": ", said);
    fail(FAILED_ASSERTION, text);
}

LIBC_NORETURN(__assert_fail, (const char *said, const char *file, unsigned line, const char *function))
{
    fail_assertion(said, file, line, function);
}
LIBC_NORETURN(__assert, (const char *said, const char *file, int line))
{
    fail_assertion(said, file, (unsigned)line, NULL);
}
LIBC_NORETURN(__assert_perror_fail, (int number, const char *file, unsigned line, const char *function))
{
    char description[128];
    fail_assertion(strerror_r(number, description, sizeof description), file, line, function);
}
LIBC_NORETURN(__stack_chk_fail, (void))
{
    check_exit_point();
    fail_at(__builtin_return_address(0), FAILED_STACK, "stack smashing detected: a local array was overrun");
}
LIBC_NORETURN(__chk_fail, (void)) { fail(FAILED_STACK, "buffer overflow detected"); }

/* Prints a message of <err.h> or <error.h>, whose own functions would write to the host's standard error and end the
 * process. */
static void complain(int number, int has_number, const char *format, va_list arguments)
{
    char name[128] = "", description[128];
    int32_t len = 0;
    SUPPORT(program_name, room_of(name, sizeof name - 1), &len);
    libc_fprintf(stderr, "%s: ", name);
    if (format != NULL)
        vfprintf(stderr, format, arguments);
    if (has_number)
        libc_fprintf(stderr, "%s%s", format == NULL ? "" : ": ", strerror_r(number, description, sizeof description));
    libc_fputc('\n', stderr);
}

LIBC(void, vwarn, (const char *format, va_list arguments)) { complain(errno, 1, format, arguments); }
LIBC(void, vwarnx, (const char *format, va_list arguments)) { complain(0, 0, format, arguments); }
LIBC(void, warn, (const char *format, ...))
{
    int number = errno;
    va_list arguments;
    va_start(arguments, format);
    complain(number, 1, format, arguments);
    va_end(arguments);
}
LIBC(void, warnx, (const char *format, ...))
{
    va_list arguments;
    va_start(arguments, format);
    complain(0, 0, format, arguments);
    va_end(arguments);
}
LIBC_NORETURN(verr, (int exit_code, const char *format, va_list arguments))
{
    complain(errno, 1, format, arguments);
    end_program(exit_code);
}
LIBC_NORETURN(verrx, (int exit_code, const char *format, va_list arguments))
{
    complain(0, 0, format, arguments);
    end_program(exit_code);
}
LIBC_NORETURN(err, (int exit_code, const char *format, ...))
{
    int number = errno;
    va_list arguments;
    va_start(arguments, format);
    complain(number, 1, format, arguments);
    va_end(arguments);
    end_program(exit_code);
}
LIBC_NORETURN(errx, (int exit_code, const char *format, ...))
{
    va_list arguments;
    va_start(arguments, format);
    complain(0, 0, format, arguments);
    va_end(arguments);
    end_program(exit_code);
}
LIBC(void, error, (int exit_code, int number, const char *format, ...))
{
    va_list arguments;
    va_start(arguments, format);
    complain(number, number != 0, format, arguments);
    va_end(arguments);
    if (exit_code != 0)
        end_program(exit_code);
}

/* ---- memory: a guard zone behind each block reveals an overrun when the block is freed ---- */

extern void *__libc_realloc(void *memory, size_t len);
extern void __libc_free(void *memory);

/* Last bytes of a guarded block; those between the program's bytes and these are GUARD_BYTE. */
struct guard {
    size_t len; /* length that the program requested */
    uintptr_t canary;
};
#define GUARD_BYTE 0xa5
#define GUARD_LEN (32 + sizeof(struct guard))
#define CANARY_OF_BLOCK(memory) ((uintptr_t)(memory) ^ (uintptr_t)0x9e3779b97f4a7c15)

#ifdef EYESIM_CPP
#define ALLOCATES "`new`, `malloc` or a container"
#else
#define ALLOCATES "`malloc`"
#endif

static char *end_of_block(void *memory) { return (char *)memory + malloc_usable_size(memory) - sizeof(struct guard); }

/* The word that the C library keeps in front of a block: its size and three bits. */
static size_t size_word(const void *memory)
{
    size_t word;
    memcpy(&word, (const char *)memory - sizeof word, sizeof word);
    return word;
}
#define SIZE_BITS (~(size_t)7)

/* True if this word cannot be a size word. Sizes are multiples of 16 from 32 on; those of 4 GiB and more are whole
 * pages, with the bit of a block that has its own mapping. */
static int is_lost(const void *memory)
{
    const size_t word = memory == NULL ? 32 : size_word(memory);
    return word < 32 || (word & 8) != 0 || (word >> 32 != 0 && (word & 0xfff) != 2);
}

/* The block allocated last. A write far beyond its end is detected by glibc first, which aborts the program with a message of its own:
 * this block is checked before glibc can. */
static struct {
    void *memory; /* NULL for none */
    const char *end;
    size_t len, size;
    const void *caller;
} newest;

/* Blocks of at least this length may have a mapping of their own, which may be unmapped while they are checked. */
#define LONG_BLOCK ((size_t)64 << 10)

/* Ends the program with an error at the line that allocated the newest block, if a write went beyond its guard zone and over
 * glibc's size word behind the block. An overrun that ends before this word is reported when the block is freed. */
static void check_newest(void)
{
    char text[192];
    struct guard guard;
    int32_t result;
    if (newest.memory == NULL || !may_call() || self.is_exiting)
        return;
    if ((size_word(newest.memory) & SIZE_BITS) != newest.size) {
        newest.memory = NULL; /* overwritten from below, or freed or grown by a function of the C library */
        return;
    }
    memcpy(&guard, newest.end, sizeof guard);
    if ((guard.canary == CANARY_OF_BLOCK(newest.memory) && guard.len == newest.len) || !is_lost(newest.end + sizeof guard + sizeof(size_t)))
        return;
    newest.memory = NULL;
    snprintf(text, sizeof text, "make a loop in a later line shorter, or reserve more memory: an index is far beyond the end of the %zu bytes reserved", newest.len);
    self.call_site.address = newest.caller;
    self.host->support->failed(self.robot, FAILED_HEAP, text_of(text), bytes_of(&newest.caller, sizeof newest.caller), &result);
    eyesim_trap_heap_lost();
}

static void forget_block(const void *memory)
{
    if (memory == newest.memory)
        newest.memory = NULL;
}

/* Sets the guard of a block of `len` bytes, which the program gets for a call that returns to `caller`; returns the block. */
static void *guarded(void *memory, size_t len, const void *caller)
{
    struct guard guard = {len, CANARY_OF_BLOCK(memory)};
    char *end;
    if (memory != NULL) {
        end = end_of_block(memory);
        memset((char *)memory + len, GUARD_BYTE, (size_t)(end - (char *)memory) - len);
        memcpy(end, &guard, sizeof guard);
        if (len < LONG_BLOCK && may_call()) {
            newest.memory = memory;
            newest.end = end;
            newest.len = len;
            newest.size = size_word(memory) & SIZE_BITS;
            newest.caller = caller;
        }
    }
    return memory;
}

/* Removes the guard of a block that has one. Returns 1 if it was written to: then `len` is the length of the block. */
static int is_overrun(void *memory, size_t *len)
{
    struct guard guard;
    const char *end, *byte;
    if (memory == NULL || malloc_usable_size(memory) < sizeof guard)
        return 0;
    end = end_of_block(memory);
    memcpy(&guard, end, sizeof guard);
    if (guard.canary != CANARY_OF_BLOCK(memory) || guard.len > (size_t)(end - (char *)memory))
        return 0; /* allocated by a function of the C library, or overrun beyond the guard */
    memset((char *)end, 0, sizeof guard);
    for (byte = (char *)memory + guard.len; byte < end; byte++)
        if (*byte != (char)GUARD_BYTE) {
            *len = guard.len;
            return 1;
        }
    return 0;
}

/* Checks a block before the C library frees it. */
PART void check_block(void *memory)
{
    char text[128];
    size_t len;
    int32_t result;
    check_newest();
    forget_block(memory);
    if (is_lost(memory))
        fail_at(__builtin_return_address(0), FAILED_HEAP, "memory before this block was written beyond its end, or the pointer is none of " ALLOCATES);
    if (is_overrun(memory, &len)) {
        snprintf(text, sizeof text, "the program has written beyond the end of these %zu bytes of " ALLOCATES, len);
        SUPPORT(hint, text_of(text), &result);
    }
}

static int has_room_for_guard(size_t len) { return len <= PTRDIFF_MAX - GUARD_LEN; }

static void *allocated(size_t len, const void *caller)
{
    check_newest();
    return has_room_for_guard(len) ? guarded(__libc_malloc(len + GUARD_LEN), len, caller) : __libc_malloc(len);
}
LIBC(void *, malloc, (size_t len)) { return allocated(len, __builtin_return_address(0)); }
#ifdef EYESIM_CPP
/* Allocates for `new`, which the program calls at `caller`. */
HIDDEN void *eyesim_allocated(size_t len, const void *caller) { return allocated(len, caller); }
#endif
LIBC(void *, calloc, (size_t count, size_t len))
{
    size_t whole;
    if (__builtin_mul_overflow(count, len, &whole) || !has_room_for_guard(whole))
        return __libc_calloc(count, len);
    check_newest();
    return guarded(__libc_calloc(1, whole + GUARD_LEN), whole, __builtin_return_address(0));
}
PART void *resized(void *memory, size_t len)
{
    check_block(memory);
    if (len == 0 || !has_room_for_guard(len))
        return __libc_realloc(memory, len);
    return guarded(__libc_realloc(memory, len + GUARD_LEN), len, __builtin_return_address(0));
}
LIBC(void *, realloc, (void *memory, size_t len)) { return resized(memory, len); }
LIBC(void *, reallocarray, (void *memory, size_t count, size_t len))
{
    size_t whole;
    if (__builtin_mul_overflow(count, len, &whole)) {
        errno = ENOMEM;
        return NULL;
    }
    return resized(memory, whole);
}
LIBC(void, free, (void *memory))
{
    check_block(memory);
    __libc_free(memory);
}

/* ---- checked functions of -D_FORTIFY_SOURCE: a failed check would end the host ---- */

static void check_room(size_t needed, size_t room, const char *name)
{
    char text[96];
    if (needed <= room)
        return;
    snprintf(text, sizeof text, "buffer overflow detected in %s: %zu bytes into %zu", name, needed, room);
    fail(FAILED_STACK, text);
}

LIBC(void *, __memcpy_chk, (void *to, const void *from, size_t len, size_t room))
{
    check_room(len, room, "memcpy");
    return memcpy(to, from, len);
}
LIBC(void *, __mempcpy_chk, (void *to, const void *from, size_t len, size_t room))
{
    check_room(len, room, "mempcpy");
    return (char *)memcpy(to, from, len) + len;
}
LIBC(void *, __memmove_chk, (void *to, const void *from, size_t len, size_t room))
{
    check_room(len, room, "memmove");
    return memmove(to, from, len);
}
LIBC(void *, __memset_chk, (void *to, int byte, size_t len, size_t room))
{
    check_room(len, room, "memset");
    return memset(to, byte, len);
}
LIBC(char *, __strcpy_chk, (char *to, const char *from, size_t room))
{
    check_room(strlen(from) + 1, room, "strcpy");
    return strcpy(to, from);
}
LIBC(char *, __stpcpy_chk, (char *to, const char *from, size_t room))
{
    check_room(strlen(from) + 1, room, "stpcpy");
    return stpcpy(to, from);
}
LIBC(char *, __strncpy_chk, (char *to, const char *from, size_t len, size_t room))
{
    check_room(len, room, "strncpy");
    return strncpy(to, from, len);
}
LIBC(char *, __stpncpy_chk, (char *to, const char *from, size_t len, size_t room))
{
    check_room(len, room, "stpncpy");
    return stpncpy(to, from, len);
}
LIBC(char *, __strcat_chk, (char *to, const char *from, size_t room))
{
    check_room(strlen(to) + strlen(from) + 1, room, "strcat");
    return strcat(to, from);
}
LIBC(char *, __strncat_chk, (char *to, const char *from, size_t len, size_t room))
{
    check_room(strlen(to) + strnlen(from, len) + 1, room, "strncat");
    return strncat(to, from, len);
}
LIBC(int, __vsnprintf_chk, (char *to, size_t len, int flag, size_t room, const char *format, va_list arguments))
{
    (void)flag;
    check_room(len, room, "vsnprintf");
    return vsnprintf(to, len, format, arguments);
}
LIBC(int, __snprintf_chk, (char *to, size_t len, int flag, size_t room, const char *format, ...))
{
    int result;
    va_list arguments;
    (void)flag;
    check_room(len, room, "snprintf");
    va_start(arguments, format);
    result = vsnprintf(to, len, format, arguments);
    va_end(arguments);
    return result;
}
/* The largest number means an unknown buffer size: output is then unbounded, as with sprintf. */
static int printed_into(char *to, size_t room, const char *name, const char *format, va_list arguments)
{
    int len;
    if (room == (size_t)-1)
        return vsprintf(to, format, arguments);
    len = vsnprintf(to, room, format, arguments);
    check_room(len < 0 ? 0 : (size_t)len + 1, room, name);
    return len;
}
LIBC(int, __vsprintf_chk, (char *to, int flag, size_t room, const char *format, va_list arguments))
{
    (void)flag;
    return printed_into(to, room, "vsprintf", format, arguments);
}
LIBC(int, __sprintf_chk, (char *to, int flag, size_t room, const char *format, ...))
{
    int result;
    va_list arguments;
    (void)flag;
    va_start(arguments, format);
    result = printed_into(to, room, "sprintf", format, arguments);
    va_end(arguments);
    return result;
}
LIBC(char *, __fgets_chk, (char *to, size_t room, int len, FILE *stream))
{
    check_room(len < 0 ? 0 : (size_t)len, room, "fgets");
    return libc_fgets(to, len, stream);
}
LIBC(size_t, __fread_chk, (void *to, size_t room, size_t size, size_t count, FILE *stream))
{
    check_room(size != 0 && count > (size_t)-1 / size ? (size_t)-1 : size * count, room, "fread");
    return libc_fread(to, size, count, stream);
}

/* ---- jumps: a jump out of a timer's function would leave the host in the middle of the call that the timer interrupts ---- */

/* Stack pointer to which a jump leads; 0 if unknown. The C library hides it with a secret of the thread. */
static uintptr_t target_of(const struct __jmp_buf_tag *buffer)
{
#if defined __x86_64__ && defined __GLIBC__
    uintptr_t hidden = (uintptr_t)buffer->__jmpbuf[6], secret;
    __asm__("mov %%fs:0x30, %0" : "=r"(secret));
    return (hidden >> 17 | hidden << 47) ^ secret;
#else
    (void)buffer;
    return 0;
#endif
}

LIBC_NORETURN(longjmp, (struct __jmp_buf_tag * buffer, int value))
{
    if (may_call() && self.exit_point->outer != NULL && target_of(buffer) > (uintptr_t)self.exit_point)
        fail(0, "longjmp out of a timer's function: the call that it interrupts would never end");
    _longjmp(buffer, value);
}
LIBC_NORETURN(siglongjmp, (struct __jmp_buf_tag * buffer, int value)) { libc_longjmp(buffer, value); }
LIBC_NORETURN(__longjmp_chk, (struct __jmp_buf_tag * buffer, int value)) { libc_longjmp(buffer, value); }

/* ---- random numbers: the robot's own streams ---- */

static uint64_t random_bits(uint32_t purpose)
{
    uint64_t bits = 0;
    SUPPORT(random, purpose, &bits);
    return bits;
}

static void seed(uint32_t purpose, uint64_t value)
{
    int32_t result;
    SUPPORT(seed, purpose, value, &result);
}

LIBC(int, rand, (void)) { return (int)(random_bits(RAND) >> 33); }
LIBC(void, srand, (unsigned value)) { seed(RAND, value); }
LIBC(long, random, (void)) { return (long)(random_bits(RANDOM) >> 33); }
LIBC(void, srandom, (unsigned value)) { seed(RANDOM, value); }

/* The 48-bit generator of POSIX; only its initial state without a seed comes from the robot's own stream. */
static struct {
    int is_seeded;
    uint64_t state, multiplier;
    uint16_t addend;
    unsigned short previous[3];
} lcg = {0, 0, 0x5DEECE66D, 0xB, {0}};

static uint64_t joined(const unsigned short state[3])
{
    return state[0] | (uint64_t)state[1] << 16 | (uint64_t)state[2] << 32;
}

static void split(uint64_t joined, unsigned short state[3])
{
    state[0] = (unsigned short)joined;
    state[1] = (unsigned short)(joined >> 16);
    state[2] = (unsigned short)(joined >> 32);
}

static uint64_t stepped(uint64_t state)
{
    return (state * lcg.multiplier + lcg.addend) & 0xFFFFFFFFFFFF;
}

static uint64_t step_own(void)
{
    if (!lcg.is_seeded) {
        lcg.is_seeded = 1;
        lcg.state = random_bits(DRAND48) >> 16;
    }
    return lcg.state = stepped(lcg.state);
}

static uint64_t step_given(unsigned short state[3])
{
    uint64_t next = stepped(joined(state));
    split(next, state);
    return next;
}

static void start(uint64_t state)
{
    lcg.is_seeded = 1;
    lcg.state = state;
    lcg.multiplier = 0x5DEECE66D;
    lcg.addend = 0xB;
}

LIBC(double, drand48, (void)) { return (double)step_own() / 281474976710656.0; }
LIBC(double, erand48, (unsigned short state[3])) { return (double)step_given(state) / 281474976710656.0; }
LIBC(long, lrand48, (void)) { return (long)(step_own() >> 17); }
LIBC(long, nrand48, (unsigned short state[3])) { return (long)(step_given(state) >> 17); }
LIBC(long, mrand48, (void)) { return (int32_t)(step_own() >> 16); }
LIBC(long, jrand48, (unsigned short state[3])) { return (int32_t)(step_given(state) >> 16); }
LIBC(void, srand48, (long value)) { start((uint64_t)(uint32_t)value << 16 | 0x330E); }
LIBC(unsigned short *, seed48, (unsigned short state[3]))
{
    split(lcg.state, lcg.previous);
    start(joined(state));
    return lcg.previous;
}
LIBC(void, lcong48, (unsigned short parameters[7]))
{
    start(joined(parameters));
    lcg.multiplier = joined(parameters + 3);
    lcg.addend = parameters[6];
}

static void fill_randomly(void *bytes, size_t len)
{
    unsigned char *to = bytes;
    while (len > 0) {
        uint64_t bits = random_bits(ENTROPY);
        size_t part = len < sizeof bits ? len : sizeof bits;
        memcpy(to, &bits, part);
        to += part;
        len -= part;
    }
}

LIBC(ssize_t, getrandom, (void *bytes, size_t len, unsigned flags))
{
    (void)flags;
    fill_randomly(bytes, len);
    return (ssize_t)len;
}
LIBC(int, getentropy, (void *bytes, size_t len))
{
    if (len > 256) {
        errno = EIO;
        return -1;
    }
    fill_randomly(bytes, len);
    return 0;
}
LIBC(uint32_t, arc4random, (void)) { return (uint32_t)random_bits(ENTROPY); }
LIBC(void, arc4random_buf, (void *bytes, size_t len)) { fill_randomly(bytes, len); }
LIBC(uint32_t, arc4random_uniform, (uint32_t bound))
{
    return (uint32_t)((random_bits(ENTROPY) >> 32) * bound >> 32);
}

/* ---- time: the robot's virtual time; the calendar starts on 1 January 2000, 0:00 UTC ---- */

#define CALENDAR_START INT64_C(946684800)
#define MILLION INT64_C(1000000)

static int64_t now_us(void)
{
    int64_t now = 0;
    SUPPORT(time_us, &now);
    return now;
}

static void pass_us(int64_t span)
{
    int32_t result;
    SUPPORT(sleep_us, span, &result);
}

static int refused(const char *name)
{
    libc_fprintf(stderr, "%s is not available to robot programs\n", name);
    errno = ENOSYS;
    return -1;
}

static int refused_timer(const char *name)
{
    libc_fprintf(stderr, "%s is not available to robot programs: OSAttachTimer calls a function at intervals\n", name);
    errno = ENOSYS;
    return -1;
}

LIBC(time_t, time, (time_t *to))
{
    time_t now = (time_t)(CALENDAR_START + now_us() / MILLION);
    if (to != NULL)
        *to = now;
    return now;
}
LIBC(clock_t, clock, (void)) { return (clock_t)now_us(); }
LIBC(int, gettimeofday, (struct timeval *to, void *zone))
{
    int64_t now = now_us();
    (void)zone;
    if (to != NULL) {
        to->tv_sec = (time_t)(CALENDAR_START + now / MILLION);
        to->tv_usec = now % MILLION;
    }
    return 0;
}

static int64_t start_of_s(clockid_t id)
{
    return id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE || id == CLOCK_TAI ? CALENDAR_START : 0;
}

LIBC(int, clock_gettime, (clockid_t id, struct timespec *to))
{
    int64_t now = now_us();
    to->tv_sec = (time_t)(start_of_s(id) + now / MILLION);
    to->tv_nsec = now % MILLION * 1000;
    return 0;
}
LIBC(int, clock_getres, (clockid_t id, struct timespec *to))
{
    (void)id;
    if (to != NULL) {
        to->tv_sec = 0;
        to->tv_nsec = 1000;
    }
    return 0;
}
LIBC(int, timespec_get, (struct timespec *to, int base))
{
    int64_t now = now_us();
    if (base != TIME_UTC)
        return 0;
    to->tv_sec = (time_t)(CALENDAR_START + now / MILLION);
    to->tv_nsec = now % MILLION * 1000;
    return base;
}
LIBC(clock_t, times, (struct tms *to))
{
    clock_t ticks = (clock_t)(now_us() / 10000);
    if (to != NULL) {
        memset(to, 0, sizeof *to);
        to->tms_utime = ticks;
    }
    return ticks;
}
LIBC(int, ftime, (struct timeb *to))
{
    int64_t now = now_us();
    memset(to, 0, sizeof *to);
    to->time = (time_t)(CALENDAR_START + now / MILLION);
    to->millitm = (unsigned short)(now % MILLION / 1000);
    return 0;
}

LIBC(unsigned, sleep, (unsigned seconds))
{
    pass_us(seconds * MILLION);
    return 0;
}
LIBC(int, usleep, (useconds_t span))
{
    pass_us(span);
    return 0;
}

static int is_span(const struct timespec *span)
{
    return span->tv_sec >= 0 && span->tv_nsec >= 0 && span->tv_nsec < 1000000000;
}

/* Rounded up, so that no sleep is too short. */
static int64_t us_of(const struct timespec *span)
{
    int64_t longest = INT64_MAX / MILLION - 1;
    return (span->tv_sec < longest ? span->tv_sec : longest) * MILLION + (span->tv_nsec + 999) / 1000;
}

static void no_rest(struct timespec *rest)
{
    if (rest != NULL)
        rest->tv_sec = rest->tv_nsec = 0;
}

LIBC(int, nanosleep, (const struct timespec *span, struct timespec *rest))
{
    if (!is_span(span)) {
        errno = EINVAL;
        return -1;
    }
    pass_us(us_of(span));
    no_rest(rest);
    return 0;
}
LIBC(int, thrd_sleep, (const struct timespec *span, struct timespec *rest))
{
    if (!is_span(span))
        return -2;
    pass_us(us_of(span));
    no_rest(rest);
    return 0;
}
LIBC(int, clock_nanosleep, (clockid_t id, int flags, const struct timespec *span, struct timespec *rest))
{
    if (!is_span(span))
        return EINVAL;
    if (flags & TIMER_ABSTIME) {
        int64_t left = us_of(span) - start_of_s(id) * MILLION - now_us();
        if (left > 0)
            pass_us(left);
        return 0;
    }
    pass_us(us_of(span));
    no_rest(rest);
    return 0;
}
LIBC(int, pause, (void))
{
    pass_us(INT64_MAX);
    errno = EINTR;
    return -1;
}
/* A wait without file descriptors is a sleep. */
LIBC(int, select, (int count, fd_set *read, fd_set *write, fd_set *except, struct timeval *span))
{
    (void)count;
    if (read != NULL || write != NULL || except != NULL)
        return refused("select on descriptors");
    pass_us(span == NULL ? INT64_MAX : span->tv_sec * MILLION + span->tv_usec);
    return 0;
}
LIBC(int, poll, (struct pollfd * descriptors, nfds_t count, int span_ms))
{
    (void)descriptors;
    if (count > 0)
        return refused("poll on descriptors");
    pass_us(span_ms < 0 ? INT64_MAX : span_ms * INT64_C(1000));
    return 0;
}
LIBC(int, __poll_chk, (struct pollfd * descriptors, nfds_t count, int span_ms, size_t room))
{
    (void)room;
    return libc_poll(descriptors, count, span_ms);
}

LIBC(unsigned, alarm, (unsigned seconds))
{
    (void)seconds;
    refused_timer("alarm");
    return 0;
}
LIBC(useconds_t, ualarm, (useconds_t first, useconds_t next))
{
    (void)first, (void)next;
    refused_timer("ualarm");
    return 0;
}
LIBC(int, setitimer, (int which, const struct itimerval *to, struct itimerval *old))
{
    (void)which, (void)to, (void)old;
    return refused_timer("setitimer");
}
LIBC(int, clock_settime, (clockid_t id, const struct timespec *to))
{
    (void)id, (void)to;
    return refused("clock_settime");
}
LIBC(int, settimeofday, (const struct timeval *to, const void *zone))
{
    (void)to, (void)zone;
    return refused("settimeofday");
}
LIBC(int, timer_create, (clockid_t id, void *event, void *timer))
{
    (void)id, (void)event, (void)timer;
    return refused_timer("timer_create");
}

/* ---- functions with a state or result that all copies of a library would share; local time is UTC ---- */

static char *rest_of_text;

LIBC(char *, strtok, (char *text, const char *separators)) { return strtok_r(text, separators, &rest_of_text); }

static struct tm *calendar_of(const time_t *at)
{
    struct results *own = own_results();
    return own == NULL ? NULL : gmtime_r(at, &own->calendar);
}

static char *calendar_text_of(const struct tm *from)
{
    struct results *own = own_results();
    return own == NULL ? NULL : asctime_r(from, own->calendar_text);
}

LIBC(struct tm *, gmtime, (const time_t *at)) { return calendar_of(at); }
LIBC(struct tm *, localtime, (const time_t *at)) { return calendar_of(at); }
LIBC(struct tm *, localtime_r, (const time_t *at, struct tm *to)) { return gmtime_r(at, to); }
LIBC(time_t, mktime, (struct tm * from)) { return timegm(from); }
LIBC(char *, asctime, (const struct tm *from)) { return calendar_text_of(from); }
LIBC(char *, ctime, (const time_t *at))
{
    struct tm broken;
    return gmtime_r(at, &broken) == NULL ? NULL : calendar_text_of(&broken);
}
LIBC(char *, ctime_r, (const time_t *at, char *to))
{
    struct tm broken;
    return gmtime_r(at, &broken) == NULL ? NULL : asctime_r(&broken, to);
}

LIBC(char *, ecvt, (double value, int count, int *point, int *is_negative))
{
    struct results *own = own_results();
    if (own == NULL || ecvt_r(value, count, point, is_negative, own->digits, sizeof own->digits) != 0)
        return NULL;
    return own->digits;
}
LIBC(char *, fcvt, (double value, int count, int *point, int *is_negative))
{
    struct results *own = own_results();
    if (own == NULL || fcvt_r(value, count, point, is_negative, own->digits, sizeof own->digits) != 0)
        return NULL;
    return own->digits;
}
