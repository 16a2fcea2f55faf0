/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/mode_placements_bounds.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "problem/avoidance.h"
#include "problem/objective.h"

/* Of levels, the change grows by the same factor from the first to the last but one. */
enum { LEVELS_MOST = 40, LEVELS_LEAST = 8 };
static const double FIRST_LEVEL = 0.03; /* of the change that leads to all bounds */
/* Two eigensolves of n modes, in multiplications over n^3. */
static const double SOLVES = 20.0;
/* What a bound gives away, relatively, for the rounding of boxes. */
static const double ROUNDING = 1e-9;

/* The box of change c within the bounds, where coordinate `wide` (-1: all) goes to c and the
 * others to c / sqrt(2); false where it is empty. */
static bool set_box(const mt_subproblem *c, double change, int wide, double *t, double *lo,
                    double *hi)
{
    const mt_problem *const p = c->p;
    double *const side[2] = {lo, hi};
    for (int s = 0; s < 2; s++) {
        for (int i = 0; i < p->n; i++) {
            const double own = wide < 0 || wide == i ? change : change / sqrt(2.0);
            const double most = own / sqrt(p->study->variables[i].weight);
            const double at = c->origin_t[i] + (s == 0 ? -most : most);
            if (s == 0 ? at > c->upper_t[i] : at < c->lower_t[i]) {
                return false;
            }
            t[i] = fmin(fmax(at, c->lower_t[i]), c->upper_t[i]);
        }
        mt_subproblem_x(c, t, side[s]);
    }
    for (int i = 0; i < p->n; i++) {
        const double slack = ROUNDING * fmax(fabs(lo[i]), fabs(hi[i]));
        lo[i] = fmax(lo[i] - slack, c->lower[i]);
        hi[i] = fmin(hi[i] + slack, c->upper[i]);
    }
    return true;
}

/* The change that leads from the original to all bounds. */
static double whole_change(const mt_subproblem *c)
{
    double most = 0.0;
    for (int i = 0; i < c->p->n; i++) {
        const double away =
            fmax(fabs(c->origin_t[i] - c->lower_t[i]), fabs(c->upper_t[i] - c->origin_t[i]));
        most = fmax(most, away * sqrt(c->p->study->variables[i].weight));
    }
    return most;
}

/* What the modes of every view can be within a box. */
typedef struct ranges {
    bool known; /* false: they can be anything */
    double **low;
    double **high;
    bool *blocked; /* [n_bands] work */
} ranges;

static mt_status find_enclosed_ranges(const mt_proof *proof, const double *lo, const double *hi,
                                      ranges *r, mt_err *err)
{
    r->known = true;
    for (int v = 0; v < proof->question.n_views && r->known; v++) {
        mt_enclosure *const e = proof->views[v];
        r->known = mt_enclosure_set(e, lo, hi);
        if (!r->known) {
            break;
        }
        MT_TRY(mt_enclosure_ranges(e, r->low[v], r->high[v], err));
        e->operations += SOLVES * pow((double)e->n, 3.0);
    }
    return MT_OK;
}

/* True where `below` modes can lie below the band, and the others above it. */
static bool allows(const mt_proof *proof, const ranges *r, int band, int below)
{
    const mt_certify_band *const b = &proof->bands[band];
    const int n = proof->views[b->view]->n_modes;
    return !r->known ||
           (below <= n &&
            (below == 0 ||
             !(r->low[b->view][below - 1] > b->lower_hz * (1.0 + b->tolerance))) &&
            (below == n || !(r->high[b->view][below] < b->upper_hz * (1.0 - b->tolerance))));
}

static bool keeps_limits(const mt_proof *proof, const ranges *r)
{
    bool kept = true;
    for (int i = 0; i < proof->question.n_limits && r->known; i++) {
        const mt_certify_limit *const l = &proof->limits[i];
        const int k = l->mode - 1;
        kept = kept && k < proof->views[l->view]->n_modes &&
               !(r->low[l->view][k] > l->at_most_hz * (1.0 + l->tolerance)) &&
               !(r->high[l->view][k] < l->at_least_hz * (1.0 - l->tolerance));
    }
    return kept;
}

