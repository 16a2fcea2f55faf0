/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a profile of vibration does: to one response, and to all outputs of a mechanism. */
#include "vibration/profile_response.h"

#include <complex.h>
#include <float.h>
#include <math.h>

/* One response, as a sum over poles. */

static const double TWO_PI = 6.28318530717958647693;

static void note_end(mt_vibration_response *out, mt_forced_end end, int pole)
{
    if (end > out->end) {
        out->end = end;
        out->pole = pole;
    }
}

/* Error of the mean square by the rounding of the poles. The resonance of a pole re + i im, |H|
 * = |rho| / |w - p|, contributes |rho|^2 G / (2 im) where the density is G: next to an undamped
 * pole all of it may be wrong. */
static double pole_rounding(const mt_psd *psd, const mt_spectral *of)
{
    const mt_frf *const h = &of->h;
    double sum = 0.0;
    for (int k = 0; k < h->n; k++) {
        const double im = fabs(h->im[k]);
        if (h->re[k] <= 0.0 || im == 0.0 || h->index[k] < of->sum->first_coupled) {
            continue;
        }
        const double size = cabs(h->rho[k]);
        sum += size * size * mt_psd_at(psd, h->re[k] / TWO_PI) / (2.0 * im) *
               (of->sum->rounding / im);
    }
    return sum;
}

static void add_random(const mt_vibration *v, const mt_spectral *of, mt_vibration_response *out)
{
    double square = 0.0;
    double bound = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        const mt_spectral_answer a = mt_spectral_rms(of, &v->random[i].psd, MT_SPECTRAL_BEST);
        note_end(out, a.end, a.pole);
        square += a.rms * a.rms;
        /* of sqrt(sum a_i^2), by each a_i at most 1 */
        bound += a.bound + mt_spectral_root_bound(pole_rounding(&v->random[i].psd, of), a.rms);
    }
    out->rms = sqrt(square);
    out->rms_bound = bound;
}

double mt_vibration_respond_tone(const mt_vibration *v, const mt_vibration_response *r, int i)
{
    return v->tones[i].level * r->tones[i].value;
}

static int largest_tone(const mt_vibration *v, const mt_vibration_response *r)
{
    int best = 0;
    for (int i = 1; i < r->n_tones; i++) {
        const bool more =
            mt_vibration_respond_tone(v, r, i) > mt_vibration_respond_tone(v, r, best);
        best = more ? i : best;
    }
    return best;
}

/* NaN of any tone is NaN of all. */
static double combine(const mt_vibration *v, const mt_vibration_response *r)
{
    double sum = 0.0;
    double square = 0.0;
    for (int i = 0; i < r->n_tones; i++) {
        const double a = mt_vibration_respond_tone(v, r, i);
        sum += a;
        square += a * a;
    }
    switch (v->rule) {
    case MT_TONES_SUM:
        break;
    case MT_TONES_LARGEST:
        return sum == sum && r->n_tones > 0
                   ? mt_vibration_respond_tone(v, r, largest_tone(v, r))
                   : sum;
    case MT_TONES_ROOT:
        return sqrt(square);
    }
    return sum;
}

/* Set `sine` and `peak` from the RMS and the tones. */
static void vibration_respond_combine(const mt_vibration *v, mt_vibration_response *r)
{
    r->sine = combine(v, r);
    r->peak = (v->sigma * r->rms) + r->sine;
}

mt_status mt_vibration_respond(const mt_vibration *v, const mt_pole_sum *h, mt_arena *mem,
                               mt_vibration_response *out, mt_err *err)
{
    mt_spectral of;
    *out = (mt_vibration_response){.end = MT_FORCED_FINITE, .pole = -1, .n_tones = v->n_tones};
    MT_TRY(mt_spectral_init(&of, h, mem, err));
    out->tones = mt_arena_alloc(mem, (size_t)v->n_tones, sizeof *out->tones);
    MT_TRY(mt_arena_check(mem, err));
    add_random(v, &of, out);
    for (int i = 0; i < v->n_tones; i++) {
        out->tones[i] = mt_sine_peak_find(&of.h, TWO_PI * v->tones[i].lower_hz,
                                          TWO_PI * v->tones[i].upper_hz);
        note_end(out, out->tones[i].end, out->tones[i].pole);
    }
    vibration_respond_combine(v, out);
    return MT_OK;
}

