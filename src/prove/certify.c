/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Branch and bound over assignments. For a box and a band [a, b], the number j of modes below
 * the band at any design that keeps it lies in
 *     least_below(b) <= j <= most_below(a),
 * so the box is done with where for some band (or limit, or bound) nothing is left, or where
 * all assignments that are left are known. Else the box is halved; what is known of it holds in
 * its halves. Where a single unknown assignment is left, or a pass ends, the middle
 * of the box is tried: a design that meets everything makes its assignment known. Catalogues
 * only thin the boxes out, and a cap cuts off those whose designs are all too costly: with the
 * objective of a known design as cap, "nothing found, nothing open" proves that none is better.
 *
 * Assignments have to be in order within a view, and equal where bands are the same (same_as).
 * Both are narrowed in before anything is listed: j(i) >= j(before i), j(i) = j(same as i).
 *
 * Passes go deeper and deeper (iterative deepening). Depth first at once would dive into the
 * first surface on which two assignments touch, where boxes stay undecided down to rounding,
 * before it meets the designs next to it that settle the matter. What earlier passes cost is a
 * fraction of the last one.
 */
#include "prove/certify.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "prove/box.h"
#include "prove/boxes.h"

/* Modes below the edges of bands and limits, over nested boxes. */

static void add_band_edge(mt_edges *d, int view, double hz, mt_side asked)
{
    const int k = d->n++;
    d->edges[k] = (mt_edge){view, mt_enclosure_lambda(hz), asked};
    d->root[k] = 0;
}

mt_status mt_edges_init(mt_edges *d, const mt_certify *c, mt_arena *mem, mt_err *err)
{
    const size_t most = 2 * ((size_t)c->n_bands + (size_t)c->n_limits);
    const size_t corners = 2 * (size_t)c->n_views;
    *d = (mt_edges){.c = c, .n_known = (int)(2 * most + corners)};
    d->edges = mt_arena_alloc(mem, most, sizeof *d->edges);
    d->root = mt_arena_int(mem, (size_t)d->n_known);
    d->fresh = mt_arena_alloc(mem, corners, sizeof *d->fresh);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->n_bands; i++) {
        const mt_certify_band *const b = &c->bands[i];
        add_band_edge(d, b->view, b->lower_hz * (1.0 + b->tolerance), MT_LOW);
        add_band_edge(d, b->view, b->upper_hz * (1.0 - b->tolerance), MT_HIGH);
    }
    for (int i = 0; i < c->n_limits; i++) {
        const mt_certify_limit *const l = &c->limits[i];
        add_band_edge(d, l->view, l->at_most_hz * (1.0 + l->tolerance), MT_LOW);
        add_band_edge(d, l->view, l->at_least_hz * (1.0 - l->tolerance), MT_HIGH);
    }
    for (int k = 0; k < d->n; k++) {
        /* no vibration mode lies below 0 Hz */
        d->root[d->n + k] = d->edges[k].lambda > 0.0 ? c->views[d->edges[k].view]->n_modes : 0;
    }
    for (size_t k = 2 * most; k < 2 * most + corners; k++) {
        d->root[k] = -1;
    }
    return MT_OK;
}

void mt_edges_use(mt_edges *d, int *now)
{
    int *const keys = now + (2 * (ptrdiff_t)d->n);
    d->now = now;
    for (int v = 0; v < d->c->n_views; v++) {
        for (mt_side s = MT_LOW; s <= MT_HIGH; s++) {
            const int key = mt_enclosure_corner_key(d->c->views[v], s);
            const int at = (2 * v) + (s == MT_LOW ? 0 : 1);
            d->fresh[at] = key != keys[at];
            keys[at] = key;
        }
    }
}

/* Count at one corner. */
static void count_at_corner(mt_edges *d, int edge, mt_side side)
{
    const mt_edge *const g = &d->edges[edge];
    mt_enclosure *const e = d->c->views[g->view];
    int *const fewest = &d->now[edge];
    int *const most = &d->now[d->n + edge];
    if (*fewest >= *most || !d->fresh[(2 * g->view) + (side == MT_LOW ? 0 : 1)]) {
        return;
    }
    if (side == MT_LOW) {
        const int n = mt_enclosure_most_below(e, g->lambda);
        *most = n < *most ? n : *most;
    } else {
        const int n = mt_enclosure_least_below(e, g->lambda);
        *fewest = n > *fewest ? n : *fewest;
    }
}

