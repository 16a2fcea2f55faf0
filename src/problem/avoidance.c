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

#include "problem/avoidance.h"

#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "base/number.h"
#include "problem/configuration.h"
#include "problem/drive_positions.h"
#include "problem/frequency.h"
#include "problem/goals.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"
#include "problem/workspace.h"

/* Range of the extra coordinate: a clearance of -95 % to +2000 %. */
static const double CLEARANCE_LOWER = -3.0;
static const double CLEARANCE_UPPER = 3.0;

static const double TWO_PI = 6.283185307179586476925;

/* Rows of one band: modes k, k-1, ... below and k+1, k+2, ... above, as many as there are and
 * at most the cluster. */
static int rows_below(const mt_avoidance *c, int below)
{
    return below < c->cluster ? below : c->cluster;
}

static int rows_above(const mt_avoidance *c, int below, int flexible)
{
    const int left = flexible - below;
    return left < c->cluster ? left : c->cluster;
}

/* Bands are no number: their rows are those of the clears. */
const mt_goal_ops mt_goal_avoid = {.quantity = MT_QUANTITY_OTHER};

static mt_status unite(mt_problem *p, mt_avoidance *c, mt_err *err)
{
    const mt_study *const s = p->study;
    const mt_bands **const lists =
        mt_arena_alloc(&p->mem, (size_t)s->n_goals, sizeof(mt_bands *));
    int n = 0;
    MT_TRY(mt_arena_check(&p->mem, err));
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
    for (int i = 0; i < p->n_avoidances; i++) {
        if (p->avoidances[i].view == view) {
            mt_avoidance *const c = &p->avoidances[i];
            c->cluster = g->avoid->cluster > c->cluster ? g->avoid->cluster : c->cluster;
            c->tolerance = fmin(c->tolerance, mt_goal_tolerance(g));
            return MT_OK;
        }
    }
    mt_avoidance *const c = &p->avoidances[p->n_avoidances];
    *c = (mt_avoidance){.view = view,
                        .goal_index = goal_index,
                        .cluster = g->avoid->cluster,
                        .first = p->n_bands,
                        .tolerance = mt_goal_tolerance(g)};
    MT_TRY(unite(p, c, err));
    p->n_bands += c->bands.n;
    p->n_avoidances++;
    return MT_OK;
}

mt_status mt_avoidances_compile(mt_problem *p, mt_err *err)
{
    const mt_study *const s = p->study;
    p->avoidances =
        mt_arena_alloc(&p->mem, (size_t)s->model->n_configurations + 1, sizeof *p->avoidances);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < s->n_goals; i++) {
        const mt_goal *const g = &s->goals[i];
        for (int k = 0; g->avoid != NULL && k < g->n_configurations; k++) {
            MT_TRY(add_clear(p, i, mt_problem_configuration(p, g->configurations[k]), err));
        }
    }
    return mt_families_init(p, err);
}

/* The lists of a case with cuts, while they grow. */
typedef struct lists {
    mt_configuration_problem *views;
    mt_avoidance *avoidances;
    int *tie;
    int *below;
} lists;

/* Appends a configuration with its bands. */
static mt_status add_cut(mt_subproblem *c, const mt_cut *cut, lists *l, mt_arena *mem,
                         mt_err *err)
{
    const mt_problem *const p = c->p;
    const mt_drive_positions *const f = &p->families[cut->drive_positions];
    mt_avoidance *const avoidance = &l->avoidances[c->n_avoidances];
    mt_band_along_paths way = {0};
    double *const at = mt_arena_f64(mem, (size_t)f->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < f->n; k++) {
        at[k] = mt_drive_positions_position(f, p->views[f->view[k]].original);
    }
    MT_TRY(mt_drive_positions_bands(p, f, at, cut->position, cut->position, mem, &way, err));
    const int n = way.n;
    int *const tie = mt_arena_int(mem, (size_t)c->n_bands + (size_t)n);
    int *const below = mt_arena_int(mem, (size_t)c->n_bands + (size_t)n);
    *avoidance = (mt_avoidance){
        .view = c->n_views,
        .cluster = 1,
        .first = c->n_bands,
        .tolerance = HUGE_VAL,
        .bands = {.n = n, .items = mt_arena_alloc(mem, (size_t)n, sizeof(mt_band))}};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = p->n_avoidances - 1; i >= 0; i--) {
        const mt_avoidance *const own = &p->avoidances[i];
        if (mt_drive_positions_of(p, own->view) == cut->drive_positions) {
            avoidance->goal_index = own->goal_index;
            avoidance->cluster =
                own->cluster > avoidance->cluster ? own->cluster : avoidance->cluster;
        }
    }
    memcpy(tie, l->tie, (size_t)c->n_bands * sizeof *tie);
    memcpy(below, l->below, (size_t)c->n_bands * sizeof *below);
    for (int i = 0; i < n; i++) {
        avoidance->bands.items[i] = way.items[i].band;
        avoidance->tolerance = fmin(avoidance->tolerance, way.items[i].tolerance);
        tie[c->n_bands + i] = way.items[i].tie;
        below[c->n_bands + i] = l->below[way.items[i].tie];
    }
    l->views[c->n_views++] = (mt_configuration_problem){.configuration = f->configuration,
                                                        .original = cut->original,
                                                        .n_rigid = cut->original->n_rigid,
                                                        .n_most = cut->original->n_most};
    l->tie = tie;
    l->below = below;
    c->n_bands += n;
    c->n_avoidances++;
    return MT_OK;
}

