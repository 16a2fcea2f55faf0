/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear motion without integration: oscillators of its modes, inputs as states, turning
 * points, and the steps. */
#include "simulate/propagate.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "expr/op.h"
#include "linalg/exponential.h"
#include "mechanics/affine.h"
#include "mechanics/eliminate.h"
#include "modal/modal.h"

/* Inputs as polynomials and sines. */

/*
 * A function of time as a polynomial and sines,
 *     u(t) = sum_k c_k t^k + sum_i (a_i cos w_i t + b_i sin w_i t),
 * a solution of a linear equation u^(m) = ... without input: such inputs are states of a linear
 * system of their own. Steps, ramps and samples joined by lines have this form piece by piece.
 */
enum { FORM_DEGREE = 8, FORM_WAVES = 24 };

typedef struct wave {
    double w; /* > 0 [rad/s] */
    double cosine;
    double sine;
} wave;

typedef struct form {
    int degree; /* of the polynomial; -1: none */
    double c[FORM_DEGREE + 1];
    int n;
    wave wave[FORM_WAVES];
} form;

/*
 * Sums, products and integer powers of forms are forms while degrees and waves are few enough:
 *     cos a cos b = (cos(a - b) + cos(a + b))/2, and so on;
 * t sin t is none. A kink is where d = (first argument) - (second one) changes its sign: d a
 * line, or a constant with one wave, whose roots have closed forms. Between two of them its
 * sign is that in the middle.
 */

static const double TWO_PI = 6.283185307179586477;
/* A root this part of a period behind t is the one at which the piece begins. */
static const double SAME_ROOT = 1e-9;

static form constant(double value)
{
    return (form){.degree = value == 0.0 ? -1 : 0, .c = {value}};
}

static bool is_constant(const form *f)
{
    return f->degree <= 0 && f->n == 0;
}

static void trim(form *f)
{
    while (f->degree >= 0 && f->c[f->degree] == 0.0) {
        f->degree--;
    }
}

static bool add_wave(form *f, double w, double cosine, double sine)
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
    if (at == FORM_WAVES) {
        return false;
    }
    if (at == f->n) {
        f->wave[f->n++] = (wave){.w = sign * w};
    }
    f->wave[at].cosine += cosine;
    f->wave[at].sine += sign * sine;
    if (f->wave[at].cosine == 0.0 && f->wave[at].sine == 0.0) {
        f->wave[at] = f->wave[--f->n];
    }
    return true;
}

