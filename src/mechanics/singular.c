/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dead centres. */
#include "mechanics/singular.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "mechanics/lagrangian.h"

/* One equation and its gradient. */

double mt_constraint_turns(const mt_data *d, int i, double value)
{
    const double turn = 6.283185307179586477;
    const mt_constraint_def *const c = &d->sys->constraints[i];
    const bool angle = d->sys->measures[c->measure[0]].kind == MT_MEASURE_ANGLE;
    return angle ? turn * round(value / turn) : 0.0;
}

void mt_constraint_values(const mt_data *d, const mt_placement *at, int m, double *c)
{
    const mt_system *const sys = d->sys;
    for (int i = 0; i < m; i++) {
        const mt_constraint_def *const def = &sys->constraints[i];
        c[i] = -creal(mt_data_target(d, i, at));
        for (int t = 0; t < def->terms; t++) {
            const mt_measure_def *const measure = &sys->measures[def->measure[t]];
            c[i] += creal(mt_data_scalar(d, def->coefficient[t], 1.0)) *
                    creal(mt_data_value(d, measure, at, NULL));
        }
        c[i] -= mt_constraint_turns(d, i, c[i]);
    }
}

/* Term t of constraint i along the motion phi[nq]: b[12] = c'' phi over the local freedoms of
 * the term's bodies. Returns the Frobenius norm of c'' with rows and columns scaled by
 * scale[nq]. */
static double constraint_curve(const mt_data *d, const mt_pose *poses, int i, int t,
                               const double *phi, const double *scale, double b[MT_LOCAL])
{
    const mt_system *const sys = d->sys;
    const mt_constraint_def *const c = &sys->constraints[i];
    const mt_measure_def *const def = &sys->measures[c->measure[t]];
    const mt_measure_data measure = mt_data_measure(d, def);
    const double factor = creal(mt_data_scalar(d, c->coefficient[t], 1.0));
    double squares = 0.0;
    mt_jet jet;
    mt_measure_eval(&measure, mt_pose_of(poses, def->body[0]), mt_pose_of(poses, def->body[1]),
                    true, NULL, &jet);
    for (int r = 0; r < MT_LOCAL; r++) {
        const int row = mt_local_dof(sys, def->body, r);
        b[r] = 0.0;
        for (int k = 0; k < MT_LOCAL && row >= 0; k++) {
            const int dof = mt_local_dof(sys, def->body, k);
            if (dof >= 0) {
                const double h = factor * creal(jet.h[r + (MT_LOCAL * k)]);
                b[r] += h * phi[dof];
                squares += scale[row] * h * scale[dof] * scale[row] * h * scale[dof];
            }
        }
    }
    return sqrt(squares);
}

/*
 * Positions where equations of joints are dependent at that very position only. With rows of
 * unit length, rotations as arcs and the model length L as unit, let
 *     A = U diag(s) V^T,   w_i, v_i a left and a right vector of a small singular value s_i,
 *         Z_i the right vectors of all values up to s_i, and of the freedoms.
 * What the other equations leave of equation i on the motions Z y is (Lyapunov-Schmidt)
 *     g_i(y) = s_i v_i^T y + 1/2 y^T H_i y + O(y^3),   H_i = Z_i^T (sum_j w_ij c_j'') Z_i,
 * which does not depend on the chart, as w_i^T A vanishes to that order. (Motions that a
 * greater s_j blocks are left out of Z_i: equation j blocks them wherever H_i leads.)
 *     H_i = 0, s_i = 0   the equation holds wherever the others do, as far as the second order
 *                        tells: redundant everywhere, welcome
 *     H_i = 0, s_i > 0   almost redundant, yet independent
 *     H_i > 0            the gradient of g_i changes by |H_i| per unit of motion: at a distance
 *                        of about s_i / |H_i| there is a position where it vanishes; the
 *                        equations are fulfilled there up to s_i^2 / (2 |H_i|). Where that is
 *                        rounding, this position is that one.
 * |H_i| is taken from its products with a few vectors of independent entries of variance 1:
 * their mean square length is |H_i|_F^2. It counts as 0 below NO_CURVATURE of its own terms.
 *
 * Where H_i = 0 and s_i = 0 a higher term may be left (a point on a line that touches its path
 * to the third order). So the mechanism is moved, by a finite y: the independent equations are
 * closed again by a chord iteration with the elimination at hand, and the others are looked at.
 * They stay closed where they are redundant everywhere.
 */

