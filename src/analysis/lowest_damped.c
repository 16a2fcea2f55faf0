/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * (s^2 M + s C + K + i H) y = 0 of a large mechanism by the nonlinear method of Arnoldi (Voss,
 * BIT 44, 2004), in the coordinates (x, a) of analysis/lowest.h:
 *     K = diag(H - s0 H A, 0),    M = diag(H A, I),
 * H being the operator of that name there. Galerkin's problem in a real basis X, X^T H X = I,
 * that begins with the undamped modes is solved as a dense one; where the residual r of one of
 * its roots s is not rounding, the basis is extended by Re and Im of H^-1 r (Neumaier's
 * residual inverse iteration). The matrices are symmetric, so y is the left eigenvector, too,
 * and to first order
 *     |ds| <= ||y|| ||H^-1 r|| / |y^T (2 s M + C) y|,
 * the norms being those of H. Galerkin's condition makes y^T r vanish: the actual error is of
 * second order.
 */
#include "analysis/lowest_damped.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/complex.h"
#include "linalg/dense.h"
#include "mechanics/rows.h"

/* A residual of this part of K y is rounding of a long chain. */
static const double CONVERGED = 1e-11;
/* Roots with a greater error are not given. */
static const double MOST_ERROR = 1e-6;
/* What is left of a shape beside the others, below which it is one of them. */
static const double DEPENDENT = 1e-8;
/* Extensions of the basis at most; shapes for each oscillating root, and besides. */
enum { MOST_EXTENSIONS = 25, SHAPES_EACH = 6, SHAPES_BESIDES = 24 };
/* Rows of a term. */
enum { MOST_ROWS = 16 };

/* Dampers, and springs whose loss factor is not that of most: sums over rows of
 * (damping + i structural) row partner^T. */
typedef struct local_damping {
    mt_rows row; /* over the states */
    double *damping;
    double *structural;
    int *partner;
} local_damping;

/* A motion (x, a), or a force by its work on one. */
typedef struct coordinates {
    double *x; /* [n_x] */
    double *a; /* [free] */
} coordinates;

typedef struct search {
    mt_lowest *l;
    mt_arena *mem; /* scratch */
    char *why;
    int n_x;
    int free;
    int kept; /* vibration modes in the basis, its first vectors */
    int size; /* vectors */
    int most;
    double *x; /* n_x x most */
    double shift;
    double alpha, beta;
    double loss; /* common to all springs */
    local_damping local;
    double left;   /* lambda from which on modes are not kept */
    double *ratio; /* [kept] damping ratios; NULL: none */
    double ratio_left;
    /* Galerkin's matrices, of order free + size in arrays of order free + most: rigid-body
     * amplitudes first */
    double *m, *c, *h;
    /* work */
    coordinates q, f, g;
    mt_lowest_push push;
    double *states, *force, *v, *r;
} search;

static double node_value(const mt_data *d, mt_node node)
{
    return creal(mt_data_scalar(d, node, 0.0));
}

static bool refuse_damped(search *k, const char *why)
{
    (void)mt_snprintf(k->why, MT_LOWEST_DAMPED_WHY, "%s", why);
    return false;
}

static double local_coefficient(const search *k, const mt_data *d, mt_term_kind kind,
                                const mt_term *t)
{
    const double c = node_value(d, t->coefficient);
    return kind == MT_TERM_DAMPING ? c : c * (node_value(d, t->loss) - k->loss);
}

/* Adds the rows of a term. */
static void add_local_term(search *k, const mt_data *d, const mt_placement *at,
                           mt_term_kind kind, const mt_term *t, int *n)
{
    local_damping *const to = &k->local;
    const double c = local_coefficient(k, d, kind, t);
    const double part = t->pair ? 0.5 * c : c;
    mt_cx rows[MOST_ROWS * MT_LOCAL];
    mt_term_rows(d, kind, t, at->pose, rows);
    for (int r = 0; r < t->count; r++, (*n)++) {
        for (int i = 0; i < MT_LOCAL; i++) {
            const int q = mt_local_dof(k->l->sys, t->body, i);
            if (q >= 0 && rows[(r * MT_LOCAL) + i] != 0.0) {
                mt_rows_push(&to->row, *n, q, creal(rows[(r * MT_LOCAL) + i]));
            }
        }
        mt_rows_end(&to->row, *n);
        to->damping[*n] = kind == MT_TERM_DAMPING ? part : 0.0;
        to->structural[*n] = kind == MT_TERM_DAMPING ? 0.0 : part;
        to->partner[*n] = *n + (t->pair ? 1 - (2 * r) : 0);
    }
}

