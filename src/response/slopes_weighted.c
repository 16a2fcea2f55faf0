/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With the letters of slopes.c, e = E y' over the states, E = [Z, -v] and y' = (y, 1), and l, m
 * from P, which gives the multipliers that balance a force,
 *     l = P (f - D q),    m = P (sigma - D e),
 * everything that dH has of x and y' is linear in sums over the frequencies of
 *     W s^k y' x^T,   W s^k x,   W s^k y',       k = 0, 1, 2,
 * whose real parts (and that of W i y' x^T, for the loss factors) are added up first. With G_j
 * that of W (factor of matrix j of D) y' x^T
 *     sum W e . dD q = sum_j (E G_j Z^T) : d(matrix j) + ...
 *     sum W y' l^T = (sum W y' f^T - sum_j G_j Z^T matrix_j) P^T,   and so on.
 */
#include "response/slopes_weighted.h"

#include <math.h>
#include <string.h>

#include "analysis/damping.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/products.h"
#include "response/slopes.h"

enum {
    MATRICES = MT_SLOPE_MATRICES,
    SUMS = 4,     /* of W y' x^T, W i y' x^T, W s y' x^T and W s^2 y' x^T */
    AT_ONCE = 128 /* frequencies */
};

typedef struct work {
    const mt_slope_problem *p;
    const mt_slope_weights *of;
    const mt_port *in;
    const mt_port *out;
    mt_linear *lin;
    mt_arena *mem;
    int n;
    int ny; /* n + 1 */
    int nq;
    int m;
    double *sum[SUMS];                   /* ny x n, real parts */
    double complex *x[MT_FORCED_POWERS]; /* n: sum W s^k x */
    double complex *y[MT_FORCED_POWERS]; /* ny: sum W s^k y' */
    double *e;                           /* nq x ny: E; its first n columns are Z */
    double *g[MATRICES];                 /* nq x nq: E G_j Z^T */
    double *lambda;                      /* m x nq: what dA goes with */
    double *l;                           /* [m]: sum W l */
    mt_ratio_modes ratio;
    double *coefficient; /* r x ny: Phi^T M E */
    double *turn;        /* r x r: what Q goes with */
    double *q;           /* r x r: Q of one input */
    double of_mass;      /* sum W s e . M q */
    double of_stiffness; /* sum W s e . K q */
} work;

static const mt_slope_factor ONE = {{1.0, 0.0, 0.0}};

/* Frequencies at work. */
typedef struct batch {
    int count;
    const double *w;
    const double complex *weight;
    mt_solved got;
    double *part[2]; /* ny x count: both parts of W s^k y' */
} batch;

static double complex power_of(double w, int k)
{
    const double complex s = mt_complex(0.0, w);
    return k == 0 ? 1.0 : k == 1 ? s : s * s;
}

/* b->part := W s^k y'; the sums of vectors. */
static void scale(const work *k, int power, const batch *b)
{
    for (ptrdiff_t i = 0; i < b->count; i++) {
        const double complex c = b->weight[i] * power_of(b->w[i], power);
        for (ptrdiff_t j = 0; j < k->ny; j++) {
            const ptrdiff_t at = j + (i * k->n);
            const double complex y =
                j < k->n ? mt_complex(b->got.y[0][at], b->got.y[1][at]) : 1.0;
            const double complex x =
                j < k->n ? mt_complex(b->got.x[0][at], b->got.x[1][at]) : 0.0;
            k->y[power][j] += c * y;
            if (j < k->n) {
                k->x[power][j] += c * x;
            }
            b->part[0][j + (i * k->ny)] = creal(c * y);
            b->part[1][j + (i * k->ny)] = cimag(c * y);
        }
    }
}

