/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_PROFILE_H
#define CLI_PROFILE_H

#include "base/run.h"
#include "cli/args.h"

/* Counters of the evaluations of a model from here on, with --profile; else NULL. */
mt_profile *mt_cli_profile(const mt_args *args, mt_profile *own);
/* Print the stages as a table on standard error; NULL: nothing. Returns the exit status. */
int mt_cli_profile_print(mt_profile *p);

#endif
