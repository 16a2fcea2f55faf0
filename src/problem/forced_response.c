/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Of H = sum_k r_k / (i w - s_k) + polynomial the largest value over a range, the RMS and the
 * peaks of tones have slopes by the envelope theorem: at the frequency where |H| is the largest
 *     d max|H| = Re(conj(H)/|H| dH),       d RMS = Re integral conj(H) dH G df / RMS,
 * a sum over frequencies of weights times dH, which adjoints give.
 */

#include "problem/forced_response.h"

#include <math.h>
#include <string.h>

#include "analysis/damping.h"
#include "problem/configuration.h"
#include "problem/frequency.h"
#include "problem/goals.h"
#include "vibration/profile_response.h"

static const double TWO_PI = 6.283185307179586476925;

/* Largest |H| over a range. */
typedef struct peak_in_range {
    mt_sine_peak at;
    double by_omega; /* d|H|/dw at that frequency */
    bool proven;
} peak_in_range;

/*
 * Without a sum over poles: adaptive curves (response/curve.h) and quadrature,
 *     RMS^2 = integral |H|^2 G df = sum_j |H(w_j)|^2 g_j,
 * the nodes w_j those of Gauss's rule for ln w between any two neighbours among the points of a
 * curve and the breakpoints of G. The largest value has no bound: its excess is NaN. Memory is
 * r->mem.
 */
enum { CURVE_POINTS = 33, NODES = 4 };
static const double NODE[NODES] = {-0.8611363115940525752, -0.3399810435848562648,
                                   0.3399810435848562648, 0.8611363115940525752};
static const double WEIGHT[NODES] = {0.3478548451374538574, 0.6521451548625461426,
                                     0.6521451548625461426, 0.3478548451374538574};

/* The value at its omega, with all that belongs to it. */
static mt_status evaluate_sine_peak(mt_response *r, mt_sine_peak *out, double *by_omega,
                                    mt_err *err)
{
    double complex h = 0.0;
    double complex dh = 0.0;
    const mt_sample at = {.h = &h, .dh = &dh};
    MT_TRY(mt_transfer_at(r->chosen, out->omega, &at, &r->mem, err));
    if (!isfinite(creal(h))) {
        *out = (mt_sine_peak){.end = MT_FORCED_INFINITE, .pole = -1, .value = nan("")};
        return MT_OK;
    }
    out->value = cabs(h);
    out->direction = out->value > 0.0 ? conj(h) / out->value : 0.0;
    out->excess = nan("");
    *by_omega = creal(mt_frf_times(out->direction, dh));
    return MT_OK;
}

static mt_status trace(mt_response *r, double lower, double upper, mt_curve *out, mt_err *err)
{
    const mt_curve_options opt = {
        .from = lower, .to = upper, .points = CURVE_POINTS, .log = true};
    return mt_response_curve(r, &opt, out, err);
}

/* An undamped resonance within the curve, which its points need not hit; NULL: none. */
static const mt_extreme *resonance(const mt_curve *curve)
{
    for (int i = 0; i < curve->n_extremes; i++) {
        if (curve->extremes[i].infinite) {
            return &curve->extremes[i];
        }
    }
    return NULL;
}

static mt_status sampled_find(mt_response *r, double lower, double upper, mt_sine_peak *out,
                              double *by_omega, mt_err *err)
{
    mt_curve curve = {.n = 0};
    double most = -1.0;
    *out = (mt_sine_peak){.end = MT_FORCED_FINITE, .pole = -1, .omega = lower};
    *by_omega = 0.0;
    if (r->growing >= 0) {
        *out = (mt_sine_peak){.end = MT_FORCED_UNSTABLE, .pole = r->growing, .value = nan("")};
        return MT_OK;
    }
    if (lower < upper) {
        MT_TRY(trace(r, lower, upper, &curve, err));
    }
    if (resonance(&curve) != NULL) {
        *out = (mt_sine_peak){.end = MT_FORCED_INFINITE, .pole = -1, .value = nan("")};
        return MT_OK;
    }
    for (int i = 0; i < curve.n; i++) {
        const double size = cabs(curve.h[i]);
        if (!(size <= most)) {
            most = size;
            out->omega = curve.w[i];
        }
    }
    out->at_edge = lower < upper && (out->omega == lower || out->omega == upper);
    return evaluate_sine_peak(r, out, by_omega, err);
}