/* to += the real part of f z x^T, z = b->part and f = 1 or i. */
static void add_products(const work *k, bool imaginary, const batch *b, double *to)
{
    const double sign = -1.0;
    mt_gemm(false, true, k->ny, k->n, b->count, imaginary ? sign : 1.0, b->part[0], k->ny,
            b->got.x[imaginary ? 1 : 0], k->n, 1.0, to, k->ny);
    mt_gemm(false, true, k->ny, k->n, b->count, sign, b->part[1], k->ny,
            b->got.x[imaginary ? 0 : 1], k->n, 1.0, to, k->ny);
}

/* *singular: there is no response at one of the frequencies. */
static mt_status add_up(work *k, bool *singular, mt_err *err)
{
    const size_t size = (size_t)k->ny * AT_ONCE;
    mt_solutions s;
    batch b = {.count = 0};
    *singular = false;
    for (int i = 0; i < 2; i++) {
        b.got.x[i] = mt_arena_f64(k->mem, size, 1);
        b.got.y[i] = mt_arena_f64(k->mem, size, 1);
        b.part[i] = mt_arena_f64(k->mem, size, 1);
    }
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(mt_solutions_open(k->p->basis, k->of->out, k->of->in, k->mem, &s, err));
    for (int at = 0; at < k->of->n && !*singular; at += AT_ONCE) {
        MT_TRY(mt_interrupt_check(k->p->a->sys->run->interrupt, err));
        b.count = k->of->n - at < AT_ONCE ? k->of->n - at : AT_ONCE;
        b.w = k->of->w + at;
        b.weight = k->of->weight + at;
        MT_TRY(mt_solutions_at(&s, b.count, b.w, &b.got, singular, k->mem, err));
        for (int power = 0; power < MT_FORCED_POWERS && !*singular; power++) {
            scale(k, power, &b);
            add_products(k, false, &b, k->sum[power == 0 ? 0 : power + 1]);
            if (power == 0) {
                add_products(k, true, &b, k->sum[1]);
            }
        }
    }
    return MT_OK;
}

/* Real part of sum W f(s) z, of the sums with its powers. */
static double with(mt_slope_factor f, double complex *const *z, ptrdiff_t j)
{
    double sum = 0.0;
    for (int i = 0; i < MT_FORCED_POWERS; i++) {
        sum += creal(f.c[i] * z[i][j]);
    }
    return sum;
}

/* to[nq] := Z times those of x. */
static void motion_with(const work *k, mt_slope_factor f, double *part, double *to)
{
    for (int j = 0; j < k->n; j++) {
        part[j] = with(f, k->x, j);
    }
    mt_gemv(false, k->nq, k->n, 1.0, k->e, k->nq, part, 0.0, to);
}

/* to (ny x n) := G_j. */
static void weigh_by_factor(const work *k, mt_slope_factor f, double *to)
{
    const int size = k->ny * k->n;
    memset(to, 0, (size_t)size * sizeof *to);
    mt_axpy(size, creal(f.c[0]), k->sum[0], to);
    mt_axpy(size, cimag(f.c[0]), k->sum[1], to);
    mt_axpy(size, creal(f.c[1]), k->sum[2], to);
    mt_axpy(size, creal(f.c[2]), k->sum[3], to);
}

static mt_status make_e(work *k, mt_err *err)
{
    const double *const v =
        k->out->kind == MT_PORT_JOINT ? k->p->ways->joint[k->of->out].v : NULL;
    k->e = mt_arena_f64(k->mem, (size_t)k->nq, (size_t)k->n + 1);
    MT_TRY(mt_arena_check(k->mem, err));
    return mt_slope_motions(k->lin, k->nq, k->n, v, k->e, k->mem, err);
}

/* What the joints carry: forces that they balance, of inputs (nq x ny) and outputs (nq x n). */
typedef struct balance {
    double *in;
    double *out;
    double *product; /* nq x ny: matrix j times E */
    double *g;       /* ny x n: G_j */
    double *half;    /* nq x n: E G_j */
} balance;