double mt_vibration_respond_psd(const mt_vibration *v, const mt_spectral *h, double hz)
{
    double sum = 0.0;
    for (int i = 0; i < v->n_random; i++) {
        sum += mt_spectral_psd(h, &v->random[i].psd, hz);
    }
    return sum;
}

/* Derivative of the peak by the amplitude of tone i. */
static double by_tone(const mt_vibration *v, const mt_vibration_response *r, int i)
{
    switch (v->rule) {
    case MT_TONES_SUM:
        break;
    case MT_TONES_LARGEST:
        return i == largest_tone(v, r) ? 1.0 : 0.0;
    case MT_TONES_ROOT:
        return r->sine > 0.0 ? mt_vibration_respond_tone(v, r, i) / r->sine : 0.0;
    }
    return 1.0;
}

mt_status mt_vibration_respond_slopes(const mt_vibration *v, const mt_pole_sum *h,
                                      const mt_vibration_response *r, mt_arena *mem,
                                      double complex *by_s, double complex *by_residue,
                                      double complex *by_d, mt_err *err)
{
    mt_spectral of;
    double complex *const part = mt_arena_alloc(mem, 2 * (size_t)h->n, sizeof *part);
    MT_TRY(mt_spectral_init(&of, h, mem, err));
    for (int k = 0; k < h->n; k++) {
        by_s[k] = 0.0;
        by_residue[k] = 0.0;
    }
    for (int j = 0; j < MT_COUNT(h->d); j++) {
        by_d[j] = 0.0;
    }
    for (int i = 0; i < v->n_random && r->rms > 0.0; i++) {
        const mt_psd *const g = &v->random[i].psd;
        double complex part_d[MT_COUNT(h->d)];
        const double share = v->sigma * mt_spectral_rms(&of, g, MT_SPECTRAL_BEST).rms / r->rms;
        mt_spectral_slopes(&of, g, part, part + h->n, part_d);
        for (int k = 0; k < h->n; k++) {
            by_s[k] += share * part[k];
            by_residue[k] += share * part[h->n + k];
        }
        for (int j = 0; j < MT_COUNT(h->d); j++) {
            by_d[j] += share * part_d[j];
        }
    }
    for (int i = 0; i < r->n_tones; i++) {
        const double share = v->tones[i].level * by_tone(v, r, i);
        mt_frf_pull(&of.h, (mt_near){r->tones[i].omega, 0.0}, share * r->tones[i].direction,
                    by_s, by_residue, by_d);
    }
    return MT_OK;
}

/* Append the nodes of random part i. */
static mt_status add_nodes(const mt_spectral *of, const mt_psd *g, double share, mt_arena *mem,
                           mt_spectral_nodes *out, mt_err *err)
{
    mt_spectral_nodes part;
    MT_TRY(mt_spectral_slope_nodes(of, g, mem, &part, err));
    const size_t n = (size_t)out->n + (size_t)part.n;
    double *const omega = mt_arena_f64(mem, n, 1);
    double complex *const weight = mt_arena_alloc(mem, n, sizeof *weight);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < out->n; i++) {
        omega[i] = out->omega[i];
        weight[i] = out->weight[i];
    }
    for (int i = 0; i < part.n; i++) {
        omega[out->n + i] = part.omega[i];
        weight[out->n + i] = share * part.weight[i];
    }
    *out = (mt_spectral_nodes){.n = (int)n, .omega = omega, .weight = weight};
    return MT_OK;
}

