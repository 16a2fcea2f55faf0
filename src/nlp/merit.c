/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/merit.h"

#include <math.h>

bool mt_is_met(double violation, double tolerance)
{
    static const double ROUNDING = 1e-6;
    return violation <= tolerance * (1.0 + ROUNDING);
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
