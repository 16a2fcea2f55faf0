/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Sums, products and integer powers of forms are forms while degrees and waves are few enough:
 *     cos a cos b = (cos(a - b) + cos(a + b))/2, and so on;
 * t sin t is none. A kink is where d = (first argument) - (second one) changes its sign: d a
 * line, or a constant with one wave, whose roots have closed forms. Between two of them its
 * sign is that in the middle.
 */
#include "simulate/form.h"

#include <math.h>
#include <string.h>

#include "expr/op.h"

static const double TWO_PI = 6.283185307179586477;
/* A root this part of a period behind t is the one at which the piece begins. */
static const double SAME_ROOT = 1e-9;

static mt_form constant(double value)
{
    return (mt_form){.degree = value == 0.0 ? -1 : 0, .c = {value}};
}

static bool is_constant(const mt_form *f)
{
    return f->degree <= 0 && f->n == 0;
}

static void trim(mt_form *f)
{
    while (f->degree >= 0 && f->c[f->degree] == 0.0) {
        f->degree--;
    }
}

static bool add_wave(mt_form *f, double w, double cosine, double sine)
{
    if (w == 0.0) {
        f->c[0] += cosine;
        f->degree = f->degree > 0 ? f->degree : 0;
        trim(f);
        return true;
    }
    const double sign = w < 0.0 ? -1.0 : 1.0;
    int at = 0;
    while (at < f->n && f->wave[at].w != sign * w) {
        at++;
    }
    if (at == MT_FORM_WAVES) {
        return false;
    }
    if (at == f->n) {
        f->wave[f->n++] = (mt_wave){.w = sign * w};
    }
    f->wave[at].cosine += cosine;
    f->wave[at].sine += sign * sine;
    if (f->wave[at].cosine == 0.0 && f->wave[at].sine == 0.0) {
        f->wave[at] = f->wave[--f->n];
    }
    return true;
}

/* out += factor * f. */
static bool add_form(mt_form *out, double factor, const mt_form *f)
{
    bool good = true;
    for (int k = 0; k <= f->degree; k++) {
        out->c[k] += factor * f->c[k];
    }
    out->degree = f->degree > out->degree ? f->degree : out->degree;
    trim(out);
    for (int i = 0; i < f->n && good && factor != 0.0; i++) {
        good =
            add_wave(out, f->wave[i].w, factor * f->wave[i].cosine, factor * f->wave[i].sine);
    }
    return good;
}

/* out = a b. */
static bool multiply_forms(const mt_form *a, const mt_form *b, mt_form *out)
{
    bool good = a->degree + b->degree <= MT_FORM_DEGREE && (a->n == 0 || b->degree <= 0) &&
                (b->n == 0 || a->degree <= 0);
    *out = (mt_form){.degree = -1};
    for (int i = 0; i <= a->degree && good; i++) {
        for (int k = 0; k <= b->degree; k++) {
            out->c[i + k] += a->c[i] * b->c[k];
        }
    }
    out->degree = good && a->degree >= 0 && b->degree >= 0 ? a->degree + b->degree : -1;
    trim(out);
    for (int i = 0; i < a->n && good && b->degree == 0; i++) {
        good =
            add_wave(out, a->wave[i].w, b->c[0] * a->wave[i].cosine, b->c[0] * a->wave[i].sine);
    }
    for (int i = 0; i < b->n && good && a->degree == 0; i++) {
        good =
            add_wave(out, b->wave[i].w, a->c[0] * b->wave[i].cosine, a->c[0] * b->wave[i].sine);
    }
    for (int i = 0; i < a->n; i++) {
        for (int k = 0; k < b->n && good; k++) {
            const mt_wave p = a->wave[i];
            const mt_wave q = b->wave[k];
            const double cc = 0.5 * p.cosine * q.cosine;
            const double ss = 0.5 * p.sine * q.sine;
            const double sc = 0.5 * p.sine * q.cosine;
            const double cs = 0.5 * p.cosine * q.sine;
            good = add_wave(out, p.w - q.w, cc + ss, sc - cs) &&
                   add_wave(out, p.w + q.w, cc - ss, sc + cs);
        }
    }
    return good;
}