/* Appends the nodes of one random part to the n present (NULL: counts them only): g in
 * `weight`. */
static int add_nodes(const mt_curve *curve, const mt_psd *g, mt_spectral_nodes *to, int n)
{
    int i = 0;
    for (int k = 0; k + 1 < g->n; k++) {
        double from = TWO_PI * g->hz[k];
        const double end = TWO_PI * g->hz[k + 1];
        while (from < end) {
            while (i < curve->n && curve->w[i] <= from) {
                i++;
            }
            const double to_w = i < curve->n ? fmin(curve->w[i], end) : end;
            const double half = 0.5 * log(to_w / from);
            for (int j = 0; j < NODES && to != NULL; j++) {
                const double w = from * exp(half * (1.0 + NODE[j]));
                const double level =
                    g->level[k] * pow(w / (TWO_PI * g->hz[k]), mt_psd_exponent(g, k));
                to->omega[n + j] = w;
                to->weight[n + j] = half * WEIGHT[j] * w * level / TWO_PI;
            }
            n += NODES;
            from = to_w;
        }
    }
    return n;
}

/* All nodes of the random parts, g_j in their weights. */
static mt_status all_nodes(mt_response *r, const mt_vibration *v, mt_spectral_nodes *out,
                           mt_err *err)
{
    mt_curve *const curves = mt_arena_alloc(&r->mem, (size_t)v->n_random, sizeof *curves);
    int n = 0;
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int i = 0; i < v->n_random; i++) {
        const mt_psd *const g = &v->random[i].psd;
        MT_TRY(trace(r, TWO_PI * g->hz[0], TWO_PI * g->hz[g->n - 1], &curves[i], err));
        n = add_nodes(&curves[i], g, NULL, n);
    }
    *out =
        (mt_spectral_nodes){.n = n,
                            .omega = mt_arena_f64(&r->mem, (size_t)n, 1),
                            .weight = mt_arena_alloc(&r->mem, (size_t)n, sizeof *out->weight)};
    MT_TRY(mt_arena_check(&r->mem, err));
    n = 0;
    for (int i = 0; i < v->n_random; i++) {
        n = add_nodes(&curves[i], &v->random[i].psd, out, n);
    }
    return MT_OK;
}

static mt_status sampled_respond(mt_response *r, const mt_vibration *v,
                                 mt_vibration_response *out, mt_err *err)
{
    mt_profiled profiled;
    MT_TRY(mt_profiled_find(r, v, &profiled, err));
    *out = profiled.answers[0];
    for (int i = 0; i < out->n_tones && out->end == MT_FORCED_FINITE; i++) {
        double ignored = 0.0;
        MT_TRY(evaluate_sine_peak(r, &out->tones[i], &ignored, err)); /* its direction */
    }
    return MT_OK;
}

static mt_status sampled_nodes(mt_response *r, const mt_vibration *v,
                               const mt_vibration_response *of, double by_rms, double by_sine,
                               mt_spectral_nodes *out, mt_err *err)
{
    mt_spectral_nodes tones;
    mt_spectral_nodes random = {.n = 0};
    MT_TRY(mt_vibration_respond_tone_nodes(v, of, by_sine, &r->mem, &tones, err));
    if (by_rms != 0.0 && of->rms > 0.0) {
        MT_TRY(all_nodes(r, v, &random, err));
    }
    out->n = tones.n + random.n;
    out->omega = mt_arena_f64(&r->mem, (size_t)out->n, 1);
    out->weight = mt_arena_alloc(&r->mem, (size_t)out->n, sizeof *out->weight);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int i = 0; i < tones.n; i++) {
        out->omega[i] = tones.omega[i];
        out->weight[i] = tones.weight[i];
    }
    for (int j = 0; j < random.n; j++) {
        double complex h = 0.0;
        const mt_sample at = {.h = &h};
        MT_TRY(mt_transfer_at(r->chosen, random.omega[j], &at, &r->mem, err));
        out->omega[tones.n + j] = random.omega[j];
        out->weight[tones.n + j] = by_rms * creal(random.weight[j]) * conj(h) / of->rms;
    }
    return MT_OK;
}