enum { PROBES = 4, WALKS = 2, CHORDS = 60, HALVINGS = 6 };

/* Relative diagonal entries of R below which an equation is looked at: to refuse (at a dead
 * centre they are rounding of positions, 1e-8 at most), and to tell how near one is. */
static const double LOOK = 1e-5;
static const double LOOK_NEAR = 2e-2;
/* Of the sum of the norms of its terms: rounding and axes drawn parallel to 1e-9 leave less. */
static const double NO_CURVATURE = 1e-7;
/* What rounding leaves of closed equations, in units in the last place of the coordinates. */
static const double CLOSED_ULPS = 64.0;
/* Of that rounding, s^2 / |H| of a position that is the same as the dead centre. */
static const double SAME = 0.25;
/* First finite motion [model lengths, rad]: large enough for terms of the seventh order, small
 * enough for the chord iteration. */
static const double WALK = 0.03;
/* Dependent equations open by less than this many times what the iteration leaves of the
 * others, or makes of their own first order. */
static const double OPEN_ROOM = 1e3;

typedef struct near {
    const mt_data *d;
    const mt_placement *at;
    const mt_elimination *e;
    double unit; /* rounding of closed equations, model lengths */
    int rank;    /* equations that are clearly independent */
    int k;       /* the others */
    int kept;    /* of them: independent all the same, s > 0 */
    int n;       /* nq - rank */
    double *w;   /* m x (k + 1), unit columns, equilibrated rows; the last: a combination */
    double *z;   /* nq x n */
    double *s;   /* [k] singular values, falling */
    double *vt;  /* k x columns: v_i in the first columns of z */
    int columns;
    double *h;   /* [k] |H_i| L */
    double *sum; /* [k] norms of its terms */
} near;

/* Uniform in (-sqrt 3, sqrt 3): variance 1. Same numbers in every run. */
static double draw(uint64_t *state)
{
    *state = (*state * 6364136223846793005u) + 1442695040888963407u;
    const double u = (double)(*state >> 11) * 0x1p-53;
    return ((2.0 * u) - 1.0) * 1.7320508075688772;
}

static double rounding(const mt_data *d, const mt_pose *poses)
{
    double extent = d->sys->length_m;
    for (int i = 0; i < d->sys->n_bodies; i++) {
        for (int k = 0; k < 3; k++) {
            extent = fmax(extent, fabs(creal(poses[i].x[k])));
        }
    }
    return CLOSED_ULPS * DBL_EPSILON * extent / d->sys->length_m;
}

/* S = W^T A Z of the left vectors from the elimination, from the lower right corner of R; W, S
 * := U^T W, diag(s). */
static mt_status decompose(near *v, mt_arena *mem, mt_err *err)
{
    const mt_elimination *const e = v->e;
    const int corner = (e->m < e->nq ? e->m : e->nq) - v->rank;
    const int columns = corner > v->k ? corner : v->k;
    v->columns = corner;
    double *const raw = mt_arena_f64(mem, (size_t)e->m, (size_t)v->k);
    double *const small = mt_arena_f64(mem, (size_t)v->k, (size_t)columns);
    double *const u = mt_arena_f64(mem, (size_t)v->k, (size_t)v->k);
    v->vt = mt_arena_f64(mem, (size_t)v->k, (size_t)columns);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < v->k; i++) {
        double *const w = raw + ((ptrdiff_t)i * e->m);
        MT_TRY(mt_eliminate_left_vector(e, v->rank, i, w, mem, err));
        const double length = mt_norm2(e->m, w);
        const double last = w[e->qr.perm[v->rank + i]] / length;
        for (int j = 0; j < e->m; j++) {
            w[j] /= length;
        }
        for (int r = 0; r < corner && r <= i; r++) {
            const ptrdiff_t column = v->rank + i;
            small[i + ((ptrdiff_t)r * v->k)] = last * e->qr.qr[v->rank + r + (column * e->nq)];
        }
    }
    MT_TRY(mt_svd(v->k, columns, small, v->s, u, v->vt, mem, err));
    mt_gemm(false, false, e->m, v->k, v->k, 1.0, raw, e->m, u, v->k, 0.0, v->w, e->m);
    return MT_OK;
}

