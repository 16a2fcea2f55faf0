/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensitivities of whole mechanisms against slopes: frequencies, sensor shapes and MAC, through
 * expressions, geometry, closed loops, gravity and driven positions. */
#include <float.h>

#include "mechanics/mech.h"
#include "support/mt_slope.h"

enum { SENSORS = 32, MODES = 4, KNOWN = 16 };

/* An evaluation repeats to n eps of the largest eigenvalue; equilibria are found to 1e-13. */
static const double NOISE = 3e-13;
static const double STEP = 3e-3; /* of each input's value; 3e-3 itself where that is zero */

/* Step for planted errors, of STEP. */
static const double PLANTED = 0.1;

/* What one design has of its first modes: slopes of many quantities ask for the same few. */
typedef struct solved {
    double x[MECH_INPUTS];
    double lambda[MODES];         /* NaN: there is no such mode */
    double shape[MODES][SENSORS]; /* at the sensors */
} solved;

typedef struct point {
    mech *s;
    solved *known; /* [KNOWN] designs */
    int *n_known;
    int mode;    /* vibration mode, from 1 */
    int channel; /* -1: ln lambda, else a shape's entry, or MAC where ns > 0 */
    int ns;
    const double *original; /* [ns] shape */
    double lambda;          /* at the original design */
    double size; /* largest entry of the shape: rounding of an entry is relative to it */
} point;

static bool solve(mech *s, const double *x, bool gradient)
{
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = gradient;
    opt.check = false;
    return mt_analysis_solve(s->a, x, &opt, &s->err) == MT_OK;
}

static int channels(const mech *s, int list[SENSORS])
{
    const int n = s->a->sys->n_channels < SENSORS ? s->a->sys->n_channels : SENSORS;
    for (int i = 0; i < n; i++) {
        list[i] = i;
    }
    return n;
}

/* A design as it is known, or solved now. NULL: it cannot be. */
static const solved *at_design(const point *p, const double *x)
{
    int list[SENSORS];
    for (int i = 0; i < *p->n_known; i++) {
        int same = 0;
        while (same < p->s->n && p->known[i].x[same] == x[same]) {
            same++;
        }
        if (same == p->s->n) {
            return &p->known[i];
        }
    }
    if (*p->n_known == KNOWN || !solve(p->s, x, false)) {
        return NULL;
    }
    solved *const new = &p->known[*p->n_known];
    const int ns = channels(p->s, list);
    memcpy(new->x, x, sizeof new->x);
    for (int k = 0; k < MODES; k++) {
        const int pos = mt_modal_flexible(&p->s->a->modes, k + 1);
        new->lambda[k] = pos < 0 ? nan("") : p->s->a->modes.lambda[pos];
        if (pos >= 0 && mt_analysis_shape(p->s->a, pos, ns, list, new->shape[k], NULL,
                                          &p->s->err) != MT_OK) {
            return NULL;
        }
    }
    ++*p->n_known;
    return new;
}

static double quantity(const void *ctx, int n, const double *x)
{
    const point *const p = ctx;
    const solved *const here = at_design(p, x);
    (void)n;
    if (here == NULL) {
        return nan("");
    }
    const double *const shape = here->shape[p->mode - 1];
    if (p->ns == 0) {
        return 1.0 + log(here->lambda[p->mode - 1] / p->lambda);
    }
    if (p->channel < 0) {
        double fixed[SENSORS];
        double mac = 0.0;
        for (int i = 0; i < p->ns; i++) {
            fixed[i] = i + 1.0; /* some reference shape */
        }
        mt_mac_matrix(p->ns, 1, shape, 1, fixed, &mac);
        return mac;
    }
    double along = 0.0; /* the sign of the shape held to the original */
    for (int i = 0; i < p->ns; i++) {
        along += shape[i] * p->original[i];
    }
    return 2.0 * p->size + (along < 0.0 ? -shape[p->channel] : shape[p->channel]);
}

/* Distance of a mode to its nearest neighbour, relative. */
static double separation(const mt_modes *m, int pos)
{
    double gap = 1.0;
    for (int i = 0; i < m->count; i++) {
        if (i != pos) {
            gap = fmin(gap, fabs(m->lambda[i] / m->lambda[pos] - 1.0));
        }
    }
    return gap;
}

/* Everything of one mode against slopes with respect to input i; p: with what is known of the
 * mechanism. */