static mt_status read_local_damping(search *k, const mt_data *d, const mt_placement *at,
                                    const mt_term_list *list, bool *is, mt_err *err)
{
    static const mt_term_kind kinds[] = {MT_TERM_DAMPING, MT_TERM_STIFFNESS};
    local_damping *const to = &k->local;
    int rows = 0;
    for (int pass = 0; pass < 2; pass++) {
        int n = 0;
        for (int which = 0; which < MT_COUNT(kinds); which++) {
            const mt_term_list *const own = &list[kinds[which]];
            for (int i = 0; i < own->n_terms; i++) {
                const mt_term *const t = &own->terms[i];
                if (local_coefficient(k, d, kinds[which], t) == 0.0) {
                    continue;
                }
                *is = *is && t->count <= MOST_ROWS;
                if (pass == 0 || !*is) {
                    rows += t->count;
                } else {
                    add_local_term(k, d, at, kinds[which], t, &n);
                }
            }
        }
        if (pass == 0) {
            mt_rows_begin(&to->row, rows, (size_t)rows * MT_LOCAL, k->mem);
            to->damping = mt_arena_f64(k->mem, (size_t)rows, 1);
            to->structural = mt_arena_f64(k->mem, (size_t)rows, 1);
            to->partner = mt_arena_int(k->mem, (size_t)rows);
            MT_TRY(mt_arena_check(k->mem, err));
        }
    }
    *is = *is || refuse_damped(k, "a damper of so many rows needs all modes");
    return MT_OK;
}

/* All damping. *is false: refused. */
static mt_status read_damping(search *k, bool *is, mt_err *err)
{
    const mt_system *const sys = k->l->sys;
    const mt_damping_def *const def = &sys->damping;
    mt_term_list list[MT_TERM_KINDS];
    mt_data d;
    mt_placement at;
    MT_TRY(mt_terms_new(sys, k->mem, list, err));
    MT_TRY(mt_absolute_stand(sys, mt_lowest_settled(k->l), k->l->at, &d, &at, k->mem, err));
    k->alpha = node_value(&d, def->mass);
    k->beta = node_value(&d, def->stiffness);
    /* under a load K is more than its springs */
    k->loss = sys->loaded ? 0.0 : mt_terms_common_loss(&d, &list[MT_TERM_STIFFNESS]);
    if (def->n_named > 0) {
        *is = refuse_damped(k, "damping ratios of named modes need all modes");
        return MT_OK;
    }
    if (def->modal) {
        k->ratio = mt_arena_f64(k->mem, (size_t)k->kept, 1);
        MT_TRY(mt_arena_check(k->mem, err));
        k->ratio_left = node_value(&d, def->ratio);
        for (int i = 0; i < k->kept; i++) {
            k->ratio[i] = node_value(&d, i < def->n_ratios ? def->ratios[i] : def->ratio);
        }
        for (int i = k->kept; i < def->n_ratios; i++) {
            k->ratio_left = fmax(k->ratio_left, node_value(&d, def->ratios[i]));
        }
    }
    return read_local_damping(k, &d, &at, list, is, err);
}

/* Motions and forces. */

/* k->states := the motion of all states of (x, a). */
static void expand_motion(search *k, coordinates q)
{
    const mt_lowest *const l = k->l;
    if (l->way == MT_LOWEST_TREE) {
        const struct mt_lowest_operation *const o = l->operation;
        for (int i = 0; i < k->free; i++) { /* r = L^-T (a - L^-1 M_ry x) */
            k->r[i] = -mt_dot(k->n_x, o->m_yr + ((ptrdiff_t)k->n_x * i), q.x);
        }
        mt_tri_solve(false, k->free, 1, o->m_rr, k->r, k->free);
        mt_axpy(k->free, 1.0, q.a, k->r);
        mt_tri_solve(true, k->free, 1, o->m_rr, k->r, k->free);
        mt_tree_motion(l->tree, q.x, k->r, k->v);
        mt_tree_states(l->tree, k->v, k->states);
        return;
    }
    memcpy(k->v, q.x, (size_t)k->n_x * sizeof *k->v);
    for (int i = 0; i < k->free; i++) {
        mt_axpy(k->n_x, q.a[i], l->found.x + ((ptrdiff_t)k->n_x * i), k->v);
    }
    mt_absolute_shape(&l->bodies, k->v, k->states);
}

