/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_PROFILE_H
#define CLI_PROFILE_H

#include "base/profile.h"
#include "cli/args.h"

/* --profile: what the evaluations of a model did, counted from here on; else NULL. */
mt_profile *mt_cli_profile(const mt_args *args, mt_profile *own);
/* The stages as a table on standard error; NULL: nothing. Returns the exit status. */
int mt_cli_profile_print(mt_profile *p);

#endif