void mt_forced_response_close(mt_configuration_work *view)
{
    for (int i = 0; i < view->n_forced_response; i++) {
        if (view->forced_response[i].open) {
            mt_response_free(&view->forced_response[i].r);
            view->forced_response[i].open = false;
        }
    }
}

/* Index of the goal's port pair in the configuration's list; added where missing. */
static int place_of(mt_configuration_problem *view, const mt_response_limit *s)
{
    for (int i = 0; i < view->n_pairs; i++) {
        if (strcmp(view->pairs[i].input, s->input.s) == 0 &&
            strcmp(view->pairs[i].output, s->output.s) == 0) {
            return i;
        }
    }
    view->pairs[view->n_pairs] = (mt_forced_response_pair){s->input.s, s->output.s};
    return view->n_pairs++;
}

static mt_status open_ports(mt_analysis *a, const mt_forced_response_pair *pair,
                            mt_response *out, mt_err *err)
{
    const mt_response_request ask = {
        .n_in = 1, .inputs = &pair->input, .n_out = 1, .outputs = &pair->output};
    const mt_status rc = mt_response_open(a, &ask, out, err);
    if (rc != MT_OK) {
        mt_response_free(out);
    }
    return rc;
}

/* Check that one goal alone has a forced problem at the original design. */
static mt_status try_ports(const mt_configuration_problem *view, const mt_requirement *d,
                           mt_err *err)
{
    const mt_forced_response_pair pair = {d->goal->response_limit->input.s,
                                          d->goal->response_limit->output.s};
    mt_response r = {.a = NULL};
    mt_err own = {.code = MT_OK};
    mt_status rc = open_ports(view->original, &pair, &r, &own);
    mt_response_free(&r);
    if (rc == MT_E_USAGE) {
        return mt_fail(err, MT_E_INPUT, "/goals/%d/output: %s", d->goal_index, own.text);
    }
    return mt_pass_final(rc, &own, err); /* else it may have one at another design */
}

mt_status mt_forced_response_ports_at(const mt_system *sys, const mt_response_limit *s,
                                      const char *at, mt_arena *mem, mt_port *in, mt_port *out,
                                      mt_err *err)
{
    mt_err own = {.code = MT_OK};
    const char *where = "input";
    mt_status rc = mt_port_input(sys, s->input.s, mem, in, &own);
    if (rc == MT_OK) {
        where = "output";
        rc = mt_port_output(sys, s->output.s, mem, out, &own);
    }
    return rc == MT_OK         ? MT_OK
           : rc == MT_E_MEMORY ? mt_fail_memory(err)
                               : mt_fail(err, MT_E_INPUT, "%s/%s: %s", at, where, own.text);
}

mt_status mt_forced_response_ports(mt_problem *p, const mt_requirement *d, mt_port *in,
                                   mt_port *out, mt_err *err)
{
    const char *const at = mt_arena_printf(&p->mem, "/goals/%d", d->goal_index);
    MT_TRY(mt_arena_check(&p->mem, err));
    return mt_forced_response_ports_at(p->views[d->view].original->sys, d->goal->response_limit,
                                       at, &p->mem, in, out, err);
}

/* Finds the requirement's ports in its configuration and checks them with a trial evaluation.
 * Fails: MT_E_INPUT, whose text begins with the address, MT_E_MEMORY. */
static mt_status compile_ports(mt_problem *p, mt_requirement *d, mt_err *err)
{
    mt_configuration_problem *const view = &p->views[d->view];
    mt_port in;
    mt_port out;
    MT_TRY(mt_forced_response_ports(p, d, &in, &out, err));
    MT_TRY(try_ports(view, d, err));
    if (view->pairs == NULL) {
        view->pairs = mt_arena_alloc(&p->mem, (size_t)p->study->n_goals, sizeof *view->pairs);
        MT_TRY(mt_arena_check(&p->mem, err));
    }
    d->pair = place_of(view, d->goal->response_limit);
    const double limit = fmin(fmin(d->equals, d->goal->at_least), d->goal->at_most);
    d->floor_hz = MT_FORCED_RESPONSE_FLOOR * limit;
    return MT_OK;
}

