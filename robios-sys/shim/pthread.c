/* Threads of POSIX and of C11, which are tasks of the robot; part of shim.c.
 *
 * One task runs at a time, and tasks switch only inside calls to the host: code between two calls is never
 * interrupted, and the state of mutexes and similar objects needs no protection. A function that may affect other tasks
 * costs one call (`begin`), acts after it, and wakes or waits without further cost. A released resource goes to the
 * task that has waited longest.
 *
 * The shim has its own layout of pthread_mutex_t and the other types: all zero is the initial state, and kinds are
 * where the system's initialisers put them. A pthread_t is the number of a task. Attributes have the system's layout. */
#include <limits.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <signal.h>
#include <threads.h>

/* The numbers of robios_sys::support::wait. */
enum { MUTEX = 1, CONDITION, SEMAPHORE, RWLOCK, BARRIER, ONCE, STREAM, TASK_END, TASKS_END };

#define FOREVER INT64_MAX
#define NOW INT64_MIN

/* A task, from its start until it has ended and cannot be joined any more. */
struct task {
    struct task *next;
    int32_t number;
    const void *thread; /* the thread that runs the task */
    struct exit_point *base;
    const void *site;   /* call site of the function that the task is in */
    void *(*start)(void *);
    int (*start_c11)(void *);
    void (*start_plain)(void); /* of OSSpawn */
    void *argument;
    void *result;
    int is_detached, is_joined, has_begun, is_ending, has_ended;
    int is_cancelled, refuses_cancel, cancel_type;
    int is_killed; /* by OSKill or OSExit, which take effect when the host stops the task */
    __pthread_unwind_buf_t *cleanup; /* the innermost handler; the next one is in its first pad */
    const void **values;             /* of keys */
    unsigned value_count;
    int identifier; /* of MTSpawn */
    char name[16];
};

static struct task main_task = {.number = 1};
static struct task *tasks = &main_task;
static int other_tasks; /* number of tasks that have not ended, without that of main */

static struct task *this_task(void) { return may_call() ? self.exit_point->task : &main_task; }

static struct task *task_numbered(pthread_t number)
{
    struct task *task = tasks;
    while (task != NULL && (pthread_t)task->number != number)
        task = task->next;
    return task;
}

/* The innermost exit point of the running flow: of the task on whose stack this function runs. Several tasks may share a thread;
 * stacks do not overlap, and the first exit point of a task is the highest one on its stack. */
static struct exit_point *exit_point_of_flow(void)
{
    const char *here = __builtin_frame_address(0);
    const void *thread = this_thread();
    struct task *task, *own = NULL;
    for (task = tasks; task != NULL; task = task->next)
        if (task->thread == thread && here < (const char *)task->base && (own == NULL || task->base < own->base))
            own = task;
    return own == NULL || (self.exit_point != NULL && self.exit_point->task == own) ? self.exit_point : own->base;
}

/* ---- calls ---- */

/* Calls the host with the call site of the current task; sets the status. Does nothing outside of the run. */
#define TASK_CALL(status, name, ...)                                                                                    \
    do {                                                                                                                \
        status = 0;                                                                                                     \
        if (reaches_host()) {                                                                                           \
            struct exit_point *exit_point_ = self.exit_point;                                                           \
            self.call_site.address = exit_point_->task->site;                                                           \
            status = self.host->support->name(self.robot, __VA_ARGS__);                                                 \
            self.exit_point = exit_point_;                                                                              \
            self.call_site.address = AFTER_CALL(exit_point_->task->site);                                               \
        }                                                                                                               \
    } while (0)

/* Charges the cost of a function called at `site`; returns the calling task. Other tasks may run meanwhile. */
static struct task *begin(const void *site)
{
    struct task *task = this_task();
    int32_t status, number;
    task->site = site;
    TASK_CALL(status, task_self, &number);
    if (status == EYESIM_STOP)
        stop();
    return task;
}
#define BEGIN() begin(__builtin_return_address(0))

/* Waits in the queue of `key` while others run. Returns 1 when woken, 0 at the deadline, -1 when the task is cancelled. */
static int wait_for(const void *key, int32_t kind, int32_t holder, int64_t deadline)
{
    int32_t status, is_woken = 0;
    TASK_CALL(status, task_wait, (uintptr_t)key, kind, holder, deadline, &is_woken);
    if (status == EYESIM_STOP && is_own_stop())
        return -1;
    if (status == EYESIM_STOP)
        stop();
    return is_woken;
}

/* Like wait_for, for functions that are not cancellation points: the task ends here if it was killed while waiting. */
static int wait_unless_killed(const void *key, int32_t kind, int32_t holder, int64_t deadline)
{
    const int is_woken = wait_for(key, kind, holder, deadline);
    if (is_woken < 0)
        cancel_self();
    return is_woken;
}

/* Wakes the task that has waited longest; returns its number, 0 for none. */
static int32_t wake(const void *key)
{
    int32_t status, number = 0;
    TASK_CALL(status, task_wake, (uintptr_t)key, &number);
    (void)status;
    return number;
}

static int32_t wake_all(const void *key)
{
    int32_t status, count = 0;
    TASK_CALL(status, task_wake_all, (uintptr_t)key, &count);
    (void)status;
    return count;
}

/* Lets other tasks run if a tick has passed; called after a section in which tasks must not switch. */
static void yield_if_due(void)
{
    int32_t status, result;
    const void *site = self.call_site.address;
    if (other_tasks == 0)
        return;
    this_task()->site = site;
    TASK_CALL(status, task_turn, &result);
    self.call_site.address = site;
    if (status == EYESIM_STOP)
        stop();
}