/* f := the work of k->force, on all states, on (x, a). */
static mt_status gather_force(search *k, coordinates f, mt_err *err)
{
    const mt_lowest *const l = k->l;
    if (l->way == MT_LOWEST_TREE) {
        MT_TRY(mt_lowest_force(l, k->force, &k->push, err));
        memcpy(f.x, k->push.x, (size_t)k->n_x * sizeof *f.x);
        memcpy(f.a, k->push.a, (size_t)k->free * sizeof *f.a);
        return MT_OK;
    }
    mt_absolute_push(&l->bodies, k->force, f.x);
    for (int i = 0; i < k->free; i++) {
        f.a[i] = mt_dot(k->n_x, l->found.x + ((ptrdiff_t)k->n_x * i), f.x);
    }
    for (int i = 0; i < k->free; i++) {
        mt_sparse_solver_mass(l->solver, l->found.x + ((ptrdiff_t)k->n_x * i), k->v);
        mt_axpy(k->n_x, -f.a[i], k->v, f.x);
    }
    return MT_OK;
}

/* f := weights times rows and partners on the motion k->states: C or H of what damps
 * locally. */
static mt_status local_force(search *k, const double *weight, coordinates f, mt_err *err)
{
    const local_damping *const from = &k->local;
    memset(k->force, 0, (size_t)k->l->sys->nq * sizeof *k->force);
    bool any = false;
    for (int r = 0; r < from->row.n_rows; r++) {
        if (weight[r] != 0.0) {
            const double rate = mt_rows_dot(&from->row, from->partner[r], k->states);
            mt_rows_axpy(&from->row, r, weight[r] * rate, k->force);
            any = true;
        }
    }
    if (!any) {
        memset(f.x, 0, (size_t)k->n_x * sizeof *f.x);
        memset(f.a, 0, (size_t)k->free * sizeof *f.a);
        return MT_OK;
    }
    return gather_force(k, f, err);
}

/* x := H^-1 f. */
static mt_status solve_with_factor(search *k, const double *f, double *x, mt_err *err)
{
    if (k->l->way == MT_LOWEST_TREE) {
        memcpy(x, f, (size_t)k->n_x * sizeof *x);
        return MT_OK;
    }
    return mt_sparse_solver_solve(k->l->solver, f, x, NULL, err);
}

/* In the norm of H. */
static double energy_norm(const search *k, const double *x)
{
    const double *const dual = mt_lowest_dual(k->l, x, k->g.x);
    return sqrt(fmax(mt_dot(k->n_x, x, dual), 0.0));
}

/* x -= its part along the basis. */
static void clear_of_basis(const search *k, double *x)
{
    const double *const dual = mt_lowest_dual(k->l, x, k->g.x);
    for (int i = 0; i < k->size; i++) {
        const double *const own = k->x + ((ptrdiff_t)k->n_x * i);
        mt_axpy(k->n_x, -mt_dot(k->n_x, own, dual), own, x);
    }
}

/* The basis and Galerkin's matrices. */

/* Column `at` (counted with the rigid-body amplitudes) of Galerkin's matrix: the work of f on
 * each vector; and its row. */
static void write_products(const search *k, double *matrix, coordinates f, int at)
{
    const ptrdiff_t ld = (ptrdiff_t)k->free + k->most;
    for (int i = 0; i <= at; i++) {
        const double by = i < k->free
                              ? f.a[i]
                              : mt_dot(k->n_x, k->x + ((ptrdiff_t)k->n_x * (i - k->free)), f.x);
        matrix[i + (at * ld)] = by;
        matrix[at + (i * ld)] = by;
    }
}

/* What damps the motion q locally, as that column of C and H. */
static mt_status add_local_products(search *k, coordinates q, int at, mt_err *err)
{
    if (k->local.row.n_rows == 0) {
        return MT_OK;
    }
    expand_motion(k, q);
    MT_TRY(local_force(k, k->local.damping, k->f, err));
    write_products(k, k->c, k->f, at);
    MT_TRY(local_force(k, k->local.structural, k->f, err));
    write_products(k, k->h, k->f, at);
    return MT_OK;
}