static mt_status open_sum(mt_forced_response *s, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    mt_status rc = mt_response_sums(&s->r, &s->sum, &own);
    rc = rc == MT_OK ? mt_frf_init(&s->frf, &s->sum, &s->r.mem, &own) : rc;
    s->summed = rc == MT_OK;
    return rc == MT_OK || rc == MT_E_SINGULAR ? MT_OK : mt_fail(err, rc, "%s", own.text);
}

static mt_status open_view(mt_workspace *w, const mt_requirement *d, mt_forced_response **out,
                           mt_err *err)
{
    mt_configuration_work *const view = &w->views[d->view];
    const mt_configuration_problem *const of = &w->c->views[d->view];
    if (view->forced_response == NULL) {
        view->forced_response =
            mt_arena_alloc(&w->mem, (size_t)of->n_pairs, sizeof *view->forced_response);
        MT_TRY(mt_arena_check(&w->mem, err));
        view->n_forced_response = of->n_pairs;
    }
    mt_forced_response *const s = &view->forced_response[d->pair];
    *out = s;
    if (s->open) {
        return MT_OK;
    }
    MT_TRY(open_ports(view->analysis, &of->pairs[d->pair], &s->r, err));
    s->open = true;
    const mt_status rc = open_sum(s, err);
    if (rc != MT_OK) {
        mt_response_free(&s->r);
        s->open = false;
    }
    return rc;
}

/* Largest response of the requirement's ports for lower <= w <= upper [rad/s], which may be
 * equal. Fails: as mt_response_open. */
static mt_status find_largest(mt_workspace *w, const mt_requirement *d, double lower,
                              double upper, peak_in_range *out, mt_err *err)
{
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    *out = (peak_in_range){.proven = s->summed};
    if (!s->summed) {
        return sampled_find(&s->r, lower, upper, &out->at, &out->by_omega, err);
    }
    out->at = mt_sine_peak_find(&s->frf, lower, upper);
    if (out->at.end == MT_FORCED_FINITE) {
        double complex jet[3];
        mt_frf_jet(&s->frf, (mt_near){out->at.omega, 0.0}, jet);
        out->by_omega = creal(mt_frf_times(out->at.direction, jet[1]));
    }
    return MT_OK;
}

/* Response to the requirement's profile; lists valid until the next solve; *proven: as
 * peak_in_range. */
static mt_status find_vibration_response(mt_workspace *w, const mt_requirement *d,
                                         mt_vibration_response *out, bool *proven, mt_err *err)
{
    const mt_vibration *const v = d->goal->response_limit->profile;
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    *proven = s->summed;
    return s->summed ? mt_vibration_respond(v, &s->sum, &s->r.mem, out, err)
                     : sampled_respond(&s->r, v, out, err);
}

/* out: by_rms d(rms) + by_sine d(sine) of that response as weighted frequencies. */
static mt_status weigh_nodes(mt_workspace *w, const mt_requirement *d,
                             const mt_vibration_response *r, double by_rms, double by_sine,
                             mt_spectral_nodes *out, mt_err *err)
{
    const mt_vibration *const v = d->goal->response_limit->profile;
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    return s->summed
               ? mt_vibration_respond_nodes(v, &s->sum, r, by_rms, by_sine, &s->r.mem, out, err)
               : sampled_nodes(&s->r, v, r, by_rms, by_sine, out, err);
}

/* out[p->n] = d/dt of Re sum_i weight_i H(w_i), times `factor`. After a solve with gradient. */
static mt_status weighted_slopes(mt_workspace *w, const mt_requirement *d,
                                 const mt_spectral_nodes *nodes, double factor, double *out,
                                 mt_err *err)
{
    mt_forced_response *s = NULL;
    MT_TRY(open_view(w, d, &s, err));
    MT_TRY(mt_response_weighted_slopes(&s->r, 0, 0, nodes->n, nodes->omega, nodes->weight, out,
                                       err));
    for (int k = 0; k < w->p->n; k++) {
        out[k] *= factor * mt_workspace_dx_dt(w, k);
    }
    return MT_OK;
}

