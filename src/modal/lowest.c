/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "modal/lowest.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/lanczos.h"
#include "modal/modes.h"

/* More are sought than are wanted: one for the gap behind the last, one if that is small. */
enum { MORE = 2, ROUNDS = 12 };
/* Motions of a free body, besides, where a shift holds them. */
enum { FREE_BODY = 6 };
/* Equal frequencies, as of many arms on one hub, are all found, but no more than that. */
enum { MOST_FOUND = 512 };

/* Neighbours closer than this (relative) are not separated by a count. */
static const double NO_GAP = 1e-7;
/* A residual, in what it is the residual of, that says nothing of a frequency (its square does)
 * but is seen in slopes. */
static const double ROUGH = 1e-10;

typedef struct finding {
    const mt_lowest_problem *p;
    int n;                   /* found */
    int most;                /* room */
    bool exhausted;          /* there are no more: all other directions have no mass */
    double *x;               /* p->n x most */
    double *ax;              /* A x */
    double *theta;           /* [most] Rayleigh quotients x^T A x, descending */
    double *rho;             /* [most] ||A x - theta x|| */
    mt_lowest_quotient *own; /* [most] */
    int n_free;              /* rigid ones among those found */
    double *mx;              /* [n] M x; NULL: M is the identity */
    double *difference;      /* [n] then */
} finding;

static double *column(const finding *f, double *of, int i)
{
    return of + ((ptrdiff_t)i * f->p->n);
}

static void swap_columns(const finding *f, double *of, int i, int j)
{
    double *const a = column(f, of, i);
    double *const b = column(f, of, j);
    for (int k = 0; k < f->p->n; k++) {
        const double x = a[k];
        a[k] = b[k];
        b[k] = x;
    }
}

/* M x. */
static const double *times_mass(const finding *f, const double *x)
{
    if (f->mx == NULL) {
        return x;
    }
    f->p->metric(f->p->context, x, f->mx);
    return f->mx;
}

/* x^T M y. */
static double inner(const finding *f, const double *x, const double *y)
{
    return mt_dot(f->p->n, times_mass(f, x), y);
}

static void swap_vectors(const finding *f, int i, int j)
{
    const double theta = f->theta[i];
    const double rho = f->rho[i];
    f->theta[i] = f->theta[j];
    f->theta[j] = theta;
    f->rho[i] = f->rho[j];
    f->rho[j] = rho;
    const mt_lowest_quotient own = f->own[i];
    f->own[i] = f->own[j];
    f->own[j] = own;
    swap_columns(f, f->x, i, j);
    swap_columns(f, f->ax, i, j);
}

/* Room for n in all. */
static mt_status grow(finding *f, int n, mt_arena *mem, mt_err *err)
{
    const finding old = *f;
    const size_t found = (size_t)f->n;
    const size_t size = (size_t)f->p->n * found;
    f->most = n;
    f->x = mt_arena_f64(mem, (size_t)f->p->n, (size_t)n);
    f->ax = mt_arena_f64(mem, (size_t)f->p->n, (size_t)n);
    f->theta = mt_arena_f64(mem, (size_t)n, 1);
    f->rho = mt_arena_f64(mem, (size_t)n, 1);
    f->own = mt_arena_alloc(mem, (size_t)n, sizeof *f->own);
    MT_TRY(mt_arena_check(mem, err));
    if (found > 0) {
        memcpy(f->x, old.x, size * sizeof *f->x);
        memcpy(f->ax, old.ax, size * sizeof *f->ax);
        memcpy(f->theta, old.theta, found * sizeof *f->theta);
        memcpy(f->rho, old.rho, found * sizeof *f->rho);
        memcpy(f->own, old.own, found * sizeof *f->own);
    }
    return MT_OK;
}

/* Quotient and residual of vector i. */
static void set_quotient(finding *f, int i)
{
    const mt_lowest_problem *const p = f->p;
    const double *const x = column(f, f->x, i);
    const double *const ax = column(f, f->ax, i);
    const double square = inner(f, x, x);
    f->theta[i] = inner(f, x, ax) / square;
    double rest = 0.0;
    if (f->mx == NULL) {
        for (int k = 0; k < p->n; k++) {
            const double r = ax[k] - (f->theta[i] * x[k]);
            rest += r * r;
        }
    } else {
        for (int k = 0; k < p->n; k++) {
            f->difference[k] = ax[k] - (f->theta[i] * x[k]);
        }
        rest = fmax(inner(f, f->difference, f->difference), 0.0);
    }
    f->rho[i] = sqrt(rest / square);
    f->n_free += f->own[i].rigid ? 1 : 0;
}