mt_status mt_vibration_respond_tone_nodes(const mt_vibration *v, const mt_vibration_response *r,
                                          double by_sine, mt_arena *mem, mt_spectral_nodes *out,
                                          mt_err *err)
{
    out->n = by_sine != 0.0 ? r->n_tones : 0;
    out->omega = mt_arena_f64(mem, (size_t)out->n, 1);
    out->weight = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->weight);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < out->n; i++) {
        out->omega[i] = r->tones[i].omega;
        out->weight[i] = by_sine * v->tones[i].level * by_tone(v, r, i) * r->tones[i].direction;
    }
    return MT_OK;
}

mt_status mt_vibration_respond_nodes(const mt_vibration *v, const mt_pole_sum *h,
                                     const mt_vibration_response *r, double by_rms,
                                     double by_sine, mt_arena *mem, mt_spectral_nodes *out,
                                     mt_err *err)
{
    mt_spectral of;
    MT_TRY(mt_vibration_respond_tone_nodes(v, r, by_sine, mem, out, err));
    MT_TRY(mt_spectral_init(&of, h, mem, err));
    for (int i = 0; i < v->n_random && by_rms != 0.0 && r->rms > 0.0; i++) {
        const mt_psd *const g = &v->random[i].psd;
        const double rms = mt_spectral_rms(&of, g, MT_SPECTRAL_BEST).rms;
        MT_TRY(add_nodes(&of, g, by_rms * rms / r->rms, mem, out, err));
    }
    return MT_OK;
}

mt_pole_sum mt_vibration_respond_one_mass(double hz, double damping_ratio, double complex s[2],
                                          double complex residue[2])
{
    const double w = TWO_PI * hz;
    const double damped = w * sqrt((1.0 - damping_ratio) * (1.0 + damping_ratio));
    s[0] = mt_frf_complex(-damping_ratio * w, damped);
    s[1] = conj(s[0]);
    /* (w^2 + 2 zeta w s) / (s - conj s) */
    residue[0] = mt_frf_ratio((w * w) + (2.0 * damping_ratio * w * s[0]),
                              mt_frf_complex(0.0, 2.0 * damped));
    residue[1] = conj(residue[0]);
    return (mt_pole_sum){.n = 2, .s = s, .residue = residue};
}

/*
 * The poles tell where a response is smooth, its values are those of mt_transfer_at:
 *     RMS^2 = sum over panels of integral |H|^2 G df,
 * each panel by Gauss's rule as a whole (I) and as two halves (J): J is taken, |I - J| is what
 * I is wrong by, and J by far less. Poles without damping are not walked around: where one
 * resonates there is no number, and where none does nothing is to be seen of it.
 */

/* The grid of a tone's range that its curve begins with. */
enum { TONE_POINTS = 9 };

typedef struct work {
    mt_response *r;
    mt_profiled *out;
    mt_gauss gauss;
    mt_frf h; /* of the poles that are damped; no residues */
    mt_sample at;
    double *square; /* [pairs] */
    double *bound;  /* [pairs] */
    double *whole;  /* [pairs] of one panel */
    double *halves; /* [pairs] */
} work;

static void note_pair_end(work *k, int pair, mt_forced_end end, int pole)
{
    mt_vibration_response *const to = &k->out->answers[pair];
    if (end > to->end) {
        to->end = end;
        to->pole = pole;
    }
}

/* Note pairs that resonate at undamped poles within a range. */
static mt_status note_resonances(work *k, double lower, double upper, mt_err *err)
{
    int growing = -1;
    if (mt_frf_judge(&k->h, lower, upper, &growing) == MT_FORCED_UNSTABLE) {
        for (int p = 0; p < k->out->n_pairs; p++) {
            note_pair_end(k, p, MT_FORCED_UNSTABLE, growing);
        }
    }
    for (int i = 0; i < k->out->n_poles; i++) {
        const double w = cimag(k->out->poles[i]);
        bool damped = false;
        for (int j = 0; j < k->h.n; j++) {
            damped = damped || k->h.index[j] == i;
        }
        if (damped || !(w > 0.0 && w >= lower && w <= upper)) {
            continue;
        }
        MT_TRY(mt_transfer_at(k->r->chosen, w, &k->at, &k->r->mem, err));
        for (int p = 0; p < k->out->n_pairs; p++) {
            if (!isfinite(creal(k->at.h[p]))) {
                note_pair_end(k, p, MT_FORCED_INFINITE, i);
            }
        }
    }
    return MT_OK;
}