/* y without its parts along v_0 .. v_(level-1). */
static void remove_first_directions(const near *v, int level, double *y)
{
    for (int i = 0; i < level; i++) {
        double part = 0.0;
        for (int c = 0; c < v->columns; c++) {
            part += v->vt[i + ((ptrdiff_t)c * v->k)] * y[c];
        }
        for (int c = 0; c < v->columns; c++) {
            y[c] -= part * v->vt[i + ((ptrdiff_t)c * v->k)];
        }
    }
}

/* push := (sum_j w_j c_j'') phi of equation i; returns the norms of the terms, none of them
 * below that of a unit row that turns once per model length. */
static double curve(const near *v, int i, const double *phi, double *push)
{
    const mt_elimination *const e = v->e;
    const mt_system *const sys = v->d->sys;
    double norms = 0.0;
    memset(push, 0, (size_t)e->nq * sizeof *push);
    for (int j = 0; j < e->m; j++) {
        const double w = v->w[j + ((ptrdiff_t)i * e->m)] * e->dr[j];
        double size = 1.0 / (e->dr[j] * sys->length_m); /* that of a turn at the model length */
        for (int t = 0; t < sys->constraints[j].terms && w != 0.0; t++) {
            const int *const body = sys->measures[sys->constraints[j].measure[t]].body;
            double b[MT_LOCAL];
            size = fmax(size, constraint_curve(v->d, v->at->pose, j, t, phi, e->dc, b));
            for (int k = 0; k < MT_LOCAL; k++) {
                const int dof = mt_local_dof(sys, body, k);
                push[dof < 0 ? 0 : dof] += dof < 0 ? 0.0 : w * b[k];
            }
        }
        norms += fabs(w) * size;
    }
    return norms;
}

/* |H_i| L on the motions that equations 0 .. level - 1 leave, into h[i], and the norms of its
 * terms into sum[i]. */
static mt_status curvature(near *v, int i, int level, mt_arena *mem, mt_err *err)
{
    const mt_elimination *const e = v->e;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const double unit = v->d->sys->length_m;
    uint64_t state = 1;
    double squares = 0.0;
    double *const g = mt_arena_f64(mem, (size_t)v->n, 1);
    double *const phi = mt_arena_f64(mem, (size_t)e->nq, 1);
    double *const push = mt_arena_f64(mem, (size_t)e->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int p = 0; p < PROBES; p++) {
        for (int c = 0; c < v->n; c++) {
            g[c] = draw(&state);
        }
        remove_first_directions(v, level, g);
        mt_gemv(false, e->nq, v->n, 1.0, v->z, e->nq, g, 0.0, phi);
        v->sum[i] = unit * curve(v, i, phi, push);
        mt_gemv(true, e->nq, v->n, unit, v->z, e->nq, push, 0.0, g);
        remove_first_directions(v, level, g);
        squares += mt_dot(v->n, g, g);
    }
    v->h[i] = sqrt(squares / PROBES);
    mt_arena_rewind(mem, mark);
    return MT_OK;
}

static bool is_curved(const near *v, int i)
{
    return v->h[i] > NO_CURVATURE * v->sum[i];
}

/* Equations that are dependent to rounding are looked at together first: a combination with
 * random coefficients has no curvature where none of them has. */
static mt_status curvatures(near *v, mt_arena *mem, mt_err *err)
{
    const ptrdiff_t m = v->e->m;
    uint64_t state = 3;
    for (int i = 0; i < v->kept; i++) {
        MT_TRY(curvature(v, i, i, mem, err));
    }
    for (int i = v->kept; i < v->k; i++) {
        mt_axpy((int)m, draw(&state), v->w + (i * m), v->w + (v->k * m));
    }
    MT_TRY(curvature(v, v->k, v->kept, mem, err));
    for (int i = v->kept; i < v->k && is_curved(v, v->k); i++) {
        MT_TRY(curvature(v, i, v->kept, mem, err));
    }
    return MT_OK;
}

