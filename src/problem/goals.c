/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Goals of one mode, and of an expression. With q of a kind:
 *
 * "frequency": the frequency of a mode [Hz], its rows in ln q,
 *     d ln q / dt = lambda' / (2 lambda) dx/dt
 * "damping": the damping ratio of a complex mode, zeta = -sigma/|s| of s = sigma + i omega,
 *     dzeta = omega (sigma domega - omega dsigma) / |s|^3
 *   An index counts the oscillating motions by |s|; a name means the one that has most of the
 *   undamped mode in its shape.
 * "limit": an expression of parameters; q = its value.
 * "shape": residuals of the unit shape at the sensors against that of a reference,
 *     r = sqrt(w) (sign u - s_ref),   u = s / |s|,   sign = sign(s . s_ref)
 *     dr = sqrt(w) sign (ds - u (u . ds)) / |s|
 * "mac": MAC of the mode's shape at the sensors with that of a reference.
 * "energy": a share of the mode's energy [%]; of the modes of one frequency their sum. Where
 *   the mode with most of it is meant, q is the largest over all modes, with a kink where two
 *   have as much.
 *
 * Goals of two modes, at f and f_of:
 * "ratio": f / f_of, its rows in the logarithm,
 *     d ln q / dt = d ln f / dt - d ln f_of / dt
 * "apart": with g the higher and s the lower frequency,
 *     q = 100 (g / s - 1) or g - s
 *   Indices are in order of frequency, names in any. Where the two meet, q has a kink:
 *   the gap to first order along v is that of eigenvalues of
 *     B(v) = sum_j v_j Phi' (dK/dx_j - lambda dM/dx_j) Phi,   Phi: the shapes that meet
 *   and the slope is that of the vectors of B(v) for the v which spreads them most (the largest
 *   singular value of v -> B(v) less its mean): a limit of slopes nearby.
 */

#include "problem/goals.h"

#include <math.h>
#include <string.h>

#include "analysis/damping.h"
#include "analysis/energy_share.h"
#include "analysis/tracking.h"
#include "linalg/eig_small.h"
#include "problem/configuration.h"
#include "problem/frequency.h"
#include "problem/requirement.h"
#include "prove/box.h"

static const double PERCENT = 100.0;

/* Index of the reference's mode that the requirement names; by default its own index. */
static int reference_mode(const mt_problem *p, const mt_requirement *d)
{
    const mt_goal *const g = d->goal;
    const int own = d->mode > 0 ? d->mode : p->study->model->modes[g->mode.named].index;
    return g->reference_mode > 0 ? g->reference_mode : own;
}

/* Finds the reference's shape. */
static mt_status compile_reference_shape(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_system *const sys = p->views[d->view].original->sys;
    return d->goal->reference_name.s == NULL
               ? MT_OK
               : mt_reference_shape_init(p->references, d->goal->reference,
                                         reference_mode(p, d), sys, d->goal->length, &p->mem,
                                         &d->shape, err);
}

/* Shape of the mode at pos at the requirement's sensors, in w->shape (and w->dshape), and its
 * norm. Fails: MT_E_DOMAIN where the mode does not move there. */
static mt_status sense_shape(mt_workspace *w, const mt_requirement *d, int pos,
                             bool with_gradient, double *norm, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    MT_TRY(mt_analysis_shape(a, pos, d->shape.ns, d->shape.channel, w->shape,
                             with_gradient ? w->dshape : NULL, err));
    mt_reference_scale(&d->shape, 1, w->shape);
    mt_reference_scale(&d->shape, with_gradient ? w->p->n : 0, w->dshape);
    *norm = mt_norm2(d->shape.ns, w->shape);
    if (!(*norm > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\": the mode does not move at the sensors of "
                       "reference \"%s\"",
                       mt_analysis_configuration(a), d->shape.reference);
    }
    return MT_OK;
}

/* Slope of the logarithm of a frequency; of a named mode in a cluster by the vector of its
 * own. */