/* Level of band i with that many modes below it, in a box. */
static int *entry(const mt_mode_placement_bounds *b, int box, int band, int below)
{
    const ptrdiff_t row = b->most + 1;
    return &b->level[(((ptrdiff_t)box * b->c->p->n_bands + band) * row) + below];
}

/* Records what first becomes possible in this box, at level k. */
static void note_level(const mt_proof *proof, const ranges *r, int box, int k,
                       mt_mode_placement_bounds *b)
{
    const mt_problem *const p = b->c->p;
    for (int below = 0; below <= b->most; below++) {
        memset(r->blocked, 0, (size_t)p->n_bands * sizeof *r->blocked);
        for (int i = 0; i < p->n_bands; i++) {
            bool *const blocked = &r->blocked[p->tie[i]];
            *blocked = *blocked || !allows(proof, r, i, below);
        }
        for (int i = 0; i < p->n_bands; i++) {
            int *const level = entry(b, box, i, below);
            const bool possible = p->tie[i] == i && *level == b->n_levels && !r->blocked[i];
            *level = possible ? k : *level;
        }
    }
    b->any[box] = b->any[box] == b->n_levels && keeps_limits(proof, r) ? k : b->any[box];
}

static mt_status claim_ranges(const mt_proof *proof, mt_arena *mem, ranges *r, mt_err *err)
{
    const size_t n = (size_t)proof->question.n_views;
    r->blocked = mt_arena_alloc(mem, (size_t)proof->question.n_bands, sizeof *r->blocked);
    r->low = mt_arena_alloc(mem, n, sizeof *r->low);
    r->high = mt_arena_alloc(mem, n, sizeof *r->high);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t v = 0; v < n; v++) {
        const size_t modes = (size_t)proof->views[v]->n_modes;
        r->low[v] = mt_arena_f64(mem, modes, 1);
        r->high[v] = mt_arena_f64(mem, modes, 1);
    }
    return mt_arena_check(mem, err);
}

static mt_status find_levels(const mt_proof *proof, double whole, mt_arena *mem,
                             mt_mode_placement_bounds *b, mt_err *err)
{
    const size_t n = (size_t)b->c->p->n;
    const double growth = pow(1.0 / FIRST_LEVEL, 1.0 / (double)(b->n_levels - 1));
    double *const t = mt_arena_f64(mem, n, 1);
    double *const lo = mt_arena_f64(mem, n, 1);
    double *const hi = mt_arena_f64(mem, n, 1);
    ranges r = {.known = false};
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(claim_ranges(proof, mem, &r, err));
    for (int k = 0; k < b->n_levels; k++) {
        const bool last = k + 1 == b->n_levels;
        const double change = FIRST_LEVEL * whole * pow(growth, (double)k);
        b->least[k + 1] = 0.5 * change * change * (1.0 - ROUNDING);
        for (int box = 0; box < b->n_boxes; box++) {
            const int wide = b->n_boxes > 1 ? box : -1;
            const bool some = set_box(b->c, last ? 2.0 * whole : change, wide, t, lo, hi);
            MT_TRY(some ? find_enclosed_ranges(proof, lo, hi, &r, err) : MT_OK);
            if (some) {
                note_level(proof, &r, box, k, b);
            }
        }
    }
    b->least[b->n_levels] = HUGE_VAL;
    return MT_OK;
}

/*
 * A placement asks of each mode that its frequency stay below some bands and above others,
 *
 *     least_j <= ln f_j <= most_j.
 *
 * To first order, ln f_j = ln f_j(original) + g_j u, the change is |u|, and the least one
 *
 *     minimise 1/2 |u|^2   subject to   least_j <= ln f_j(original) + g_j u <= most_j
 *
 * a quadratic program whose dual is ascended coordinate by coordinate (Hildreth 1957): with the
 * multipliers m >= 0 of the rows a_k u >= b_k,
 *
 *     u = sum m_k a_k,   m_k <- max(0, m_k + (b_k - a_k u) / |a_k|^2),
 *
 * and sum m_k b_k - 1/2 |u|^2 rises to the least change. Some sweeps are enough for an order.
 */
enum { SWEEPS = 30 };
/* Step of the differences, in t. */
static const double STEP = 1e-3;

