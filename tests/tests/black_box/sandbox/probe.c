/* Attempts actions that a sandbox denies, and prints a line for each attempt: its name, and `closed` or `OPEN`. */
#define _GNU_SOURCE
#include "eyebot.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#define TRY(name, attempt) printf("%s: %s\n", name, (attempt) < 0 ? "closed" : "OPEN")

static char path[4096];

/* Path of a file in the victim's folder. */
static const char *of(const char *folder, const char *name)
{
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static long peek(pid_t process)
{
    long word;
    struct iovec own = { &word, sizeof word }, other = { (void *)&errno, sizeof word };
    return syscall(SYS_process_vm_readv, process, &own, 1, &other, 1, 0);
}

static int descriptors(void)
{
    int fd, open = 0;
    for (fd = 3; fd < 256; fd++) open += fcntl(fd, F_GETFD) >= 0 && fd != 3;
    return open;
}

int main(int argc, char **argv)
{
    const char *victim = argv[1];
    pid_t parent = getppid();
    char memory[64];
    struct rlimit limit = { 1, 1 };
    FILE *file;
    snprintf(memory, sizeof memory, "/proc/%d/mem", parent);
    TRY("read shadow", open("/etc/shadow", O_RDONLY));
    TRY("read passwd", open("/etc/passwd", O_RDONLY));
    TRY("read a file", open(of(victim, "secret.txt"), O_RDONLY));
    TRY("write a file", open(of(victim, "secret.txt"), O_WRONLY | O_TRUNC));
    TRY("cut a file", truncate(of(victim, "secret.txt"), 0));
    TRY("delete a file", unlink(of(victim, "secret.txt")));
    TRY("rename a file", rename(of(victim, "secret.txt"), "taken.txt"));
    TRY("link a file", link(of(victim, "secret.txt"), "taken.txt"));
    TRY("change a mode", chmod(of(victim, "secret.txt"), 0777));
    TRY("change a time", utimensat(AT_FDCWD, of(victim, "secret.txt"), NULL, 0));
    TRY("make a file", open(of(victim, "new.txt"), O_WRONLY | O_CREAT, 0600));
    TRY("make a folder", mkdir(of(victim, "new"), 0700));
    TRY("remove a folder", rmdir(of(victim, "folder")));
    TRY("list a folder", open(victim, O_RDONLY | O_DIRECTORY));
    TRY("change the program", open(of(victim, "programs/probe.c"), O_WRONLY));
    symlink(of(victim, "secret.txt"), "link.txt");
    TRY("read through a link", open("link.txt", O_RDONLY));
    TRY("make a device", mknod("device", S_IFCHR | 0600, 0x103));
    TRY("make a pipe", mknod("pipe", S_IFIFO | 0600, 0));
    TRY("memory of the host", open(memory, O_RDWR));
    TRY("peek at the host", peek(parent));
    TRY("trace the host", ptrace(PTRACE_ATTACH, parent, 0, 0));
    TRY("seize the host", ptrace(PTRACE_SEIZE, parent, 0, 0));
    TRY("signal the host", kill(parent, 0));
    TRY("signal its group", kill(-getpgid(parent), 0));
    TRY("signal everyone", kill(-1, 0));
    TRY("signal by descriptor", syscall(SYS_pidfd_open, parent, 0));
    TRY("limit the host", prlimit(parent, RLIMIT_NOFILE, &limit, NULL));
    TRY("slow the host", setpriority(PRIO_PROCESS, parent, 19));
    TRY("internet", syscall(SYS_socket, 2, 1, 0));
    TRY("datagrams", syscall(SYS_socket, 2, 2, 0));
    TRY("local sockets", syscall(SYS_socket, 1, 1, 0));
    TRY("netlink", syscall(SYS_socket, 16, 3, 0));
    TRY("fork", syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0));
    TRY("clone3", syscall(435, memory, 64));
    TRY("namespaces", syscall(SYS_unshare, 0x10000000));
    TRY("mount", syscall(SYS_mount, "none", "/tmp", "tmpfs", 0, 0));
    TRY("keyring", syscall(SYS_keyctl, 0, -3, 0, 0, 0));
    TRY("bpf", syscall(SYS_bpf, 0, 0, 0));
    TRY("perf", syscall(SYS_perf_event_open, 0, 0, -1, -1, 0));
    TRY("io_uring", syscall(425, 1, memory));
    TRY("userfaultfd", syscall(SYS_userfaultfd, 1));
    TRY("memfd", syscall(SYS_memfd_create, "m", 0));
    TRY("shared memory", syscall(SYS_shmget, 1234, 4096, 01666));
    TRY("message queue", syscall(SYS_mq_open, "/q", 0102, 0600, 0));
    TRY("inotify", syscall(SYS_inotify_init1, 0));
    TRY("file handles", syscall(SYS_open_by_handle_at, -100, memory, 0));
    TRY("own session", setsid());
    TRY("become root", setuid(0));
    TRY("terminal input", ioctl(0, 0x5412, "x"));
    TRY("new call", syscall(459, 0, 0, 0, 0));
#ifdef __x86_64__
    TRY("x32 call", syscall(0x40000000 | SYS_getpid));
#endif
    TRY("descriptors", descriptors() ? 0 : -1);
    TRY("environment", getenv("EYESIM_SECRET") || getenv("LD_PRELOAD") || getenv("EYESIM_CACHE") ? 0 : -1);
    TRY("root", getuid() ? -1 : 0);
    file = fopen("own.txt", "w");
    printf("%s\n", file && fputs("mine", file) >= 0 && fclose(file) == 0 ? "writes its own" : "CANNOT WRITE ITS OWN");
    printf("%s\n", fopen(of(victim, "programs/data.txt"), "r") ? "reads its own" : "CANNOT READ ITS OWN");
    printf("%s\n", malloc(1 << 20) ? "has memory" : "HAS NO MEMORY");
    return 0;
}
