/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One matrix is factored, H = K + s M + A^T Gamma A, Gamma = diag(gamma): that is what becomes
 * of [K + s M, A^T; A, -Gamma^-1] when its last rows are eliminated, and the iteration
 *     dx = H^-1 (f - (K + s M) x - A^T mu - A^T Gamma A x),   dmu = Gamma A (x + dx)
 * solves (K + s M) x + A^T mu = f, A x = 0 (augmented Lagrangian; Hestenes 1969). It refines
 * what rounding did to the factor as well. Rows of A that depend on others change nothing.
 *     Residuals are taken from strains: K x = sum k b (b^T x). A strain's rounding is delta =
 * eps |b|^T |x|, and as b^T H^-1 b <= 1/k, what all of them make of the energy's norm of x is
 * at most N = (sum k delta^2)^(1/2): with E = x^T K x the quotient is off by 2 N E^(-1/2). That
 * is the whole of the condition of K as it is felt by one mode.
 *     H - (tau + s) M has no fewer negative eigenvalues than there are modes below tau: if it
 * has as many as were found, none is missing.
 */
#include "modal/sparse_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"

/* gamma over the largest stiffness: a constraint's own flexibility is gone after two or three
 * iterations (of loops of thousands with the second), and eps gamma cond K is well below 1. The
 * third is for what is so much larger than its parts that stiffnesses against turns, over the
 * square of the whole length, are nothing: a ring of 20,000 hinged bars. */
static const double STIFFER[] = {1e6, 1e8, 1e12};
enum { OF_LOADED = 2 /* of them, where gamma may have to outweigh G */ };
/* The same of a count that says more than was found, in that. */
static const double COUNTED[] = {1e3, 1e6};
/* Below this the factor's rounding is refined away in each product. */
static const double WELL = 1e-7;
/* The first shift, in the largest K_ii/M_ii; and the least and most that it should be of the
 * lowest mode: far above it the modes stand close together in what is iterated, and below it a
 * rigid-body mode's rounding there is large against all that the others are. */
static const double FIRST_SHIFT = 1e-8;
static const double MOST_SHIFT = 100.0;
static const double LEAST_SHIFT = 0.25;
/* Tries of a first shift, and of a better one. */
enum { SHIFTS = 2, ROUNDS = 4 };
/* Columns of Lanczos' method at a time. */
enum { BLOCK = 4 };
/* Roundings of a strain, and strains so many times their rounding that are none. */
static const double STRAIN_ULPS = 4.0;
static const double RIGID = 1e3;
/* Of everything else in a quotient. */
static const double OTHER_ULPS = 64.0;

static mt_status apply_inverse_iteration(void *context, int count, const double *x, double *y,
                                         mt_err *err)
{
    mt_sparse *const s = context;
    const ptrdiff_t n = s->p->n;
    double *const to = s->refined ? s->f : y;
    for (int c = 0; c < count; c++) {
        mt_sparse_metric(s, x + (n * c), to + (n * c));
    }
    if (s->refined) {
        return mt_sparse_solve(s, count, s->f, MT_SPARSE_SOLVED, y, err);
    }
    MT_TRY(s->p->check != NULL ? s->p->check(s->p->context, err) : MT_OK);
    MT_TRY(mt_sparse_hold(s, err));
    mt_factor_solve(&s->factor, count, y);
    return MT_OK;
}

double mt_sparse_energy(const mt_squares *of, const double *x, double *noise)
{
    double sum = 0.0;
    *noise = 0.0;
    for (int r = 0; r < of->row.n_rows; r++) {
        double size = 0.0;
        const double here = mt_rows_dot_size(&of->row, r, x, &size);
        const double delta = STRAIN_ULPS * DBL_EPSILON * size;
        sum += of->c[r] * here * here;
        *noise += fabs(of->c[r]) * delta * delta;
    }
    return sum;
}

/* *k += x^T G x, *noise += its rounding. */
static void add_load(const mt_sparse_problem *p, const double *x, double *k, double *noise)
{
    for (int j = 0; p->g != NULL && j < p->n; j++) {
        for (int i = p->g->start[j]; i < p->g->start[j + 1]; i++) {
            const double twice = p->g->row[i] == j ? 1.0 : 2.0;
            const double part = twice * p->g->value[i] * x[j] * x[p->g->row[i]];
            *k += part;
            *noise += STRAIN_ULPS * DBL_EPSILON * fabs(part);
            *noise += twice * p->g_noise[i] * fabs(x[j] * x[p->g->row[i]]);
        }
    }
}