static mt_status add_cuts(mt_subproblem *c, int n_cuts, const mt_cut *cuts, lists *l,
                          mt_arena *mem, mt_err *err)
{
    const mt_problem *const p = c->p;
    const size_t n_views = (size_t)p->n_views + (size_t)n_cuts;
    const size_t n_avoidances = (size_t)p->n_avoidances + (size_t)n_cuts;
    l->views = mt_arena_alloc(mem, n_views, sizeof *l->views);
    l->avoidances = mt_arena_alloc(mem, n_avoidances, sizeof *l->avoidances);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(l->views, p->views, (size_t)p->n_views * sizeof *l->views);
    memcpy(l->avoidances, p->avoidances, (size_t)p->n_avoidances * sizeof *l->avoidances);
    for (int i = 0; i < n_cuts; i++) {
        MT_TRY(cuts[i].requirement < 0 ? add_cut(c, &cuts[i], l, mem, err) : MT_OK);
    }
    c->views = l->views;
    c->avoidances = l->avoidances;
    return MT_OK;
}

/* Configurations, bands and mode placement of the subproblem, with those at cuts. */
static mt_status place_modes(const mt_row_layout *l, mt_err *err)
{
    mt_subproblem *const c = l->c;
    const mt_problem *const p = c->p;
    const bool any = l->below != NULL && p->n_bands > 0;
    lists own = {.tie = p->tie};
    c->clearance = any && mt_objective_is(c->stages[0].type, MT_BANDS);
    c->n_avoidances = p->n_avoidances;
    c->avoidances = p->avoidances;
    c->n_bands = p->n_bands;
    c->tie = p->tie;
    c->below = NULL;
    if (!any) {
        return MT_OK;
    }
    own.below = mt_arena_int(l->mem, (size_t)p->n_bands);
    MT_TRY(mt_arena_check(l->mem, err));
    memcpy(own.below, l->below, (size_t)p->n_bands * sizeof *own.below);
    MT_TRY(l->n_cuts > 0 ? add_cuts(c, l->n_cuts, l->cuts, &own, l->mem, err) : MT_OK);
    c->tie = own.tie;
    c->below = own.below;
    if (c->clearance) {
        c->n_t = p->n + 1;
        c->lower_t[p->n] = CLEARANCE_LOWER;
        c->upper_t[p->n] = CLEARANCE_UPPER;
        c->origin_t[p->n] = 0.0;
    }
    return MT_OK;
}

static mt_status lay_out_bands(const mt_row_layout *l, mt_err *err)
{
    mt_subproblem *const c = l->c;
    mt_row row;
    MT_TRY(place_modes(l, err));
    mt_avoidance_rows rows = {.c = c, .below = c->below};
    while (c->below != NULL && mt_avoidance_next_row(&rows, &row)) {
        MT_TRY(mt_rows_append(&c->rows.in, &row, l->mem, err));
    }
    return MT_OK;
}

/* One row: in = sign ln(f / edge) - z, sign -1 for a mode below the band. */
static mt_status eval_band(mt_workspace *w, int at, bool with_gradient, mt_nlp_values *out,
                           mt_err *err)
{
    const mt_row *const row = &w->c->rows.in.rows[at];
    mt_analysis *const a = w->views[row->view].analysis;
    const int n = w->p->n;
    const double z = w->c->clearance ? w->t[n] : 0.0;
    const ptrdiff_t rows = w->c->rows.in.n;
    const double sign = mt_row_sign(row);
    const int pos = mt_modal_flexible(&a->modes, row->mode);
    const double floor = MT_FREQUENCY_FLOOR * row->limit;
    if ((pos < 0 && !mt_analysis_is_infinite(a, row->mode)) || !(row->limit > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" has no vibration mode %d here",
                       mt_analysis_configuration(a), row->mode);
    }
    out->in[at] = (sign * mt_problem_ln_ratio(&a->modes, pos, row->limit, floor)) - z;
    if (!with_gradient) {
        return MT_OK;
    }
    MT_TRY(mt_problem_dln_frequency(w, a, pos, floor, w->dshape, err));
    for (int i = 0; i < n; i++) {
        out->din[at + (i * rows)] = sign * w->dshape[i];
    }
    if (w->c->n_t > n) {
        out->din[at + (n * rows)] = w->c->clearance ? -1.0 : 0.0;
    }
    return MT_OK;
}

