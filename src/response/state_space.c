/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * In coordinates q = (q_m, q_d), with mass 1 and without mass, C_dd diagonal:
 *     q_m'' = b_m u - G_mm q_m - C_mm q_m' - C_md q_d',
 *     q_d'  = C_dd^-1 (b_d u - G_dd q_d - C_dm q_m'),     G_md = 0.
 */
#include "response/state_space.h"

#include <math.h>
#include <string.h>

#include "linalg/dense.h"

/* A column of the static responses that the kept modes leave depends on others below this part
 * of the longest. */
static const double INDEPENDENT = 1e-9;
/* Imaginary parts, and parts with derivatives of inputs, up to this share are rounding. */
static const double ROUNDING = 1e-10;

/* The problem with real matrices, in modes or in modes and residual shapes. */
typedef struct real_parts {
    int n;
    int r; /* coordinates with mass, the first ones */
    int n_in;
    int n_out;
    double *c;                    /* n x n */
    double *g;                    /* n x n */
    double *b;                    /* n x n_in */
    double *s[MT_FORCED_POWERS];  /* n_out x n */
    double *rest[MT_REST_POWERS]; /* n_out x n_in; NULL: 0 */
} real_parts;

static mt_status refused(mt_state_space *out, int input, int output, const char *why,
                         mt_err *err)
{
    out->refused_input = input;
    out->refused_output = output;
    return mt_fail(err, MT_E_USAGE, "there is no state space: %s", why);
}

static bool has_imaginary(size_t n, const double complex *z)
{
    double most = 0.0;
    double imaginary = 0.0;
    for (size_t i = 0; z != NULL && i < n; i++) {
        most = fmax(most, cabs(z[i]));
        imaginary = fmax(imaginary, fabs(cimag(z[i])));
    }
    return imaginary > ROUNDING * most;
}

static mt_status copy_real_part(size_t n, const double complex *z, mt_arena *mem, double **out,
                                mt_err *err)
{
    *out = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; z != NULL && i < n; i++) {
        (*out)[i] = creal(z[i]);
    }
    return MT_OK;
}

/* Entry (i, j) of a matrix that the transfer holds by its diagonal or in full. */
static double complex entry_of(const mt_transfer *t, const double complex *a, ptrdiff_t i,
                               ptrdiff_t j)
{
    if (t->diagonal) {
        return i == j ? a[i] : 0.0;
    }
    return a[i + (j * t->n)];
}

/* Damping and stiffness; loss factors as viscous damping. */
static mt_status fill_matrices(const mt_basis *basis, real_parts *p, mt_state_space *out,
                               mt_err *err)
{
    const mt_transfer *const t = &basis->t;
    const ptrdiff_t n = t->n;
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            const double complex g = entry_of(t, t->g, i, j);
            const bool modes = i < p->r && j < p->r;
            double c = 0.0;
            if (t->c != NULL) {
                c = t->diagonal ? (i == j ? t->c[i] : 0.0) : t->c[i + (j * n)];
            }
            if (cimag(g) != 0.0 && !modes) {
                return refused(out, -1, -1,
                               "a spring with a loss factor acts where a damper holds what has "
                               "no mass; give the body a mass",
                               err);
            }
            if (cimag(g) != 0.0 && basis->lambda[i] > 0.0 && basis->lambda[j] > 0.0) {
                c += cimag(g) / sqrt(sqrt(basis->lambda[i]) * sqrt(basis->lambda[j]));
                out->lossy = true;
            }
            p->g[i + (j * n)] = creal(g);
            p->c[i + (j * n)] = c;
        }
    }
    return MT_OK;
}

/* Force of the inputs; only forces and accelerations of the ground act without a derivative. */
static mt_status fill_inputs(const mt_transfer *t, real_parts *p, mt_arena *mem,
                             mt_state_space *out, mt_err *err)
{
    const ptrdiff_t n = t->n;
    for (int power = 1; power < MT_FORCED_POWERS; power++) {
        for (ptrdiff_t at = 0; t->beta[power] != NULL && at < n * t->n_in; at++) {
            if (t->beta[power][at] != 0.0) {
                return refused(out, (int)(at / n), -1,
                               "a derivative of this input acts; take the acceleration of the "
                               "ground",
                               err);
            }
        }
    }
    if (has_imaginary((size_t)(n * t->n_in), t->beta[0])) {
        return refused(out, -1, -1,
                       "a spring with a loss factor holds what has no mass; give the body a "
                       "mass",
                       err);
    }
    return copy_real_part((size_t)(n * t->n_in), t->beta[0], mem, &p->b, err);
}

