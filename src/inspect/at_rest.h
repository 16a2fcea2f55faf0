/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_AT_REST_H
#define INSPECT_AT_REST_H

#include "analysis/analysis.h"
#include "result/record.h"

/* What a configuration does at rest: its sensors against the reference position, the forces of
 * its springs, what its joints carry (mechanics/statics.h). */

typedef struct mt_rest_row {
    const char *output; /* as goals of type "static" name it: "joint.pivot.rx" */
    double value;       /* NaN: not determined */
    const char *unit;
    const char *why; /* why it is not determined; NULL: it is */
} mt_rest_row;
extern const mt_record mt_rest_record;

typedef struct mt_rest_rows {
    int n;
    mt_rest_row *rows; /* [n] */
    int left_out;      /* of a large mechanism: numbers beyond the first ones */
} mt_rest_rows;

/* After a solve; none where nothing loads or drives the mechanism. Results in mem. Fails:
 * MT_E_MEMORY. */
mt_status mt_rest_rows_of(mt_analysis *a, mt_arena *mem, mt_rest_rows *out, mt_err *err);

/* What a row belongs to, "joint.pivot" of "joint.pivot.rx", and the length of that part. */
int mt_rest_owner(const mt_rest_row *row);
/* Text of rows `from` to `end` of one owner: "x 1.2, y 0 N; rz 3 N m", in mem. Numbers below
 * rounding of the largest of their unit are 0. */
const char *mt_rest_text(const mt_rest_rows *rows, int from, int end, int digits,
                         mt_arena *mem);

#endif
