/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses of models between ports by name; derivatives against slopes. */
#ifndef RESPONSE_FIXTURE_H
#define RESPONSE_FIXTURE_H

#include <float.h>

#include "mechanics/mech.h"
#include "response/forced_fixture.h"
#include "response/response.h"
#include "response/slopes.h"
#include "response/slopes_forms.h"
#include "support/mt_slope.h"

typedef struct asked {
    mech m;
    mt_response r;
    mt_sample s;
    mt_status rc;
} asked;

static inline mt_analysis_options all_modes(bool gradient)
{
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = gradient;
    return opt;
}

static inline int split_words(const char *text, char *room, size_t size, const char **words,
                              int most)
{
    int n = 0;
    (void)snprintf(room, size, "%s", text);
    for (char *p = strtok(room, " "); p != NULL && n < most; p = strtok(NULL, " ")) {
        words[n++] = p;
    }
    return n;
}

/* Names separated by blanks; so many modes (0: all). */
static inline bool ask_modes(mt_test *t, asked *q, const char *inputs, const char *outputs,
                             int modes)
{
    char room[2][512];
    const char *in[8];
    const char *out[16];
    const mt_response_request request = {
        .n_in = split_words(inputs, room[0], sizeof room[0], in, 8),
        .inputs = in,
        .n_out = split_words(outputs, room[1], sizeof room[1], out, 16),
        .outputs = out,
        .modes = modes};
    mt_err err = {.text = ""};
    q->rc = mt_response_open(q->m.a, &request, &q->r, &err);
    if (!CHECK(t, q->rc == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
        return false;
    }
    const size_t pairs = (size_t)q->r.ports.n_in * (size_t)q->r.ports.n_out;
    q->s = (mt_sample){.h = mt_arena_alloc(&q->r.mem, pairs, sizeof *q->s.h),
                       .error = mt_arena_f64(&q->r.mem, pairs, 1)};
    return true;
}

static inline bool ask(mt_test *t, asked *q, const char *inputs, const char *outputs)
{
    return ask_modes(t, q, inputs, outputs, 0);
}

/* By modes; the direct way is checked against it. */
static inline void response_at(mt_test *t, asked *q, double w)
{
    const size_t pairs = (size_t)q->r.ports.n_in * (size_t)q->r.ports.n_out;
    mt_err err;
    mt_sample other = {.h = mt_arena_alloc(&q->r.mem, pairs, sizeof *other.h),
                       .error = mt_arena_f64(&q->r.mem, pairs, 1)};
    CHECK(t, mt_transfer_at(&q->r.direct, w, &other, &q->r.mem, &err) == MT_OK);
    CHECK(t, mt_transfer_at(&q->r.basis.t, w, &q->s, &q->r.mem, &err) == MT_OK);
    for (size_t i = 0; i < pairs; i++) {
        CHECK(t, cabs(q->s.h[i] - other.h[i]) <= q->s.error[i] + other.error[i]);
        CHECK_NEAR_ABS(t, cabs(q->s.h[i] - other.h[i]), 0.0, 1e-7 * cabs(other.h[i]) + 1e-13);
    }
}

static inline void done(asked *q)
{
    mt_response_free(&q->r);
    mech_free(&q->m);
}

enum { MOST_PAIRS = 8 * 16, SLOPE_POINTS = 5 }; /* a slope is judged by so many values */

/* All responses at w at the designs of one parameter's slopes, which all pairs have in common.
 */
typedef struct slope_values {
    mt_analysis *a;
    mt_response_request request;
    double w;
    int n;
    double x[SLOPE_POINTS][MECH_INPUTS];
    double complex h[SLOPE_POINTS][MOST_PAIRS];
} slope_values;

static inline bool fill_values(slope_values *v, const double *x, const mt_sample *sample)
{
    const mt_analysis_options opt = all_modes(false);
    mt_response r = {.a = NULL};
    mt_err err;
    const bool ok = mt_analysis_solve(v->a, x, &opt, &err) == MT_OK &&
                    mt_response_open(v->a, &v->request, &r, &err) == MT_OK &&
                    mt_transfer_at(&r.direct, v->w, sample, &r.mem, &err) == MT_OK;
    mt_response_free(&r);
    return ok;
}

/* At x[n]; NULL: no answer, or more designs than a slope takes. */
static inline const double complex *values_at(slope_values *v, int n, const double *x)
{
    const size_t size = (size_t)n * sizeof *x;
    for (int i = 0; i < v->n; i++) {
        if (memcmp(v->x[i], x, size) == 0) {
            return v->h[i];
        }
    }
    if (v->n == SLOPE_POINTS || !fill_values(v, x, &(mt_sample){.h = v->h[v->n]})) {
        return NULL;
    }
    memcpy(v->x[v->n], x, size);
    return v->h[v->n++];
}

/* One part of one response as a function of the inputs of the analysis. */
typedef struct slope_of {
    slope_values *values;
    int pair;
    bool imaginary;
} slope_of;

static inline double value_at(const void *ctx, int n, const double *x)
{
    const slope_of *const s = ctx;
    const double complex *const h = values_at(s->values, n, x);
    if (h == NULL) {
        return nan("");
    }
    return s->imaginary ? cimag(h[s->pair]) : creal(h[s->pair]);
}

/* What is asked of a model (a text, or a file of tests/models). */
typedef struct sloped {
    const char *text;
    const char *file;
    const char *configuration;
    const char *parameters;
    const char *inputs;
    const char *outputs;
} sloped;

/* Every derivative at w, both parts. */
static inline void check_slopes(mt_test *t, const sloped *s, asked *q, double w)
{
    char room[2][512];
    const char *in[8];
    const char *out[16];
    double complex dh[MOST_PAIRS * MECH_INPUTS];
    mt_err err = {.text = ""};
    const int n_in = split_words(s->inputs, room[0], sizeof room[0], in, 8);
    const int n_out = split_words(s->outputs, room[1], sizeof room[1], out, 16);
    const mt_analysis_options opt = all_modes(true);
    CHECK(t, mt_analysis_solve(q->m.a, q->m.at, &opt, &err) == MT_OK);
    if (!ask(t, q, s->inputs, s->outputs) ||
        !CHECK(t, mt_response_slopes_at(&q->r, w, dh, &err) == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
        return;
    }
    mt_response_free(&q->r);
    slope_values values = {
        .a = q->m.a,
        .request = {.n_in = n_in, .inputs = in, .n_out = n_out, .outputs = out},
        .w = w};
    for (int k = 0; k < 2 * n_in * n_out * q->m.n; k++) {
        const int p = k / (2 * n_in * n_out);
        const int pair = k / 2 % (n_in * n_out);
        const bool imaginary = k % 2 == 1;
        const slope_of f = {&values, pair, imaginary};
        const double size = fabs(q->m.at[p]) > 0.0 ? fabs(q->m.at[p]) : 1.0;
        values.n = k % (2 * n_in * n_out) == 0 ? 0 : values.n;
        mt_test_row(t, "%s, w = %g, input %s, output %s, parameter %d, part %d",
                    s->configuration, w, in[pair / n_out], out[pair % n_out], p,
                    (int)imaginary);
        CHECK(t, mt_slope_agrees(value_at, &f, q->m.n, q->m.at, p,
                                 imaginary ? cimag(dh[k / 2]) : creal(dh[k / 2]), 2e-4 * size,
                                 1e-11));
    }
}

/* Weights that turn. */
static inline double complex weight_of(int i)
{
    return (1.0 + (0.3 * i)) * cexp(mt_complex(0.0, 0.7 + (1.9 * i)));
}

enum { MOST_SLOPES = MOST_PAIRS * MECH_INPUTS, MOST_WEIGHTED = 4096 };

/* want and size [pairs x inputs]: sum of weight dH over the slopes at each frequency, and of
 * its magnitude. */
static inline void add_up_slopes(mt_test *t, asked *q, const double *ws, int n_w, double *want,
                                 double *size)
{
    const int pairs = q->r.ports.n_in * q->r.ports.n_out;
    double complex dh[MOST_SLOPES];
    mt_err err = {.text = ""};
    for (int i = 0; i < n_w; i++) {
        CHECK(t, mt_response_slopes_at(&q->r, ws[i], dh, &err) == MT_OK);
        for (int at = 0; at < pairs * q->m.n; at++) {
            const double complex part = weight_of(i) * dh[at];
            want[at] += creal(part);
            size[at] += cabs(part);
        }
    }
}

/* terms [pairs]: sum of |weight| |y|^T |K| |x|: a derivative by a parameter of size 1 is a sum
 * of such terms, and has their rounding however small it is. */
static inline void add_up_terms(mt_test *t, asked *q, const double *ws, int n_w, double *terms)
{
    const int n = q->r.f.n;
    const int n_out = q->r.ports.n_out;
    double complex *const x = mt_arena_alloc(&q->r.mem, (size_t)n * 8, sizeof *x);
    double complex *const y = mt_arena_alloc(&q->r.mem, (size_t)n * 16, sizeof *y);
    mt_err err = {.text = ""};
    bool singular = false;
    for (int i = 0; i < n_w; i++) {
        CHECK(t, mt_basis_solve(&q->r.basis, ws[i], x, y, &singular, &q->r.mem, &err) == MT_OK);
        for (int at = 0; at < q->r.ports.n_in * n_out * n * n; at++) {
            const int pair = at / (n * n);
            const int a = at % n;
            const int b = at / n % n;
            terms[pair] += cabs(weight_of(i)) * fabs(q->r.f.k[a + (b * n)]) *
                           cabs(y[a + (pair % n_out * n)]) * cabs(x[b + (pair / n_out * n)]);
        }
    }
}

/* The forms of one pair: values, and every derivative at every frequency, beside those of that
 * frequency alone; one that is 0 by itself is rounding beside the others. `want`: the latter,
 * pairs x inputs x n_w. */
static inline void check_forms(mt_test *t, asked *q, const mt_slope_problem *p, int pair,
                               const double *ws, int n_w, const double complex *want)
{
    const int pairs = q->r.ports.n_in * q->r.ports.n_out;
    const int inputs = q->m.n;
    const mt_arena_mark mark = mt_arena_get_mark(&q->r.mem);
    mt_slope_forms f;
    mt_err err = {.text = ""};
    const size_t size = (size_t)inputs * (size_t)n_w;
    double complex *const dh = mt_arena_alloc(&q->r.mem, size, sizeof *dh);
    double complex *const h = mt_arena_alloc(&q->r.mem, (size_t)n_w, sizeof *h);
    double complex *const all = mt_arena_alloc(&q->r.mem, (size_t)pairs, sizeof *all);
    const int n_out = q->r.ports.n_out;
    if (!CHECK(t, mt_slope_forms_make(p, pair % n_out, pair / n_out, 1 << 20, &q->r.mem, &f,
                                      &err) == MT_OK) ||
        !CHECK(t, mt_slope_forms_at(&f, n_w, ws, h, dh, &q->r.mem, &err) == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
        return;
    }
    for (int i = 0; i < n_w; i++) {
        const double complex *const own = want + ((ptrdiff_t)i * pairs * inputs);
        double most = 0.0;
        double terms[MOST_PAIRS] = {0.0};
        add_up_terms(t, q, &ws[i], 1, terms);
        CHECK(t, mt_transfer_at(&p->basis->t, ws[i], &(mt_sample){.h = all}, &q->r.mem, &err) ==
                     MT_OK);
        mt_test_row(t, "forms, pair %d, w = %g", pair, ws[i]);
        CHECK_NEAR_ABS(t, cabs(h[i] - all[pair]), 0.0, 1e-13 * cabs(all[pair]));
        for (int at = 0; at < pairs * inputs; at++) {
            most = fmax(most, cabs(own[at]));
        }
        for (int k = 0; k < inputs; k++) {
            mt_test_row(t, "forms, pair %d, w = %g, parameter %d", pair, ws[i], k);
            const double unit = fabs(q->m.at[k]) > 0.0 ? fabs(q->m.at[k]) : 1.0;
            CHECK_NEAR_ABS(t, cabs(dh[k + ((ptrdiff_t)i * inputs)] - own[pair + (k * pairs)]),
                           0.0,
                           1e-11 * cabs(own[pair + (k * pairs)]) + 1e-13 * most +
                               16.0 * DBL_EPSILON * terms[pair] / unit);
        }
    }
    mt_arena_rewind(&q->r.mem, mark);
}

/* Of all pairs, at some of the frequencies. */
static inline void forms_agree(mt_test *t, asked *q, const double *ws, int n_w)
{
    enum { MOST = 7 };
    const int pairs = q->r.ports.n_in * q->r.ports.n_out;
    const ptrdiff_t size = (ptrdiff_t)pairs * q->m.n;
    const mt_arena_mark mark = mt_arena_get_mark(&q->r.mem);
    double some[MOST];
    int n = 0;
    mt_basis basis;
    mt_err err = {.text = ""};
    const mt_basis_problem whole = {
        .f = &q->r.f, .mass = &q->m.a->mass, .modes = &q->m.a->modes};
    const mt_slope_problem p = {
        .a = q->m.a, .basis = &basis, .ports = &q->r.ports, .ways = &q->r.ways};
    double complex *const want = mt_arena_alloc(&q->r.mem, (size_t)size * MOST, sizeof *want);
    if (!CHECK(t, mt_basis_make(&whole, &q->r.mem, &basis, &err) == MT_OK)) {
        return;
    }
    for (int i = 0; i < n_w && n < MOST; i += 1 + (n_w / MOST)) {
        some[n] = ws[i];
        CHECK(t, mt_response_slopes(&p, ws[i], want + (n * size), &q->r.mem, &err) == MT_OK);
        n++;
    }
    for (int pair = 0; pair < pairs; pair++) {
        check_forms(t, q, &p, pair, some, n, want);
    }
    mt_arena_rewind(&q->r.mem, mark);
}

/* A derivative that is 0 by itself is rounding beside the others. */
static inline void check_weighted(mt_test *t, asked *q, const double *ws, int n_w)
{
    double complex weight[MOST_WEIGHTED];
    double want[MOST_SLOPES] = {0.0};
    double size[MOST_SLOPES] = {0.0};
    double terms[MOST_PAIRS] = {0.0};
    double got[MECH_INPUTS];
    mt_err err = {.text = ""};
    const int n_out = q->r.ports.n_out;
    const int pairs = q->r.ports.n_in * n_out;
    for (int i = 0; i < n_w && i < MOST_WEIGHTED; i++) {
        weight[i] = weight_of(i);
    }
    forms_agree(t, q, ws, n_w);
    add_up_slopes(t, q, ws, n_w, want, size);
    add_up_terms(t, q, ws, n_w, terms);
    double most = 0.0;
    for (int at = 0; at < pairs * q->m.n; at++) {
        most = fmax(most, size[at]);
    }
    for (int pair = 0; pair < pairs; pair++) {
        CHECK(t, mt_response_weighted_slopes(&q->r, pair % n_out, pair / n_out, n_w, ws, weight,
                                             got, &err) == MT_OK);
        for (int p = 0; p < q->m.n; p++) {
            mt_test_row(t, "weighted, input %s, output %s, parameter %d",
                        q->r.ports.in[pair / n_out].name, q->r.ports.out[pair % n_out].name, p);
            const double unit = fabs(q->m.at[p]) > 0.0 ? fabs(q->m.at[p]) : 1.0;
            CHECK_NEAR_ABS(t, got[p], want[pair + (p * pairs)],
                           1e-11 * size[pair + (p * pairs)] + 1e-13 * most +
                               16.0 * DBL_EPSILON * terms[pair] / unit);
        }
    }
}

static inline void weighted_agree(mt_test *t, const sloped *s, asked *q, const double *ws,
                                  int n_w)
{
    const mt_analysis_options opt = all_modes(true);
    mt_err err = {.text = ""};
    if (CHECK(t, mt_analysis_solve(q->m.a, q->m.at, &opt, &err) == MT_OK) &&
        ask(t, q, s->inputs, s->outputs)) {
        check_weighted(t, q, ws, n_w);
    }
    mt_response_free(&q->r);
}

static inline void slopes_agree(mt_test *t, const sloped *s, const double *ws, int n_w)
{
    asked q = {.rc = MT_OK};
    mt_model *const model = s->text != NULL ? mech_parse(t, s->text) : mech_load(t, s->file);
    const bool ready = mech_must(t, model, s->configuration, s->parameters, &q.m);
    for (int k = 0; k < n_w && ready; k++) {
        check_slopes(t, s, &q, ws[k]);
    }
    if (ready) {
        weighted_agree(t, s, &q, ws, n_w);
    }
    done(&q);
}

#endif