/* to[pairs] += integral of |H|^2 G over a panel, [rad/s]; rounding into the bound, where it is
 * asked for. */
static mt_status add_gauss(work *k, const mt_psd *g, const mt_panel *on, double *to,
                           bool rounding, mt_err *err)
{
    const double half = 0.5 * (on->b - on->a);
    for (int i = 0; i < MT_GAUSS_NODES; i++) {
        const double w = on->anchor + (on->a + (half * (1.0 + k->gauss.node[i])));
        const double weight = half * k->gauss.weight[i] * mt_psd_at(g, w / TWO_PI);
        MT_TRY(mt_transfer_at(k->r->chosen, w, &k->at, &k->r->mem, err));
        for (int p = 0; p < k->out->n_pairs; p++) {
            const double size = cabs(k->at.h[p]);
            to[p] += weight * size * size;
            k->bound[p] += rounding ? 2.0 * weight * size * k->at.error[p] : 0.0;
        }
    }
    return MT_OK;
}

static mt_status add_panel(work *k, const mt_psd *g, const mt_panel *on, mt_err *err)
{
    const double middle = 0.5 * (on->a + on->b);
    const mt_panel left = {on->anchor, on->a, middle};
    const mt_panel right = {on->anchor, middle, on->b};
    for (int p = 0; p < k->out->n_pairs; p++) {
        k->whole[p] = 0.0;
        k->halves[p] = 0.0;
    }
    MT_TRY(mt_interrupt_check(k->r->sys->run->interrupt, err));
    MT_TRY(add_gauss(k, g, on, k->whole, false, err));
    MT_TRY(add_gauss(k, g, &left, k->halves, true, err));
    MT_TRY(add_gauss(k, g, &right, k->halves, true, err));
    for (int p = 0; p < k->out->n_pairs; p++) {
        k->square[p] += k->halves[p];
        k->bound[p] += fabs(k->whole[p] - k->halves[p]) + (DBL_EPSILON * k->halves[p]);
    }
    return MT_OK;
}

static mt_status add_random_part(work *k, const mt_psd *g, mt_err *err)
{
    MT_TRY(note_resonances(k, TWO_PI * g->hz[0], TWO_PI * g->hz[g->n - 1], err));
    for (int i = 0; i + 1 < g->n; i++) {
        const double lower = TWO_PI * g->hz[i];
        const double upper = TWO_PI * g->hz[i + 1];
        mt_panels walk;
        mt_panel on;
        if (!(upper > lower)) {
            continue;
        }
        mt_panels_begin(&walk, &k->h, lower, upper, mt_psd_exponent(g, i));
        while (mt_panels_next(&walk, &on)) {
            MT_TRY(add_panel(k, g, &on, err));
        }
        for (int p = 0; p < k->out->n_pairs && walk.narrow; p++) {
            k->bound[p] = HUGE_VAL;
        }
    }
    return MT_OK;
}

/* RMS of all random parts: their mean squares add up. */
static mt_status find_rms(work *k, mt_err *err)
{
    const mt_vibration *const v = k->out->v;
    for (int i = 0; i < v->n_random; i++) {
        MT_TRY(add_random_part(k, &v->random[i].psd, err));
    }
    for (int p = 0; p < k->out->n_pairs; p++) {
        mt_vibration_response *const to = &k->out->answers[p];
        const double bound = k->bound[p] / TWO_PI;
        const bool has = to->end == MT_FORCED_FINITE;
        to->rms = has ? sqrt(k->square[p] / TWO_PI) : nan("");
        to->rms_bound = has ? mt_spectral_root_bound(bound, to->rms) : nan("");
    }
    return MT_OK;
}