/* ln of the frequencies at the point x. */
static mt_status find_frequencies(const mt_proof *proof, const double *x, double *out,
                                  mt_arena *mem, mt_err *err)
{
    for (int v = 0; v < proof->question.n_views; v++) {
        mt_enclosure *const e = proof->views[v];
        const size_t n = (size_t)e->n_modes;
        double *const low = mt_arena_f64(mem, n, 1);
        double *const high = mt_arena_f64(mem, n, 1);
        MT_TRY(mt_arena_check(mem, err));
        const bool known = mt_enclosure_set(e, x, x);
        MT_TRY(known ? mt_enclosure_ranges(e, low, high, err) : MT_OK);
        for (size_t j = 0; j < n; j++) {
            const double hz = 0.5 * (low[j] + high[j]);
            *out++ = known && hz > 0.0 ? log(hz) : nan("");
        }
    }
    return MT_OK;
}

static mt_status find_gradient(mt_mode_placement_estimates *e, mt_arena *mem, mt_err *err)
{
    const mt_subproblem *const c = e->c;
    const size_t n = (size_t)c->p->n;
    const size_t n_modes = (size_t)e->n_modes;
    double *const t = mt_arena_f64(mem, n, 1);
    double *const x = mt_arena_f64(mem, n, 1);
    double *const moved = mt_arena_f64(mem, n_modes, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n; i++) {
        t[i] = fmin(fmax(c->origin_t[i], c->lower_t[i]), c->upper_t[i]);
    }
    mt_subproblem_x(c, t, x);
    MT_TRY(find_frequencies(e->proof, x, e->ln_f, mem, err));
    for (size_t i = 0; i < n; i++) {
        const double at = t[i];
        const double room = c->upper_t[i] - c->lower_t[i];
        const double size = fmin(STEP, 0.5 * room);
        const double step = at + size <= c->upper_t[i] ? size : -size;
        const double unit = step * sqrt(c->p->study->variables[i].weight);
        if (!(room > 0.0)) {
            continue;
        }
        t[i] = at + step;
        mt_subproblem_x(c, t, x);
        t[i] = at;
        MT_TRY(find_frequencies(e->proof, x, moved, mem, err));
        for (size_t j = 0; j < n_modes; j++) {
            const double slope = (moved[j] - e->ln_f[j]) / unit;
            e->gradient[(j * n) + i] = isfinite(slope) ? slope : 0.0;
        }
    }
    return MT_OK;
}

/* Slopes by differences: n + 1 eigensolves of each configuration. */
static mt_status make_estimates(const mt_subproblem *c, const mt_proof *proof, mt_arena *mem,
                                mt_mode_placement_estimates *out, mt_err *err)
{
    const size_t n = (size_t)c->p->n;
    *out = (mt_mode_placement_estimates){.c = c, .proof = proof};
    for (int v = 0; v < proof->question.n_views; v++) {
        out->n_modes += proof->views[v]->n_modes;
    }
    const size_t n_modes = (size_t)out->n_modes;
    out->ln_f = mt_arena_f64(mem, n_modes, 1);
    out->gradient = mt_arena_f64(mem, n_modes, n);
    out->u = mt_arena_f64(mem, n, 1);
    out->least = mt_arena_f64(mem, n_modes, 1);
    out->most = mt_arena_f64(mem, n_modes, 1);
    out->multiplier = mt_arena_f64(mem, n_modes, 2);
    MT_TRY(mt_arena_check(mem, err));
    return find_gradient(out, mem, err);
}

/* What the placement asks of each mode. */
static void find_limits(const mt_mode_placement_estimates *e, const int *below)
{
    const mt_proof *const proof = e->proof;
    int first = 0;
    for (int j = 0; j < e->n_modes; j++) {
        e->least[j] = -HUGE_VAL;
        e->most[j] = HUGE_VAL;
    }
    for (int v = 0; v < proof->question.n_views; v++) {
        const int n = proof->views[v]->n_modes;
        for (int i = 0; i < proof->question.n_bands; i++) {
            const mt_certify_band *const b = &proof->bands[i];
            const int k = below[i];
            if (b->view == v && k > 0 && k <= n && b->lower_hz > 0.0) {
                double *const most = &e->most[first + k - 1];
                *most = fmin(*most, log(b->lower_hz));
            }
            if (b->view == v && k < n) {
                double *const least = &e->least[first + k];
                *least = fmax(*least, log(b->upper_hz));
            }
        }
        first += n;
    }
}

