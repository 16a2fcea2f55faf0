/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Derivation. With R -> exp(theta^) R a vector w = R w0 fixed to the body becomes, to second
 * order,
 *     w + theta x w + 1/2 theta x (theta x w).
 * Hence, for a constant n,
 *     d(n . w)   = theta . (w x n)
 *     d2(n . w)  = theta^T [ 1/2 (n w^T + w n^T) - (n . w) I ] theta,
 * and for w on body a, v on body b
 *     d2(w . v)  mixed: (theta_a x w) . (theta_b x v) = theta_a^T [
 *         (w . v) I - v w^T ] theta_b.
 * Everything below is these three lines and the chain rule.
 */
#include "mechanics/measure_priv.h"

#include <stddef.h>
#include <string.h>

static const double TURN = 6.283185307179586477; /* 2 pi */
static const mt_cx ZERO3[3] = {0.0, 0.0, 0.0};

/* Block (theta_a, theta_b) of alpha I + beta s t^T. */
static void add_mixed(mt_relative_jet *j, mt_cx alpha, double beta, const mt_cx *s,
                      const mt_cx *t)
{
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    for (int c = first; c < 3; c++) {
        mt_cx *const row = j->h + mt_relative_row(MT_AT_TURN_B + c) + MT_AT_TURN_A;
        for (int r = first; r < 3; r++) {
            mt_cx v = beta * cx_mul(s[r], t[c]);
            if (r == c) {
                v += alpha;
            }
            row[r] += v;
        }
    }
}

/* The same as add_dot, of numbers without derivatives. */
static void add_real_dot(mt_relative_jet *j, double scale, const mt_cx *cu, const mt_cx *cv)
{
    const double u[3] = {creal(cu[0]), creal(cu[1]), creal(cu[2])};
    const double v[3] = {creal(cv[0]), creal(cv[1]), creal(cv[2])};
    const double n[3] = {(u[1] * v[2]) - (u[2] * v[1]), (u[2] * v[0]) - (u[0] * v[2]),
                         (u[0] * v[1]) - (u[1] * v[0])};
    const double dot = scale * ((u[0] * v[0]) + (u[1] * v[1]) + (u[2] * v[2]));
    j->value += dot;
    for (int k = 0; k < 3; k++) {
        j->g[MT_AT_TURN_A + k] += scale * n[k];
        j->g[MT_AT_TURN_B + k] -= scale * n[k];
    }
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    for (int r = j->second ? first : 3; r < 3; r++) {
        mt_cx *const a = j->h + mt_relative_row(MT_AT_TURN_A + r) + MT_AT_TURN_A;
        mt_cx *const b = j->h + mt_relative_row(MT_AT_TURN_B + r) + MT_AT_TURN_B;
        mt_cx *const mixed = b - (MT_AT_TURN_B - MT_AT_TURN_A);
        for (int c = first; c <= r; c++) {
            const double half = 0.5 * scale;
            const double one = (half * (u[r] * v[c])) - (r == c ? dot : 0.0);
            const double other = half * (v[r] * u[c]);
            a[c] = a[c] + one + other;
            b[c] = b[c] + one + other;
        }
        for (int c = first; c < 3; c++) {
            mixed[c] += (r == c ? dot : 0.0) - (scale * (v[c] * u[r]));
        }
    }
}

/* j += scale (u . v), u on a, v on b, both already rotated. */
static void add_dot(mt_relative_jet *j, double scale, const mt_cx *u, const mt_cx *v)
{
    mt_cx n[3];
    if (j->real) {
        add_real_dot(j, scale, u, v);
        return;
    }
    const mt_cx dot = scale * cx_dot3(u, v);
    j->value += dot;
    cx_cross3(u, v, n);
    mt_relative_add_vec(j->g + MT_AT_TURN_A, scale, n);
    mt_relative_add_vec(j->g + MT_AT_TURN_B, -scale, n);
    if (j->second) {
        mt_relative_add_rotation(j, MT_AT_TURN_A, scale, u, v);
        mt_relative_add_rotation(j, MT_AT_TURN_B, scale, u, v);
        add_mixed(j, dot, -scale, v, u);
    }
}