static mt_status dln_of(mt_workspace *w, int at, int named, int pos, double floor_hz,
                        double *out, mt_err *err)
{
    const mt_configuration_work *const view = &w->views[at];
    mt_analysis *const a = view->analysis;
    int size = 1;
    const double lambda = pos < 0 ? 0.0 : a->modes.lambda[pos];
    bool own = pos >= 0 && named >= 0 && lambda > mt_enclosure_lambda(floor_hz);
    if (own) {
        (void)mt_modal_cluster(&a->modes, pos, &size);
        own = size > 1;
    }
    if (own) {
        MT_TRY(mt_track_dlambda(a, view->of->shape[named], pos, out, &own, err));
    }
    for (int i = 0; i < w->p->n && own; i++) {
        out[i] *= mt_workspace_dx_dt(w, i) / (2.0 * lambda);
    }
    return own ? MT_OK : mt_problem_dln_frequency(w, a, pos, floor_hz, out, err);
}

/* The reference's frequency is the target. */
static mt_status compile_frequency(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_goal *const g = d->goal;
    if (g->reference_name.s != NULL) {
        MT_TRY(mt_reference_frequency_init(p->references, g->reference, reference_mode(p, d),
                                           &d->shape, err));
        d->equals = d->shape.frequency_hz;
    }
    d->floor_hz = MT_FREQUENCY_FLOOR * fmin(fmin(d->equals, g->at_least), g->at_most);
    return MT_OK;
}

static mt_status evaluate_frequency(mt_workspace *w, const mt_requirement *d, int pos,
                                    double *q, double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    *q = pos < 0 ? HUGE_VAL : mt_modal_hz(&a->modes, pos);
    if (!(*q >= 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": the mode has no frequency",
                       mt_analysis_configuration(a));
    }
    return slope == NULL ? MT_OK : dln_of(w, d->view, d->named, pos, d->floor_hz, slope, err);
}

const mt_goal_ops mt_goal_frequency = {.quantity = MT_QUANTITY_FREQUENCY,
                                       .compile = compile_frequency,
                                       .value = evaluate_frequency,
                                       .number = "frequency",
                                       .equals = "at"};

/* The frequency of the other mode of two. */
static mt_status find_other(mt_workspace *w, const mt_requirement *d, int *pos, double *hz,
                            mt_err *err)
{
    const mt_requirement_mode *const of = &d->of;
    mt_configuration_work *const view = &w->views[of->view];
    MT_TRY(mt_configuration_position(w, view, of->mode, of->named, pos, err));
    *hz = *pos < 0 ? nan("") : mt_modal_hz(&view->analysis->modes, *pos);
    return *hz >= 0.0 ? MT_OK
                      : mt_fail(err, MT_E_DOMAIN,
                                "configuration \"%s\" has no such vibration mode to compare "
                                "with here",
                                mt_analysis_configuration(view->analysis));
}

/* Adds factor times the slope of the logarithm of the other mode's frequency. */
static mt_status add_other_slope(mt_workspace *w, const mt_requirement *d, int pos,
                                 double floor_hz, double factor, double *slope, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&w->mem);
    double *const other = mt_arena_f64(&w->mem, (size_t)w->p->n, 1);
    mt_status rc = mt_arena_check(&w->mem, err);
    rc = rc == MT_OK ? dln_of(w, d->of.view, d->of.named, pos, floor_hz, other, err) : rc;
    for (int i = 0; i < w->p->n && rc == MT_OK; i++) {
        slope[i] += factor * other[i];
    }
    mt_arena_rewind(&w->mem, mark);
    return rc;
}

static mt_status compile_ratio(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_goal *const g = d->goal;
    (void)p;
    (void)err;
    d->floor_hz = MT_FREQUENCY_FLOOR * fmin(fmin(g->equals, g->at_least), g->at_most);
    return MT_OK;
}

/* The row continues ln q below a floor of q by a tangent in q^2 (frequency.h): so does its
 * slope. */