static mt_status eval_bands(mt_workspace *w, bool with_gradient, mt_nlp_values *out,
                            mt_err *err)
{
    const mt_row_span span = w->c->rows.of_kind[MT_ROW_BAND];
    for (int k = 0; k < span.n; k++) {
        const bool own = w->c->rows.in.rows[span.first + k].kind == MT_ROW_BAND;
        MT_TRY(own ? eval_band(w, span.first + k, with_gradient, out, err) : MT_OK);
    }
    return MT_OK;
}

const mt_row_ops mt_rows_bands = {.lay_out = lay_out_bands, .eval = eval_bands};

double mt_avoidance_find_modes(const mt_avoidance *c, const mt_modes *modes, int *below)
{
    const double room = mt_bands_find(&c->bands, modes, below);
    return mt_modal_indexed(modes) ? room : nan("");
}

/* Row `left` of one band: modes below it, nearest first, then those above. */
static mt_row row_of_band(const mt_subproblem *c, int i, int b, int k, int under, int left)
{
    const mt_avoidance *const avoidance = &c->avoidances[i];
    const mt_band *const band = &avoidance->bands.items[b];
    const bool above = left >= under;
    mt_row row = mt_row_init(MT_ROW_BAND, above ? MT_AT_LEAST : MT_AT_MOST);
    row.avoidance = i;
    row.band = b;
    row.view = avoidance->view;
    row.mode = above ? k + 1 + left - under : k - left;
    row.limit = above ? band->upper_hz : band->lower_hz;
    row.tolerance = avoidance->tolerance;
    return row;
}

bool mt_avoidance_next_row(mt_avoidance_rows *rows, mt_row *out)
{
    const mt_subproblem *const c = rows->c;
    for (; rows->avoidance < c->n_avoidances; rows->avoidance++, rows->band = 0) {
        const mt_avoidance *const avoidance = &c->avoidances[rows->avoidance];
        const int flexible = mt_configuration_vibrations(&c->views[avoidance->view]);
        for (; rows->band < avoidance->bands.n; rows->band++, rows->row = 0) {
            const int k = rows->below[avoidance->first + rows->band];
            const int under = rows_below(avoidance, k);
            if (rows->row < under + rows_above(avoidance, k, flexible)) {
                *out = row_of_band(c, rows->avoidance, rows->band, k, under, rows->row++);
                return true;
            }
        }
    }
    return false;
}

void mt_avoidances_query(const mt_subproblem *c, int view, mt_modal_part *shapes)
{
    const int flexible = mt_configuration_vibrations(&c->views[view]);
    for (int i = 0; i < c->n_avoidances; i++) {
        const mt_avoidance *const avoidance = &c->avoidances[i];
        for (int b = 0; b < avoidance->bands.n && avoidance->view == view; b++) {
            const int below = c->below != NULL ? c->below[avoidance->first + b] : 0;
            const int rows =
                c->below != NULL ? below + rows_above(avoidance, below, flexible) : 0;
            const double omega = TWO_PI * avoidance->bands.items[b].upper_hz;
            const int most = rows > 0 ? rows + MT_MODE_ORDER_MOST : 0;
            shapes->first = most > shapes->first ? most : shapes->first;
            shapes->up_to = fmax(shapes->up_to, omega * omega);
        }
    }
}

int mt_avoidances_reach(const mt_workspace *w, int view)
{
    const mt_modes *const modes = &w->views[view].analysis->modes;
    int n = 0;
    for (int c = 0; c < w->c->n_avoidances; c++) {
        const mt_bands *const bands = &w->c->avoidances[c].bands;
        if (w->c->avoidances[c].view != view || bands->n == 0) {
            continue;
        }
        const double top = bands->items[bands->n - 1].upper_hz;
        for (int i = 0; i < modes->count; i++) {
            n += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
            if (modes->kind[i] == MT_MODE_FLEXIBLE && !mt_exceeds(top, mt_modal_hz(modes, i))) {
                break; /* the first above all bands still says how far it stays away */
            }
        }
    }
    return n;
}

mt_analysis_options mt_configuration_queries(const mt_workspace *w,
                                             const mt_configuration_work *view,
                                             bool with_gradient)
{
    mt_analysis_options opt = view->ask;
    opt.gradient = with_gradient;
    opt.accuracy = w->accuracy;
    if (!view->all && !opt.vectors) {
        mt_avoidances_query(w->c, (int)(view - w->views), &opt.shapes);
    }
    return opt;
}
