/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mt_faults.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_NAMES = 1000 };

static struct {
    const char *names[MOST_NAMES];
    long count;
    long at;
    mt_fault fault;
    int error;
    bool met;
    const char *function; /* of the call that met it */
    int log;              /* descriptor, 0: none */
} faults;

void mt_faults_at(long k, mt_fault fault, int error)
{
    faults.count = 0;
    faults.at = k;
    faults.fault = fault;
    faults.error = error;
    faults.met = false;
    faults.function = NULL;
}

long mt_faults_count(void)
{
    return faults.count;
}

bool mt_faults_met(void)
{
    return faults.met;
}

const char *mt_faults_name(long k)
{
    return k < faults.count && k < MOST_NAMES ? faults.names[k] : "";
}

/* The linker's names for what it replaces, and for what was there. */
/* NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */
#define WRAP(type, name, parameters) \
    type __real_##name parameters;   \
    type __wrap_##name parameters;   \
    type __wrap_##name parameters

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __real_openat(int folder, const char *path, int flags, ...);
int __wrap_openat(int folder, const char *path, int flags, ...);
ssize_t __real_write(int fd, const void *bytes, size_t length);

static void die(void)
{
    (void)kill(getpid(), SIGKILL);
}

/* What this call shall meet; errno is set where it shall fail. */
static mt_fault meet(const char *function)
{
    const long k = faults.count++;
    if (k < MOST_NAMES) {
        faults.names[k] = function;
    }
    if (faults.log > 0) {
        (void)__real_write(faults.log, function, strlen(function));
        (void)__real_write(faults.log, "\n", 1);
    }
    const bool again = faults.fault == MT_FAULT_EVER && faults.function != NULL &&
                       strcmp(faults.function, function) == 0;
    if (faults.fault == MT_FAULT_NONE || (k != faults.at && !again)) {
        return MT_FAULT_NONE;
    }
    faults.met = true;
    faults.function = function;
    if (faults.fault == MT_FAULT_KILL) {
        die();
    }
    if (faults.fault != MT_FAULT_TEAR) {
        errno = faults.error;
        return MT_FAULT_FAIL;
    }
    return MT_FAULT_TEAR;
}

/* The call as it is, unless it shall fail; then its end, where it is the last one. */
#define CALL(type, function, failure, ...)              \
    do {                                                \
        const mt_fault met = meet(#function);           \
        if (met == MT_FAULT_FAIL) {                     \
            return failure;                             \
        }                                               \
        type const rc = __real_##function(__VA_ARGS__); \
        if (met == MT_FAULT_TEAR) {                     \
            die();                                      \
        }                                               \
        return rc;                                      \
    } while (0)

static int mode_of(int flags, va_list args)
{
    return ((unsigned)flags & (unsigned)O_CREAT) != 0 ? va_arg(args, int) : 0;
}

int __wrap_open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    const int mode = mode_of(flags, args);
    va_end(args);
    CALL(int, open, -1, path, flags, mode);
}

int __wrap_openat(int folder, const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    const int mode = mode_of(flags, args);
    va_end(args);
    CALL(int, openat, -1, folder, path, flags, mode);
}

WRAP(ssize_t, read, (int fd, void *bytes, size_t length))
{
    CALL(ssize_t, read, -1, fd, bytes, length);
}

WRAP(ssize_t, write, (int fd, const void *bytes, size_t length))
{
    const mt_fault met = meet("write");
    if (met == MT_FAULT_FAIL) {
        return -1;
    }
    const ssize_t n = __real_write(fd, bytes, met == MT_FAULT_TEAR ? length / 2 : length);
    if (met == MT_FAULT_TEAR) {
        die();
    }
    return n;
}

/* A close that fails has closed all the same. */
WRAP(int, close, (int fd))
{
    const mt_fault met = meet("close");
    const int error = errno;
    const int rc = __real_close(fd);
    if (met == MT_FAULT_TEAR) {
        die();
    }
    errno = met == MT_FAULT_FAIL ? error : errno;
    return met == MT_FAULT_FAIL ? -1 : rc;
}

WRAP(int, fsync, (int fd))
{
    CALL(int, fsync, -1, fd);
}

WRAP(int, fchmod, (int fd, mode_t mode))
{
    CALL(int, fchmod, -1, fd, mode);
}

WRAP(int, renameat, (int from_folder, const char *from, int to_folder, const char *to))
{
    CALL(int, renameat, -1, from_folder, from, to_folder, to);
}

WRAP(int, unlinkat, (int folder, const char *path, int flags))
{
    CALL(int, unlinkat, -1, folder, path, flags);
}

WRAP(int, mkdir, (const char *path, mode_t mode))
{
    CALL(int, mkdir, -1, path, mode);
}

WRAP(int, stat, (const char *restrict path, struct stat *restrict st))
{
    CALL(int, stat, -1, path, st);
}

WRAP(int, fstat, (int fd, struct stat *st))
{
    CALL(int, fstat, -1, fd, st);
}

WRAP(int, fstatat, (int folder, const char *restrict path, struct stat *restrict st, int flags))
{
    CALL(int, fstatat, -1, folder, path, st, flags);
}

WRAP(int, flock, (int fd, int operation))
{
    CALL(int, flock, -1, fd, operation);
}

WRAP(char *, realpath, (const char *restrict path, char *restrict resolved))
{
    CALL(char *, realpath, NULL, path, resolved);
}
/* NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp) */

/* Before main, so that the program needs to know nothing. */
__attribute__((constructor)) static void take_orders(void)
{
    static const char *const actions[] = {":none", ":fail", ":ever", ":kill", ":tear"};
    const char *const order = getenv("MT_FAULT");
    const char *const log = getenv("MT_FAULT_LOG");
    if (log != NULL) {
        faults.log = __real_open(log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    }
    if (order == NULL) {
        return;
    }
    char *action = NULL;
    const long k = strtol(order, &action, 10);
    const size_t length = action[0] == ':' ? strcspn(action + 1, ":") + 1 : 0;
    const int error = action[length] == ':' ? (int)strtol(action + length + 1, NULL, 10) : EIO;
    for (int i = 0; i < (int)(sizeof actions / sizeof actions[0]); i++) {
        if (strncmp(action, actions[i], length) == 0 && length == strlen(actions[i])) {
            mt_faults_at(k, (mt_fault)i, error);
        }
    }
}