/* A point in time given by the program. */
static int is_time(const struct timespec *at) { return at->tv_nsec >= 0 && at->tv_nsec < 1000000000; }
static int64_t deadline_of(clockid_t clock, const struct timespec *at)
{
    return us_of(at) - start_of_s(clock) * MILLION;
}

/* ---- the end of a task ---- */

static struct {
    int is_used;
    void (*destructor)(void *);
} *keys;
static unsigned key_count;

static void call_destructors(struct task *task)
{
    int round, is_done = 0;
    unsigned key;
    for (round = 0; round < PTHREAD_DESTRUCTOR_ITERATIONS && !is_done; round++) {
        is_done = 1;
        for (key = 0; key < task->value_count; key++) {
            void *value = (void *)task->values[key];
            task->values[key] = NULL;
            if (value != NULL && key < key_count && keys[key].is_used && keys[key].destructor != NULL) {
                keys[key].destructor(value);
                is_done = 0;
            }
        }
    }
    free(task->values);
    task->values = NULL;
    task->value_count = 0;
}

/* Removes a task that cannot be joined any more. */
static void forget(struct task *task)
{
    struct task **link = &tasks;
    while (*link != task)
        link = &(*link)->next;
    if (task == &main_task)
        return;
    *link = task->next;
    free(task);
}

static void note_end(struct task *task)
{
    task->has_ended = 1;
    if (task != &main_task) /* keep its stack: timer functions may run on it until the other tasks have ended */
        task->thread = NULL;
    wake(task);
    if (task->is_detached)
        forget(task);
}

/* Counts a task as ended. */
static void remove_task(struct task *task)
{
    if (--other_tasks == 0)
        wake(&other_tasks);
    note_end(task);
}

/* _longjmp: a handler's buffer begins like a jmp_buf but ends before the signal mask. */
_Noreturn void jump_to_handler(__pthread_unwind_buf_t *handler, int value) __asm__("_longjmp");

/* Ends the task, after its cleanup handlers in reverse order. */
static _Noreturn void unwind_task(struct task *task)
{
    __pthread_unwind_buf_t *handler = task->cleanup;
    if (self.exit_point->outer != NULL)
        fail(0, "a timer function would end the task that it interrupts");
    if (handler != NULL) {
        task->cleanup = handler->__pad[0];
        jump_to_handler(handler, 1);
    }
    if (task->start_plain != NULL && !task->base->is_unwinding) {
        task->base->is_unwinding = 1;
        task->base->jump_value = EXIT_TASK;
        eyesim_unwind(task->base);
    }
    _longjmp(task->base->jump_buffer, EXIT_TASK);
}

static _Noreturn void end_task(struct task *task, void *result)
{
    if (!may_call())
        eyesim_trap_off_task();
    task->result = result;
    task->refuses_cancel = task->is_ending = 1;
    unwind_task(task);
}

static __attribute__((noinline)) void *start_outermost(struct task *task)
{
    OUTERMOST;
    if (task->start_plain != NULL) {
        task->start_plain();
        return NULL;
    }
    return task->start != NULL ? task->start(task->argument) : (void *)(intptr_t)task->start_c11(task->argument);
}

/* Runs a task on its own stack. */
static int32_t run_task(void *data)
{
    struct task *const task = data;
    struct exit_point exit_point = {.task = task, .thread = this_thread(), .canary = CANARY_OF(&exit_point)};
    task->thread = exit_point.thread;
    task->base = &exit_point;
    task->has_begun = 1;
    self.exit_point = &exit_point;
    switch (setjmp(exit_point.jump_buffer)) {
    case 0:
        task->result = start_outermost(task);
        /* fall through */
    case EXIT_TASK:
        task->refuses_cancel = task->is_ending = 1;
        end_thread();
        call_destructors(task);
        remove_task(task);
        self.exit_point = NULL;
        return 0;
    default:
        self.exit_point = NULL;
        return EYESIM_STOP;
    }
}

/* Handles pthread_exit in `main`: the program ends when all other tasks have ended. */
static void end_main_task(void)
{
    call_destructors(&main_task);
    note_end(&main_task);
    while (other_tasks > 0)
        wait_for(&other_tasks, TASKS_END, 0, FOREVER);
}

/* ---- tasks ---- */

static void add_task(struct task *task, int32_t number)
{
    struct task **link = &tasks;
    task->number = number;
    while (*link != NULL)
        link = &(*link)->next;
    *link = task;
    other_tasks++;
}

static int spawn_task(const void *site, pthread_t *to, const pthread_attr_t *attributes, struct task what)
{
    struct eyesim_callback callback = {run_task, NULL};
    struct task *task;
    int detached = PTHREAD_CREATE_JOINABLE;
    int32_t status, number = 0;
    begin(site);
    if (!may_call() || (task = malloc(sizeof *task)) == NULL)
        return EAGAIN;
    *task = what;
    if (attributes != NULL)
        pthread_attr_getdetachstate(attributes, &detached);
    task->is_detached = detached == PTHREAD_CREATE_DETACHED;
    callback.data = task;
    TASK_CALL(status, task_spawn, callback, &number);
    if (status == EYESIM_STOP)
        stop();
    if (number == 0) {
        free(task);
        return EAGAIN;
    }
    add_task(task, number);
    *to = (pthread_t)number;
    return 0;
}

