/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_BATCH_H
#define CLI_BATCH_H

#include "base/sha256.h"
#include "cli/args.h"
#include "report/index.h"
#include "result/result.h"

/*
 * Several studies run together: the outcome of each, as a table at the end and as index.json
 * and index.html in the folder of their results. The index is replaced after every study,
 * unless that takes more than a small part of the time. In the index of a killed run, studies
 * not yet recorded are "not run".
 */
typedef struct mt_batch {
    const mt_args *args;
    mt_arena mem;
    mt_index_study *studies; /* [n_operands] */
    double written_s;        /* time of writing the index, and the duration of writing */
    double cost_s;
} mt_batch;

/* The end of running one study. */
typedef struct mt_batch_end {
    const mt_result *result; /* NULL: none */
    const char *sha256;      /* of result.json; "": not written */
    const char *message;     /* reason for no result; "": unknown */
    int exit_status;
    double seconds;
} mt_batch_end;

/* Begin with all studies "not run". Returns MT_EXIT_DONE or the exit status, with all messages
 * given; mt_batch_free in any case (out zeroed before). */
int mt_batch_begin(const mt_args *args, mt_batch *out);
/* Record the end of study i. Returns the exit status of writing the index. */
int mt_batch_note(mt_batch *batch, int i, const mt_batch_end *end);
/* Write the whole index; as text append the table to out. Returns the exit status of
 * writing. */
int mt_batch_close(mt_batch *batch, mt_text *out);
void mt_batch_free(mt_batch *batch);

#endif