/* One step of the dual for the row sign (g u - b) >= 0; returns its part of sum m b. */
static double ascend(const mt_mode_placement_estimates *e, int mode, double sign, double b,
                     double *multiplier)
{
    const int n = e->c->p->n;
    const double *const g = e->gradient + ((ptrdiff_t)mode * n);
    double square = 0.0;
    double value = 0.0;
    if (!isfinite(b)) {
        return 0.0;
    }
    for (int i = 0; i < n; i++) {
        square += g[i] * g[i];
        value += g[i] * e->u[i];
    }
    if (!(square > 0.0)) {
        return 0.0;
    }
    const double before = *multiplier;
    *multiplier = fmax(0.0, before + (sign * (b - value) / square));
    for (int i = 0; i < n; i++) {
        e->u[i] += (*multiplier - before) * sign * g[i];
    }
    return *multiplier * sign * b;
}

/* 1/2 c^2, c the estimated change of placement below[n_bands]. */
static double estimate_change(const mt_mode_placement_estimates *e, const int *below)
{
    const int n = e->c->p->n;
    double linear = 0.0;
    double square = 0.0;
    find_limits(e, below);
    memset(e->u, 0, (size_t)n * sizeof *e->u);
    memset(e->multiplier, 0, 2 * (size_t)e->n_modes * sizeof *e->multiplier);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        linear = 0.0;
        for (int j = 0; j < e->n_modes; j++) {
            double *const m = e->multiplier + (2 * (ptrdiff_t)j);
            linear += ascend(e, j, 1.0, e->least[j] - e->ln_f[j], &m[0]);
            linear += ascend(e, j, -1.0, e->most[j] - e->ln_f[j], &m[1]);
        }
    }
    for (int i = 0; i < n; i++) {
        square += e->u[i] * e->u[i];
    }
    return fmax(linear - (0.5 * square), 0.0);
}

mt_status mt_mode_placement_bounds_make(const mt_subproblem *c, const mt_proof *proof,
                                        double work, mt_arena *mem,
                                        mt_mode_placement_bounds *out, bool *known, mt_err *err)
{
    const mt_problem *const p = c->p;
    const double whole = whole_change(c);
    double cost = 0.0;
    *out = (mt_mode_placement_bounds){.c = c};
    *known = false;
    if (!proof->possible || c->stages[0].type != MT_OBJECTIVE_CHANGE || !(whole > 0.0)) {
        return MT_OK;
    }
    for (int v = 0; v < proof->question.n_views; v++) {
        const int n = proof->views[v]->n_modes;
        cost += SOLVES * pow((double)proof->views[v]->n, 3.0);
        out->most = n > out->most ? n : out->most;
    }
    out->n_boxes = p->n > 1 && work >= LEVELS_LEAST * cost * (double)p->n ? p->n : 1;
    const double levels = floor(work / (cost * (double)out->n_boxes));
    if (!(levels >= LEVELS_LEAST)) {
        return MT_OK;
    }
    const size_t boxes = (size_t)out->n_boxes;
    const size_t entries = boxes * (size_t)p->n_bands * (size_t)(out->most + 1);
    out->n_levels = levels < LEVELS_MOST ? (int)levels : LEVELS_MOST;
    out->any = mt_arena_int(mem, boxes);
    out->level = mt_arena_int(mem, entries);
    out->least = mt_arena_f64(mem, (size_t)out->n_levels + 1, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < entries; i++) {
        out->level[i] = out->n_levels;
    }
    for (size_t i = 0; i < boxes; i++) {
        out->any[i] = out->n_levels;
    }
    MT_TRY(find_levels(proof, whole, mem, out, err));
    MT_TRY(make_estimates(c, proof, mem, &out->estimates, err));
    *known = !mt_interrupted(p->run->interrupt);
    return MT_OK;
}

static int level_of(const mt_mode_placement_bounds *b, int box, int band, int below)
{
    return below > b->most ? b->n_levels : *entry(b, box, b->c->p->tie[band], below);
}

