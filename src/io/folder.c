/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Files of a folder replaced as one, by an undo log of names.
 *
 *     .modetune-new.F    the new file F, whole and on the disk before anything is renamed
 *     .modetune-old.F    the file F that stood there
 *     .modetune-none.F   no file F stood there
 *
 * In this order, under the folder's lock:
 *     1. all .modetune-new.F, that of the last file L first
 *     2. for each F but L: F becomes .modetune-old.F, or .modetune-none.F is made;
 *       .modetune-new.F becomes F
 *     3. .modetune-new.L becomes L: from here on the new files are the folder's
 *     4. .modetune-old.F and .modetune-none.F are removed
 * While .modetune-new.L is there the old files are what counts, and all of them can be put back
 * by their names alone; without it, what is left over is waste. So a failure and the run after
 * a killed one do the same. The folder is flushed before 3 and after it: what a power failure
 * leaves is one of these states, too.
 *
 * Why not exchange whole folders (renameat2), which would be a single step: other files of the
 * user are in there, terminals stand in it, it may be a link or a mount point, and only some
 * file systems can.
 */
#include "io/folder.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h> /* renameat */
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/arena.h"
#include "base/text.h"
#include "io/file.h"

static const char NEW[] = ".modetune-new.";
static const char OLD[] = ".modetune-old.";
static const char NONE[] = ".modetune-none.";

enum { NAME_SIZE = MT_FOLDER_NAME + (int)sizeof NONE };

typedef struct replacement {
    const char *folder;
    int fd; /* of the folder; holds the lock */
    const mt_folder_file *files;
    int n;
    mt_err *err;
} replacement;

typedef struct marked_name {
    char s[NAME_SIZE];
} marked_name;

static marked_name marked(const char *mark, const mt_folder_file *f)
{
    const size_t m = strlen(mark);
    const size_t n = strnlen(f->name, MT_FOLDER_NAME - 1);
    marked_name name = {.s = ""};
    memcpy(name.s, mark, m);
    memcpy(name.s + m, f->name, n);
    return name;
}

static void add_path(mt_text *t, const char *folder, const char *mark, const char *name)
{
    mt_text_add(t, folder);
    mt_text_add(t, "/");
    mt_text_add(t, mark);
    mt_text_add(t, name);
}

/* errno as a failure of this file. */
static mt_status failed(const replacement *r, const char *name)
{
    const int code = errno;
    mt_text path = {.s = NULL};
    add_path(&path, r->folder, "", name);
    const mt_status rc =
        path.failed ? mt_fail_memory(r->err) : mt_file_failed(path.s, code, r->err);
    mt_text_free(&path);
    return rc;
}

static mt_status is_there(const replacement *r, const char *name, bool *there)
{
    struct stat st;
    *there = fstatat(r->fd, name, &st, AT_SYMLINK_NOFOLLOW) == 0;
    return *there || errno == ENOENT ? MT_OK : failed(r, name);
}

static mt_status take_away(const replacement *r, const char *name)
{
    return unlinkat(r->fd, name, 0) == 0 || errno == ENOENT ? MT_OK : failed(r, name);
}

static mt_status rename_in_folder(const replacement *r, const char *from, const char *to)
{
    return renameat(r->fd, from, r->fd, to) == 0 ? MT_OK : failed(r, to);
}

/* Remove the copy with this mark of every file but the last; the first failure is returned,
 * none stops the loop. */
static mt_status sweep_up(const replacement *r, const char *mark)
{
    mt_status rc = MT_OK;
    for (int i = 0; i < r->n - 1; i++) {
        const mt_status one = take_away(r, marked(mark, &r->files[i]).s);
        rc = rc == MT_OK ? one : rc;
    }
    return rc;
}

static bool flushed(int fd)
{
    int rc = 0;
    do {
        rc = fsync(fd);
    } while (rc != 0 && errno == EINTR);
    return rc == 0;
}

/* Some file systems cannot flush a folder, and need not. */
static mt_status flush_folder(const replacement *r)
{
    return flushed(r->fd) || errno == EINVAL || errno == ENOTSUP
               ? MT_OK
               : mt_file_failed(r->folder, errno, r->err);
}

static bool keep_permissions(const replacement *r, int fd, const char *name)
{
    enum { PERMISSIONS = 0777 };
    struct stat old;
    struct stat new;
    if (fstatat(r->fd, name, &old, 0) != 0) {
        return errno == ENOENT || errno == ELOOP;
    }
    return !S_ISREG(old.st_mode) ||
           (fstat(fd, &new) == 0 && ((old.st_mode ^ new.st_mode) & PERMISSIONS) == 0) ||
           fchmod(fd, old.st_mode & PERMISSIONS) == 0;
}