static mt_status evaluate_ratio(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                double *slope, mt_err *err)
{
    const mt_analysis *const a = w->views[d->view].analysis;
    int pos_of = -1;
    double of = nan("");
    MT_TRY(find_other(w, d, &pos_of, &of, err));
    *q = mt_modal_hz(&a->modes, pos) / of;
    if (!(of > 0.0) || !isfinite(*q)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "the ratio has no value: a mode of configuration \"%s\" is at 0 Hz",
                       mt_analysis_configuration(w->views[d->of.view].analysis));
    }
    if (slope == NULL) {
        return MT_OK;
    }
    const double part = fmin(*q / d->floor_hz, 1.0);
    MT_TRY(dln_of(w, d->view, d->named, pos, d->floor_hz * of, slope, err));
    return add_other_slope(w, d, pos_of, 0.0, -part * part, slope, err);
}

static const char *other_text(const mt_requirement *d, mt_arena *mem)
{
    return d->of.mode > 0 ? mt_arena_printf(mem, "mode %d", d->of.mode)
                          : mt_arena_printf(mem, "\"%s\"", d->of.asked->mode_name.s);
}

static const char *ratio_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    const char *const other = other_text(d, mem);
    const mt_name where = d->goal->of.configuration_name;
    return where.s == NULL ? mt_arena_printf(mem, "%s: ratio to %s", what, other)
                           : mt_arena_printf(mem, "%s: ratio to %s %s", what, where.s, other);
}

const mt_goal_ops mt_goal_ratio = {.quantity = MT_QUANTITY_FREQUENCIES,
                                   .compile = compile_ratio,
                                   .value = evaluate_ratio,
                                   .subject = ratio_subject,
                                   .number = "ratio of frequencies",
                                   .equals = "at"};

/* Modes that meet, at most: of more no direction is told. */
enum { MEETING_MOST = 5, MEETING_ENTRIES = MEETING_MOST * MEETING_MOST };

/* b[r x r x n]: Phi' (dK/dx_j - lambda dM/dx_j) Phi for every variable, by the polarisation of
 * quadratic forms, in the coordinates t, less its mean over the diagonal. */
static mt_status meeting_slopes(mt_workspace *w, mt_analysis *a, int first, int r, double *b,
                                mt_arena *mem, mt_err *err)
{
    const int n = w->p->n;
    const size_t freedoms = (size_t)mt_linear_freedoms(a->lin);
    double *const sum = mt_arena_f64(mem, freedoms, 1);
    double *const form = mt_arena_f64(mem, (size_t)n, 1);
    const double lambda = a->modes.lambda[first];
    MT_TRY(mt_arena_check(mem, err));
    for (int pair = 0; pair < r * r; pair++) {
        const int i = pair % r;
        const int k = pair / r;
        const double *const x = mt_modal_shape(&a->modes, first + i);
        const double *const y = mt_modal_shape(&a->modes, first + k);
        for (size_t m = 0; m < freedoms; m++) {
            sum[m] = i == k ? x[m] : x[m] + y[m];
        }
        MT_TRY(mt_linear_slopes(a->lin, lambda, sum, form, err));
        for (int j = 0; j < n; j++) {
            b[pair + (j * r * r)] = mt_workspace_dx_dt(w, j) * form[j];
        }
    }
    for (int j = 0; j < n; j++) {
        double *const own = b + ((ptrdiff_t)j * r * r);
        double mean = 0.0;
        for (int pair = 0; pair < r * r; pair++) {
            const int i = pair % r;
            const int k = pair / r;
            own[pair] -= i == k ? 0.0 : own[i + (i * r)] + own[k + (k * r)];
            own[pair] *= i == k ? 1.0 : 0.5;
        }
        for (int i = 0; i < r; i++) {
            mean += own[i + (i * r)] / (double)r;
        }
        for (int i = 0; i < r; i++) {
            own[i + (i * r)] -= mean;
        }
    }
    return MT_OK;
}