/* j += u . (Q - P); s, t: P - x_a and Q - x_b rotated; d = x_b - x_a. P moves with a as u
 * does, so u . s is constant. */
static void add_plane(mt_relative_jet *j, const mt_cx *u, const mt_cx *s, const mt_cx *t,
                      const mt_cx *d)
{
    mt_cx w[3];
    mt_cx n[3];
    for (int i = 0; i < 3; i++) {
        w[i] = d[i] + t[i];
    }
    j->value += cx_dot3(u, w) - cx_dot3(u, s);
    mt_relative_add_vec(j->g + MT_AT_CHORD, 1.0, u);
    cx_cross3(u, w, n);
    mt_relative_add_vec(j->g + MT_AT_TURN_A, 1.0, n);
    cx_cross3(t, u, n);
    mt_relative_add_vec(j->g + MT_AT_TURN_B, 1.0, n);
    if (j->second) {
        mt_relative_add_rotation(j, MT_AT_TURN_A, 1.0, u, w);
        mt_relative_add_cross(j, MT_AT_TURN_A, u);
        add_mixed(j, cx_dot3(u, t), -1.0, t, u);
        mt_relative_add_rotation(j, MT_AT_TURN_B, 1.0, u, t);
    }
}

/* A distance of 0 has no direction: its value, without derivatives. */
static void distance_none(double value, mt_relative_jet *out)
{
    const mt_cx none = cx_pair(nan(""), nan(""));
    out->value = cx_pair(value, nan(""));
    out->real = false;
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] = none;
    }
    for (int i = 0; out->second && i < MT_RELATIVE_PAIRS; i++) {
        out->h[i] = none;
    }
}

/* Columns of J: dr = dd + theta_b x t - theta_a x s. */
static void reach_columns(const mt_cx *s, const mt_cx *t, mt_cx (*jac)[3])
{
    for (int k = 0; k < 3; k++) {
        mt_cx e[3] = {0.0, 0.0, 0.0};
        e[k] = 1.0;
        memcpy(jac[MT_AT_CHORD + k], e, sizeof e);
        cx_cross3(s, e, jac[MT_AT_TURN_A + k]); /* -(e x s) */
        cx_cross3(e, t, jac[MT_AT_TURN_B + k]);
    }
}

/* |r| with r = Q - P, u = r / |r|: gradient u^T J, Hessian (J^T J - g g^T) / |r| + u . d2r. */
void mt_relative_distance(const mt_cx *s, const mt_cx *t, const mt_cx *d, mt_second second,
                          bool real, mt_relative_jet *out)
{
    const bool chord = s == NULL && t == NULL;
    const mt_cx *const p = s == NULL ? ZERO3 : s;
    const mt_cx *const q = t == NULL ? ZERO3 : t;
    mt_cx r[3];
    mt_cx u[3];
    mt_cx jac[MT_RELATIVE][3];
    mt_relative_clear(out, second, chord ? MT_SPAN_CHORD : MT_SPAN_ALL, real);
    for (int i = 0; i < 3; i++) {
        r[i] = d[i] + q[i] - p[i];
    }
    const mt_cx length = cx_norm3(r);
    if (!(creal(length) > 0.0)) {
        out->span = MT_SPAN_ALL;
        distance_none(creal(length), out);
        return;
    }
    for (int i = 0; i < 3; i++) {
        u[i] = cx_div(r[i], length);
    }
    out->value = length;
    mt_relative_add_vec(out->g + MT_AT_CHORD, 1.0, u);
    if (!chord) {
        mt_cx n[3];
        cx_cross3(p, u, n);
        mt_relative_add_vec(out->g + MT_AT_TURN_A, -1.0, n);
        cx_cross3(q, u, n);
        mt_relative_add_vec(out->g + MT_AT_TURN_B, 1.0, n);
    }
    if (!second) {
        return;
    }
    reach_columns(p, q, jac);
    const mt_relative_list *const l = mt_relative_filled(second, out->span);
    for (int ii = 0; ii < l->n; ii++) {
        const int i = l->at[ii];
        for (int kk = 0; kk <= ii; kk++) {
            const int k = l->at[kk];
            const mt_cx v = cx_dot3(jac[i], jac[k]) - cx_mul(out->g[i], out->g[k]);
            out->h[mt_relative_row(i) + k] = cx_div(v, length);
        }
    }
    if (!chord) {
        mt_relative_add_rotation(out, MT_AT_TURN_A, -1.0, u, p);
        mt_relative_add_rotation(out, MT_AT_TURN_B, 1.0, u, q);
    }
}