double mt_sparse_load_noise(const mt_sparse *s, const double *x)
{
    double k = 0.0;
    double noise = 0.0;
    add_load(s->p, x, &k, &noise);
    return noise;
}

/* The quotient of y, whose constraints' forces are mu. */
static void quotient_of_vector(const mt_sparse *s, const double *y, const double *mu,
                               mt_lowest_quotient *q)
{
    const mt_sparse_problem *const p = s->p;
    double k_noise = 0.0;
    double m_noise = 0.0;
    double k = mt_sparse_energy(&p->k, y, &k_noise);
    const double m = mt_sparse_energy(&p->m, y, &m_noise);
    double other = 0.0;
    add_load(p, y, &k, &other);
    /* what y leaves open of the constraints, their forces pay for */
    for (int r = 0; r < p->a.n_rows; r++) {
        double size = 0.0;
        const double gap = mt_rows_dot_size(&p->a, r, y, &size);
        k += 2.0 * mu[r] * gap;
        other += 2.0 * fabs(mu[r]) * STRAIN_ULPS * DBL_EPSILON * size;
    }
    q->lambda = k / m;
    q->rigid = fabs(k) <= RIGID * ((RIGID * k_noise) + other) ||
               fabs(q->lambda) <= DBL_EPSILON * s->shift;
    const double size = fmax(fabs(k), DBL_MIN);
    q->noise = (2.0 * sqrt(k_noise / size)) + ((k_noise + other) / size) +
               (2.0 * sqrt(m_noise / m)) + (OTHER_ULPS * DBL_EPSILON);
}

/* Columns from first on that are solved for together. */
static int some(int first, int count)
{
    return count - first < MT_SPARSE_COLUMNS ? count - first : MT_SPARSE_COLUMNS;
}

static mt_status refine_vectors(void *context, int count, const double *x, double *y,
                                mt_lowest_quotient *q, mt_err *err)
{
    mt_sparse *const s = context;
    const ptrdiff_t n = s->p->n;
    const ptrdiff_t rows = s->p->a.n_rows;
    for (int first = 0; first < count; first += MT_SPARSE_COLUMNS) {
        const int here = some(first, count);
        double *const to = y + (n * first);
        for (int c = 0; c < here; c++) {
            mt_sparse_metric(s, x + (n * (first + c)), s->f + (n * c));
        }
        MT_TRY(mt_sparse_solve(s, here, s->f, MT_SPARSE_SOLVED, to, err));
        for (int c = 0; c < here; c++) {
            quotient_of_vector(s, to + (n * c), s->mu + (rows * c), q + first + c);
        }
    }
    return MT_OK;
}

/* Every count is a bound from above: a chain of many bodies has modes of its constraints' own
 * flexibility, which are gone where these are stiffer. */
static mt_status count_modes_below(void *context, double tau, int known, int *n, bool *certain,
                                   mt_err *err)
{
    mt_sparse *const s = context;
    double least = 0.0;
    *certain = false;
    for (int i = 0; i <= MT_COUNT(COUNTED) && !(*certain && *n <= known); i++) {
        int here = 0;
        if (i > 0 && s->p->a.n_rows == 0) {
            break;
        }
        MT_TRY(s->p->check != NULL ? s->p->check(s->p->context, err) : MT_OK);
        MT_TRY(mt_sparse_inertia(s, i == 0 ? 1.0 : COUNTED[i - 1], -tau, &here, &least, err));
        if (least > MT_SPARSE_CERTAIN && (!*certain || here < *n)) {
            *n = here;
            *certain = true;
        }
    }
    return MT_OK;
}

/* The largest K_ii/M_ii. */
static double highest(const mt_sparse *s)
{
    double most = 0.0;
    for (int j = 0; j < s->p->n; j++) {
        const double m = s->m.value[s->m.start[j]];
        most = m > 0.0 ? fmax(most, s->x[j] / m) : most;
    }
    return most;
}

