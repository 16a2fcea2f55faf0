/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _XOPEN_SOURCE 700 /* mkdtemp, scandir; NOLINT(cert-dcl37-c,cert-dcl51-cpp) */
#include "mt_child.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_WORDS = 24, LINE_ROOM = 2048 };

static char top[] = "/tmp/mt_child_XXXXXX";

static mt_child_text read_text(const char *path)
{
    mt_child_text t = {NULL, 0};
    struct stat st;
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd >= 0 && fstat(fd, &st) == 0) {
        t.s = calloc((size_t)st.st_size + 1, 1);
        const ssize_t got = t.s == NULL ? -1 : read(fd, t.s, (size_t)st.st_size);
        t.n = got > 0 ? (size_t)got : 0;
    }
    if (fd >= 0) {
        (void)close(fd);
    }
    return t;
}

void mt_child_forget(mt_child_left *l)
{
    free(l->out.s);
    free(l->err.s);
    for (int i = 0; i < l->n_files; i++) {
        free(l->file[i].s);
    }
    memset(l, 0, sizeof *l);
}

static void keep_file(mt_child_left *l, const char *path)
{
    if (l->n_files < MT_CHILD_FILES) {
        (void)snprintf(l->name[l->n_files], MT_CHILD_PATH, "%s", path);
        l->file[l->n_files++] = read_text(path);
    }
}

/* Remove everything beneath a folder; its files are kept in l, where that is not NULL. */
static void empty(const char *folder, mt_child_left *l)
{
    struct dirent **list = NULL;
    const int n = scandir(folder, &list, NULL, alphasort);
    for (int i = 0; i < n; i++) {
        char path[MT_CHILD_PATH];
        struct stat st;
        const bool dots =
            strcmp(list[i]->d_name, ".") == 0 || strcmp(list[i]->d_name, "..") == 0;
        (void)snprintf(path, sizeof path, "%s/%s", folder, list[i]->d_name);
        free(list[i]);
        if (dots || lstat(path, &st) != 0) {
            continue;
        }
        if (S_ISDIR(st.st_mode)) {
            empty(path, l);
            (void)rmdir(path);
            continue;
        }
        if (l != NULL) {
            keep_file(l, path);
        }
        (void)unlink(path);
    }
    free(list);
}

bool mt_child_open(void)
{
    char kept[MT_CHILD_PATH];
    const bool made = mkdtemp(top) != NULL;
    (void)snprintf(kept, sizeof kept, "%s/kept", top);
    return made && mkdir(kept, 0700) == 0;
}

bool mt_child_write(const char *name, const char *content)
{
    char path[MT_CHILD_PATH];
    (void)snprintf(path, sizeof path, "%s/kept/%s", top, name);
    FILE *const file = fopen(path, "w");
    const bool ok = file != NULL && fputs(content, file) >= 0;
    return file != NULL && fclose(file) == 0 && ok;
}

void mt_child_close(void)
{
    empty(top, NULL);
    (void)rmdir(top);
}

/* The words of a line, as main would get them. */
static int split(const char *line, char *expanded, char **argv)
{
    int argc = 1;
    size_t at = 0;
    for (const char *p = line; *p != '\0' && at + sizeof top + 8 < LINE_ROOM; p++) {
        if (*p == '@' || *p == '%') {
            at += (size_t)snprintf(expanded + at, LINE_ROOM - at, "%s/%s", top,
                                   *p == '@' ? "new" : "kept");
        } else {
            expanded[at++] = *p;
        }
    }
    expanded[at] = '\0';
    char *rest = NULL;
    for (char *word = strtok_r(expanded, " ", &rest); word != NULL && argc <= MOST_WORDS;
         word = strtok_r(NULL, " ", &rest)) {
        argv[argc++] = word;
    }
    return argc;
}

static void put_into(int descriptor, const char *path)
{
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (fd < 0 || dup2(fd, descriptor) < 0) {
        _exit(99);
    }
    (void)close(fd);
}

mt_child_left mt_child_run(const mt_child *p, const char *line)
{
    mt_child_left l = {.code = -1};
    char out[MT_CHILD_PATH];
    char err[MT_CHILD_PATH];
    char folder[MT_CHILD_PATH];
    int status = 0;
    (void)snprintf(out, sizeof out, "%s/out", top);
    (void)snprintf(err, sizeof err, "%s/err", top);
    (void)snprintf(folder, sizeof folder, "%s/new", top);
    (void)fflush(NULL);
    const pid_t child = fork();
    if (child == 0) {
        char expanded[LINE_ROOM];
        char program[] = "modetune";
        char *argv[MOST_WORDS + 2] = {program};
        const int argc = split(line, expanded, argv);
        (void)alarm((unsigned)p->seconds);
        put_into(STDOUT_FILENO, p->output == NULL ? out : p->output);
        put_into(STDERR_FILENO, err);
        if (p->begin != NULL) {
            p->begin(p->context);
        }
        exit(p->main(argc, argv));
    }
    if (child < 0 || waitpid(child, &status, 0) != child) {
        return l;
    }
    l.code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    l.out = read_text(out);
    l.err = read_text(err);
    empty(folder, &l);
    return l;
}
