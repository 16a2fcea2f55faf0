/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals over the tolerances of the variables: nominal and worst values beside each other. */
#include <math.h>
#include <string.h>

#include "describe/describe.h"
#include "problem/frequency.h"
#include "problem/requirement.h"
#include "problem/tolerance.h"

static const double PERCENT = 100.0;

mt_status mt_describe_ranges(mt_workspace *fresh, mt_err *err)
{
    if (fresh->c->tolerance_box == NULL) {
        return MT_OK;
    }
    mt_ranges *const ranges = mt_arena_alloc(&fresh->mem, 1, sizeof *ranges);
    MT_TRY(mt_arena_check(&fresh->mem, err));
    MT_TRY(mt_tolerance_ranges(fresh, &fresh->mem, ranges, err));
    fresh->tolerance_box->ranges = ranges;
    return MT_OK;
}

/* Relative distance by which a range misses a limit; negative: margin left. NaN where a value
 * is missing. */
static double beyond(const mt_tolerance_range *r, mt_tolerance_side side, double limit,
                     const mt_requirement *d)
{
    const double value = r->value[side];
    const double sign = side == MT_LOWEST ? 1.0 : -1.0;
    const bool ratio = d->measure == MT_MEASURE_RATIO;
    const double unit = mt_requirement_unit(d, limit);
    const double far = sign * (ratio ? mt_log_ratio(limit, value) : (limit - value) / unit);
    return ratio && far > MT_MOST_INSIDE ? MT_MOST_INSIDE : far; /* NaN stays */
}

/* A violation in percent of what is asked for: that of a frequency is a logarithm. */
static double percent_of(const mt_requirement *d, mt_tolerance_side side, double violation)
{
    const bool ratio = d->measure == MT_MEASURE_RATIO;
    const double below = ratio ? -expm1(-violation) : violation;
    const double above = ratio ? expm1(violation) : violation;
    return PERCENT * (side == MT_LOWEST ? below : above);
}

typedef struct verdict {
    mt_tolerance_side side; /* that the goal is judged by */
    double violation;       /* at most 0: it is met */
    double percent;
} verdict;

static verdict find_worst_side(const mt_requirement *d, const mt_tolerance_range *r)
{
    const double target = d->equals;
    const bool equal = MT_HAS(target);
    const double limit[MT_TOLERANCE_SIDES] = {equal ? target : d->goal->at_least,
                                              equal ? target : d->goal->at_most};
    verdict v = {.side = MT_LOWEST, .violation = -HUGE_VAL, .percent = -HUGE_VAL};
    for (int k = 0; k < MT_TOLERANCE_SIDES; k++) {
        const mt_tolerance_side side = (mt_tolerance_side)k;
        if (!MT_HAS(limit[k]) || !MT_HAS(v.percent)) {
            continue;
        }
        const double far = beyond(r, side, limit[k], d);
        const double percent = percent_of(d, side, far);
        v.side = percent > v.percent || !MT_HAS(percent) ? side : v.side;
        v.violation = far > v.violation || !MT_HAS(far) ? far : v.violation;
        v.percent = percent > v.percent || !MT_HAS(percent) ? percent : v.percent;
    }
    if (equal &&
        d->measure == MT_MEASURE_RATIO) { /* within the tolerance as a part of the target */
        v.violation = v.percent / PERCENT;
    }
    return v;
}

mt_status mt_describe_worst(mt_workspace *fresh, const mt_requirement *d, mt_result *result,
                            mt_result_goal *g, double *violation, double *percent, mt_err *err)
{
    const mt_ranges *const known = mt_tolerance_known(fresh);
    if (known == NULL || d->role == MT_ROLE_RESIDUAL) {
        return MT_OK; /* without tolerances, or the design itself could not be evaluated */
    }
    const mt_tolerance_range *const r =
        d->view >= 0 ? mt_ranges_hz(known, d->view, d->mode) : &known->number[d->index];
    if (r == NULL) {
        return MT_OK;
    }
    const verdict v = find_worst_side(d, r);
    if (d->role != MT_ROLE_TARGET) {
        *violation =
            v.violation > *violation || !MT_HAS(v.violation) ? v.violation : *violation;
        *percent = v.percent > *percent || !MT_HAS(v.percent) ? v.percent : *percent;
    }
    g->worst = r->value[v.side];
    g->worst_at = mt_arena_f64(&result->mem, (size_t)fresh->p->n, 1);
    MT_TRY(mt_arena_check(&result->mem, err));
    memcpy(g->worst_at, r->at[v.side], (size_t)fresh->p->n * sizeof *g->worst_at);
    return MT_OK;
}

double mt_describe_worst_hz(const mt_workspace *fresh, int view, int mode, const mt_band *band,
                            double hz, const double **at)
{
    const mt_tolerance_range *const r = mt_ranges_hz(mt_tolerance_known(fresh), view, mode);
    const double middle = sqrt(fmax(band->lower_hz, 0.0) * band->upper_hz);
    *at = NULL;
    if (r == NULL) {
        return nan("");
    }
    const mt_tolerance_side side = hz > middle ? MT_LOWEST : MT_HIGHEST;
    const double end = r->value[side];
    *at = r->at[side];
    /* one that crosses the band from one side to the other is in its middle on the way */
    return side == MT_LOWEST ? fmax(end, fmin(middle, hz)) : fmin(end, fmax(middle, hz));
}
