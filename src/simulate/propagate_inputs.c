/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Inputs as states. An input u = p + sum of waves has
 *     p_k = p^(k) h^k/s,  p_k' = p_(k+1)/h;    g = wave/s,  g' = w g~,  g~' = -w g,
 * s a power of 2 that makes its columns of A as large as the others. These states begin each
 * step as the formula has them at that time, so that they do not drift.
 *     A fitted input has in each step the polynomial through DEGREE + 1 Chebyshev points;
 * between them it is compared, and where it differs by more than FITTED it is called coarse.
 */
#include "simulate/propagate_priv.h"

#include <math.h>
#include <string.h>

enum { DEGREE = MT_FORM_DEGREE };
static const double PI = 3.14159265358979323846;
/* What a polynomial may differ from the input that it stands for, of its largest value. */
static const double FITTED = 1e-12;

mt_status mt_propagation_forms(mt_propagation *r, bool *changed, mt_err *err)
{
    r->until = HUGE_VAL;
    *changed = r->a == NULL;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        const mt_sim_input *const in = &r->opt->inputs[i];
        mt_input_state *const s = &r->input[i];
        mt_form form;
        double until = HUGE_VAL;
        if (s->fitted) {
            continue;
        }
        const int slope = in->push == MT_SIM_BASE ? in->slope : 0;
        const bool known = mt_form_of_signal(in->signal, slope, r->t, &r->own, &form, &until);
        MT_TRY(mt_arena_check(&r->own, err));
        if (!known || (slope > 0 && isfinite(until))) {
            /* a signal that is one form at times and none at others is fitted at all of them;
             * a velocity that jumps is left to the integration */
            r->known = r->known && (slope == 0 || !isfinite(until));
            s->fitted = true;
            s->degree = DEGREE;
            s->form.n = 0;
            *changed = true;
            continue;
        }
        bool same = form.n == s->form.n && form.degree <= s->degree;
        for (int k = 0; k < form.n && same; k++) {
            same = form.wave[k].w == s->form.wave[k].w;
        }
        *changed = *changed || !same;
        s->degree = form.degree > s->degree ? form.degree : s->degree;
        s->form = form;
        r->until = fmin(r->until, until);
    }
    return MT_OK;
}

/* Add a column: input i acts with s times its state. */
static void add_input_column(mt_propagation *r, int i, int state, double scale)
{
    const double *const b = r->o.input + ((ptrdiff_t)i * r->n);
    for (int j = 0; j < r->n; j++) {
        const ptrdiff_t at = r->n + j;
        mt_propagation_add(r, (int)at, state, scale * b[j]);
        r->p[at + ((ptrdiff_t)state * r->nz)] += 0.5 * scale * b[j];
        r->p[state + (at * r->nz)] += 0.5 * scale * b[j];
    }
}

void mt_propagation_couple(mt_propagation *r, int i, double h)
{
    mt_input_state *const s = &r->input[i];
    const double most = mt_max_abs(r->n, r->o.input + ((ptrdiff_t)i * r->n));
    const double fastest = fmax(mt_max_abs(r->n, r->w), 1.0 / h);
    int exponent = 0;
    (void)frexp(most > 0.0 ? fastest / most : 1.0, &exponent);
    s->scale = ldexp(1.0, exponent);
    int at = s->first;
    for (int k = 0; k <= s->degree; k++, at++) {
        if (k == 0) {
            add_input_column(r, i, at, s->scale);
        } else {
            mt_propagation_add(r, at - 1, at, 1.0 / h);
        }
    }
    for (int k = 0; k < s->form.n; k++, at += 2) {
        add_input_column(r, i, at, s->scale);
        mt_propagation_add(r, at, at + 1, s->form.wave[k].w);
        mt_propagation_add(r, at + 1, at, -s->form.wave[k].w);
    }
}

/* p[DEGREE + 1]: derivatives at t, times h^k, of the polynomial that stands for an input from t
 * to t + h. */
static mt_status fit(mt_propagation *r, int i, double t, double h, double *p, mt_err *err)
{
    const mt_sim_input *const in = &r->opt->inputs[i];
    const int slope = in->push == MT_SIM_BASE ? in->slope : 0;
    mt_input_state *const s = &r->input[i];
    double x[DEGREE + 1];
    double c[DEGREE + 1]; /* divided differences, then coefficients, x from -1 to 1 */
    double value[3];
    for (int k = 0; k <= DEGREE; k++) {
        x[k] = -cos(PI * k / DEGREE);
        MT_TRY(mt_signal_eval(in->signal, t + (0.5 * h * (1.0 + x[k])), value, err));
        c[k] = value[slope];
        s->largest = fmax(s->largest, fabs(c[k]));
    }
    for (int d = 1; d <= DEGREE; d++) {
        for (int k = DEGREE; k >= d; k--) {
            c[k] = (c[k] - c[k - 1]) / (x[k] - x[k - d]);
        }
    }
    /* Newton's form to powers of x - y, y = 0 for the comparison, then -1: p(x) = c_0 + (x -
     * x_0)(c_1 + ...) */
    double most = 0.0;
    for (int k = 0; k < DEGREE; k++) {
        const double at = 0.5 * (x[k] + x[k + 1]);
        double sum = c[DEGREE];
        for (int d = DEGREE - 1; d >= 0; d--) {
            sum = c[d] + ((at - x[d]) * sum);
        }
        MT_TRY(mt_signal_eval(in->signal, t + (0.5 * h * (1.0 + at)), value, err));
        s->largest = fmax(s->largest, fabs(value[slope]));
        most = fmax(most, fabs(sum - value[slope]));
    }
    r->out->fit.input_error = s->largest > 0.0
                                  ? fmax(r->out->fit.input_error, most / s->largest)
                                  : r->out->fit.input_error;
    r->coarse = r->coarse || !(most <= FITTED * s->largest);
    memset(p, 0, (DEGREE + 1) * sizeof *p);
    for (int d = DEGREE; d >= 0; d--) {
        /* p := c_d + (v - 1 - x_d) p, v = x + 1 */
        for (int k = DEGREE; k >= 0; k--) {
            p[k] = (k > 0 ? p[k - 1] : c[d]) - ((1.0 + x[d]) * p[k]);
        }
    }
    double factor = 1.0; /* k! (2/h)^k h^k */
    for (int k = 1; k <= DEGREE; k++) {
        factor *= 2.0 * k;
        p[k] *= factor;
    }
    return MT_OK;
}

mt_status mt_propagation_set(mt_propagation *r, double t, double h, mt_err *err)
{
    const double unit = r->opt->sample_s;
    if (r->set_at == t && r->set_step == h) {
        return MT_OK;
    }
    r->set_at = t;
    r->set_step = h;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        mt_input_state *const s = &r->input[i];
        double p[DEGREE + 1] = {0.0};
        int at = s->first;
        r->u[i] = 0.0;
        double power = 1.0;
        if (s->fitted) {
            MT_TRY(fit(r, i, t, h, p, err));
        } else {
            mt_form_derivatives(&s->form, t, s->degree + 1, p);
        }
        for (int k = 0; k <= s->degree; k++, at++) {
            r->z[at] = p[k] * power / s->scale;
            power *= s->fitted ? unit / h : unit;
        }
        r->u[i] += p[0];
        for (int k = 0; k < s->form.n; k++, at += 2) {
            double of[2];
            mt_wave_eval(&s->form.wave[k], t, of);
            r->z[at] = of[0] / s->scale;
            r->z[at + 1] = of[1] / s->form.wave[k].w / s->scale;
            r->u[i] += of[0];
        }
    }
    return MT_OK;
}