int mt_edges_count(mt_edges *d, int edge)
{
    const mt_side asked = d->edges[edge].asked;
    int *const known = &d->now[asked == MT_LOW ? d->n + edge : edge];
    const int before = *known;
    count_at_corner(d, edge, asked);
    if (*known == before) { /* halving no longer helps: the other side tells if all is known */
        count_at_corner(d, edge, asked == MT_LOW ? MT_HIGH : MT_LOW);
    }
    return *known;
}

/* Pairs of modes, by the ranges of both over the box that is set. */

/* Frequencies of the modes of each view over a box; hz NULL: nothing is known of it. */
typedef struct view_ranges {
    double **low; /* [n_views][n_modes] */
    double **high;
    bool *asked; /* [n_views] by a pair */
} view_ranges;

static mt_status ranges_init(view_ranges *r, const mt_certify *c, mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)c->n_views;
    *r = (view_ranges){.low = mt_arena_alloc(mem, n, sizeof *r->low),
                       .high = mt_arena_alloc(mem, n, sizeof *r->high),
                       .asked = mt_arena_alloc(mem, n, sizeof *r->asked)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->n_pairs; i++) {
        r->asked[c->pairs[i].view] = true;
        r->asked[c->pairs[i].of_view] = true;
    }
    for (int v = 0; v < c->n_views; v++) {
        const size_t modes = r->asked[v] ? (size_t)c->views[v]->n_modes : 0;
        r->low[v] = mt_arena_f64(mem, modes, 1);
        r->high[v] = mt_arena_f64(mem, modes, 1);
    }
    return mt_arena_check(mem, err);
}

/* Multiplications of one eigensolve without vectors, over n^3. */
static const double EIGENSOLVE = 3.0;

/* Over the box that is set in all views. Where it fails anything is possible. */
static void ranges_find(view_ranges *r, const mt_certify *c)
{
    for (int v = 0; v < c->n_views; v++) {
        mt_enclosure *const e = c->views[v];
        mt_err own = {.code = MT_OK};
        if (!r->asked[v]) {
            continue;
        }
        const bool known = mt_enclosure_ranges(e, r->low[v], r->high[v], &own) == MT_OK;
        e->operations += 2.0 * EIGENSOLVE * (double)e->n * (double)e->n * (double)e->n;
        for (int k = 0; k < e->n_modes && !known; k++) {
            r->low[v][k] = 0.0;
            r->high[v][k] = HUGE_VAL;
        }
    }
}

static bool pair_exists(const mt_certify *c, const mt_certify_pair *p)
{
    return p->mode <= c->views[p->view]->n_modes && p->of_mode <= c->views[p->of_view]->n_modes;
}

/* *low ... *high: what the pair makes over the box, widened by the rounding of the quotient or
 * the difference. */
static void pair_range(const view_ranges *r, const mt_certify_pair *p, double *low,
                       double *high)
{
    const double lowest = r->low[p->view][p->mode - 1];
    const double highest = r->high[p->view][p->mode - 1];
    const double of_lowest = r->low[p->of_view][p->of_mode - 1];
    const double of_highest = r->high[p->of_view][p->of_mode - 1];
    if (p->difference) {
        *low = lowest - of_highest;
        *high = highest - of_lowest;
    } else {
        *low = lowest > 0.0 ? lowest / of_highest : 0.0;
        *high = of_lowest > 0.0 ? highest / of_lowest : HUGE_VAL;
    }
    *low -= DBL_EPSILON * fabs(*low);
    *high += DBL_EPSILON * fabs(*high);
}

/* True where each pair can be met in the box; all: where all of the box meets it. */
static bool pairs_met(view_ranges *r, const mt_certify *c, bool all)
{
    bool met = true;
    for (int i = 0; i < c->n_pairs && met; i++) {
        met = pair_exists(c, &c->pairs[i]);
    }
    if (met && c->n_pairs > 0) {
        ranges_find(r, c);
    }
    for (int i = 0; i < c->n_pairs && met; i++) {
        const mt_certify_pair *const p = &c->pairs[i];
        double low = 0.0;
        double high = 0.0;
        pair_range(r, p, &low, &high);
        met = all ? !(low < p->at_least) && !(high > p->at_most)
                  : !(high < p->at_least) && !(low > p->at_most); /* NaN limits: always */
    }
    return met;
}

