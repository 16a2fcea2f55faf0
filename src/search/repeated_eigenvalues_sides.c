/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which rows of a problem are limits on single modes: of goals, of bands with their assignment,
 * and of both at corners of the tolerances. */
#include <math.h>

#include "problem/goal_avoid.h"
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

static void add_requirement(listing *l, const mt_requirement *d)
{
    const mt_workspace *const ws = l->ws;
    const mt_goal *const g = d->goal;
    const int n_eq = mt_subproblem_rows_eq(ws->c);
    if (!mt_requirement_is_frequency(d)) {
        return;
    }
    for (int k = 0; k < 2; k++) {
        mt_repeated_eigenvalues_side s = {.analysis = ws->views[d->view].analysis,
                                          .limit_hz = k == 0 ? g->at_least : g->at_most,
                                          .sign = k == 0 ? 1.0 : -1.0};
        const int in = d->row_in + (k == 1 && MT_HAS(g->at_least) ? 1 : 0);
        if (d->row_in >= 0 && MT_HAS(s.limit_hz) && !mt_tolerance_at_corner(ws->c, in)) {
            s.row = n_eq + in;
            add_mode_side(l, &s, d->mode);
        }
        if (d->row_eq >= 0 && MT_HAS(d->equals)) {
            s.limit_hz = d->equals;
            s.row = d->row_eq;
            add_mode_side(l, &s, d->mode);
        }
    }
}

static void add_bands(listing *l)
{
    const mt_workspace *const ws = l->ws;
    mt_avoidance_row at;
    for (int k = 0; ws->c->below != NULL && mt_avoidance_row_at(ws->c, ws->c->below, k, &at);
         k++) {
        const mt_avoidance *const c = &ws->c->avoidances[at.avoidance];
        const mt_band *const band = &c->bands.items[at.band];
        const int in = ws->c->first_band_row + k;
        const mt_repeated_eigenvalues_side s = {.analysis = ws->views[c->view].analysis,
                                                .limit_hz =
                                                    at.above ? band->upper_hz : band->lower_hz,
                                                .sign = at.above ? 1.0 : -1.0,
                                                .moves = ws->c->clearance,
                                                .row = mt_subproblem_rows_eq(ws->c) + in};
        if (!mt_tolerance_at_corner(ws->c, in)) {
            add_mode_side(l, &s, at.mode);
        }
    }
}

static void add_corners(listing *l)
{
    const mt_workspace *const ws = l->ws;
    for (int k = 0; ws->c->tolerance_box != NULL && k < ws->c->tolerance_box->n_rows; k++) {
        const mt_tolerance_row *const row = &ws->c->tolerance_box->rows[k];
        const int view = mt_tolerance_row_configuration(ws->c, row);
        if (view >= 0) {
            const mt_tolerance_corners *const set = &ws->c->tolerance_box->views[view];
            const mt_repeated_eigenvalues_side s = {
                .analysis = ws->views[view].corners[row->corner],
                .factor = set->corners[row->corner].factor,
                .limit_hz = mt_tolerance_limit_hz(ws->c, row),
                .sign = row->side == MT_LOWEST ? 1.0 : -1.0,
                .moves = row->requirement < 0 && ws->c->clearance,
                .row = mt_subproblem_rows_eq(ws->c) + row->row};
            add_mode_side(l, &s, mt_tolerance_row_mode(ws->c, row));
        }
    }
}

mt_status mt_repeated_eigenvalues_sides(mt_workspace *ws, mt_arena *mem,
                                        mt_repeated_eigenvalues_side **out, int *n, mt_err *err)
{
    const size_t corners =
        ws->c->tolerance_box != NULL ? (size_t)ws->c->tolerance_box->n_rows : 0;
    const size_t most = 4 * (size_t)ws->p->n_requirements + (size_t)ws->c->n_in + corners;
    listing l = {.ws = ws, .items = mt_arena_alloc(mem, most, sizeof *l.items)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < ws->p->n_requirements; i++) {
        add_requirement(&l, &ws->p->requirements[i]);
    }
    add_bands(&l);
    add_corners(&l);
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
