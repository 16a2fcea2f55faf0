/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The modes of one configuration as functions of inputs, with the channels that read them. */
#include "analysis/analysis.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/count.h"
#include "analysis/lowest.h"
#include "analysis/tracking.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/energy.h"
#include "mechanics/linear.h"
#include "mechanics/products.h"

/* Channels. */

mt_status mt_channels_scale(const mt_system *sys, int n, const int *channels, double length,
                            mt_arena *mem, double **scale, mt_err *err)
{
    int turns = 0;
    *scale = NULL;
    for (int i = 0; i < n; i++) {
        turns += mt_channel_turns(sys->channels[channels[i]].kind) ? 1 : 0;
    }
    if (turns == 0 || turns == n) {
        return MT_OK;
    }
    *scale = mt_arena_f64(mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        (*scale)[i] = mt_channel_turns(sys->channels[channels[i]].kind) ? length : 1.0;
    }
    return MT_OK;
}

void mt_channels_weigh(int n, const double *scale, int columns, double *shapes)
{
    for (int k = 0; k < columns && scale != NULL; k++) {
        for (int i = 0; i < n; i++) {
            shapes[i + ((ptrdiff_t)k * n)] *= scale[i];
        }
    }
}

mt_status mt_analysis_common_channels(const mt_analysis *a, const mt_analysis *b, mt_arena *mem,
                                      mt_common_channels *out, mt_err *err)
{
    const size_t most = (size_t)a->sys->n_channels;
    *out = (mt_common_channels){.a = mt_arena_int(mem, most), .b = mt_arena_int(mem, most)};
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < a->sys->n_channels; i++) {
        const int other = mt_system_find_channel(b->sys, a->sys->channels[i].name);
        if (other >= 0) {
            out->a[out->n] = i;
            out->b[out->n++] = other;
        }
    }
    return MT_OK;
}

/* Analysis. */

enum { DIRECTION_TEXT = 300 };
static const char NO_GRADIENT[] = "derivatives asked for after a solve without gradient";
static const char NO_SHAPE[] = "the shape of mode %d was not asked for";

mt_analysis_options mt_analysis_options_default(void)
{
    const mt_analysis_options opt = {.gradient = false,
                                     .vectors = true,
                                     .accuracy = MT_MODAL_ACCURACY,
                                     .check = true,
                                     .bounds = true};
    return opt;
}

const char *mt_analysis_configuration(const mt_analysis *a)
{
    return a->sys->model->configurations[a->sys->configuration].name.s;
}

void mt_analysis_delete(mt_analysis *a)
{
    if (a != NULL) {
        mt_arena_free(&a->mass_mem);
        mt_arena_free(&a->mem);
        mt_arena_free(&a->damping_mem);
        mt_arena_free(&a->first_mem);
        mt_linear_delete(a->lin);
        mt_system_delete(a->own_sys);
        free(a);
    }
}

/* Shapes of the modes that damping ratios name, at the first design. */
static mt_status name_modes(mt_analysis *a, mt_err *err)
{
    const mt_damping_def *const d = &a->sys->damping;
    if (d->n_named == 0) {
        return MT_OK;
    }
    a->named_shape = mt_arena_alloc(&a->first_mem, (size_t)d->n_named, sizeof *a->named_shape);
    MT_TRY(mt_arena_check(&a->first_mem, err));
    for (int i = 0; i < d->n_named; i++) {
        const int pos = mt_analysis_named(a, a->sys->model->modes[d->named[i]].index);
        if (pos < 0 || mt_modal_shape(&a->modes, pos) == NULL) {
            continue;
        }
        double *const w = mt_arena_f64(&a->first_mem, (size_t)a->sys->nq, 1);
        MT_TRY(mt_arena_check(&a->first_mem, err));
        MT_TRY(mt_track_weigh(a, pos, w, err));
        a->named_shape[i] = w;
    }
    return MT_OK;
}

