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
    MT_TRY(mt_mode_placement_estimates_make(c, proof, mem, &out->estimates, err));
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
        order[k].estimate = mt_mode_placement_estimate(&b->estimates, own);
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
