/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Runs the program's command line in a process of its own (a fork of the test: no loading, so
 * that thousands of runs take seconds), and keeps what it leaves behind: exit status or signal,
 * output, messages, files. Within a line @ stands for a folder that is empty before each run
 * and emptied after it, % for one that lasts.
 */
#ifndef MT_CHILD_H
#define MT_CHILD_H

#include <stdbool.h>
#include <stddef.h>

enum { MT_CHILD_FILES = 16, MT_CHILD_PATH = 512 };

typedef struct mt_child_text {
    char *s; /* NUL-terminated; NULL: there is none */
    size_t n;
} mt_child_text;

typedef struct mt_child_left {
    int code; /* exit status; negative: the signal that ended it */
    mt_child_text out;
    mt_child_text err;
    int n_files;
    char name[MT_CHILD_FILES][MT_CHILD_PATH]; /* in @, sorted */
    mt_child_text file[MT_CHILD_FILES];
} mt_child_left;

typedef struct mt_child {
    int (*main)(int argc, char *const argv[]);
    void (*begin)(void *context); /* in the child, before main; may be NULL */
    void *context;
    const char *output; /* where standard output goes, NULL: into .out of what is left */
    int seconds;        /* what takes longer is ended by SIGALRM */
} mt_child;

/* Make the folders, beneath one of /tmp; false: they cannot be made. */
bool mt_child_open(void);
/* A file in the folder that lasts; false: it cannot be written. */
bool mt_child_write(const char *name, const char *content);
/* Remove them. */
void mt_child_close(void);
/* Run a line of words separated by blanks. The caller forgets what is returned. */
mt_child_left mt_child_run(const mt_child *p, const char *line);
void mt_child_forget(mt_child_left *l);

#endif