/* Solve for the first time; *out is a, which is deleted on failure. */
static mt_status open_at(mt_analysis *a, const double *at, int first, mt_analysis **out,
                         mt_err *err)
{
    mt_analysis_options opt = mt_analysis_options_default();
    const char *const name = mt_analysis_configuration(a);
    opt.modes.first = first;
    a->n_rigid = -1;
    mt_status rc = mt_linear_new(a->sys, &a->lin, err);
    rc = rc == MT_OK ? mt_analysis_solve(a, at, &opt, err) : rc;
    a->n_rigid = a->modes.n_rigid;
    a->n_null = a->modes.n_rigid;
    a->n_most = a->modes.all;
    a->graded = a->modes.from_factor;
    rc = rc == MT_OK && a->named_shape == NULL ? name_modes(a, err) : rc;
    if (rc != MT_OK) {
        mt_analysis_delete(a);
        return mt_err_in(err, rc, "configuration \"%s\"", name);
    }
    *out = a;
    return MT_OK;
}

mt_status mt_analysis_new_of(const mt_system_def *def, int first, mt_analysis **out,
                             mt_err *err)
{
    const double bodies = mt_lowest_bodies(def->model, def->configuration);
    const char *const name = def->model->configurations[def->configuration].name.s;
    *out = NULL;
    if (bodies > MT_ANALYSIS_BODIES) {
        return mt_fail(
            err, MT_E_INPUT,
            "configuration \"%s\": %.0f bodies are too many for dense matrices, which "
            "take %d",
            name, bodies, (int)MT_ANALYSIS_BODIES);
    }
    mt_analysis *const a = calloc(1, sizeof *a);
    if (a == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = mt_system_new_of(def, &a->own_sys, err);
    if (rc != MT_OK) {
        mt_analysis_delete(a);
        return mt_err_in(err, rc, "configuration \"%s\"", name);
    }
    a->sys = a->own_sys;
    return open_at(a, def->at, first, out, err);
}

mt_status mt_analysis_new(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_analysis **out, mt_err *err)
{
    const mt_system_def def = {.model = model,
                               .configuration = configuration,
                               .n_inputs = n_inputs,
                               .inputs = inputs,
                               .at = at};
    return mt_analysis_new_of(&def, 0, out, err);
}

mt_status mt_analysis_new_like(const mt_analysis *like, const double *at, mt_analysis **out,
                               mt_err *err)
{
    mt_analysis *const a = calloc(1, sizeof *a);
    *out = NULL;
    if (a == NULL) {
        return mt_fail_memory(err);
    }
    a->sys = like->sys;
    a->named_shape = like->named_shape;
    return open_at(a, at, 0, out, err);
}

/* Factor the reduced mass again where it has changed. */
static mt_status refresh_mass(mt_analysis *a, mt_err *err)
{
    const mt_reduced r = mt_linear_reduced(a->lin);
    if (a->mass_version == r.mass_version) {
        return MT_OK;
    }
    mt_arena_clear(&a->mass_mem);
    a->mass_version = 0;
    MT_TRY(mt_modal_factor_mass(r.n, r.m, &a->mass_mem, &a->mass, err));
    a->mass_version = r.mass_version;
    return MT_OK;
}

/* Energies of `count` shapes y, stored from `at` on. */
static mt_status energies_of(mt_analysis *a, int at, int count, const double *y,
                             mt_mode_energies *e, mt_err *err)
{
    const mt_energies out = {.stiffness = e->stiffness + at,
                             .mass = e->mass + at,
                             .stiffness_noise = e->stiffness_noise + at,
                             .mass_noise = e->mass_noise + at,
                             .given_noise = e->given_noise + at,
                             .strained = e->strained + at};
    return count > 0 ? mt_linear_energies(a->lin, count, y, &out, err) : MT_OK;
}

static mt_status solve_and_judge(mt_analysis *a, const mt_reduced *r,
                                 const mt_modal_options *options, bool bounds, mt_err *err)
{
    const mt_stiffness_factor factor = {.rows = r->rows,
                                        .b = r->b,
                                        .c = r->c,
                                        .noise = r->noise,
                                        .g = r->g,
                                        .interrupt = a->sys->run->interrupt};
    MT_TRY(mt_modal_solve(r->k, &a->mass, &factor, options, &a->mem, &a->modes, err));
    const int all = a->modes.count;
    const bool whole = r->loaded || bounds || options->judged;
    const int worth = whole ? all : mt_modal_doubtful(&a->modes);
    const int judged = worth < a->modes.shaped ? worth : a->modes.shaped;
    if (judged == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    /* of a group whose errors nobody asks for, eigenvalues are good enough as they are */
    int *const group = bounds ? mt_arena_int(&a->mem, (size_t)judged) : NULL;
    MT_TRY(mt_arena_check(&a->mem, err));
    const int pairs = bounds ? mt_modal_groups(&a->modes, judged, group) : 0;
    const size_t count = (size_t)all + (size_t)pairs;
    double *const pair_y = mt_arena_f64(&a->mem, (size_t)a->modes.n, (size_t)pairs);
    mt_mode_energies e = {.stiffness = mt_arena_f64(&a->mem, count, 1),
                          .mass = mt_arena_f64(&a->mem, count, 1),
                          .stiffness_noise = mt_arena_f64(&a->mem, count, 1),
                          .mass_noise = mt_arena_f64(&a->mem, count, 1),
                          .given_noise = mt_arena_f64(&a->mem, count, 1),
                          .strained = mt_arena_alloc(&a->mem, count, sizeof(bool)),
                          .count = judged,
                          .group = group};
    MT_TRY(mt_arena_check(&a->mem, err));
    if (pairs > 0) {
        mt_modal_pair_shapes(&a->modes, judged, group, pair_y);
    }
    MT_TRY(energies_of(a, 0, judged, a->modes.y, &e, err));
    MT_TRY(energies_of(a, judged, pairs, pair_y, &e, err));
    mt_modal_judge(&e, options->n_rigid, &a->modes);
    mt_arena_rewind(&a->mem, mark);
    return MT_OK;
}

/* True where wanted vibration modes exist but are missing. After mt_modal_judge a mode may no
 * longer be a vibration. */
static bool is_short(const mt_modes *modes, int first)
{
    return first > 0 && modes->count < modes->all && mt_modal_indexed(modes) &&
           mt_modal_flexible(modes, first) < 0;
}

/* Modes of K and M as they are, with a->n_rigid rigid-body modes or, where that does not hold,
 * counted again. */
static mt_status find_modes(mt_analysis *a, const mt_reduced *r, mt_modal_options *options,
                            bool bounds, mt_err *err)
{
    MT_TRY(refresh_mass(a, err));
    mt_status rc = solve_and_judge(a, r, options, bounds, err);
    if (rc == MT_OK && options->judged && !a->modes.from_factor && mt_modal_rough(&a->modes)) {
        options->judged = false;
        rc = solve_and_judge(a, r, options, bounds, err);
    }
    if (rc == MT_OK && a->modes.n_held > 0 && a->recount) {
        options->n_rigid = -1;
        rc = solve_and_judge(a, r, options, bounds, err);
    }
    if (rc == MT_OK && is_short(&a->modes, options->modes.first)) {
        options->modes = (mt_modal_part){.first = 0};
        rc = solve_and_judge(a, r, options, bounds, err);
    }
    if (rc == MT_E_MASSLESS && a->modes.massless != NULL) {
        char text[DIRECTION_TEXT];
        mt_linear_name_direction(a->lin, a->modes.massless, text, sizeof text);
        return mt_fail(
            err, rc,
            "neither mass nor stiffness holds %s: give it a mass, a spring, or a joint", text);
    }
    MT_TRY(rc);
    if (a->modes.n_held > 0) {
        return mt_fail(err, MT_E_DOMAIN,
                       "stiffness holds %d of the %d directions that are counted as rigid-body "
                       "modes: the count of vibration modes does not hold at this design",
                       a->modes.n_held, a->n_rigid);
    }
    return MT_OK;
}

static bool same_part(const mt_modal_part *a, const mt_modal_part *b)
{
    return a->first == b->first && a->up_to == b->up_to;
}

static bool is_same_key(const struct mt_modes_key *had, const struct mt_modes_key *now)
{
    return had->stiffness_version == now->stiffness_version &&
           had->mass_version == now->mass_version && had->n_rigid == now->n_rigid &&
           same_part(&had->modes, &now->modes) && same_part(&had->shapes, &now->shapes) &&
           had->recount == now->recount && had->vectors == now->vectors &&
           had->accuracy == now->accuracy && had->bounds == now->bounds &&
           (had->check || !now->check);
}

static bool is_part(const mt_modal_part *part)
{
    return part->first > 0 || part->up_to > 0.0;
}

/*
 * Where the matrices alone are not enough, a few lowest modes are had for less than by the
 * factor of all of them: from their shapes, by energies.
 */
static bool is_judged(const mt_analysis *a, const mt_analysis_options *opt, int n)
{
    const bool few = is_part(&opt->modes) || is_part(&opt->shapes);
    return few && a->graded && opt->accuracy > 0.0 && !opt->bounds && n >= MT_MODAL_PART_ORDER;
}

/* The stage modes. Where it fails there are none: not those of another design. */
static mt_status run_modes(mt_analysis *a, const mt_analysis_options *opt, const double *inputs,
                           mt_err *err)
{
    mt_stages *const st = mt_linear_stages(a->lin);
    const mt_reduced r = mt_linear_reduced(a->lin);
    mt_modal_options options = mt_modal_options_default();
    options.n_rigid = a->n_rigid;
    options.modes = opt->modes;
    options.shapes = opt->shapes;
    /* where K is no sum of squares, shapes say what rounding leaves of its sign */
    options.accuracy = opt->accuracy;
    options.judged = is_judged(a, opt, r.n);
    options.vectors = opt->vectors || opt->gradient || r.g != NULL || options.judged;
    options.check = opt->check;
    const struct mt_modes_key key = {.stiffness_version = r.stiffness_version,
                                     .mass_version = r.mass_version,
                                     .n_rigid = a->n_rigid,
                                     .modes = opt->modes,
                                     .shapes = opt->shapes,
                                     .recount = a->recount,
                                     .vectors = options.vectors,
                                     .accuracy = opt->accuracy,
                                     .check = opt->check,
                                     .bounds = opt->bounds};
    st->valid[MT_STAGE_MODES] = st->valid[MT_STAGE_MODES] && is_same_key(&a->key, &key);
    if (!mt_stages_begin(st, MT_STAGE_MODES, st->none, inputs)) {
        mt_arena_rewind(&a->mem, a->after_modes);
        return MT_OK;
    }
    mt_arena_clear(&a->mem);
    a->modes = (mt_modes){0};
    MT_TRY(find_modes(a, &r, &options, opt->bounds, err));
    a->key = key;
    a->after_modes = mt_arena_get_mark(&a->mem);
    mt_stages_done(st, MT_STAGE_MODES, inputs);
    return MT_OK;
}

/* Where an update or a count fails, no modes remain. */
static mt_status update_and_solve_modes(mt_analysis *a, const double *inputs,
                                        const mt_analysis_options *opt, mt_err *err)
{
    MT_TRY(mt_linear_update(a->lin, inputs, opt->gradient, err));
    MT_TRY(mt_interrupt_check(a->sys->run->interrupt, err));
    return run_modes(a, opt, inputs, err);
}

mt_status mt_analysis_solve(mt_analysis *a, const double *inputs,
                            const mt_analysis_options *opt, mt_err *err)
{
    a->solves++;
    a->with_gradient = false;
    a->damping = NULL;
    const mt_status rc = update_and_solve_modes(a, inputs, opt, err);
    if (rc != MT_OK) {
        a->modes = (mt_modes){0};
        mt_linear_stages(a->lin)->valid[MT_STAGE_MODES] = false;
        return rc;
    }
    a->with_gradient = opt->gradient;
    if (opt->gradient) {
        const size_t n = (size_t)mt_linear_freedoms(a->lin);
        a->dky = mt_arena_f64(&a->mem, n, (size_t)a->sys->n_inputs);
        a->dmy = mt_arena_f64(&a->mem, n, (size_t)a->sys->n_inputs);
        a->slopes = mt_arena_f64(&a->mem, (size_t)a->modes.count, (size_t)a->sys->n_inputs);
        a->sloped = mt_arena_alloc(&a->mem, (size_t)a->modes.count, sizeof *a->sloped);
        MT_TRY(mt_arena_check(&a->mem, err));
    }
    return MT_OK;
}

/* Succeeds where there are derivatives of the mode at pos. */
static mt_status has_slopes(const mt_analysis *a, int pos, mt_err *err)
{
    if (!a->with_gradient) {
        return mt_fail(err, MT_E_INTERNAL, "%s", NO_GRADIENT);
    }
    return pos < a->modes.shaped ? MT_OK : mt_fail(err, MT_E_INTERNAL, NO_SHAPE, pos + 1);
}

mt_status mt_analysis_products(mt_analysis *a, int pos, mt_err *err)
{
    const ptrdiff_t n = mt_linear_freedoms(a->lin);
    MT_TRY(has_slopes(a, pos, err));
    MT_TRY(mt_interrupt_check(a->sys->run->interrupt, err));
    for (int p = 0; p < a->sys->n_inputs; p++) {
        MT_TRY(mt_linear_products(a->lin, p, 1, mt_modal_shape(&a->modes, pos),
                                  a->dky + (p * n), a->dmy + (p * n), err));
    }
    return MT_OK;
}

mt_status mt_analysis_dlambda_raw(mt_analysis *a, int pos, double *dlambda, mt_err *err)
{
    const size_t np = (size_t)a->sys->n_inputs;
    MT_TRY(has_slopes(a, pos, err));
    double *const slope = a->slopes + ((size_t)pos * np);
    if (!a->sloped[pos]) {
        MT_TRY(mt_interrupt_check(a->sys->run->interrupt, err));
        MT_TRY(mt_linear_slopes(a->lin, a->modes.lambda[pos], mt_modal_shape(&a->modes, pos),
                                slope, err));
    }
    a->sloped[pos] = true;
    memcpy(dlambda, slope, np * sizeof *dlambda);
    return MT_OK;
}

mt_status mt_analysis_dlambda(mt_analysis *a, int pos, double *dlambda, bool *repeated,
                              mt_err *err)
{
    int size = 1;
    MT_TRY(mt_analysis_dlambda_raw(a, pos, dlambda, err));
    (void)mt_modal_cluster(&a->modes, pos, &size);
    for (int p = 0; p < a->sys->n_inputs && size > 1; p++) {
        dlambda[p] = nan("");
    }
    if (repeated != NULL) {
        *repeated = size > 1;
    }
    return MT_OK;
}

mt_status mt_analysis_shape(mt_analysis *a, int pos, int ns, const int *channel, double *s,
                            double *ds, mt_err *err)
{
    const ptrdiff_t n = mt_linear_freedoms(a->lin);
    const int np = a->sys->n_inputs;
    const double *const y = mt_modal_shape(&a->modes, pos);
    if (y == NULL) {
        return mt_fail(err, MT_E_INTERNAL, NO_SHAPE, pos + 1);
    }
    MT_TRY(mt_linear_sense(a->lin, ns, channel, 1, y, s, err));
    if (ds == NULL || np == 0) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    double *const dy = mt_arena_f64(&a->mem, (size_t)n, (size_t)np);
    MT_TRY(mt_arena_check(&a->mem, err));
    MT_TRY(mt_analysis_products(a, pos, err));
    const mt_directions given = {.np = np, .dky = a->dky, .dmy = a->dmy};
    const mt_reduced r = mt_linear_reduced(a->lin);
    const mt_pencil pencil = {.n = r.n, .k = r.k, .m = r.m};
    if (a->modes.n_condensed == 0 && a->modes.shaped == a->modes.all) {
        MT_TRY(mt_modal_dvector_by_modes(&a->modes, pos, &given, dy, NULL, &a->mem, err));
    } else {
        MT_TRY(
            mt_modal_dvector(&pencil, a->modes.lambda[pos], y, &given, dy, NULL, &a->mem, err));
    }
    for (int p = 0; p < np; p++) {
        MT_TRY(mt_linear_sense_derivative(a->lin, p, ns, channel, 1, y, dy + (p * n),
                                          ds + ((ptrdiff_t)p * ns), err));
    }
    mt_arena_rewind(&a->mem, mark);
    return MT_OK;
}

/*
 *     dlambda/dp = y^T (dK - lambda dM) y,   f = sqrt(lambda) / (2 pi),
 *     df/dp = (dlambda/dp) / (8 pi^2 f).
 *
 * Where joints are redundant at the present value of a parameter only, frequencies jump there:
 * no derivative (mt_linear_independence).
 */

/* Derivatives of the cluster that begins at position first: its directional values,
 * ascending. */
static mt_status cluster_values(mt_analysis *a, int p, int first, int size, double *dlambda,
                                mt_err *err)
{
    const size_t n = (size_t)mt_linear_freedoms(a->lin);
    const size_t r = (size_t)size;
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    if (size == 1) { /* by all inputs at once, and kept */
        double *const all = mt_arena_f64(&a->mem, (size_t)a->sys->n_inputs, 1);
        MT_TRY(mt_arena_check(&a->mem, err));
        MT_TRY(mt_analysis_dlambda_raw(a, first, all, err));
        *dlambda = all[p];
        mt_arena_rewind(&a->mem, mark);
        return MT_OK;
    }
    double *const dky = mt_arena_f64(&a->mem, n, r);
    double *const dmy = mt_arena_f64(&a->mem, n, r);
    double *const matrix = mt_arena_f64(&a->mem, r, r);
    MT_TRY(mt_arena_check(&a->mem, err));
    MT_TRY(
        mt_linear_products(a->lin, p, size, mt_modal_shape(&a->modes, first), dky, dmy, err));
    MT_TRY(mt_modal_dcluster(&a->modes, first, size, dky, dmy, matrix, &a->mem, err));
    MT_TRY(mt_eig_sym(size, matrix, dlambda, false, &a->mem, err));
    mt_arena_rewind(&a->mem, mark);
    return MT_OK;
}

mt_status mt_analysis_sensitivity(mt_analysis *a, int p, int n, const int *position,
                                  mt_arena *mem, double *hz_per_unit, mt_independence *why,
                                  mt_err *err)
{
    const mt_modes *const modes = &a->modes;
    double *const values = mt_arena_f64(mem, (size_t)modes->count, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_linear_independence(a->lin, p, mem, why, err));
    /* where a mode is blocked, those above it are counted again */
    bool gone = why->opens;
    for (int i = 0; i < n;) {
        int size = 1;
        const int first = mt_modal_cluster(modes, position[i], &size);
        MT_TRY(cluster_values(a, p, first, size, values, err));
        for (int j = first; j < first + size && why->blocks && !gone; j++) {
            MT_TRY(mt_linear_blocked(a->lin, p, 1, mt_modal_shape(modes, j), &gone, err));
        }
        for (int j = 0; j < size && i < n; j++, i++) {
            const double hz = mt_modal_hz(modes, position[i]);
            hz_per_unit[i] = gone ? nan("") : mt_modal_hz_slope(values[j], hz);
        }
    }
    return MT_OK;
}