/* Converts the slope of q to that of ln q as in rows (MT_MEASURE_RATIO), in place. */
static void to_ln(const mt_workspace *w, const mt_requirement *d, double q, double *slope)
{
    const double by = q < d->floor_hz ? q / (d->floor_hz * d->floor_hz) : 1.0 / q;
    for (int k = 0; k < w->p->n; k++) {
        slope[k] *= by;
    }
}

mt_status mt_forced_response_find_peak(mt_workspace *w, const mt_requirement *d,
                                       mt_forced_response_value *out, mt_err *err)
{
    *out = (mt_forced_response_value){.value = nan(""), .error = nan(""), .omega = nan("")};
    MT_TRY(d->ops->look(w, d, out, err));
    out->finite = out->end == MT_FORCED_FINITE;
    out->end_name = mt_forced_end_name(out->end);
    return MT_OK;
}

/* The way out of the infinite: undamped poles within [lower, upper] leave it by their nearer
 * end, or are damped. */
/* ln of what the infinite is off by, above MT_MOST_INSIDE: no damping that counts for a search
 * leaves a resonance that much above its limit. */
static const double BEYOND = 16.0;
/* A damping ratio of this is worth as much as leaving the range by a factor of e. */
static const double DAMPED = 1e-3;
/* An undamped pole is a mode that dampers do not touch: the same frequency, to rounding. */
static const double SAME = 1e-9;

/* Adds the slope of the damping ratio of the mode at omega with the variables, where it has
 * none. */
static mt_status add_damping(mt_workspace *w, mt_analysis *a, double omega, double *slope,
                             mt_err *err)
{
    const mt_damped_modes *damped = NULL;
    bool repeated = false;
    mt_err own = {.code = MT_OK};
    mt_status rc = mt_analysis_damped(a, &damped, &own);
    for (int i = 0; rc == MT_OK && i < damped->count; i++) {
        if (damped->kind[i] == MT_DAMPED_OSCILLATING &&
            fabs(damped->im[i] - omega) <= SAME * omega &&
            fabs(damped->re[i]) <= SAME * omega) {
            rc = mt_analysis_dpole(a, i, w->work, w->dshape, &repeated, &own);
            for (int k = 0; k < w->p->n && rc == MT_OK && !repeated; k++) {
                slope[k] += mt_workspace_dx_dt(w, k) * w->work[k] / (omega * DAMPED);
            }
            break;
        }
    }
    return mt_pass_final(rc, &own, err);
}

/*
 * Guides a search away from designs with an undamped resonance that is excited, whose value is
 * infinite. Sets w->beyond, the excess over a finite value: a constant plus the least ln(w /
 * lower) or ln(upper / w) of the undamped poles in [lower, upper], and slope (unless NULL), its
 * derivative plus the effect of the damping that a variable would add.
 */
static mt_status lead_out(mt_workspace *w, const mt_requirement *d, double lower, double upper,
                          double *slope, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_modes *const modes = &a->modes;
    int nearest = -1;
    double least = HUGE_VAL;
    double sign = 0.0;
    for (int i = 0; i < modes->count; i++) {
        const double omega = TWO_PI * mt_modal_hz(modes, i);
        if (modes->kind[i] != MT_MODE_FLEXIBLE || !(omega >= lower && omega <= upper)) {
            continue;
        }
        const double down = log(omega / lower);
        const double up = log(upper / omega);
        if (fmin(down, up) < least) {
            least = fmin(down, up);
            nearest = i;
            sign = down < up ? 1.0 : -1.0;
        }
    }
    w->beyond = BEYOND + (nearest < 0 ? 0.0 : least);
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        slope[k] = 0.0;
    }
    if (nearest < 0 || slope == NULL) {
        return MT_OK;
    }
    MT_TRY(mt_problem_dln_frequency(w, a, nearest, 0.0, slope, err));
    for (int k = 0; k < w->p->n; k++) {
        slope[k] *= sign;
    }
    return add_damping(w, a, TWO_PI * mt_modal_hz(modes, nearest), slope, err);
}

