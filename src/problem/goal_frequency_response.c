/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "frequency_response": residuals of the model's response H against a measured one H_m, two for
 * each of N lines,
 *     e_i = ln(H(w_i) / H_m(w_i)) = ln |H/H_m| + i arg(H/H_m),   arg to the nearest turn,
 *     r   = sqrt(w p_i) (Re e_i, Im e_i),   sum p_i = 1,
 *     de  = dH / H.
 * A response spans decades: of H - H_m only the peaks would count, of (H - H_m)/H_m only lines
 * where the model is too large (it is -1 at worst where it is too small), and its square has a
 * valley that leads to H = 0. The logarithm weighs resonances, antiresonances and what lies
 * between alike, is what a relative error of the measurement adds to, and moves by about as
 * much per decade of a parameter wherever the search stands. Real and imaginary part have the
 * same variance where the noise of both parts of H_m has.
 *     p_i = 1/N, so that a goal does not weigh more by having more lines; by coherence g2
 * p_i ~ g2 / (1 - g2), the inverse of the variance of e_i (Bendat and Piersol, Random Data:
 * var |H|/|H|^2 = (1 - g2) / (2 n g2) of n averages).
 */

#include "problem/goal_frequency_response.h"

#include <math.h>
#include <string.h>

#include "base/run.h"
#include "problem/configuration.h"
#include "problem/forced_response.h"
#include "problem/goals.h"
#include "problem/requirement.h"
#include "response/slopes_forms.h"

static const double TWO_PI = 6.283185307179586477;

/* Of 1 - coherence: below it what is left is bias (leakage, calibration) and no noise that more
 * weight would make less of. */
static const double NOISE_FLOOR = 0.01;

static bool is_unset_or_equal(const char *has, const char *asked)
{
    return has == NULL || strcmp(has, asked) == 0;
}

/* True where the file's name of a port means this one: in full, or as files may abbreviate
 * it. */
static bool is_port(const mt_system *sys, const char *name, const mt_port *port, bool input)
{
    mt_arena own = {0};
    mt_port other = {.name = NULL};
    if (name == NULL || strcmp(name, port->name) == 0) {
        return true;
    }
    const mt_status rc = input ? mt_port_input(sys, name, &own, &other, NULL)
                               : mt_port_output(sys, name, &own, &other, NULL);
    const bool is = rc == MT_OK && strcmp(other.name, port->name) == 0;
    mt_arena_free(&own);
    return is;
}

static mt_status none_found(const mt_problem *p, const mt_requirement *d, int found,
                            mt_arena *mem, mt_err *err)
{
    const mt_measurement *const m =
        &p->study->measurements[d->goal->response_limit->measurement];
    const mt_fit *const fit = d->fit;
    return mt_fail(
        err, MT_E_INPUT,
        "%s responses of \"%s\" are of %s by %s in configuration \"%s\" (it has: %s)",
        found == 0 ? "no" : "several", m->path.s, fit->ports.out->name, fit->ports.in->name,
        mt_configuration_name(p, &p->views[d->view]), mt_measured_list_text(m, mem));
}

/* The response of the file with these ports. */
static mt_status find_measured(mt_problem *p, const mt_requirement *d, mt_fit *fit, mt_err *err)
{
    const mt_measurement *const m =
        &p->study->measurements[d->goal->response_limit->measurement];
    const mt_system *const sys = p->views[d->view].original->sys;
    int found = 0;
    for (int i = 0; i < m->n_responses; i++) {
        const mt_measured_response *const r = &m->responses[i];
        if (is_unset_or_equal(r->configuration, mt_configuration_name(p, &p->views[d->view])) &&
            is_port(sys, r->input, fit->ports.in, true) &&
            is_port(sys, r->output, fit->ports.out, false)) {
            fit->measured = found++ == 0 ? r : fit->measured;
        }
    }
    return found == 1 ? MT_OK : none_found(p, d, found, &p->mem, err);
}

/* Compares units where the file gives them. */
static mt_status check_unit(mt_problem *p, const mt_requirement *d, const mt_fit *fit,
                            mt_err *err)
{
    const mt_measurement *const m =
        &p->study->measurements[d->goal->response_limit->measurement];
    const char *const unit =
        mt_arena_printf(&p->mem, "%s per %s", fit->ports.out->unit, fit->ports.in->unit);
    if (unit == NULL || fit->measured->unit == NULL || strcmp(unit, fit->measured->unit) == 0) {
        return MT_OK;
    }
    return mt_fail(err, MT_E_INPUT, "\"%s\" is in %s, and %s by %s is in %s", m->path.s,
                   fit->measured->unit, fit->ports.out->name, fit->ports.in->name, unit);
}