static int join_task(const void *site, pthread_t which, void **result, int64_t deadline)
{
    struct task *me = begin(site), *task = task_numbered(which);
    if (is_cancelled())
        cancel_self();
    if (task == NULL)
        return ESRCH;
    if (task == me)
        return EDEADLK;
    if (task->is_detached || task->is_joined)
        return EINVAL;
    if (!task->has_ended) {
        int is_woken;
        if (deadline == NOW)
            return EBUSY;
        task->is_joined = 1;
        is_woken = wait_for(task, TASK_END, task->number, deadline);
        task->is_joined = 0;
        if (is_woken < 0)
            cancel_self();
        if (!is_woken)
            return ETIMEDOUT;
    }
    if (result != NULL)
        *result = task->result;
    forget(task);
    return 0;
}

static int detach_task(const void *site, pthread_t which)
{
    struct task *task;
    begin(site);
    if ((task = task_numbered(which)) == NULL)
        return ESRCH;
    if (task->is_detached)
        return EINVAL;
    task->is_detached = 1;
    if (task->has_ended)
        forget(task);
    return 0;
}

static void give_way(const void *site)
{
    int32_t status, result;
    this_task()->site = site;
    TASK_CALL(status, task_yield, &result);
    if (status == EYESIM_STOP)
        stop();
}

LIBC(int, pthread_create, (pthread_t *to, const pthread_attr_t *attributes, void *(*start)(void *), void *argument))
{
    struct task what = {.start = start, .argument = argument};
    return spawn_task(__builtin_return_address(0), to, attributes, what);
}
LIBC(int, pthread_join, (pthread_t which, void **result))
{
    return join_task(__builtin_return_address(0), which, result, FOREVER);
}
LIBC(int, pthread_tryjoin_np, (pthread_t which, void **result))
{
    return join_task(__builtin_return_address(0), which, result, NOW);
}
LIBC(int, pthread_timedjoin_np, (pthread_t which, void **result, const struct timespec *until))
{
    int64_t deadline = until == NULL ? FOREVER : deadline_of(CLOCK_REALTIME, until);
    return join_task(__builtin_return_address(0), which, result, deadline);
}
LIBC(int, pthread_clockjoin_np, (pthread_t which, void **result, clockid_t clock, const struct timespec *until))
{
    int64_t deadline = until == NULL ? FOREVER : deadline_of(clock, until);
    return join_task(__builtin_return_address(0), which, result, deadline);
}
LIBC(int, pthread_detach, (pthread_t which)) { return detach_task(__builtin_return_address(0), which); }
LIBC_NORETURN(pthread_exit, (void *result)) { end_task(BEGIN(), result); }
LIBC(pthread_t, pthread_self, (void)) { return (pthread_t)this_task()->number; }
LIBC(int, pthread_equal, (pthread_t one, pthread_t other)) { return one == other; }
LIBC(int, sched_yield, (void))
{
    give_way(__builtin_return_address(0));
    return 0;
}
LIBC(int, pthread_yield, (void))
{
    give_way(__builtin_return_address(0));
    return 0;
}

/* One-time initialisation. The control is 0 at first, then minus the number of the initialising task, then 1. */
static void do_once(const void *site, int *once, void (*function)(void))
{
    struct task *me = begin(site);
    if (*once < 0)
        wait_unless_killed(once, ONCE, -*once, FOREVER);
    if (*once != 0)
        return;
    *once = -me->number;
    function();
    *once = 1;
    wake_all(once);
}

LIBC(int, pthread_once, (pthread_once_t *once, void (*function)(void)))
{
    do_once(__builtin_return_address(0), once, function);
    return 0;
}

/* ---- cancellation: at calls that may wait, and at every call of RoBIOS ---- */

static int is_cancelled(void)
{
    struct task *task = self.exit_point == NULL ? NULL : self.exit_point->task;
    return task != NULL && task->is_cancelled && !task->refuses_cancel && self.exit_point->outer == NULL &&
           !self.is_exiting && may_call();
}

static _Noreturn void cancel_self(void) { end_task(this_task(), PTHREAD_CANCELED); }

/* True if a stop by the host concerns only the running task, which was killed or cancelled. */
static int is_own_stop(void)
{
    struct task *task = this_task();
    if (task->is_killed) {
        task->is_cancelled = 1;
        task->is_killed = task->refuses_cancel = 0;
    }
    return is_cancelled();
}

static _Noreturn void stop(void)
{
    if (is_own_stop())
        cancel_self();
    exit_program(EYESIM_EXIT_STOPPED);
}

LIBC(int, pthread_cancel, (pthread_t which))
{
    struct task *me = BEGIN(), *task = task_numbered(which);
    int32_t status, result;
    if (task == NULL)
        return ESRCH;
    task->is_cancelled = 1;
    if (task != me && !task->refuses_cancel && !task->has_ended)
        TASK_CALL(status, task_interrupt, task->number, &result);
    (void)status;
    return 0;
}
LIBC(void, pthread_testcancel, (void))
{
    BEGIN();
    if (is_cancelled())
        cancel_self();
}
LIBC(int, pthread_setcancelstate, (int state, int *old))
{
    struct task *task = BEGIN();
    if (state != PTHREAD_CANCEL_ENABLE && state != PTHREAD_CANCEL_DISABLE)
        return EINVAL;
    if (old != NULL)
        *old = task->refuses_cancel ? PTHREAD_CANCEL_DISABLE : PTHREAD_CANCEL_ENABLE;
    task->refuses_cancel = state == PTHREAD_CANCEL_DISABLE;
    return 0;
}
LIBC(int, pthread_setcanceltype, (int type, int *old))
{
    struct task *task = BEGIN();
    if (type != PTHREAD_CANCEL_DEFERRED && type != PTHREAD_CANCEL_ASYNCHRONOUS)
        return EINVAL;
    if (old != NULL)
        *old = task->cancel_type;
    task->cancel_type = type;
    return 0;
}