/* Extends the basis by x (overwritten), unless it depends on it. *added is set where it does
 * not. */
static mt_status extend_basis(search *k, double *x, bool *added, mt_err *err)
{
    const double was = energy_norm(k, x);
    double size = was;
    for (int round = 0; round < 2 && size > 0.0; round++) {
        clear_of_basis(k, x);
        MT_TRY(round == 0 ? mt_lowest_admit(k->l, x, err) : MT_OK);
        size = energy_norm(k, x);
    }
    if (!(size > DEPENDENT * was) || k->size == k->most) {
        return MT_OK;
    }
    double *const to = k->x + ((ptrdiff_t)k->n_x * k->size);
    for (int j = 0; j < k->n_x; j++) {
        to[j] = x[j] / size;
    }
    const int at = k->free + k->size;
    memset(k->q.a, 0, (size_t)k->free * sizeof *k->q.a);
    memset(k->f.a, 0, (size_t)k->free * sizeof *k->f.a);
    k->size++;
    *added = true;
    MT_TRY(mt_lowest_momentum(k->l, to, k->f.x, err));
    write_products(k, k->m, k->f, at);
    return add_local_products(k, (coordinates){.x = to, .a = k->q.a}, at, err);
}

static mt_status begin_basis(search *k, mt_err *err)
{
    bool added = false;
    memset(k->q.x, 0, (size_t)k->n_x * sizeof *k->q.x);
    for (int i = 0; i < k->free; i++) {
        memset(k->q.a, 0, (size_t)k->free * sizeof *k->q.a);
        k->q.a[i] = 1.0;
        MT_TRY(add_local_products(k, k->q, i, err));
    }
    for (int i = 0; i < k->kept; i++) {
        memcpy(k->q.x, mt_lowest_mode(k->l, i), (size_t)k->n_x * sizeof *k->q.x);
        MT_TRY(extend_basis(k, k->q.x, &added, err));
    }
    return MT_OK;
}

/* Galerkin's problem in coordinates of its own undamped modes, where M is the identity. */
typedef struct galerkin {
    int n;
    int size;  /* of the basis */
    double *t; /* size x size: the modes in the basis */
    mt_modes modes;
    double *c; /* n x n */
    mt_damped_modes roots;
    int listed;      /* of the roots, */
    int oscillating; /* and of these */
    double *error;   /* [listed] of |ds|/|s| */
    double *open;    /* [listed] of the residual, relative to K y */
} galerkin;

static mt_status open_galerkin(const search *k, mt_arena *mem, galerkin *g, mt_err *err)
{
    const size_t n = (size_t)k->free + (size_t)k->size;
    mt_modes *const m = &g->modes;
    g->n = (int)n;
    g->size = k->size;
    g->t = mt_arena_f64(mem, (size_t)k->size, (size_t)k->size);
    g->c = mt_arena_f64(mem, n, n);
    *m = (mt_modes){.n = (int)n,
                    .all = (int)n,
                    .count = (int)n,
                    .shaped = (int)n,
                    .n_rigid = k->free,
                    .lambda = mt_arena_f64(mem, n, 1),
                    .error = mt_arena_f64(mem, n, 1),
                    .y = mt_arena_f64(mem, n, n),
                    .kind = mt_arena_alloc(mem, n, sizeof *m->kind),
                    .cluster = mt_arena_int(mem, n)};
    return mt_arena_check(mem, err);
}