static void push_output(const work *k, mt_slope_factor factor, const double *sigma,
                        const balance *b)
{
    for (ptrdiff_t j = 0; j < k->n; j++) {
        mt_axpy(k->nq, with(factor, k->x, j), sigma, b->out + (j * k->nq));
    }
}

/* f (W s^k y')^T and sigma (W factor x)^T. */
static mt_status add_weighted_loads(work *k, const balance *b, mt_err *err)
{
    double *const f = mt_arena_f64(k->mem, (size_t)k->nq, 2);
    double *const sigma = f + k->nq;
    MT_TRY(mt_arena_check(k->mem, err));
    mt_slope_push(k->lin, k->in, f);
    for (ptrdiff_t j = 0; j < k->ny; j++) {
        mt_axpy(k->nq, creal(k->y[mt_response_power(k->in)][j]), f, b->in + (j * k->nq));
    }
    if (k->out->kind == MT_PORT_JOINT) {
        const double *const standing = k->p->ways->joint[k->of->out].geometric;
        if (standing != NULL) {
            mt_axpy(k->nq, -1.0, standing, sigma);
            push_output(k, ONE, sigma, b);
        }
        return MT_OK;
    }
    mt_slope_part part[MT_FORCE_PARTS];
    const int n = mt_slope_parts(k->p->a, k->out, part);
    for (int i = 0; i < n; i++) {
        memset(sigma, 0, (size_t)k->nq * sizeof *sigma);
        mt_linear_row_add(k->lin, part[i].kind, part[i].row, 1.0, sigma);
        push_output(k, part[i].factor, sigma, b);
    }
    return MT_OK;
}

/* Matrix j of D: its part in both, and its E G_j Z^T. */
static void add_matrix(work *k, int j, mt_slope_factor factor, const balance *b)
{
    const int nq = k->nq;
    const int n = k->n;
    const int ny = k->ny;
    memset(b->product, 0, (size_t)nq * (size_t)ny * sizeof *b->product);
    for (ptrdiff_t c = 0; c < ny; c++) {
        mt_linear_states_product(k->lin, (mt_linear_matrix)j, 1.0, k->e + (c * nq),
                                 b->product + (c * nq));
    }
    weigh_by_factor(k, factor, b->g);
    mt_gemm(false, true, nq, ny, n, -1.0, b->product, nq, b->g, ny, 1.0, b->in, nq);
    mt_gemm(false, false, nq, n, ny, -1.0, b->product, nq, b->g, ny, 1.0, b->out, nq);
    mt_gemm(false, false, nq, n, ny, 1.0, k->e, nq, b->g, ny, 0.0, b->half, nq);
    mt_gemm(false, true, nq, nq, n, 1.0, b->half, nq, k->e, nq, 0.0, k->g[j], nq);
    if (j == MT_MATRIX_MASS || j == MT_MATRIX_STIFFNESS) {
        mt_gemm(false, false, nq, n, ny, 1.0, k->e, nq, k->sum[2], ny, 0.0, b->half, nq);
        *(j == MT_MATRIX_MASS ? &k->of_mass : &k->of_stiffness) =
            mt_dot(nq * n, b->half, b->product);
    }
}

/* to (m x cols) += P w, w nq x cols. */
static mt_status multipliers(work *k, int cols, const double *w, double *to, mt_err *err)
{
    for (ptrdiff_t j = 0; j < cols; j++) {
        MT_TRY(mt_linear_multipliers(k->lin, w + (j * k->nq), to + (j * k->m), err));
    }
    return MT_OK;
}