/* Level of the first n bands of a placement. */
static int level_of_first(const mt_mode_placement_bounds *b, const int *below, int n)
{
    int least = b->n_levels;
    for (int box = 0; box < b->n_boxes; box++) {
        int level = b->any[box];
        for (int i = 0; i < n && level < least; i++) {
            const int own = level_of(b, box, i, below[i]);
            level = own > level ? own : level;
        }
        least = level < least ? level : least;
    }
    return least;
}

/* A walk through the assignments, band by band. */
typedef struct walk {
    const mt_mode_placement_bounds *b;
    int cap;      /* levels up to this one */
    int most;     /* so many assignments and no more */
    long visited; /* bands set so far */
    int n;
    int *below; /* [n_bands] */
    /* [n_bands] of the earlier bands of the same configuration the next one below or at the
     * same height, and the next one above; -1: none. Earlier bands are in order already, so
     * these two alone limit the number of modes */
    int *under;
    int *over;
    int *reached; /* [(n_bands + 1) x n_boxes] level of so many bands in each box */
    int *list;    /* [most x n_bands]; NULL: they are counted */
} walk;

/* More would take long even to count. */
enum { VISITED_MOST = 1000000 };

typedef struct placed_band {
    int view;
    double lower_hz;
} placed_band;

static placed_band band_at(const mt_problem *p, int band)
{
    int i = 0;
    while (band >= p->avoidances[i].first + p->avoidances[i].bands.n) {
        i++;
    }
    return (placed_band){p->avoidances[i].view,
                         p->avoidances[i].bands.items[band - p->avoidances[i].first].lower_hz};
}

/* Of two bands of one configuration no fewer modes lie below the upper one. */
static void find_neighbours(const mt_problem *p, const placed_band *at, walk *w)
{
    for (int band = 0; band < p->n_bands; band++) {
        int under = -1;
        int over = -1;
        for (int i = 0; i < band; i++) {
            const double hz = at[i].lower_hz;
            if (at[i].view != at[band].view) {
                continue;
            }
            if (hz <= at[band].lower_hz) {
                under = under < 0 || hz >= at[under].lower_hz ? i : under;
            } else {
                over = over < 0 || hz < at[over].lower_hz ? i : over;
            }
        }
        w->under[band] = under;
        w->over[band] = over;
    }
}

static mt_status begin_walk(const mt_mode_placement_bounds *b, int most, mt_arena *mem, walk *w,
                            mt_err *err)
{
    const mt_problem *const p = b->c->p;
    const size_t row = (size_t)p->n_bands;
    *w = (walk){.b = b,
                .most = most,
                .below = mt_arena_int(mem, row),
                .under = mt_arena_int(mem, row),
                .over = mt_arena_int(mem, row),
                .reached = mt_arena_int(mem, (row + 1) * (size_t)b->n_boxes)};
    placed_band *const at = mt_arena_alloc(mem, row, sizeof *at);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < p->n_bands; i++) {
        at[i] = band_at(p, i);
    }
    find_neighbours(p, at, w);
    for (int box = 0; box < b->n_boxes; box++) {
        w->reached[box] = b->any[box];
    }
    return MT_OK;
}

static bool is_over(const walk *w)
{
    return w->n > w->most || w->visited > VISITED_MOST;
}

/* Levels with one band more in each box; false where all are above the cap. */
static bool reaches(const walk *w, int band)
{
    const mt_mode_placement_bounds *const b = w->b;
    const int *const before = w->reached + ((ptrdiff_t)band * b->n_boxes);
    int *const after = w->reached + ((ptrdiff_t)(band + 1) * b->n_boxes);
    bool any = false;
    for (int box = 0; box < b->n_boxes; box++) {
        const int own = level_of(b, box, band, w->below[band]);
        after[box] = own > before[box] ? own : before[box];
        any = any || after[box] <= w->cap;
    }
    return any;
}