/* Functions that the macros pthread_cleanup_push and pop expand to in C. */
LIBC(void, __pthread_register_cancel, (__pthread_unwind_buf_t * handler))
{
    struct task *task = this_task();
    handler->__pad[0] = task->cleanup;
    task->cleanup = handler;
}
LIBC(void, __pthread_unregister_cancel, (__pthread_unwind_buf_t * handler))
{
    this_task()->cleanup = handler->__pad[0];
}
LIBC(void, __pthread_register_cancel_defer, (__pthread_unwind_buf_t * handler))
{
    libc___pthread_register_cancel(handler);
}
LIBC(void, __pthread_unregister_cancel_restore, (__pthread_unwind_buf_t * handler))
{
    libc___pthread_unregister_cancel(handler);
}
LIBC_NORETURN(__pthread_unwind_next, (__pthread_unwind_buf_t * handler))
{
    (void)handler;
    unwind_task(this_task());
}

/* ---- mutexes ---- */

enum { KIND_MASK = 3 };

static void release_mutex(pthread_mutex_t *mutex)
{
    mutex->__data.__owner = wake(mutex);
    mutex->__data.__count = mutex->__data.__owner != 0;
}

static int acquire_mutex(struct task *me, pthread_mutex_t *mutex, int64_t deadline)
{
    int kind = mutex->__data.__kind & KIND_MASK;
    if (mutex->__data.__owner == 0) {
        mutex->__data.__owner = me->number;
        mutex->__data.__count = 1;
        return 0;
    }
    if (mutex->__data.__owner == me->number && kind == PTHREAD_MUTEX_RECURSIVE_NP) {
        mutex->__data.__count++;
        return 0;
    }
    if (deadline == NOW)
        return EBUSY;
    if (mutex->__data.__owner == me->number && kind == PTHREAD_MUTEX_ERRORCHECK_NP)
        return EDEADLK;
    return wait_unless_killed(mutex, MUTEX, mutex->__data.__owner, deadline) ? 0 : ETIMEDOUT;
}

static int lock_until(const void *site, pthread_mutex_t *mutex, clockid_t clock, const struct timespec *until)
{
    struct task *me = begin(site);
    if (!is_time(until))
        return mutex->__data.__owner == 0 ? acquire_mutex(me, mutex, NOW) : EINVAL;
    return acquire_mutex(me, mutex, deadline_of(clock, until));
}

static int unlock(struct task *me, pthread_mutex_t *mutex)
{
    int kind = mutex->__data.__kind & KIND_MASK;
    int is_checked = kind == PTHREAD_MUTEX_RECURSIVE_NP || kind == PTHREAD_MUTEX_ERRORCHECK_NP;
    if (is_checked && mutex->__data.__owner != me->number)
        return EPERM;
    if (mutex->__data.__count > 1)
        mutex->__data.__count--;
    else
        release_mutex(mutex);
    return 0;
}

LIBC(int, pthread_mutex_init, (pthread_mutex_t *mutex, const pthread_mutexattr_t *attributes))
{
    int kind = PTHREAD_MUTEX_DEFAULT;
    BEGIN();
    memset(mutex, 0, sizeof *mutex);
    if (attributes != NULL)
        pthread_mutexattr_gettype(attributes, &kind);
    mutex->__data.__kind = kind;
    return 0;
}
LIBC(int, pthread_mutex_destroy, (pthread_mutex_t *mutex))
{
    BEGIN();
    return mutex->__data.__owner != 0 ? EBUSY : 0;
}
LIBC(int, pthread_mutex_lock, (pthread_mutex_t *mutex)) { return acquire_mutex(BEGIN(), mutex, FOREVER); }
LIBC(int, pthread_mutex_trylock, (pthread_mutex_t *mutex)) { return acquire_mutex(BEGIN(), mutex, NOW); }
LIBC(int, pthread_mutex_timedlock, (pthread_mutex_t *mutex, const struct timespec *until))
{
    return lock_until(__builtin_return_address(0), mutex, CLOCK_REALTIME, until);
}
LIBC(int, pthread_mutex_clocklock, (pthread_mutex_t *mutex, clockid_t clock, const struct timespec *until))
{
    return lock_until(__builtin_return_address(0), mutex, clock, until);
}
LIBC(int, pthread_mutex_unlock, (pthread_mutex_t *mutex)) { return unlock(BEGIN(), mutex); }
LIBC(int, pthread_mutex_consistent, (pthread_mutex_t *mutex))
{
    (void)mutex;
    return EINVAL;
}

LIBC(int, pthread_spin_init, (pthread_spinlock_t *lock, int shared))
{
    (void)shared;
    BEGIN();
    *lock = 0;
    return 0;
}
LIBC(int, pthread_spin_destroy, (pthread_spinlock_t *lock))
{
    (void)lock;
    return 0;
}
LIBC(int, pthread_spin_lock, (pthread_spinlock_t *lock))
{
    struct task *me = BEGIN();
    if (*lock == 0)
        *lock = me->number;
    else if (*lock == me->number)
        return EDEADLK;
    else
        wait_unless_killed((const void *)lock, MUTEX, *lock, FOREVER);
    return 0;
}
LIBC(int, pthread_spin_trylock, (pthread_spinlock_t *lock))
{
    struct task *me = BEGIN();
    if (*lock != 0)
        return EBUSY;
    *lock = me->number;
    return 0;
}
LIBC(int, pthread_spin_unlock, (pthread_spinlock_t *lock))
{
    BEGIN();
    *lock = wake((const void *)lock);
    return 0;
}