/* Compute the images and quotients of `count` vectors from the first on. */
static mt_status compute_quotients(finding *f, int first, int count, mt_err *err)
{
    const mt_lowest_problem *const p = f->p;
    MT_TRY(p->refine(p->context, count, column(f, f->x, first), column(f, f->ax, first),
                     f->own + first, err));
    for (int i = first; i < first + count; i++) {
        set_quotient(f, i);
    }
    return MT_OK;
}

/* Search `more` modes in the complement of those found. The iteration's basis is as large as
 * many vectors; it is given back before the vectors are refined. */
static mt_status search_complement(finding *f, int more, int round, mt_err *err)
{
    mt_arena basis = {.first = NULL};
    const mt_lowest_problem *const p = f->p;
    const int room = (p->most < f->most ? p->most : f->most) - f->n;
    const int wanted = more < room ? more : room;
    const mt_lanczos lanczos = {.n = p->n,
                                .wanted = wanted,
                                .block = p->block,
                                .seed = round,
                                .apply = p->apply,
                                .metric = p->metric,
                                .context = p->context,
                                .n_locked = f->n,
                                .locked = f->x};
    int got = 0;
    MT_TRY(mt_arena_init(&basis, 0, err));
    const mt_status rc = mt_lanczos_largest(&lanczos, &basis, column(f, f->x, f->n), &got, err);
    mt_arena_free(&basis);
    MT_TRY(rc);
    f->exhausted = got < wanted || f->n + got == p->most;
    MT_TRY(compute_quotients(f, f->n, got, err));
    for (int i = f->n; i < f->n + got; i++) {
        for (int at = i; at > 0 && f->theta[at] > f->theta[at - 1]; at--) {
            swap_vectors(f, at, at - 1);
        }
    }
    f->n += got;
    return MT_OK;
}

/* Number of modes to count behind: at least the wanted ones, with the widest gap; -1: no
 * gap. */
static int find_widest_gap(const finding *f)
{
    const int wanted = f->p->count + f->n_free;
    const int least = f->n < wanted ? f->n : wanted;
    int best = f->exhausted ? f->n : -1;
    double widest = f->exhausted ? HUGE_VAL : 1.0 + NO_GAP;
    for (int j = least; j < f->n && j > 0; j++) {
        const double gap = f->theta[j - 1] / f->theta[j];
        if (gap > widest) {
            widest = gap;
            best = j;
        }
    }
    return best;
}

/* Count the modes below a frequency behind mode j; where a pivot is uncertain, try other
 * frequencies in the gap. */
static mt_status count_behind(const finding *f, int j, double *tau, int *below, bool *certain,
                              mt_err *err)
{
    static const double places[] = {0.5, 0.37, 0.66, 0.21,
                                    0.84}; /* of the gap, in logarithms */
    *certain = false;
    for (int k = 0; k < MT_COUNT(places) && !*certain; k++) {
        const double end = j < f->n ? f->theta[j] : 0.25 * f->theta[j - 1];
        *tau = (pow(f->theta[j - 1] / end, places[k]) / f->theta[j - 1]) - f->p->shift;
        MT_TRY(f->p->below(f->p->context, *tau, f->p->n_rigid + j, below, certain, err));
    }
    return MT_OK;
}

/* Search until the count confirms that no mode below *tau is missing; *upto: number of modes
 * found below. */
static mt_status find_counted_modes(finding *f, mt_arena *mem, double *tau, int *upto,
                                    mt_err *err)
{
    const mt_lowest_problem *const p = f->p;
    int more = f->most;
    for (int round = 0; round < ROUNDS && p->most > 0; round++) {
        MT_TRY(search_complement(f, more, round, err));
        const int j = find_widest_gap(f);
        more = f->n > MORE ? f->n : MORE; /* no end of equal ones is in sight */
        if (j > 0) {
            int below = 0;
            bool certain = false;
            MT_TRY(count_behind(f, j, tau, &below, &certain, err));
            const int missing = below - p->n_rigid - j;
            if (certain && missing == 0) {
                *upto = j;
                return MT_OK;
            }
            more = certain && missing > 0 ? missing + 1 : MORE;
        } else if (f->exhausted && f->n == 0) {
            *upto = 0;
            return MT_OK;
        }
        if (f->n == p->most || f->n + more > MOST_FOUND + (2 * p->count)) {
            break;
        }
        if (f->n + more > f->most) {
            MT_TRY(grow(f, f->n + more, mem, err));
        }
    }
    *upto = 0;
    return p->most == 0
               ? MT_OK
               : mt_fail(err, MT_E_NO_CONVERGENCE,
                         "the count of modes below %g rad^2/s^2 does not agree with those "
                         "that were found",
                         *tau);
}