/* atan2(p, q). */
static void atan2_jet(const mt_relative_jet *p, const mt_relative_jet *q, mt_relative_jet *out)
{
    const mt_cx rr = cx_mul(p->value, p->value) + cx_mul(q->value, q->value);
    const mt_cx r4 = cx_mul(rr, rr);
    const mt_cx pq2 = 2.0 * cx_mul(p->value, q->value);
    const mt_cx diff = cx_mul(p->value, p->value) - cx_mul(q->value, q->value);
    const mt_chain2 c = {
        .f = cx_atan2(p->value, q->value),
        .fp = cx_div(q->value, rr),
        .fq = -cx_div(p->value, rr),
        .fpp = -cx_div(pq2, r4),
        .fpq = cx_div(diff, r4),
        .fqq = cx_div(pq2, r4),
    };
    mt_relative_chain(&c, p, q, out);
}

/* p = c_a . b_b, q = b_a . b_b. */
static void angle_jet(const mt_cx *b_a, const mt_cx *c_a, const mt_cx *b_b, mt_second second,
                      bool real, mt_relative_jet *out)
{
    mt_relative_jet p;
    mt_relative_jet q;
    mt_relative_clear(&p, second, MT_SPAN_TURNS, real);
    mt_relative_clear(&q, second, MT_SPAN_TURNS, real);
    add_dot(&p, 1.0, c_a, b_b);
    add_dot(&q, 1.0, b_a, b_b);
    atan2_jet(&p, &q, out);
}

/* p = e3 . f2 - e2 . f3, q = e2 . f2 + e3 . f3: of the quaternion of the turn from e to f, p =
 * 4 q0 q1, q = 2 (q0^2 - q1^2). */
void mt_relative_twist(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, bool real,
                       mt_relative_jet *out)
{
    mt_relative_jet p;
    mt_relative_jet q;
    mt_relative_clear(&p, second, MT_SPAN_TURNS, real);
    mt_relative_clear(&q, second, MT_SPAN_TURNS, real);
    add_dot(&p, 1.0, e[2], f[1]);
    add_dot(&p, -1.0, e[1], f[2]);
    add_dot(&q, 1.0, e[1], f[1]);
    add_dot(&q, 1.0, e[2], f[2]);
    atan2_jet(&p, &q, out);
}

/* Below this 1 - cos the closed forms of g = angle/sin lose digits to cancellation and a series
 * is used; its next term is of order x^8 < 1e-17 there. */
static const double SERIES_BELOW = 0.01;

/*
 * g(c) = acos(c)/sqrt(1 - c^2) satisfies (1 - c^2) g' = c g - 1, so all its derivatives follow
 * from g; near c = 1 with x = 1 - c:
 *     g = sum a_n x^n,  a_0 = 1,  a_n = a_(n-1) n/(2n + 1)      (from the same equation).
 */
void mt_angle_over_sine(mt_cx c, mt_cx g[3])
{
    const mt_cx x = 1.0 - c;
    if (creal(x) < SERIES_BELOW) {
        mt_cx power = 1.0; /* x^(n-2) */
        double a = 1.0;
        g[0] = 1.0 + (x / 3.0);
        g[1] = -1.0 / 3.0;
        g[2] = 0.0;
        a = 1.0 / 3.0;
        for (int n = 2; n <= 10; n++) {
            a *= (double)n / (double)((2 * n) + 1);
            g[2] += (double)(n * (n - 1)) * a * power;
            g[1] -= (double)n * a * cx_mul(power, x);
            g[0] += a * cx_mul(power, cx_mul(x, x));
            power = cx_mul(power, x);
        }
        return;
    }
    const mt_cx ss = 1.0 - cx_mul(c, c);
    const mt_cx sine = cx_sqrt(ss);
    g[0] = cx_div(cx_atan2(sine, c), sine);
    g[1] = cx_div(cx_mul(c, g[0]) - 1.0, ss);
    g[2] = cx_div(g[0] + (3.0 * cx_mul(c, g[1])), ss);
}

