/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How good a design is: what it misses goals by, which of two is better, and the steps of a
 * search as a list of the best so far. */
#include "nlp/merit.h"

#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* Merit. */

bool mt_is_met(double violation, double tolerance)
{
    static const double ROUNDING = 1e-6;
    return violation <= tolerance * (1.0 + ROUNDING);
}

double mt_short_of(double room)
{
    return room != room ? room : fmax(-room, 0.0);
}

void mt_miss(mt_missed *m, double short_of, double tolerance)
{
    if (short_of != short_of || m->violation != m->violation) {
        *m = (mt_missed){.violation = short_of + m->violation, .squares = HUGE_VAL};
        return;
    }
    m->squares += short_of * short_of;
    m->violation = fmax(m->violation, short_of / tolerance);
}

mt_missed mt_missed_of(int n_eq, const double *eq, const double *eq_tol, int n_in,
                       const double *in, const double *in_tol)
{
    mt_missed m = {0.0, 0.0};
    for (int i = 0; i < n_eq; i++) {
        mt_miss(&m, fabs(eq[i]), eq_tol[i]);
    }
    for (int i = 0; i < n_in; i++) {
        mt_miss(&m, mt_short_of(in[i]), in_tol[i]);
    }
    return m;
}

bool mt_is_held(double violation)
{
    return violation <= 1.0;
}

int mt_compare(double a, double b, double equal)
{
    static const double NOTHING = 1e-6; /* of a change, a misfit, a part of a band's edge */
    const double size = fmax(fmax(fabs(a), fabs(b)), NOTHING);
    if (isfinite(size) && fabs(a - b) <= equal * size) {
        return 0;
    }
    return a < b ? -1 : a > b ? 1 : 0;
}

bool mt_merit_before(const mt_merit *a, const mt_merit *b, double equal)
{
    if (a->feasible != b->feasible) {
        return a->feasible;
    }
    int order = a->feasible ? 0 : mt_compare(a->squares, b->squares, equal);
    for (int k = 0; k < a->n && k < b->n && order == 0; k++) {
        order = mt_compare(a->f[k], b->f[k], equal);
    }
    return order < 0;
}

double mt_change(int n, const double *origin, const double *weight, const double *t)
{
    double f = 0.0;
    for (int j = 0; j < n; j++) {
        const double d = t[j] - origin[j];
        f += 0.5 * (weight != NULL ? weight[j] : 1.0) * d * d;
    }
    return f;
}

bool mt_is_nearer(int n, const double *origin, const double *weight, const double *s,
                  const double *t)
{
    int order = mt_compare(mt_change(n, origin, weight, s), mt_change(n, origin, weight, t),
                           MT_EQUAL_FOUND);
    for (int j = 0; j < n && order == 0; j++) {
        order = fabs(s[j] - t[j]) <= MT_SAME_DESIGN ? 0 : s[j] < t[j] ? -1 : 1;
    }
    return order < 0;
}

/* The steps of a search. */

mt_steps mt_steps_new(int most, mt_arena *mem)
{
    return (mt_steps){.most = most, .at = mt_arena_alloc(mem, (size_t)most, sizeof(mt_step))};
}

/* True where a ranks before b; use of the tolerances makes no difference. */
static bool is_before(const mt_step *a, const mt_step *b)
{
    const mt_merit x = {mt_is_held(a->violation), a->squares, 1, &a->f};
    const mt_merit y = {mt_is_held(b->violation), b->squares, 1, &b->f};
    return mt_merit_before(&x, &y, MT_EQUAL_FOUND);
}

static bool is_alike(const mt_step *a, const mt_step *b)
{
    return a->stage == b->stage && a->round == b->round;
}

/* The last step of its stage and round; NULL: none. */
static const mt_step *last_of(const mt_steps *steps, const mt_step *step)
{
    for (int i = steps->n - 1; i >= 0; i--) {
        if (is_alike(&steps->at[i], step)) {
            return &steps->at[i];
        }
    }
    return NULL;
}

/* Drops every other step between the first and the last of each stage and round; where none
 * lies between, the oldest. */
static void thin(mt_steps *steps)
{
    mt_step *const at = steps->at;
    bool drop = true;
    int kept = 1;
    for (int i = 1; i + 1 < steps->n; i++) {
        const bool inner = is_alike(&at[i - 1], &at[i]) && is_alike(&at[i], &at[i + 1]);
        if (!inner || !drop) {
            at[kept++] = at[i];
        }
        drop = inner && !drop;
    }
    at[kept++] = at[steps->n - 1];
    if (kept == steps->n) {
        kept--;
        memmove(at, at + 1, (size_t)kept * sizeof *at);
    }
    steps->n = kept;
}

static void append_step(mt_steps *steps, const mt_step *step)
{
    if (steps->at == NULL) {
        return;
    }
    if (steps->n == steps->most) {
        thin(steps);
    }
    steps->at[steps->n++] = *step;
}

void mt_steps_add(mt_steps *steps, const mt_step *step)
{
    const mt_step *const last = steps->at == NULL ? NULL : last_of(steps, step);
    if (last == NULL || is_before(step, last)) {
        append_step(steps, step);
    }
}

void mt_steps_append(mt_steps *steps, const mt_steps *more, long evals, int stage, int round)
{
    for (int i = 0; i < more->n; i++) {
        mt_step one = more->at[i];
        one.evals += evals;
        one.stage += stage;
        one.round += round;
        mt_steps_add(steps, &one);
    }
}

void mt_steps_settle(mt_steps *steps, const mt_step *end)
{
    mt_step one = *end;
    one.round = 0;
    for (int i = 0; i < steps->n; i++) {
        if (steps->at[i].stage == one.stage && steps->at[i].round > one.round) {
            one.round = steps->at[i].round;
        }
    }
    const mt_step *const last = last_of(steps, &one);
    if (last != NULL && is_before(last, &one)) {
        one.round++;
    }
    append_step(steps, &one);
}

void mt_steps_serialize(mt_steps *steps, mt_serializer *serializer)
{
    int n = steps->n;
    mt_serializer_int(serializer, &n, 0, steps->most);
    for (int i = 0; i < n && !serializer->failed; i++) {
        mt_step *const s = &steps->at[i];
        if (serializer->reads) {
            *s = (mt_step){.evals = 0};
        }
        mt_serializer_long(serializer, &s->evals, 0, LONG_MAX);
        mt_serializer_numbers(serializer, 1, &s->f);
        mt_serializer_numbers(serializer, 1, &s->violation);
        mt_serializer_numbers(serializer, 1, &s->squares);
    }
    steps->n = serializer->failed ? 0 : n;
}
