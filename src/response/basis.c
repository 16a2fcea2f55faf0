/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With X = [Y T] the coordinates that stay and U those that follow at once (modes left out,
 * directions without mass and damping), G = K + i H:
 *     u = G_UU^-1 (U^T f - G_UX q),        x = X q + U u = (X - U W) q + U G_UU^-1 U^T f,
 *         W = G_UU^-1 G_UX,
 *     stiffness of what stays: G_XX - G_XU W,
 * and S U G_UU^-1 U^T B goes into the rest, power by power: with all modes kept it is exact.
 */
#include "response/basis.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/dense.h"
#include "linalg/ldl.h"

/* Roundings per coordinate in an entry Y^T C Y, in terms of its entries' sizes. */
static const double ENTRY_ULPS = 4.0;

typedef struct parts {
    const mt_forced *f;
    mt_arena *mem;
    mt_arena *scratch;
    int n;
    int r;                 /* modes that stay */
    int zd;                /* damped directions without mass */
    int stay;              /* r + zd */
    int u;                 /* what follows at once */
    double *x;             /* n x stay */
    double *follow;        /* n x u */
    double complex *guu;   /* u x u: G_UU */
    mt_complex_ldl factor; /* of guu */
    double complex *w;     /* u x stay */
} parts;

/* out := A^T B C, A n x ra, C n x rc, B symmetric, NULL: 0; an entry that is rounding is 0. */
static mt_status sandwich(parts *s, const double *b, int ra, const double *a, int rc,
                          const double *c, double *out, mt_err *err)
{
    const ptrdiff_t n = s->n;
    memset(out, 0, (size_t)ra * (size_t)rc * sizeof *out);
    if (b == NULL) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(s->scratch);
    double *const bc = mt_arena_f64(s->scratch, (size_t)n, 2);
    MT_TRY(mt_arena_check(s->scratch, err));
    double *const sizes = bc + n;
    for (ptrdiff_t j = 0; j < rc; j++) {
        memset(bc, 0, 2 * (size_t)n * sizeof *bc);
        for (ptrdiff_t k = 0; k < n; k++) {
            const double x = c[k + (j * n)];
            for (ptrdiff_t i = 0; i < n && x != 0.0; i++) {
                bc[i] += b[i + (k * n)] * x;
                sizes[i] += fabs(b[i + (k * n)] * x);
            }
        }
        for (ptrdiff_t i = 0; i < ra; i++) {
            double sum = 0.0;
            double size = 0.0;
            for (ptrdiff_t k = 0; k < n; k++) {
                sum += a[k + (i * n)] * bc[k];
                size += fabs(a[k + (i * n)]) * sizes[k];
            }
            const double noise = ENTRY_ULPS * (double)n * DBL_EPSILON * size;
            out[i + (j * ra)] = fabs(sum) <= noise ? 0.0 : sum;
        }
    }
    mt_arena_rewind(s->scratch, mark);
    return MT_OK;
}

/* Directions without mass: appends undamped ones to `follow`, damped ones to x, each scaled to
 * |k| = 1, with c of the latter diagonal. */
static mt_status split_massless(parts *s, int z, const double *t0, mt_err *err)
{
    const ptrdiff_t n = s->n;
    const double tol = 16.0 * (double)n * DBL_EPSILON;
    double *const t = mt_arena_f64(s->scratch, (size_t)n, (size_t)z);
    double *const c = mt_arena_f64(s->scratch, (size_t)z, (size_t)z);
    double *const mu = mt_arena_f64(s->scratch, (size_t)z, 1);
    MT_TRY(mt_arena_check(s->scratch, err));
    for (ptrdiff_t j = 0; j < z; j++) {
        double own = 0.0;
        MT_TRY(sandwich(s, s->f->k, 1, t0 + (j * n), 1, t0 + (j * n), &own, err));
        mt_axpy(s->n, own != 0.0 ? 1.0 / sqrt(fabs(own)) : 1.0, t0 + (j * n), t + (j * n));
    }
    MT_TRY(sandwich(s, s->f->c, z, t, z, t, c, err));
    MT_TRY(mt_eig_sym(z, c, mu, true, s->scratch, err));
    for (ptrdiff_t j = 0; j < z; j++) {
        const bool damped = mu[j] > tol * mu[z - 1];
        double *const to = damped ? s->x + ((s->stay++) * n) : s->follow + ((s->u++) * n);
        mt_gemv(false, s->n, z, 1.0, t, s->n, c + (j * z), 0.0, to);
        s->zd += damped ? 1 : 0;
    }
    return MT_OK;
}