/*
 * "response": q = |H| at a frequency, or the largest over a band. Where two peaks are equal, as
 * at the best tuning of an absorber, that largest one has a kink. So a band is held by several
 * rows: it is divided at
 *     b_i = sqrt(w_i w_(i+1)),   w_i the undamped natural frequencies in their order,
 * and each part has its own largest value, which is smooth while its peak stays within. Where
 * it lies on an end that moves,
 *     d q = d|H| + d|H|/dw b_i d ln b_i,   d ln b_i = (d ln w_i + d ln w_(i+1)) / 2.
 * A part that the band has not gives the value at the band's end.
 */

/* Modes that parts are made of: those of the original design within the band, and so many
 * beside it that may come in; what lies beyond shares the outermost parts. */
enum { BESIDE = 3, MOST_PARTS = 24 };

static double lower_of(const mt_requirement *d)
{
    return TWO_PI * d->goal->response_limit->lower_hz;
}

static double upper_of(const mt_requirement *d)
{
    return TWO_PI * d->goal->response_limit->upper_hz;
}

/* Vibration modes below a frequency at the original design. */
static int below(const mt_modes *modes, double hz)
{
    int n = 0;
    for (int i = 0; i < modes->count; i++) {
        n += modes->kind[i] == MT_MODE_FLEXIBLE && mt_modal_hz(modes, i) < hz ? 1 : 0;
    }
    return n;
}

static mt_status compile_response(mt_problem *p, mt_requirement *d, mt_err *err)
{
    MT_TRY(compile_ports(p, d, err));
    if (d->goal->response_limit->lower_hz == d->goal->response_limit->upper_hz) {
        return MT_OK;
    }
    const mt_configuration_problem *const view = &p->views[d->view];
    const mt_modes *const modes = &view->original->modes;
    const int most = mt_configuration_vibrations(view);
    const int first = below(modes, d->goal->response_limit->lower_hz) - BESIDE;
    const int last = below(modes, d->goal->response_limit->upper_hz) + BESIDE + 1;
    d->first_mode = first > 1 ? first : 1;
    const int end = last < most ? last : most;
    const int parts = end - d->first_mode + 1;
    d->n_parts = parts < 1 ? 1 : parts > MOST_PARTS ? MOST_PARTS : parts;
    return MT_OK;
}

/* Angular frequency of a vibration mode; of one at infinity infinite. */
static double omega_of(const mt_analysis *a, int index, int *pos)
{
    *pos = mt_modal_flexible(&a->modes, index);
    return *pos < 0 ? HUGE_VAL : TWO_PI * mt_modal_hz(&a->modes, *pos);
}

/* Between modes i and i + 1. */
static double between(const mt_analysis *a, int i)
{
    int pos = -1;
    const double under = omega_of(a, i, &pos);
    const double over = omega_of(a, i + 1, &pos);
    return sqrt(under) * sqrt(over);
}

/* slope += by b d ln b of the end above mode i. */
static mt_status add_end(mt_workspace *w, mt_analysis *a, int i, double by, double *slope,
                         mt_err *err)
{
    const double moved = 0.5 * by * between(a, i);
    for (int k = 0; k < 2; k++) {
        int pos = -1;
        (void)omega_of(a, i + k, &pos);
        MT_TRY(mt_problem_dln_frequency(w, a, pos, 0.0, w->dshape, err));
        mt_axpy(w->p->n, moved, w->dshape, slope);
    }
    return MT_OK;
}

/* The number that the peak is, and its slope; end: the mode below the end that it lies on; 0:
 * it lies on none. */
static mt_status evaluate_peak(mt_workspace *w, const mt_requirement *d,
                               const peak_in_range *peak, int end, double *q, double *slope,
                               mt_err *err)
{
    double omega = peak->at.omega;
    double complex weight = peak->at.direction;
    const mt_spectral_nodes one = {.n = 1, .omega = &omega, .weight = &weight};
    *q = peak->at.value;
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(weighted_slopes(w, d, &one, 1.0, slope, err));
    if (end > 0) {
        MT_TRY(add_end(w, w->views[d->view].analysis, end, peak->by_omega, slope, err));
    }
    to_ln(w, d, *q, slope);
    return MT_OK;
}

static double within(const mt_requirement *d, double omega)
{
    return fmin(fmax(omega, lower_of(d)), upper_of(d));
}