/* True where the intervals of k and k + 1 are disjoint. */
static bool apart(const finding *f, int k)
{
    return f->theta[k] - f->rho[k] > f->theta[k + 1] + f->rho[k + 1];
}

/* Error of theta: Kato and Temple where the neighbours are far enough. Of several that are not
 * apart, as many eigenvalues lie within the norm of all their residuals (Kahan; Parlett, The
 * Symmetric Eigenvalue Problem, theorem 11-5-1). */
static double theta_error(const finding *f, int i, int upto, double tau)
{
    int first = i;
    int last = i;
    while (first > 0 && !apart(f, first - 1)) {
        first--;
    }
    while (last + 1 < upto && !apart(f, last)) {
        last++;
    }
    const double rho = mt_norm2(last + 1 - first, f->rho + first);
    const double above =
        first > 0 ? f->theta[first - 1] - f->rho[first - 1] - f->theta[i] : HUGE_VAL;
    const double next = last + 1 < upto ? f->theta[last + 1] + f->rho[last + 1] : 1.0 / tau;
    const double gap = fmin(above, f->theta[i] - next);
    return first == last && gap > rho ? rho * (rho / gap) : rho;
}

/* Error of lambda: of theta, of how x and its image differ, and of rounding. */
static double lambda_error(const finding *f, int i, int upto, double tau)
{
    const mt_lowest_quotient *const own = &f->own[i];
    const double shifted = own->lambda + f->p->shift;
    const double relative =
        fmin((theta_error(f, i, upto, tau) / f->theta[i]) + fabs((f->theta[i] * shifted) - 1.0),
             0.5);
    return (shifted * relative / (1.0 - relative)) +
           (fabs(own->lambda) * fmin(own->noise, 1.0));
}

/* Rigid-body modes come first: those that are known, then those that were found. */
static void write_found_modes(const finding *f, int upto, double tau, mt_lowest_modes *out)
{
    const mt_lowest_problem *const p = f->p;
    mt_modes *const m = &out->modes;
    int at = p->n_rigid;
    m->scale = f->n > 0 ? 1.0 / f->theta[0] : 0.0;
    for (int i = 0; i < p->n_rigid; i++) {
        m->kind[i] = MT_MODE_RIGID_BODY;
    }
    for (int i = 0; at < m->count; i++, at++) {
        const mt_lowest_quotient *const own = &f->own[i];
        const double unit = ((double)p->n * DBL_EPSILON) + fmin(own->noise, 1.0);
        m->residual[at] = f->rho[i] / ((f->theta[0] + f->theta[i]) * unit);
        for (int j = 0; j < m->count - p->n_rigid; j++) {
            const double gram = inner(f, column(f, f->x, i), column(f, f->ax, j)) /
                                sqrt(f->theta[i] * f->theta[j]);
            m->orthogonality[at] =
                fmax(m->orthogonality[at], fabs(gram - (i == j ? 1.0 : 0.0)) / unit);
        }
        m->kind[at] = own->rigid ? MT_MODE_RIGID_BODY : MT_MODE_FLEXIBLE;
        memcpy(column(f, out->x, i), column(f, f->x, i), (size_t)p->n * sizeof *out->x);
        if (own->rigid) {
            m->n_rigid++;
            continue;
        }
        m->error_relative = fmax(m->error_relative, own->noise);
        m->lambda[at] = own->lambda;
        m->error[at] = lambda_error(f, i, upto, tau);
    }
    mt_modal_find_clusters(m);
}

/* Number of counted modes to return: those wanted and the free ones, and the repetitions of the
 * last. */
static int whole(const finding *f, int upto)
{
    const int wanted = f->p->count + f->n_free;
    int n = upto < wanted ? upto : wanted;
    while (n > 0 && n < upto && f->theta[n - 1] <= (1.0 + NO_GAP) * f->theta[n]) {
        n++;
    }
    return n;
}

/* Replace the first n vectors by their images, orthonormal: these have no components without
 * mass, which the metric does not see. */