/* Rigid-body modes are repeated and have no unique basis: in the one that makes their own
 * damping diagonal, undamped ones are visible. */
static mt_status turn_rigid(parts *s, const mt_modes *m, mt_err *err)
{
    const ptrdiff_t n = s->n;
    int first = 0;
    int count = 0;
    while (first < s->r && m->kind[first] != MT_MODE_RIGID_BODY) {
        first++;
    }
    while (first + count < s->r && m->kind[first + count] == MT_MODE_RIGID_BODY) {
        count++;
    }
    if (count == 0 || s->f->c == NULL) {
        return MT_OK;
    }
    double *const c = mt_arena_f64(s->scratch, (size_t)count, (size_t)count);
    double *const mu = mt_arena_f64(s->scratch, (size_t)count, 1);
    double *const row = mt_arena_f64(s->scratch, (size_t)count, 1);
    MT_TRY(mt_arena_check(s->scratch, err));
    double *const y = s->x + (first * n);
    MT_TRY(sandwich(s, s->f->c, count, y, count, y, c, err));
    MT_TRY(mt_eig_sym(count, c, mu, true, s->scratch, err));
    mt_turn_columns(n, count, count, c, count, y, row);
    return MT_OK;
}

static mt_status split_coordinates(parts *s, const mt_basis_problem *p, mt_err *err)
{
    const size_t n = (size_t)s->n;
    const mt_modes *const m = p->modes;
    const int z = s->n - p->mass->rank;
    s->x = mt_arena_f64(s->mem, n, n);
    s->follow = mt_arena_f64(s->mem, n, n);
    MT_TRY(mt_arena_check(s->mem, err));
    s->stay = s->r;
    s->u = m->all - s->r;
    memcpy(s->x, m->y, n * (size_t)s->r * sizeof *s->x);
    memcpy(s->follow, m->y + (n * (size_t)s->r), n * (size_t)s->u * sizeof *s->follow);
    MT_TRY(turn_rigid(s, m, err));
    return z == 0 ? MT_OK
                  : split_massless(s, z, p->mass->t + ((ptrdiff_t)p->mass->rank * s->n), err);
}

/* Eliminates the following coordinates: factor of G_UU, W. */
static mt_status eliminate_following(parts *s, const mt_modes *m, mt_err *err)
{
    const ptrdiff_t u = s->u;
    const ptrdiff_t stay = s->stay;
    const size_t most = (size_t)u * (size_t)(u > stay ? u : stay);
    double *const re = mt_arena_f64(s->scratch, most, 1);
    double *const im = mt_arena_f64(s->scratch, most, 1);
    s->guu = mt_arena_alloc(s->mem, (size_t)(u * u), sizeof *s->guu);
    s->w = mt_arena_alloc(s->mem, (size_t)(u * stay), sizeof *s->w);
    MT_TRY(mt_arena_check(s->scratch, err));
    MT_TRY(mt_arena_check(s->mem, err));
    MT_TRY(sandwich(s, s->f->k, s->u, s->follow, s->u, s->follow, re, err));
    MT_TRY(sandwich(s, s->f->h, s->u, s->follow, s->u, s->follow, im, err));
    for (ptrdiff_t j = 0; j < m->all - s->r; j++) { /* known better than by the matrix */
        for (ptrdiff_t i = 0; i < u; i++) {
            re[i + (j * u)] = i == j ? m->lambda[s->r + j] : 0.0;
            re[j + (i * u)] = re[i + (j * u)];
        }
    }
    for (ptrdiff_t at = 0; at < u * u; at++) {
        s->guu[at] = mt_complex(re[at], im[at]);
    }
    const double norm = mt_complex_norm(s->u, s->guu);
    MT_TRY(mt_complex_factor(s->u, s->guu, s->mem, &s->factor, err));
    double rcond = 0.0;
    MT_TRY(mt_complex_rcond(&s->factor, norm, &rcond, s->scratch, err));
    if (!(rcond > DBL_EPSILON)) {
        return mt_fail(err, MT_E_SINGULAR,
                       "a direction without mass or damping is held by no stiffness");
    }
    MT_TRY(sandwich(s, s->f->k, s->u, s->follow, s->stay, s->x, re, err));
    MT_TRY(sandwich(s, s->f->h, s->u, s->follow, s->stay, s->x, im, err));
    for (ptrdiff_t at = 0; at < u * stay; at++) {
        const bool between = at / u < s->r || at % u < m->all - s->r;
        s->w[at] = mt_complex(between ? 0.0 : re[at], im[at]);
    }
    return MT_OK;
}