static mt_status part(mt_workspace *w, const mt_requirement *d, int k, double *q, double *slope,
                      mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const int under = k > 0 ? d->first_mode + k - 1 : 0; /* the modes below its ends */
    const int over = k + 1 < d->n_parts ? d->first_mode + k : 0;
    const double from = under > 0 ? within(d, between(a, under)) : lower_of(d);
    const double to = over > 0 ? within(d, between(a, over)) : upper_of(d);
    peak_in_range peak;
    if (!mt_modal_indexed(&a->modes)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\" is unstable",
                       mt_analysis_configuration(a));
    }
    MT_TRY(find_largest(w, d, from, to, &peak, err));
    if (peak.at.end != MT_FORCED_FINITE) {
        *q = HUGE_VAL;
        return lead_out(w, d, from, to, slope, err);
    }
    const bool inside = peak.at.omega > lower_of(d) && peak.at.omega < upper_of(d);
    const int end = !inside                 ? 0
                    : peak.at.omega == from ? under
                    : peak.at.omega == to   ? over
                                            : 0;
    return evaluate_peak(w, d, &peak, end, q, slope, err);
}

static mt_status evaluate_response(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                   double *slope, mt_err *err)
{
    peak_in_range peak;
    (void)pos;
    MT_TRY(find_largest(w, d, lower_of(d), upper_of(d), &peak, err));
    if (peak.at.end != MT_FORCED_FINITE) {
        *q = HUGE_VAL;
        return lead_out(w, d, lower_of(d), upper_of(d), slope, err);
    }
    return evaluate_peak(w, d, &peak, 0, q, slope, err);
}

static mt_status find_response_peak(mt_workspace *w, const mt_requirement *d,
                                    mt_forced_response_value *out, mt_err *err)
{
    peak_in_range peak;
    MT_TRY(find_largest(w, d, lower_of(d), upper_of(d), &peak, err));
    out->end = peak.at.end;
    out->proven = peak.proven;
    out->lower_hz = d->goal->response_limit->lower_hz;
    out->upper_hz = d->goal->response_limit->upper_hz;
    if (out->end == MT_FORCED_FINITE) {
        out->value = peak.at.value;
        out->error = peak.at.value * peak.at.excess;
        out->omega = peak.at.omega;
        out->at_edge = peak.at.at_edge;
    }
    return MT_OK;
}

static const char *response_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    const mt_response_limit *const s = d->goal->response_limit;
    return s->lower_hz == s->upper_hz
               ? mt_arena_printf(mem, "%s: response of %s to %s at %.10g Hz", what, s->output.s,
                                 s->input.s, s->lower_hz)
               : mt_arena_printf(mem, "%s: response of %s to %s from %.10g to %.10g Hz", what,
                                 s->output.s, s->input.s, s->lower_hz, s->upper_hz);
}

const mt_goal_ops mt_goal_response = {.quantity = MT_QUANTITY_OTHER,
                                      .needs_vectors = true,
                                      .compile = compile_response,
                                      .value = evaluate_response,
                                      .part = part,
                                      .look = find_response_peak,
                                      .subject = response_subject,
                                      .equals = "at"};

/*
 * "vibration": q = what a profile does to a response: the RMS of its random parts, the peaks of
 * its tones, each the largest over its range and together by the profile's rule, or both:
 * q = by_rms RMS + by_sine tones.
 */
static double by_rms(const mt_response_limit *s)
{
    return s->quantity == MT_RESPONSE_LIMIT_RMS    ? 1.0
           : s->quantity == MT_RESPONSE_LIMIT_PEAK ? s->profile->sigma
                                                   : 0.0;
}

static double by_sine(const mt_response_limit *s)
{
    return s->quantity == MT_RESPONSE_LIMIT_RMS ? 0.0 : 1.0;
}

static double limited_quantity(const mt_response_limit *s, const mt_vibration_response *r)
{
    return s->quantity == MT_RESPONSE_LIMIT_RMS    ? r->rms
           : s->quantity == MT_RESPONSE_LIMIT_SINE ? r->sine
                                                   : r->peak;
}

/* Frequency range of the parts of the profile that count [Hz]. */
static void range_of(const mt_response_limit *s, double hz[2])
{
    mt_vibration_range(s->profile, by_rms(s) > 0.0, by_sine(s) > 0.0, hz);
}