/* ---- condition variables ---- */

struct condition {
    clockid_t clock;
};

static struct condition *condition_of(pthread_cond_t *condition) { return (struct condition *)condition; }

static int wait_on_condition(const void *site, pthread_cond_t *condition, pthread_mutex_t *mutex, clockid_t clock,
                             const struct timespec *until)
{
    struct task *me = begin(site);
    unsigned count = mutex->__data.__count;
    int is_woken;
    if (is_cancelled())
        cancel_self();
    if (until != NULL && !is_time(until))
        return EINVAL;
    release_mutex(mutex);
    is_woken = wait_for(condition, CONDITION, 0, until == NULL ? FOREVER : deadline_of(clock, until));
    if (mutex->__data.__owner == 0)
        mutex->__data.__owner = me->number;
    else
        wait_for(mutex, MUTEX, mutex->__data.__owner, FOREVER);
    mutex->__data.__count = count;
    if (is_woken < 0)
        cancel_self();
    return is_woken ? 0 : ETIMEDOUT;
}

LIBC(int, pthread_cond_init, (pthread_cond_t *condition, const pthread_condattr_t *attributes))
{
    clockid_t clock = CLOCK_REALTIME;
    BEGIN();
    memset(condition, 0, sizeof *condition);
    if (attributes != NULL)
        pthread_condattr_getclock(attributes, &clock);
    condition_of(condition)->clock = clock;
    return 0;
}
LIBC(int, pthread_cond_destroy, (pthread_cond_t *condition))
{
    (void)condition;
    BEGIN();
    return 0;
}
LIBC(int, pthread_cond_wait, (pthread_cond_t *condition, pthread_mutex_t *mutex))
{
    return wait_on_condition(__builtin_return_address(0), condition, mutex, CLOCK_REALTIME, NULL);
}
LIBC(int, pthread_cond_timedwait, (pthread_cond_t *condition, pthread_mutex_t *mutex, const struct timespec *until))
{
    return wait_on_condition(__builtin_return_address(0), condition, mutex, condition_of(condition)->clock, until);
}
LIBC(int, pthread_cond_clockwait,
     (pthread_cond_t *condition, pthread_mutex_t *mutex, clockid_t clock, const struct timespec *until))
{
    return wait_on_condition(__builtin_return_address(0), condition, mutex, clock, until);
}
LIBC(int, pthread_cond_signal, (pthread_cond_t *condition))
{
    BEGIN();
    wake(condition);
    return 0;
}
LIBC(int, pthread_cond_broadcast, (pthread_cond_t *condition))
{
    BEGIN();
    wake_all(condition);
    return 0;
}

/* ---- locks of streams: the system's locks would stop the whole robot ---- */

struct stream_lock {
    struct stream_lock *next;
    FILE *stream;
    int32_t owner;
    unsigned count;
};

static struct stream_lock *stream_locks;

static struct stream_lock **lock_of(const FILE *stream)
{
    struct stream_lock **link = &stream_locks;
    while (*link != NULL && (*link)->stream != stream)
        link = &(*link)->next;
    return link;
}

static int lock_stream(struct task *me, FILE *stream, int may_wait)
{
    struct stream_lock **link = lock_of(stream), *lock = *link;
    if (lock == NULL) {
        if ((lock = calloc(1, sizeof *lock)) == NULL)
            return ENOMEM;
        lock->stream = stream;
        lock->owner = me->number;
        *link = lock;
    }
    if (lock->owner != me->number) {
        if (!may_wait)
            return EBUSY;
        wait_unless_killed(lock, STREAM, lock->owner, FOREVER);
    }
    lock->count++;
    return 0;
}

LIBC(void, flockfile, (FILE *stream)) { lock_stream(BEGIN(), stream, 1); }
LIBC(int, ftrylockfile, (FILE *stream)) { return lock_stream(BEGIN(), stream, 0); }
LIBC(void, funlockfile, (FILE *stream))
{
    struct task *me = BEGIN();
    struct stream_lock **link = lock_of(stream), *lock = *link;
    if (lock == NULL || lock->owner != me->number || --lock->count > 0)
        return;
    if ((lock->owner = wake(lock)) == 0) {
        *link = lock->next;
        free(lock);
    }
}

/* ---- semaphores ---- */

struct semaphore {
    unsigned value;
};

static int failed_with(int number)
{
    errno = number;
    return -1;
}

static int take_semaphore(const void *site, sem_t *sem, int64_t deadline)
{
    struct semaphore *semaphore = (struct semaphore *)sem;
    int is_woken;
    begin(site);
    if (is_cancelled())
        cancel_self();
    if (semaphore->value > 0) {
        semaphore->value--;
        return 0;
    }
    if (deadline == NOW)
        return failed_with(EAGAIN);
    is_woken = wait_for(sem, SEMAPHORE, 0, deadline);
    if (is_woken < 0)
        cancel_self();
    return is_woken ? 0 : failed_with(ETIMEDOUT);
}