/* Stiffness of the kept coordinates, after `eliminate_following`; W is G_UX on entry, and is
 * solved for here. */
static mt_status stiffness(parts *s, const mt_modes *m, double complex *g, mt_err *err)
{
    const ptrdiff_t stay = s->stay;
    const ptrdiff_t u = s->u;
    double *const re = mt_arena_f64(s->scratch, (size_t)(stay * stay), 1);
    double *const im = mt_arena_f64(s->scratch, (size_t)(stay * stay), 1);
    double complex *const gux = mt_arena_alloc(s->scratch, (size_t)(u * stay), sizeof *gux);
    MT_TRY(mt_arena_check(s->scratch, err));
    MT_TRY(sandwich(s, s->f->k, s->stay, s->x, s->stay, s->x, re, err));
    MT_TRY(sandwich(s, s->f->h, s->stay, s->x, s->stay, s->x, im, err));
    memcpy(gux, s->w, (size_t)(u * stay) * sizeof *gux);
    MT_TRY(mt_complex_solve(&s->factor, s->stay, s->w, err));
    for (ptrdiff_t j = 0; j < stay; j++) {
        for (ptrdiff_t i = 0; i < stay; i++) {
            const ptrdiff_t at = i + (j * stay);
            const bool mode = i < s->r || j < s->r;
            const double k = mode ? (i == j ? m->lambda[i] : 0.0) : re[at];
            g[at] = mt_complex(k, im[at]);
            for (ptrdiff_t a = 0; a < u; a++) {
                g[at] -= gux[a + (i * u)] * s->w[a + (j * u)];
            }
        }
    }
    return MT_OK;
}

/* out (ra x rc) := A^T C, a row sum that is rounding being 0. */
static void projected(ptrdiff_t n, int ra, const double *a, int rc, const double *c,
                      double *out)
{
    for (ptrdiff_t j = 0; j < rc; j++) {
        for (ptrdiff_t i = 0; i < ra; i++) {
            double sum = 0.0;
            double size = 0.0;
            for (ptrdiff_t k = 0; k < n; k++) {
                const double term = a[k + (i * n)] * c[k + (j * n)];
                sum += term;
                size += fabs(term);
            }
            out[i + (j * ra)] =
                fabs(sum) <= ENTRY_ULPS * (double)n * DBL_EPSILON * size ? 0.0 : sum;
        }
    }
}

/* (X^T c, U^T c) of the columns re + i im (either NULL: 0), n x cols: stay x cols (transposed
 * with `turn`: cols x stay) with what follows eliminated, and u x cols. */
static mt_status forces(parts *s, int cols, const double *re, const double *im, bool turn,
                        double complex *stays, double complex *follows, mt_err *err)
{
    const double *const part[2] = {re, im};
    const ptrdiff_t stay = s->stay;
    const ptrdiff_t u = s->u;
    const mt_arena_mark mark = mt_arena_get_mark(s->scratch);
    double *const own = mt_arena_f64(s->scratch, (size_t)stay, (size_t)cols);
    double *const rest = mt_arena_f64(s->scratch, (size_t)u, (size_t)cols);
    MT_TRY(mt_arena_check(s->scratch, err));
    for (int i = 0; i < 2; i++) {
        const double complex unit = mt_complex(i == 0 ? 1.0 : 0.0, i == 0 ? 0.0 : 1.0);
        if (part[i] == NULL) {
            continue;
        }
        projected(s->n, s->stay, s->x, cols, part[i], own);
        projected(s->n, s->u, s->follow, cols, part[i], rest);
        for (ptrdiff_t at = 0; at < u * cols; at++) {
            follows[at] += unit * rest[at];
        }
        for (ptrdiff_t at = 0; at < stay * cols; at++) {
            stays[turn ? (at / stay) + ((at % stay) * cols) : at] += unit * own[at];
        }
    }
    for (ptrdiff_t c = 0; c < cols; c++) {
        for (ptrdiff_t j = 0; j < stay; j++) {
            for (ptrdiff_t a = 0; a < u; a++) {
                stays[turn ? c + (j * cols) : j + (c * stay)] -=
                    s->w[a + (j * u)] * follows[a + (c * u)];
            }
        }
    }
    mt_arena_rewind(s->scratch, mark);
    return MT_OK;
}