/* The search itself. */

/* What a box costs beside its corners: bounds, the cap, the middle, the list of assignments; in
 * multiplications of a factorisation. */
static const double BOX = 500.0;

typedef struct search {
    const mt_certify *c;
    const int *only; /* NULL: all assignments */
    mt_arena *mem;   /* results */
    mt_err *err;
    int *previous; /* [n_bands] the band before in the same view; -1 */
    /* [n_bands] assignments of the box: j between, not below that of the band before */
    int *least;
    int *most;
    int *tuple; /* [n_bands] work */
    int *single;
    mt_edges edges;
    view_ranges ranges; /* of pairs, work */
    double *node_lo;    /* [program.count] work */
    double *node_hi;
    mt_boxes boxes;
    int n_known;
    int cap_known;
    int *known; /* known, found */
    int cap_order;
    /* [n_known] their places in the list, sorted by memcmp: every box looks for some */
    int *order;
    int cap_found;
    int cap_open;
    double before;  /* operations */
    double decided; /* of the box, in this pass */
    bool told;      /* where the progress is */
    int limit;      /* bisections of a box in this pass */
    mt_certify_search *out;
} search;

static mt_status alloc_search_arrays(search *s, mt_arena *work)
{
    const mt_certify *const c = s->c;
    /* never of length 0: memcpy and memcmp want pointers */
    const size_t bands = (size_t)c->n_bands + 1;
    const size_t nodes = c->program == NULL ? 0 : (size_t)c->program->count;
    s->previous = mt_arena_int(work, bands);
    s->least = mt_arena_int(work, bands);
    s->most = mt_arena_int(work, bands);
    s->tuple = mt_arena_int(work, bands);
    s->single = mt_arena_int(work, bands);
    s->node_lo = mt_arena_f64(work, nodes, 1);
    s->node_hi = mt_arena_f64(work, nodes, 1);
    MT_TRY(mt_arena_check(work, s->err));
    for (int i = 0; i < c->n_bands; i++) {
        s->previous[i] = -1;
        for (int k = 0; k < i; k++) {
            s->previous[i] = c->bands[k].view == c->bands[i].view ? k : s->previous[i];
        }
    }
    MT_TRY(ranges_init(&s->ranges, c, work, s->err));
    MT_TRY(mt_edges_init(&s->edges, c, work, s->err));
    return mt_boxes_init(&s->boxes, c, false, s->edges.n_known, work, s->err);
}

/* Append memory for a placement after *list's count; returns it. */
static int *append(search *s, int **list, int count, int *capacity)
{
    const size_t size = ((size_t)s->c->n_bands + 1) * sizeof(int); /* + 1: never 0 */
    int *const grown = mt_arena_grow(s->mem, *list, count, capacity, size);
    if (grown == NULL) {
        return NULL;
    }
    *list = grown;
    return grown + ((ptrdiff_t)count * s->c->n_bands);
}

static void copy(const search *s, int *to, const int *from)
{
    memcpy(to, from, (size_t)s->c->n_bands * sizeof *to);
}

int mt_certify_index_of(const int *rows, int n, const int *row, int n_bands)
{
    int k = 0;
    while (k < n &&
           memcmp(rows + ((ptrdiff_t)k * n_bands), row, (size_t)n_bands * sizeof *row) != 0) {
        k++;
    }
    return k;
}

/* Number of known placements before the tuple in s->order; *there: the next one is the
 * tuple. */
static int place_of(const search *s, const int *tuple, bool *there)
{
    const size_t n = (size_t)s->c->n_bands;
    int low = 0;
    int high = s->n_known;
    *there = false;
    while (low < high && !*there) {
        const int middle = low + ((high - low) / 2);
        const int *const known = s->known + ((size_t)s->order[middle] * n);
        const int before = memcmp(known, tuple, n * sizeof *tuple);
        *there = before == 0;
        low = before < 0 ? middle + 1 : before == 0 ? middle : low;
        high = before > 0 ? middle : high;
    }
    return low;
}

