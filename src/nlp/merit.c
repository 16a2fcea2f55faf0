/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/merit.h"

#include <math.h>
#include <stddef.h>

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