static void check_mode(mt_test *t, point p, int mode, int i)
{
    mech *const s = p.s;
    int list[SENSORS];
    double shape[SENSORS] = {0.0};
    double ds[SENSORS * MECH_INPUTS] = {0.0};
    double dlambda[MECH_INPUTS];
    double x[MECH_INPUTS];
    double fixed[SENSORS];
    p.mode = mode;
    memcpy(x, s->at, sizeof x);
    if (!CHECK(t, solve(s, x, true))) {
        (void)fprintf(stderr, "%s\n", s->err.text);
        return;
    }
    const int pos = mt_modal_flexible(&s->a->modes, mode);
    if (!CHECK(t, pos >= 0)) {
        return;
    }
    bool repeated = true;
    CHECK(t, mt_analysis_dlambda(s->a, pos, dlambda, &repeated, &s->err) == MT_OK);
    CHECK(t, !repeated);
    const int ns = channels(s, list);
    CHECK(t, mt_analysis_shape(s->a, pos, ns, list, shape, ds, &s->err) == MT_OK);
    const double lambda = s->a->modes.lambda[pos];
    const double top = s->a->modes.lambda[s->a->modes.count - 1];
    const double noise = fmax(NOISE, DBL_EPSILON * top / lambda);
    const double shape_noise = 10.0 * noise / separation(&s->a->modes, pos);
    p.lambda = lambda;
    const double step = STEP * (x[i] != 0.0 ? fabs(x[i]) : 1.0);
    CHECK(t, mt_slope_agrees(quantity, &p, s->n, x, i, dlambda[i] / lambda, step, noise));
    /* planted: 1e-6 too much, at a step where truncation and rounding are both smaller */
    const double wrong = 1e-6 * (STEP / step + fabs(dlambda[i] / lambda));
    CHECK(t, !mt_slope_agrees(quantity, &p, s->n, x, i, dlambda[i] / lambda + wrong,
                              PLANTED * step, NOISE));
    p.original = shape;
    p.ns = ns;
    p.size = 1.0;
    for (int k = 0; k < ns; k++) {
        fixed[k] = k + 1.0;
        p.size = fmax(p.size, fabs(shape[k]));
    }
    for (p.channel = 0; p.channel < ns; p.channel++) {
        CHECK(t, mt_slope_agrees(quantity, &p, s->n, x, i, ds[p.channel + (i * ns)], step,
                                 shape_noise));
    }
    if (ns > 0) {
        p.channel = -1;
        CHECK(t, mt_slope_agrees(quantity, &p, s->n, x, i,
                                 mt_mac_derivative(ns, shape, ds + (ptrdiff_t)i * ns, fixed),
                                 step, shape_noise));
    }
}

static const struct {
    const char *file;
    const char *configuration;
    const char *inputs;
    int modes;
} CASES[] = {
    {"pendulum", "hanging", "g m L w", 1},
    {"double_pendulum", "distances", "g m1 m2 l1 l2", 2},
    {"double_pendulum", "rods", "g m1 m2 l1 l2", 2},
    {"taut_string", "preload", "T l m k", 2},
    {"taut_string", "free_length", "T l m k", 2},
    {"driven_rod", "sprung", "m L J_d k_d k phi", 2},
    {"driven_rod", "locked", "m L m_d J_d k_d k angle", 1},
    {"driven_rod", "trimmed", "m L m_d J_d k_d k angle", 2},
    {"four_bar", "still", "a k m_c alpha dx", 1},
    {"four_bar", "loaded", "a k m_c alpha g dx", 1},
    {"four_bar", "trimmed", "a k m_c alpha g turn", 1},
    {"massless", "sprung", "m k1 k2", 1},
    {"space_body", "ball", "kr", 3},
    {"space_four_bar", "loaded", "a k", 1},
    {"space_four_bar", "trimmed", "a k", 1},
    {"space_stick", "plain", "k tilt l m kb", 4},
    {"space_stick", "weightless", "k tilt l m kb", 4},
    {"space_stick", "geared", "k tilt l m kb ratio", 4},
    {"loaded_frame", "loaded", "E h x P g k", 3},
    {"loaded_frame", "weightless", "E h k", 2},
    {"space_frame", "loaded", "h x E mass", 3},
    {"space_shear", "loaded", "h x E", 2},
    {"space_shear", "weightless", "h x E", 2},
    {"space_frame", "weightless", "h x E mass", 3},
    {"couplings", "planet", "g N r k l m", 3},
    {"couplings", "coiled", "N r k l", 4},
    {"couplings", "driven", "g N r k l m to", 3},
    {"space_couplings", "loaded", "tilt k m r h", 4},
    {"space_couplings", "weightless", "tilt r h", 4},
    {"loads", "dead", "g F M T P h k l", 3},
    {"loads", "trimmed", "F M T P h to", 3},
    {"space_loads", "loaded", "F T P a k", 4},
    {"rods", "bodies", "g m h x k P", 3},
    {"rods", "distances", "g m h x k P", 3},
};

static void derivatives__agree_with_slopes_in_every_mechanism(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(CASES); i++) {
        mech s;
        mt_test_row(t, "%s, %s", CASES[i].file, CASES[i].configuration);
        if (mech_must(t, mech_load(t, CASES[i].file), CASES[i].configuration, CASES[i].inputs,
                      &s)) {
            for (int p = 0; p < s.n; p++) {
                solved known[KNOWN];
                int n_known = 0;
                const point start = {.s = &s, .known = known, .n_known = &n_known};
                for (int mode = 1; mode <= CASES[i].modes; mode++) {
                    const int parameter = s.a->sys->inputs[p];
                    mt_test_row(t, "%s, %s, mode %d, %s", CASES[i].file, CASES[i].configuration,
                                mode, s.model->parameters[parameter].name.s);
                    check_mode(t, start, mode, p);
                }
            }
        }
        mech_free(&s);
    }
}

MT_TEST_MAIN(MT_TEST(derivatives__agree_with_slopes_in_every_mechanism))