/* H, with a shift where K alone may be singular. */
static mt_status factor_stiffness(mt_sparse *s, bool *held, char *why, mt_err *err)
{
    double shift = FIRST_SHIFT * highest(s);
    *held = s->stiffest > 0.0;
    if (!*held) {
        (void)mt_snprintf(why, MT_SPARSE_WHY, "nothing in it has a stiffness");
        return MT_OK;
    }
    MT_TRY(mt_sparse_freedoms(s, err));
    MT_TRY(mt_sparse_factor(s, 0.0, held, err));
    for (int i = 0; i < SHIFTS && !*held && shift > 0.0; i++) {
        MT_TRY(mt_sparse_factor(s, shift, held, err));
        shift *= 100.0;
    }
    if (!*held) {
        (void)mt_snprintf(why, MT_SPARSE_WHY,
                          "a motion without stiffness has no mass, the mechanism is unstable, "
                          "or sixteen digits do not resolve all of its motions");
    }
    return MT_OK;
}

/* lambda of the lowest mode that is not a rigid-body mode, negative where it is unstable (it
 * comes before the rigid-body ones, in the order of 1/(lambda + s)); 0: none. */
static double lowest_lambda(const mt_modes *m)
{
    double lowest = HUGE_VAL;
    for (int i = 0; i < m->count; i++) {
        lowest = m->kind[i] == MT_MODE_FLEXIBLE ? fmin(lowest, m->lambda[i]) : lowest;
    }
    return lowest < HUGE_VAL ? lowest : 0.0;
}

static mt_status find_sparse_modes(mt_sparse *s, mt_arena *mem, mt_lowest_modes *out,
                                   bool *stable, mt_err *err)
{
    const mt_sparse_problem *const p = s->p;
    for (int round = 0;; round++) {
        const mt_arena_mark mark = mt_arena_get_mark(mem);
        const mt_lowest_problem problem = {.n = p->n,
                                           .most = s->freedoms,
                                           .count = p->count,
                                           .block = BLOCK,
                                           .shift = s->shift,
                                           .shapes = p->shapes,
                                           .apply = apply_inverse_iteration,
                                           .metric = mt_sparse_metric,
                                           .refine = refine_vectors,
                                           .below = count_modes_below,
                                           .context = s};
        s->refined = p->a.n_rows > 0 || s->least < WELL;
        MT_TRY(mt_modal_lowest(&problem, mem, out, err));
        const double first = lowest_lambda(&out->modes);
        *stable = first >= 0.0;
        const bool apart = s->shift > MOST_SHIFT * first || s->shift < LEAST_SHIFT * first;
        if (round == ROUNDS || s->shift == 0.0 || !(first > 0.0 && apart)) {
            return MT_OK;
        }
        const double was = s->shift;
        bool sound = false;
        MT_TRY(mt_sparse_factor(s, first, &sound, err));
        if (!sound) {
            return mt_sparse_factor(s, was, &sound, err);
        }
        mt_arena_rewind(mem, mark);
    }
}

/* y := y - X X^T M y with the first i columns, and its forces nu with theirs (rigid-body modes
 * have none): inverse iteration has made the rounding of M y larger by the quotient of their
 * eigenvalues. */
static void clear_of_softer(mt_sparse *s, int i, const double *x, const double *forces,
                            double *y, double *nu)
{
    const int n = s->p->n;
    const int rows = s->p->a.n_rows;
    mt_sparse_metric(s, y, s->f);
    for (int j = 0; j < i; j++) {
        const double *const softer = x + ((ptrdiff_t)n * j);
        const double part = -mt_dot(n, softer, s->f);
        mt_axpy(n, part, softer, y);
        mt_axpy(rows, part, forces + ((ptrdiff_t)rows * j), nu);
    }
}

/* One more step of inverse iteration, (K + s M) Y + A^T N = M X, and among the vibration modes
 * the Ritz vectors: of X^T M Y, X being orthonormal. x := y, mu := nu, both over the size of
 * y. */