static bool is_real(size_t n, const double complex *x)
{
    bool real = true;
    for (size_t i = 0; i < n; i++) {
        real = real && cimag(x[i]) == 0.0;
    }
    return real;
}

/* follow_s of the adjoints of S_p; su: U^T S_p^T. */
static mt_status follow_adjoint(parts *s, int p, const double complex *su, mt_basis *b,
                                mt_err *err)
{
    const size_t size = (size_t)s->u * (size_t)s->f->n_out;
    double complex *const solved = mt_arena_alloc(s->mem, size, sizeof *solved);
    MT_TRY(mt_arena_check(s->mem, err));
    memcpy(solved, su, size * sizeof *solved);
    b->follow_s[p] = solved;
    return mt_complex_solve(&s->factor, s->f->n_out, solved, err);
}

/* Makes rest[power] a writable copy in mem (zeros where it was NULL) and returns it; NULL: out
 * of memory. */
static double complex *writable_rest(mt_transfer *t, int power, mt_arena *mem)
{
    const size_t size = (size_t)t->n_in * (size_t)t->n_out;
    double complex *const out = mt_arena_alloc(mem, size, sizeof *out);
    const double complex *const had = t->rest[power - MT_REST_LOWEST];
    if (had != NULL && out != NULL) {
        memcpy(out, had, size * sizeof *out);
    }
    t->rest[power - MT_REST_LOWEST] = out;
    return out;
}

/* beta, sigma and rest of the transfer. */
static mt_status channels(parts *s, mt_basis *b, mt_err *err)
{
    mt_transfer *const t = &b->t;
    const mt_forced *const f = s->f;
    const ptrdiff_t u = s->u;
    double complex *bu[MT_FORCED_POWERS] = {NULL};
    double complex *su[MT_FORCED_POWERS] = {NULL};
    for (int p = 0; p < MT_FORCED_POWERS; p++) {
        const double *const s_im = p == 0 ? f->s_im : NULL;
        if (f->b[p] != NULL) {
            double complex *const beta =
                mt_arena_alloc(s->mem, (size_t)s->stay * (size_t)f->n_in, sizeof *beta);
            bu[p] = mt_arena_alloc(s->mem, (size_t)u * (size_t)f->n_in, sizeof *beta);
            MT_TRY(mt_arena_check(s->mem, err));
            MT_TRY(forces(s, f->n_in, f->b[p], NULL, false, beta, bu[p], err));
            MT_TRY(mt_complex_solve(&s->factor, f->n_in, bu[p], err));
            b->follow_b[p] = bu[p];
            t->beta[p] = beta;
        }
        if (f->s[p] != NULL || s_im != NULL) {
            const size_t size = (size_t)s->stay * (size_t)f->n_out;
            double complex *const sigma = mt_arena_alloc(s->mem, size, sizeof *sigma);
            su[p] = mt_arena_alloc(s->mem, (size_t)u * (size_t)f->n_out, sizeof *sigma);
            MT_TRY(mt_arena_check(s->mem, err));
            MT_TRY(forces(s, f->n_out, f->s[p], s_im, true, sigma, su[p], err));
            MT_TRY(follow_adjoint(s, p, su[p], b, err));
            t->sigma[p] = sigma;
            t->real[p] = is_real(size, sigma);
        }
    }
    for (int at = 0; u > 0 && at < MT_FORCED_POWERS * MT_FORCED_POWERS; at++) {
        const double complex *const left = su[at % MT_FORCED_POWERS];
        const double complex *const right = bu[at / MT_FORCED_POWERS];
        if (left == NULL || right == NULL) {
            continue;
        }
        double complex *const rest =
            writable_rest(t, (at % MT_FORCED_POWERS) + (at / MT_FORCED_POWERS), s->mem);
        MT_TRY(mt_arena_check(s->mem, err));
        for (ptrdiff_t i = 0; i < f->n_in; i++) {
            for (ptrdiff_t o = 0; o < f->n_out; o++) {
                for (ptrdiff_t a = 0; a < u; a++) {
                    rest[o + (i * f->n_out)] += left[a + (o * u)] * right[a + (i * u)];
                }
            }
        }
    }
    return MT_OK;
}

