/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With the letters of slopes.c and slopes_weighted.c, E = [Z, -v], q = [Z, 0] x' and e = E y'.
 * What the joints carry is linear in x' and y', with the parts u = (1, i, s, s^2) of D and f:
 *     l = sum_c u_c F_c x',    m = sum_c u_c G_c y',
 *     F_c = [-sum_j d_jc P A_j Z, P f_c],    G_c = -sum_j d_jc P A_j E + P sigma_c (0 .. 0 1),
 * A_j the matrices of D, d_jc their factors, P what gives the multipliers that balance a force.
 * By one input p,
 *     T_c = -(dA E)^T F_c - G_c^T dA [Z, 0] - E^T (sum_j d_jc dA_j) [Z, 0] + ...,
 * d(sigma) and d(t) standing in the last row, df in the last column.
 */
#include "response/slopes_forms.h"

#include <math.h>
#include <string.h>

#include "analysis/damping.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/products.h"
#include "response/slopes.h"

enum {
    MATRICES = MT_SLOPE_MATRICES,
    PARTS = 4,        /* 1, i, s, s^2 */
    OF_S = 2,         /* the part s */
    AT_ONCE = 1 << 15 /* numbers that are multiplied with T at a time */
};

typedef struct work {
    const mt_slope_problem *p;
    const mt_port *in;
    const mt_port *out;
    int column; /* of the output in the problem */
    mt_linear *lin;
    mt_arena *mem;
    int n;
    int ny; /* n + 1 */
    int nq;
    int m;
    mt_slope_factor d[MATRICES];
    double *e;                 /* nq x ny: E; its first n columns are Z */
    double *product[MATRICES]; /* nq x ny: A_j E */
    double *carried[MATRICES]; /* m x ny: P A_j E */
    double *f[PARTS];          /* m x ny */
    double *g[PARTS];          /* m x ny */
    mt_ratio_modes ratio;
    double *psi;         /* nq x ny: Phi F Phi^T M E */
    double *coefficient; /* r x ny: Phi^T M E */
    double *q;           /* r x r: Q of one input */
    double *moved;       /* m x ny: dA E of one input */
    double *turned;      /* m x ny: dA psi of one input */
    double *half;        /* nq x ny */
} work;

static double part_of_factor(mt_slope_factor f, int c)
{
    return c == 0 ? creal(f.c[0]) : c == 1 ? cimag(f.c[0]) : creal(f.c[c - 1]);
}

/* The part that a real factor times a power of s has. */
static int part_at(int power)
{
    return power == 0 ? 0 : power + 1;
}

/* to (m x cols) := P w, w nq x cols. */
static mt_status multipliers(const work *k, int cols, const double *w, double *to, mt_err *err)
{
    for (ptrdiff_t j = 0; j < cols && k->m > 0; j++) {
        MT_TRY(mt_linear_multipliers(k->lin, w + (j * k->nq), to + (j * k->m), err));
    }
    return MT_OK;
}

static mt_status make_e(work *k, mt_err *err)
{
    const double *const v =
        k->out->kind == MT_PORT_JOINT ? k->p->ways->joint[k->column].v : NULL;
    return mt_slope_motions(k->lin, k->nq, k->n, v, k->e, k->mem, err);
}

/* F and G of what pushes: f, and sigma or what stands in a joint. */
static mt_status set_load_multipliers(work *k, mt_err *err)
{
    double *const f = mt_arena_f64(k->mem, (size_t)k->nq, 1);
    double *const balanced = mt_arena_f64(k->mem, (size_t)k->m, 1);
    const ptrdiff_t last = (ptrdiff_t)k->n * k->m;
    MT_TRY(mt_arena_check(k->mem, err));
    mt_slope_push(k->lin, k->in, f);
    MT_TRY(multipliers(k, 1, f, k->f[part_at(mt_response_power(k->in))] + last, err));
    if (k->out->kind == MT_PORT_JOINT) {
        const double *const standing = k->p->ways->joint[k->column].geometric;
        if (standing != NULL) {
            MT_TRY(multipliers(k, 1, standing, balanced, err));
            mt_axpy(k->m, -1.0, balanced, k->g[0] + last);
        }
        return MT_OK;
    }
    mt_slope_part part[MT_FORCE_PARTS];
    const int n = mt_slope_parts(k->p->a, k->out, part);
    for (int i = 0; i < n; i++) {
        memset(f, 0, (size_t)k->nq * sizeof *f);
        mt_linear_row_add(k->lin, part[i].kind, part[i].row, 1.0, f);
        MT_TRY(multipliers(k, 1, f, balanced, err));
        for (int c = 0; c < PARTS; c++) {
            mt_axpy(k->m, part_of_factor(part[i].factor, c), balanced, k->g[c] + last);
        }
    }
    return MT_OK;
}