/* Rows of the outputs. A force in a spring with a loss factor has an imaginary part, which
 * follows the rate of each mode as its damping does. */
static mt_status fill_outputs(const mt_basis *basis, real_parts *p, mt_arena *mem,
                              mt_state_space *out, mt_err *err)
{
    const mt_transfer *const t = &basis->t;
    const size_t size = (size_t)t->n * (size_t)t->n_out;
    for (int power = 0; power < MT_FORCED_POWERS; power++) {
        MT_TRY(copy_real_part(size, t->sigma[power], mem, &p->s[power], err));
    }
    for (size_t at = 0; t->sigma[0] != NULL && at < size; at++) {
        const size_t i = at / (size_t)t->n_out;
        const double im = cimag(t->sigma[0][at]);
        if (im == 0.0) {
            continue;
        }
        if (i >= (size_t)p->r) {
            return refused(out, -1, (int)(at % (size_t)t->n_out),
                           "the spring has a loss factor, and holds what has no mass", err);
        }
        if (basis->lambda[i] > 0.0) {
            p->s[1][at] += im / sqrt(basis->lambda[i]);
            out->lossy = true;
        }
    }
    for (int power = 0; power < MT_REST_POWERS; power++) {
        const size_t pairs = (size_t)t->n_out * (size_t)t->n_in;
        if (t->rest[power] != NULL) {
            MT_TRY(copy_real_part(pairs, t->rest[power], mem, &p->rest[power], err));
        }
    }
    return MT_OK;
}

/* q = T y, n x m: the kept modes, residual shapes, and what has no mass. */
static mt_status project(const real_parts *p, const double *t, int m, int r, mt_arena *mem,
                         real_parts *out, mt_err *err)
{
    const int n = p->n;
    double *const work = mt_arena_f64(mem, (size_t)n, (size_t)m);
    *out = *p;
    out->n = m;
    out->r = r;
    out->c = mt_arena_f64(mem, (size_t)m, (size_t)m);
    out->g = mt_arena_f64(mem, (size_t)m, (size_t)m);
    out->b = mt_arena_f64(mem, (size_t)m, (size_t)p->n_in);
    for (int power = 0; power < MT_FORCED_POWERS; power++) {
        out->s[power] = mt_arena_f64(mem, (size_t)p->n_out, (size_t)m);
    }
    MT_TRY(mt_arena_check(mem, err));
    mt_gemm(false, false, n, m, n, 1.0, p->c, n, t, n, 0.0, work, n);
    mt_gemm(true, false, m, m, n, 1.0, t, n, work, n, 0.0, out->c, m);
    mt_gemm(false, false, n, m, n, 1.0, p->g, n, t, n, 0.0, work, n);
    mt_gemm(true, false, m, m, n, 1.0, t, n, work, n, 0.0, out->g, m);
    mt_gemm(true, false, m, p->n_in, n, 1.0, t, n, p->b, n, 0.0, out->b, m);
    for (int power = 0; power < MT_FORCED_POWERS; power++) {
        mt_gemm(false, false, p->n_out, m, n, 1.0, p->s[power], p->n_out, t, n, 0.0,
                out->s[power], p->n_out);
    }
    return MT_OK;
}

/* Static responses lambda^-1 b of the modes left out, orthonormal, and turned to modes of their
 * own: v, left x *count. */
static mt_status residual_shapes(const mt_basis *basis, const real_parts *p, int keep,
                                 mt_arena *mem, int *count, double **v, mt_err *err)
{
    const int left = p->r - keep;
    double *const follow = mt_arena_f64(mem, (size_t)left, (size_t)p->n_in);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < p->n_in; i++) {
        double *const column = follow + (i * left);
        for (ptrdiff_t k = 0; k < left; k++) {
            column[k] = p->b[keep + k + (i * p->n)] / basis->lambda[keep + k];
        }
        const double length = mt_norm2(left, column);
        for (ptrdiff_t k = 0; length > 0.0 && k < left; k++) {
            column[k] /= length; /* whatever the unit of the input */
        }
    }
    mt_qr qr;
    MT_TRY(mt_qr_factor(left, p->n_in, follow, left, INDEPENDENT, mem, &qr, err));
    *count = qr.rank;
    const size_t m = (size_t)qr.rank;
    double *const all = mt_arena_f64(mem, (size_t)left, (size_t)left);
    double *const ritz = mt_arena_f64(mem, m, m);
    double *const w = mt_arena_f64(mem, m, 1);
    *v = mt_arena_f64(mem, (size_t)left, m);
    MT_TRY(mt_arena_check(mem, err));
    if (qr.rank == 0) {
        return MT_OK;
    }
    MT_TRY(mt_qr_q(&qr, 0, all, mem, err));
    for (ptrdiff_t j = 0; j < qr.rank; j++) {
        for (ptrdiff_t i = 0; i < qr.rank; i++) {
            for (ptrdiff_t k = 0; k < left; k++) {
                ritz[i + (j * qr.rank)] +=
                    all[k + (i * left)] * basis->lambda[keep + k] * all[k + (j * left)];
            }
        }
    }
    MT_TRY(mt_eig_sym(qr.rank, ritz, w, true, mem, err));
    mt_gemm(false, false, left, qr.rank, qr.rank, 1.0, all, left, ritz, qr.rank, 0.0, *v, left);
    return MT_OK;
}

