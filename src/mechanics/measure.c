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

const mt_jet_list *mt_jet_filled(mt_second second)
{
    static const mt_jet_list lists[] = {
        [MT_SECOND_NONE] = {0, {0}},
        [MT_SECOND_PLANE] = {6, {0, 1, 5, 6, 7, 11}},
        [MT_SECOND_ALL] = {MT_LOCAL, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}},
    };
    return &lists[second];
}

void mt_jet_clear(mt_jet *j, mt_second second)
{
    j->value = 0.0;
    memset(j->g, 0, sizeof j->g);
    if (second) {
        memset(j->h, 0, sizeof j->h);
    }
    j->second = second;
}

/* h[block (p, q), both rotations] += scale (alpha I + beta s t^T); with `mirror` also its
 * transpose in block (q, p). */
static void add_block(mt_jet *j, const int at[2], mt_cx alpha, mt_cx beta, const mt_cx *s,
                      const mt_cx *t)
{
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    for (int c = first; c < 3; c++) {
        for (int r = first; r < 3; r++) {
            mt_cx v = cx_mul(beta, cx_mul(s[r], t[c]));
            if (r == c) {
                v += alpha;
            }
            j->h[at[0] + r + (MT_LOCAL * (at[1] + c))] += v;
            if (at[0] != at[1]) {
                j->h[at[1] + c + (MT_LOCAL * (at[0] + r))] += v;
            }
        }
    }
}

/* Diagonal block of scale n . w: scale [1/2 (n w^T + w n^T) - (n . w) I]. */
void mt_jet_add_rotation_block(mt_jet *j, int at, mt_cx scale, const mt_cx *n, const mt_cx *w)
{
    const int block[2] = {at, at};
    add_block(j, block, cx_mul(-scale, cx_dot3(n, w)), 0.5 * scale, n, w);
    add_block(j, block, 0.0, 0.5 * scale, w, n);
}

/* Block (theta at p, dx at q) of scale (theta x u) . dx = scale theta . (u x dx): scale [u]x,
 * and its transpose. */
void mt_jet_add_cross_block(mt_jet *j, int p, int q, mt_cx scale, const mt_cx *u)
{
    const mt_cx m[9] = {0.0, u[2], -u[1], -u[2], 0.0, u[0], u[1], -u[0], 0.0};
    const bool plane = j->second == MT_SECOND_PLANE; /* theta about z, dx in x and y */
    for (int c = 0; c < (plane ? 2 : 3); c++) {
        for (int r = plane ? 2 : 0; r < 3; r++) {
            const mt_cx v = cx_mul(scale, m[r + (3 * c)]);
            j->h[p + r + (MT_LOCAL * (q + c))] += v;
            j->h[q + c + (MT_LOCAL * (p + r))] += v;
        }
    }
}

void mt_jet_add_vec(mt_cx *g, mt_cx scale, const mt_cx *v)
{
    for (int i = 0; i < 3; i++) {
        g[i] += cx_mul(scale, v[i]);
    }
}

/* j += scale (u . v), u on a, v on b, both already rotated. */
static void add_dot(mt_jet *j, mt_cx scale, const mt_cx *u, const mt_cx *v)
{
    mt_cx n[3];
    j->value += cx_mul(scale, cx_dot3(u, v));
    cx_cross3(u, v, n);
    mt_jet_add_vec(j->g + 3, scale, n);
    mt_jet_add_vec(j->g + 9, -scale, n);
    if (j->second) {
        const int mixed[2] = {3, 9};
        mt_jet_add_rotation_block(j, 3, scale, u, v);
        mt_jet_add_rotation_block(j, 9, scale, u, v);
        add_block(j, mixed, cx_mul(scale, cx_dot3(u, v)), -scale, v, u);
    }
}

/* j += scale u . (Q - P); s, t: P - x_a and Q - x_b rotated; d = x_b - x_a. P moves with a as u
 * does, so u . s is constant. */
static void add_plane(mt_jet *j, mt_cx scale, const mt_cx *u, const mt_cx *s, const mt_cx *t,
                      const mt_cx *d)
{
    mt_cx w[3];
    mt_cx n[3];
    for (int i = 0; i < 3; i++) {
        w[i] = d[i] + t[i];
    }
    j->value += cx_mul(scale, cx_dot3(u, w) - cx_dot3(u, s));
    mt_jet_add_vec(j->g, -scale, u);
    mt_jet_add_vec(j->g + 6, scale, u);
    cx_cross3(u, w, n);
    mt_jet_add_vec(j->g + 3, scale, n);
    cx_cross3(t, u, n);
    mt_jet_add_vec(j->g + 9, scale, n);
    if (j->second) {
        const int mixed[2] = {3, 9};
        mt_jet_add_rotation_block(j, 3, scale, u, w);
        mt_jet_add_cross_block(j, 3, 0, -scale, u);
        mt_jet_add_cross_block(j, 3, 6, scale, u);
        add_block(j, mixed, cx_mul(scale, cx_dot3(u, t)), -scale, t, u);
        mt_jet_add_rotation_block(j, 9, scale, u, t);
    }
}