/* Equations whose relative diagonal entry of R is below `look`. */
static mt_status find_near_dependent(const mt_data *d, const mt_placement *at,
                                     const mt_elimination *e, double look, near *v,
                                     mt_arena *mem, mt_err *err)
{
    const int most = e->m < e->nq ? e->m : e->nq;
    const double first = most > 0 ? fabs(e->qr.qr[0]) : 0.0;
    *v = (near){.d = d, .at = at, .e = e};
    while (v->rank < most &&
           fabs(e->qr.qr[v->rank + ((ptrdiff_t)v->rank * e->nq)]) > look * first) {
        v->rank++;
    }
    v->k = e->m - v->rank;
    v->kept = e->qr.rank > v->rank ? e->qr.rank - v->rank : 0;
    v->n = e->nq - v->rank;
    if (v->k == 0 || v->n == 0) {
        v->k = 0;
        return MT_OK;
    }
    v->unit = rounding(d, at->pose);
    v->w = mt_arena_f64(mem, (size_t)e->m, (size_t)v->k + 1);
    v->z = mt_arena_f64(mem, (size_t)e->nq, (size_t)v->n);
    v->s = mt_arena_f64(mem, (size_t)v->k, 1);
    v->h = mt_arena_f64(mem, (size_t)v->k + 1, 1);
    v->sum = mt_arena_f64(mem, (size_t)v->k + 1, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_qr_q(&e->qr, v->rank, v->z, mem, err));
    for (ptrdiff_t c = 0; c < v->n; c++) {
        for (int j = 0; j < e->nq; j++) {
            v->z[j + (c * e->nq)] *= e->dc[j];
        }
    }
    MT_TRY(decompose(v, mem, err));
    return curvatures(v, mem, err);
}

static mt_status refuse_dependent_joints(const near *v, const double *w, mt_arena *mem,
                                         mt_err *err)
{
    mt_joint_names names;
    MT_TRY(mt_name_joints(v->d->sys, v->e->m, w, mem, &names, err));
    return mt_fail(err, MT_E_DEAD_CENTRE,
                   "dead centre: joints %s become dependent in exactly this position. Neither "
                   "the direction of motion nor the forces of these joints are determined "
                   "here, so there are no small vibrations to compute. Move the mechanism "
                   "slightly out of this position, or remove the joint that is superfluous",
                   names.text);
}

/* Largest motion of a body in a displacement [model lengths, rad]. */
static double largest_displacement(const mt_system *sys, const double *dq)
{
    double most = 0.0;
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            const double unit = k < 3 ? sys->length_m : 1.0;
            most = fmax(most, dof >= 0 ? fabs(dq[dof]) / unit : 0.0);
        }
    }
    return most;
}

typedef struct walk {
    mt_placement at;
    double *dq;   /* [nq] */
    double *back; /* [nq] */
    double *c;    /* [m] */
    double left;  /* of the independent equations, model lengths */
} walk;

/* dq := correction that closes the independent equations; *closed. */
static mt_status close(const near *v, walk *w, bool *closed, mt_arena *mem, mt_err *err)
{
    const mt_elimination *const e = v->e;
    const mt_system *const sys = v->d->sys;
    const double limit = 2.0 * largest_displacement(sys, w->dq);
    *closed = false;
    for (int it = 0; it < CHORDS && !*closed; it++) {
        mt_placement_copy(sys, v->at, &w->at);
        mt_poses_move(sys, w->at.pose, w->dq);
        mt_constraint_values(v->d, &w->at, e->m, w->c);
        w->left = 0.0;
        for (int i = 0; i < e->qr.rank; i++) {
            const int row = e->qr.perm[i];
            w->left = fmax(w->left, fabs(e->dr[row] * w->c[row]) / sys->length_m);
        }
        *closed = w->left <= v->unit;
        for (int i = 0; i < e->m; i++) {
            w->c[i] = *closed ? w->c[i] : -w->c[i];
        }
        if (!*closed) {
            MT_TRY(mt_eliminate_particular(e, w->c, w->back, mem, err));
            mt_axpy(e->nq, 1.0, w->back, w->dq);
            if (!(largest_displacement(sys, w->dq) <= limit)) {
                return MT_OK;
            }
        }
    }
    return MT_OK;
}

/* The dependent equation with the largest gap after a finite motion; -1: none. e: with the
 * orthonormal basis. */