LIBC(int, sem_init, (sem_t *sem, int shared, unsigned value))
{
    (void)shared;
    BEGIN();
    if (value > SEM_VALUE_MAX)
        return failed_with(EINVAL);
    memset(sem, 0, sizeof *sem);
    ((struct semaphore *)sem)->value = value;
    return 0;
}
LIBC(int, sem_destroy, (sem_t *sem))
{
    (void)sem;
    BEGIN();
    return 0;
}
LIBC(int, sem_wait, (sem_t *sem)) { return take_semaphore(__builtin_return_address(0), sem, FOREVER); }
LIBC(int, sem_trywait, (sem_t *sem)) { return take_semaphore(__builtin_return_address(0), sem, NOW); }
LIBC(int, sem_clockwait, (sem_t *sem, clockid_t clock, const struct timespec *until))
{
    if (!is_time(until))
        return failed_with(EINVAL);
    return take_semaphore(__builtin_return_address(0), sem, deadline_of(clock, until));
}
LIBC(int, sem_timedwait, (sem_t *sem, const struct timespec *until))
{
    if (!is_time(until))
        return failed_with(EINVAL);
    return take_semaphore(__builtin_return_address(0), sem, deadline_of(CLOCK_REALTIME, until));
}
LIBC(int, sem_post, (sem_t *sem))
{
    struct semaphore *semaphore = (struct semaphore *)sem;
    BEGIN();
    if (semaphore->value == SEM_VALUE_MAX)
        return failed_with(EOVERFLOW);
    if (wake(sem) == 0)
        semaphore->value++;
    return 0;
}
LIBC(int, sem_getvalue, (sem_t *sem, int *value))
{
    BEGIN();
    *value = (int)((struct semaphore *)sem)->value;
    return 0;
}
LIBC(sem_t *, sem_open, (const char *name, int flags, ...))
{
    (void)name, (void)flags;
    refused("sem_open");
    return SEM_FAILED;
}

/* ---- read-write locks: readers have precedence, as in the system's locks, unless the lock's kind prefers writers ---- */

static const void *writers_of(const pthread_rwlock_t *lock) { return (const char *)lock + 1; }

static int acquire_to_read(const void *site, pthread_rwlock_t *lock, int64_t deadline)
{
    struct task *me = begin(site);
    int prefers_writers = lock->__data.__flags == PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP;
    if (lock->__data.__cur_writer == 0 && !(prefers_writers && lock->__data.__writers > 0)) {
        lock->__data.__readers++;
        return 0;
    }
    if (deadline == NOW)
        return EBUSY;
    if (lock->__data.__cur_writer == me->number)
        return EDEADLK;
    return wait_unless_killed(lock, RWLOCK, lock->__data.__cur_writer, deadline) ? 0 : ETIMEDOUT;
}

static int acquire_to_write(const void *site, pthread_rwlock_t *lock, int64_t deadline)
{
    struct task *me = begin(site);
    int is_woken;
    if (lock->__data.__cur_writer == 0 && lock->__data.__readers == 0) {
        lock->__data.__cur_writer = me->number;
        return 0;
    }
    if (deadline == NOW)
        return EBUSY;
    if (lock->__data.__cur_writer == me->number)
        return EDEADLK;
    lock->__data.__writers++;
    is_woken = wait_for(writers_of(lock), RWLOCK, lock->__data.__cur_writer, deadline);
    lock->__data.__writers--;
    /* Readers that waited for this writer now share the lock with those that hold it. */
    if (is_woken <= 0 && lock->__data.__cur_writer == 0 && lock->__data.__writers == 0)
        lock->__data.__readers += (unsigned)wake_all(lock);
    if (is_woken < 0)
        cancel_self();
    return is_woken ? 0 : ETIMEDOUT;
}

LIBC(int, pthread_rwlock_init, (pthread_rwlock_t *lock, const pthread_rwlockattr_t *attributes))
{
    int kind = PTHREAD_RWLOCK_DEFAULT_NP;
    BEGIN();
    memset(lock, 0, sizeof *lock);
    if (attributes != NULL)
        pthread_rwlockattr_getkind_np(attributes, &kind);
    lock->__data.__flags = (unsigned char)kind;
    return 0;
}
LIBC(int, pthread_rwlock_destroy, (pthread_rwlock_t *lock))
{
    BEGIN();
    return lock->__data.__cur_writer != 0 || lock->__data.__readers > 0 ? EBUSY : 0;
}
LIBC(int, pthread_rwlock_rdlock, (pthread_rwlock_t *lock))
{
    return acquire_to_read(__builtin_return_address(0), lock, FOREVER);
}
LIBC(int, pthread_rwlock_tryrdlock, (pthread_rwlock_t *lock))
{
    return acquire_to_read(__builtin_return_address(0), lock, NOW);
}
LIBC(int, pthread_rwlock_timedrdlock, (pthread_rwlock_t *lock, const struct timespec *until))
{
    if (!is_time(until))
        return EINVAL;
    return acquire_to_read(__builtin_return_address(0), lock, deadline_of(CLOCK_REALTIME, until));
}
LIBC(int, pthread_rwlock_clockrdlock, (pthread_rwlock_t *lock, clockid_t clock, const struct timespec *until))
{
    if (!is_time(until))
        return EINVAL;
    return acquire_to_read(__builtin_return_address(0), lock, deadline_of(clock, until));
}
LIBC(int, pthread_rwlock_wrlock, (pthread_rwlock_t *lock))
{
    return acquire_to_write(__builtin_return_address(0), lock, FOREVER);
}
LIBC(int, pthread_rwlock_trywrlock, (pthread_rwlock_t *lock))
{
    return acquire_to_write(__builtin_return_address(0), lock, NOW);
}
LIBC(int, pthread_rwlock_timedwrlock, (pthread_rwlock_t *lock, const struct timespec *until))
{
    if (!is_time(until))
        return EINVAL;
    return acquire_to_write(__builtin_return_address(0), lock, deadline_of(CLOCK_REALTIME, until));
}
LIBC(int, pthread_rwlock_clockwrlock, (pthread_rwlock_t *lock, clockid_t clock, const struct timespec *until))
{
    if (!is_time(until))
        return EINVAL;
    return acquire_to_write(__builtin_return_address(0), lock, deadline_of(clock, until));
}
LIBC(int, pthread_rwlock_unlock, (pthread_rwlock_t *lock))
{
    int prefers_writers = lock->__data.__flags == PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP;
    BEGIN();
    if (lock->__data.__cur_writer != 0)
        lock->__data.__cur_writer = 0;
    else if (lock->__data.__readers > 0)
        lock->__data.__readers--;
    else
        return EPERM;
    if (lock->__data.__readers > 0)
        return 0;
    if (prefers_writers)
        lock->__data.__cur_writer = wake(writers_of(lock));
    if (lock->__data.__cur_writer == 0)
        lock->__data.__readers = (unsigned)wake_all(lock);
    if (lock->__data.__cur_writer == 0 && lock->__data.__readers == 0)
        lock->__data.__cur_writer = wake(writers_of(lock));
    return 0;
}