/* F and G of one matrix, of which P times its columns is given. */
static void pull(work *k, const double *carried, mt_slope_factor factor)
{
    for (int c = 0; c < PARTS; c++) {
        mt_axpy(k->m * k->n, -part_of_factor(factor, c), carried, k->f[c]);
        mt_axpy(k->m * k->ny, -part_of_factor(factor, c), carried, k->g[c]);
    }
}

static mt_status pull_matrices(work *k, mt_err *err)
{
    for (int j = 0; j < MATRICES; j++) {
        for (ptrdiff_t c = 0; c < k->ny; c++) {
            mt_linear_states_product(k->lin, (mt_linear_matrix)j, 1.0, k->e + (c * k->nq),
                                     k->product[j] + (c * k->nq));
        }
        MT_TRY(multipliers(k, k->ny, k->product[j], k->carried[j], err));
        pull(k, k->carried[j], k->d[j]);
    }
    return MT_OK;
}

/* Modal ratios, a fifth matrix of D with the factor s. */
static mt_status pull_ratios(work *k, mt_err *err)
{
    const int n = k->n;
    const int r = k->ratio.r;
    double *const own = mt_arena_f64(k->mem, (size_t)n, (size_t)k->ny);
    double *const times = mt_arena_f64(k->mem, (size_t)r, (size_t)k->ny);
    double *const carried = mt_arena_f64(k->mem, (size_t)k->m, (size_t)k->ny);
    k->psi = mt_arena_f64(k->mem, (size_t)k->nq, (size_t)k->ny);
    k->coefficient = mt_arena_f64(k->mem, (size_t)r, (size_t)k->ny);
    k->q = mt_arena_f64(k->mem, (size_t)r, (size_t)r);
    k->turned = mt_arena_f64(k->mem, (size_t)k->m, (size_t)k->ny);
    MT_TRY(mt_arena_check(k->mem, err));
    for (ptrdiff_t c = 0; c < k->ny; c++) {
        mt_linear_project(k->lin, k->product[MT_MATRIX_MASS] + (c * k->nq), own + (c * n));
    }
    mt_gemm(true, false, r, k->ny, n, 1.0, k->ratio.y, n, own, n, 0.0, k->coefficient, r);
    for (ptrdiff_t at = 0; at < (ptrdiff_t)r * k->ny; at++) {
        times[at] = k->ratio.f[at % r] * k->coefficient[at];
    }
    mt_gemm(false, false, n, k->ny, r, 1.0, k->ratio.y, n, times, r, 0.0, own, n);
    mt_linear_expand(k->lin, k->ny, own, k->psi);
    memset(k->half, 0, (size_t)k->nq * (size_t)k->ny * sizeof *k->half);
    for (ptrdiff_t c = 0; c < k->ny; c++) {
        mt_linear_states_product(k->lin, MT_MATRIX_MASS, 1.0, k->psi + (c * k->nq),
                                 k->half + (c * k->nq));
    }
    MT_TRY(multipliers(k, k->ny, k->half, carried, err));
    pull(k, carried, (mt_slope_factor){{0.0, 1.0, 0.0}});
    return MT_OK;
}