/* sin or cos of a line. */
static bool wave_of(bool sine, const mt_form *a, mt_form *out)
{
    *out = (mt_form){.degree = -1};
    if (a->degree > 1 || a->n > 0) {
        return false;
    }
    const double phase = a->degree >= 0 ? a->c[0] : 0.0;
    const double w = a->degree == 1 ? a->c[1] : 0.0;
    return sine ? add_wave(out, w, sin(phase), cos(phase))
                : add_wave(out, w, cos(phase), -sin(phase));
}

static bool power(const mt_form *a, const mt_form *b, mt_form *out)
{
    const double exponent = b->degree == 0 ? b->c[0] : 0.0;
    if (!is_constant(b) || exponent != floor(exponent) || exponent < 0.0 ||
        exponent > MT_FORM_DEGREE) {
        return false;
    }
    *out = constant(1.0);
    for (int i = 0; i < (int)exponent; i++) {
        const mt_form so_far = *out;
        if (!multiply_forms(&so_far, a, out)) {
            return false;
        }
    }
    return true;
}

void mt_wave_eval(const mt_wave *w, double t, double out[2])
{
    const double c = cos(w->w * t);
    const double s = sin(w->w * t);
    out[0] = (w->cosine * c) + (w->sine * s);
    out[1] = w->w * ((w->sine * c) - (w->cosine * s));
}

void mt_form_derivatives(const mt_form *f, double t, int count, double *out)
{
    double c[MT_FORM_DEGREE + 1];
    int degree = f->degree;
    memcpy(c, f->c, sizeof c);
    for (int k = 0; k < count; k++) {
        out[k] = 0.0;
        for (int i = degree; i >= 0; i--) {
            out[k] = (out[k] * t) + c[i];
        }
        for (int i = 1; i <= degree; i++) {
            c[i - 1] = i * c[i];
        }
        degree--;
    }
}

static double value_at(const mt_form *f, double t)
{
    double value = 0.0;
    mt_form_derivatives(f, t, 1, &value);
    for (int i = 0; i < f->n; i++) {
        double of[2];
        mt_wave_eval(&f->wave[i], t, of);
        value += of[0];
    }
    return value;
}

/* The first root of d behind t, infinite where there is none. false: not known. */
static bool next_root(const mt_form *d, double t, double *root)
{
    *root = HUGE_VAL;
    if (d->n == 0 && d->degree <= 1) {
        const double at = d->degree == 1 ? -d->c[0] / d->c[1] : HUGE_VAL;
        *root = at > t ? at : HUGE_VAL;
        return true;
    }
    if (d->n != 1 || d->degree > 0) {
        return false;
    }
    /* size sin(w t + phase) = -c */
    const mt_wave w = d->wave[0];
    const double size = hypot(w.cosine, w.sine);
    const double c = d->degree == 0 ? d->c[0] : 0.0;
    const double phase = atan2(w.cosine, w.sine);
    if (!(fabs(c) < size)) {
        return true;
    }
    const double up = asin(-c / size);
    const double angles[2] = {up - phase, (0.5 * TWO_PI) - up - phase};
    const double period = TWO_PI / w.w;
    for (int i = 0; i < 2; i++) {
        const double turns = floor((t / period) - (angles[i] / TWO_PI) + SAME_ROOT) + 1.0;
        *root = fmin(*root, (angles[i] + (TWO_PI * turns)) / w.w);
    }
    return true;
}

/* The form of min (sign -1) or max (1) of two forms just after t; a sign of 0: |a - b|. */
static bool form_of_min_or_max(int sign, const mt_form *a, const mt_form *b, double t,
                               double *until, mt_form *out)
{
    mt_form d = *a;
    double root = HUGE_VAL;
    if (!add_form(&d, -1.0, b) || !next_root(&d, t, &root)) {
        return false;
    }
    *until = fmin(*until, root);
    const double middle = isfinite(root) ? 0.5 * (t + root) : t + 1.0;
    const bool above = value_at(&d, middle) >= 0.0;
    if (sign == 0) {
        *out = constant(0.0);
        return add_form(out, above ? 1.0 : -1.0, &d);
    }
    *out = above == (sign > 0) ? *a : *b;
    return true;
}

