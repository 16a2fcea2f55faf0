/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The corners that a search over tolerances begins with, and the one that is worst to first
 * order at a design. With h_i = tolerance_i |x_i|,
 *
 *     lambda(x + d) = lambda(x) + sum_i (dlambda/dx_i) d_i + O(h^2),   |d_i| <= h_i
 *
 * is least at d_i = -h_i sign(dlambda/dx_i) and greatest at the opposite corner. Where slopes
 * change their sign within the tolerances that is wrong: whoever counts a design judges it at
 * the others, too (tolerance_cut.c).
 */
#include <math.h>
#include <string.h>

#include "problem/tolerance.h"

/* Adds the corner to the set; where it is already there, only its sides are added. */
static void add_corner(const mt_tolerance_corner *corner, int n, mt_tolerance_corners *out)
{
    for (int k = 0; k < out->n; k++) {
        mt_tolerance_corner *const known = &out->corners[k];
        if (memcmp(known->factor, corner->factor, (size_t)n * sizeof *known->factor) == 0) {
            for (int side = 0; side < MT_TOLERANCE_SIDES; side++) {
                known->may[side] = known->may[side] || corner->may[side];
            }
            return;
        }
    }
    out->corners[out->n++] = *corner;
}

/* The corner of one mode on one side. */
static mt_status make_first(const mt_subproblem *c, const int *signs, const double *slope,
                            mt_tolerance_side side, mt_arena *mem, mt_tolerance_corner *out,
                            mt_err *err)
{
    *out = (mt_tolerance_corner){.factor = mt_arena_f64(mem, (size_t)c->p->n, 1)};
    MT_TRY(mt_arena_check(mem, err));
    out->may[side] = true;
    for (int i = 0; i < c->p->n; i++) {
        const int by_slope = slope[i] < 0.0 ? MT_FALLS : MT_RISES;
        const int rises = signs[i] == MT_UNKNOWN ? by_slope : signs[i];
        out->factor[i] = mt_tolerance_factor(c, i, side == MT_LOWEST ? -rises : rises);
    }
    return MT_OK;
}

/* Sides on which goals limit mode `mode` of a configuration: bands on both sides, for modes
 * below their upper edges and one above. */
static void find_sides(const mt_subproblem *c, int view, int mode, double hz_before,
                       bool *sides)
{
    for (int i = 0; i < c->p->n_requirements; i++) {
        const mt_requirement *const d = &c->p->requirements[i];
        const bool ranged = d->role == MT_ROLE_RANGE;
        if (d->view == view && d->mode == mode && (ranged || d->role == MT_ROLE_LIMIT)) {
            sides[MT_LOWEST] = sides[MT_LOWEST] || ranged || MT_HAS(d->goal->at_least);
            sides[MT_HIGHEST] = sides[MT_HIGHEST] || ranged || MT_HAS(d->goal->at_most);
        }
    }
    for (int i = 0; i < c->n_avoidances; i++) {
        const mt_bands *const bands = &c->avoidances[i].bands;
        const bool reaches = c->avoidances[i].view == view && bands->n > 0 &&
                             hz_before <= bands->items[bands->n - 1].upper_hz;
        sides[MT_LOWEST] = sides[MT_LOWEST] || reaches;
        sides[MT_HIGHEST] = sides[MT_HIGHEST] || reaches;
    }
}

/* The corners that the slopes of one mode name. */
static mt_status add_sides(const mt_subproblem *c, const int *signs, const double *slope,
                           const bool sides[MT_TOLERANCE_SIDES], mt_arena *mem,
                           mt_tolerance_corners *out, mt_err *err)
{
    for (int k = 0; k < MT_TOLERANCE_SIDES; k++) {
        mt_tolerance_corner corner;
        if (sides[k]) {
            MT_TRY(make_first(c, signs, slope, (mt_tolerance_side)k, mem, &corner, err));
            add_corner(&corner, c->p->n, out);
        }
    }
    return MT_OK;
}

/* Gives a side that no corner has to the first corner, so that every row is evaluated at
 * one. */
static void hold_somewhere(mt_tolerance_corners *out)
{
    for (int side = 0; side < MT_TOLERANCE_SIDES && out->n > 0; side++) {
        bool any = false;
        for (int k = 0; k < out->n; k++) {
            any = any || out->corners[k].may[side];
        }
        out->corners[0].may[side] = out->corners[0].may[side] || !any;
    }
}

static mt_status name_corners(const mt_subproblem *c, int view, mt_analysis *a,
                              const int *signs, mt_arena *mem, mt_tolerance_corners *out,
                              mt_err *err)
{
    const int n = c->p->n;
    const int most = mt_modal_vibrations(&a->modes);
    double hz_before = 0.0;
    double *const slope = mt_arena_f64(mem, (size_t)n, 1);
    out->corners =
        mt_arena_alloc(mem, (size_t)MT_TOLERANCE_SIDES * (size_t)most, sizeof *out->corners);
    MT_TRY(mt_arena_check(mem, err));
    for (int mode = 1; mode <= most; mode++) {
        bool sides[MT_TOLERANCE_SIDES] = {false};
        mt_err own = {.code = MT_OK};
        const int pos = mt_modal_flexible(&a->modes, mode);
        if (pos < 0) {
            continue;
        }
        find_sides(c, view, mode, hz_before, sides);
        hz_before = mt_modal_hz(&a->modes, pos);
        if (!sides[MT_LOWEST] && !sides[MT_HIGHEST]) {
            continue;
        }
        const mt_status rc = mt_analysis_dlambda_raw(a, pos, slope, &own);
        MT_TRY(mt_pass_final(rc, &own, err));
        if (rc == MT_OK) {
            MT_TRY(add_sides(c, signs, slope, sides, mem, out, err));
        }
    }
    hold_somewhere(out);
    return MT_OK;
}

mt_status mt_tolerance_first(const mt_subproblem *c, int view, const int *signs, mt_arena *mem,
                             mt_tolerance_corners *out, mt_err *err)
{
    const mt_analysis_options opt = {
        .gradient = true, .vectors = true, .accuracy = MT_MODAL_ACCURACY};
    mt_analysis *a = NULL;
    mt_err own = {.code = MT_OK};
    double *const x = mt_arena_f64(mem, (size_t)c->p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < c->p->n; i++) {
        x[i] = fmin(fmax(c->p->original[i], c->lower[i]), c->upper[i]);
    }
    *out = (mt_tolerance_corners){.exact = false};
    mt_problem_note_modal(c->p, 2); /* made and solved with slopes */
    mt_status rc = mt_configuration_analyse(&c->views[view], x, &a, &own);
    rc = rc == MT_OK ? mt_analysis_solve(a, x, &opt, &own) : rc;
    const bool known = rc == MT_OK;
    rc = mt_pass_final(rc, &own, err);
    rc = rc == MT_OK && known ? name_corners(c, view, a, signs, mem, out, err) : rc;
    mt_analysis_delete(a);
    return rc;
}