static bool all_diagonal(ptrdiff_t n, const double *c, const double complex *g)
{
    bool diagonal = true;
    for (ptrdiff_t at = 0; at < n * n; at++) {
        const bool off = at % n != at / n;
        diagonal = diagonal && !(off && (g[at] != 0.0 || (c != NULL && c[at] != 0.0)));
    }
    return diagonal;
}

/* m, c and g as the transfer reads them. */
static mt_status matrices(parts *s, const mt_modes *m, mt_basis *b, mt_err *err)
{
    const ptrdiff_t n = s->stay;
    const size_t size = (size_t)(n * n);
    b->g = mt_arena_alloc(s->mem, size, sizeof *b->g);
    b->c = s->f->c == NULL ? NULL : mt_arena_f64(s->mem, size, 1);
    b->lambda = mt_arena_f64(s->mem, (size_t)s->r, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    memcpy(b->lambda, m->lambda, (size_t)s->r * sizeof *b->lambda);
    MT_TRY(eliminate_following(s, m, err));
    MT_TRY(stiffness(s, m, b->g, err));
    if (b->c != NULL) {
        MT_TRY(sandwich(s, s->f->c, s->stay, s->x, s->stay, s->x, b->c, err));
    }
    b->t.diagonal = s->zd == 0 && all_diagonal(n, b->c, b->g);
    const size_t held = b->t.diagonal ? (size_t)n : size;
    const ptrdiff_t step = b->t.diagonal ? n + 1 : 1;
    double *const mass = mt_arena_f64(s->mem, held, 1);
    double *const c = b->c == NULL ? NULL : mt_arena_f64(s->mem, held, 1);
    double complex *const g = mt_arena_alloc(s->mem, held, sizeof *g);
    double *const error = mt_arena_f64(s->mem, (size_t)n, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    for (ptrdiff_t at = 0; at < (ptrdiff_t)held; at++) {
        const ptrdiff_t from = at * step;
        mass[at] = from % (n + 1) == 0 && from / (n + 1) < s->r ? 1.0 : 0.0;
        g[at] = b->g[from];
        if (c != NULL) {
            c[at] = b->c[from];
        }
    }
    memcpy(error, m->error, (size_t)s->r * sizeof *error);
    b->t.m = mass;
    b->t.c = c;
    b->t.g = g;
    b->t.error = error;
    return MT_OK;
}

static mt_status make_transfer_basis(parts *s, const mt_basis_problem *p, mt_basis *b,
                                     mt_err *err)
{
    const mt_forced *const f = p->f;
    MT_TRY(split_coordinates(s, p, err));
    b->t = (mt_transfer){.n = s->stay, .n_in = f->n_in, .n_out = f->n_out};
    MT_TRY(matrices(s, p->modes, b, err));
    mt_transfer given = {.n = 0};
    const mt_forced alone = {.n_in = f->n_in,
                             .n_out = f->n_out,
                             .d = {f->d[0], f->d[1], f->d[2]},
                             .d_im = f->d_im,
                             .e = {f->e[0], f->e[1]}};
    MT_TRY(mt_transfer_direct(&alone, s->mem, &given, err));
    memcpy(b->t.rest, given.rest, sizeof b->t.rest);
    b->x = s->x;
    b->follow = s->follow;
    b->w = s->w;
    b->n_follow = s->u;
    return channels(s, b, err);
}

mt_status mt_basis_make(const mt_basis_problem *p, mt_arena *mem, mt_basis *out, mt_err *err)
{
    const mt_modes *const m = p->modes;
    if (m->shaped < m->all) {
        return mt_fail(err, MT_E_USAGE, "a response by modes needs the shapes of all modes");
    }
    const int asked = p->keep > 0 && p->keep < m->all ? p->keep : m->all;
    const int keep = asked > m->n_rigid ? asked : m->n_rigid; /* these follow nothing */
    mt_arena scratch;
    *out = (mt_basis){.f = p->f,
                      .n_modes = keep,
                      .n_left = m->all - keep,
                      .lowest_left = keep < m->all ? m->lambda[keep] : HUGE_VAL};
    MT_TRY(mt_arena_init(&scratch, 0, err));
    parts s = {.f = p->f, .mem = mem, .scratch = &scratch, .n = p->f->n, .r = keep};
    const mt_status rc = make_transfer_basis(&s, p, out, err);
    mt_arena_free(&scratch);
    return rc;
}
