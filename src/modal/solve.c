/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One solve:
 *   take results from mem; mark; plain path; kinds; perhaps the factor path (and the load's
 *   part on top of it) and kinds again; clusters; what was asked for; signs; checks; rewind to
 *   the mark.
 */
#include "modal/solve.h"

#include "modal/modal_priv.h"

#include <float.h>
#include <math.h>

mt_modal_options mt_modal_options_default(void)
{
    return (mt_modal_options){.n_rigid = -1, .vectors = true, .accuracy = 0.0, .check = true};
}

static mt_status claim_modes(const mt_mass_factor *mass, const mt_modal_options *opt,
                             mt_arena *mem, mt_modes *out, mt_err *err)
{
    const int count = mass->rank;
    const size_t c = (size_t)count;
    *out =
        (mt_modes){.n = mass->n, .all = count, .count = count, .n_condensed = mass->n - count};
    out->lambda = mt_arena_f64(mem, c, 1);
    out->shaped = opt->vectors ? count : 0;
    out->kind = mt_arena_alloc(mem, c, sizeof *out->kind);
    out->cluster = mt_arena_int(mem, c);
    out->error = mt_arena_f64(mem, c, 1);
    if (opt->vectors) {
        out->y = mt_arena_f64(mem, (size_t)mass->n, c);
    }
    if (opt->vectors && opt->check) {
        out->residual = mt_arena_f64(mem, c, 1);
        out->orthogonality = mt_arena_f64(mem, c, 1);
    }
    if (out->n_condensed > 0) {
        out->massless = mt_arena_f64(mem, (size_t)mass->n, 1);
    }
    return mt_arena_check(mem, err);
}

/* Errors of eigenvalues that quotients make the 1e-9 of mt_modal_rough of, by the square. */
static const double SHAPES = 3e-5;

/* True where the plain result is not accurate enough. Signs and ranks are uncertain where a
 * factor (K semidefinite by construction) has an unstable mode, rigid-body modes that were not
 * given, or given ones with stiffness. */
static bool needs_factor(const mt_modes *modes, const mt_modal_options *opt)
{
    if (modes->n_unstable > 0 || modes->n_held > 0 ||
        (opt->n_rigid < 0 && modes->n_rigid > 0)) {
        return true;
    }
    const int lowest = mt_modal_flexible(modes, 1);
    if (lowest >= 0 && opt->judged) {
        return modes->error_bound > SHAPES * modes->lambda[lowest];
    }
    return lowest >= 0 && DBL_EPSILON * modes->scale > opt->accuracy * modes->lambda[lowest];
}

/* Correct n_held, which classification counts above the noise only. */
static void judge_held(mt_modes *modes, const mt_modal_options *opt, double rigid_most,
                       int null_count)
{
    if (null_count >= 0) {
        modes->n_held = opt->n_rigid > null_count ? opt->n_rigid - null_count : 0;
    } else if (!(rigid_most > MT_MODAL_HELD * modes->error_bound)) {
        modes->n_held = 0;
    }
}

/* Solve with the factor, then add G; the rank of B then says nothing about the null directions
 * of K (null_count -1). */
static mt_status by_factor(const mt_stiffness_factor *factor, const mt_mass_factor *mass,
                           mt_arena *scratch, mt_modes *out, int *null_count, mt_err *err)
{
    double *const wanted = out->y;
    if (factor->g != NULL && out->y == NULL) {
        out->y = mt_arena_f64(scratch, (size_t)out->n, (size_t)out->n);
        MT_TRY(mt_arena_check(scratch, err));
    }
    mt_status rc = mt_modal_by_factor(factor, mass, scratch, out, null_count, err);
    if (rc == MT_OK && factor->g != NULL) {
        rc = mt_modal_add_load(factor->g, mass, scratch, out, err);
        *null_count = -1;
    }
    out->y = wanted;
    return rc;
}

/* Kinds and errors; zero eigenvalues are decided by the absolute bound, and the value set to
 * zero is then part of its error. */