static bool within(const mt_response_limit *s, const mt_measured_line *line)
{
    return !(line->frequency_hz < s->lower_hz) && !(line->frequency_hz > s->upper_hz);
}

static mt_status add_line(const mt_problem *p, const mt_requirement *d,
                          const mt_measured_line *line, mt_fit *fit, mt_err *err)
{
    const mt_measurement *const m =
        &p->study->measurements[d->goal->response_limit->measurement];
    const double g2 = line->coherence;
    const double complex h = fit->measured->scale * mt_complex(line->re, line->im);
    const double size = hypot(creal(h), cimag(h));
    if (!(size > 0.0) || !isfinite(size)) {
        return mt_fail(err, MT_E_INPUT,
                       "line %d of \"%s\", at %.10g Hz, is %s and has no logarithm: leave it "
                       "out of \"band_hz\"",
                       line->line, m->path.s, line->frequency_hz,
                       size > 0.0 ? "infinite" : "0");
    }
    if (d->goal->response_limit->coherence && !(g2 >= 0.0)) {
        return mt_fail(err, MT_E_INPUT, "\"%s\" has no coherence", m->path.s);
    }
    fit->w[fit->n] = TWO_PI * line->frequency_hz;
    fit->h[fit->n] = h;
    fit->level[fit->n] = log(size);
    fit->phase[fit->n] = carg(h);
    fit->share[fit->n] =
        d->goal->response_limit->coherence ? g2 / fmax(1.0 - g2, NOISE_FLOOR) : 1.0;
    fit->line[fit->n++] = line->line;
    return MT_OK;
}

static mt_status take_lines(mt_problem *p, const mt_requirement *d, mt_fit *fit, mt_err *err)
{
    const mt_measured_response *const r = fit->measured;
    const mt_measurement *const m =
        &p->study->measurements[d->goal->response_limit->measurement];
    const size_t most = (size_t)r->n_lines;
    double sum = 0.0;
    fit->w = mt_arena_f64(&p->mem, most, 1);
    fit->h = mt_arena_alloc(&p->mem, most, sizeof *fit->h);
    fit->level = mt_arena_f64(&p->mem, most, 1);
    fit->phase = mt_arena_f64(&p->mem, most, 1);
    fit->share = mt_arena_f64(&p->mem, most, 1);
    fit->line = mt_arena_int(&p->mem, most);
    MT_TRY(mt_arena_check(&p->mem, err));
    for (int i = 0; i < r->n_lines; i++) {
        if (within(d->goal->response_limit, &r->lines[i])) {
            MT_TRY(add_line(p, d, &r->lines[i], fit, err));
            sum += fit->share[fit->n - 1];
        }
    }
    if (!(sum > 0.0)) {
        return fit->n > 0 ? mt_fail(err, MT_E_INPUT,
                                    "the coherence of \"%s\" is 0 at every line", m->path.s)
               : most == 0
                   ? mt_fail(err, MT_E_INPUT, "\"%s\" has no line above 0 Hz", m->path.s)
                   : mt_fail(
                         err, MT_E_INPUT,
                         "no line of \"%s\", which has %d from %.10g to %.10g Hz, is within "
                         "\"band_hz\"",
                         m->path.s, r->n_lines, r->lines[0].frequency_hz,
                         r->lines[most - 1].frequency_hz);
    }
    for (int i = 0; i < fit->n; i++) {
        fit->share[i] /= sum;
    }
    return MT_OK;
}

static mt_status compile_frequency_response(mt_problem *p, mt_requirement *d, mt_err *err)
{
    mt_fit *const fit = mt_arena_alloc(&p->mem, 1, sizeof *fit);
    mt_port *const ports = mt_arena_alloc(&p->mem, 2, sizeof *ports);
    MT_TRY(mt_arena_check(&p->mem, err));
    d->fit = fit;
    fit->ports = (mt_port_set){.n_in = 1, .n_out = 1, .in = &ports[0], .out = &ports[1]};
    MT_TRY(mt_forced_response_ports(p, d, &ports[0], &ports[1], err));
    MT_TRY(find_measured(p, d, fit, err));
    MT_TRY(check_unit(p, d, fit, err));
    MT_TRY(take_lines(p, d, fit, err));
    d->n_rows = 2 * fit->n;
    return MT_OK;
}