/* Undamped modes: the kept ones are known better than by their Ritz values. */
static mt_status solve_undamped(search *k, mt_arena *mem, galerkin *g, bool *is, mt_err *err)
{
    const ptrdiff_t ld = (ptrdiff_t)k->free + k->most;
    const mt_modes *const exact = &k->l->found.modes;
    double *const theta = mt_arena_f64(mem, (size_t)k->size, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t j = 0; j < k->size; j++) {
        memcpy(g->t + (j * k->size), k->m + k->free + ((k->free + j) * ld),
               (size_t)k->size * sizeof *g->t);
    }
    const mt_status rc = mt_eig_graded(k->size, g->t, theta, mem, err);
    if (rc == MT_E_NOT_SPD) {
        *is = refuse_damped(k, "sixteen digits do not resolve the shapes that damping adds");
        return MT_OK;
    }
    MT_TRY(rc);
    for (int i = 0; i < g->n; i++) {
        const int j = i - k->free;
        g->modes.y[(ptrdiff_t)i * (g->n + 1)] = 1.0;
        g->modes.kind[i] = j < 0 ? MT_MODE_RIGID_BODY : MT_MODE_FLEXIBLE;
        g->modes.cluster[i] = i;
        if (j >= 0) {
            g->modes.lambda[i] = j < k->kept ? exact->lambda[i] : (1.0 / theta[j]) - k->shift;
            for (int r = 0; r < k->size; r++) {
                g->t[r + ((ptrdiff_t)j * k->size)] /= sqrt(theta[j]);
            }
        }
    }
    return MT_OK;
}

/* out (n x n) := T^T A T, A one of Galerkin's matrices. */
static void turn_galerkin(const search *k, const galerkin *g, const double *a, double *work,
                          double *out)
{
    const int ld = k->free + k->most;
    const int n = g->n;
    const int r = k->free;
    const int size = k->size;
    for (ptrdiff_t j = 0; j < r; j++) {
        memcpy(work + (j * n), a + (j * ld), (size_t)n * sizeof *work);
    }
    mt_gemm(false, false, n, size, size, 1.0, a + ((ptrdiff_t)r * ld), ld, g->t, size, 0.0,
            work + ((ptrdiff_t)r * n), n);
    for (ptrdiff_t j = 0; j < n; j++) {
        memcpy(out + (j * n), work + (j * n), (size_t)r * sizeof *out);
    }
    mt_gemm(true, false, size, n, size, 1.0, g->t, size, work + r, n, 0.0, out + r, n);
}

/* 2 zeta omega of mode j (counted without rigid-body ones) of Galerkin's problem. */
static double rate_of_ratio(const search *k, int j, double lambda)
{
    const double ratio = k->ratio == NULL ? 0.0 : j < k->kept ? k->ratio[j] : k->ratio_left;
    return 2.0 * ratio * sqrt(lambda);
}

static mt_status solve_galerkin(search *k, mt_arena *mem, galerkin *g, bool *is, mt_err *err)
{
    MT_TRY(open_galerkin(k, mem, g, err));
    MT_TRY(solve_undamped(k, mem, g, is, err));
    if (!*is) {
        return MT_OK;
    }
    const size_t n = (size_t)g->n;
    double *const stiffness = mt_arena_f64(mem, n, n);
    double *const h = mt_arena_f64(mem, n, n);
    double *const work = mt_arena_f64(mem, n, n);
    mt_mass_factor mass;
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_modal_identity_mass(g->n, mem, &mass, err));
    turn_galerkin(k, g, k->c, work, g->c);
    turn_galerkin(k, g, k->h, work, h);
    for (int i = 0; i < g->n; i++) {
        const ptrdiff_t at = (ptrdiff_t)i * (g->n + 1);
        const double lambda = g->modes.lambda[i];
        const int j = i - k->free;
        stiffness[at] = lambda;
        g->c[at] += k->alpha + (k->beta * lambda) + (j < 0 ? 0.0 : rate_of_ratio(k, j, lambda));
        h[at] += k->loss * lambda;
    }
    const bool structural = mt_max_abs((ptrdiff_t)(n * n), h) > 0.0;
    const mt_damped_problem p = {.n = g->n,
                                 .k = stiffness,
                                 .c = g->c,
                                 .h = structural ? h : NULL,
                                 .mass = &mass,
                                 .modes = &g->modes};
    return mt_modal_damped(&p, mem, &g->roots, err);
}

/* The residual of a root in the whole mechanism. */

/* Adds z times real and imaginary part of what a real vector is multiplied with. */
static void add_complex(int n, double complex z, const double *x, double *re, double *im)
{
    mt_axpy(n, creal(z), x, re);
    mt_axpy(n, cimag(z), x, im);
}

