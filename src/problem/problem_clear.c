/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Bands. Modes are sorted, so a design without a mode inside any band has one gap assignment:
 * how many modes lie below each band. For a given assignment k_b the condition is smooth
 * wherever the modes are simple:
 *     f_k <= lower_b,   f_(k+1) >= upper_b.
 * Where neighbours change places on the way the next modes on each side take over, so a cluster
 * of them is constrained (their rows follow from the first by the order of the modes; they only
 * tell the search what comes next). With the objective "clearance" every row has to exceed the
 * extra coordinate z, which is made as great as it can be.
 */
#include <math.h>
#include <string.h>

#include "problem/family.h"
#include "problem/goal.h"
#include "problem/robust.h"

/* Range of the extra coordinate: a clearance of -95 % to +2000 %. */
static const double CLEARANCE_LOWER = -3.0;
static const double CLEARANCE_UPPER = 3.0;

/* Rows of one band: modes k, k-1, ... below and k+1, k+2, ... above, as many as there are and
 * at most the cluster. */
static int rows_below(const mt_clear *c, int below)
{
    return below < c->cluster ? below : c->cluster;
}

static int rows_above(const mt_clear *c, int below, int flexible)
{
    const int left = flexible - below;
    return left < c->cluster ? left : c->cluster;
}

/* Bands are no number: their rows are those of the clears. */
const mt_goal_ops mt_goal_avoid = {.quantity = MT_QUANTITY_OTHER};

static mt_status unite(mt_problem *p, mt_clear *c, mt_err *err)
{
    const mt_study *const s = p->study;
    const mt_bands **const lists =
        mt_arena_alloc(&p->mem, (size_t)s->n_goals, sizeof(mt_bands *));
    int n = 0;
    if (lists == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < s->n_goals; i++) {
        const mt_goal *const g = &s->goals[i];
        for (int k = 0; g->avoid != NULL && k < g->n_configurations; k++) {
            if (g->configurations[k] == p->views[c->view].configuration) {
                lists[n++] = &g->avoid->bands;
            }
        }
    }
    return mt_bands_unite(n, lists, &p->mem, &c->bands, err);
}

static mt_status add_clear(mt_problem *p, int goal_index, int view, mt_err *err)
{
    const mt_goal *const g = &p->study->goals[goal_index];
    for (int i = 0; i < p->n_clears; i++) {
        if (p->clears[i].view == view) {
            mt_clear *const c = &p->clears[i];
            c->cluster = g->avoid->cluster > c->cluster ? g->avoid->cluster : c->cluster;
            c->tolerance = fmin(c->tolerance, mt_goal_tolerance(g));
            return MT_OK;
        }
    }
    mt_clear *const c = &p->clears[p->n_clears];
    *c = (mt_clear){.view = view,
                    .goal_index = goal_index,
                    .cluster = g->avoid->cluster,
                    .first = p->n_bands,
                    .row_in = -1,
                    .tolerance = mt_goal_tolerance(g)};
    MT_TRY(unite(p, c, err));
    p->n_bands += c->bands.n;
    p->n_clears++;
    return MT_OK;
}

static void number_rows(mt_problem *p, mt_clear *c)
{
    const int flexible = mt_view_vibrations(&p->views[c->view]);
    c->row_in = p->n_in;
    for (int b = 0; b < c->bands.n; b++) {
        const int below = p->below[c->first + b];
        c->n_rows += rows_below(c, below) + rows_above(c, below, flexible);
    }
    p->n_in += c->n_rows;
}

static mt_status add_cut(mt_problem *p, const mt_cut *cut, mt_clear *c, mt_err *err)
{
    mt_view *const view = &p->views[p->n_views];
    const mt_family *const f = &p->families[cut->family];
    *view = (mt_view){.configuration = f->configuration, .solved = true, .cut = cut};
    MT_TRY(mt_view_analyse(p, view, p->original, &view->analysis, err));
    c->view = p->n_views++;
    c->first = p->n_bands;
    p->n_clears++;
    return MT_OK;
}