/* form[r x r], scaled by its largest entry, to eigenvectors of ascending eigenvalues; false: it
 * is 0, or there are none. */
static bool small_vectors(int n, double *form)
{
    double value[MEETING_ENTRIES];
    double most = 0.0;
    for (int i = 0; i < n * n; i++) {
        most = fmax(most, fabs(form[i]));
    }
    for (int i = 0; i < n * n; i++) {
        form[i] /= most > 0.0 ? most : 1.0;
    }
    return most > 0.0 && isfinite(most) && mt_eig_small(n, form, value, true);
}

/* vector[r x r]: vectors of B(v) along the direction that spreads modes most; false: nothing
 * spreads them. */
static bool find_spread(int n, int r, const double *b, double *vector)
{
    const int entries = r * r;
    double gram[MEETING_ENTRIES * MEETING_ENTRIES] = {0.0};
    int lead = 0;
    for (int i = 0; i < entries * entries; i++) {
        for (int j = 0; j < n; j++) {
            gram[i] += b[(i % entries) + (j * entries)] * b[(i / entries) + (j * entries)];
        }
    }
    if (!small_vectors(entries, gram)) {
        return false;
    }
    /* B(v) = sum_j v_j B_j with v_j = B_j . z is the largest eigenvalue times z itself */
    const double *const z = gram + ((ptrdiff_t)(entries - 1) * entries);
    for (int i = 1; i < entries; i++) {
        lead = fabs(z[i]) > fabs(z[lead]) ? i : lead;
    }
    for (int i = 0; i < entries; i++) {
        vector[i] = z[lead] < 0.0 ? -z[i] : z[i];
    }
    return small_vectors(r, vector);
}

/* c' B c */
static double form_of(int r, const double *b, const double *c)
{
    double sum = 0.0;
    for (int i = 0; i < r * r; i++) {
        sum += c[i % r] * b[i] * c[i / r];
    }
    return sum;
}

/* Slope of ln(f_high / f_low) of two modes that meet, at positions among all modes. */
static mt_status meeting_gap(mt_workspace *w, mt_analysis *a, int low, int high, double *slope,
                             mt_err *err)
{
    const int n = w->p->n;
    int r = 1;
    const int first = mt_modal_cluster(&a->modes, low, &r);
    const double lambda = a->modes.lambda[first];
    double vector[MEETING_ENTRIES];
    memset(slope, 0, (size_t)n * sizeof *slope);
    if (r > MEETING_MOST || !(lambda > 0.0)) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&w->mem);
    double *const b = mt_arena_f64(&w->mem, (size_t)r * (size_t)r, (size_t)n);
    mt_status rc = mt_arena_check(&w->mem, err);
    rc = rc == MT_OK ? meeting_slopes(w, a, first, r, b, &w->mem, err) : rc;
    if (rc == MT_OK && find_spread(n, r, b, vector)) {
        const double *const over = vector + ((ptrdiff_t)(high - first) * r);
        const double *const under = vector + ((ptrdiff_t)(low - first) * r);
        for (int j = 0; j < n; j++) {
            const double *const own = b + ((ptrdiff_t)j * r * r);
            slope[j] = (form_of(r, own, over) - form_of(r, own, under)) / (2.0 * lambda);
        }
    }
    mt_arena_rewind(&w->mem, mark);
    return rc;
}

/* Two modes of one configuration, by their positions among all modes and their frequencies. */
typedef struct two_modes {
    int at[2]; /* lower, higher */
    double hz[2];
    bool swapped; /* the first named of them is the lower */
} two_modes;

