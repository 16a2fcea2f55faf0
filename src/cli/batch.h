/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_BATCH_H
#define CLI_BATCH_H

#include "base/sha256.h"
#include "cli/args.h"
#include "report/index.h"
#include "result/result.h"

/*
 * Several studies that are run together: what became of each, as a table at the end and as
 * index.json and index.html in the folder of their results. The index is replaced after every
 * study, but where that would take more than a small part of the time; a run that is killed
 * leaves one that calls "not run" what was not in it yet.
 */
typedef struct mt_batch {
    const mt_args *args;
    mt_arena mem;
    mt_index_study *studies; /* [n_operands] */
    double written_s;        /* when the index was written, and how long that took */
    double cost_s;
} mt_batch;

/* How running one study ended. */
typedef struct mt_batch_end {
    const mt_result *result; /* NULL: there is none */
    const char *sha256;      /* of result.json; "": it was not written */
    const char *message;     /* why there is no result; "": unknown */
    int exit_status;
    double seconds;
} mt_batch_end;

/* All are called "not run". MT_EXIT_DONE or the exit status, everything said; mt_batch_free in
 * any case (out zeroed before). */
int mt_batch_begin(const mt_args *args, mt_batch *out);
/* Study i has ended. Returns the exit status of writing the index. */
int mt_batch_note(mt_batch *batch, int i, const mt_batch_end *end);
/* The whole index is written; as text the table is appended to out. Returns its exit status. */
int mt_batch_close(mt_batch *batch, mt_text *out);
void mt_batch_free(mt_batch *batch);

#endif