static bool is_known_tuple(const search *s, const int *tuple)
{
    bool there = false;
    (void)place_of(s, tuple, &there);
    return there;
}

static mt_status note_known(search *s, const int *tuple)
{
    int *const place = append(s, &s->known, s->n_known, &s->cap_known);
    int *const order =
        mt_arena_grow(s->mem, s->order, s->n_known, &s->cap_order, sizeof *order);
    MT_TRY(mt_arena_check(s->mem, s->err));
    bool there = false;
    s->order = order;
    const int at = place_of(s, tuple, &there);
    memmove(order + at + 1, order + at, (size_t)(s->n_known - at) * sizeof *order);
    order[at] = s->n_known;
    copy(s, place, tuple);
    s->n_known++;
    return MT_OK;
}

/* The earlier band whose count band i must equal; -1: none. */
static int same_of(const search *s, int i)
{
    return s->c->same_as != NULL && s->c->same_as[i] < i ? s->c->same_as[i] : -1;
}

/* Set band i to its least value that is consistent with the earlier bands; false: none. */
static bool set_least_count(search *s, int i)
{
    const int same = same_of(s, i);
    const int before = s->previous[i] < 0 ? 0 : s->tuple[s->previous[i]];
    const int low = before > s->least[i] ? before : s->least[i];
    s->tuple[i] = same < 0 ? low : s->tuple[same];
    return s->tuple[i] >= low && s->tuple[i] <= s->most[i];
}

/* The first consistent assignment that keeps the bands before `from`, or follows them in
 * lexicographic order: bands as low as they go. */
static bool first_placement(search *s, int from)
{
    int i = from;
    while (i >= 0 && i < s->c->n_bands) {
        if (set_least_count(s, i)) {
            i++;
            continue;
        }
        do { /* back to the last one that can be raised */
            i--;
        } while (i >= 0 && (same_of(s, i) >= 0 || s->tuple[i] >= s->most[i]));
        if (i >= 0) {
            s->tuple[i]++;
            i++;
        }
    }
    return i >= 0;
}

static bool next(search *s)
{
    int i = s->c->n_bands - 1;
    while (i >= 0 && (same_of(s, i) >= 0 || s->tuple[i] >= s->most[i])) {
        i--;
    }
    if (i < 0) {
        return false;
    }
    s->tuple[i]++;
    return first_placement(s, i + 1);
}

static void raise_to(int *low, int other, bool *changed)
{
    *changed = *changed || other > *low;
    *low = other > *low ? other : *low;
}

static void lower_to(int *high, int other, bool *changed)
{
    *changed = *changed || other < *high;
    *high = other < *high ? other : *high;
}

/* Ranges of the bands that order and equality leave: false where one is empty. */
static bool narrow(search *s)
{
    bool changed = true;
    while (changed) {
        changed = false;
        for (int i = 0; i < s->c->n_bands; i++) {
            const int before = s->previous[i];
            const int same = same_of(s, i);
            if (before >= 0) {
                raise_to(&s->least[i], s->least[before], &changed);
                lower_to(&s->most[before], s->most[i], &changed);
            }
            if (same >= 0) {
                raise_to(&s->least[i], s->least[same], &changed);
                raise_to(&s->least[same], s->least[i], &changed);
                lower_to(&s->most[i], s->most[same], &changed);
                lower_to(&s->most[same], s->most[i], &changed);
            }
            if (s->least[i] > s->most[i]) {
                return false;
            }
        }
    }
    return true;
}

/* Number of unknown placements of the box: 0, 1 (stored in single), or 2 for more. */
static int count_unknown_placements(search *s)
{
    int count = 0;
    for (bool more = first_placement(s, 0); more && count < 2; more = next(s)) {
        if (!is_known_tuple(s, s->tuple)) {
            copy(s, s->single, s->tuple);
            count++;
        }
    }
    return count;
}