static void walk_from(walk *w, int band) /* NOLINT(misc-no-recursion): as deep as bands */
{
    const mt_problem *const p = w->b->c->p;
    if (band == p->n_bands) {
        if (w->list != NULL && w->n < w->most) {
            memcpy(w->list + ((ptrdiff_t)w->n * p->n_bands), w->below,
                   (size_t)p->n_bands * sizeof *w->below);
        }
        w->n++;
        return;
    }
    const bool tied = p->tie[band] != band;
    const int same = w->below[p->tie[band]];
    const int least = w->under[band] >= 0 ? w->below[w->under[band]] : 0;
    const int most = w->over[band] >= 0 ? w->below[w->over[band]] : w->b->most;
    const int first = tied && same > least ? same : least;
    const int last = tied && same < most ? same : most;
    for (int k = first; k <= last && !is_over(w); k++) {
        w->below[band] = k;
        w->visited++;
        if (reaches(w, band)) {
            walk_from(w, band + 1);
        }
    }
}

static bool count_placements(walk *w, int cap)
{
    w->cap = cap;
    w->n = 0;
    w->visited = 0;
    walk_from(w, 0);
    return !is_over(w);
}

/* The highest level up to which they can be counted, -1: none. More levels are no fewer
 * assignments. */
static int find_cap(walk *w)
{
    int good = -1;
    int bad = w->b->n_levels;
    while (bad - good > 1) {
        const int middle = good + ((bad - good) / 2);
        if (count_placements(w, middle)) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    return good;
}

typedef struct ranked {
    double least;
    double estimate;
    int place;
} ranked;

static int by_least(const void *a, const void *b)
{
    const ranked *const x = a;
    const ranked *const y = b;
    if (x->least != y->least) {
        return x->least < y->least ? -1 : 1;
    }
    if (x->estimate != y->estimate) {
        return x->estimate < y->estimate ? -1 : 1;
    }
    return x->place < y->place ? -1 : 1;
}

mt_status mt_mode_placement_bounds_sort(const mt_mode_placement_bounds *b,
                                        mt_mode_placement_candidates *c, mt_arena *mem,
                                        mt_err *err)
{
    const mt_problem *const p = b->c->p;
    const size_t n = (size_t)c->n;
    const size_t row = (size_t)p->n_bands;
    const size_t width = (size_t)p->n;
    ranked *const order = mt_arena_alloc(mem, n, sizeof *order);
    int *const below = mt_arena_int(mem, n * row);
    double *const at = mt_arena_f64(mem, width, n);
    double *const least = mt_arena_f64(mem, n, 1);
    double *const estimate = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t k = 0; k < n; k++) {
        const int *const own = c->below + (k * row);
        order[k] =
            (ranked){.least = b->least[level_of_first(b, own, p->n_bands)], .place = (int)k};
        order[k].estimate = estimate_change(&b->estimates, own);
    }
    qsort(order, n, sizeof *order, by_least);
    for (size_t k = 0; k < n; k++) {
        const size_t from = (size_t)order[k].place;
        least[k] = order[k].least;
        estimate[k] = order[k].estimate;
        memcpy(below + (k * row), c->below + (from * row), row * sizeof *below);
        for (size_t i = 0; i < width; i++) {
            at[(k * width) + i] = c->at == NULL ? nan("") : c->at[(from * width) + i];
        }
    }
    c->below = below;
    c->at = at;
    c->least = least;
    c->estimate = estimate;
    return MT_OK;
}

mt_status mt_mode_placement_bounds_list(const mt_mode_placement_bounds *b, int most,
                                        mt_arena *mem, mt_mode_placement_candidates *out,
                                        double *rest, mt_err *err)
{
    const size_t row = (size_t)b->c->p->n_bands;
    walk w;
    *out = (mt_mode_placement_candidates){.n = 0};
    MT_TRY(begin_walk(b, most, mem, &w, err));
    const int cap = find_cap(&w);
    *rest = cap + 1 < b->n_levels ? b->least[cap + 1] : HUGE_VAL;
    if (cap < 0 || !count_placements(&w, cap) || w.n == 0) {
        return MT_OK;
    }
    w.list = mt_arena_int(mem, (size_t)w.n * row);
    MT_TRY(mt_arena_check(mem, err));
    w.most = w.n;
    (void)count_placements(&w, cap);
    out->n = w.n;
    out->below = w.list;
    return mt_mode_placement_bounds_sort(b, out, mem, err);
}