/* The largest value of each pair's curve within the range of tone i. */
static mt_status find_tone(work *k, int i, mt_err *err)
{
    const mt_vibration_tone *const tone = &k->out->v->tones[i];
    const double lower = TWO_PI * tone->lower_hz;
    const double upper = TWO_PI * tone->upper_hz;
    const mt_curve_options opt = {.from = lower, .to = upper, .points = TONE_POINTS};
    mt_curve curve = {.n = 1, .h = k->at.h, .w = (double[]){lower}};
    MT_TRY(note_resonances(k, lower, upper, err));
    if (upper > lower) {
        MT_TRY(mt_response_curve(k->r, &opt, &curve, err));
    } else {
        MT_TRY(mt_transfer_at(k->r->chosen, lower, &k->at, &k->r->mem, err));
    }
    for (ptrdiff_t p = 0; p < k->out->n_pairs; p++) {
        const mt_forced_end end = k->out->answers[p].end;
        mt_sine_peak *const peak = &k->out->answers[p].tones[i];
        *peak = (mt_sine_peak){.end = end, .pole = k->out->answers[p].pole, .excess = nan("")};
        for (ptrdiff_t at = 0; at < curve.n; at++) {
            const double size = cabs(curve.h[p + (at * k->out->n_pairs)]);
            if (at == 0 || size > peak->value) {
                peak->value = size;
                peak->omega = curve.w[at];
                peak->at_edge = at == 0 || at + 1 == curve.n;
            }
        }
        peak->value = end == MT_FORCED_FINITE ? peak->value : nan("");
        peak->omega = end == MT_FORCED_FINITE ? peak->omega : nan("");
    }
    return MT_OK;
}

static mt_status make_quadrature_work(work *k, mt_err *err)
{
    mt_arena *const mem = &k->r->mem;
    const size_t pairs = (size_t)k->out->n_pairs;
    const size_t poles = (size_t)k->r->n_poles;
    double complex *const none = mt_arena_alloc(mem, poles, sizeof *none);
    k->at = (mt_sample){.h = mt_arena_alloc(mem, pairs, sizeof *k->at.h),
                        .error = mt_arena_f64(mem, pairs, 1)};
    k->square = mt_arena_f64(mem, pairs, 1);
    k->bound = mt_arena_f64(mem, pairs, 1);
    k->whole = mt_arena_f64(mem, pairs, 1);
    k->halves = mt_arena_f64(mem, pairs, 1);
    MT_TRY(mt_arena_check(mem, err));
    k->out->n_poles = k->r->n_poles;
    k->out->poles = k->r->poles;
    const mt_pole_sum sum = {.n = k->r->n_poles,
                             .s = k->r->poles,
                             .residue = none,
                             .judged = true,
                             .growing = k->r->growing};
    MT_TRY(mt_frf_init(&k->h, &sum, mem, err));
    mt_panels_gauss(&k->gauss);
    for (size_t p = 0; p < pairs; p++) {
        const int n = k->out->v->n_tones;
        mt_vibration_response *const to = &k->out->answers[p];
        *to = (mt_vibration_response){.end = MT_FORCED_FINITE, .pole = -1, .n_tones = n};
        to->tones = mt_arena_alloc(mem, (size_t)n, sizeof *to->tones);
    }
    return mt_arena_check(mem, err);
}

/* Fill out->answers, each with its list of tones, by quadrature, without a sum of poles. */
static mt_status profiled_quadrature(mt_response *r, mt_profiled *out, mt_err *err)
{
    work k = {.r = r, .out = out};
    MT_TRY(make_quadrature_work(&k, err));
    MT_TRY(find_rms(&k, err));
    for (int i = 0; i < out->v->n_tones; i++) {
        MT_TRY(find_tone(&k, i, err));
    }
    for (int p = 0; p < out->n_pairs; p++) {
        vibration_respond_combine(out->v, &out->answers[p]);
    }
    return MT_OK;
}

/* All outputs of a mechanism. */