/* True where the bounds can be met in the box (all: are met everywhere in it). */
static bool bounds_met(search *s, const double *lo, const double *hi, bool all)
{
    const mt_certify *const c = s->c;
    if (c->n_bounds == 0) {
        return true;
    }
    mt_program_interval(c->program, lo, hi, s->node_lo, s->node_hi);
    for (int i = 0; i < c->n_bounds; i++) {
        const mt_certify_bound *const b = &c->bounds[i];
        const double low = all ? s->node_hi[b->node] : s->node_lo[b->node];
        const double high = all ? s->node_lo[b->node] : s->node_hi[b->node];
        if (low > b->at_most || high < b->at_least) { /* NaN limits: never */
            return false;
        }
    }
    return true;
}

/* True where limit i can be met in the box. */
static bool limit_possible(search *s, int i)
{
    const mt_certify_limit *const l = &s->c->limits[i];
    const int edge = 2 * (s->c->n_bands + i);
    return l->mode <= s->c->views[l->view]->n_modes &&
           (isnan(l->at_most_hz) || mt_edges_count(&s->edges, edge) >= l->mode) &&
           (isnan(l->at_least_hz) || mt_edges_count(&s->edges, edge + 1) < l->mode);
}

/* Assignments of one band in the box, into least, most; false: none. */
static bool band_possible(search *s, int i)
{
    const int *const only = s->only == NULL ? NULL : s->only + i;
    /* that may lie below the band, or on its lower edge */
    s->most[i] = mt_edges_count(&s->edges, 2 * i);
    if (only != NULL && s->most[i] < *only) {
        return false;
    }
    s->least[i] = mt_edges_count(&s->edges, (2 * i) + 1);
    if (only != NULL) {
        const bool possible = s->least[i] <= *only;
        s->least[i] = *only;
        s->most[i] = *only;
        return possible;
    }
    return s->least[i] <= s->most[i];
}

/* True where a design of the box may have an objective below the cap. */
static bool below_cap(const mt_certify *c, const double *lo, const double *hi)
{
    return c->cap == NULL || c->cap->least(c->cap->context, lo, hi) < c->cap->below;
}

/* Number of placements left in the box: unknown ones (0, 1, 2 for more). Where nothing is known
 * of the box, all are left. */
static int count_placements_left(search *s)
{
    const mt_certify *const c = s->c;
    const mt_boxes *const b = &s->boxes;
    bool possible =
        below_cap(c, b->now_lo, b->now_hi) && bounds_met(s, b->now_lo, b->now_hi, false);
    if (!possible) {
        return 0;
    }
    if (!mt_certify_set(c, b->now_lo, b->now_hi)) {
        for (int i = 0; i < c->n_bands; i++) {
            s->least[i] = s->only == NULL ? 0 : s->only[i];
            s->most[i] = s->only == NULL ? c->views[c->bands[i].view]->n_modes : s->only[i];
        }
        return narrow(s) ? count_unknown_placements(s) : 0;
    }
    mt_edges_use(&s->edges, s->boxes.now_known);
    for (int i = 0; i < c->n_limits && possible; i++) {
        possible = limit_possible(s, i);
    }
    for (int i = 0; i < c->n_bands && possible; i++) {
        possible = band_possible(s, i);
    }
    possible = possible && narrow(s) && pairs_met(&s->ranges, c, false);
    return possible ? count_unknown_placements(s) : 0;
}

static bool same_counts(const search *s, const int *tuple)
{
    for (int i = 0; i < s->c->n_bands; i++) {
        const int same = same_of(s, i);
        if (same >= 0 && tuple[i] != tuple[same]) {
            return false;
        }
    }
    return true;
}

/* True where the design that is set has at least so many modes below the edge; or fewer. */
static bool has_below(const search *s, int edge, int modes)
{
    const mt_edge *const g = &s->edges.edges[edge];
    return isnan(g->lambda) || modes < 1 ||
           mt_enclosure_least_below(s->c->views[g->view], g->lambda) >= modes;
}

static bool has_fewer_below(const search *s, int edge, int modes)
{
    const mt_edge *const g = &s->edges.edges[edge];
    return isnan(g->lambda) || mt_enclosure_most_below(s->c->views[g->view], g->lambda) < modes;
}