void mt_jet_chain(const mt_chain2 *c, const mt_jet *p, const mt_jet *q, mt_jet *out)
{
    out->value = c->f;
    out->second = p->second;
    for (int i = 0; i < MT_LOCAL; i++) {
        out->g[i] = cx_mul(c->fp, p->g[i]) + cx_mul(c->fq, q->g[i]);
    }
    const mt_jet_list *const l = mt_jet_filled(p->second);
    for (int kk = 0; kk < l->n; kk++) {
        const int k = l->at[kk];
        const mt_cx a = cx_mul(c->fpp, p->g[k]) + cx_mul(c->fpq, q->g[k]);
        const mt_cx b = cx_mul(c->fpq, p->g[k]) + cx_mul(c->fqq, q->g[k]);
        for (int ii = 0; ii < l->n; ii++) {
            const int i = l->at[ii];
            const int at = i + (MT_LOCAL * k);
            out->h[at] = cx_mul(c->fp, p->h[at]) + cx_mul(c->fq, q->h[at]) +
                         cx_mul(a, p->g[i]) + cx_mul(b, q->g[i]);
        }
    }
}

/* A distance of 0 has no direction: its value, without derivatives. */
static void distance_none(double value, mt_second second, mt_jet *out)
{
    const mt_cx none = cx_pair(nan(""), nan(""));
    out->value = cx_pair(value, nan(""));
    for (int i = 0; i < MT_LOCAL; i++) {
        out->g[i] = none;
    }
    for (int i = 0; second && i < MT_LOCAL * MT_LOCAL; i++) {
        out->h[i] = none;
    }
}

/* |r| with r = Q - P, u = r / |r|: gradient u^T J, Hessian (J^T J - g g^T) / |r| + u . d2r. */
void mt_jet_distance(const mt_cx *s, const mt_cx *t, const mt_cx *d, mt_second second,
                     mt_jet *out)
{
    mt_cx r[3];
    mt_cx u[3];
    mt_cx n[3];
    mt_jet_clear(out, second);
    for (int i = 0; i < 3; i++) {
        r[i] = d[i] + t[i] - s[i];
    }
    const mt_cx length = cx_norm3(r);
    if (!(creal(length) > 0.0)) {
        distance_none(creal(length), second, out);
        return;
    }
    for (int i = 0; i < 3; i++) {
        u[i] = cx_div(r[i], length);
    }
    out->value = length;
    mt_jet_add_vec(out->g, -1.0, u);
    mt_jet_add_vec(out->g + 6, 1.0, u);
    cx_cross3(s, u, n);
    mt_jet_add_vec(out->g + 3, -1.0, n);
    cx_cross3(t, u, n);
    mt_jet_add_vec(out->g + 9, 1.0, n);
    if (!second) {
        return;
    }
    /* columns of J: dr = dx_b - dx_a + theta_b x t - theta_a x s */
    mt_cx jac[MT_LOCAL][3];
    for (int k = 0; k < 3; k++) {
        mt_cx e[3] = {0.0, 0.0, 0.0};
        e[k] = 1.0;
        for (int i = 0; i < 3; i++) {
            jac[k][i] = -e[i];
            jac[6 + k][i] = e[i];
        }
        cx_cross3(s, e, jac[3 + k]); /* -(e x s) */
        cx_cross3(e, t, jac[9 + k]);
    }
    const mt_jet_list *const l = mt_jet_filled(second);
    for (int kk = 0; kk < l->n; kk++) {
        const int k = l->at[kk];
        for (int ii = 0; ii < l->n; ii++) {
            const int i = l->at[ii];
            const mt_cx v = cx_dot3(jac[i], jac[k]) - cx_mul(out->g[i], out->g[k]);
            out->h[i + (MT_LOCAL * k)] = cx_div(v, length);
        }
    }
    mt_jet_add_rotation_block(out, 3, -1.0, u, s);
    mt_jet_add_rotation_block(out, 9, 1.0, u, t);
}

/* atan2(p, q). */
static void atan2_jet(const mt_jet *p, const mt_jet *q, mt_jet *out)
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
    mt_jet_chain(&c, p, q, out);
}

/* p = c_a . b_b, q = b_a . b_b. */
static void angle_jet(const mt_cx *b_a, const mt_cx *c_a, const mt_cx *b_b, mt_second second,
                      mt_jet *out)
{
    mt_jet p;
    mt_jet q;
    mt_jet_clear(&p, second);
    mt_jet_clear(&q, second);
    add_dot(&p, 1.0, c_a, b_b);
    add_dot(&q, 1.0, b_a, b_b);
    atan2_jet(&p, &q, out);
}

/* p = e3 . f2 - e2 . f3, q = e2 . f2 + e3 . f3: of the quaternion of the turn from e to f, p =
 * 4 q0 q1, q = 2 (q0^2 - q1^2). */
