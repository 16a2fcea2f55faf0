/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Assignment by shortest augmenting paths. With costs c_ij = -score and potentials u (rows), v
 * (columns) such that the reduced costs c_ij - u_i - v_j are never negative and zero on pairs,
 * each row in turn is added by the cheapest alternating path (Dijkstra over columns) to a free
 * column; the potentials then move by the distances, which keeps both properties, so the
 * pairing is optimal for the rows added so far. The shorter side plays the rows.
 */
#include "linalg/assign.h"

#include <math.h>

typedef struct matching {
    int rows; /* the shorter side */
    int columns;
    bool swapped; /* rows are columns of score */
    int m;        /* leading dimension of score */
    const double *score;
    double lowest;    /* stands for a score that is not finite */
    double *u;        /* [rows] */
    double *v;        /* [columns] */
    double *distance; /* [columns] cheapest known path to a column */
    int *from;        /* [columns] column before it on that path, -1: the path's start */
    int *row_of;      /* [columns] paired row or -1 */
    bool *done;       /* [columns] */
} matching;

static double raw_score(const matching *g, int row, int column)
{
    const int i = g->swapped ? column : row;
    const int j = g->swapped ? row : column;
    return g->score[i + (ptrdiff_t)j * g->m];
}

static double cost(const matching *g, int row, int column)
{
    const double s = raw_score(g, row, column);
    return -(isfinite(s) ? s : g->lowest);
}

/* A score so low that one missing pair outweighs the spread of all others: as few as possible
 * are missing. */
static double lowest_score(int m, int n, const double *score)
{
    double least = HUGE_VAL;
    double most = -HUGE_VAL;
    for (ptrdiff_t k = 0; k < (ptrdiff_t)m * n; k++) {
        if (isfinite(score[k])) {
            least = fmin(least, score[k]);
            most = fmax(most, score[k]);
        }
    }
    if (least > most) {
        return 0.0;
    }
    const double spread = most - least;
    const double unit = spread > 0.0 ? spread : fmax(fabs(most), 1.0);
    return least - unit * (1.0 + (double)(m < n ? m : n));
}

/* The unfinished column that is nearest, or -1. */
static int nearest_open_column(const matching *g)
{
    int best = -1;
    for (int j = 0; j < g->columns; j++) {
        if (!g->done[j] && (best < 0 || g->distance[j] < g->distance[best])) {
            best = j;
        }
    }
    return best;
}

/* Shorten the distances of unfinished columns by paths through `row`, reached over column `via`
 * (-1: the start) at distance `so_far`. */
static void relax(matching *g, int row, int via, double so_far)
{
    for (int j = 0; j < g->columns; j++) {
        const double d = so_far + cost(g, row, j) - g->u[row] - g->v[j];
        if (!g->done[j] && d < g->distance[j]) {
            g->distance[j] = d;
            g->from[j] = via;
        }
    }
}

static void match_row(matching *g, int row)
{
    for (int j = 0; j < g->columns; j++) {
        g->distance[j] = HUGE_VAL;
        g->from[j] = -1;
        g->done[j] = false;
    }
    relax(g, row, -1, 0.0);
    int end = nearest_open_column(g);
    while (end >= 0 && g->row_of[end] >= 0) {
        g->done[end] = true;
        relax(g, g->row_of[end], end, g->distance[end]);
        end = nearest_open_column(g);
    }
    if (end < 0) {
        return; /* cannot happen: there are at least as many columns as rows */
    }
    const double length = g->distance[end];
    g->u[row] += length;
    for (int j = 0; j < g->columns; j++) {
        if (g->done[j]) {
            g->u[g->row_of[j]] += length - g->distance[j];
            g->v[j] -= length - g->distance[j];
        }
    }
    while (end >= 0) { /* flip the path */
        const int before = g->from[end];
        g->row_of[end] = before < 0 ? row : g->row_of[before];
        end = before;
    }
}

static mt_status assign(matching *g, int m, int *pair, mt_arena *scratch, mt_err *err)
{
    const size_t columns = (size_t)g->columns;
    g->u = mt_arena_f64(scratch, (size_t)g->rows, 1);
    g->v = mt_arena_f64(scratch, columns, 1);
    g->distance = mt_arena_f64(scratch, columns, 1);
    g->from = mt_arena_int(scratch, columns);
    g->row_of = mt_arena_int(scratch, columns);
    g->done = mt_arena_alloc(scratch, columns, sizeof *g->done);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < g->columns; j++) {
        g->row_of[j] = -1;
    }
    for (int i = 0; i < g->rows; i++) {
        match_row(g, i);
    }
    for (int i = 0; i < m; i++) {
        pair[i] = -1;
    }
    for (int j = 0; j < g->columns; j++) {
        const int row = g->row_of[j];
        if (row >= 0 && isfinite(raw_score(g, row, j))) {
            pair[g->swapped ? j : row] = g->swapped ? row : j;
        }
    }
    return MT_OK;
}

mt_status mt_assign(int m, int n, const double *score, int *pair, mt_arena *scratch,
                    mt_err *err)
{
    matching g = {.m = m, .score = score, .swapped = m > n};
    g.rows = g.swapped ? n : m;
    g.columns = g.swapped ? m : n;
    g.lowest = lowest_score(m, n, score);
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = assign(&g, m, pair, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