static double kinds(mt_modes *out, int n_rigid)
{
    for (int i = 0; i < out->count; i++) {
        out->error[i] = out->lambda[i];
    }
    const double most = mt_modal_classify(out, n_rigid, NULL, NULL);
    for (int i = 0; i < out->count; i++) {
        const double was = out->error[i];
        const double part = out->lambda[i] == was ? out->error_relative : 1.0;
        out->error[i] = out->error_bound + (part * fabs(was));
    }
    return most;
}

/* True where fewer shapes than all may be wanted and are cheaper. The number of modes up to a
 * frequency is not known beforehand. */
static bool is_part(const mt_mass_factor *mass, const mt_modal_options *opt)
{
    const int modes = opt->modes.first > 0 ? opt->modes.first : mass->rank;
    const int shapes = opt->shapes.first > 0 ? opt->shapes.first : modes;
    const bool part = opt->shapes.up_to > 0.0 || opt->modes.up_to > 0.0;
    const int least = part && opt->shapes.first == 0 ? 0 : shapes < modes ? shapes : modes;
    return opt->vectors && mass->rank >= MT_MODAL_PART_ORDER &&
           least <= mass->rank / MT_MODAL_PART;
}

/* Number of lowest modes that contain all of a part; maybe_zero: and all modes that may be
 * 0. */
static int end_of(const mt_modes *out, const mt_modal_part *part, bool maybe_zero)
{
    const bool all = part->first <= 0 && !(part->up_to > 0.0);
    int seen = 0;
    int end = 0;
    for (int i = 0; i < out->count; i++) {
        const bool flexible = out->kind[i] == MT_MODE_FLEXIBLE;
        seen += flexible ? 1 : 0;
        const bool asked =
            seen <= part->first || (part->up_to > 0.0 && out->lambda[i] <= part->up_to);
        const bool repeated = i > 0 && end == i && out->cluster[i] == out->cluster[i - 1];
        const bool zero = maybe_zero && out->lambda[i] <= out->error[i];
        end = all || !flexible || asked || repeated || zero ? i + 1 : end;
    }
    return end;
}

/* Drop modes and shapes that are not wanted. */
static void drop_unwanted_modes(mt_modes *out, const mt_modal_options *opt)
{
    out->count = end_of(out, &opt->modes, false);
    out->shaped = opt->vectors ? end_of(out, &opt->shapes, true) : 0;
}

static mt_status compute(const double *k, const mt_mass_factor *mass,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *scratch, mt_modes *out, mt_err *err)
{
    int null_count = -1;
    mt_tridiagonal later = {.n = 0};
    MT_TRY(mt_modal_plain(k, mass, scratch, out, is_part(mass, opt) ? &later : NULL, err));
    double rigid_most = kinds(out, opt->n_rigid);
    const bool usable = factor != NULL && opt->accuracy > 0.0 && mass->rank == mass->n;
    if (usable && needs_factor(out, opt)) {
        MT_TRY(by_factor(factor, mass, scratch, out, &null_count, err));
        const bool exact = opt->n_rigid < 0 && null_count >= 0;
        rigid_most = kinds(out, exact ? null_count : opt->n_rigid);
    }
    judge_held(out, opt, rigid_most, null_count);
    mt_modal_find_clusters(out);
    drop_unwanted_modes(out, opt);
    if (later.n > 0 && !out->from_factor) {
        MT_TRY(mt_modal_plain_lowest(k, mass, &later, scratch, out, err));
    }
    if (opt->vectors) {
        mt_modal_fix_sign(out->n, out->shaped, out->y);
    }
    return out->residual == NULL ? MT_OK : mt_modal_check(k, mass, scratch, out, err);
}

mt_status mt_modal_solve(const double *k, const mt_mass_factor *mass,
                         const mt_stiffness_factor *factor, const mt_modal_options *opt,
                         mt_arena *mem, mt_modes *out, mt_err *err)
{
    const mt_modal_options used = opt == NULL ? mt_modal_options_default() : *opt;
    MT_TRY(claim_modes(mass, &used, mem, out, err));
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = compute(k, mass, factor, &used, mem, out, err);
    mt_arena_rewind(mem, mark);
    if (rc != MT_E_MASSLESS) {
        out->massless = NULL;
    }
    return rc;
}