static mt_status open_work(work *k, mt_err *err)
{
    const size_t ny = (size_t)k->ny;
    const size_t nq = (size_t)k->nq;
    const size_t m = (size_t)k->m;
    k->e = mt_arena_f64(k->mem, nq, ny);
    k->half = mt_arena_f64(k->mem, nq, ny);
    k->moved = mt_arena_f64(k->mem, m, ny);
    for (int j = 0; j < MATRICES; j++) {
        k->product[j] = mt_arena_f64(k->mem, nq, ny);
        k->carried[j] = mt_arena_f64(k->mem, m, ny);
    }
    for (int c = 0; c < PARTS; c++) {
        k->f[c] = mt_arena_f64(k->mem, m, ny);
        k->g[c] = mt_arena_f64(k->mem, m, ny);
    }
    MT_TRY(mt_arena_check(k->mem, err));
    mt_slope_matrices(k->p->a, k->d);
    if (k->p->a->sys->damping.modal) {
        MT_TRY(mt_analysis_ratio_modes(k->p->a, &k->ratio, err));
    }
    MT_TRY(make_e(k, err));
    MT_TRY(set_load_multipliers(k, err));
    MT_TRY(pull_matrices(k, err));
    return k->ratio.r > 0 ? pull_ratios(k, err) : MT_OK;
}

/* t (ny x ny) += scale times left^T right (ny x cols, of `rows` rows). */
static void add_to(const work *k, int rows, int cols, double scale, const double *left,
                   const double *right, double *t)
{
    if (rows > 0) {
        mt_gemm(true, false, k->ny, cols, rows, scale, left, rows, right, rows, 1.0, t, k->ny);
    }
}

/* k->half := dA_j times columns of x. */
static bool matrix_slope(work *k, int p, mt_linear_matrix j, const double *x)
{
    const ptrdiff_t size = (ptrdiff_t)k->nq * k->ny;
    memset(k->half, 0, (size_t)size * sizeof *k->half);
    for (ptrdiff_t c = 0; c < k->ny; c++) {
        mt_linear_states_slope(k->lin, p, j, x + (c * k->nq), k->half + (c * k->nq));
    }
    return mt_max_abs(size, k->half) != 0.0;
}

/* -e . dD q, without modal ratios. */
static void add_matrix_forms(work *k, int p, double *const t[PARTS])
{
    const mt_damping_def *const d = &k->p->a->sys->damping;
    const double mass = mt_slope_node(k->p->a, p, d->mass);
    const double stiffness = mt_slope_node(k->p->a, p, d->stiffness);
    for (int j = 0; j < MATRICES; j++) {
        const bool moves = matrix_slope(k, p, (mt_linear_matrix)j, k->e);
        for (int c = 0; c < PARTS && moves; c++) {
            if (part_of_factor(k->d[j], c) != 0.0) {
                add_to(k, k->nq, k->n, -part_of_factor(k->d[j], c), k->e, k->half, t[c]);
            }
        }
    }
    if (mass != 0.0) {
        add_to(k, k->nq, k->n, -mass, k->e, k->product[MT_MATRIX_MASS], t[OF_S]);
    }
    if (stiffness != 0.0) {
        add_to(k, k->nq, k->n, -stiffness, k->e, k->product[MT_MATRIX_STIFFNESS], t[OF_S]);
    }
}

/* -e . d(ratios) q. */
static mt_status ratios(work *k, int p, double *t, mt_err *err)
{
    const int r = k->ratio.r;
    const double *const carried = k->carried[MT_MATRIX_MASS];
    const mt_arena_mark mark = mt_arena_get_mark(k->mem);
    double *const times = mt_arena_f64(k->mem, (size_t)r, (size_t)k->n);
    MT_TRY(mt_arena_check(k->mem, err));
    if (matrix_slope(k, p, MT_MATRIX_MASS, k->psi)) {
        add_to(k, k->nq, k->n, -1.0, k->e, k->half, t);
    }
    if (matrix_slope(k, p, MT_MATRIX_MASS, k->e)) {
        add_to(k, k->nq, k->n, -1.0, k->psi, k->half, t);
    }
    for (ptrdiff_t c = 0; c < k->ny && k->m > 0; c++) {
        mt_linear_jacobian_slope(k->lin, p, k->psi + (c * k->nq), k->turned + (c * k->m));
    }
    add_to(k, k->m, k->n, 1.0, carried, k->turned, t);
    add_to(k, k->m, k->n, 1.0, k->turned, carried, t);
    MT_TRY(mt_analysis_ratio_slope(k->p->a, p, k->q, err));
    mt_gemm(false, false, r, k->n, r, 1.0, k->q, r, k->coefficient, r, 0.0, times, r);
    add_to(k, r, k->n, -1.0, k->coefficient, times, t);
    mt_arena_rewind(k->mem, mark);
    return MT_OK;
}