static void purify(const finding *f, int n, double *x)
{
    for (int i = 0; i < n; i++) {
        double *const to = column(f, x, i);
        memcpy(to, column(f, f->ax, i), (size_t)f->p->n * sizeof *to);
        const double *const weighed = times_mass(f, to);
        for (int j = 0; j < i; j++) {
            const double *const softer = column(f, x, j);
            mt_axpy(f->p->n, -mt_dot(f->p->n, weighed, softer), softer, to);
        }
        const double size = sqrt(inner(f, to, to));
        for (int k = 0; k < f->p->n; k++) {
            to[k] /= size;
        }
    }
}

static bool rough(const finding *f, int n)
{
    bool is = false;
    for (int i = 0; i < n; i++) {
        is = is || (!f->own[i].rigid && !(f->rho[i] <= ROUGH * f->theta[i]));
    }
    return is;
}

/* Replace all vectors found by Ritz vectors, and compute the first n again. Residuals of the
 * others come from the method's vectors without mass, in which rounding is as large as they
 * are. */
static mt_status replace_by_ritz_vectors(finding *f, int n, mt_arena *scratch, mt_err *err)
{
    const ptrdiff_t found = f->n;
    double *const h = mt_arena_f64(scratch, (size_t)found, (size_t)found);
    double *const theta = mt_arena_f64(scratch, (size_t)found, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (ptrdiff_t i = 0; i < found; i++) {
        const double *const weighed = times_mass(f, column(f, f->ax, (int)i));
        for (ptrdiff_t k = 0; k <= i; k++) { /* the smaller image: its rounding is smaller */
            h[i + (found * k)] = mt_dot(f->p->n, weighed, column(f, f->x, (int)k));
        }
    }
    const mt_status rc = mt_eig_graded(f->n, h, theta, scratch, err);
    if (rc == MT_E_NOT_SPD) {
        return MT_OK; /* the last ones are rounding */
    }
    MT_TRY(rc);
    mt_turn_columns(f->p->n, f->n, f->n, h, found, f->x, theta);
    mt_turn_columns(f->p->n, f->n, f->n, h, found, f->ax, theta);
    f->n_free = 0;
    return compute_quotients(f, 0, n, err);
}

static mt_status answer(const mt_lowest_problem *p, mt_arena *scratch, mt_arena *mem,
                        mt_lowest_modes *out, mt_err *err)
{
    finding f = {.p = p, .most = (p->count < p->most ? p->count : p->most) + MORE};
    mt_modes *const m = &out->modes;
    int upto = 0;
    f.most += p->shift > 0.0 ? FREE_BODY : 0;
    if (p->metric != NULL) {
        f.mx = mt_arena_f64(scratch, (size_t)p->n, 1);
        f.difference = mt_arena_f64(scratch, (size_t)p->n, 1);
    }
    MT_TRY(grow(&f, f.most, scratch, err));
    MT_TRY(find_counted_modes(&f, scratch, &out->tau, &upto, err));
    const int few = whole(&f, upto);
    if (p->shapes && rough(&f, few)) {
        MT_TRY(replace_by_ritz_vectors(&f, few, scratch, err));
    }
    const size_t n = (size_t)few;
    const size_t most = n + (size_t)p->n_rigid;
    *m = (mt_modes){.n = p->most + p->n_rigid, .n_rigid = p->n_rigid, .count = (int)most};
    m->lambda = mt_arena_f64(mem, most, 1);
    m->kind = mt_arena_alloc(mem, most, sizeof *m->kind);
    m->cluster = mt_arena_int(mem, most);
    m->residual = mt_arena_f64(mem, most, 1);
    m->orthogonality = mt_arena_f64(mem, most, 1);
    m->error = mt_arena_f64(mem, most, 1);
    out->x = mt_arena_f64(mem, (size_t)p->n, n);
    out->below = p->n_rigid + upto;
    m->all = p->n_rigid + p->most;
    MT_TRY(mt_arena_check(mem, err));
    write_found_modes(&f, upto, out->tau + p->shift, out);
    if (p->shapes && p->metric != NULL) {
        purify(&f, few, out->x);
    }
    return MT_OK;
}

mt_status mt_modal_lowest(const mt_lowest_problem *p, mt_arena *mem, mt_lowest_modes *out,
                          mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    *out = (mt_lowest_modes){.below = 0};
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? answer(p, &scratch, mem, out, err) : rc;
    mt_arena_free(&scratch);
    return rc;
}