static mt_status reduce(const mt_basis *basis, real_parts *p, int keep, mt_arena *mem,
                        mt_state_space *out, mt_err *err)
{
    const int left = p->r - keep;
    const int massless = p->n - p->r;
    double *v = NULL;
    out->modes = keep;
    out->massless = massless;
    if (left == 0) {
        return MT_OK;
    }
    MT_TRY(residual_shapes(basis, p, keep, mem, &out->residual, &v, err));
    const int r = keep + out->residual;
    const ptrdiff_t n = p->n;
    double *const t = mt_arena_f64(mem, (size_t)n, (size_t)r + (size_t)massless);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < keep; i++) {
        t[i + (i * n)] = 1.0;
    }
    for (ptrdiff_t j = 0; j < out->residual; j++) {
        memcpy(t + keep + ((keep + j) * n), v + (j * left), (size_t)left * sizeof *t);
    }
    for (ptrdiff_t i = 0; i < massless; i++) {
        t[p->r + i + ((r + i) * n)] = 1.0;
    }
    real_parts whole = *p;
    return project(&whole, t, r + massless, r, mem, p, err);
}

/* Where the states of coordinates, rates, massless coordinates and integrals begin. */
typedef struct places {
    int rate;
    int massless;
    int integral;
} places;

/* Integrals of the inputs that outputs need. */
static mt_status list_integrals(const real_parts *p, mt_arena *mem, mt_state_space *out,
                                mt_err *err)
{
    out->integral_of = mt_arena_int(mem, 2 * (size_t)p->n_in);
    out->integral_order = mt_arena_int(mem, 2 * (size_t)p->n_in);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < p->n_in; i++) {
        int highest = 0;
        for (ptrdiff_t o = 0; o < p->n_out; o++) {
            for (int order = 1; order <= -MT_REST_LOWEST; order++) {
                const double *const rest = p->rest[-MT_REST_LOWEST - order];
                if (rest != NULL && rest[o + (i * p->n_out)] != 0.0) {
                    highest = highest > order ? highest : order;
                }
            }
        }
        for (int order = 1; order <= highest; order++) {
            out->integral_of[out->integrals] = (int)i;
            out->integral_order[out->integrals++] = order;
        }
    }
    return MT_OK;
}

static void fill_dynamics(const real_parts *p, places at, mt_state_space *s)
{
    const ptrdiff_t n = s->n;
    const ptrdiff_t m = p->n;
    for (ptrdiff_t d = 0; d < s->massless; d++) {
        const ptrdiff_t row = at.massless + d;
        const ptrdiff_t q = p->r + d;
        const double held = p->c[q + (q * m)];
        for (ptrdiff_t i = 0; i < s->n_in; i++) {
            s->b[row + (i * n)] = p->b[q + (i * m)] / held;
        }
        for (ptrdiff_t j = 0; j < p->r; j++) {
            s->a[row + ((at.rate + j) * n)] = -p->c[q + (j * m)] / held;
        }
        for (ptrdiff_t j = 0; j < s->massless; j++) {
            s->a[row + ((at.massless + j) * n)] = -p->g[q + ((p->r + j) * m)] / held;
        }
    }
    for (ptrdiff_t k = 0; k < p->r; k++) {
        const ptrdiff_t row = at.rate + k;
        s->a[k + (row * n)] = 1.0;
        for (ptrdiff_t i = 0; i < s->n_in; i++) {
            s->b[row + (i * n)] = p->b[k + (i * m)];
        }
        for (ptrdiff_t j = 0; j < p->r; j++) {
            s->a[row + (j * n)] = -p->g[k + (j * m)];
            s->a[row + ((at.rate + j) * n)] = -p->c[k + (j * m)];
        }
        for (ptrdiff_t d = 0; d < s->massless; d++) {
            const double pull = p->c[k + ((p->r + d) * m)];
            const ptrdiff_t from = at.massless + d;
            for (ptrdiff_t j = 0; j < n; j++) {
                s->a[row + (j * n)] -= pull * s->a[from + (j * n)];
            }
            for (ptrdiff_t i = 0; i < s->n_in; i++) {
                s->b[row + (i * n)] -= pull * s->b[from + (i * n)];
            }
        }
    }
    for (ptrdiff_t k = 0; k < s->integrals; k++) {
        const ptrdiff_t row = at.integral + k;
        if (s->integral_order[k] == 1) {
            s->b[row + ((ptrdiff_t)s->integral_of[k] * n)] = 1.0;
        } else {
            s->a[row + ((row - 1) * n)] = 1.0;
        }
    }
}