/* r += z D(s) q of a real motion q. */
static mt_status add_residual(search *k, double complex s, double complex z, coordinates q,
                              double *re, double *im, mt_err *err)
{
    const int n = k->n_x;
    const double complex i = mt_complex(0.0, 1.0);
    const double complex of_k = 1.0 + (s * k->beta) + (i * k->loss);
    const double complex of_m = (s * s) + (s * k->alpha) - (k->shift * of_k);
    const double *const hx = mt_lowest_dual(k->l, q.x, k->g.x);
    add_complex(n, z * of_k, hx, re, im);
    MT_TRY(mt_lowest_momentum(k->l, q.x, k->f.x, err));
    add_complex(n, z * of_m, k->f.x, re, im);
    if (k->local.row.n_rows > 0) {
        expand_motion(k, q);
        MT_TRY(local_force(k, k->local.damping, k->f, err));
        add_complex(n, z * s, k->f.x, re, im);
        MT_TRY(local_force(k, k->local.structural, k->f, err));
        add_complex(n, z * i, k->f.x, re, im);
    }
    return MT_OK;
}

/* A root, its vector in the basis, and what it leaves open. */
typedef struct root {
    double complex s;
    const double *y[2]; /* real and imaginary part in Galerkin's coordinates */
    double *c, *work;   /* [n] work */
    double *v[2];       /* [n_x] real and imaginary part of H^-1 r, beside the basis */
    double open;        /* size of v over that of y */
    double error;       /* of |ds|/|s| */
} root;

/* y^T (2 s + C) y. */
static double complex find_denominator(const galerkin *g, const root *t, double *work)
{
    double part[2][2];
    double square[2][2];
    for (int i = 0; i < 2; i++) {
        mt_symm(g->n, 1, g->c, t->y[i], work);
        for (int j = 0; j < 2; j++) {
            part[i][j] = mt_dot(g->n, t->y[j], work);
            square[i][j] = mt_dot(g->n, t->y[j], t->y[i]);
        }
    }
    return (2.0 * t->s * mt_complex(square[0][0] - square[1][1], 2.0 * square[0][1])) +
           mt_complex(part[0][0] - part[1][1], 2.0 * part[0][1]);
}

static mt_status find_residual(search *k, const galerkin *g, root *t, mt_err *err)
{
    const size_t bytes = (size_t)k->n_x * sizeof(double);
    double *const r[2] = {t->v[0], t->v[1]};
    double motion = 0.0; /* squares of sizes: of x, of a, of what is no mode in x */
    double rigid = 0.0;
    double beside = 0.0;
    memset(r[0], 0, bytes);
    memset(r[1], 0, bytes);
    for (int part = 0; part < 2; part++) {
        const double *const y = t->y[part];
        if (!(mt_max_abs(g->n, y) > 0.0)) {
            continue;
        }
        mt_gemv(false, g->size, g->size, 1.0, g->t, g->size, y + k->free, 0.0, t->c);
        mt_gemv(false, k->n_x, g->size, 1.0, k->x, k->n_x, t->c, 0.0, k->q.x);
        memcpy(k->q.a, y, (size_t)k->free * sizeof *k->q.a);
        motion += mt_dot(g->size, t->c, t->c);
        beside += mt_dot(g->size - k->kept, t->c + k->kept, t->c + k->kept);
        rigid += mt_dot(k->free, y, y);
        MT_TRY(add_residual(k, t->s, part == 0 ? 1.0 : mt_complex(0.0, 1.0), k->q, r[0], r[1],
                            err));
    }
    double left = 0.0;
    for (int part = 0; part < 2; part++) {
        memcpy(k->q.x, r[part], bytes);
        MT_TRY(solve_with_factor(k, k->q.x, t->v[part], err));
        clear_of_basis(k, t->v[part]);
        clear_of_basis(k, t->v[part]);
        left = hypot(left, energy_norm(k, t->v[part]));
    }
    const double size = cabs(t->s);
    const double scale = sqrt(motion + (size * size * rigid));
    /* modal ratios of modes that are not kept: at most 2 zeta omega M <= 2 zeta K / omega */
    const double ratios = 4.0 * size * k->ratio_left * beside / sqrt(k->left);
    const double by = size * cabs(find_denominator(g, t, t->work));
    t->open = left / scale;
    t->error = ((scale * left) + ratios) / by;
    return MT_OK;
}

/* The search. */

