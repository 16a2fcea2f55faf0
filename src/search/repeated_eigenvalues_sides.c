/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which rows of a problem are limits on single modes: of goals, of bands with their assignment,
 * and of both at corners of the tolerances. */
#include <math.h>

#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "search/repeated_eigenvalues.h"

typedef struct listing {
    const mt_workspace *ws;
    mt_repeated_eigenvalues_side *items;
    int n;
} listing;

/* Vibration mode `mode` of the analysis; nothing where there is none, or no limit. */
static void add_mode_side(listing *l, const mt_repeated_eigenvalues_side *what, int mode)
{
    mt_repeated_eigenvalues_side s = *what;
    if (s.analysis->modes.n_unstable == 0 && s.limit_hz > 0.0) {
        s.pos = mt_modal_flexible(&s.analysis->modes, mode);
        if (s.pos >= 0) {
            l->items[l->n++] = s;
        }
    }
}

/* The analysis that a row is evaluated with. */
static mt_repeated_eigenvalues_side side_of(const mt_workspace *ws, const mt_row *row, int at)
{
    const mt_configuration_work *const view = &ws->views[row->view];
    mt_repeated_eigenvalues_side s = {.analysis = view->analysis,
                                      .limit_hz = row->limit,
                                      .sign = mt_row_sign(row),
                                      .moves = row->avoidance >= 0 && ws->c->clearance,
                                      .row = at};
    if (row->corner >= 0) {
        s.analysis = view->corners[row->corner];
        s.factor = ws->c->tolerance_box->views[row->view].corners[row->corner].factor;
    }
    return s;
}

/* True where a row limits the frequency of a mode by its index. */
static bool limits_mode(const mt_subproblem *c, const mt_row *row)
{
    return row->avoidance >= 0 ||
           (row->requirement >= 0 && row->kind != MT_ROW_POSITION &&
            mt_requirement_is_frequency(&c->requirements[row->requirement]));
}

/* A target is a limit on both sides. */
static void add_row(listing *l, const mt_row *row, int at)
{
    if (limits_mode(l->ws->c, row)) {
        mt_repeated_eigenvalues_side s = side_of(l->ws, row, at);
        add_mode_side(l, &s, row->mode);
        if (row->sense == MT_EQUAL) {
            s.sign = -s.sign;
            add_mode_side(l, &s, row->mode);
        }
    }
}

mt_status mt_repeated_eigenvalues_sides(mt_workspace *ws, mt_arena *mem,
                                        mt_repeated_eigenvalues_side **out, int *n, mt_err *err)
{
    const mt_row_table *const rows = &ws->c->rows;
    const size_t most = (2 * (size_t)rows->eq.n) + (size_t)rows->in.n;
    listing l = {.ws = ws, .items = mt_arena_alloc(mem, most, sizeof *l.items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < rows->eq.n; i++) {
        add_row(&l, &rows->eq.rows[i], i);
    }
    for (int i = 0; i < rows->in.n; i++) {
        add_row(&l, &rows->in.rows[i], rows->eq.n + i);
    }
    *out = l.items;
    *n = l.n;
    return MT_OK;
}

double mt_repeated_eigenvalues_margin(const mt_workspace *ws,
                                      const mt_repeated_eigenvalues_side *s, int pos)
{
    const double z = s->moves ? ws->t[ws->p->n] : 0.0;
    return (s->sign * log(mt_modal_hz(&s->analysis->modes, pos) / s->limit_hz)) - z;
}