static mt_status write_new(const replacement *r, const mt_folder_file *f)
{
    const marked_name name = marked(NEW, f);
    const int fd = mt_file_create(r->fd, name.s, false);
    if (fd < 0) {
        return failed(r, f->name);
    }
    const bool ok = mt_file_write(fd, f->bytes, f->length) &&
                    keep_permissions(r, fd, f->name) && flushed(fd);
    const mt_status rc = ok ? MT_OK : failed(r, f->name);
    /* after the flush an interrupted close has nothing left to fail at */
    const bool closed = close(fd) == 0 || errno == EINTR;
    return closed || rc != MT_OK ? rc : failed(r, f->name);
}

/* Check the files to be replaced. A folder in their place cannot be put aside: its removal
 * would fail. */
static mt_status look_first(const replacement *r)
{
    for (int i = 0; i < r->n; i++) {
        struct stat st;
        if (fstatat(r->fd, r->files[i].name, &st, AT_SYMLINK_NOFOLLOW) == 0) {
            if (S_ISDIR(st.st_mode)) {
                errno = EISDIR;
                return failed(r, r->files[i].name);
            }
        } else if (errno != ENOENT) {
            return failed(r, r->files[i].name);
        }
    }
    return MT_OK;
}

static mt_status write_all_new(const replacement *r)
{
    MT_TRY(write_new(r, &r->files[r->n - 1])); /* the mark that nothing is decided */
    for (int i = 0; i < r->n - 1; i++) {
        if (r->files[i].bytes != NULL) {
            MT_TRY(write_new(r, &r->files[i]));
        }
    }
    return MT_OK;
}

static mt_status put_aside(const replacement *r, const mt_folder_file *f)
{
    const marked_name old = marked(OLD, f);
    bool there = false;
    MT_TRY(is_there(r, f->name, &there));
    if (there) {
        return renameat(r->fd, f->name, r->fd, old.s) == 0 ? MT_OK : failed(r, f->name);
    }
    if (f->bytes == NULL) {
        return MT_OK;
    }
    const int fd = mt_file_create(r->fd, marked(NONE, f).s, false);
    return fd >= 0 && (close(fd) == 0 || errno == EINTR) ? MT_OK : failed(r, f->name);
}

/* Everything up to and including the decisive step. */
static mt_status exchange(const replacement *r)
{
    const mt_folder_file *const last = &r->files[r->n - 1];
    for (int i = 0; i < r->n - 1; i++) {
        const mt_folder_file *const f = &r->files[i];
        MT_TRY(put_aside(r, f));
        if (f->bytes != NULL) {
            MT_TRY(rename_in_folder(r, marked(NEW, f).s, f->name));
        }
    }
    MT_TRY(flush_folder(r));
    const mt_status rc = rename_in_folder(r, marked(NEW, last).s, last->name);
    bool undecided = true;
    /* a network may fail to tell that it was done */
    return rc == MT_OK || is_there(r, marked(NEW, last).s, &undecided) != MT_OK || undecided
               ? rc
               : MT_OK;
}

/* Put the old files back; nothing where none was put aside. */
static mt_status undo(const replacement *r)
{
    for (int i = 0; i < r->n - 1; i++) {
        const mt_folder_file *const f = &r->files[i];
        const marked_name old = marked(OLD, f);
        const marked_name none = marked(NONE, f);
        bool was_there = false;
        bool was_none = false;
        MT_TRY(is_there(r, old.s, &was_there));
        MT_TRY(is_there(r, none.s, &was_none));
        if (was_there) {
            MT_TRY(rename_in_folder(r, old.s, f->name));
        } else if (was_none) {
            MT_TRY(take_away(r, f->name));
        }
        if (was_none) {
            MT_TRY(take_away(r, none.s));
        }
    }
    return MT_OK;
}

/* Back to the old files, without the new ones. The mark of the last one goes when all is
 * done. */
static mt_status go_back(const replacement *r)
{
    MT_TRY(undo(r));
    MT_TRY(sweep_up(r, NEW));
    return take_away(r, marked(NEW, &r->files[r->n - 1]).s);
}

/* Recover from a killed process. */
static mt_status recover(const replacement *r)
{
    bool undecided = false;
    MT_TRY(is_there(r, marked(NEW, &r->files[r->n - 1]).s, &undecided));
    if (undecided) {
        return go_back(r);
    }
    MT_TRY(sweep_up(r, NEW));
    MT_TRY(sweep_up(r, OLD));
    return sweep_up(r, NONE);
}