/* The last row: d(sigma) . q - d(t) . l. */
static mt_status output_row(work *k, int p, double *const t[PARTS], mt_err *err)
{
    const mt_port *const port = k->out;
    const ptrdiff_t last = k->n;
    if (port->kind == MT_PORT_JOINT) {
        double *const turn = k->half;
        MT_TRY(mt_linear_joint_geometric_slope(k->lin, p, port->index, port->axis, turn, err));
        for (ptrdiff_t j = 0; j < k->n; j++) {
            t[0][last + (j * k->ny)] -= mt_dot(k->nq, turn, k->e + (j * k->nq));
        }
        for (ptrdiff_t at = 0; at < (ptrdiff_t)PARTS * k->ny && k->m > 0; at++) {
            const ptrdiff_t j = at / PARTS;
            t[at % PARTS][last + (j * k->ny)] -= mt_linear_joint_slope(
                k->lin, p, port->index, port->axis, k->f[at % PARTS] + (j * k->m));
        }
        return MT_OK;
    }
    mt_slope_part part[MT_FORCE_PARTS];
    const int n = mt_slope_parts(k->p->a, port, part);
    for (int i = 0; i < n; i++) {
        const mt_slope_factor turn = mt_slope_turn(k->p->a, p, &part[i]);
        for (ptrdiff_t j = 0; j < k->n; j++) {
            const double *const z = k->e + (j * k->nq);
            const double own = mt_linear_row_dot_slope(k->lin, p, part[i].kind, part[i].row, z);
            const double way = mt_linear_row_dot(k->lin, part[i].kind, part[i].row, z);
            for (int c = 0; c < PARTS; c++) {
                t[c][last + (j * k->ny)] +=
                    (part_of_factor(part[i].factor, c) * own) + (part_of_factor(turn, c) * way);
            }
        }
    }
    return MT_OK;
}

/* The last column: e . df. */
static void input_column(const work *k, int p, double *t)
{
    for (ptrdiff_t i = 0; i < k->ny; i++) {
        const double *const e = k->e + (i * k->nq);
        t[i + ((ptrdiff_t)k->n * k->ny)] +=
            k->in->kind == MT_PORT_SENSOR
                ? mt_linear_row_dot_slope(k->lin, p, MT_TERM_CHANNEL,
                                          mt_slope_channel(k->lin, k->in), e)
                : mt_linear_base_slope(k->lin, p, k->in->index, e);
    }
}

/* t[c] := T_c of input p. */
static mt_status forms_by(work *k, int p, double *const t[PARTS], mt_err *err)
{
    for (ptrdiff_t c = 0; c < k->ny && k->m > 0; c++) {
        mt_linear_jacobian_slope(k->lin, p, k->e + (c * k->nq), k->moved + (c * k->m));
    }
    const bool moves = mt_max_abs((ptrdiff_t)k->m * k->ny, k->moved) != 0.0;
    for (int c = 0; c < PARTS && moves; c++) {
        add_to(k, k->m, k->ny, -1.0, k->moved, k->f[c], t[c]);
        add_to(k, k->m, k->n, -1.0, k->g[c], k->moved, t[c]);
    }
    add_matrix_forms(k, p, t);
    if (k->ratio.r > 0) {
        MT_TRY(ratios(k, p, t[OF_S], err));
    }
    input_column(k, p, t[part_at(mt_response_power(k->in))]);
    return output_row(k, p, t, err);
}

/* Keeps the entries of t (n_inputs times ny x ny x PARTS, the parts last) that are nonzero for
 * some input. */
