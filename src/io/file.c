/* SPDX-License-Identifier: GPL-3.0-or-later */
/* realpath is in POSIX.1-2008, but the C library shows it only with X/Open: asked for before
 * any header. */
#define _XOPEN_SOURCE 700 /* NOLINT(cert-dcl37-c,cert-dcl51-cpp): for the system, not ours */

#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/arena.h"
#include "base/base.h"
#include "base/format.h"
#include "io/shipped_data.h"

/* What failed, for the words of the system. */
typedef struct failed {
    const char *path;
    int code;
} failed;

static mt_status say_failed(void *context, mt_err *err)
{
    const failed *const f = context;
    char text[128];
    if (strerror_r(f->code, text, sizeof text) != 0) {
        (void)mt_snprintf(text, sizeof text, "error %d", f->code);
    }
    return mt_fail(err, MT_E_SYSTEM, "%s: %s", f->path, text);
}

mt_status mt_file_failed(const char *path, int code, mt_err *err)
{
    failed f = {path, code};
    return code == ENOMEM ? mt_fail_memory(err) : mt_locale_plain(say_failed, &f, err);
}

/* True for errors that mean that a name leads to nothing. */
static bool is_absence(int code)
{
    return code == ENOENT || code == ENOTDIR || code == ELOOP || code == ENAMETOOLONG;
}