/* ---- barriers ---- */

struct barrier {
    unsigned count, arrived;
};

LIBC(int, pthread_barrier_init,
     (pthread_barrier_t *to, const pthread_barrierattr_t *attributes, unsigned count))
{
    struct barrier *barrier = (struct barrier *)to;
    (void)attributes;
    BEGIN();
    if (count == 0)
        return EINVAL;
    barrier->count = count;
    barrier->arrived = 0;
    return 0;
}
LIBC(int, pthread_barrier_destroy, (pthread_barrier_t *to))
{
    BEGIN();
    return ((struct barrier *)to)->arrived > 0 ? EBUSY : 0;
}
LIBC(int, pthread_barrier_wait, (pthread_barrier_t *at))
{
    struct barrier *barrier = (struct barrier *)at;
    BEGIN();
    if (++barrier->arrived < barrier->count) {
        if (wait_for(at, BARRIER, 0, FOREVER) < 0) {
            barrier->arrived--;
            cancel_self();
        }
        return 0;
    }
    barrier->arrived = 0;
    wake_all(at);
    return PTHREAD_BARRIER_SERIAL_THREAD;
}

/* ---- thread-specific values ---- */

static int add_key(unsigned *to, void (*destructor)(void *))
{
    unsigned key = 0;
    while (key < key_count && keys[key].is_used)
        key++;
    if (key == PTHREAD_KEYS_MAX)
        return EAGAIN;
    if (key == key_count) {
        void *more = realloc(keys, (key_count + 1) * sizeof *keys);
        if (more == NULL)
            return ENOMEM;
        keys = more;
        key_count++;
    }
    keys[key].is_used = 1;
    keys[key].destructor = destructor;
    *to = key;
    return 0;
}

static int remove_key(unsigned key)
{
    struct task *task;
    if (key >= key_count || !keys[key].is_used)
        return EINVAL;
    keys[key].is_used = 0;
    for (task = tasks; task != NULL; task = task->next)
        if (key < task->value_count)
            task->values[key] = NULL;
    return 0;
}

static int set_value(unsigned key, const void *value)
{
    struct task *task = this_task();
    if (key >= key_count || !keys[key].is_used)
        return EINVAL;
    if (key >= task->value_count) {
        const void **more = realloc(task->values, (key + 1) * sizeof *more);
        if (more == NULL)
            return ENOMEM;
        memset(more + task->value_count, 0, (key + 1 - task->value_count) * sizeof *more);
        task->values = more;
        task->value_count = key + 1;
    }
    task->values[key] = value;
    return 0;
}

static void *value_of(unsigned key)
{
    struct task *task = this_task();
    return key < task->value_count ? (void *)task->values[key] : NULL;
}

LIBC(int, pthread_key_create, (pthread_key_t *key, void (*destructor)(void *))) { return add_key(key, destructor); }
LIBC(int, pthread_key_delete, (pthread_key_t key)) { return remove_key(key); }
LIBC(int, pthread_setspecific, (pthread_key_t key, const void *value)) { return set_value(key, value); }
LIBC(void *, pthread_getspecific, (pthread_key_t key)) { return value_of(key); }

/* ---- other functions of threads: accepted, without an effect ---- */

LIBC(int, pthread_setname_np, (pthread_t which, const char *name))
{
    struct task *task = task_numbered(which);
    if (task == NULL)
        return ESRCH;
    if (strlen(name) >= sizeof task->name)
        return ERANGE;
    strcpy(task->name, name);
    return 0;
}
LIBC(int, pthread_getname_np, (pthread_t which, char *name, size_t room))
{
    struct task *task = task_numbered(which);
    if (task == NULL)
        return ESRCH;
    if (strlen(task->name) >= room)
        return ERANGE;
    strcpy(name, task->name);
    return 0;
}
LIBC(int, pthread_getattr_np, (pthread_t which, pthread_attr_t *attributes))
{
    struct task *task = task_numbered(which);
    if (task == NULL)
        return ESRCH;
    pthread_attr_init(attributes);
    return pthread_attr_setdetachstate(attributes,
                                       task->is_detached ? PTHREAD_CREATE_DETACHED : PTHREAD_CREATE_JOINABLE);
}
LIBC(int, pthread_setschedparam, (pthread_t which, int policy, const struct sched_param *parameters))
{
    (void)policy, (void)parameters;
    return task_numbered(which) == NULL ? ESRCH : 0;
}
LIBC(int, pthread_getschedparam, (pthread_t which, int *policy, struct sched_param *parameters))
{
    if (task_numbered(which) == NULL)
        return ESRCH;
    *policy = SCHED_OTHER;
    parameters->sched_priority = 0;
    return 0;
}
LIBC(int, pthread_setschedprio, (pthread_t which, int priority))
{
    (void)priority;
    return task_numbered(which) == NULL ? ESRCH : 0;
}
LIBC(int, pthread_setaffinity_np, (pthread_t which, size_t size, const cpu_set_t *processors))
{
    (void)size, (void)processors;
    return task_numbered(which) == NULL ? ESRCH : 0;
}
LIBC(int, pthread_getaffinity_np, (pthread_t which, size_t size, cpu_set_t *processors))
{
    if (task_numbered(which) == NULL)
        return ESRCH;
    CPU_ZERO_S(size, processors);
    CPU_SET_S(0, size, processors);
    return 0;
}
LIBC(int, pthread_getcpuclockid, (pthread_t which, clockid_t *clock))
{
    *clock = CLOCK_THREAD_CPUTIME_ID;
    return task_numbered(which) == NULL ? ESRCH : 0;
}
LIBC(int, pthread_kill, (pthread_t which, int signal_number))
{
    struct task *task;
    BEGIN();
    if ((task = task_numbered(which)) == NULL || task->has_ended)
        return ESRCH;
    if (signal_number == 0)
        return 0;
    refused("pthread_kill");
    return EINVAL;
}