/* True where the middle of the box, which is set, meets the limits. */
static bool limits_met(const search *s)
{
    bool met = true;
    for (int i = 0; i < s->c->n_limits && met; i++) {
        const int mode = s->c->limits[i].mode;
        const int edge = 2 * (s->c->n_bands + i);
        met = has_below(s, edge, mode) && has_fewer_below(s, edge + 1, mode);
    }
    return met;
}

/* True where the middle of the box meets the bands; its placement goes to `single`. */
static bool bands_met(search *s)
{
    bool met = true;
    for (int i = 0; i < s->c->n_bands && met; i++) {
        const mt_edge *const g = &s->edges.edges[2 * (ptrdiff_t)i];
        if (s->only == NULL) {
            s->single[i] = mt_enclosure_least_below(s->c->views[g->view], g->lambda);
        } else {
            s->single[i] = s->only[i];
            met = has_below(s, 2 * i, s->only[i]);
        }
        met = met && has_fewer_below(s, (2 * i) + 1, s->single[i] + 1);
    }
    return met;
}

/* True where the middle of the box meets everything. Its assignment goes to `single` (in a
 * search for one: it must have that). Limits first: hardly a design is on a target. */
static bool witnessed(search *s)
{
    const mt_boxes *const b = &s->boxes;
    return below_cap(s->c, b->middle, b->middle) && bounds_met(s, b->middle, b->middle, true) &&
           mt_certify_set(s->c, b->middle, b->middle) && limits_met(s) && bands_met(s) &&
           pairs_met(&s->ranges, s->c, true) && same_counts(s, s->single) &&
           !is_known_tuple(s, s->single);
}

static mt_status note_found(search *s)
{
    mt_certify_search *const out = s->out;
    const size_t n = (size_t)s->c->n;
    int capacity = s->cap_found;
    int *const place = append(s, &out->found, out->n_found, &s->cap_found);
    double *const at =
        mt_arena_grow(s->mem, out->at, out->n_found, &capacity, (n + 1) * sizeof *at);
    MT_TRY(note_known(s, s->single));
    copy(s, place, s->single);
    out->at = at;
    if (n > 0) {
        memcpy(at + ((size_t)out->n_found * n), s->boxes.middle, n * sizeof *at);
    }
    out->n_found++;
    return MT_OK;
}

/* Record all unknown placements of the box as open. */
static mt_status note_open(search *s)
{
    mt_certify_search *const out = s->out;
    out->proven = false;
    for (bool more = first_placement(s, 0); more && !out->more; more = next(s)) {
        if (is_known_tuple(s, s->tuple) || mt_certify_index_of(out->open, out->n_open, s->tuple,
                                                               s->c->n_bands) < out->n_open) {
            continue;
        }
        out->more = out->n_open == MT_CERTIFY_OPEN_MOST; /* there is one more */
        if (out->more) {
            break;
        }
        int *const place = append(s, &out->open, out->n_open, &s->cap_open);
        MT_TRY(mt_arena_check(s->mem, s->err));
        copy(s, place, s->tuple);
        out->n_open++;
    }
    return MT_OK;
}

/* Remove open placements that were found in a later box. */
static void drop_found(search *s)
{
    mt_certify_search *const out = s->out;
    const ptrdiff_t n = s->c->n_bands;
    int kept = 0;
    for (int i = 0; i < out->n_open; i++) {
        if (!is_known_tuple(s, out->open + (i * n))) {
            memmove(out->open + (kept * n), out->open + (i * n), (size_t)n * sizeof(int));
            kept++;
        }
    }
    out->n_open = kept;
    out->proven = kept == 0 && !out->more;
    out->undecided = out->proven ? 0.0 : out->undecided;
}

/* Bisections between one pass and the next: 64 times as many boxes at most. */
enum { DEEPER = 6 };

/* Operations so far, of all questions to these enclosures. */
static double operations(const search *s)
{
    double sum = BOX * (double)s->out->boxes;
    for (int v = 0; v < s->c->n_views; v++) {
        sum += s->c->views[v]->operations;
    }
    return sum;
}

static bool spent(const search *s)
{
    const double most = s->c->max_work > 0.0 ? s->c->max_work : MT_CERTIFY_WORK;
    return s->out->stopped || operations(s) - s->before >= most;
}

/* Mark a box of this number of bisections as decided, and report the decided share of all
 * designs. */