/* Largest relative error of a kept mode's frequency, up to the square root of lambda. */
static double error_of_modes(const search *k, double lambda)
{
    const mt_modes *const m = &k->l->found.modes;
    double most = 0.0;
    for (int i = k->free; i < m->count && m->lambda[i] <= lambda; i++) {
        most = fmax(most, 0.5 * m->error[i] / m->lambda[i]);
    }
    return most;
}

/* Lists the roots up to oscillating root `count` below the limit. */
static mt_status list_roots(const search *k, int count, mt_arena *mem, galerkin *g, mt_err *err)
{
    const mt_damped_modes *const d = &g->roots;
    g->listed = 0;
    g->oscillating = 0;
    while (g->listed < d->count && g->oscillating < count &&
           !(hypot(d->re[g->listed], d->im[g->listed]) > sqrt(k->left))) {
        g->oscillating += d->kind[g->listed++] == MT_DAMPED_OSCILLATING ? 1 : 0;
    }
    g->error = mt_arena_f64(mem, (size_t)g->listed, 1);
    g->open = mt_arena_f64(mem, (size_t)g->listed, 1);
    return mt_arena_check(mem, err);
}

/* One round: the roots, and the basis extended by the residuals of those that are not rounding,
 * unless it is the last. *worst: the largest `open`. */
static mt_status search_round(search *k, galerkin *g, bool last, double *worst, bool *added,
                              mt_arena *mem, mt_err *err)
{
    const size_t n = (size_t)g->n;
    root t = {.c = mt_arena_f64(mem, n, 1), .work = mt_arena_f64(mem, n, 1)};
    t.v[0] = mt_arena_f64(mem, (size_t)k->n_x, 1);
    t.v[1] = mt_arena_f64(mem, (size_t)k->n_x, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < g->listed; i++) {
        t.s = mt_complex(g->roots.re[i], g->roots.im[i]);
        if (!(cabs(t.s) > 0.0)) {
            continue;
        }
        t.y[0] = g->roots.y_re + ((ptrdiff_t)i * g->n);
        t.y[1] = g->roots.y_im + ((ptrdiff_t)i * g->n);
        MT_TRY(find_residual(k, g, &t, err));
        g->error[i] = t.error;
        g->open[i] = t.open;
        *worst = fmax(*worst, t.open);
        for (int part = 0; part < 2 && !last && t.open > CONVERGED; part++) {
            MT_TRY(extend_basis(k, t.v[part], added, err));
        }
    }
    return MT_OK;
}

/* Rounds until the residuals are rounding; g: the last one's, in mem. */
static mt_status search_roots(search *k, int count, mt_arena *mem, galerkin *g, bool *is,
                              mt_err *err)
{
    double before = HUGE_VAL;
    bool last = false;
    for (int round = 0;; round++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        double worst = 0.0;
        bool added = false;
        MT_TRY(mt_interrupt_check(k->l->sys->run->interrupt, err));
        MT_TRY(solve_galerkin(k, mem, g, is, err));
        if (!*is) {
            return MT_OK;
        }
        MT_TRY(list_roots(k, count, mem, g, err));
        MT_TRY(search_round(k, g, last, &worst, &added, mem, err));
        if (!added) {
            return MT_OK;
        }
        /* the rounding of the products is reached, or there is no more room */
        last = round + 1 >= MOST_EXTENSIONS || k->size + 2 > k->most ||
               (round > 3 && !(worst < 0.9 * before));
        before = worst;
        mt_arena_rewind(mem, mark);
    }
}