static mt_status keep_used(const work *k, const double *t, mt_arena *mem, mt_slope_forms *f,
                           mt_err *err)
{
    const ptrdiff_t inputs = k->p->a->sys->n_inputs;
    const ptrdiff_t square = (ptrdiff_t)k->ny * k->ny;
    const ptrdiff_t all = PARTS * square;
    f->entry = mt_arena_int(mem, (size_t)all);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t at = 0; at < all; at++) {
        const ptrdiff_t from = ((at % PARTS) * square) + (at / PARTS);
        bool used = false;
        for (ptrdiff_t p = 0; p < inputs; p++) {
            used = used || t[from + (p * all)] != 0.0;
        }
        if (used) {
            f->entry[f->used++] = (int)at;
        }
    }
    f->t = mt_arena_f64(mem, (size_t)inputs, (size_t)f->used);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t i = 0; i < f->used; i++) {
        const ptrdiff_t from = ((f->entry[i] % PARTS) * square) + (f->entry[i] / PARTS);
        for (ptrdiff_t p = 0; p < inputs; p++) {
            f->t[p + (i * inputs)] = t[from + (p * all)];
        }
    }
    return MT_OK;
}

static mt_status make_slope_forms(work *k, mt_arena *mem, mt_slope_forms *f, mt_err *err)
{
    const size_t inputs = (size_t)k->p->a->sys->n_inputs;
    const size_t square = (size_t)k->ny * (size_t)k->ny;
    double *const t = mt_arena_f64(k->mem, inputs * PARTS, square);
    MT_TRY(mt_arena_check(k->mem, err));
    MT_TRY(mt_linear_complete(k->lin, err));
    MT_TRY(open_work(k, err));
    for (size_t p = 0; p < inputs; p++) {
        double *const own = t + (p * PARTS * square);
        mt_independence why = {.opens = false};
        MT_TRY(mt_linear_independence(k->lin, (int)p, k->mem, &why, err));
        f->none[p] = why.opens || why.blocks;
        if (!f->none[p]) {
            MT_TRY(forms_by(k, (int)p,
                            (double *const[PARTS]){own, own + square, own + (2 * square),
                                                   own + (3 * square)},
                            err));
        }
    }
    return keep_used(k, t, mem, f, err);
}

mt_status mt_slope_forms_make(const mt_slope_problem *p, int out, int in, int frequencies,
                              mt_arena *mem, mt_slope_forms *f, mt_err *err)
{
    const int n = mt_linear_freedoms(p->a->lin);
    mt_arena scratch;
    *f = (mt_slope_forms){.p = p, .out = out, .in = in, .single = frequencies < n};
    MT_TRY(mt_slope_admit(p, err));
    MT_TRY(mt_solutions_open(p->basis, out, in, mem, &f->of, err));
    f->none = mt_arena_alloc(mem, (size_t)p->a->sys->n_inputs, sizeof *f->none);
    MT_TRY(mt_arena_check(mem, err));
    if (f->single) {
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&scratch, 0, err));
    work k = {.p = p,
              .in = &p->ports->in[in],
              .out = &p->ports->out[out],
              .column = out,
              .lin = p->a->lin,
              .mem = &scratch,
              .n = n,
              .ny = n + 1,
              .nq = p->a->sys->nq,
              .m = mt_linear_equations(p->a->lin)};
    const mt_status rc = make_slope_forms(&k, mem, f, err);
    mt_arena_free(&scratch);
    return rc;
}

/* At one frequency: both parts of u_c y'_i x'_j of the entries that are used. */
static void products_of(const mt_slope_forms *f, double w, const double complex *x,
                        const double complex *y, double *re, double *im)
{
    const int ny = f->of.basis->f->n + 1;
    for (int k = 0; k < f->used; k++) {
        const int row = f->entry[k] / PARTS % ny;
        const int column = f->entry[k] / PARTS / ny;
        const double yr = creal(y[row]);
        const double yi = cimag(y[row]);
        const double xr = creal(x[column]);
        const double xi = cimag(x[column]);
        const double r = (yr * xr) - (yi * xi);
        const double i = (yr * xi) + (yi * xr);
        switch (f->entry[k] % PARTS) {
        case 0:
            re[k] = r;
            im[k] = i;
            break;
        case 1:
            re[k] = -i;
            im[k] = r;
            break;
        case OF_S:
            re[k] = -w * i;
            im[k] = w * r;
            break;
        default:
            re[k] = -w * w * r;
            im[k] = -w * w * i;
        }
    }
}