static void mark_box_decided(search *s, int depth)
{
    s->decided += ldexp(1.0, -depth);
    mt_progress_share(s->c->progress, s->told, s->decided);
}

/* One box: settle it, or halve it, or leave it open. *deeper: a deeper pass may settle it. */
static mt_status decide_box(search *s, bool *deeper)
{
    mt_certify_search *const out = s->out;
    out->stopped = out->stopped || mt_interrupted(s->c->interrupt);
    const int left = count_placements_left(s);
    int depth = 0;
    for (int i = 0; i < s->boxes.n; i++) {
        depth += s->boxes.now_depth[i];
    }
    out->boxes++;
    mt_progress_boxed(s->c->progress);
    if (left == 0) {
        mark_box_decided(s, depth);
        return MT_OK;
    }
    const bool cut = depth >= s->limit;
    if ((left == 1 || cut) && witnessed(s)) {
        MT_TRY(note_found(s));
        if (count_unknown_placements(s) == 0) {
            mark_box_decided(s, depth);
            return MT_OK;
        }
    }
    if (!spent(s) && !cut && mt_boxes_split(&s->boxes)) {
        return MT_OK;
    }
    *deeper = *deeper || cut;
    out->undecided += ldexp(1.0, -depth);
    return note_open(s);
}

/* True where the search can end: any placement was requested, or a given one, and is found. */
static bool satisfied(const search *s)
{
    return (s->only != NULL || s->c->any) && s->out->n_found > 0;
}

static mt_status deepen_until_decided(search *s)
{
    mt_certify_search *const out = s->out;
    bool deeper = true;
    for (s->limit = DEEPER; deeper && !satisfied(s); s->limit += DEEPER) {
        deeper = false;
        out->proven = true;
        out->n_open = 0;
        out->more = false;
        out->undecided = 0.0;
        s->decided = 0.0;
        mt_boxes_start(&s->boxes, s->c->lower, s->c->upper, s->edges.root);
        while (mt_boxes_pop(&s->boxes) && !satisfied(s)) {
            MT_TRY(decide_box(s, &deeper));
        }
        if (!out->proven) {
            drop_found(s);
        }
        deeper = deeper && !out->proven && !spent(s);
    }
    out->proven = out->proven && !(s->c->any && out->n_found > 0);
    return MT_OK;
}

static mt_status search_all(const mt_certify *c, int n_known, const int *known, const int *only,
                            mt_arena *mem, mt_arena *work, mt_certify_search *out, mt_err *err)
{
    search s = {.c = c, .only = only, .mem = mem, .err = err, .out = out};
    *out = (mt_certify_search){0};
    MT_TRY(alloc_search_arrays(&s, work));
    for (int i = 0; i < n_known; i++) {
        MT_TRY(note_known(&s, known + ((ptrdiff_t)i * c->n_bands)));
    }
    s.before = operations(&s);
    s.told = mt_progress_begin(c->progress, "designs decided", 0);
    const mt_status rc = deepen_until_decided(&s);
    out->work = operations(&s) - s.before;
    mt_progress_end(c->progress, s.told);
    return rc;
}

mt_status mt_certify_assignments(const mt_certify *c, int n_known, const int *known,
                                 mt_arena *mem, mt_certify_search *out, mt_err *err)
{
    mt_arena work = {0};
    mt_status rc = mt_arena_init(&work, 0, err);
    if (rc == MT_OK) {
        rc = search_all(c, n_known, known, NULL, mem, &work, out, err);
    }
    mt_arena_free(&work);
    return rc;
}

