/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The least clearance z is free to be negative, so that a search can start anywhere; a design
 * that ends with z < 0 has a mode on the wrong side of an edge: it is not of this kind, and
 * misses the bands by -z, which is f.
 */
#include <math.h>

#include "nlp/merit.h"
#include "search/mode_placements.h"

void mt_mode_placement_refuse(mt_nlp_solution *best, double short_of, double tolerance)
{
    mt_missed m = {best->violation, best->squares};
    mt_miss(&m, short_of, tolerance);
    best->feasible = false;
    best->squares = m.squares;
    best->violation = m.violation;
}

static double least_tolerance(const mt_subproblem *c)
{
    double tolerance = HUGE_VAL;
    for (int i = 0; i < c->n_avoidances; i++) {
        tolerance = fmin(tolerance, c->avoidances[i].tolerance);
    }
    return tolerance;
}

void mt_mode_placement_refuse_step(const mt_subproblem *c, mt_step *s)
{
    const double tolerance = least_tolerance(c);
    if (s->f > tolerance) {
        mt_missed m = {s->violation, s->squares};
        mt_miss(&m, s->f, tolerance);
        s->violation = m.violation;
        s->squares = m.squares;
    }
}

void mt_mode_placement_verify_clearance(const mt_subproblem *c, mt_nlp_result *found)
{
    const double tolerance = least_tolerance(c);
    for (int i = 0; i < found->n_solutions && c->clearance; i++) {
        mt_nlp_solution *const s = &found->solutions[i];
        const double z = s->t[c->p->n];
        if (z < -tolerance) {
            mt_mode_placement_refuse(s, -z, tolerance);
        }
    }
    found->compromise = found->n_solutions > 0 && !found->solutions[0].feasible;
}