mt_status mt_clear_cut(mt_problem *p, const mt_cut *cut, mt_err *err)
{
    mt_way_band *way = NULL;
    int n = 0;
    const mt_family *const f = &p->families[cut->family];
    mt_clear *const c = &p->clears[p->n_clears];
    *c = (mt_clear){.row_in = -1, .cluster = 1, .tolerance = HUGE_VAL};
    MT_TRY(mt_family_bands(p, f, cut->position, cut->position, &p->mem, &way, &n, err));
    c->bands.items = mt_arena_alloc(&p->mem, (size_t)n, sizeof *c->bands.items);
    int *const tie = mt_arena_int(&p->mem, (size_t)p->n_bands + (size_t)n);
    int *const below = mt_arena_int(&p->mem, (size_t)p->n_bands + (size_t)n);
    if (c->bands.items == NULL || tie == NULL || below == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = p->n_clears - 1; i >= 0; i--) {
        const mt_clear *const own = &p->clears[i];
        if (mt_family_of(p, own->view) == cut->family) {
            c->goal_index = own->goal_index;
            c->cluster = own->cluster > c->cluster ? own->cluster : c->cluster;
        }
    }
    MT_TRY(add_cut(p, cut, c, err));
    memcpy(tie, p->tie, (size_t)p->n_bands * sizeof *tie);
    memcpy(below, p->below, (size_t)p->n_bands * sizeof *below);
    for (int i = 0; i < n; i++) {
        c->bands.items[i] = way[i].band;
        c->tolerance = fmin(c->tolerance, way[i].tolerance);
        tie[p->n_bands] = way[i].tie;
        below[p->n_bands++] = p->below[way[i].tie];
    }
    c->bands.n = n;
    p->tie = tie;
    p->below = below;
    return MT_OK;
}

mt_status mt_clear_init(mt_problem *p, const int *below, int n_cuts, const struct mt_cut *cuts,
                        mt_err *err)
{
    const mt_study *const s = p->study;
    p->clears = mt_arena_alloc(&p->mem, (size_t)s->model->n_configurations + (size_t)n_cuts + 1,
                               sizeof *p->clears);
    if (p->clears == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < s->n_goals; i++) {
        const mt_goal *const g = &s->goals[i];
        for (int k = 0; g->avoid != NULL && k < g->n_configurations; k++) {
            MT_TRY(add_clear(p, i, mt_problem_view(p, g->configurations[k]), err));
        }
    }
    MT_TRY(mt_families_init(p, err));
    if (below == NULL || p->n_bands == 0) {
        return MT_OK;
    }
    p->below = mt_arena_int(&p->mem, (size_t)p->n_bands);
    if (p->below == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < p->n_bands; i++) {
        p->below[i] = below[i];
    }
    for (int i = 0; i < n_cuts; i++) {
        MT_TRY(mt_clear_cut(p, &cuts[i], err));
    }
    for (int i = 0; i < p->n_clears; i++) {
        number_rows(p, &p->clears[i]);
    }
    if (p->clearance) {
        p->lower_t[p->n] = CLEARANCE_LOWER;
        p->upper_t[p->n] = CLEARANCE_UPPER;
        p->origin_t[p->n] = 0.0;
    }
    return MT_OK;
}

/* One row: in = sign ln(f / edge) - z, sign -1 for a mode below the band. */
typedef struct edge_row {
    int row;
    int index; /* vibration mode */
    double edge_hz;
    double sign;
} edge_row;

static mt_status put_row(mt_problem *p, const mt_view *view, const edge_row *e, const double *t,
                         bool with_gradient, mt_nlp_values *out, mt_err *err)
{
    mt_analysis *const a = view->analysis;
    const int index = e->index;
    const int row = e->row;
    const double sign = e->sign;
    const double z = p->clearance ? t[p->n] : 0.0;
    const int pos = mt_modal_flexible(&a->modes, index);
    const double floor = MT_FREQUENCY_FLOOR * e->edge_hz;
    if ((pos < 0 && !mt_analysis_is_infinite(a, index)) || !(e->edge_hz > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" has no vibration mode %d here",
                       mt_analysis_configuration(a), index);
    }
    out->in[row] = (sign * mt_problem_ln_ratio(&a->modes, pos, e->edge_hz, floor)) - z;
    if (!with_gradient) {
        return MT_OK;
    }
    MT_TRY(mt_problem_dln_frequency(p, a, pos, floor, p->dshape, err));
    for (int i = 0; i < p->n; i++) {
        out->din[row + ((ptrdiff_t)i * mt_problem_rows_in(p))] = sign * p->dshape[i];
    }
    if (p->clearance) {
        out->din[row + ((ptrdiff_t)p->n * mt_problem_rows_in(p))] = -1.0;
    }
    return MT_OK;
}

/* Rows of one clear: over bands, below then above, nearest mode first. */
static mt_status put_rows(mt_problem *p, const mt_clear *c, const double *t, bool with_gradient,
                          mt_nlp_values *out, mt_err *err)
{
    const mt_view *const view = &p->views[c->view];
    const int flexible = mt_view_vibrations(view);
    int row = c->row_in;
    for (int b = 0; b < c->bands.n; b++) {
        const mt_band *const band = &c->bands.items[b];
        const int below = p->below[c->first + b];
        for (int k = 0; k < rows_below(c, below); k++) {
            const edge_row e = {row++, below - k, band->lower_hz, -1.0};
            MT_TRY(put_row(p, view, &e, t, with_gradient, out, err));
        }
        for (int k = 0; k < rows_above(c, below, flexible); k++) {
            const edge_row e = {row++, below + 1 + k, band->upper_hz, 1.0};
            MT_TRY(put_row(p, view, &e, t, with_gradient, out, err));
        }
    }
    if (row != c->row_in + c->n_rows) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\" has another number of modes here",
                       mt_analysis_configuration(view->analysis));
    }
    return MT_OK;
}