mt_status mt_certify_possible(const mt_certify *c, const int *assignment, mt_arena *scratch,
                              mt_verdict *verdict, double *at, long *boxes, mt_err *err)
{
    static const int none = 0; /* with no bands the assignment is empty */
    mt_certify_search out;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = search_all(c, 0, NULL, assignment == NULL ? &none : assignment,
                                    scratch, scratch, &out, err);
    *verdict = MT_VERDICT_OPEN;
    if (rc == MT_OK) {
        *verdict = out.n_found > 0 ? MT_VERDICT_POSSIBLE
                                   : (out.proven ? MT_VERDICT_IMPOSSIBLE : MT_VERDICT_OPEN);
        if (at != NULL && out.n_found > 0 && c->n > 0) {
            memcpy(at, out.at, (size_t)c->n * sizeof *at);
        }
        if (boxes != NULL) {
            *boxes = out.boxes;
        }
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* What one mode can reach in a box. */

/* Frequencies of the modes of a view over the box, in scratch; NULL where nothing is known. */
static mt_status ranges_of(const mt_certify *c, int view, mt_arena *scratch, double **low,
                           double **high, mt_err *err)
{
    mt_enclosure *const e = c->views[view];
    *low = NULL;
    *high = NULL;
    if (!mt_enclosure_set(e, c->lower, c->upper)) {
        return MT_OK;
    }
    *low = mt_arena_f64(scratch, (size_t)e->n_modes, 1);
    *high = mt_arena_f64(scratch, (size_t)e->n_modes, 1);
    MT_TRY(mt_arena_check(scratch, err));
    return mt_enclosure_ranges(e, *low, *high, err);
}

static bool exists(const mt_certify *c, const mt_certify_limit *l)
{
    return l->mode >= 1 && l->mode <= c->views[l->view]->n_modes;
}

static bool is_missed(const mt_certify_limit *l, double low_hz, double high_hz)
{
    return high_hz < l->at_least_hz * (1.0 - l->tolerance) ||
           low_hz > l->at_most_hz * (1.0 + l->tolerance);
}

static mt_status find_reachable_range(const mt_certify *c, int limit, mt_arena *scratch,
                                      mt_certify_reach *out, mt_err *err)
{
    const mt_certify_limit *const l = &c->limits[limit];
    mt_certify one = *c;
    *out = (mt_certify_reach){MT_VERDICT_IMPOSSIBLE, nan(""), nan(""), 0};
    double *low = NULL;
    double *high = NULL;
    if (!exists(c, l)) {
        return MT_OK;
    }
    MT_TRY(ranges_of(c, l->view, scratch, &low, &high, err));
    if (low != NULL) {
        out->low_hz = low[l->mode - 1];
        out->high_hz = high[l->mode - 1];
    }
    if (is_missed(l, out->low_hz, out->high_hz)) {
        return MT_OK;
    }
    one.n_bands = 0;
    one.n_bounds = 0;
    one.n_pairs = 0;
    one.limits = l;
    one.n_limits = 1;
    return mt_certify_possible(&one, NULL, scratch, &out->verdict, NULL, &out->boxes, err);
}

mt_status mt_certify_reach_of(const mt_certify *c, int limit, mt_arena *scratch,
                              mt_certify_reach *out, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = find_reachable_range(c, limit, scratch, out, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* Limits of one view. */
static mt_status any_missed(const mt_certify *c, int view, mt_arena *scratch, bool *out,
                            mt_err *err)
{
    double *low = NULL;
    double *high = NULL;
    bool known = false;
    for (int i = 0; i < c->n_limits && !*out; i++) {
        const mt_certify_limit *const l = &c->limits[i];
        if (l->view != view) {
            continue;
        }
        if (!known) {
            MT_TRY(ranges_of(c, view, scratch, &low, &high, err));
            known = true;
        }
        *out =
            !exists(c, l) || (low != NULL && is_missed(l, low[l->mode - 1], high[l->mode - 1]));
    }
    return MT_OK;
}

/* Pairs over the whole box. */
static mt_status any_pair_missed(const mt_certify *c, mt_arena *scratch, bool *out, mt_err *err)
{
    view_ranges r;
    if (c->n_pairs == 0) {
        return MT_OK;
    }
    MT_TRY(ranges_init(&r, c, scratch, err));
    *out = mt_certify_set(c, c->lower, c->upper) && !pairs_met(&r, c, false);
    return MT_OK;
}

mt_status mt_certify_out_of_reach(const mt_certify *c, mt_arena *scratch, bool *out,
                                  mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    mt_status rc = MT_OK;
    *out = false;
    rc = any_pair_missed(c, scratch, out, err);
    for (int v = 0; v < c->n_views && rc == MT_OK && !*out; v++) {
        rc = any_missed(c, v, scratch, out, err);
    }
    mt_arena_rewind(scratch, mark);
    return rc;
}
