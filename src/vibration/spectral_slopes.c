/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vibration/spectral_priv.h"

#include <math.h>

/* A node of the integral that is d RMS. */
typedef struct node {
    mt_near w;
    double complex weight;
} node;

typedef struct nodes {
    const mt_spectral *r;
    const mt_psd *input;
    double rms;
    int segment;
    mt_spectral_segment of;
    mt_panels walk;
    mt_panel on;
    int i; /* the next node of the panel */
    bool walking;
} nodes;

/* False where there is no derivative. */
static bool begin_nodes(nodes *n, const mt_spectral *r, const mt_psd *input)
{
    const mt_spectral_answer a = mt_spectral_rms(r, input, MT_SPECTRAL_BEST);
    *n = (nodes){.r = r, .input = input, .rms = a.rms, .segment = -1, .i = MT_GAUSS_NODES};
    return a.end == MT_FORCED_FINITE && a.rms > 0.0;
}

static bool next_panel(nodes *n)
{
    while (!n->walking || !mt_panels_next(&n->walk, &n->on)) {
        if (++n->segment + 1 >= n->input->n) {
            return false;
        }
        n->of = mt_spectral_segment_of(n->input, n->segment);
        n->walking = n->of.upper > n->of.lower;
        if (n->walking) {
            mt_panels_begin(&n->walk, &n->r->h, n->of.lower, n->of.upper, n->of.exponent);
        }
    }
    n->i = 0;
    return true;
}

static bool next(nodes *n, node *out)
{
    if (n->i >= MT_GAUSS_NODES && !next_panel(n)) {
        return false;
    }
    const double half = 0.5 * (n->on.b - n->on.a);
    const mt_near w = {n->on.anchor, n->on.a + (half * (1.0 + n->r->gauss.node[n->i]))};
    const double g = n->input->level[n->segment] * mt_spectral_power(&n->of, w);
    *out = (node){.w = w,
                  .weight = (half * n->r->gauss.weight[n->i] * g / (MT_TWO_PI * n->rms)) *
                            conj(mt_frf_value(&n->r->h, w, NULL))};
    n->i++;
    return true;
}

mt_status mt_spectral_slope_nodes(const mt_spectral *r, const mt_psd *input, mt_arena *mem,
                                  mt_spectral_nodes *out, mt_err *err)
{
    nodes walk;
    node at;
    int room = 0;
    *out = (mt_spectral_nodes){.n = 0};
    if (!begin_nodes(&walk, r, input)) {
        return MT_OK;
    }
    const nodes again = walk;
    while (next(&walk, &at)) {
        room++;
    }
    out->omega = mt_arena_f64(mem, (size_t)room, 1);
    out->weight = mt_arena_alloc(mem, (size_t)room, sizeof *out->weight);
    MT_TRY(mt_arena_check(mem, err));
    walk = again;
    while (next(&walk, &at)) {
        out->omega[out->n] = at.w.anchor + at.w.t;
        out->weight[out->n++] = at.weight;
    }
    return MT_OK;
}

void mt_spectral_slopes(const mt_spectral *r, const mt_psd *input, double complex *by_s,
                        double complex *by_residue, double complex *by_d)
{
    const mt_frf *const h = &r->h;
    nodes walk;
    node at;
    for (int k = 0; k < r->sum->n; k++) {
        by_s[k] = 0.0;
        by_residue[k] = 0.0;
    }
    for (int j = 0; j < MT_COUNT(h->c); j++) {
        by_d[j] = 0.0;
    }
    if (!begin_nodes(&walk, r, input)) {
        return;
    }
    while (next(&walk, &at)) {
        mt_frf_pull(h, at.w, at.weight, by_s, by_residue, by_d);
    }
}