/* What is solved at each line. */
typedef struct forced {
    mt_forced f;
    mt_response_ways ways;
    mt_basis basis;
} forced;

static mt_status prepare_forced_response(mt_analysis *a, const mt_fit *fit, forced *out,
                                         mt_err *err)
{
    MT_TRY(mt_response_problem(a, &fit->ports, &a->mem, &out->f, &out->ways, err));
    const mt_basis_problem problem = {.f = &out->f, .mass = &a->mass, .modes = &a->modes};
    return mt_basis_make(&problem, &a->mem, &out->basis, err);
}

/* Names the measured file and its line, where the fault is. */
static mt_status no_value(const mt_workspace *w, const mt_requirement *d, int i,
                          const char *what, mt_err *err)
{
    const mt_measurement *const m =
        &w->p->study->measurements[d->goal->response_limit->measurement];
    return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": %s at %.10g Hz, line %d of \"%s\"",
                   mt_analysis_configuration(w->views[d->view].analysis), what,
                   d->fit->w[i] / TWO_PI, d->fit->line[i], m->path.s);
}

/* The two rows of line i. */
static mt_status line(mt_workspace *w, const mt_requirement *d, int i, double complex h,
                      mt_err *err)
{
    const double weight = sqrt(mt_requirement_weight(w, d) * d->fit->share[i]);
    double *const r = w->r + mt_requirement_row(w->c, d) + (2 * (ptrdiff_t)i);
    const double size = hypot(creal(h), cimag(h));
    if (!isfinite(size)) {
        return no_value(w, d, i, "nothing damps the resonance", err);
    }
    if (!(size > 0.0)) {
        return no_value(w, d, i, "nothing moves", err);
    }
    r[0] = weight * (log(size) - d->fit->level[i]);
    r[1] = weight * remainder(carg(h) - d->fit->phase[i], TWO_PI);
    return MT_OK;
}

/* Slopes of the residuals, from those of h: dh / h, written out since h and dh are finite. */
static mt_status line_slopes(mt_workspace *w, const mt_requirement *d, int i, double complex h,
                             const double complex *dh, mt_err *err)
{
    const double weight = sqrt(mt_requirement_weight(w, d) * d->fit->share[i]);
    const double complex inverse = 1.0 / h;
    for (int k = 0; k < w->p->n; k++) {
        const double dx_dt = weight * mt_workspace_dx_dt(w, k);
        const double re = (creal(dh[k]) * creal(inverse)) - (cimag(dh[k]) * cimag(inverse));
        const double im = (creal(dh[k]) * cimag(inverse)) + (cimag(dh[k]) * creal(inverse));
        double *const dr = w->dr + mt_requirement_row(w->c, d) + (2 * (ptrdiff_t)i) +
                           ((ptrdiff_t)k * w->c->rows.res.n);
        if (!isfinite(re) || !isfinite(im)) {
            return no_value(w, d, i, "the response has no slope", err);
        }
        dr[0] = dx_dt * re;
        dr[1] = dx_dt * im;
    }
    return MT_OK;
}

static mt_status values(mt_workspace *w, const mt_requirement *d, const forced *f, mt_err *err)
{
    mt_arena *const mem = &w->views[d->view].analysis->mem;
    for (int i = 0; i < d->fit->n; i++) {
        double complex h = 0.0;
        MT_TRY(mt_interrupt_check(w->p->run->interrupt, err));
        MT_TRY(mt_transfer_at(&f->basis.t, d->fit->w[i], &(mt_sample){.h = &h}, mem, err));
        MT_TRY(line(w, d, i, h, err));
    }
    return MT_OK;
}

static mt_status evaluate_response_slopes(mt_workspace *w, const mt_requirement *d,
                                          const forced *f, mt_err *err)
{
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_fit *const fit = d->fit;
    const size_t inputs = (size_t)a->sys->n_inputs;
    const mt_slope_problem problem = {
        .a = a, .basis = &f->basis, .ports = &fit->ports, .ways = &f->ways};
    mt_slope_forms forms;
    double complex *const h = mt_arena_alloc(&a->mem, (size_t)fit->n, sizeof *h);
    double complex *const dh = mt_arena_alloc(&a->mem, inputs * (size_t)fit->n, sizeof *dh);
    MT_TRY(mt_arena_check(&a->mem, err));
    MT_TRY(mt_slope_forms_make(&problem, 0, 0, fit->n, &a->mem, &forms, err));
    MT_TRY(mt_slope_forms_at(&forms, fit->n, fit->w, h, dh, &a->mem, err));
    for (int i = 0; i < fit->n; i++) {
        MT_TRY(line(w, d, i, h[i], err));
        MT_TRY(line_slopes(w, d, i, h[i], dh + ((size_t)i * inputs), err));
    }
    return MT_OK;
}