/* psi of all columns of E, nq x ny, and its modal coefficients. */
static mt_status turned(work *k, const double *mass_e, double *psi, mt_err *err)
{
    const int n = k->n;
    const int r = k->ratio.r;
    double *const own = mt_arena_f64(k->mem, (size_t)n, (size_t)k->ny);
    double *const times = mt_arena_f64(k->mem, (size_t)r, (size_t)k->ny);
    k->coefficient = mt_arena_f64(k->mem, (size_t)r, (size_t)k->ny);
    k->turn = mt_arena_f64(k->mem, (size_t)r, (size_t)r);
    k->q = mt_arena_f64(k->mem, (size_t)r, (size_t)r);
    MT_TRY(mt_arena_check(k->mem, err));
    mt_gemm(true, false, n, k->ny, k->nq, 1.0, k->e, k->nq, mass_e, k->nq, 0.0, own, n);
    mt_gemm(true, false, r, k->ny, n, 1.0, k->ratio.y, n, own, n, 0.0, k->coefficient, r);
    for (ptrdiff_t at = 0; at < (ptrdiff_t)r * k->ny; at++) {
        times[at] = k->ratio.f[at % r] * k->coefficient[at];
    }
    mt_gemm(false, false, n, k->ny, r, 1.0, k->ratio.y, n, times, r, 0.0, own, n);
    mt_linear_expand(k->lin, k->ny, own, psi);
    mt_gemm(false, false, r, n, k->ny, 1.0, k->coefficient, r, k->sum[2], k->ny, 0.0, times, r);
    mt_gemm(false, true, r, r, n, 1.0, times, r, k->coefficient, r, 0.0, k->turn, r);
    return MT_OK;
}

/* Modal ratios, a fifth matrix: its part in both, in what dM goes with and in what dA does. */
static mt_status add_ratios(work *k, const balance *b, mt_err *err)
{
    const int nq = k->nq;
    const int n = k->n;
    const int ny = k->ny;
    const int m = k->m;
    const double *const g = k->sum[2];
    double *const mass_e = mt_arena_f64(k->mem, (size_t)nq, (size_t)ny);
    double *const psi = mt_arena_f64(k->mem, (size_t)nq, (size_t)ny);
    double *const carried = mt_arena_f64(k->mem, (size_t)m, (size_t)ny);
    double *const times = mt_arena_f64(k->mem, (size_t)(m > nq ? m : nq), (size_t)ny);
    MT_TRY(mt_arena_check(k->mem, err));
    memset(b->product, 0, (size_t)nq * (size_t)ny * sizeof *b->product);
    for (ptrdiff_t c = 0; c < ny; c++) {
        mt_linear_states_product(k->lin, MT_MATRIX_MASS, 1.0, k->e + (c * nq),
                                 mass_e + (c * nq));
    }
    MT_TRY(turned(k, mass_e, psi, err));
    for (ptrdiff_t c = 0; c < ny; c++) {
        mt_linear_states_product(k->lin, MT_MATRIX_MASS, 1.0, psi + (c * nq),
                                 b->product + (c * nq));
    }
    mt_gemm(false, true, nq, ny, n, -1.0, b->product, nq, g, ny, 1.0, b->in, nq);
    mt_gemm(false, false, nq, n, ny, -1.0, b->product, nq, g, ny, 1.0, b->out, nq);
    mt_gemm(false, false, nq, n, ny, 1.0, k->e, nq, g, ny, 0.0, b->half, nq);
    mt_gemm(false, true, nq, nq, n, 1.0, b->half, nq, psi, nq, 1.0, k->g[MT_MATRIX_MASS], nq);
    mt_gemm(false, false, nq, n, ny, 1.0, psi, nq, g, ny, 0.0, b->half, nq);
    mt_gemm(false, true, nq, nq, n, 1.0, b->half, nq, k->e, nq, 1.0, k->g[MT_MATRIX_MASS], nq);
    MT_TRY(multipliers(k, ny, mass_e, carried, err));
    if (m > 0) {
        mt_gemm(false, false, m, n, ny, 1.0, carried, m, g, ny, 0.0, times, m);
        mt_gemm(false, true, m, nq, n, -1.0, times, m, psi, nq, 1.0, k->lambda, m);
        mt_gemm(false, true, m, ny, n, 1.0, carried, m, g, ny, 0.0, times, m);
        mt_gemm(false, true, m, nq, ny, -1.0, times, m, psi, nq, 1.0, k->lambda, m);
    }
    return MT_OK;
}