static mt_status refine_shapes(mt_sparse *s, mt_arena *mem, const mt_lowest_modes *out,
                               double **mu, mt_err *err)
{
    const int n = s->p->n;
    const int rows = s->p->a.n_rows;
    const int first = out->modes.n_rigid;
    const int count = out->modes.count - first;
    double *const x = out->x + ((ptrdiff_t)n * first);
    double *const y = mt_arena_f64(s->mem, (size_t)n, (size_t)count);
    double *const h = mt_arena_f64(s->mem, (size_t)count, (size_t)count);
    double *const theta = mt_arena_f64(s->mem, (size_t)count, 1);
    *mu = mt_arena_f64(mem, (size_t)rows, (size_t)out->modes.count);
    double *const force = *mu + ((ptrdiff_t)rows * first);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_arena_check(s->mem, err));
    for (int i = 0; i < count; i += MT_SPARSE_COLUMNS) {
        const int here = some(i, count);
        for (int c = 0; c < here; c++) {
            mt_sparse_metric(s, x + ((ptrdiff_t)n * (i + c)), s->f + ((ptrdiff_t)n * c));
        }
        MT_TRY(mt_sparse_solve(s, here, s->f, MT_SPARSE_SOLVED, y + ((ptrdiff_t)n * i), err));
        memcpy(force + ((ptrdiff_t)rows * i), s->mu,
               (size_t)rows * (size_t)here * sizeof *force);
    }
    for (int i = 0; i < count; i++) {
        mt_sparse_metric(s, y + ((ptrdiff_t)n * i), s->f);
        for (int k = 0; k <= i; k++) { /* the smaller image: its rounding is the smaller one */
            h[i + ((ptrdiff_t)count * k)] = mt_dot(n, x + ((ptrdiff_t)n * k), s->f);
        }
    }
    MT_TRY(mt_eig_graded(count, h, theta, s->mem, err));
    mt_turn_columns(n, count, count, h, count, y, theta);
    mt_turn_columns(rows, count, count, h, count, force, theta);
    for (int i = 0; i < count; i++) {
        double *const to = y + ((ptrdiff_t)n * i);
        double *const nu = force + ((ptrdiff_t)rows * i);
        clear_of_softer(s, first + i, out->x, *mu, to, nu);
        mt_sparse_metric(s, to, s->f);
        const double size = sqrt(mt_dot(n, to, s->f));
        for (int j = 0; j < n; j++) {
            x[j + ((ptrdiff_t)n * i)] = to[j] / size;
        }
        for (int j = 0; j < rows; j++) {
            nu[j] /= size;
        }
    }
    return MT_OK;
}

/* Without constraints, or stiffnesses, all of STIFFER are one. */
int mt_sparse_tries(const mt_sparse_problem *p)
{
    return p->a.n_rows == 0 ? 1 : p->g == NULL ? MT_COUNT(STIFFER) : 2 * OF_LOADED;
}

mt_sparse mt_sparse_try(const mt_sparse_problem *p, int i, mt_arena *mem)
{
    return (mt_sparse){.p = p,
                       .mem = mem,
                       .stiffer = STIFFER[p->g == NULL ? i : i % OF_LOADED],
                       .outweigh = p->g != NULL && i >= OF_LOADED};
}

mt_status mt_modal_sparse(const mt_sparse_problem *p, mt_arena *mem, mt_lowest_modes *out,
                          double **mu, bool *answered, char why[MT_SPARSE_WHY], mt_err *err)
{
    mt_arena work = {.first = NULL};
    mt_sparse s = {.p = p};
    *answered = false;
    *mu = NULL;
    *out = (mt_lowest_modes){.below = 0};
    mt_status rc = mt_arena_init(&work, 0, err);
    bool more = true;
    for (int i = 0; i < mt_sparse_tries(p) && rc == MT_OK && more; i++) {
        mt_arena_clear(&work);
        s = mt_sparse_try(p, i, &work);
        rc = mt_sparse_prepare(&s, err);
        rc = rc == MT_OK ? factor_stiffness(&s, answered, why, err) : rc;
        more = !*answered && s.stiffest > 0.0;
    }
    if (rc == MT_OK && *answered) {
        rc = find_sparse_modes(&s, mem, out, answered, err);
        if (!*answered) {
            (void)mt_snprintf(why, MT_SPARSE_WHY, "the mechanism is unstable");
        }
        rc = rc == MT_OK && *answered && p->shapes ? refine_shapes(&s, mem, out, mu, err) : rc;
    }
    mt_arena_free(&work);
    return rc;
}
