/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "problem/rows.h"

#include <math.h>

mt_row mt_row_init(mt_row_kind kind, mt_row_sense sense)
{
    return (mt_row){.kind = kind,
                    .sense = sense,
                    .requirement = -1,
                    .avoidance = -1,
                    .view = -1,
                    .corner = -1,
                    .objective = -1,
                    .implied_by = -1,
                    .limit = nan(""),
                    .tolerance = nan("")};
}

mt_status mt_rows_append(mt_row_block *block, const mt_row *row, mt_arena *mem, mt_err *err)
{
    mt_row *const grown =
        mt_arena_grow(mem, block->rows, block->n, &block->room, sizeof *grown);
    MT_TRY(mt_arena_check(mem, err));
    block->rows = grown;
    block->rows[block->n++] = *row;
    return MT_OK;
}

mt_status mt_rows_finish(mt_row_block *block, int more, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)block->n + (size_t)more;
    mt_row *const rows = mt_arena_alloc(mem, n, sizeof *rows);
    double *const tol = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < block->n; i++) {
        rows[i] = block->rows[i];
        tol[i] = rows[i].tolerance;
    }
    *block = (mt_row_block){.n = block->n, .room = block->n + more, .rows = rows, .tol = tol};
    return MT_OK;
}