static mt_status replace_locked(replacement *r)
{
    mt_err *const err = r->err;
    MT_TRY(recover(r));
    MT_TRY(look_first(r));
    mt_status rc = write_all_new(r);
    rc = rc == MT_OK ? exchange(r) : rc;
    if (rc != MT_OK) {
        r->err = NULL; /* the first failure is told */
        if (go_back(r) != MT_OK) {
            (void)mt_err_in(err, rc,
                            "the old files are not all back, which the next run mends");
        }
        return rc;
    }
    rc = flush_folder(r);
    (void)mt_err_in(err, rc, "everything is written, but the disk does not confirm it");
    r->err = NULL; /* what stays of the old files the next run takes away */
    (void)sweep_up(r, OLD);
    (void)sweep_up(r, NONE);
    return rc;
}

/* Make a folder. It is durable when its parent is flushed; file systems that cannot flush are
 * accepted. */
static mt_status make_folder(const char *path, mt_err *err)
{
    if (mkdir(path, 0777) != 0) {
        return errno == EEXIST ? MT_OK : mt_file_failed(path, errno, err);
    }
    char *const above = mt_file_folder(path);
    if (above == NULL) {
        return mt_fail_memory(err);
    }
    const int fd = mt_file_open_folder(above);
    if (fd >= 0) {
        (void)flushed(fd);
        (void)close(fd);
    }
    free(above);
    return MT_OK;
}

mt_status mt_folder_make(const char *path, mt_err *err)
{
    mt_text t = {.s = NULL};
    mt_status rc = MT_OK;
    for (size_t i = 1; rc == MT_OK && i <= strlen(path); i++) {
        if (path[i] == '/' || path[i] == '\0') {
            t.length = 0;
            mt_text_add_n(&t, path, i);
            rc = t.failed ? mt_fail_memory(err) : make_folder(t.s, err);
        }
    }
    mt_text_free(&t);
    return rc;
}

mt_status mt_folder_lock(const char *folder, bool shared, int patience_ms, int *lock,
                         mt_err *err)
{
    enum { PAUSE_MS = 20, MS_PER_S = 1000 };
    const int fd = mt_file_open_folder(folder);
    *lock = -1;
    if (fd < 0) {
        return mt_file_failed(folder, errno, err);
    }
    for (int waited = 0; flock(fd, (shared ? LOCK_SH : LOCK_EX) | LOCK_NB) != 0;) {
        if (errno == EWOULDBLOCK && waited >= patience_ms) {
            (void)close(fd);
            return mt_fail(err, MT_E_SYSTEM, "%s: another run has been writing there for %d s",
                           folder, patience_ms / MS_PER_S);
        }
        if (errno == EWOULDBLOCK) {
            (void)poll(NULL, 0, PAUSE_MS);
            waited += PAUSE_MS;
        } else if (errno != EINTR) {
            break; /* knows no locks */
        }
    }
    *lock = fd;
    return MT_OK;
}

void mt_folder_unlock(int lock)
{
    if (lock >= 0) {
        (void)close(lock);
    }
}

bool mt_folder_unfinished(const char *folder, const char *last)
{
    mt_text path = {.s = NULL};
    add_path(&path, folder, NEW, last);
    const bool there = !path.failed && !mt_file_absent(path.s);
    mt_text_free(&path);
    return there;
}

/* True where the path still names the descriptor's folder. */
static bool still_there(int fd, const char *folder)
{
    struct stat held;
    struct stat named;
    return fstat(fd, &held) != 0 || (stat(folder, &named) == 0 && held.st_dev == named.st_dev &&
                                     held.st_ino == named.st_ino);
}

mt_status mt_folder_replace(const char *folder, const mt_folder_file *files, int n, mt_err *err)
{
    enum { TIMES = 3 }; /* that it is removed by somebody while this waits for it */
    replacement r = {.folder = folder, .fd = -1, .files = files, .n = n, .err = err};
    for (int i = 0; i < TIMES; i++) {
        mt_folder_unlock(r.fd);
        MT_TRY(mt_folder_make(folder, err));
        MT_TRY(mt_folder_lock(folder, false, MT_FOLDER_PATIENCE_MS, &r.fd, err));
        if (still_there(r.fd, folder)) {
            break;
        }
    }
    const mt_status rc = replace_locked(&r);
    mt_folder_unlock(r.fd);
    return rc;
}