/* cos from the trace of Q_ij = e_i(a) . e_j(b). */
void mt_relative_cosine(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, bool real, mt_cx g[3],
                        mt_relative_jet *out)
{
    mt_relative_clear(out, second, MT_SPAN_TURNS, real);
    for (int i = 0; i < 3; i++) {
        add_dot(out, 0.5, e[i], f[i]);
    }
    out->value -= 0.5;
    mt_angle_over_sine(out->value, g);
}

/* xi_k = g(cos) psi_k with psi_k = sin * axis_k from the skew part of Q. */
void mt_relative_rotation(mt_cx (*e)[3], mt_cx (*f)[3], int k, const mt_relative_jet *cosine,
                          const mt_cx g[3], mt_relative_jet *out)
{
    mt_relative_jet psi;
    const int k1 = (k + 1) % 3;
    const int k2 = (k + 2) % 3;
    mt_relative_clear(&psi, cosine->second, MT_SPAN_TURNS, cosine->real);
    add_dot(&psi, 0.5, e[k2], f[k1]);
    add_dot(&psi, -0.5, e[k1], f[k2]);
    const mt_chain2 c = {
        .f = cx_mul(g[0], psi.value),
        .fp = g[0],
        .fq = cx_mul(g[1], psi.value),
        .fpp = 0.0,
        .fpq = g[1],
        .fqq = cx_mul(g[2], psi.value),
    };
    mt_relative_chain(&c, &psi, cosine, out);
}

/* True where the parts are those of this element at these poses, with enough of the Hessian. */
static bool has_parts(const mt_beam_parts *p, const mt_measure_data *m, const mt_pose *a,
                      const mt_pose *b, mt_second second)
{
    return p->dir == m->dir[0] && p->dir != NULL && p->pose[0] == a && p->pose[1] == b &&
           p->length.second == second;
}

/* True where none of n numbers carries a derivative. */
static bool all_real(int n, const mt_cx *z)
{
    bool real = true;
    for (int i = 0; i < n; i++) {
        real = real && cimag(z[i]) == 0.0;
    }
    return real;
}

static void beam_jet(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                     mt_second second, mt_beam_parts *parts, mt_relative_jet *out)
{
    if (!has_parts(parts, m, a, b, second)) {
        mt_cx d[3];
        mt_cx e[3][3];
        mt_cx f[3][3];
        for (int i = 0; i < 3; i++) {
            d[i] = b->x[i] - a->x[i];
            cx_rotate3(a->r, m->dir[i], e[i]);
            cx_rotate3(b->r, m->dir[i], f[i]);
        }
        const bool real = all_real(3, d) && all_real(9, e[0]) && all_real(9, f[0]);
        mt_beam_parts_fill(m, e, f, d, second, real, parts);
        parts->dir = m->dir[0];
        parts->pose[0] = a;
        parts->pose[1] = b;
    }
    mt_beam_strain_fill(m, parts, out);
}

/* w := the vector v rotated with its body, 0 for NULL; true where it has no derivative. */
static bool turn(const mt_pose *pose, const mt_cx *v, mt_cx w[3])
{
    if (v == NULL) {
        memset(w, 0, 3 * sizeof *w);
        return true;
    }
    cx_rotate3(pose->r, v, w);
    return all_real(3, w);
}

/* d = x_b - x_a, s and t; true where they have no derivative. */
static bool set_measure_vectors(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                                mt_cx d[3], mt_cx s[3], mt_cx t[3])
{
    for (int i = 0; i < 3; i++) {
        d[i] = b->x[i] - a->x[i];
    }
    const bool real[] = {all_real(3, d), turn(a, m->point[0], s), turn(b, m->point[1], t)};
    return real[0] && real[1] && real[2];
}

