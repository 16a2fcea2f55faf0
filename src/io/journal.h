/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JOURNAL_H
#define IO_JOURNAL_H

#include <stdbool.h>

#include "base/base.h"
#include "base/workers.h"

/*
 * A checkpoint store in files. A journal is text:
 *
 *     modetune-journal/1 SHA-256 of the identity
 *     | the identity, line by line: everything that the records follow from
 *     CHECK KEY WORD WORD ...
 *
 * with one line per record: its words in hexadecimal digits, preceded by the first 16 digits of
 * the SHA-256 of identity and rest of the line. Lines are appended whole, so a killed process
 * leaves at most one incomplete line, the last. A line whose check fails is not a record.
 * Records come in any order; two different records of one key are both ignored.
 */
typedef struct mt_journal mt_journal;

/* Counters of a journal. */
typedef struct mt_journal_counts {
    long known;   /* records that were read */
    long used;    /* of these, records that were used */
    long made;    /* new records */
    long written; /* of these, written into the file */
    long ignored; /* lines that are not records */
} mt_journal_counts;

/* identity: lines of text, kept until mt_journal_end. Fails: MT_E_MEMORY. */
mt_status mt_journal_new(const char *identity, mt_journal **out, mt_err *err);
/* Accepts NULL. */
void mt_journal_delete(mt_journal *j);
/* Add the records of a file; a file that ends within its head has none. Fails: MT_E_INPUT (not
 * a journal, or one of another identity: the text gives the difference), MT_E_SYSTEM,
 * MT_E_MEMORY. *foreign (may be NULL): it fails because a processor with different arithmetic
 * worked on the same study; nothing of the file is used, and other files may be read. */
mt_status mt_journal_read(mt_journal *j, const char *path, bool *foreign, mt_err *err);
/* The state of the path for new records. */
typedef enum mt_journal_place {
    MT_JOURNAL_NEW,       /* no file */
    MT_JOURNAL_CONTINUED, /* a file that has been read: records are appended */
    MT_JOURNAL_KEPT,      /* another file, renamed with MT_JOURNAL_OLD appended */
    /* a file that another run writes: records are not written, nothing is removed */
    MT_JOURNAL_HELD,
    MT_JOURNAL_FAILED /* not a regular file, or not accessible: mt_journal_end reports why */
} mt_journal_place;
#define MT_JOURNAL_OLD ".old"

/* Write new records to `path`, whose folder is made; the file is made with the first record and
 * held until mt_journal_end. adds: append to the file there, which has been read; else rename
 * that file. Fails: MT_E_MEMORY. */
mt_status mt_journal_write_to(mt_journal *j, const char *path, bool adds,
                              mt_journal_place *place, mt_err *err);
/* The checkpoint store of the whole journal, or of one of `parts` parts. Lives as long as the
 * journal; call it after all reading. */
mt_checkpoint_store *mt_journal_checkpoint_store(mt_journal *j, int part, int parts);
mt_journal_counts mt_journal_count(const mt_journal *j);
/* Make the file for records now, even without any record: it marks a part that is done.
 * mt_journal_end reports failures. */
void mt_journal_begin(mt_journal *j);
/* End the journal: everything is written, and with `remove` its file is removed. Fails:
 * MT_E_SYSTEM: what could not be written or removed. */
mt_status mt_journal_end(mt_journal *j, bool remove, mt_err *err);

#endif
