/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath is in POSIX.1-2008, but the C library shows it only with X/Open: asked for before any header. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/arena.h"
#include "base/format.h"

static mt_status system_error(mt_err *err, const char *path, int code)
{
    char text[128];
    if (strerror_r(code, text, sizeof text) != 0) {
        (void)mt_snprintf(text, sizeof text, "error %d", code);
    }
    return code == ENOMEM ? mt_fail_memory(err)
                          : mt_fail(err, MT_E_SYSTEM, "%s: %s", path, text);
}

/* Does the resolved path lie beneath the resolved folder? */
static bool beneath(const char *path, const char *folder)
{
    const size_t n = strlen(folder);
    if (strcmp(folder, "/") == 0) {
        return path[0] == '/';
    }
    return strncmp(path, folder, n) == 0 && path[n] == '/';
}

/* The path without symbolic links, checked against root; heap. NULL on failure, with *rc. */
static char *resolve(const char *path, const char *root, mt_status *rc, mt_err *err)
{
    char *const real = realpath(path, NULL);
    if (real == NULL) {
        *rc = system_error(err, path, errno);
        return NULL;
    }
    *rc = MT_OK;
    if (root == NULL) {
        return real;
    }
    char *const folder = realpath(root, NULL);
    if (folder == NULL) {
        *rc = system_error(err, root, errno);
    } else if (!beneath(real, folder)) {
        *rc = mt_fail(err, MT_E_INPUT, "%s: lies outside the root folder %s", path, root);
    }
    free(folder);
    if (*rc != MT_OK) {
        free(real);
        return NULL;
    }
    return real;
}

/* Bytes of an open file until its end; a growing file stops at the limit. */
static mt_status read_all(int fd, const char *path, size_t limit, mt_file *out, mt_err *err)
{
    struct stat st;
    if (fstat(fd, &st) != 0) {
        return system_error(err, path, errno);
    }
    if (!S_ISREG(st.st_mode)) {
        return mt_fail(err, MT_E_INPUT, "%s: is not a regular file", path);
    }
    if (st.st_size < 0 || (unsigned long long)st.st_size > limit) {
        return mt_fail(err, MT_E_INPUT, "%s: is longer than %zu bytes", path, limit);
    }
    const size_t size = (size_t)st.st_size;
    out->bytes = malloc(size + 1);
    if (out->bytes == NULL) {
        return mt_fail_memory(err);
    }
    while (out->length < size) {
        const ssize_t n = read(fd, out->bytes + out->length, size - out->length);
        if (n < 0 && errno != EINTR) {
            return system_error(err, path, errno);
        }
        if (n == 0) {
            break;
        }
        out->length += n > 0 ? (size_t)n : 0;
    }
    out->bytes[out->length] = '\0';
    return MT_OK;
}

mt_status mt_file_read(const char *path, const char *root, size_t limit, mt_file *out,
                       mt_err *err)
{
    *out = (mt_file){0};
    mt_status rc = MT_OK;
    char *const real = resolve(path, root, &rc, err);
    if (real == NULL) {
        return rc;
    }
    /* the last part is no link any more; without O_NONBLOCK a pipe would block the open */
    const int fd = open(real, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    const int code = errno;
    free(real);
    if (fd < 0) {
        return system_error(err, path, code);
    }
    rc = read_all(fd, path, limit, out, err);
    (void)close(fd);
    if (rc != MT_OK) {
        mt_file_free(out);
        return rc;
    }
    mt_sha256(out->bytes, out->length, out->sha256);
    return MT_OK;
}

void mt_file_free(mt_file *f)
{
    free(f->bytes);
    *f = (mt_file){0};
}

bool mt_file_exists(const char *path)
{
    return access(path, F_OK) == 0;
}

/* a, the first n bytes of it, and b; heap. */
static char *concatenated(const char *a, size_t n, const char *b)
{
    const size_t m = strlen(b);
    char *const s = malloc(n + m + 1);
    if (s != NULL) {
        memcpy(s, a, n);
        memcpy(s + n, b, m + 1);
    }
    return s;
}

/* Length of the folder part, with its slash; 0 where there is none. */
static size_t folder_length(const char *path)
{
    const char *const slash = strrchr(path, '/');
    return slash == NULL ? 0 : (size_t)(slash - path) + 1;
}

char *mt_file_join(const char *naming, const char *name)
{
    return concatenated(naming, name[0] == '/' ? 0 : folder_length(naming), name);
}

char *mt_file_folder(const char *path)
{
    const size_t n = folder_length(path);
    return n == 0 ? concatenated(".", 1, "") : concatenated(path, n == 1 ? 1 : n - 1, "");
}

char *mt_file_default_root(const char *study_path)
{
    return concatenated(study_path, folder_length(study_path), "..");
}

static bool write_all(int fd, const char *bytes, size_t length)
{
    size_t done = 0;
    while (done < length) {
        const ssize_t n = write(fd, bytes + done, length - done);
        if (n < 0 && errno != EINTR) {
            return false;
        }
        done += n > 0 ? (size_t)n : 0;
    }
    return true;
}

/* Permissions of the file that stands there, else what the process gives to new files: 0666 without the umask. The umask can
 * only be read by setting it, which other threads would see: a new file gets 0644. */
static mode_t wanted_mode(const char *path)
{
    struct stat st;
    enum { NEW_FILE = 0644, PERMISSIONS = 0777 };
    return stat(path, &st) == 0 && S_ISREG(st.st_mode) ? st.st_mode & PERMISSIONS : NEW_FILE;
}

/* Make the new name durable: the folder is flushed too. */
static bool flush_folder(const char *path)
{
    char *const folder = mt_file_folder(path);
    const int fd = folder == NULL ? -1 : open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    free(folder);
    if (fd < 0) {
        return false;
    }
    const bool ok = fsync(fd) == 0 || errno == EINVAL; /* some file systems cannot */
    (void)close(fd);
    return ok;
}

mt_status mt_file_write(const char *path, const char *bytes, size_t length, mt_err *err)
{
    char *const temporary = concatenated(path, strlen(path), ".XXXXXX");
    if (temporary == NULL) {
        return mt_fail_memory(err);
    }
    const int fd = mkstemp(temporary);
    int code = errno;
    bool ok = fd >= 0;
    if (ok) {
        ok = write_all(fd, bytes, length) && fchmod(fd, wanted_mode(path)) == 0 &&
             fsync(fd) == 0;
        code = errno;
        if (close(fd) != 0 && ok) {
            ok = false;
            code = errno;
        }
        if (ok && rename(temporary, path) != 0) {
            ok = false;
            code = errno;
        }
        if (!ok) {
            (void)unlink(temporary);
        }
    }
    free(temporary);
    if (!ok) {
        return system_error(err, path, code);
    }
    /* the file is whole already: a folder that cannot be flushed is no failure of ours */
    (void)flush_folder(path);
    return MT_OK;
}
