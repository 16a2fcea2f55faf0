/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_LIMITS_H
#define CLI_LIMITS_H

#include "cli/cli.h"

/* A size on the command line: a whole number of bytes, or with k, M, G, T (1024 each). Fails:
 * MT_E_USAGE. */
mt_status mt_limits_read_size(const char *text, uint64_t *bytes, mt_err *err);
/* Have what the workers need of OpenBLAS (where --threads does not say: as many as there are
 * processors for the process, or one where they cannot all have it), then limit the memory of
 * the process to what it has and --max-memory on top (default: half of the machine's memory or
 * of its container's). Only ever lowers what the system allows; nothing where a sanitizer needs
 * address space. Fails: MT_E_MEMORY. */
mt_status mt_limits_set(mt_args *args, mt_err *err);
/* A line to standard error that names the limit. */
void mt_limits_explain(void);

#endif