static mt_status residuals(mt_workspace *w, const mt_requirement *d, int pos,
                           bool with_gradient, mt_err *err)
{
    (void)pos;
    mt_analysis *const a = w->views[d->view].analysis;
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    forced f = {.f = {.n = 0}};
    mt_status rc = prepare_forced_response(a, d->fit, &f, err);
    if (rc == MT_OK) {
        rc = with_gradient ? evaluate_response_slopes(w, d, &f, err) : values(w, d, &f, err);
    }
    mt_arena_rewind(&a->mem, mark);
    return rc;
}

bool mt_fit_worst(const mt_workspace *w, const mt_requirement *d, double *hz,
                  double complex *off)
{
    *hz = nan("");
    *off = nan("");
    if (d->fit == NULL) {
        return false;
    }
    double worst = -1.0;
    for (int i = 0; i < d->fit->n; i++) {
        const double scale = sqrt(mt_requirement_weight(w, d) * d->fit->share[i]);
        const double *const r = w->r + mt_requirement_row(w->c, d) + (2 * (ptrdiff_t)i);
        const double size = scale > 0.0 ? hypot(r[0], r[1]) / scale : 0.0;
        if (size > worst) {
            worst = size;
            *hz = d->fit->w[i] / TWO_PI;
            *off = mt_complex(r[0], r[1]) / scale;
        }
    }
    return true;
}

double mt_fit_rise(const mt_requirement *d, double *hz)
{
    const mt_fit *const fit = d->fit;
    int peak = 0;
    *hz = nan("");
    if (fit == NULL) {
        return 0.0;
    }
    for (int i = 1; i < fit->n; i++) {
        peak = cabs(fit->h[i]) > cabs(fit->h[peak]) ? i : peak;
    }
    const double half_power = cabs(fit->h[peak]) / sqrt(2.0);
    int first = peak;
    int last = peak;
    while (first > 0 && cabs(fit->h[first]) >= half_power) {
        first--;
    }
    while (last < fit->n - 1 && cabs(fit->h[last]) >= half_power) {
        last++;
    }
    double rise = 0.0;
    for (int i = first; i < last; i++) {
        rise += remainder(carg(fit->h[i + 1]) - carg(fit->h[i]), TWO_PI);
    }
    *hz = fit->w[peak] / TWO_PI;
    /* a quarter turn lies between the half-power points; a line beyond each */
    return first < peak && peak < last && last - first >= 4 ? fmax(rise, 0.0) : 0.0;
}

bool mt_fit_is_reversed(const mt_workspace *w, const mt_requirement *d)
{
    double as_is = 0.0;
    double reversed = 0.0;
    for (int i = 0; d->fit != NULL && i < d->fit->n; i++) {
        const double scale = sqrt(mt_requirement_weight(w, d) * d->fit->share[i]);
        const double off = w->r[mt_requirement_row(w->c, d) + (2 * (ptrdiff_t)i) + 1];
        const double other =
            scale > 0.0 ? scale * remainder((off / scale) + (0.5 * TWO_PI), TWO_PI) : 0.0;
        as_is += off * off;
        reversed += other * other;
    }
    return 2.0 * reversed < as_is;
}

static const char *frequency_response_subject(const mt_requirement *d, const char *what,
                                              mt_arena *mem)
{
    return mt_arena_printf(mem, "%s %s by %s as measured in \"%s\" (%d lines, %.6g to %.6g Hz)",
                           what, d->fit->ports.out->name, d->fit->ports.in->name,
                           d->goal->response_limit->measurement_name.s, d->fit->n,
                           d->fit->w[0] / TWO_PI, d->fit->w[d->fit->n - 1] / TWO_PI);
}

const mt_goal_ops mt_goal_frequency_response = {.quantity = MT_QUANTITY_OTHER,
                                                .needs_vectors = true,
                                                .compile = compile_frequency_response,
                                                .residuals = residuals,
                                                .subject = frequency_response_subject,
                                                .equals = "at"};
