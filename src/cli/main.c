/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "cli/cli.h"
#include "linalg/blas.h"
#include "tune/prepare.h"

/* What belongs to the whole process is set here, and nowhere below. */
int main(int argc, char *argv[])
{
    mt_terminal_catch_signals();
    mt_tune_prepare_process();
    mt_blas_set_threads(1);
    return mt_cli_main(argc, argv);
}