/* slope[n]: factor[1] d ln f_higher - factor[0] d ln f_lower. */
static mt_status apart_slope(mt_workspace *w, const mt_requirement *d, const two_modes *m,
                             const double *factor, double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const double floor_hz = MT_FREQUENCY_FLOOR * m->hz[1];
    int size = 1;
    const int first = mt_modal_cluster(&a->modes, m->at[0], &size);
    if (d->named < 0 && d->of.named < 0 && m->at[1] < first + size) {
        MT_TRY(meeting_gap(w, a, m->at[0], m->at[1], slope, err));
        for (int i = 0; i < w->p->n; i++) {
            slope[i] *= factor[1];
        }
        return MT_OK;
    }
    MT_TRY(dln_of(w, d->view, d->named, m->at[m->swapped ? 0 : 1], floor_hz, slope, err));
    for (int i = 0; i < w->p->n; i++) {
        slope[i] *= m->swapped ? -factor[0] : factor[1];
    }
    return add_other_slope(w, d, m->at[m->swapped ? 1 : 0], floor_hz,
                           m->swapped ? factor[1] : -factor[0], slope, err);
}

/* With factors of d ln f: of 100 (g / s - 1) both are 100 g / s, of g - s they are s and g. */
static mt_status evaluate_apart(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                double *slope, mt_err *err)
{
    const mt_analysis *const a = w->views[d->view].analysis;
    int pos_of = -1;
    double of = nan("");
    MT_TRY(find_other(w, d, &pos_of, &of, err));
    const double own = mt_modal_hz(&a->modes, pos);
    const bool swapped = (d->named >= 0 || d->of.named >= 0) && own < of;
    const two_modes m = {.at = {swapped ? pos : pos_of, swapped ? pos_of : pos},
                         .hz = {swapped ? own : of, swapped ? of : own},
                         .swapped = swapped};
    const bool in_hz = MT_HAS(d->goal->at_least_hz);
    const double part = m.hz[0] > 0.0 ? m.hz[1] / m.hz[0] : m.hz[1] > 0.0 ? HUGE_VAL : 1.0;
    *q = in_hz ? m.hz[1] - m.hz[0] : PERCENT * (part - 1.0);
    if (!(*q >= 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": a mode has no frequency",
                       mt_analysis_configuration(a));
    }
    if (slope == NULL) {
        return MT_OK;
    }
    if (isinf(part) && !in_hz) {
        memset(slope, 0, (size_t)w->p->n * sizeof *slope);
        return MT_OK;
    }
    const double factor[] = {in_hz ? m.hz[0] : PERCENT * part,
                             in_hz ? m.hz[1] : PERCENT * part};
    return apart_slope(w, d, &m, factor, slope, err);
}

static const char *apart_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    return mt_arena_printf(mem, "%s: distance from %s", what, other_text(d, mem));
}

const mt_goal_ops mt_goal_apart = {.quantity = MT_QUANTITY_FREQUENCIES,
                                   .value = evaluate_apart,
                                   .subject = apart_subject,
                                   .number = "distance",
                                   .equals = "at"};

static mt_status find_damped_mode(mt_workspace *w, const mt_requirement *d, int pos, int *at,
                                  mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_damped_modes *damped = NULL;
    MT_TRY(mt_analysis_damped(a, &damped, err));
    *at = mt_damped_oscillating(damped, d->mode > 0 ? d->mode : 1);
    if (d->mode == 0 && *at >= 0) {
        MT_TRY(mt_analysis_damped_of(a, pos, at, err));
    }
    return *at >= 0 ? MT_OK
                    : mt_fail(err, MT_E_DOMAIN,
                              "configuration \"%s\" has no such motion that oscillates: it is "
                              "overdamped, or another is unstable",
                              mt_analysis_configuration(a));
}

static mt_status evaluate_damping(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                  double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_damped_modes *damped = NULL;
    bool repeated = false;
    int at = -1;
    MT_TRY(find_damped_mode(w, d, pos, &at, err));
    MT_TRY(mt_analysis_damped(a, &damped, err));
    *q = mt_damped_ratio(damped, at);
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_analysis_dpole(a, at, slope, w->work, &repeated, err));
    if (repeated) {
        return mt_fail(err, MT_E_SINGULAR,
                       "configuration \"%s\": two motions have one root, which has no slope",
                       mt_analysis_configuration(a));
    }
    const double re = damped->re[at];
    const double im = damped->im[at];
    const double size = hypot(re, im);
    for (int k = 0; k < w->p->n; k++) {
        const double turn = ((re / size) * w->work[k]) - ((im / size) * slope[k]);
        slope[k] = mt_workspace_dx_dt(w, k) * (im / size) * turn / size;
    }
    return MT_OK;
}

