/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_errno.h>
#include <string.h>

#include "cli/cli.h"
#include "linalg/dense.h"

extern char **environ;

/*
 * Load OpenBLAS with one thread. When loaded it starts a thread per processor, and each
 * requests a buffer until it has one: with little address space for ever. Only
 * OPENBLAS_NUM_THREADS prevents that. Functions in .preinit_array run before the constructors
 * of all libraries: here it is loaded with that variable set; its other settings
 * (OPENBLAS_CORETYPE) apply.
 */
static void load_blas(int argc, char *argv[], char *envp[])
{
    enum { MOST = 32 };
    static char one_thread[] = "OPENBLAS_NUM_THREADS=1";
    static char *settings[MOST + 1] = {one_thread, NULL};
    int n = 1;
    (void)argc;
    (void)argv;
    for (char *const *e = envp; *e != NULL && n < MOST; e++) {
        if (strncmp(*e, "OPENBLAS_", strlen("OPENBLAS_")) == 0) {
            settings[n++] = *e; /* the first of a name counts */
        }
    }
    char **const before = environ;
    environ = settings;
    mt_blas_load();
    environ = before;
}

typedef void (*before_constructors)(int argc, char *argv[], char *envp[]);
__attribute__((section(".preinit_array"), used)) static const before_constructors preinit =
    load_blas;

/* Settings of the whole process are made here, and nowhere below. */
int main(int argc, char *argv[])
{
    mt_terminal_open();
    mt_blas_set_threads(1);
    (void)gsl_set_error_handler_off(); /* it would abort where memory is out */
    const int code = mt_cli_main(argc, argv);
    return mt_exit_worse(code, mt_terminal_close());
}
