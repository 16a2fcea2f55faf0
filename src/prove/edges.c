/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "prove/edges.h"

#include "prove/box.h"

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