/* lambda += (sum W y' l^T)^T E^T + (sum W x m^T)^T Z^T. */
static mt_status carry(work *k, const balance *b, mt_err *err)
{
    const ptrdiff_t m = k->m;
    double *const l = mt_arena_f64(k->mem, (size_t)m, (size_t)k->ny);
    MT_TRY(mt_arena_check(k->mem, err));
    double *const other = mt_arena_f64(k->mem, (size_t)m, (size_t)k->n);
    MT_TRY(mt_arena_check(k->mem, err));
    k->l = l + (k->n * m);
    if (m == 0) {
        return MT_OK;
    }
    MT_TRY(multipliers(k, k->ny, b->in, l, err));
    MT_TRY(multipliers(k, k->n, b->out, other, err));
    mt_gemm(false, true, k->m, k->nq, k->ny, 1.0, l, k->m, k->e, k->nq, 1.0, k->lambda, k->m);
    mt_gemm(false, true, k->m, k->nq, k->n, 1.0, other, k->m, k->e, k->nq, 1.0, k->lambda,
            k->m);
    return MT_OK;
}

static mt_status gather_weighted_products(work *k, mt_err *err)
{
    const size_t nq = (size_t)k->nq;
    const size_t n = (size_t)k->n;
    const balance b = {.in = mt_arena_f64(k->mem, nq, n + 1),
                       .out = mt_arena_f64(k->mem, nq, n),
                       .product = mt_arena_f64(k->mem, nq, n + 1),
                       .g = mt_arena_f64(k->mem, n + 1, n),
                       .half = mt_arena_f64(k->mem, nq, n)};
    for (int j = 0; j < MATRICES; j++) {
        k->g[j] = mt_arena_f64(k->mem, nq, nq);
    }
    k->lambda = mt_arena_f64(k->mem, (size_t)k->m, nq);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(make_e(k, err));
    MT_TRY(add_weighted_loads(k, &b, err));
    mt_slope_factor d[MATRICES];
    mt_slope_matrices(k->p->a, d);
    for (int j = 0; j < MATRICES; j++) {
        add_matrix(k, j, d[j], &b);
    }
    if (k->p->a->sys->damping.modal) {
        MT_TRY(mt_analysis_ratio_modes(k->p->a, &k->ratio, err));
    }
    if (k->ratio.r > 0) {
        MT_TRY(add_ratios(k, &b, err));
    }
    return carry(k, &b, err);
}

/* sum W e . dD q. */
static mt_status weighted_matrix_slope(work *k, int p, double *out, mt_err *err)
{
    const mt_damping_def *const d = &k->p->a->sys->damping;
    double sum = (mt_slope_node(k->p->a, p, d->mass) * k->of_mass) +
                 (mt_slope_node(k->p->a, p, d->stiffness) * k->of_stiffness);
    for (int j = 0; j < MATRICES; j++) {
        sum += mt_linear_contract_slope(k->lin, p, (mt_linear_matrix)j, k->g[j]);
    }
    if (k->ratio.r > 0) {
        MT_TRY(mt_analysis_ratio_slope(k->p->a, p, k->q, err));
        sum += mt_dot(k->ratio.r * k->ratio.r, k->q, k->turn);
    }
    *out = sum;
    return MT_OK;
}

/* sum W e . df. */
static double force_slope(const work *k, int p, double *part, double *e)
{
    for (int j = 0; j < k->ny; j++) {
        part[j] = creal(k->y[mt_response_power(k->in)][j]);
    }
    mt_gemv(false, k->nq, k->ny, 1.0, k->e, k->nq, part, 0.0, e);
    return k->in->kind == MT_PORT_SENSOR
               ? mt_linear_row_dot_slope(k->lin, p, MT_TERM_CHANNEL,
                                         mt_slope_channel(k->lin, k->in), e)
               : mt_linear_base_slope(k->lin, p, k->in->index, e);
}