/* out += factor * f. */
static bool add_form(form *out, double factor, const form *f)
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
static bool multiply_forms(const form *a, const form *b, form *out)
{
    bool good = a->degree + b->degree <= FORM_DEGREE && (a->n == 0 || b->degree <= 0) &&
                (b->n == 0 || a->degree <= 0);
    *out = (form){.degree = -1};
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
            const wave p = a->wave[i];
            const wave q = b->wave[k];
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
static bool wave_of(bool sine, const form *a, form *out)
{
    *out = (form){.degree = -1};
    if (a->degree > 1 || a->n > 0) {
        return false;
    }
    const double phase = a->degree >= 0 ? a->c[0] : 0.0;
    const double w = a->degree == 1 ? a->c[1] : 0.0;
    return sine ? add_wave(out, w, sin(phase), cos(phase))
                : add_wave(out, w, cos(phase), -sin(phase));
}

static bool power(const form *a, const form *b, form *out)
{
    const double exponent = b->degree == 0 ? b->c[0] : 0.0;
    if (!is_constant(b) || exponent != floor(exponent) || exponent < 0.0 ||
        exponent > FORM_DEGREE) {
        return false;
    }
    *out = constant(1.0);
    for (int i = 0; i < (int)exponent; i++) {
        const form so_far = *out;
        if (!multiply_forms(&so_far, a, out)) {
            return false;
        }
    }
    return true;
}

/* Value and derivative of one wave at t. */
static void wave_eval(const wave *w, double t, double out[2])
{
    const double c = cos(w->w * t);
    const double s = sin(w->w * t);
    out[0] = (w->cosine * c) + (w->sine * s);
    out[1] = w->w * ((w->sine * c) - (w->cosine * s));
}

/* out[k] = derivative of order k at t, k < count. */
static void form_derivatives(const form *f, double t, int count, double *out)
{
    double c[FORM_DEGREE + 1];
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

static double value_at(const form *f, double t)
{
    double value = 0.0;
    form_derivatives(f, t, 1, &value);
    for (int i = 0; i < f->n; i++) {
        double of[2];
        wave_eval(&f->wave[i], t, of);
        value += of[0];
    }
    return value;
}

/* The first root of d behind t, infinite where there is none. false: not known. */
static bool next_root(const form *d, double t, double *root)
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
    const wave w = d->wave[0];
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
static bool form_of_min_or_max(int sign, const form *a, const form *b, double t, double *until,
                               form *out)
{
    form d = *a;
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
static bool operate(mt_op op, const form *a, const form *b, double t, double *until, form *out)
{
    const form none = constant(0.0);
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
static bool fold(const mt_program_node *n, const form *a, const form *b, form *out)
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

static bool form_of_program(const mt_signal *s, double t, mt_arena *mem, form *out,
                            double *until)
{
    const mt_program *const p = s->program;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    form *const forms = mt_arena_alloc(mem, (size_t)p->count, sizeof *forms);
    bool *const known = mt_arena_alloc(mem, (size_t)p->count, sizeof *known);
    const bool room = !mt_arena_failed(mem);
    for (int i = 0; i < p->count && room; i++) {
        const mt_program_node *const n = &p->nodes[i];
        if (n->op == MT_OP_CONST) {
            forms[i] = constant(n->value);
            known[i] = true;
        } else if (n->op == MT_OP_PARAM) {
            forms[i] = (form){.degree = 1, .c = {0.0, 1.0}};
            known[i] = true;
        } else if (known[n->a] && (n->b == MT_NO_NODE || known[n->b])) {
            const form *const b = n->b == MT_NO_NODE ? NULL : &forms[n->b];
            double own = HUGE_VAL;
            known[i] = fold(n, &forms[n->a], b, &forms[i]) ||
                       operate(n->op, &forms[n->a], b, t, &own, &forms[i]);
            *until = fmin(*until, own);
        }
    }
    const bool good = room && known[s->node];
    if (good) {
        *out = forms[s->node];
    }
    mt_arena_rewind(mem, mark);
    return good;
}

/* f := f'. */
static void differentiate(form *f)
{
    for (int k = 1; k <= f->degree; k++) {
        f->c[k - 1] = k * f->c[k];
    }
    if (f->degree >= 0) {
        f->c[f->degree--] = 0.0;
    }
    for (int i = 0; i < f->n; i++) {
        const wave w = f->wave[i];
        f->wave[i] = (wave){w.w, w.w * w.sine, -w.w * w.cosine};
    }
}

/* The derivative of order `slope` of the signal just after t, as a form, which holds up to
 * *until (infinite: for all times). False where it has no known form: a varying frequency,
 * exp(t), a kink at a place without a closed form. Kinks are places where an argument of abs,
 * min or max changes sign. mem remembers a shortage. */
static bool form_of_signal(const mt_signal *s, int slope, double t, mt_arena *mem, form *out,
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
        good = s->n <= FORM_WAVES;
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

/* The motion of the modes. */

/*
 * A mechanism of linear equations (mechanics/affine.h) in modal coordinates,
 *     q = phi e,   e'' + C e' + diag(lambda) e = sum_i b_i u_i(t),
 * phi^T M phi = 1, u_i the inputs.
 */
typedef struct oscillators {
    mt_linear *lin;
    const mt_system *sys;
    const mt_sim_options *opt;
    mt_affine affine;
    mt_motion motion; /* the whole equations, for oscillators_check */
    mt_placement at;
    int nq;
    int n;
    const double *lambda; /* [n] [1/s^2] */
    const double *y;      /* n x n: the freedoms are y e */
    double *phi;          /* nq x n */
    double *damping;      /* n x n: C; 0 without dampers */
    double *input;        /* n x inputs: b_i */
    double *gauge;        /* gauges x n: derivative of a gauge's value by e */
    double *still;        /* [gauges] its value at rest */
    double *length;       /* lengths x n: derivative of distances by e */
    double *noise;        /* [n] forces along e from rounding of positions */
    double *work[3];      /* [nq] */
    double *row;          /* [nq] */
} oscillators;

/* The largest deviations so far of states of the linear motion from the equations of
 * mechanics/motion.h. */
typedef struct oscillators_fit {
    double residual;  /* largest of phi^T (M q'' - f) */
    double excess;    /* the same less the part from rounding of positions */
    double size;      /* largest of the terms whose difference it is */
    double gap_m;     /* largest gap of a joint */
    bool independent; /* the rank of the joints is that at rest */
} oscillators_fit;

/* The states of one input. */
typedef struct input_state {
    bool fitted;
    int first;  /* index of its first state */
    int degree; /* of the polynomial; -1: none */
    double scale;
    form form; /* the present form */
    double largest;
} input_state;

typedef struct propagation {
    oscillators o;
    const mt_sim_options *opt;
    mt_arena *mem;
    mt_arena own; /* the matrices of a piece */
    mt_sim_result *out;
    int room;
    int n;  /* modes */
    int nz; /* states */
    double *w;
    input_state *input;
    double *a; /* nz x nz */
    double *p;
    double *see;          /* gauges x nz: accelerations of gauges */
    mt_exponential whole; /* over one sample */
    bool has_whole;
    int halvings; /* halvings of each step */
    double *z;
    double *begin; /* [nz] at the beginning of the step */
    double *inner; /* [nz] within the step */
    double *rate;  /* [nz] z' */
    double *work;  /* [nz] */
    double *u;     /* [inputs] */
    double t;
    double until; /* end of the present piece */
    double done;  /* work [J] */
    double energy0;
    double potential0;
    double set_at; /* time of the states of inputs, NaN: none */
    double set_step;
    int pieces;          /* pieces of the inputs so far */
    double free_state;   /* |(a, b)| below which no distance becomes 0 */
    double fast;         /* largest speed of a body so far [m/s] */
    double *turn_weight; /* [nq] 1, or the model's length on rotations */
    double *speed;       /* [gauges] at the beginning of the step */
    double *checked;     /* CHECKS x (n e, n e', n e'', inputs): states to be checked */
    double *weight;      /* [CHECKS] size of these states */
    bool known;          /* inputs and lengths meet the conditions of this method */
    bool coarse;         /* the polynomial of an input does not fit it */
} propagation;

static inline void propagation_add(propagation *r, int row, int column, double value)
{
    r->a[row + ((ptrdiff_t)column * r->nz)] += value;
}

static void oscillators_position(oscillators *o, const double *e, const double *rate,
                                 mt_placement *at, double *v);

/*
 * Coordinates of modes, because frequencies may lie far apart: lambda then has the digits that
 * the springs have (modal/solve.c), which sums of their matrices lose.
 *     A check puts a state into the whole equations, with positions, angles and velocity terms:
 * along phi, which the forces of joints do no work on,
 *     r = phi^T (M q'' - f(g, v) - inputs)
 * is 0 but for rounding. Of positions of size l, that is eps l times what a spring makes of it,
 * sum |k_t| |f_t| |f_t phi|; of the terms of r, eps of the largest.
 */

/* Rounding errors that a residual may have, of its largest term, and of positions. */
static const double FITS = 1e-10;
static const double ROUNDING = 64.0 * DBL_EPSILON;
/* A start is one of the linear motion to this part of its size and the model's length. */
static const double STARTS = 1e-12;

static mt_status allocate_oscillators(oscillators *o, mt_arena *mem, mt_err *err)
{
    const size_t nq = (size_t)o->nq;
    const size_t n = (size_t)o->n;
    MT_TRY(mt_motion_init(&o->motion, o->lin, mem, err));
    MT_TRY(mt_placement_init(&o->at, o->sys, mem, err));
    o->phi = mt_arena_f64(mem, nq, n);
    o->damping = mt_arena_f64(mem, n, n);
    o->input = mt_arena_f64(mem, n, (size_t)o->opt->n_inputs);
    o->gauge = mt_arena_f64(mem, (size_t)o->opt->n_gauges, n);
    o->still = mt_arena_f64(mem, (size_t)o->opt->n_gauges, 1);
    o->length = mt_arena_f64(mem, (size_t)o->affine.n_lengths, n);
    o->noise = mt_arena_f64(mem, n, 1);
    o->row = mt_arena_f64(mem, nq, 1);
    for (int i = 0; i < MT_COUNT(o->work); i++) {
        o->work[i] = mt_arena_f64(mem, nq, 1);
    }
    return mt_arena_check(mem, err);
}

/* Modes with all shapes; *good false: a direction without mass, or they do not converge. */
static mt_status find_modes(oscillators *o, mt_arena *mem, bool *good, mt_err *err)
{
    const mt_reduced r = mt_linear_reduced(o->lin);
    mt_mass_factor *const mass = mt_arena_alloc(mem, 1, sizeof *mass);
    mt_modes modes;
    MT_TRY(mt_arena_check(mem, err));
    mt_status rc = mt_modal_factor_mass(r.n, r.m, mem, mass, NULL);
    *good = rc == MT_OK && mass->rank == r.n;
    if (*good) {
        const mt_stiffness_factor factor = {
            .rows = r.rows, .b = r.b, .c = r.c, .noise = r.noise, .g = r.g};
        mt_modal_options options = mt_modal_options_default();
        options.accuracy = MT_MODAL_ACCURACY;
        rc = mt_modal_solve(r.k, mass, &factor, &options, mem, &modes, NULL);
        *good = rc == MT_OK && modes.shaped == r.n;
    }
    if (rc == MT_E_MEMORY) {
        return mt_fail_memory(err);
    }
    if (*good) {
        o->lambda = modes.lambda;
        o->y = modes.y;
    }
    return MT_OK;
}

/* C = y^T (Z^T C Z) y. */
static mt_status find_damping(oscillators *o, mt_arena *mem, mt_err *err)
{
    const int n = o->n;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    double *const c = mt_arena_f64(mem, (size_t)n, (size_t)n);
    double *const cy = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    mt_linear_damping(o->lin, c);
    mt_gemm(false, false, n, n, n, 1.0, c, n, o->y, n, 0.0, cy, n);
    mt_gemm(true, false, n, n, n, 1.0, o->y, n, cy, n, 0.0, o->damping, n);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

/* noise: sum over springs of |k| |f| |f phi|, f as the rows over the freedoms. */
static void find_noise(oscillators *o)
{
    const mt_term_list *const list = mt_linear_terms(o->lin, MT_TERM_STIFFNESS);
    double *const along = o->work[0];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const double *const f = mt_linear_row(o->lin, MT_TERM_STIFFNESS, i);
        const double k = fabs(mt_linear_value(o->lin, t->coefficient));
        mt_gemv(true, o->n, o->n, k * mt_norm2(o->n, f), o->y, o->n, f, 0.0, along);
        for (int j = 0; j < o->n; j++) {
            o->noise[j] += fabs(along[j]) * ROUNDING * o->sys->length_m;
        }
    }
}

/* The force of input i at rest along all states, into o->row. */
static void input_row(oscillators *o, const mt_sim_input *in, mt_gauge_motion *gauge)
{
    if (in->push == MT_SIM_FORCE) {
        const mt_gauge g = {.channel = in->at, .joint = -1};
        mt_motion_gauge(&o->motion, &o->at, o->work[0], g, gauge);
        return;
    }
    memset(o->row, 0, (size_t)o->nq * sizeof *o->row);
    mt_motion_base(&o->motion, &o->at, in->at, 1.0, o->row);
}

/* Rows of inputs, gauges and lengths, all at rest. */
static void find_rows(oscillators *o)
{
    mt_gauge_motion gauge = {.row = o->row};
    memset(o->work[0], 0, (size_t)o->nq * sizeof *o->work[0]);
    for (int i = 0; i < o->opt->n_inputs; i++) {
        input_row(o, &o->opt->inputs[i], &gauge);
        mt_gemv(true, o->nq, o->n, 1.0, o->phi, o->nq, o->row, 0.0,
                o->input + ((ptrdiff_t)i * o->n));
    }
    for (ptrdiff_t g = 0; g < o->opt->n_gauges; g++) {
        mt_motion_gauge(&o->motion, &o->at, o->work[0], o->opt->gauges[g], &gauge);
        o->still[g] = mt_motion_has_value(o->sys, o->opt->gauges[g]) ? gauge.value : 0.0;
        for (ptrdiff_t j = 0; j < o->n; j++) {
            o->gauge[g + (j * o->opt->n_gauges)] = mt_dot(o->nq, o->row, o->phi + (j * o->nq));
        }
    }
    for (ptrdiff_t i = 0; i < o->affine.n_lengths; i++) {
        for (ptrdiff_t j = 0; j < o->n; j++) {
            o->length[i + (j * o->affine.n_lengths)] =
                mt_dot(o->n, o->affine.length[i].slope, o->y + (j * o->n));
        }
    }
}

/* True where inputs and gauges are linear. */
static bool has_linear_ports(const oscillators *o)
{
    bool linear = true;
    for (int i = 0; i < o->opt->n_inputs; i++) {
        const mt_sim_input *const in = &o->opt->inputs[i];
        const mt_gauge g = {.channel = in->at, .joint = -1};
        linear = linear && in->push != MT_SIM_MOVE &&
                 (in->push != MT_SIM_FORCE || mt_affine_gauge(o->lin, &o->affine, g));
    }
    for (int i = 0; i < o->opt->n_gauges; i++) {
        linear = linear && mt_affine_gauge(o->lin, &o->affine, o->opt->gauges[i]);
    }
    return linear;
}

/* *linear false: the equations are not linear, or not known to be; *out is then invalid. Fails:
 * MT_E_MEMORY, MT_E_DOMAIN. */
static mt_status oscillators_make(mt_linear *lin, const mt_sim_options *opt, mt_arena *mem,
                                  oscillators *out, bool *linear, mt_err *err)
{
    *out = (oscillators){.lin = lin, .sys = mt_linear_system(lin), .opt = opt};
    MT_TRY(mt_affine_make(lin, mem, &out->affine, err));
    out->nq = out->sys->nq;
    out->n = out->affine.n;
    *linear = out->affine.linear && out->n > 0 && has_linear_ports(out);
    if (!*linear) {
        return MT_OK;
    }
    MT_TRY(find_modes(out, mem, linear, err));
    if (!*linear) {
        return MT_OK;
    }
    MT_TRY(allocate_oscillators(out, mem, err));
    mt_linear_expand(lin, out->n, out->y, out->phi);
    mt_placement_copy(out->sys, &mt_linear_position(lin)->at, &out->at);
    mt_motion_eval(&out->motion, &out->at, out->work[0]);
    MT_TRY(find_damping(out, mem, err));
    find_noise(out);
    find_rows(out);
    return MT_OK;
}

/* out[n] = phi^T M q; returns true where phi out is q. */
static bool project_on_modes(oscillators *o, const double *q, double scale, double *out)
{
    double *const mq = o->work[1];
    mt_gemv(false, o->nq, o->nq, 1.0, o->motion.mass, o->nq, q, 0.0, mq);
    mt_gemv(true, o->nq, o->n, 1.0, o->phi, o->nq, mq, 0.0, out);
    memcpy(mq, q, (size_t)o->nq * sizeof *mq);
    const double size = mt_max_abs(o->nq, q);
    mt_gemv(false, o->nq, o->n, -1.0, o->phi, o->nq, out, 1.0, mq);
    return mt_max_abs(o->nq, mq) <= STARTS * (size + scale);
}

/* e[n] and its rate at a start; *linear false: the start is not a state of this linear
 * motion. */
static mt_status oscillators_start(oscillators *o, const mt_sim_start *start, double *e,
                                   double *rate, bool *linear)
{
    const mt_placement *const rest = &mt_linear_position(o->lin)->at;
    double *const way = o->work[0];
    mt_placement_copy(o->sys, rest, &o->at);
    memset(way, 0, (size_t)o->nq * sizeof *way);
    mt_motion_eval(&o->motion, &o->at, way);
    mt_poses_increment(o->sys, rest->pose, start->at.pose, way);
    *linear = project_on_modes(o, way, o->sys->length_m, e);
    *linear = project_on_modes(o, start->v, 0.0, rate) && *linear;
    /* whole turns are no part of the way */
    oscillators_position(o, e, rate, &o->at, way);
    for (int i = 0; i < o->sys->n_measures; i++) {
        const double off = o->at.turn[i] - start->at.turn[i];
        *linear = *linear && (o->sys->measures[i].kind != MT_MEASURE_ANGLE || fabs(off) < 1.0);
    }
    return MT_OK;
}

/* The position at e, and its velocities v[nq]. */
static void oscillators_position(oscillators *o, const double *e, const double *rate,
                                 mt_placement *at, double *v)
{
    double *const y = o->work[1];
    mt_gemv(false, o->n, o->n, 1.0, o->y, o->n, e, 0.0, y);
    mt_affine_position(o->lin, &o->affine, y, o->work[2], at);
    mt_gemv(false, o->nq, o->n, 1.0, o->phi, o->nq, rate, 0.0, v);
}

/* Update *fit with the deviation at a state with accelerations `second` and inputs
 * u[inputs]. */
static mt_status oscillators_check(oscillators *o, const double *e, const double *rate,
                                   const double *second, const double *u, mt_arena *scratch,
                                   oscillators_fit *fit, mt_err *err)
{
    const int n = o->n;
    const int rank = o->nq - n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const f = mt_arena_f64(scratch, (size_t)o->nq, 1);
    double *const r = mt_arena_f64(scratch, (size_t)n, 1);
    double *const damped = mt_arena_f64(scratch, (size_t)n, 1);
    mt_elimination joints;
    MT_TRY(mt_arena_check(scratch, err));
    oscillators_position(o, e, rate, &o->at, o->row);
    mt_motion_eval(&o->motion, &o->at, o->row);
    MT_TRY(mt_eliminate_factor(o->sys, o->motion.m, o->motion.a, scratch, &joints, err));
    for (int i = 0; i < o->motion.m; i++) {
        const double gap = fabs(o->motion.gap[i]) * joints.dr[i];
        fit->gap_m = !(gap <= fit->gap_m) ? gap : fit->gap_m;
    }
    mt_gemv(true, o->nq, n, -1.0, o->phi, o->nq, o->motion.force, 0.0, r);
    mt_gemv(false, n, n, 1.0, o->damping, n, rate, 0.0, damped);
    mt_gemv(false, o->nq, n, 1.0, o->phi, o->nq, second, 0.0, o->row);
    mt_gemv(false, o->nq, o->nq, 1.0, o->motion.mass, o->nq, o->row, 0.0, f);
    mt_gemv(true, o->nq, n, 1.0, o->phi, o->nq, f, 1.0, r);
    fit->independent = fit->independent && joints.qr.rank == rank;
    for (int j = 0; j < n; j++) {
        fit->size = fmax(fit->size, fabs(second[j]));
        fit->size = fmax(fit->size, fabs(o->lambda[j] * e[j]));
        fit->size = fmax(fit->size, fabs(damped[j]));
    }
    for (int i = 0; i < o->opt->n_inputs; i++) {
        const double *const b = o->input + ((ptrdiff_t)i * n);
        mt_axpy(n, -u[i], b, r);
        fit->size = fmax(fit->size, fabs(u[i]) * mt_max_abs(n, b));
    }
    for (int j = 0; j < n; j++) {
        const double excess = fabs(r[j]) - o->noise[j];
        fit->residual = fmax(fit->residual, fabs(r[j]));
        fit->excess = !(excess <= fit->excess) ? excess : fit->excess;
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

/* True where the deviation is rounding. */
static bool oscillators_fits(const oscillators_fit *fit)
{
    return fit->independent && fit->excess <= FITS * fit->size;
}

/*
 * Inputs as states. An input u = p + sum of waves has
 *     p_k = p^(k) h^k/s,  p_k' = p_(k+1)/h;    g = wave/s,  g' = w g~,  g~' = -w g,
 * s a power of 2 that makes its columns of A as large as the others. These states begin each
 * step as the formula has them at that time, so that they do not drift.
 *     A fitted input has in each step the polynomial through DEGREE + 1 Chebyshev points;
 * between them it is compared, and where it differs by more than FITTED it is called coarse.
 */

enum { DEGREE = FORM_DEGREE };
static const double PI = 3.14159265358979323846;
/* What a polynomial may differ from the input that it stands for, of its largest value. */
static const double FITTED = 1e-12;

/* Set the forms of all inputs after r->t, r->until and r->known. *changed: their states differ
 * from those before, or there were none. */
static mt_status propagation_forms(propagation *r, bool *changed, mt_err *err)
{
    r->until = HUGE_VAL;
    *changed = r->a == NULL;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        const mt_sim_input *const in = &r->opt->inputs[i];
        input_state *const s = &r->input[i];
        form now;
        double until = HUGE_VAL;
        if (s->fitted) {
            continue;
        }
        const int slope = in->push == MT_SIM_BASE ? in->slope : 0;
        const bool known = form_of_signal(in->signal, slope, r->t, &r->own, &now, &until);
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
        bool same = now.n == s->form.n && now.degree <= s->degree;
        for (int k = 0; k < now.n && same; k++) {
            same = now.wave[k].w == s->form.wave[k].w;
        }
        *changed = *changed || !same;
        s->degree = now.degree > s->degree ? now.degree : s->degree;
        s->form = now;
        r->until = fmin(r->until, until);
    }
    return MT_OK;
}

/* Add a column: input i acts with s times its state. */
static void add_input_column(propagation *r, int i, int state, double scale)
{
    const double *const b = r->o.input + ((ptrdiff_t)i * r->n);
    for (int j = 0; j < r->n; j++) {
        const ptrdiff_t at = r->n + j;
        propagation_add(r, (int)at, state, scale * b[j]);
        r->p[at + ((ptrdiff_t)state * r->nz)] += 0.5 * scale * b[j];
        r->p[state + (at * r->nz)] += 0.5 * scale * b[j];
    }
}

/* Set the entries of input i in A and P; h: unit of time of its polynomial. */
static void propagation_couple(propagation *r, int i, double h)
{
    input_state *const s = &r->input[i];
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
            propagation_add(r, at - 1, at, 1.0 / h);
        }
    }
    for (int k = 0; k < s->form.n; k++, at += 2) {
        add_input_column(r, i, at, s->scale);
        propagation_add(r, at, at + 1, s->form.wave[k].w);
        propagation_add(r, at + 1, at, -s->form.wave[k].w);
    }
}

/* p[DEGREE + 1]: derivatives at t, times h^k, of the polynomial that stands for an input from t
 * to t + h. */
static mt_status fit(propagation *r, int i, double t, double h, double *p, mt_err *err)
{
    const mt_sim_input *const in = &r->opt->inputs[i];
    const int slope = in->push == MT_SIM_BASE ? in->slope : 0;
    input_state *const s = &r->input[i];
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

/* Set the states of inputs at t, the beginning of a step h (the end where h < 0), and r->u. */
static mt_status propagation_set(propagation *r, double t, double h, mt_err *err)
{
    const double unit = r->opt->sample_s;
    if (r->set_at == t && r->set_step == h) {
        return MT_OK;
    }
    r->set_at = t;
    r->set_step = h;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        input_state *const s = &r->input[i];
        double p[DEGREE + 1] = {0.0};
        int at = s->first;
        r->u[i] = 0.0;
        double power = 1.0;
        if (s->fitted) {
            MT_TRY(fit(r, i, t, h, p, err));
        } else {
            form_derivatives(&s->form, t, s->degree + 1, p);
        }
        for (int k = 0; k <= s->degree; k++, at++) {
            r->z[at] = p[k] * power / s->scale;
            power *= s->fitted ? unit / h : unit;
        }
        r->u[i] += p[0];
        for (int k = 0; k < s->form.n; k++, at += 2) {
            double of[2];
            wave_eval(&s->form.wave[k], t, of);
            r->z[at] = of[0] / s->scale;
            r->z[at + 1] = of[1] / s->form.wave[k].w / s->scale;
            r->u[i] += of[0];
        }
    }
    return MT_OK;
}

/*
 * Where a gauge turns back: by halves of a step while its velocity keeps its sign, then, within
 * |A h| < 1/2, by Newton's method on the velocity, each step by Taylor's series.
 */

/* A Newton step below this part of the last half is the last one. */
static const double TURN_FOUND = 1e-15;
enum { TURN_STEPS = 6, TURN_TERMS = 20 };

/* Value and velocity of a gauge, and its acceleration relative to the ground. */
static void propagation_see(const propagation *r, int g, double out[3])
{
    const ptrdiff_t gauges = r->opt->n_gauges;
    out[0] = r->o.still[g];
    out[1] = 0.0;
    out[2] = 0.0;
    for (ptrdiff_t j = 0; j < r->n; j++) {
        const double row = r->o.gauge[g + (j * gauges)];
        out[0] += row * (r->z[j] / r->w[j]);
        out[1] += row * r->z[r->n + j];
    }
    for (ptrdiff_t j = 0; j < r->nz; j++) {
        out[2] += r->see[g + (j * gauges)] * r->z[j];
    }
}

/* Find where gauge g turns within the step of e->f[from] from t, which begins at r->z. */
static mt_status find_turning(propagation *r, const mt_exponential *e, int from, double t,
                              int g, mt_err *err)
{
    const double sign = r->speed[g];
    double h = ldexp(e->h, -from);
    double read[3];
    for (int j = from + 1; j <= e->kept; j++) {
        memcpy(r->rate, r->z, (size_t)r->nz * sizeof *r->z);
        h *= 0.5;
        mt_exponential_step(e, j, r->z, r->work);
        propagation_see(r, g, read);
        if (read[1] * sign < 0.0) {
            memcpy(r->z, r->rate, (size_t)r->nz * sizeof *r->z);
        } else {
            t += h;
        }
    }
    double left = h;
    for (int i = 0; i < TURN_STEPS && fabs(left) > TURN_FOUND * h; i++) {
        propagation_see(r, g, read);
        left = read[2] != 0.0 ? fmin(fmax(-read[1] / read[2], -h), h) : 0.0;
        memcpy(r->rate, r->z, (size_t)r->nz * sizeof *r->z);
        for (int k = 1; k <= TURN_TERMS; k++) {
            mt_gemv(false, r->nz, r->nz, left / k, r->a, r->nz, r->rate, 0.0, r->work);
            memcpy(r->rate, r->work, (size_t)r->nz * sizeof *r->z);
            mt_axpy(r->nz, 1.0, r->rate, r->z);
        }
        t += left;
    }
    propagation_see(r, g, read);
    mt_turnings *const list = &r->out->turnings[g];
    list->at = mt_arena_grow(r->mem, list->at, list->n, &list->room, sizeof *list->at);
    MT_TRY(mt_arena_check(r->mem, err));
    list->at[list->n++] = (mt_turning){.t = t, .value = read[0], .highest = sign > 0.0};
    return MT_OK;
}

/* Add the turning points of all gauges within the step of e->f[j] from t, which begins at
 * r->begin and ends at r->z. Turning points within rounding of the motion of the bodies are
 * left out. */
static mt_status propagation_turnings(propagation *r, const mt_exponential *e, int j, double t,
                                      mt_err *err)
{
    double *const end = r->z;
    for (int k = 0; k < r->o.nq; k++) {
        double v = 0.0;
        for (ptrdiff_t i = 0; i < r->n; i++) {
            v += r->o.phi[k + (i * r->o.nq)] * end[r->n + i];
        }
        r->fast = fmax(r->fast, r->turn_weight[k] * fabs(v));
    }
    for (int g = 0; g < r->opt->n_gauges; g++) {
        double read[3];
        propagation_see(r, g, read);
        const double least = r->opt->tolerance * r->fast;
        const double from = r->speed[g];
        if (from * read[1] < 0.0 && fmax(fabs(from), fabs(read[1])) > least) {
            memcpy(r->inner, r->begin, (size_t)r->nz * sizeof *r->z);
            r->z = r->inner;
            const mt_status rc = find_turning(r, e, j, t, g, err);
            r->z = end;
            MT_TRY(rc);
        }
        r->speed[g] = read[1];
    }
    return MT_OK;
}

/*
 * States, with w_j = sqrt|lambda_j| (of a rigid-body mode: 1/h):
 *     a_j = w_j e_j,  a_j' = w_j b_j;   b_j = e_j',
 *     b' = -diag(lambda/w) a - C b + sum b_i u_i,
 * so that frequencies that lie far apart do not meet in one entry, and those of the inputs
 * (above).
 *     Work of inputs and dampers is the integral of z^T P z, of inputs sum_i u_i b_i . b, of
 * dampers -b . C b: energy balances if the exponential and its quadratic form, two sums, agree.
 *     Where a fitted input is coarse, all begins again with steps in halves.
 */

enum { STATES_MOST = 1000, FIT_HALVINGS = 12, CHECKS = 8 };
/* Lengths of steps are the same within this part of the time. */
static const double ROUNDED = 4.0 * DBL_EPSILON;
/* Of the state that may bring a distance to 0 */
static const double HALF_WAY = 0.5;
/* Samples nearer to the end than this part of their distance are at the end. */
static const double SAME_TIME = 1e-6;
/* Steps in which turning points are looked for are at most this over the highest frequency. */
static const double TURN_STEP = 0.25;
enum { TURN_HALVINGS = 30 };
/* Pieces of an input beyond which it is integrated like any other. */
enum { PIECES_MOST = 20000 };

static mt_status allocate_propagation(propagation *r, mt_err *err)
{
    const size_t n = (size_t)r->n;
    const size_t most =
        (2 * n) + ((size_t)r->opt->n_inputs * (FORM_DEGREE + 1 + ((size_t)2 * FORM_WAVES)));
    const size_t gauges = (size_t)r->opt->n_gauges;
    double **const states[] = {&r->z, &r->begin, &r->inner, &r->rate, &r->work};
    for (int i = 0; i < MT_COUNT(states); i++) {
        *states[i] = mt_arena_f64(r->mem, most, 1);
    }
    r->w = mt_arena_f64(r->mem, n, 1);
    r->turn_weight = mt_arena_f64(r->mem, (size_t)r->o.nq, 1);
    r->u = mt_arena_f64(r->mem, (size_t)r->opt->n_inputs, 1);
    r->speed = mt_arena_f64(r->mem, gauges, 1);
    r->input = mt_arena_alloc(r->mem, (size_t)r->opt->n_inputs, sizeof *r->input);
    r->checked = mt_arena_f64(r->mem, CHECKS, (3 * n) + (size_t)r->opt->n_inputs);
    r->weight = mt_arena_f64(r->mem, CHECKS, 1);
    return mt_arena_check(r->mem, err);
}

/* Make A, P and the rows of the gauges' accelerations. */
static mt_status make_matrices(propagation *r, double h, mt_err *err)
{
    const int n = r->n;
    int nz = 2 * n;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        r->input[i].first = nz;
        nz += r->input[i].degree + 1 + (2 * r->input[i].form.n);
    }
    r->nz = nz;
    r->known = r->known && nz <= STATES_MOST;
    r->has_whole = false;
    if (!r->known) {
        return MT_OK;
    }
    mt_arena_clear(&r->own);
    r->a = mt_arena_f64(&r->own, (size_t)nz, (size_t)nz);
    r->p = mt_arena_f64(&r->own, (size_t)nz, (size_t)nz);
    r->see = mt_arena_f64(&r->own, (size_t)r->opt->n_gauges, (size_t)nz);
    MT_TRY(mt_arena_check(&r->own, err));
    for (int j = 0; j < n; j++) {
        const double *const c = r->o.damping + ((ptrdiff_t)j * n);
        propagation_add(r, j, n + j, r->w[j]);
        propagation_add(r, n + j, j, -r->o.lambda[j] / r->w[j]);
        for (int i = 0; i < n; i++) {
            propagation_add(r, n + i, n + j, -c[i]);
            r->p[n + i + ((ptrdiff_t)(n + j) * nz)] -= c[i];
        }
    }
    for (int i = 0; i < r->opt->n_inputs; i++) {
        propagation_couple(r, i, h);
    }
    mt_gemm(false, false, r->opt->n_gauges, nz, n, 1.0, r->o.gauge, r->opt->n_gauges, r->a + n,
            nz, 0.0, r->see, r->opt->n_gauges);
    return MT_OK;
}

static double kinetic(const propagation *r)
{
    return 0.5 * mt_dot(r->n, r->z + r->n, r->z + r->n);
}

static double potential(const propagation *r)
{
    double sum = 0.0;
    for (int j = 0; j < r->n; j++) {
        const double e = r->z[j] / r->w[j];
        sum += 0.5 * r->o.lambda[j] * e * e;
    }
    return sum;
}

static void note_energy(propagation *r)
{
    const double k = kinetic(r);
    const double v = potential(r);
    const double left = (k + v) - (r->energy0 + r->done);
    r->out->energy_error_j = fmax(r->out->energy_error_j, fabs(left));
    r->out->energy_scale_j = fmax(r->out->energy_scale_j, k);
    r->out->energy_scale_j = fmax(r->out->energy_scale_j, fabs(v - r->potential0));
}

/* Acceleration of the ground along an axis. */
static double ground(const propagation *r, int axis)
{
    double sum = 0.0;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        const mt_sim_input *const in = &r->opt->inputs[i];
        sum += in->push == MT_SIM_BASE && in->at == axis ? r->u[i] : 0.0;
    }
    return sum;
}

/* True where distances stay above 0, also within a step h: by |row . e|^2 <= (sum (row/w)^2)
 * (sum a^2 + b^2), or one by one. */
static bool keeps_lengths(const propagation *r, double h)
{
    const ptrdiff_t lengths = r->o.affine.n_lengths;
    const double state = mt_norm2(2 * r->n, r->z);
    if (state <= HALF_WAY * r->free_state) {
        return true;
    }
    bool keeps = true;
    for (ptrdiff_t i = 0; i < lengths && keeps; i++) {
        const double rest = r->o.affine.length[i].rest_m;
        double at = rest;
        double rate = 0.0;
        double bound = 0.0;
        for (ptrdiff_t j = 0; j < r->n; j++) {
            const double a = r->z[j];
            const double b = r->z[r->n + j];
            const double row = r->o.length[i + (j * lengths)];
            at += row * a / r->w[j];
            rate += row * b;
            bound += fabs(row) * sqrt((a * a) + (b * b)) / r->w[j];
        }
        keeps = at > 0.0 && fmax(at - (h * fabs(rate)), rest - bound) > 0.0;
    }
    return keeps;
}

/* Keep the state of the largest energy of each part of the duration, to be checked. */
static void note_check(propagation *r)
{
    const int n = r->n;
    const int last = r->room > 1 ? r->room - 1 : 1;
    const int part = (int)((double)r->out->n / last * CHECKS);
    const int k = part < CHECKS ? part : CHECKS - 1;
    const double size = kinetic(r) + fabs(potential(r));
    if (r->weight[k] > 0.0 && !(size > r->weight[k])) {
        return;
    }
    double *const to = r->checked + ((ptrdiff_t)k * ((3 * n) + r->opt->n_inputs));
    r->weight[k] = fmax(size, DBL_MIN);
    mt_gemv(false, r->nz, r->nz, 1.0, r->a, r->nz, r->z, 0.0, r->rate);
    for (int j = 0; j < n; j++) {
        to[j] = r->z[j] / r->w[j];
        to[n + j] = r->z[n + j];
        to[(2 * n) + j] = r->rate[n + j];
    }
    memcpy(to + ((ptrdiff_t)3 * n), r->u, (size_t)r->opt->n_inputs * sizeof *to);
}

/* Store a sample at r->t, where the inputs are set. */
static void store_sample(propagation *r)
{
    mt_sim_result *const out = r->out;
    const ptrdiff_t i = out->n;
    for (int g = 0; g < out->n_gauges; g++) {
        const ptrdiff_t at = g + (i * out->n_gauges);
        const int channel = r->opt->gauges[g].channel;
        double read[3];
        propagation_see(r, g, read);
        if (channel >= 0 && !mt_channel_turns(r->o.sys->channels[channel].kind)) {
            read[2] += ground(r, r->o.sys->channels[channel].axis);
        }
        out->value[at] = read[0];
        out->speed[at] = read[1];
        out->acceleration[at] = read[2];
    }
    out->t[i] = r->t;
    out->kinetic[i] = kinetic(r);
    out->potential[i] = potential(r);
    out->work[i] = r->done;
    note_check(r);
    out->n++;
}

/* Step from r->t by `length`, for which the exponential was made. */
static mt_status go_by(propagation *r, const mt_exponential *e, double length, mt_err *err)
{
    const int j = r->halvings;
    const double h = ldexp(length, -j);
    const double from = r->t;
    for (int i = 0; i < 1 << j && !r->coarse; i++) {
        const double t = from + (i * h);
        MT_TRY(propagation_set(r, t, h, err));
        memcpy(r->begin, r->z, (size_t)r->nz * sizeof *r->z);
        r->done += mt_exponential_integral(e, j, r->z, r->work);
        mt_exponential_step(e, j, r->z, r->work);
        r->set_at = nan("");
        r->out->steps++;
        if (r->opt->turning) {
            MT_TRY(propagation_turnings(r, e, j, t, err));
        }
        note_energy(r);
    }
    return MT_OK;
}

/* Step to `until`, or to the end of the piece. */
static mt_status step_to(propagation *r, double until, mt_err *err)
{
    const double end = fmin(until, r->until);
    const double length = end - r->t;
    const double h = r->opt->sample_s;
    mt_exponential_of of = {r->nz, r->a, r->p, h};
    if (end == until && fabs(length - h) <= ROUNDED * until) {
        if (!r->has_whole) {
            MT_TRY(mt_exponential_make(&of, r->halvings, r->opt->turning, &r->own, &r->whole,
                                       err));
            r->has_whole = true;
        }
        MT_TRY(go_by(r, &r->whole, h, err));
    } else {
        const mt_arena_mark mark = mt_arena_get_mark(&r->own);
        mt_exponential part;
        of.h = length;
        MT_TRY(mt_exponential_make(&of, r->halvings, r->opt->turning, &r->own, &part, err));
        MT_TRY(go_by(r, &part, length, err));
        mt_arena_rewind(&r->own, mark);
    }
    r->t = end;
    return MT_OK;
}

/* Begin another piece of the inputs at r->t. */
static mt_status turn_page(propagation *r, mt_err *err)
{
    bool changed = false;
    MT_TRY(propagation_forms(r, &changed, err));
    r->set_at = nan("");
    r->known = r->known && ++r->pieces <= PIECES_MOST;
    return changed && r->known ? make_matrices(r, r->opt->sample_s, err) : MT_OK;
}

/* Step to the sample at `until`, while the inputs have known forms and no step is too
 * coarse. */
static mt_status go_until(propagation *r, double until, mt_err *err)
{
    while (r->t < until) {
        if (r->t >= r->until) {
            MT_TRY(turn_page(r, err));
        }
        if (!r->known || r->coarse) {
            return MT_OK;
        }
        MT_TRY(step_to(r, until, err));
    }
    return MT_OK;
}

static mt_status sample_to_end(propagation *r, mt_err *err)
{
    const mt_sim_options *const opt = r->opt;
    const double step = ldexp(opt->sample_s, -r->halvings);
    while (r->out->n < r->room && r->t < opt->duration_s) {
        const double next = r->out->n * opt->sample_s;
        const double until =
            next < opt->duration_s - (SAME_TIME * opt->sample_s) ? next : opt->duration_s;
        if (mt_interrupted(r->o.sys->run->interrupt)) {
            r->out->stop = MT_SIM_INTERRUPTED;
            return MT_OK;
        }
        MT_TRY(go_until(r, until, err));
        if (r->t < until) {
            return MT_OK;
        }
        MT_TRY(propagation_set(r, r->t, r->t < opt->duration_s ? step : -step, err));
        r->known = keeps_lengths(r, opt->sample_s);
        store_sample(r);
    }
    return MT_OK;
}

/* Run from the start with 2^halvings parts per step. */
static mt_status run_propagation(propagation *r, const mt_sim_start *start, mt_err *err)
{
    mt_sim_result *const out = r->out;
    double *const e = r->begin;
    double *const rate = r->begin + r->n;
    r->t = 0.0;
    r->done = 0.0;
    r->coarse = false;
    r->pieces = 0;
    out->n = 0;
    out->steps = 0;
    out->energy_error_j = 0.0;
    out->energy_scale_j = 0.0;
    out->fit.input_error = 0.0;
    memset(r->weight, 0, CHECKS * sizeof *r->weight);
    MT_TRY(oscillators_start(&r->o, start, e, rate, &r->known));
    for (int j = 0; j < r->n; j++) {
        r->z[j] = r->w[j] * e[j];
        r->z[r->n + j] = rate[j];
    }
    if (r->known) {
        MT_TRY(turn_page(r, err));
    }
    if (!r->known) {
        return MT_OK;
    }
    MT_TRY(propagation_set(r, 0.0, ldexp(r->opt->sample_s, -r->halvings), err));
    r->energy0 = kinetic(r) + potential(r);
    r->potential0 = potential(r);
    for (int g = 0; g < out->n_gauges; g++) {
        double read[3];
        propagation_see(r, g, read);
        r->speed[g] = read[1];
    }
    r->known = keeps_lengths(r, r->opt->sample_s);
    note_energy(r);
    store_sample(r);
    return sample_to_end(r, err);
}

/* True where the motion satisfies the full equations. */
static mt_status check_full_equations(propagation *r, mt_err *err)
{
    const int n = r->n;
    oscillators_fit fit = {.independent = true};
    for (ptrdiff_t k = 0; k < CHECKS; k++) {
        const double *const at = r->checked + (k * ((3 * n) + r->opt->n_inputs));
        if (r->weight[k] > 0.0) {
            MT_TRY(oscillators_check(&r->o, at, at + n, at + (ptrdiff_t)2 * n,
                                     at + (ptrdiff_t)3 * n, &r->own, &fit, err));
            r->out->fit.checks++;
        }
    }
    r->out->evaluations = r->out->fit.checks;
    r->out->fit.residual = fit.size > 0.0 ? fit.residual / fit.size : fit.residual;
    r->out->gap_m = fit.gap_m;
    r->out->left_m = fit.gap_m;
    r->known = oscillators_fits(&fit);
    return MT_OK;
}

/* Compute the frequencies, and the halvings required for turning points. */
static void find_steps(propagation *r)
{
    double highest = 0.0;
    for (int j = 0; j < r->n; j++) {
        const double w = sqrt(fabs(r->o.lambda[j]));
        r->w[j] = w > 0.0 ? w : 1.0 / r->opt->sample_s;
        highest = fmax(highest, w);
    }
    while (r->opt->turning && r->halvings < TURN_HALVINGS &&
           ldexp(highest * r->opt->sample_s, -r->halvings) > TURN_STEP) {
        r->halvings++;
    }
    r->free_state = HUGE_VAL;
    for (ptrdiff_t i = 0; i < r->o.affine.n_lengths; i++) {
        double square = 0.0;
        for (ptrdiff_t j = 0; j < r->n; j++) {
            const double row = r->o.length[i + (j * r->o.affine.n_lengths)] / r->w[j];
            square += row * row;
        }
        if (square > 0.0) {
            r->free_state = fmin(r->free_state, r->o.affine.length[i].rest_m / sqrt(square));
        }
    }
    for (int b = 0; b < r->o.sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = r->o.sys->bodies[b].dof[k];
            if (dof >= 0) {
                r->turn_weight[dof] = k < 3 ? 1.0 : r->o.sys->length_m;
            }
        }
    }
}

static mt_status propagate(propagation *r, const mt_sim_start *start, mt_err *err)
{
    MT_TRY(oscillators_make(r->o.lin, r->opt, r->mem, &r->o, &r->known, err));
    if (!r->known) {
        return MT_OK;
    }
    r->n = r->o.n;
    MT_TRY(allocate_propagation(r, err));
    find_steps(r);
    const int most = r->halvings + FIT_HALVINGS;
    MT_TRY(run_propagation(r, start, err));
    while (r->coarse && r->known && r->halvings < most) {
        r->halvings++;
        r->a = NULL;
        MT_TRY(run_propagation(r, start, err));
    }
    r->known = r->known && !r->coarse;
    if (!r->known) {
        return MT_OK;
    }
    MT_TRY(check_full_equations(r, err));
    r->out->method = MT_SIM_EXACT;
    for (int i = 0; i < r->opt->n_inputs; i++) {
        r->out->method = r->input[i].fitted ? MT_SIM_FITTED : r->out->method;
    }
    if (r->opt->end != NULL && r->known) {
        for (int j = 0; j < r->n; j++) {
            r->begin[j] = r->z[j] / r->w[j];
        }
        oscillators_position(&r->o, r->begin, r->z + r->n, &r->opt->end->at, r->opt->end->v);
    }
    return MT_OK;
}

mt_status mt_propagate(mt_linear *lin, const mt_sim_start *start, const mt_sim_options *opt,
                       int room, mt_arena *mem, mt_sim_result *out, bool *done, mt_err *err)
{
    propagation r = {.opt = opt, .mem = mem, .out = out, .room = room, .set_at = nan("")};
    r.o.lin = lin;
    mt_status rc = mt_arena_init(&r.own, 0, err);
    rc = rc == MT_OK ? propagate(&r, start, err) : rc;
    *done = rc == MT_OK && r.known;
    mt_arena_free(&r.own);
    return rc;
}
