/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JOURNAL_HEAD_H
#define IO_JOURNAL_HEAD_H

#include <stdbool.h>

#include "base/base.h"
#include "base/text.h"

/* The head of a journal (io/journal.h): format, digest of the identity, and the identity behind
 * bars. */
#define MT_JOURNAL_FORMAT "modetune-journal/1 "
mt_text mt_journal_head(const char *identity, const char *sha256);

/* MT_E_INPUT, naming the first line of the identity, other than those of the processor, in
 * which another head differs; where only the processor differs (*foreign), its first line.
 * theirs: the lines behind bars. */
mt_status mt_journal_refuse(const char *identity, const char *path, const char *theirs,
                            bool *foreign, mt_err *err);

#endif