/* True where the resolved path lies beneath the resolved folder. */
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
        *rc = mt_file_failed(path, errno, err);
        return NULL;
    }
    *rc = MT_OK;
    if (root == NULL) {
        return real;
    }
    char *const folder = realpath(root, NULL);
    if (folder == NULL) {
        *rc = is_absence(errno) ? mt_fail(err, MT_E_INPUT, "%s: there is no such folder", root)
                                : mt_file_failed(root, errno, err);
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

const int MT_FILE_HERE = AT_FDCWD;

/* Without O_NONBLOCK a pipe would block the open. */
static int opened(int folder, const char *name, int how)
{
    enum { ALL_THE_UMASK_ALLOWS = 0666 };
    int fd = -1;
    do {
        fd = openat(folder, name, how | O_NONBLOCK | O_CLOEXEC, ALL_THE_UMASK_ALLOWS);
    } while (fd < 0 && errno == EINTR);
    return fd;
}

int mt_file_open(int folder, const char *name)
{
    return opened(folder, name, O_RDONLY | O_NOFOLLOW);
}

int mt_file_open_folder(const char *path)
{
    return opened(AT_FDCWD, path, O_RDONLY | O_DIRECTORY);
}

int mt_file_create(int folder, const char *name, bool adds)
{
    const int fd =
        opened(folder, name, O_WRONLY | O_APPEND | O_NOFOLLOW | (adds ? 0 : O_CREAT | O_EXCL));
    struct stat st;
    if (fd < 0 || !adds) {
        return fd;
    }
    int code = fstat(fd, &st) != 0 ? errno : !S_ISREG(st.st_mode) ? ENXIO : 0;
    code = code == 0 && st.st_nlink != 1 ? EMLINK : code;
    if (code != 0) {
        (void)close(fd);
        errno = code;
        return -1;
    }
    return fd;
}

bool mt_file_write(int fd, const char *bytes, size_t length)
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

/* Bytes of an open file until its end; a growing file stops at the limit. */
static mt_status read_all(int fd, const char *path, size_t limit, mt_file *out, mt_err *err)
{
    struct stat st;
    if (fstat(fd, &st) != 0) {
        return mt_file_failed(path, errno, err);
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
            return mt_file_failed(path, errno, err);
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
    const int fd = mt_file_open(MT_FILE_HERE, real); /* the last part is no link any more */
    const int code = errno;
    free(real);
    if (fd < 0) {
        return mt_file_failed(path, code, err);
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

bool mt_file_absent(const char *path)
{
    struct stat st;
    return stat(path, &st) != 0 && is_absence(errno);
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

/* Texts that are given in place of files. */

char *mt_files_normal(const char *path)
{
    char *const out = malloc(strlen(path) + 2);
    if (out == NULL) {
        return NULL;
    }
    const size_t root = path[0] == '/' ? 1 : 0;
    size_t length = root;
    memcpy(out, "/", root);
    for (const char *at = path + strspn(path, "/"); *at != '\0'; at += strspn(at, "/")) {
        const size_t n = strcspn(at, "/");
        size_t last = length; /* where the last part begins */
        while (last > root && out[last - 1] != '/') {
            last--;
        }
        const bool up = n == 2 && strncmp(at, "..", 2) == 0;
        const bool stays = length > root && strncmp(out + last, "..", length - last) == 0;
        if (up && length > root && !stays) {
            length = last > root ? last - 1 : root;
        } else if (!(n == 1 && *at == '.') && !(up && root == 1)) {
            if (length > root) {
                out[length++] = '/';
            }
            memcpy(out + length, at, n);
            length += n;
        }
        at += n;
    }
    out[length] = '\0';
    return out;
}

/* The text that is given for the path; NULL: none, or *rc. */
static const char *find_given_text(const mt_files *files, const char *path, mt_status *rc)
{
    const char *found = NULL;
    *rc = MT_OK;
    if (files == NULL || files->n == 0) {
        return NULL;
    }
    char *const wanted = mt_files_normal(path);
    for (int i = 0; i < files->n && found == NULL && wanted != NULL; i++) {
        char *const name = mt_files_normal(files->given[i].path);
        if (name == NULL) {
            *rc = MT_E_MEMORY;
            break;
        }
        found = strcmp(name, wanted) == 0 ? files->given[i].text : NULL;
        free(name);
    }
    *rc = wanted == NULL ? MT_E_MEMORY : *rc;
    free(wanted);
    return found;
}

mt_status mt_files_read(const mt_files *files, const char *path, const char *root, size_t limit,
                        mt_file *out, mt_err *err)
{
    mt_status rc = MT_OK;
    const char *const text = find_given_text(files, path, &rc);
    *out = (mt_file){0};
    if (rc != MT_OK) {
        return mt_fail_memory(err);
    }
    if (text == NULL && files != NULL && files->only) {
        return mt_fail(err, MT_E_SYSTEM, "%s: is not among the files that are given", path);
    }
    if (text == NULL) {
        return mt_file_read(path, root, limit, out, err);
    }
    const size_t length = strlen(text);
    if (length > limit) {
        return mt_fail(err, MT_E_INPUT, "%s: is longer than %zu bytes", path, limit);
    }
    out->bytes = malloc(length + 1);
    if (out->bytes == NULL) {
        return mt_fail_memory(err);
    }
    memcpy(out->bytes, text, length + 1);
    out->length = length;
    mt_sha256(out->bytes, length, out->sha256);
    return MT_OK;
}

mt_status mt_files_give(const mt_files *files, const char *path, bool *out, mt_err *err)
{
    mt_status rc = MT_OK;
    *out = find_given_text(files, path, &rc) != NULL;
    return rc == MT_OK ? rc : mt_fail_memory(err);
}

bool mt_files_lack(const mt_files *files, const char *path)
{
    mt_status rc = MT_OK;
    if (find_given_text(files, path, &rc) != NULL || rc != MT_OK) {
        return false;
    }
    return (files != NULL && files->only) || mt_file_absent(path);
}

/* Files that are built into the program: the bytes are those of files (CMakeLists.txt). */

static const mt_shipped files[] = {
#define SHIPPED(bytes, path) {path, bytes, sizeof(bytes) - 1},
    SHIPPED_LIST(SHIPPED)
#undef SHIPPED
};

const mt_shipped *mt_shipped_all(int *n)
{
    *n = MT_COUNT(files);
    return files;
}

const mt_shipped *mt_shipped_among(const mt_shipped *of, int n, const char *path)
{
    for (int i = 0; i < n; i++) {
        if (strcmp(of[i].path, path) == 0) {
            return &of[i];
        }
    }
    return NULL;
}

const mt_shipped *mt_shipped_find(const char *path)
{
    return mt_shipped_among(files, MT_COUNT(files), path);
}

/* The locale. */

mt_status mt_locale_plain(mt_status (*f)(void *context, mt_err *err), void *context,
                          mt_err *err)
{
    const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c == (locale_t)0) {
        return mt_fail_memory(err);
    }
    const locale_t own = uselocale(c);
    const mt_status rc = f(context, err);
    (void)uselocale(own);
    freelocale(c);
    return rc;
}