void mt_jet_twist(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, mt_jet *out)
{
    mt_jet p;
    mt_jet q;
    mt_jet_clear(&p, second);
    mt_jet_clear(&q, second);
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

/* xi_k = g(cos) psi_k with psi_k = sin * axis_k from the skew part of Q_ij = e_i(a) . e_j(b),
 * cos from its trace. */
void mt_jet_rotation(mt_cx (*e)[3], mt_cx (*f)[3], int k, mt_second second, mt_jet *out)
{
    mt_jet psi;
    mt_jet cosine;
    mt_cx g[3];
    const int k1 = (k + 1) % 3;
    const int k2 = (k + 2) % 3;
    mt_jet_clear(&psi, second);
    mt_jet_clear(&cosine, second);
    add_dot(&psi, 0.5, e[k2], f[k1]);
    add_dot(&psi, -0.5, e[k1], f[k2]);
    for (int i = 0; i < 3; i++) {
        add_dot(&cosine, 0.5, e[i], f[i]);
    }
    cosine.value -= 0.5;
    mt_angle_over_sine(cosine.value, g);
    const mt_chain2 c = {
        .f = cx_mul(g[0], psi.value),
        .fp = g[0],
        .fq = cx_mul(g[1], psi.value),
        .fpp = 0.0,
        .fpq = g[1],
        .fqq = cx_mul(g[2], psi.value),
    };
    mt_jet_chain(&c, &psi, &cosine, out);
}

/* Whether the parts are those of this element, here, with as much of the Hessian. */
static bool has_parts(const mt_beam_parts *p, const mt_measure_data *m, const mt_pose *a,
                      const mt_pose *b, mt_second second)
{
    return p->dir == m->dir[0] && p->dir != NULL && p->pose[0] == a && p->pose[1] == b &&
           p->length.second == second;
}

static void beam_jet(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                     mt_second second, mt_beam_parts *parts, mt_jet *out)
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
        mt_jet_beam_parts(m, e, f, d, second, parts);
        parts->dir = m->dir[0];
        parts->pose[0] = a;
        parts->pose[1] = b;
    }
    mt_jet_clear(out, second);
    mt_jet_beam(m, parts, out);
}

void mt_measure_eval(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                     bool with_second, mt_beam_parts *kept, mt_jet *out)
{
    const mt_second second = !with_second ? MT_SECOND_NONE
                             : m->plane   ? MT_SECOND_PLANE
                                          : MT_SECOND_ALL;
    mt_cx p[4][3]; /* -, s, t, d */
    mt_cx e[3][3];
    mt_cx f[3][3];
    if (m->kind == MT_MEASURE_BEAM) {
        mt_beam_parts own;
        own.dir = NULL;
        beam_jet(m, a, b, second, kept != NULL ? kept : &own, out);
        return;
    }
    cx_rotate3(a->r, m->point[0] != NULL ? m->point[0] : ZERO3, p[1]);
    cx_rotate3(b->r, m->point[1] != NULL ? m->point[1] : ZERO3, p[2]);
    for (int i = 0; i < 3; i++) {
        p[3][i] = b->x[i] - a->x[i];
        if (m->dir[i] != NULL) {
            cx_rotate3(a->r, m->dir[i], e[i]);
            cx_rotate3(b->r, m->dir[i], f[i]);
        }
    }
    mt_jet_clear(out, second);
    switch (m->kind) {
    case MT_MEASURE_PLANE:
        add_plane(out, 1.0, e[0], p[1], p[2], p[3]);
        break;
    case MT_MEASURE_DOT:
        add_dot(out, 1.0, e[0], f[1]);
        break;
    case MT_MEASURE_DISTANCE:
        mt_jet_distance(p[1], p[2], p[3], second, out);
        break;
    case MT_MEASURE_ANGLE:
        angle_jet(e[0], e[1], f[0], second, out);
        out->value += TURN * rint((m->near - creal(out->value)) / TURN);
        break;
    case MT_MEASURE_ROTATION:
        mt_jet_rotation(e, f, m->component, second, out);
        break;
    case MT_MEASURE_BEAM:
        break;
    }
}

mt_cx mt_measure_value(const mt_measure_data *m, const mt_pose *a, const mt_pose *b,
                       mt_beam_parts *kept)
{
    mt_jet j;
    mt_measure_eval(m, a, b, false, kept, &j);
    return j.value;
}

void mt_measure_point(const mt_cx *s, const mt_cx *f, const mt_pose *a, bool with_second,
                      mt_jet *out)
{
    const mt_second second = with_second ? MT_SECOND_ALL : MT_SECOND_NONE;
    mt_cx w[3];
    mt_cx n[3];
    mt_jet_clear(out, second);
    cx_rotate3(a->r, s != NULL ? s : ZERO3, w);
    out->value = cx_dot3(f, a->x) + cx_dot3(f, w);
    mt_jet_add_vec(out->g, 1.0, f);
    cx_cross3(w, f, n);
    mt_jet_add_vec(out->g + 3, 1.0, n);
    if (second) {
        mt_jet_add_rotation_block(out, 3, 1.0, f, w);
    }
}