/* As many frequencies as there is room for. */
typedef struct batch {
    double complex *x; /* [n + 1] */
    double complex *y; /* [n + 1] */
    double *part[2];   /* used x count */
    double *slope[2];  /* n_inputs x count */
    bool *singular;    /* [count] */
} batch;

static mt_status new_batch(const mt_slope_forms *f, int most, mt_arena *mem, batch *b,
                           mt_err *err)
{
    const size_t ny = (size_t)f->of.basis->f->n + 1;
    const size_t inputs = (size_t)f->p->a->sys->n_inputs;
    b->x = mt_arena_alloc(mem, ny, sizeof *b->x);
    b->y = mt_arena_alloc(mem, ny, sizeof *b->y);
    b->singular = mt_arena_alloc(mem, (size_t)most, sizeof *b->singular);
    for (int i = 0; i < 2; i++) {
        b->part[i] = mt_arena_f64(mem, (size_t)f->used, (size_t)most);
        b->slope[i] = mt_arena_f64(mem, inputs, (size_t)most);
    }
    MT_TRY(mt_arena_check(mem, err));
    b->x[ny - 1] = 1.0;
    b->y[ny - 1] = 1.0;
    return MT_OK;
}

static mt_status batch_at(const mt_slope_forms *f, const batch *b, int count, const double *w,
                          double complex *h, double complex *dh, mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t used = f->used;
    const ptrdiff_t inputs = f->p->a->sys->n_inputs;
    for (ptrdiff_t i = 0; i < count; i++) {
        MT_TRY(
            mt_solutions_one(&f->of, w[i], b->x, b->y, &h[i], &b->singular[i], scratch, err));
        if (!b->singular[i]) {
            products_of(f, w[i], b->x, b->y, b->part[0] + (i * used), b->part[1] + (i * used));
        }
    }
    for (int c = 0; c < 2 && used > 0; c++) {
        mt_gemm(false, false, (int)inputs, count, (int)used, 1.0, f->t, (int)inputs, b->part[c],
                (int)used, 0.0, b->slope[c], (int)inputs);
    }
    for (ptrdiff_t at = 0; at < inputs * count; at++) {
        dh[at] = b->singular[at / inputs] || f->none[at % inputs]
                     ? (double complex)nan("")
                     : mt_complex(b->slope[0][at], b->slope[1][at]);
    }
    return MT_OK;
}

/* Without the forms: derivatives of all pairs of the problem, of which one is used. */
static mt_status single_at(const mt_slope_forms *f, double w, double complex *h,
                           double complex *dh, mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t inputs = f->p->a->sys->n_inputs;
    const mt_forced *const of = f->p->basis->f;
    const ptrdiff_t pairs = (ptrdiff_t)of->n_in * of->n_out;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double complex *const all = mt_arena_alloc(scratch, (size_t)(pairs * inputs), sizeof *all);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_transfer_at(&f->of.one, w, &(mt_sample){.h = h}, scratch, err));
    MT_TRY(mt_response_slopes(f->p, w, all, scratch, err));
    for (ptrdiff_t p = 0; p < inputs; p++) {
        dh[p] = all[f->out + ((ptrdiff_t)f->in * of->n_out) + (p * pairs)];
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

mt_status mt_slope_forms_at(const mt_slope_forms *f, int count, const double *w,
                            double complex *h, double complex *dh, mt_arena *scratch,
                            mt_err *err)
{
    const ptrdiff_t inputs = f->p->a->sys->n_inputs;
    for (ptrdiff_t i = 0; i < count && f->single; i++) {
        MT_TRY(mt_interrupt_check(f->p->a->sys->run->interrupt, err));
        MT_TRY(single_at(f, w[i], &h[i], dh + (i * inputs), scratch, err));
    }
    if (f->single) {
        return MT_OK;
    }
    const int room = 1 + (AT_ONCE / (f->used + 1));
    const int most = room < count ? room : count;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    batch b;
    MT_TRY(new_batch(f, most, scratch, &b, err));
    for (ptrdiff_t at = 0; at < count; at += most) {
        const int own = count - at < most ? (int)(count - at) : most;
        MT_TRY(mt_interrupt_check(f->p->a->sys->run->interrupt, err));
        MT_TRY(batch_at(f, &b, own, w + at, h + at, dh + (at * inputs), scratch, err));
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