/* ---- C11 ---- */

static int as_c11(int number)
{
    switch (number) {
    case 0:
        return thrd_success;
    case EBUSY:
        return thrd_busy;
    case ENOMEM:
        return thrd_nomem;
    case ETIMEDOUT:
        return thrd_timedout;
    default:
        return thrd_error;
    }
}

LIBC(int, thrd_create, (thrd_t * to, thrd_start_t start, void *argument))
{
    struct task what = {.start_c11 = start, .argument = argument};
    int number = spawn_task(__builtin_return_address(0), to, NULL, what);
    return as_c11(number == EAGAIN ? ENOMEM : number);
}
LIBC(int, thrd_join, (thrd_t which, int *result))
{
    void *value = NULL;
    int number = join_task(__builtin_return_address(0), which, &value, FOREVER);
    if (number == 0 && result != NULL)
        *result = (int)(intptr_t)value;
    return as_c11(number);
}
LIBC(int, thrd_detach, (thrd_t which)) { return as_c11(detach_task(__builtin_return_address(0), which)); }
LIBC_NORETURN(thrd_exit, (int result)) { end_task(BEGIN(), (void *)(intptr_t)result); }
LIBC(thrd_t, thrd_current, (void)) { return (thrd_t)this_task()->number; }
LIBC(int, thrd_equal, (thrd_t one, thrd_t other)) { return one == other; }
LIBC(void, thrd_yield, (void)) { give_way(__builtin_return_address(0)); }
LIBC(int, mtx_init, (mtx_t * mutex, int type))
{
    BEGIN();
    memset(mutex, 0, sizeof *mutex);
    ((pthread_mutex_t *)mutex)->__data.__kind = type & mtx_recursive ? PTHREAD_MUTEX_RECURSIVE_NP : PTHREAD_MUTEX_NORMAL;
    return thrd_success;
}
LIBC(void, mtx_destroy, (mtx_t * mutex)) { (void)mutex; }
LIBC(int, mtx_lock, (mtx_t * mutex)) { return as_c11(acquire_mutex(BEGIN(), (pthread_mutex_t *)mutex, FOREVER)); }
LIBC(int, mtx_trylock, (mtx_t * mutex)) { return as_c11(acquire_mutex(BEGIN(), (pthread_mutex_t *)mutex, NOW)); }
LIBC(int, mtx_timedlock, (mtx_t *restrict mutex, const struct timespec *restrict until))
{
    return as_c11(lock_until(__builtin_return_address(0), (pthread_mutex_t *)mutex, CLOCK_REALTIME, until));
}
LIBC(int, mtx_unlock, (mtx_t * mutex)) { return as_c11(unlock(BEGIN(), (pthread_mutex_t *)mutex)); }
LIBC(void, call_once, (once_flag * once, void (*function)(void)))
{
    do_once(__builtin_return_address(0), (int *)once, function);
}
LIBC(int, cnd_init, (cnd_t * condition))
{
    BEGIN();
    memset(condition, 0, sizeof *condition);
    return thrd_success;
}
LIBC(void, cnd_destroy, (cnd_t * condition)) { (void)condition; }
LIBC(int, cnd_signal, (cnd_t * condition))
{
    BEGIN();
    wake(condition);
    return thrd_success;
}
LIBC(int, cnd_broadcast, (cnd_t * condition))
{
    BEGIN();
    wake_all(condition);
    return thrd_success;
}
LIBC(int, cnd_wait, (cnd_t * condition, mtx_t *mutex))
{
    return as_c11(wait_on_condition(__builtin_return_address(0), (pthread_cond_t *)condition,
                                    (pthread_mutex_t *)mutex, CLOCK_REALTIME, NULL));
}
LIBC(int, cnd_timedwait,
     (cnd_t *restrict condition, mtx_t *restrict mutex, const struct timespec *restrict until))
{
    return as_c11(wait_on_condition(__builtin_return_address(0), (pthread_cond_t *)condition,
                                    (pthread_mutex_t *)mutex, CLOCK_REALTIME, until));
}
LIBC(int, tss_create, (tss_t * key, tss_dtor_t destructor)) { return as_c11(add_key(key, destructor)); }
LIBC(void, tss_delete, (tss_t key)) { remove_key(key); }
LIBC(int, tss_set, (tss_t key, void *value)) { return as_c11(set_value(key, value)); }
LIBC(void *, tss_get, (tss_t key)) { return value_of(key); }