static void rotation_jet(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                         mt_second second, mt_relative_jet *out)
{
    mt_relative_jet cosine;
    mt_cx e[3][3];
    mt_cx f[3][3];
    mt_cx g[3];
    bool real = true;
    for (int i = 0; i < 3; i++) {
        real = turn(a, m->dir[i], e[i]) && real;
        real = turn(b, m->dir[i], f[i]) && real;
    }
    mt_relative_cosine(e, f, second, real, g, &cosine);
    mt_relative_rotation(e, f, m->component, &cosine, g, out);
}

/* All kinds but a beam's strains. */
static void plain_jet(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                      mt_second second, mt_relative_jet *out)
{
    mt_cx s[3];
    mt_cx t[3];
    mt_cx d[3];
    mt_cx e[3];
    mt_cx f[3];
    bool real = true;
    switch (m->kind) {
    case MT_MEASURE_PLANE:
        real = turn(a, m->dir[0], e);
        real = set_measure_vectors(m, a, b, d, s, t) && real;
        mt_relative_clear(out, second, MT_SPAN_ALL, real);
        add_plane(out, e, s, t, d);
        break;
    case MT_MEASURE_DOT:
        real = turn(a, m->dir[0], e);
        real = turn(b, m->dir[1], f) && real;
        mt_relative_clear(out, second, MT_SPAN_TURNS, real);
        add_dot(out, 1.0, e, f);
        break;
    case MT_MEASURE_DISTANCE:
        real = set_measure_vectors(m, a, b, d, s, t);
        mt_relative_distance(s, t, d, second, real, out);
        break;
    case MT_MEASURE_ANGLE:
        real = turn(a, m->dir[0], e);
        real = turn(a, m->dir[1], s) && real;
        real = turn(b, m->dir[0], f) && real;
        angle_jet(e, s, f, second, real, out);
        out->value += TURN * rint((m->near - creal(out->value)) / TURN);
        break;
    case MT_MEASURE_ROTATION:
        rotation_jet(m, a, b, second, out);
        break;
    case MT_MEASURE_BEAM:
        break;
    }
}

void mt_measure_relative(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                         bool with_second, mt_beam_parts *kept, mt_relative_jet *out)
{
    const mt_second second = !with_second ? MT_SECOND_NONE
                             : m->plane   ? MT_SECOND_PLANE
                                          : MT_SECOND_ALL;
    if (m->kind == MT_MEASURE_BEAM) {
        mt_beam_parts own;
        own.dir = NULL;
        beam_jet(m, a, b, second, kept != NULL ? kept : &own, out);
        return;
    }
    plain_jet(m, a, b, second, out);
}

void mt_measure_eval(const mt_measure_data *m, const mt_pose *a, const mt_pose *b, bool second,
                     mt_beam_parts *kept, mt_jet *out)
{
    mt_relative_jet j;
    mt_measure_relative(m, a, b, second, kept, &j);
    mt_relative_expand(&j, out);
}

mt_cx mt_measure_value(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                       mt_beam_parts *kept)
{
    mt_relative_jet j;
    mt_measure_relative(m, a, b, false, kept, &j);
    return j.value;
}

void mt_measure_relative_point(const mt_cx *s, const mt_cx *f, const mt_pose *a,
                               bool with_second, mt_relative_jet *out)
{
    const mt_second second = with_second ? MT_SECOND_ALL : MT_SECOND_NONE;
    mt_cx w[3];
    mt_cx n[3];
    mt_relative_clear(out, second, MT_SPAN_CHORD | MT_SPAN_TURN_A, false);
    cx_rotate3(a->r, s != NULL ? s : ZERO3, w);
    out->value = cx_dot3(f, a->x) + cx_dot3(f, w);
    mt_relative_add_vec(out->g + MT_AT_CHORD, -1.0, f);
    cx_cross3(w, f, n);
    mt_relative_add_vec(out->g + MT_AT_TURN_A, 1.0, n);
    if (with_second) {
        mt_relative_add_rotation(out, MT_AT_TURN_A, 1.0, f, w);
    }
}

void mt_measure_point(const mt_cx *s, const mt_cx *f, const mt_pose *a, bool second,
                      mt_jet *out)
{
    mt_relative_jet j;
    mt_measure_relative_point(s, f, a, second, &j);
    mt_relative_expand(&j, out);
    for (int k = 6; k < 9; k++) {
        out->g[k] = 0.0; /* of the ground */
    }
}