mt_status mt_clear_eval(mt_problem *p, const double *t, bool with_gradient, mt_nlp_values *out,
                        mt_err *err)
{
    for (int i = 0; i < p->n_clears && p->below != NULL; i++) {
        MT_TRY(put_rows(p, &p->clears[i], t, with_gradient, out, err));
    }
    return MT_OK;
}

double mt_clear_violation(const mt_clear *c, const mt_modes *modes, int *below, int *worst)
{
    double violation = mt_modal_indexed(modes) ? 0.0 : nan("");
    for (int b = 0; b < c->bands.n; b++) {
        const mt_band *const band = &c->bands.items[b];
        const bool from_zero = !(band->lower_hz > 0.0); /* 0 Hz is inside: nothing is below */
        const double middle = sqrt(fmax(band->lower_hz, 0.0) * band->upper_hz);
        int count = 0;
        for (int i = 0; i < modes->count; i++) {
            const double hz = mt_modal_hz(modes, i);
            if (modes->kind[i] != MT_MODE_FLEXIBLE) {
                continue;
            }
            const double over = mt_log_ratio(hz, band->lower_hz);
            const double under = fmin(mt_log_ratio(band->upper_hz, hz), MT_MOST_INSIDE);
            const double inside = fmin(over, under);
            count += hz <= middle && !from_zero ? 1 : 0;
            if (inside > violation) {
                violation = inside;
                if (worst != NULL) {
                    *worst = i;
                }
            }
        }
        if (below != NULL) {
            below[b] = count;
        }
    }
    return violation;
}

int mt_clear_row_count(const mt_problem *p, const int *below)
{
    mt_clear_row ignored;
    int n = 0;
    while (mt_clear_row_at(p, below, n, &ignored)) {
        n++;
    }
    return n;
}

bool mt_clear_row_at(const mt_problem *p, const int *below, int row, mt_clear_row *out)
{
    int left = row;
    for (int i = 0; i < p->n_clears; i++) {
        const mt_clear *const c = &p->clears[i];
        const int flexible = mt_view_vibrations(&p->views[c->view]);
        for (int b = 0; b < c->bands.n; b++) {
            const int k = below[c->first + b];
            const int under = rows_below(c, k);
            const int rows = under + rows_above(c, k, flexible);
            if (left < rows) {
                const bool above = left >= under;
                const int mode = above ? k + 1 + left - under : k - left;
                *out = (mt_clear_row){.clear = i, .band = b, .mode = mode, .above = above};
                return true;
            }
            left -= rows;
        }
    }
    return false;
}

double mt_clear_room(const mt_problem *p, const mt_clear *c)
{
    const mt_modes *const modes = &p->views[c->view].analysis->modes;
    if (p->robust != NULL) {
        return mt_robust_room(p, c);
    }
    double room = mt_modal_indexed(modes) ? HUGE_VAL : nan("");
    for (int b = 0; b < c->bands.n; b++) {
        const mt_band *const band = &c->bands.items[b];
        for (int i = 0; i < modes->count; i++) {
            if (modes->kind[i] == MT_MODE_FLEXIBLE && MT_HAS(room)) {
                const double hz = mt_modal_hz(modes, i);
                const double below =
                    band->lower_hz > 0.0 ? mt_log_ratio(band->lower_hz, hz) : -HUGE_VAL;
                const double above = fmax(mt_log_ratio(hz, band->upper_hz), -MT_MOST_INSIDE);
                room = fmin(room, fmax(below, above));
            }
        }
    }
    return room;
}

double mt_clears_room(const mt_problem *p)
{
    double room = HUGE_VAL;
    for (int i = 0; i < p->n_clears; i++) {
        room = fmin(room, mt_clear_room(p, &p->clears[i]));
    }
    return room;
}

double mt_clear_least_percent(const mt_clear *c, const mt_modes *modes, int *band, int *pos)
{
    double least = HUGE_VAL;
    for (int b = 0; b < c->bands.n; b++) {
        for (int i = 0; i < modes->count; i++) {
            if (modes->kind[i] != MT_MODE_FLEXIBLE) {
                continue;
            }
            const double percent =
                mt_band_clearance_percent(&c->bands.items[b], mt_modal_hz(modes, i), NULL);
            if (!(percent >= least)) {
                least = percent;
                if (band != NULL) {
                    *band = b;
                }
                if (pos != NULL) {
                    *pos = i;
                }
            }
        }
    }
    return least;
}