/* The same for a joint's force, with its own coefficients and turns. */
static mt_status joint_slope(work *k, int p, double *part, double *motion, double *out,
                             mt_err *err)
{
    const mt_port *const port = k->out;
    double *const turn = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(mt_linear_joint_geometric_slope(k->lin, p, port->index, port->axis, turn, err));
    motion_with(k, ONE, part, motion);
    *out = -mt_linear_joint_slope(k->lin, p, port->index, port->axis, k->l) -
           mt_dot(k->nq, turn, motion);
    return MT_OK;
}

/* sum W (d(sigma) . q - d(t) . l), for an output other than a joint's force. */
static double output_slope(const work *k, int p, double *room, double *motion)
{
    mt_slope_part part[MT_FORCE_PARTS];
    const int n = mt_slope_parts(k->p->a, k->out, part);
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        motion_with(k, part[i].factor, room, motion);
        sum += mt_linear_row_dot_slope(k->lin, p, part[i].kind, part[i].row, motion);
        motion_with(k, mt_slope_turn(k->p->a, p, &part[i]), room, motion);
        sum += mt_linear_row_dot(k->lin, part[i].kind, part[i].row, motion);
    }
    return sum;
}

static mt_status slopes_of_all(work *k, double *slope, mt_err *err)
{
    double *const part = mt_arena_f64(k->mem, (size_t)k->ny, 1);
    double *const motion = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(mt_linear_complete(k->lin, err));
    for (int p = 0; p < k->p->a->sys->n_inputs; p++) {
        const mt_arena_mark mark = mt_arena_get_mark(k->mem);
        mt_independence why = {.opens = false};
        MT_TRY(mt_linear_independence(k->lin, p, k->mem, &why, err));
        double between_of = nan("");
        double output = 0.0;
        if (!why.opens && !why.blocks) {
            MT_TRY(weighted_matrix_slope(k, p, &between_of, err));
        }
        if (k->out->kind == MT_PORT_JOINT) {
            MT_TRY(joint_slope(k, p, part, motion, &output, err));
        } else {
            output = output_slope(k, p, part, motion);
        }
        slope[p] = output + force_slope(k, p, part, motion) - between_of -
                   mt_linear_jacobian_contract(k->lin, p, k->lambda);
        mt_arena_rewind(k->mem, mark);
    }
    return MT_OK;
}

static mt_status weighted(work *k, double *slope, mt_err *err)
{
    bool singular = false;
    for (int i = 0; i < SUMS; i++) {
        k->sum[i] = mt_arena_f64(k->mem, (size_t)k->ny, (size_t)k->n);
    }
    for (int i = 0; i < MT_FORCED_POWERS; i++) {
        k->x[i] = mt_arena_alloc(k->mem, (size_t)k->n, sizeof *k->x[i]);
        k->y[i] = mt_arena_alloc(k->mem, (size_t)k->ny, sizeof *k->y[i]);
    }
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(add_up(k, &singular, err));
    if (singular) {
        for (int p = 0; p < k->p->a->sys->n_inputs; p++) {
            slope[p] = nan("");
        }
        return MT_OK;
    }
    MT_TRY(gather_weighted_products(k, err));
    return slopes_of_all(k, slope, err);
}

mt_status mt_response_slopes_weighted(const mt_slope_problem *p, const mt_slope_weights *q,
                                      double *slope, mt_arena *scratch, mt_err *err)
{
    const int n = mt_linear_freedoms(p->a->lin);
    work k = {.p = p,
              .of = q,
              .in = &p->ports->in[q->in],
              .out = &p->ports->out[q->out],
              .lin = p->a->lin,
              .mem = scratch,
              .n = n,
              .ny = n + 1,
              .nq = p->a->sys->nq,
              .m = mt_linear_equations(p->a->lin)};
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    MT_TRY(mt_slope_admit(p, err));
    const mt_status rc = weighted(&k, slope, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}