/* Row o of C and D += share times the derivative of state `row`. */
static void add_rate(mt_state_space *s, ptrdiff_t o, double share, ptrdiff_t row)
{
    const ptrdiff_t n = s->n;
    for (ptrdiff_t j = 0; j < n; j++) {
        s->c[o + (j * s->n_out)] += share * s->a[row + (j * n)];
    }
    for (ptrdiff_t i = 0; i < s->n_in; i++) {
        s->d[o + (i * s->n_out)] += share * s->b[row + (i * n)];
    }
}

/* The second derivative of what has no mass: no input may act on it, whose derivative would
 * appear. */
static mt_status add_massless_acceleration(const real_parts *p, places at, mt_state_space *s,
                                           ptrdiff_t o, double share, ptrdiff_t d, mt_err *err)
{
    const ptrdiff_t m = p->n;
    const ptrdiff_t q = p->r + d;
    for (ptrdiff_t i = 0; i < s->n_in; i++) {
        if (p->b[q + (i * m)] != 0.0) {
            return refused(s, (int)i, (int)o,
                           "this output is the acceleration of a point without mass, which "
                           "follows the derivative of the input",
                           err);
        }
    }
    const double held = p->c[q + (q * m)];
    for (ptrdiff_t j = 0; j < p->r; j++) {
        add_rate(s, o, -share * p->c[q + (j * m)] / held, at.rate + j);
    }
    for (ptrdiff_t j = 0; j < s->massless; j++) {
        add_rate(s, o, -share * p->g[q + ((p->r + j) * m)] / held, at.massless + j);
    }
    return MT_OK;
}

/* Size of the response of o to i where the highest mode is. */
static double size_at(const real_parts *p, ptrdiff_t o, ptrdiff_t i, double w)
{
    const double *const still = p->rest[-MT_REST_LOWEST];
    double size = still == NULL ? 0.0 : fabs(still[o + (i * p->n_out)]);
    for (ptrdiff_t k = 0; k < p->r; k++) {
        double row = 0.0;
        double power = 1.0;
        for (int q = 0; q < MT_FORCED_POWERS; q++) {
            row += power * fabs(p->s[q][o + (k * p->n_out)]);
            power *= w;
        }
        size += row * fabs(p->b[k + (i * p->n)]) / (w * w);
    }
    return size;
}

/* D from what follows the inputs at once, and the integrals. */
static mt_status add_rest(const real_parts *p, places at, double highest, mt_state_space *s,
                          mt_err *err)
{
    for (int power = MT_REST_LOWEST; power <= MT_REST_HIGHEST; power++) {
        const double *const rest = p->rest[power - MT_REST_LOWEST];
        for (ptrdiff_t pair = 0; rest != NULL && pair < (ptrdiff_t)s->n_out * s->n_in; pair++) {
            const ptrdiff_t o = pair % s->n_out;
            const ptrdiff_t i = pair / s->n_out;
            if (power > 0 &&
                fabs(rest[pair]) * pow(highest, power) > ROUNDING * size_at(p, o, i, highest)) {
                return refused(s, (int)i, (int)o,
                               "this output follows a derivative of the input at once: it is "
                               "the motion of a point without mass",
                               err);
            }
            if (power == 0) {
                s->d[pair] += rest[pair];
            }
            for (ptrdiff_t k = 0; power < 0 && k < s->integrals; k++) {
                if (s->integral_of[k] == i && s->integral_order[k] == -power) {
                    s->c[o + ((at.integral + k) * s->n_out)] += rest[pair];
                }
            }
        }
    }
    return MT_OK;
}

