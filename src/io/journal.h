/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_JOURNAL_H
#define IO_JOURNAL_H

#include <stdbool.h>

#include "base/workers.h"

/*
 * A ledger in files. A journal is text:
 *
 *     modetune-journal/1 SHA-256 of the identity
 *     | the identity, line by line: everything that the records follow from
 *     CHECK KEY WORD WORD ...
 *
 * with one line for each record: its words in hexadecimal digits, before them the first 16
 * digits of the SHA-256 of identity and the rest of the line. Lines are appended whole, so a
 * process that is killed at any moment leaves at most a last line that is not; a line that does
 * not check is no record, wherever it comes from. Records need not come in any order; of one
 * key that has two different records none counts.
 */
typedef struct mt_journal mt_journal;

/* What a journal did. */
typedef struct mt_journal_counts {
    long known;   /* records that were read */
    long used;    /* of them, those that were asked for */
    long made;    /* new ones */
    long written; /* of them, into the file */
    long ignored; /* lines that are no record */
} mt_journal_counts;

/* identity: lines of text, kept until the end. Fails: MT_E_MEMORY. */
mt_status mt_journal_new(const char *identity, mt_journal **out, mt_err *err);
/* Accepts NULL. */
void mt_journal_delete(mt_journal *j);
/* The records of a file join; one that ends within its head has none. Fails: MT_E_INPUT (no
 * journal; one of another question: what differs), MT_E_SYSTEM, MT_E_MEMORY. *foreign (may be
 * NULL): it fails because the same question was worked on by a processor that computes
 * otherwise; nothing of it is taken, and others may be read. */
mt_status mt_journal_read(mt_journal *j, const char *path, bool *foreign, mt_err *err);
/* What stood where new records are to go. */
typedef enum mt_journal_place {
    MT_JOURNAL_NEW,       /* nothing */
    MT_JOURNAL_CONTINUED, /* what has been read: they go behind it */
    MT_JOURNAL_KEPT,      /* what is now called so with MT_JOURNAL_OLD behind its name */
    MT_JOURNAL_HELD,      /* what another run writes: they go nowhere, and nothing is removed */
    MT_JOURNAL_FAILED     /* what is no regular file, or cannot be had: the end tells why */
} mt_journal_place;
#define MT_JOURNAL_OLD ".old"

/* New records go to `path`, whose folder is made; the file is made with the first one, and held
 * until the end. adds: behind what is there, which has been read; else what is there is put
 * aside. Fails: MT_E_MEMORY. */
mt_status mt_journal_write_to(mt_journal *j, const char *path, bool adds,
                              mt_journal_place *place, mt_err *err);
/* All of it, or (of parts) one part. Lives as long as the journal; not before everything has
 * been read. */
mt_checkpoint_store *mt_journal_checkpoint_store(mt_journal *j, int part, int parts);
mt_journal_counts mt_journal_count(const mt_journal *j);
/* Where records go there is a file from here on, also where there are none: of a part that is
 * done. What fails is told at the end. */
void mt_journal_begin(mt_journal *j);
/* No more records: everything is written, and with `remove` the file that they went to goes.
 * Fails: MT_E_SYSTEM: what of them could not be written, or removed. */
mt_status mt_journal_end(mt_journal *j, bool remove, mt_err *err);

#endif
