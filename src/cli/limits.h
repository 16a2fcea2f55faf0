/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_LIMITS_H
#define CLI_LIMITS_H

#include "cli/cli.h"

/* A size on the command line: a whole number of bytes, or with k, M, G, T (1024 each). Fails:
 * MT_E_USAGE. */
mt_status mt_limits_read_size(const char *text, uint64_t *bytes, mt_err *err);
/* Reserve OpenBLAS's memory for the workers (without --threads: as many as the process has
 * processors, or one where they cannot all have it), then limit the memory of the process to
 * what it has plus --max-memory (default: half of the machine's memory or of its container's).
 * Never raises a limit of the system; no limit where a sanitizer needs address space. Fails:
 * MT_E_MEMORY. */
mt_status mt_limits_set(mt_args *args, mt_err *err);
/* Write a line that names the limit to standard error. */
void mt_limits_explain(void);

#endif