static mt_status open_search(search *k, int count, bool *is, mt_err *err)
{
    const mt_lowest_modes *const found = &k->l->found;
    const mt_modes *const m = &found->modes;
    k->n_x = mt_lowest_coordinates(k->l);
    k->free = mt_lowest_free(k->l);
    k->shift = mt_lowest_shift(k->l);
    k->kept = m->count - k->free;
    for (int i = m->n_rigid; i < m->count && *is; i++) {
        *is = m->kind[i] == MT_MODE_FLEXIBLE ||
              refuse_damped(k, "a motion without stiffness is none of its rigid-body modes");
    }
    if (!*is || k->kept < 1) {
        *is = *is && refuse_damped(k, "it has no vibration modes");
        return MT_OK;
    }
    k->left = k->kept == m->all - k->free ? HUGE_VAL
              : found->below > m->count   ? m->lambda[m->count - 1]
                                          : found->tau;
    k->most = k->kept + (SHAPES_EACH * count) + SHAPES_BESIDES;
    const size_t n = (size_t)k->n_x;
    const size_t free = (size_t)k->free;
    const size_t all = (size_t)k->most + free;
    const size_t nq = (size_t)k->l->sys->nq;
    k->x = mt_arena_f64(k->mem, n, (size_t)k->most);
    k->m = mt_arena_f64(k->mem, all, all);
    k->c = mt_arena_f64(k->mem, all, all);
    k->h = mt_arena_f64(k->mem, all, all);
    coordinates *const of[] = {&k->q, &k->f, &k->g};
    for (int i = 0; i < MT_COUNT(of); i++) {
        of[i]->x = mt_arena_f64(k->mem, n, 1);
        of[i]->a = mt_arena_f64(k->mem, free, 1);
    }
    mt_lowest_push_init(k->l, k->mem, &k->push);
    k->states = mt_arena_f64(k->mem, nq, 1);
    k->force = mt_arena_f64(k->mem, nq, 1);
    k->v = mt_arena_f64(
        k->mem, k->l->way == MT_LOWEST_TREE ? (size_t)k->l->tree->n * (size_t)k->l->tree->s : n,
        1);
    k->r = mt_arena_f64(k->mem, free, 1);
    return mt_arena_check(k->mem, err);
}

/* The listed roots, in mem. */
static mt_status write_roots(const search *k, const galerkin *g, mt_arena *mem,
                             mt_lowest_damped *out, mt_err *err)
{
    const mt_damped_modes *const from = &g->roots;
    const double rounding = DBL_EPSILON * k->l->found.modes.n;
    const size_t n = (size_t)g->listed;
    mt_damped_modes *const to = &out->modes;
    *to = (mt_damped_modes){.n = k->l->found.modes.n,
                            .count = g->listed,
                            .kind = mt_arena_alloc(mem, n, sizeof *to->kind),
                            .re = mt_arena_f64(mem, n, 1),
                            .im = mt_arena_f64(mem, n, 1),
                            .residual = mt_arena_f64(mem, n, 1)};
    out->error = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < g->listed; i++) {
        const double size = hypot(from->re[i], from->im[i]);
        to->kind[i] = from->kind[i];
        to->re[i] = from->re[i];
        to->im[i] = from->im[i];
        to->residual[i] = fmax(from->residual[i], g->open[i] / rounding);
        out->error[i] = size > 0.0 ? g->error[i] + error_of_modes(k, size * size) : 0.0;
    }
    return MT_OK;
}

static mt_status find_damped(search *k, int count, mt_arena *mem, mt_lowest_damped *out,
                             bool *is, mt_err *err)
{
    galerkin g = {.n = 0};
    MT_TRY(open_search(k, count, is, err));
    MT_TRY(*is ? read_damping(k, is, err) : MT_OK);
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(begin_basis(k, err));
    MT_TRY(search_roots(k, count, k->mem, &g, is, err));
    if (!*is) {
        return MT_OK;
    }
    MT_TRY(write_roots(k, &g, mem, out, err));
    for (int i = 0; i < g.listed && *is; i++) {
        *is = out->error[i] <= MOST_ERROR ||
              refuse_damped(k, "its damped motions are not resolved from its lowest modes");
    }
    out->shapes = g.size - k->kept;
    out->limit = sqrt(k->left);
    out->enough = g.oscillating == count || k->left == HUGE_VAL;
    return MT_OK;
}

mt_status mt_lowest_damped_modes(mt_lowest *l, int count, mt_arena *mem, mt_lowest_damped *out,
                                 bool *is, char why[MT_LOWEST_DAMPED_WHY], mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    *out = (mt_lowest_damped){.shapes = 0};
    why[0] = '\0';
    MT_TRY(mt_lowest_open_forced(l, is, err));
    if (!*is) {
        (void)mt_snprintf(why, MT_LOWEST_DAMPED_WHY,
                          "sixteen digits do not resolve its motions");
        return MT_OK;
    }
    mt_status rc = mt_arena_init(&scratch, 0, err);
    search k = {.l = l, .mem = &scratch, .why = why};
    rc = rc == MT_OK ? find_damped(&k, count, mem, out, is, err) : rc;
    mt_arena_free(&scratch);
    return rc;
}