static const char *damping_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    (void)d;
    return mt_arena_printf(mem, "%s: damping ratio", what);
}

const mt_goal_ops mt_goal_damping = {.quantity = MT_QUANTITY_OTHER,
                                     .needs_vectors = true,
                                     .value = evaluate_damping,
                                     .subject = damping_subject,
                                     .number = "damping ratio",
                                     .equals = "at"};

static mt_status evaluate_limit(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                double *slope, mt_err *err)
{
    (void)pos;
    (void)err;
    *q = w->value[d->node];
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        slope[k] = mt_workspace_dx_dt(w, k) * w->grad[((ptrdiff_t)d->node * w->p->n) + k];
    }
    return MT_OK;
}

const mt_goal_ops mt_goal_limit = {
    .quantity = MT_QUANTITY_EXPRESSION, .value = evaluate_limit, .equals = "equal to"};

static mt_status compile_shape(mt_problem *p, mt_requirement *d, mt_err *err)
{
    MT_TRY(compile_reference_shape(p, d, err));
    d->n_rows = d->shape.ns;
    return MT_OK;
}

static mt_status residuals(mt_workspace *w, const mt_requirement *d, int pos,
                           bool with_gradient, mt_err *err)
{
    const int ns = d->shape.ns;
    const double weight = sqrt(mt_requirement_weight(w, d));
    double *const u = w->shape;
    double norm = 0.0;
    MT_TRY(sense_shape(w, d, pos, with_gradient, &norm, err));
    const double sign = mt_dot(ns, u, d->shape.shape) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < ns; i++) {
        u[i] /= norm;
        w->r[mt_requirement_row(w->c, d) + i] = weight * ((sign * u[i]) - d->shape.shape[i]);
    }
    for (int k = 0; k < w->p->n && with_gradient; k++) {
        const double *const ds = w->dshape + ((ptrdiff_t)k * ns);
        const double along = mt_dot(ns, u, ds);
        const double factor = weight * sign * mt_workspace_dx_dt(w, k) / norm;
        for (int i = 0; i < ns; i++) {
            w->dr[mt_requirement_row(w->c, d) + i + ((ptrdiff_t)k * w->c->rows.res.n)] =
                factor * (ds[i] - (along * u[i]));
        }
    }
    return MT_OK;
}

static const char *shape_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    return mt_arena_printf(mem, "%s shaped as mode %d of \"%s\"", what, d->shape.mode,
                           d->shape.reference);
}

const mt_goal_ops mt_goal_shape = {.quantity = MT_QUANTITY_OTHER,
                                   .needs_vectors = true,
                                   .compile = compile_shape,
                                   .residuals = residuals,
                                   .subject = shape_subject,
                                   .equals = "at"};

static mt_status evaluate_mac(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                              double *slope, mt_err *err)
{
    const int ns = d->shape.ns;
    double norm = 0.0;
    MT_TRY(sense_shape(w, d, pos, slope != NULL, &norm, err));
    mt_mac_matrix(ns, 1, w->shape, 1, d->shape.shape, q);
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        const double *const ds = w->dshape + ((ptrdiff_t)k * ns);
        slope[k] =
            mt_workspace_dx_dt(w, k) * mt_mac_derivative(ns, w->shape, ds, d->shape.shape);
    }
    return MT_OK;
}

static const char *mac_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    return mt_arena_printf(mem, "%s: MAC with mode %d of \"%s\"", what, d->shape.mode,
                           d->shape.reference);
}