static bool is_finite(const mt_response_limit *s, const mt_vibration_response *r)
{
    return isfinite(limited_quantity(s, r));
}

static mt_status evaluate_vibration(mt_workspace *w, const mt_requirement *d, int pos,
                                    double *q, double *slope, mt_err *err)
{
    const mt_response_limit *const s = d->goal->response_limit;
    bool proven = false;
    mt_vibration_response r;
    mt_spectral_nodes nodes = {.n = 0};
    (void)pos;
    MT_TRY(find_vibration_response(w, d, &r, &proven, err));
    *q = limited_quantity(s, &r);
    if (!is_finite(s, &r)) {
        double hz[2];
        range_of(s, hz);
        *q = HUGE_VAL;
        return lead_out(w, d, TWO_PI * hz[0], TWO_PI * hz[1], slope, err);
    }
    if (slope == NULL) {
        return MT_OK;
    }
    MT_TRY(weigh_nodes(w, d, &r, by_rms(s), by_sine(s), &nodes, err));
    MT_TRY(weighted_slopes(w, d, &nodes, 1.0, slope, err));
    to_ln(w, d, *q, slope);
    return MT_OK;
}

/* The tone with the largest response. */
static int worst_tone(const mt_response_limit *s, const mt_vibration_response *r)
{
    int best = 0;
    for (int i = 1; i < r->n_tones; i++) {
        const double own = mt_vibration_respond_tone(s->profile, r, i);
        best = own > mt_vibration_respond_tone(s->profile, r, best) ? i : best;
    }
    return best;
}

static void look_at_tones(const mt_response_limit *s, const mt_vibration_response *r,
                          mt_forced_response_value *out)
{
    double excess = 0.0;
    for (int i = 0; i < r->n_tones; i++) {
        excess = fmax(excess, r->tones[i].excess);
    }
    out->error += by_sine(s) * r->sine * excess;
    if (s->quantity == MT_RESPONSE_LIMIT_SINE) {
        const int worst = worst_tone(s, r);
        out->omega = r->tones[worst].omega;
        out->at_edge = r->tones[worst].at_edge;
        out->lower_hz = s->profile->tones[worst].lower_hz;
        out->upper_hz = s->profile->tones[worst].upper_hz;
    }
}

static mt_status find_vibration_peak(mt_workspace *w, const mt_requirement *d,
                                     mt_forced_response_value *out, mt_err *err)
{
    const mt_response_limit *const s = d->goal->response_limit;
    bool proven = false;
    mt_vibration_response r;
    peak_in_range peak;
    double hz[2];
    MT_TRY(find_vibration_response(w, d, &r, &proven, err));
    range_of(s, hz);
    out->lower_hz = hz[0];
    out->upper_hz = hz[1];
    out->proven = proven;
    out->end = r.end;
    if (!is_finite(s, &r)) {
        return MT_OK;
    }
    out->end = MT_FORCED_FINITE;
    out->value = limited_quantity(s, &r);
    out->error = by_rms(s) > 0.0 ? by_rms(s) * r.rms_bound : 0.0;
    look_at_tones(s, &r, out);
    if (s->quantity != MT_RESPONSE_LIMIT_SINE) {
        MT_TRY(find_largest(w, d, TWO_PI * out->lower_hz, TWO_PI * out->upper_hz, &peak, err));
        out->omega = peak.at.omega;
        out->at_edge = peak.at.at_edge;
    }
    return MT_OK;
}

static const char *vibration_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    static const char *const words[MT_RESPONSE_LIMIT_QUANTITIES] = {"response", "RMS", "tones",
                                                                    "peak"};
    const mt_response_limit *const s = d->goal->response_limit;
    return mt_arena_printf(
        mem, "%s: %s of %s under %s along %s", what, words[s->quantity], s->output.s,
        s->profile->name != NULL ? s->profile->name : s->profile_name.s, s->input.s);
}

const mt_goal_ops mt_goal_vibration = {.quantity = MT_QUANTITY_OTHER,
                                       .needs_vectors = true,
                                       .compile = compile_ports,
                                       .value = evaluate_vibration,
                                       .look = find_vibration_peak,
                                       .subject = vibration_subject,
                                       .equals = "at"};
