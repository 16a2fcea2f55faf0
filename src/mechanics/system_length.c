/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The model length: what a displacement is compared with, so that it has to scale as the model
 * does. Where bodies have an extent it is theirs. Else (one body held at its centre) it is, of
 * what is there, the first of
 *     the distance between the ends of springs, joints and links,
 *     a radius of gyration sqrt(J / m),
 *     a static displacement F / k of the largest force and the stiffest spring,
 * each taken of the largest there are. Where there is none of them nothing moves by a length,
 * or nothing says how far, and 1 will do.
 */
#include <math.h>

#include "mechanics/system.h"

static double vector_length(const mt_vec_def *def, const double *v)
{
    return hypot(hypot(v[def->node[0]], v[def->node[1]]), v[def->node[2]]);
}

static double value_or_zero(const double *v, mt_node node)
{
    return node == MT_NO_NODE ? 0.0 : v[node];
}

/* Diagonal of the box around all centres. */
static double diagonal(const mt_system *sys, const double *v)
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL;
        double high = -HUGE_VAL;
        for (int i = 0; i < sys->n_bodies; i++) {
            const double x = v[sys->vecs[sys->bodies[i].centre].node[k]];
            low = fmin(low, x);
            high = fmax(high, x);
        }
        sum = sys->n_bodies > 0 ? hypot(sum, high - low) : 0.0;
    }
    return sum;
}

/* Longest arm from a centre. */
static double longest_arm(const mt_system *sys, const double *v)
{
    double most = 0.0;
    for (int i = 0; i < sys->n_measures; i++) {
        const mt_measure_def *const m = &sys->measures[i];
        for (int side = 0; side < 2; side++) {
            if (m->point[side] >= 0 && m->body[side] != MT_GROUND) {
                most = fmax(most, vector_length(&sys->vecs[m->point[side]], v));
            }
        }
    }
    return most;
}

/* Coordinate k of an end of a measure in the drawn position. */
static double end_of(const mt_system *sys, const mt_measure_def *m, int side, int k,
                     const double *v)
{
    const double arm = m->point[side] >= 0 ? v[sys->vecs[m->point[side]].node[k]] : 0.0;
    return m->body[side] == MT_GROUND
               ? arm
               : v[sys->vecs[sys->bodies[m->body[side]].centre].node[k]] + arm;
}

static bool is_between_points(const mt_measure_def *m)
{
    return m->kind == MT_MEASURE_PLANE || m->kind == MT_MEASURE_DISTANCE;
}

/* Longest distance between the ends of a measure. */
static double span(const mt_system *sys, const double *v)
{
    double most = 0.0;
    for (int i = 0; i < sys->n_measures; i++) {
        const mt_measure_def *const m = &sys->measures[i];
        double sum = 0.0;
        for (int k = 0; k < 3 && is_between_points(m); k++) {
            sum = hypot(sum, end_of(sys, m, 1, k, v) - end_of(sys, m, 0, k, v));
        }
        most = fmax(most, sum);
    }
    return most;
}

static double gyration(const mt_system *sys, const double *v)
{
    double mass = 0.0;
    double inertia = 0.0;
    for (int i = 0; i < sys->n_inertias; i++) {
        const mt_inertia_def *const def = &sys->inertias[i];
        const double size = value_or_zero(v, def->coefficient);
        mass = def->kind == MT_INERTIA_TRANSLATION ? fmax(mass, size) : mass;
        inertia = def->kind == MT_INERTIA_ROTATION ? fmax(inertia, size) : inertia;
    }
    return mass > 0.0 ? sqrt(inertia / mass) : 0.0;
}

static double deflection(const mt_system *sys, const double *v)
{
    double force = 0.0;
    double stiffness = 0.0;
    for (int i = 0; i < sys->n_loads; i++) {
        double sum = 0.0;
        for (int k = 0; k < 3 && sys->loads[i].measure < 0; k++) {
            sum = hypot(sum, value_or_zero(v, sys->loads[i].force[k]));
        }
        force = fmax(force, sum);
    }
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (is_between_points(&sys->measures[s->measure[0]]) && !s->damper) {
            stiffness = fmax(stiffness, fabs(value_or_zero(v, s->stiffness)));
        }
    }
    return stiffness > 0.0 ? force / stiffness : 0.0;
}

double mt_system_length(const mt_system *sys, const double *v)
{
    double (*const of[])(const mt_system *, const double *) = {span, gyration, deflection};
    double length = fmax(diagonal(sys, v), longest_arm(sys, v));
    for (size_t i = 0; i < sizeof of / sizeof of[0] && !(length > 0.0); i++) {
        length = of[i](sys, v);
    }
    return length > 0.0 && isfinite(length) ? length : 1.0;
}