static mt_status find_open(const near *v, const mt_elimination *e, uint64_t *state, walk *w,
                           int *open, mt_arena *mem, mt_err *err)
{
    const mt_system *const sys = v->d->sys;
    double *const y = mt_arena_f64(mem, (size_t)e->n, 1);
    double *const direction = mt_arena_f64(mem, (size_t)e->nq, 1);
    bool closed = false;
    double length = WALK;
    *open = -1;
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < e->n; i++) {
        y[i] = draw(state);
    }
    mt_eliminate_expand(e, y, direction);
    const double size = largest_displacement(sys, direction);
    for (int half = 0; half < HALVINGS && !closed && size > 0.0; half++) {
        for (int j = 0; j < e->nq; j++) {
            w->dq[j] = length / size * direction[j];
        }
        MT_TRY(close(v, w, &closed, mem, err));
        length *= closed ? 1.0 : 0.5;
    }
    double most = OPEN_ROOM * (fmax(w->left, DBL_EPSILON) + (e->qr.dropped * length));
    for (int i = e->qr.rank; closed && i < e->m; i++) {
        const int row = e->qr.perm[i];
        const double gap = fabs(e->dr[row] * w->c[row]) / sys->length_m;
        if (!(gap <= most)) {
            most = gap;
            *open = i - e->qr.rank;
        }
    }
    return MT_OK;
}

static mt_status walk_away(const near *v, mt_arena *mem, mt_err *err)
{
    const mt_elimination *const e = v->e;
    const size_t nq = (size_t)e->nq;
    uint64_t state = 2;
    int open = -1;
    walk w = {.dq = mt_arena_f64(mem, nq, 1),
              .back = mt_arena_f64(mem, nq, 1),
              .c = mt_arena_f64(mem, (size_t)e->m, 1)};
    double *const null = mt_arena_f64(mem, (size_t)e->m, 1);
    mt_elimination own = *e;
    own.z = mt_arena_f64(mem, nq, (size_t)e->n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_eliminate_basis(&own, mem, err));
    MT_TRY(mt_placement_init(&w.at, v->d->sys, mem, err));
    for (int i = 0; i < WALKS && open < 0; i++) {
        MT_TRY(find_open(v, &own, &state, &w, &open, mem, err));
    }
    if (open < 0) {
        return MT_OK;
    }
    MT_TRY(mt_eliminate_left_null(e, open, null, mem, err));
    return refuse_dependent_joints(v, null, mem, err);
}

static mt_status check_dead_centre(const mt_data *d, const mt_placement *at,
                                   const mt_elimination *e, mt_arena *mem, mt_err *err)
{
    near v;
    int worst = -1;
    MT_TRY(find_near_dependent(d, at, e, LOOK, &v, mem, err));
    for (int i = 0; i < v.k; i++) {
        const bool here = is_curved(&v, i) && v.s[i] * v.s[i] <= SAME * v.unit * v.h[i];
        worst = here && (worst < 0 || v.h[i] > v.h[worst]) ? i : worst;
    }
    if (worst >= 0) {
        return refuse_dependent_joints(&v, v.w + ((ptrdiff_t)worst * e->m), mem, err);
    }
    return v.k > 0 && e->qr.rank < e->m && e->n > 0 ? walk_away(&v, mem, err) : MT_OK;
}

mt_status mt_singular_refuse(const mt_data *d, const mt_placement *at, const mt_elimination *e,
                             mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = check_dead_centre(d, at, e, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

mt_status mt_singular_nearness(const mt_data *d, const mt_placement *at,
                               const mt_elimination *e, mt_arena *scratch, mt_arena *mem,
                               mt_nearness *out, mt_err *err)
{
    near v;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    *out = (mt_nearness){.independence = 1.0, .distance = HUGE_VAL};
    MT_TRY(find_near_dependent(d, at, e, LOOK_NEAR, &v, scratch, err));
    for (int i = 0; i < v.k; i++) {
        const double distance = i < v.kept && is_curved(&v, i) ? v.s[i] / v.h[i] : HUGE_VAL;
        if (distance <= MT_NEAR_DISTANCE && distance < out->distance) {
            out->near = true;
            out->independence = v.s[i];
            out->distance = distance;
            MT_TRY(mt_name_joints(d->sys, e->m, v.w + ((ptrdiff_t)i * e->m), mem, &out->joints,
                                  err));
        }
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}