static mt_status name_input(const mt_vibration *v, const mt_system *sys, mt_arena *mem,
                            mt_response_request *request, mt_err *err)
{
    static const char *const names[] = {"x", "y", "z"};
    const char *const axis = v->axis == MT_ABSENT ? NULL : names[v->axis];
    const char **const input = mt_arena_alloc(mem, 1, sizeof *input);
    MT_TRY(mt_arena_check(mem, err));
    if (axis == NULL) {
        return mt_fail(
            err, MT_E_USAGE,
            "%s names no axis: name an input, base.x, base.y or base.z, along which it "
            "shakes",
            v->name == NULL ? v->path : v->name);
    }
    if (v->axis >= sys->dimension) {
        return mt_fail(err, MT_E_USAGE,
                       "%s is along %s, and the mechanism is plane: name an input, base.x or "
                       "base.y, along "
                       "which it shakes",
                       v->name == NULL ? v->path : v->name, axis);
    }
    input[0] = mt_arena_printf(mem, "base.%s", axis);
    request->n_in = 1;
    request->inputs = input;
    return mt_arena_check(mem, err);
}

mt_status mt_profiled_ports(const mt_vibration *v, const mt_system *sys, mt_arena *mem,
                            mt_response_request *request, mt_err *err)
{
    if (request->n_in == 0) {
        MT_TRY(name_input(v, sys, mem, request, err));
    }
    if (request->n_out == 0) {
        const char **const names = mt_arena_alloc(mem, (size_t)sys->n_channels, sizeof *names);
        MT_TRY(mt_arena_check(mem, err));
        for (int i = 0; i < sys->n_channels; i++) {
            names[i] = mt_arena_printf(mem, "%s:acceleration", sys->channels[i].name);
        }
        request->n_out = sys->n_channels;
        request->outputs = names;
    }
    return mt_arena_check(mem, err);
}

mt_status mt_profiled_input(const mt_port *port, mt_err *err)
{
    return port->kind == MT_PORT_BASE && port->motion == 2
               ? MT_OK
               : mt_fail(err, MT_E_USAGE,
                         "a profile of vibration is an acceleration of the ground, and \"%s\" "
                         "is none: \"base.x\", \"base.y\" and \"base.z\" are",
                         port->name);
}

static mt_status by_poles(mt_response *r, const mt_pole_sum *sums, mt_profiled *out,
                          mt_err *err)
{
    out->n_poles = sums[0].n;
    out->poles = sums[0].s;
    out->of = mt_arena_alloc(&r->mem, (size_t)out->n_pairs, sizeof *out->of);
    MT_TRY(mt_arena_check(&r->mem, err));
    for (int p = 0; p < out->n_pairs; p++) {
        MT_TRY(mt_vibration_respond(out->v, &sums[p], &r->mem, &out->answers[p], err));
        MT_TRY(mt_spectral_init(&out->of[p], &sums[p], &r->mem, err));
    }
    return MT_OK;
}

mt_status mt_profiled_find(mt_response *r, const mt_vibration *v, mt_profiled *out, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    *out = (mt_profiled){.v = v, .n_pairs = r->ports.n_in * r->ports.n_out};
    for (int i = 0; i < r->ports.n_in; i++) {
        MT_TRY(mt_profiled_input(&r->ports.in[i], err));
    }
    const size_t pairs = (size_t)out->n_pairs;
    mt_pole_sum *const sums = mt_arena_alloc(&r->mem, pairs, sizeof *sums);
    out->answers = mt_arena_alloc(&r->mem, pairs, sizeof *out->answers);
    MT_TRY(mt_arena_check(&r->mem, err));
    const mt_status rc = mt_response_sums(r, sums, &own);
    if (rc == MT_OK) {
        return by_poles(r, sums, out, err);
    }
    if (rc != MT_E_SINGULAR) {
        return mt_fail(err, rc, "%s", own.text);
    }
    out->no_sums = mt_arena_strdup(&r->mem, own.text);
    MT_TRY(mt_arena_check(&r->mem, err));
    return profiled_quadrature(r, out, err);
}

double mt_profiled_psd(const mt_profiled *s, int pair, double hz, double complex h)
{
    if (s->of != NULL) {
        return mt_vibration_respond_psd(s->v, &s->of[pair], hz);
    }
    const double size = cabs(h);
    return mt_vibration_density(s->v, hz) * size * size;
}
