/* Makes random system calls with random arguments that aim at the simulator and at a victim's folder: SEED COUNT FOLDER. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

/* One more than the highest number of a system call. */
#define LAST_CALL 480

static unsigned long long state;

static unsigned random_below(unsigned n)
{
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (unsigned)(state >> 33) % n;
}

static void wake(int signal) { (void)signal; }

/* Interrupts waiting calls, whatever earlier calls have done to signals and timers. */
static void arm(void)
{
    struct sigaction action = { .sa_handler = wake };
    struct itimerval soon = { { 0, 3000 }, { 0, 3000 } };
    sigset_t none;
    sigemptyset(&none);
    sigaction(SIGALRM, &action, NULL);
    sigprocmask(SIG_SETMASK, &none, NULL);
    setitimer(ITIMER_REAL, &soon, NULL);
}

int main(int argc, char **argv)
{
    static char names[6][512];
    const unsigned long count = argc > 2 ? strtoul(argv[2], NULL, 10) : 1000;
    const char *victim = argc > 3 ? argv[3] : "/nowhere";
    const size_t room = 1 << 20;
    unsigned long done = 0;
    char *memory = mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    const long parent = getppid();
    state = strtoull(argc > 1 ? argv[1] : "1", NULL, 10) * 0x9E3779B97F4A7C15ULL + 1;
    snprintf(names[0], sizeof names[0], "%s/secret.txt", victim);
    snprintf(names[1], sizeof names[1], "%s/folder", victim);
    snprintf(names[2], sizeof names[2], "%s", victim);
    snprintf(names[3], sizeof names[3], "/proc/%ld/mem", parent);
    snprintf(names[4], sizeof names[4], "%s/new", victim);
    snprintf(names[5], sizeof names[5], "own");
    for (; done < count; done++) {
        long call = random_below(LAST_CALL), argument[6];
        for (int i = 0; i < 6; i++) {
            switch (random_below(10)) {
            case 0: argument[i] = 0; break;
            case 1: argument[i] = -1; break;
            case 2: argument[i] = random_below(16); break;
            case 3: argument[i] = i % 2 ? parent : -parent; break;
            case 4: argument[i] = 1L << random_below(48); break;
            case 5: argument[i] = (long)state; break;
            case 6: argument[i] = -100; break; /* AT_FDCWD */
            case 7: argument[i] = (long)(memory + random_below(room / 2)); break;
            default: argument[i] = (long)names[random_below(6)]; break;
            }
        }
        /* Calls that end the program or unmap its memory would end the search. */
        if (call == SYS_exit || call == SYS_exit_group || call == SYS_munmap || call == SYS_mprotect || call == SYS_mremap || call == SYS_brk
            || call == SYS_mmap || call == SYS_rt_sigreturn || call == SYS_execve || call == SYS_execveat || call == SYS_close_range
            || call == SYS_madvise || call == SYS_pkey_mprotect || call == SYS_seccomp || call == SYS_clone
#ifdef SYS_arch_prctl
            || call == SYS_arch_prctl || call == SYS_fork || call == SYS_vfork
            || call == 335 || call == 336 /* uretprobe, uprobe: the kernel ends a process that calls them */
#endif
            || ((call == SYS_kill || call == SYS_tgkill) && (argument[0] == getpid() || argument[0] == 0)))
            continue;
        if (call == SYS_prctl && argument[0] == 22) /* PR_SET_SECCOMP */
            continue;
        for (size_t i = 0; i < 64; i++) memory[random_below(room)] = (char)random_below(256);
        arm();
        syscall(call, argument[0], argument[1], argument[2], argument[3], argument[4], argument[5]);
    }
    arm();
    printf("made %lu calls\n", done);
    return 0;
}