/* One operation, not a leaf. */
static bool operate(mt_op op, const mt_form *a, const mt_form *b, double t, double *until,
                    mt_form *out)
{
    const mt_form none = constant(0.0);
    switch ((int)op) {
    case MT_OP_NEG:
        *out = none;
        return add_form(out, -1.0, a);
    case MT_OP_ADD:
    case MT_OP_SUB:
        *out = *a;
        return add_form(out, op == MT_OP_ADD ? 1.0 : -1.0, b);
    case MT_OP_MUL:
        return multiply_forms(a, b, out);
    case MT_OP_DIV:
        *out = none;
        return is_constant(b) && b->degree == 0 && add_form(out, 1.0 / b->c[0], a);
    case MT_OP_POW:
        return power(a, b, out);
    case MT_OP_SIN:
    case MT_OP_COS:
        return wave_of(op == MT_OP_SIN, a, out);
    case MT_OP_ABS:
        return form_of_min_or_max(0, a, &none, t, until, out);
    case MT_OP_MIN:
    case MT_OP_MAX:
        return form_of_min_or_max(op == MT_OP_MAX ? 1 : -1, a, b, t, until, out);
    default:
        return false;
    }
}

/* Evaluate an operation whose operands are constants. */
static bool fold(const mt_program_node *n, const mt_form *a, const mt_form *b, mt_form *out)
{
    const bool two = n->b != MT_NO_NODE;
    if (!is_constant(a) || (two && !is_constant(b))) {
        return false;
    }
    const double value = mt_op_value(n->op, a->degree == 0 ? a->c[0] : 0.0,
                                     two && b->degree == 0 ? b->c[0] : 0.0);
    *out = constant(value);
    return isfinite(value);
}

static bool form_of_program(const mt_signal *s, double t, mt_arena *mem, mt_form *out,
                            double *until)
{
    const mt_program *const p = s->program;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_form *const form = mt_arena_alloc(mem, (size_t)p->count, sizeof *form);
    bool *const known = mt_arena_alloc(mem, (size_t)p->count, sizeof *known);
    const bool room = !mt_arena_failed(mem);
    for (int i = 0; i < p->count && room; i++) {
        const mt_program_node *const n = &p->nodes[i];
        if (n->op == MT_OP_CONST) {
            form[i] = constant(n->value);
            known[i] = true;
        } else if (n->op == MT_OP_PARAM) {
            form[i] = (mt_form){.degree = 1, .c = {0.0, 1.0}};
            known[i] = true;
        } else if (known[n->a] && (n->b == MT_NO_NODE || known[n->b])) {
            const mt_form *const b = n->b == MT_NO_NODE ? NULL : &form[n->b];
            double own = HUGE_VAL;
            known[i] = fold(n, &form[n->a], b, &form[i]) ||
                       operate(n->op, &form[n->a], b, t, &own, &form[i]);
            *until = fmin(*until, own);
        }
    }
    const bool good = room && known[s->node];
    if (good) {
        *out = form[s->node];
    }
    mt_arena_rewind(mem, mark);
    return good;
}

/* f := f'. */
static void differentiate(mt_form *f)
{
    for (int k = 1; k <= f->degree; k++) {
        f->c[k - 1] = k * f->c[k];
    }
    if (f->degree >= 0) {
        f->c[f->degree--] = 0.0;
    }
    for (int i = 0; i < f->n; i++) {
        const mt_wave w = f->wave[i];
        f->wave[i] = (mt_wave){w.w, w.w * w.sine, -w.w * w.cosine};
    }
}

bool mt_form_of_signal(const mt_signal *s, int slope, double t, mt_arena *mem, mt_form *out,
                       double *until)
{
    bool good = true;
    *out = constant(0.0);
    *until = HUGE_VAL;
    switch (s->kind) {
    case MT_SIGNAL_SINES:
        for (int i = 0; i < s->n && good; i++) {
            const mt_sine *const w = &s->sines[i];
            good = add_wave(out, TWO_PI * w->hz, w->amplitude * sin(w->phase),
                            w->amplitude * cos(w->phase));
        }
        break;
    case MT_SIGNAL_LINES:
        good = s->n <= MT_FORM_WAVES;
        for (int i = 0; i < s->n && good; i++) {
            good = add_wave(out, TWO_PI * (s->from_hz + (i * s->step_hz)), s->sine[i],
                            s->cosine[i]);
        }
        break;
    case MT_SIGNAL_SWEEP:
        good = s->from_hz == s->to_hz && add_wave(out, TWO_PI * s->from_hz, 0.0, s->level);
        break;
    case MT_SIGNAL_EXPRESSION:
        good = form_of_program(s, t, mem, out, until);
        break;
    }
    for (int k = 0; k < slope && good; k++) {
        differentiate(out);
    }
    return good;
}