const mt_goal_ops mt_goal_mac = {.quantity = MT_QUANTITY_OTHER,
                                 .needs_vectors = true,
                                 .compile = compile_reference_shape,
                                 .value = evaluate_mac,
                                 .subject = mac_subject,
                                 .number = "MAC",
                                 .equals = "at"};

/* What is meant of the goal's body or spring: its direction or component; MT_ABSENT: all. */
static int energy_direction(const mt_requirement *d)
{
    const mt_energy_goal *const e = d->goal->energy;
    return e->body_name.s == NULL ? e->component
           : e->n_directions > 0  ? e->directions[d->direction]
                                  : MT_ABSENT;
}

static mt_status compile_energy(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_energy_goal *const e = d->goal->energy;
    const mt_system *const sys = p->views[d->view].original->sys;
    const bool moves = e->body_name.s != NULL;
    mt_energy_owners all;
    mt_energy_part *const part = mt_arena_alloc(&p->mem, 1, sizeof *part);
    MT_TRY(mt_arena_check(&p->mem, err));
    MT_TRY(mt_energy_owners_find(sys, &p->mem, &all, err));
    const mt_energy_owner *const list = moves ? all.bodies : all.springs;
    const char *const name = moves ? e->body_name.s : e->spring_name.s;
    const int at = mt_energy_owner_named(moves ? all.n_bodies : all.n_springs, list, name);
    if (at == MT_ABSENT) {
        return mt_fail(err, MT_E_INPUT,
                       "configuration \"%s\": \"%s\" has no stiffness, and so no strain energy",
                       mt_analysis_configuration(p->views[d->view].original), name);
    }
    d->energy = part;
    return mt_energy_part_init(sys, moves ? MT_ENERGY_MOTION : MT_ENERGY_STRAIN, &list[at],
                               energy_direction(d), &e->about, &p->mem, part, err);
}

static mt_status evaluate_energy(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                 double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    int at = pos;
    if (at < 0) {
        MT_TRY(mt_analysis_most_energy(a, d->energy, &at, err));
    }
    if (at < 0) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" has no vibration mode here",
                       mt_analysis_configuration(a));
    }
    MT_TRY(mt_analysis_energy_share(a, at, d->energy, q, slope, err));
    *q *= 100.0;
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        slope[k] *= 100.0 * mt_workspace_dx_dt(w, k);
    }
    return MT_OK;
}

static const char *energy_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    const mt_energy_goal *const e = d->goal->energy;
    const int direction = energy_direction(d);
    const bool moves = e->body_name.s != NULL;
    const char *const along =
        direction < 0 ? "" : mt_arena_printf(mem, " in %s", mt_energy_directions[direction]);
    const char *const about =
        e->point_name.s == NULL ? "" : mt_arena_printf(mem, " about \"%s\"", e->point_name.s);
    const char *const axes =
        e->about.axes == MT_ENERGY_AXES_PRINCIPAL ? " of the principal axes"
        : e->about.axes == MT_ENERGY_AXES_GLOBAL  ? ""
                                                  : " of the torque roll axis";
    return along == NULL || about == NULL
               ? NULL
               : mt_arena_printf(mem, "%s: %s energy of \"%s\"%s%s%s%s", what,
                                 moves ? "kinetic" : "strain",
                                 moves ? e->body_name.s : e->spring_name.s, along, axes, about,
                                 e->most ? ", in the mode with most of it" : "");
}

const mt_goal_ops mt_goal_energy = {.quantity = MT_QUANTITY_OTHER,
                                    .needs_vectors = true,
                                    .compile = compile_energy,
                                    .value = evaluate_energy,
                                    .subject = energy_subject,
                                    .number = "share of energy",
                                    .equals = "at"};

#define OPS(id, name, ...) &mt_goal_##name,
static const mt_goal_ops *const OPERATIONS[] = {MT_GOAL_LIST(OPS)};

const mt_goal_ops *mt_goal_ops_of(mt_goal_type type)
{
    return OPERATIONS[type];
}