/* Row o of C and D, but for what follows the inputs at once. */
static mt_status fill_reading(const real_parts *p, places at, ptrdiff_t o, mt_state_space *s,
                              mt_err *err)
{
    const ptrdiff_t out = s->n_out;
    for (ptrdiff_t k = 0; k < p->r; k++) {
        s->c[o + (k * out)] += p->s[0][o + (k * out)];
        s->c[o + ((at.rate + k) * out)] += p->s[1][o + (k * out)];
        add_rate(s, o, p->s[2][o + (k * out)], at.rate + k);
    }
    for (ptrdiff_t d = 0; d < s->massless; d++) {
        const ptrdiff_t q = (p->r + d) * out;
        s->c[o + ((at.massless + d) * out)] += p->s[0][o + q];
        add_rate(s, o, p->s[1][o + q], at.massless + d);
        if (p->s[2][o + q] != 0.0) {
            MT_TRY(add_massless_acceleration(p, at, s, o, p->s[2][o + q], d, err));
        }
    }
    return MT_OK;
}

mt_status mt_state_space_make(const mt_basis *basis, int keep, mt_arena *mem,
                              mt_state_space *out, mt_err *err)
{
    const mt_transfer *const t = &basis->t;
    const size_t n = (size_t)t->n;
    *out = (mt_state_space){
        .n_in = t->n_in, .n_out = t->n_out, .refused_input = -1, .refused_output = -1};
    real_parts p = {.n = t->n, .r = basis->n_modes, .n_in = t->n_in, .n_out = t->n_out};
    p.c = mt_arena_f64(mem, n, n);
    p.g = mt_arena_f64(mem, n, n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(fill_matrices(basis, &p, out, err));
    MT_TRY(fill_inputs(t, &p, mem, out, err));
    MT_TRY(fill_outputs(basis, &p, mem, out, err));
    int rigid = 0;
    while (rigid < p.r && basis->lambda[rigid] <= 0.0) {
        rigid++;
    }
    const int asked = keep < p.r ? keep : p.r;
    const double highest = p.r > rigid ? sqrt(basis->lambda[p.r - 1]) : 1.0;
    MT_TRY(reduce(basis, &p, asked > rigid ? asked : rigid, mem, out, err));
    MT_TRY(list_integrals(&p, mem, out, err));
    const places at = {p.r, 2 * p.r, (2 * p.r) + out->massless};
    out->n = at.integral + out->integrals;
    out->a = mt_arena_f64(mem, (size_t)out->n, (size_t)out->n);
    out->b = mt_arena_f64(mem, (size_t)out->n, (size_t)out->n_in);
    out->c = mt_arena_f64(mem, (size_t)out->n_out, (size_t)out->n);
    out->d = mt_arena_f64(mem, (size_t)out->n_out, (size_t)out->n_in);
    MT_TRY(mt_arena_check(mem, err));
    fill_dynamics(&p, at, out);
    for (int o = 0; o < out->n_out; o++) {
        MT_TRY(fill_reading(&p, at, o, out, err));
    }
    return add_rest(&p, at, highest, out, err);
}

mt_status mt_state_space_at(const mt_state_space *s, double w, double complex *h,
                            mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t n = s->n;
    const ptrdiff_t both = 2 * n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const a = mt_arena_f64(scratch, (size_t)both, (size_t)both);
    double *const x = mt_arena_f64(scratch, (size_t)both, (size_t)s->n_in);
    MT_TRY(mt_arena_check(scratch, err));
    /* (i w - A)(x + i y) = B: -A x - w y = B, w x - A y = 0 */
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            a[i + (j * both)] = -s->a[i + (j * n)];
            a[n + i + ((n + j) * both)] = -s->a[i + (j * n)];
        }
        a[n + j + (j * both)] = w;
        a[j + ((n + j) * both)] = -w;
    }
    for (ptrdiff_t i = 0; i < s->n_in; i++) {
        memcpy(x + (i * both), s->b + (i * n), (size_t)n * sizeof *x);
    }
    const mt_status rc =
        n == 0 ? MT_OK : mt_lu_solve((int)both, a, s->n_in, x, NULL, scratch, err);
    for (ptrdiff_t pair = 0; pair < (ptrdiff_t)s->n_out * s->n_in; pair++) {
        const ptrdiff_t o = pair % s->n_out;
        const double *const re = x + ((pair / s->n_out) * both);
        double sum[2] = {s->d[pair], 0.0};
        for (ptrdiff_t j = 0; j < n; j++) {
            sum[0] += s->c[o + (j * s->n_out)] * re[j];
            sum[1] += s->c[o + (j * s->n_out)] * re[n + j];
        }
        h[pair] = rc == MT_OK ? mt_complex(sum[0], sum[1]) : mt_complex(HUGE_VAL, 0.0);
    }
    mt_arena_rewind(scratch, mark);
    return rc == MT_E_SINGULAR ? MT_OK : rc;
}
