/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Arithmetic of jets in the nine relative freedoms. Where no number carries a derivative the
 * sums over a Hessian are real: the same operations on the real parts, to the same bits.
 */
#include "mechanics/measure.h"

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* Vectors named u, v, w, s, t, d are rotated already. */

/* f(p, q) and its partial derivatives. */
typedef struct chain2 {
    mt_cx f;
    mt_cx fp;
    mt_cx fq;
    mt_cx fpp;
    mt_cx fpq;
    mt_cx fqq;
} chain2;

/* First of the three freedoms of each among the nine, and their bits in a span. */
enum { AT_CHORD = 0, AT_TURN_A = 3, AT_TURN_B = 6 };

enum {
    SPAN_CHORD = 1,
    SPAN_TURN_A = 2,
    SPAN_TURN_B = 4,
    SPAN_TURNS = SPAN_TURN_A | SPAN_TURN_B,
    SPAN_ALL = SPAN_CHORD | SPAN_TURNS
};

static void relative_distance(const mt_cx *s, const mt_cx *t, const mt_cx *d, unsigned moving,
                              mt_second second, bool real, mt_relative_jet *out);
static void relative_cosine(mt_cx (*e)[3], mt_cx (*f)[3], unsigned moving, mt_second second,
                            bool real, mt_cx g[3], mt_relative_jet *out);
static void relative_rotation(mt_cx (*e)[3], mt_cx (*f)[3], int k,
                              const mt_relative_jet *cosine, const mt_cx g[3],
                              mt_relative_jet *out);
static void relative_twist(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, bool real,
                           mt_relative_jet *out);
static void angle_over_sine(mt_cx c, mt_cx g[3]);

/* [in the plane][span] */
static const mt_relative_list LISTS[2][SPAN_ALL + 1] = {
    {{0, {0}},
     {3, {0, 1, 2}},
     {3, {3, 4, 5}},
     {6, {0, 1, 2, 3, 4, 5}},
     {3, {6, 7, 8}},
     {6, {0, 1, 2, 6, 7, 8}},
     {6, {3, 4, 5, 6, 7, 8}},
     {9, {0, 1, 2, 3, 4, 5, 6, 7, 8}}},
    {{0, {0}},
     {2, {0, 1}},
     {1, {5}},
     {3, {0, 1, 5}},
     {1, {8}},
     {3, {0, 1, 8}},
     {2, {5, 8}},
     {4, {0, 1, 5, 8}}},
};

const mt_relative_list *mt_relative_filled(mt_second second, unsigned span)
{
    return second == MT_SECOND_NONE ? &LISTS[0][0] : &LISTS[second == MT_SECOND_PLANE][span];
}

/* real: nothing that is added has a derivative. */
static void relative_clear(mt_relative_jet *j, mt_second second, unsigned span, bool real)
{
    j->value = 0.0;
    memset(j->g, 0, sizeof j->g);
    if (second) {
        memset(j->h, 0, sizeof j->h);
    }
    j->second = second;
    j->span = span;
    j->real = real;
}

/* g[0..2] += scale v. */
static void relative_add_vec(mt_cx *g, double scale, const mt_cx *v)
{
    for (int i = 0; i < 3; i++) {
        g[i] += scale * v[i];
    }
}

/* True where the body with this theta offset turns. */
static bool has_turn(const mt_relative_jet *j, int at)
{
    return (j->span & (at == AT_TURN_A ? SPAN_TURN_A : SPAN_TURN_B)) != 0;
}

/* Diagonal block at theta offset `at` of scale n . w (w rotates): scale [1/2 (n w^T + w n^T) -
 * (n . w) I]. */
static void relative_add_rotation(mt_relative_jet *j, int at, double scale, const mt_cx *n,
                                  const mt_cx *w)
{
    const mt_cx dot = scale * cx_dot3(n, w);
    const double half = 0.5 * scale;
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    for (int r = has_turn(j, at) ? first : 3; r < 3; r++) {
        mt_cx *const row = j->h + mt_relative_row(at + r) + at;
        for (int c = first; c <= r; c++) {
            if (j->real) {
                const double one = half * (creal(n[r]) * creal(w[c]));
                const double other = half * (creal(w[r]) * creal(n[c]));
                row[c] = row[c] + (one - (r == c ? creal(dot) : 0.0)) + other;
            } else {
                row[c] += (half * cx_mul(n[r], w[c])) - (r == c ? dot : 0.0);
                row[c] += half * cx_mul(w[r], n[c]);
            }
        }
    }
}

/* Block (theta at offset `at`, dd) of (theta x u) . dd = theta . (u x dd): [u]x. */
static void relative_add_cross(mt_relative_jet *j, int at, const mt_cx *u)
{
    const mt_cx m[9] = {0.0, u[2], -u[1], -u[2], 0.0, u[0], u[1], -u[0], 0.0};
    const bool plane = j->second == MT_SECOND_PLANE; /* theta about z, dd in x and y */
    for (int r = !has_turn(j, at) ? 3 : plane ? 2 : 0; r < 3; r++) {
        mt_cx *const row = j->h + mt_relative_row(at + r) + AT_CHORD;
        for (int c = 0; c < (plane ? 2 : 3); c++) {
            row[c] += m[r + (3 * c)];
        }
    }
}

/* out += scale p. */
static void relative_add(mt_relative_jet *out, double scale, const mt_relative_jet *p)
{
    out->span |= p->span;
    out->real = out->real && p->real;
    out->value += scale * p->value;
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] += scale * p->g[i];
    }
    const mt_relative_list *const l = mt_relative_filled(out->second, p->span);
    for (int ii = 0; ii < l->n; ii++) {
        const int row = mt_relative_row(l->at[ii]);
        for (int kk = 0; kk <= ii; kk++) {
            out->h[row + l->at[kk]] += scale * p->h[row + l->at[kk]];
        }
    }
}

/*
 * A row of a Hessian of f(p, q), entries k of the list up to row i:
 *     h_ik (+)= fp p_ik + fq q_ik + x_k p_i + z_k q_i.
 */
typedef struct second_form {
    const mt_relative_jet *p;
    const mt_relative_jet *q;
    mt_cx fp;
    mt_cx fq;
    mt_cx x[MT_RELATIVE];
    mt_cx z[MT_RELATIVE];
} second_form;

static void add_real_row(const second_form *f, int i, const mt_relative_list *l, int entries,
                         mt_cx *row)
{
    const mt_cx *const p = f->p->h + mt_relative_row(i);
    const mt_cx *const q = f->q->h + mt_relative_row(i);
    const double fp = creal(f->fp);
    const double fq = creal(f->fq);
    const double pi = creal(f->p->g[i]);
    const double qi = creal(f->q->g[i]);
    for (int n = 0; n < entries; n++) {
        const int k = l->at[n];
        row[k] += (fp * creal(p[k])) + (fq * creal(q[k])) + (creal(f->x[k]) * pi) +
                  (creal(f->z[k]) * qi);
    }
}

static void add_second_form_row(const second_form *f, int i, const mt_relative_list *l,
                                int entries, mt_cx *row)
{
    const mt_cx *const p = f->p->h + mt_relative_row(i);
    const mt_cx *const q = f->q->h + mt_relative_row(i);
    for (int n = 0; n < entries; n++) {
        const int k = l->at[n];
        row[k] += cx_mul(f->fp, p[k]) + cx_mul(f->fq, q[k]) + cx_mul(f->x[k], f->p->g[i]) +
                  cx_mul(f->z[k], f->q->g[i]);
    }
}

static void add_second(const second_form *f, mt_relative_jet *out)
{
    const mt_relative_list *const l = mt_relative_filled(out->second, f->p->span | f->q->span);
    for (int n = 0; n < l->n; n++) {
        mt_cx *const row = out->h + mt_relative_row(l->at[n]);
        if (out->real) {
            add_real_row(f, l->at[n], l, n + 1, row);
        } else {
            add_second_form_row(f, l->at[n], l, n + 1, row);
        }
    }
}

/* x g, to the same bits without derivatives. */
static mt_cx times(bool real, mt_cx x, mt_cx g)
{
    return real ? cx_pair(creal(x) * creal(g), 0.0) : cx_mul(x, g);
}

/* out += scale p q. */
static void relative_add_product(mt_relative_jet *out, mt_cx scale, const mt_relative_jet *p,
                                 const mt_relative_jet *q)
{
    second_form f = {.p = q, .q = p};
    out->span |= p->span | q->span;
    out->real = out->real && p->real && q->real && cimag(scale) == 0.0;
    f.fp = cx_mul(scale, p->value);
    f.fq = cx_mul(scale, q->value);
    out->value += cx_mul(f.fp, q->value);
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] += times(out->real, f.fq, p->g[i]) + times(out->real, f.fp, q->g[i]);
    }
    if (out->second) {
        for (int i = 0; i < MT_RELATIVE; i++) {
            f.x[i] = times(out->real, scale, p->g[i]);
            f.z[i] = times(out->real, scale, q->g[i]);
        }
        add_second(&f, out);
    }
}

/* out = f(p, q); out must differ from p and q. */
static void relative_chain(const chain2 *c, const mt_relative_jet *p, const mt_relative_jet *q,
                           mt_relative_jet *out)
{
    const bool real = p->real && q->real;
    second_form f = {.p = p, .q = q};
    relative_clear(out, p->second, p->span | q->span, real);
    out->value = c->f;
    f.fp = c->fp;
    f.fq = c->fq;
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] = times(real, c->fp, p->g[i]) + times(real, c->fq, q->g[i]);
    }
    if (out->second) {
        for (int i = 0; i < MT_RELATIVE; i++) {
            f.x[i] = times(real, c->fpp, p->g[i]) + times(real, c->fpq, q->g[i]);
            f.z[i] = times(real, c->fpq, p->g[i]) + times(real, c->fqq, q->g[i]);
        }
        add_second(&f, out);
    }
}

/* Expand to the twelve local freedoms. */
static void relative_expand(const mt_relative_jet *j, mt_jet *out)
{
    out->value = j->value;
    out->second = j->second;
    for (int k = 0; k < MT_LOCAL; k++) {
        out->g[k] = mt_relative_sign(k) * j->g[mt_relative_of(k)];
    }
    for (int c = 0; c < MT_LOCAL && j->second; c++) {
        for (int r = c; r < MT_LOCAL; r++) {
            const double sign = mt_relative_sign(r) * mt_relative_sign(c);
            const mt_cx v = sign * j->h[mt_relative_pair(r, c)];
            out->h[r + (MT_LOCAL * c)] = v;
            out->h[c + (MT_LOCAL * r)] = v;
        }
    }
}

/*
 * Generalised strains of a beam element between nodes A and B, a distance l apart as drawn.
 * Triads e (of A) and f (of B) were equal then, e1 along the element. With the chord d = x_B -
 * x_A, L = |d|, c = d/L:
 *     a2 = g(e1.c) (e3.c),  a3 = -g(e1.c) (e2.c)     rotation of the end A against the chord,
 *                                                    in its own triad, g(x) = acos(x)/sqrt(1 -
 *                                                    x^2)
 *     b2, b3                                         the same of the end B with f
 *     phi2, phi3                                     components of log(R_A^T R_B): rotation of
 *                                                    one end against the other
 *     phi1                                           twist: what is left about e1 when the
 *                                                    shortest turn from e1 to f1 has been taken
 *                                                    off
 *     s2 = a2 + b2,  s3 = a3 + b3.
 * Between the ends, relative to the chord, with y = 2 x/l - 1 and Legendre polynomials P(y), mu
 * = 1/(1 + Phi), Phi = 12 E I/(k A G l^2) (mu = 1: Euler-Bernoulli),
 *     w2' = phi3 y/2 + mu3 s3/2 P2,   w3' = -(phi2 y/2 + mu2 s2/2 P2),   theta1 = phi1 y/2,
 * the exact static solution under end forces. Put into the strains of a rod to second order
 * (curvatures K = R^T R', elongation u' + w'^2/2, twist of the fibres), each taken in the mean
 * over the element against the force that is conjugate to it, these are
 *     STRETCH  L - l + L/2 [phi3^2/12 + (mu3 s3)^2/20 + phi2^2/12 + (mu2 s2)^2/20] +
 *         (I2 + I3)/A phi1^2/(2 l)
 *     TWIST    phi1 + (mu2 s2 phi3 - mu3 s3 phi2)/2 - phi1 (mu3 phi2^2 + mu2 phi3^2)/4
 *     BEND_3   phi3 - mu2 phi1 s2/2          BEND_2  phi2 + mu3 phi1 s3/2
 *     SWAY_3   s3 + phi1 phi2/3              SWAY_2  s2 - phi1 phi3/3.
 * (With shear N acts along the slope w' of the axis, not of the sections: Engesser's column, P
 * = P_E/(1 + P_E/(k A G)).) Bernoulli's term of STRETCH is 1/2 of the integral of w'^2, l (2
 * a^2 - a b + 2 b^2)/30: under a normal force N it makes the consistent geometric stiffness
 * N/(30 l) [36 3l -36 3l; ...]. The last term of STRETCH is Wagner's (an outer fibre of a
 * twisted bar is longer); that of third order in TWIST turns s, which is measured in the ends'
 * own triads, into the triad halfway; the second orders of the others carry torque and bending
 * moments into the stiffness (a shaft that buckles under torque, a blade that trips sideways).
 * The energy
 *     V = 1/2 [EA/l STRETCH^2 + GJ/l TWIST^2 + EI3/l (BEND_3^2 + 3 mu3 SWAY_3^2) + EI2/l
 *         (BEND_2^2 + 3 mu2 SWAY_2^2)]
 * does not change under any motion of the whole, however large, nor when A and B change their
 * roles (e1, e2 -> -e1, -e2: BEND_3 and SWAY_2 change their sign). Its linearisation about the
 * straight element is that of Euler-Bernoulli or Timoshenko exactly.
 */

/* out = u . d, u fixed to body a (side 0) or b (side 1), d = x_b - x_a. */
static void reach_jet(int side, const mt_cx *u, const mt_cx *d, const mt_relative_jet *length,
                      mt_relative_jet *out)
{
    const int turn = side == 0 ? AT_TURN_A : AT_TURN_B;
    const unsigned span = SPAN_CHORD | (side == 0 ? SPAN_TURN_A : SPAN_TURN_B);
    mt_cx n[3];
    relative_clear(out, length->second, span, length->real);
    out->value = cx_dot3(u, d);
    relative_add_vec(out->g + AT_CHORD, 1.0, u);
    cx_cross3(u, d, n);
    relative_add_vec(out->g + turn, 1.0, n);
    if (length->second) {
        relative_add_rotation(out, turn, 1.0, u, d);
        relative_add_cross(out, turn, u);
    }
}

/* out = p/q. */
static void quotient_jet(const mt_relative_jet *p, const mt_relative_jet *q,
                         mt_relative_jet *out)
{
    const mt_cx f = cx_div(p->value, q->value);
    const mt_cx per = cx_div(1.0, q->value);
    const mt_cx per2 = cx_mul(per, per);
    const chain2 c = {.f = f,
                      .fp = per,
                      .fq = -cx_mul(f, per),
                      .fpp = 0.0,
                      .fpq = -per2,
                      .fqq = 2.0 * cx_mul(f, per2)};
    relative_chain(&c, p, q, out);
}

/* s[k] += rotation of one end against the chord, about e2 (k = 0) and e3 (k = 1); in the plane
 * about e3 alone. */
static void add_end(int side, mt_cx (*e)[3], const mt_cx *d, const mt_relative_jet *length,
                    bool plane, mt_relative_jet s[2])
{
    mt_relative_jet reach;
    mt_relative_jet cosine;
    mt_relative_jet sine;
    mt_relative_jet angle;
    mt_cx g[3];
    reach_jet(side, e[0], d, length, &reach);
    quotient_jet(&reach, length, &cosine);
    angle_over_sine(cosine.value, g);
    for (int k = plane ? 1 : 0; k < 2; k++) {
        reach_jet(side, e[k == 0 ? 2 : 1], d, length, &reach);
        quotient_jet(&reach, length, &sine);
        const chain2 c = {.f = cx_mul(g[0], sine.value),
                          .fp = g[0],
                          .fq = cx_mul(g[1], sine.value),
                          .fpp = 0.0,
                          .fpq = g[1],
                          .fqq = cx_mul(g[2], sine.value)};
        relative_chain(&c, &sine, &cosine, &angle);
        relative_add(&s[k], k == 0 ? 1.0 : -1.0, &angle);
    }
}

/* Fill the parts of the beam element with triads e (on a), f (on b) and d = x_b - x_a; compute
 * its strain m->component. */
static void beam_parts_fill(const mt_measure_data *m, mt_cx (*e)[3], mt_cx (*f)[3],
                            const mt_cx *d, mt_second second, bool real, mt_beam_parts *out)
{
    const bool plane = m->beam.plane;
    mt_relative_jet cosine;
    mt_cx g[3];
    relative_cosine(e, f, SPAN_ALL, second, real, g, &cosine);
    for (int k = plane ? 2 : 1; k < 3; k++) {
        relative_rotation(e, f, k, &cosine, g, &out->phi[k]);
    }
    if (!plane) {
        relative_twist(e, f, second, real, &out->phi[0]);
    }
    for (int k = 0; k < 2; k++) {
        relative_clear(&out->s[k], second, 0, real);
    }
    relative_distance(NULL, NULL, d, SPAN_ALL, second, real, &out->length);
    add_end(0, e, d, &out->length, plane, out->s);
    add_end(1, f, d, &out->length, plane, out->s);
}

static void stretch_jet(const mt_beam_numbers *b, const mt_beam_parts *p, mt_relative_jet *out)
{
    mt_relative_jet bow;
    relative_clear(&bow, out->second, 0, out->real);
    for (int k = b->plane ? 1 : 0; k < 2; k++) {
        const mt_cx mu2 = cx_mul(b->shape[k], b->shape[k]);
        relative_add_product(&bow, 1.0 / 24.0, &p->phi[1 + k], &p->phi[1 + k]);
        relative_add_product(&bow, mu2 / 40.0, &p->s[k], &p->s[k]);
    }
    relative_add(out, 1.0, &p->length);
    relative_add_product(out, 1.0, &p->length, &bow);
    out->value -= b->length;
    if (!b->plane) {
        relative_add_product(out, 0.5 * cx_div(b->polar, b->length), &p->phi[0], &p->phi[0]);
    }
}

/* -phi1 (mu3 phi2^2 + mu2 phi3^2)/4. */
static void twist_bow(const mt_beam_numbers *b, const mt_beam_parts *p, mt_relative_jet *out)
{
    mt_relative_jet bow;
    relative_clear(&bow, out->second, 0, out->real);
    relative_add_product(&bow, b->shape[1], &p->phi[1], &p->phi[1]);
    relative_add_product(&bow, b->shape[0], &p->phi[2], &p->phi[2]);
    relative_add_product(out, -0.25, &p->phi[0], &bow);
}

static void beam_strain_fill(const mt_measure_data *m, const mt_beam_parts *p,
                             mt_relative_jet *out)
{
    const mt_beam_numbers *const b = &m->beam;
    const int k = m->component == MT_BEAM_BEND_2 || m->component == MT_BEAM_SWAY_2 ? 0 : 1;
    const int other = 1 - k;
    const double sign = k == 1 ? 1.0 : -1.0;
    relative_clear(out, p->length.second, 0, p->length.real);
    switch ((mt_beam_strain)m->component) {
    case MT_BEAM_STRETCH:
        stretch_jet(b, p, out);
        break;
    case MT_BEAM_TWIST:
        relative_add(out, 1.0, &p->phi[0]);
        relative_add_product(out, 0.5 * b->shape[0], &p->s[0], &p->phi[2]);
        relative_add_product(out, -0.5 * b->shape[1], &p->s[1], &p->phi[1]);
        twist_bow(b, p, out);
        break;
    case MT_BEAM_BEND_2:
    case MT_BEAM_BEND_3:
        relative_add(out, 1.0, &p->phi[1 + k]);
        if (!b->plane) {
            relative_add_product(out, -0.5 * sign * b->shape[other], &p->phi[0], &p->s[other]);
        }
        break;
    case MT_BEAM_SWAY_2:
    case MT_BEAM_SWAY_3:
        relative_add(out, 1.0, &p->s[k]);
        if (!b->plane) {
            relative_add_product(out, sign / 3.0, &p->phi[0], &p->phi[1 + other]);
        }
        break;
    case MT_BEAM_STRAINS:
        break;
    }
}

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

static const double TURN = 6.283185307179586477; /* 2 pi */
static const mt_cx ZERO3[3] = {0.0, 0.0, 0.0};

/* True where both bodies turn. */
static bool has_turns(const mt_relative_jet *j)
{
    return (j->span & SPAN_TURNS) == SPAN_TURNS;
}

/* Block (theta_a, theta_b) of alpha I + beta s t^T. */
static void add_mixed(mt_relative_jet *j, mt_cx alpha, double beta, const mt_cx *s,
                      const mt_cx *t)
{
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    for (int c = first; c < 3 && has_turns(j); c++) {
        mt_cx *const row = j->h + mt_relative_row(AT_TURN_B + c) + AT_TURN_A;
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
        j->g[AT_TURN_A + k] += scale * n[k];
        j->g[AT_TURN_B + k] -= scale * n[k];
    }
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    const bool turns[2] = {has_turn(j, AT_TURN_A), has_turn(j, AT_TURN_B)};
    for (int r = j->second ? first : 3; r < 3; r++) {
        mt_cx *const a = j->h + mt_relative_row(AT_TURN_A + r) + AT_TURN_A;
        mt_cx *const b = j->h + mt_relative_row(AT_TURN_B + r) + AT_TURN_B;
        mt_cx *const mixed = b - (AT_TURN_B - AT_TURN_A);
        for (int c = first; c <= r; c++) {
            const double half = 0.5 * scale;
            const double one = (half * (u[r] * v[c])) - (r == c ? dot : 0.0);
            const double other = half * (v[r] * u[c]);
            if (turns[0]) {
                a[c] = a[c] + one + other;
            }
            if (turns[1]) {
                b[c] = b[c] + one + other;
            }
        }
        for (int c = first; c < 3 && has_turns(j); c++) {
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
    relative_add_vec(j->g + AT_TURN_A, scale, n);
    relative_add_vec(j->g + AT_TURN_B, -scale, n);
    if (j->second) {
        relative_add_rotation(j, AT_TURN_A, scale, u, v);
        relative_add_rotation(j, AT_TURN_B, scale, u, v);
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
    relative_add_vec(j->g + AT_CHORD, 1.0, u);
    cx_cross3(u, w, n);
    relative_add_vec(j->g + AT_TURN_A, 1.0, n);
    cx_cross3(t, u, n);
    relative_add_vec(j->g + AT_TURN_B, 1.0, n);
    if (j->second) {
        relative_add_rotation(j, AT_TURN_A, 1.0, u, w);
        relative_add_cross(j, AT_TURN_A, u);
        add_mixed(j, cx_dot3(u, t), -1.0, t, u);
        relative_add_rotation(j, AT_TURN_B, 1.0, u, t);
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
        memcpy(jac[AT_CHORD + k], e, sizeof e);
        cx_cross3(s, e, jac[AT_TURN_A + k]); /* -(e x s) */
        cx_cross3(e, t, jac[AT_TURN_B + k]);
    }
}

/* |d + t - s|; s and t NULL: |d|. moving: the span that is wanted. */
/* |r| with r = Q - P, u = r / |r|: gradient u^T J, Hessian (J^T J - g g^T) / |r| + u . d2r. */
static void relative_distance(const mt_cx *s, const mt_cx *t, const mt_cx *d, unsigned moving,
                              mt_second second, bool real, mt_relative_jet *out)
{
    const bool chord = s == NULL && t == NULL;
    const mt_cx *const p = s == NULL ? ZERO3 : s;
    const mt_cx *const q = t == NULL ? ZERO3 : t;
    mt_cx r[3];
    mt_cx u[3];
    mt_cx jac[MT_RELATIVE][3];
    relative_clear(out, second, moving & (chord ? SPAN_CHORD : SPAN_ALL), real);
    for (int i = 0; i < 3; i++) {
        r[i] = d[i] + q[i] - p[i];
    }
    const mt_cx length = cx_norm3(r);
    if (!(creal(length) > 0.0)) {
        out->span = SPAN_ALL;
        distance_none(creal(length), out);
        return;
    }
    for (int i = 0; i < 3; i++) {
        u[i] = cx_div(r[i], length);
    }
    out->value = length;
    relative_add_vec(out->g + AT_CHORD, 1.0, u);
    if (!chord) {
        mt_cx n[3];
        cx_cross3(p, u, n);
        relative_add_vec(out->g + AT_TURN_A, -1.0, n);
        cx_cross3(q, u, n);
        relative_add_vec(out->g + AT_TURN_B, 1.0, n);
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
        relative_add_rotation(out, AT_TURN_A, -1.0, u, p);
        relative_add_rotation(out, AT_TURN_B, 1.0, u, q);
    }
}

/* atan2(p, q). */
static void atan2_jet(const mt_relative_jet *p, const mt_relative_jet *q, mt_relative_jet *out)
{
    const mt_cx rr = cx_mul(p->value, p->value) + cx_mul(q->value, q->value);
    const mt_cx r4 = cx_mul(rr, rr);
    const mt_cx pq2 = 2.0 * cx_mul(p->value, q->value);
    const mt_cx diff = cx_mul(p->value, p->value) - cx_mul(q->value, q->value);
    const chain2 c = {
        .f = cx_atan2(p->value, q->value),
        .fp = cx_div(q->value, rr),
        .fq = -cx_div(p->value, rr),
        .fpp = -cx_div(pq2, r4),
        .fpq = cx_div(diff, r4),
        .fqq = cx_div(pq2, r4),
    };
    relative_chain(&c, p, q, out);
}

/* p = c_a . b_b, q = b_a . b_b. */
static void angle_jet(const mt_cx *b_a, const mt_cx *c_a, const mt_cx *b_b, unsigned moving,
                      mt_second second, bool real, mt_relative_jet *out)
{
    mt_relative_jet p;
    mt_relative_jet q;
    relative_clear(&p, second, moving & SPAN_TURNS, real);
    relative_clear(&q, second, moving & SPAN_TURNS, real);
    add_dot(&p, 1.0, c_a, b_b);
    add_dot(&q, 1.0, b_a, b_b);
    atan2_jet(&p, &q, out);
}

/* Twist from triad e (on a) to triad f (on b): the rotation about e1 that remains after the
 * shortest rotation from e1 to f1. */
/* p = e3 . f2 - e2 . f3, q = e2 . f2 + e3 . f3: of the quaternion of the turn from e to f, p =
 * 4 q0 q1, q = 2 (q0^2 - q1^2). */
static void relative_twist(mt_cx (*e)[3], mt_cx (*f)[3], mt_second second, bool real,
                           mt_relative_jet *out)
{
    mt_relative_jet p;
    mt_relative_jet q;
    relative_clear(&p, second, SPAN_TURNS, real);
    relative_clear(&q, second, SPAN_TURNS, real);
    add_dot(&p, 1.0, e[2], f[1]);
    add_dot(&p, -1.0, e[1], f[2]);
    add_dot(&q, 1.0, e[1], f[1]);
    add_dot(&q, 1.0, e[2], f[2]);
    atan2_jet(&p, &q, out);
}

/* Below this 1 - cos the closed forms of g = angle/sin lose digits to cancellation and a series
 * is used; its next term is of order x^8 < 1e-17 there. */
static const double SERIES_BELOW = 0.01;

/* g(c) = acos(c)/sqrt(1 - c^2), g', g''. */
/*
 * g(c) = acos(c)/sqrt(1 - c^2) satisfies (1 - c^2) g' = c g - 1, so all its derivatives follow
 * from g; near c = 1 with x = 1 - c:
 *     g = sum a_n x^n,  a_0 = 1,  a_n = a_(n-1) n/(2n + 1)      (from the same equation).
 */
static void angle_over_sine(mt_cx c, mt_cx g[3])
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

/* Cosine of the angle of the rotation from triad e (on a) to triad f (on b), (trace - 1)/2, and
 * g of it. */
/* cos from the trace of Q_ij = e_i(a) . e_j(b). */
static void relative_cosine(mt_cx (*e)[3], mt_cx (*f)[3], unsigned moving, mt_second second,
                            bool real, mt_cx g[3], mt_relative_jet *out)
{
    relative_clear(out, second, moving & SPAN_TURNS, real);
    for (int i = 0; i < 3; i++) {
        add_dot(out, 0.5, e[i], f[i]);
    }
    out->value -= 0.5;
    angle_over_sine(out->value, g);
}

/* Component k of the rotation vector of that rotation. */
/* xi_k = g(cos) psi_k with psi_k = sin * axis_k from the skew part of Q. */
static void relative_rotation(mt_cx (*e)[3], mt_cx (*f)[3], int k,
                              const mt_relative_jet *cosine, const mt_cx g[3],
                              mt_relative_jet *out)
{
    mt_relative_jet psi;
    const int k1 = (k + 1) % 3;
    const int k2 = (k + 2) % 3;
    relative_clear(&psi, cosine->second, cosine->span, cosine->real);
    add_dot(&psi, 0.5, e[k2], f[k1]);
    add_dot(&psi, -0.5, e[k1], f[k2]);
    const chain2 c = {
        .f = cx_mul(g[0], psi.value),
        .fp = g[0],
        .fq = cx_mul(g[1], psi.value),
        .fpp = 0.0,
        .fpq = g[1],
        .fqq = cx_mul(g[2], psi.value),
    };
    relative_chain(&c, &psi, cosine, out);
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
        beam_parts_fill(m, e, f, d, second, real, parts);
        parts->dir = m->dir[0];
        parts->pose[0] = a;
        parts->pose[1] = b;
    }
    beam_strain_fill(m, parts, out);
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

/* Freedoms of a Hessian: without those of the ground. */
static unsigned moving_span(const mt_measure_data *m)
{
    return SPAN_CHORD | (m->held[0] ? 0U : SPAN_TURN_A) | (m->held[1] ? 0U : SPAN_TURN_B);
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
    relative_cosine(e, f, moving_span(m), second, real, g, &cosine);
    relative_rotation(e, f, m->component, &cosine, g, out);
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
    const unsigned moving = moving_span(m);
    switch (m->kind) {
    case MT_MEASURE_PLANE:
        real = turn(a, m->dir[0], e);
        real = set_measure_vectors(m, a, b, d, s, t) && real;
        relative_clear(out, second, moving, real);
        add_plane(out, e, s, t, d);
        break;
    case MT_MEASURE_DOT:
        real = turn(a, m->dir[0], e);
        real = turn(b, m->dir[1], f) && real;
        relative_clear(out, second, moving & SPAN_TURNS, real);
        add_dot(out, 1.0, e, f);
        break;
    case MT_MEASURE_DISTANCE:
        real = set_measure_vectors(m, a, b, d, s, t);
        relative_distance(s, t, d, moving, second, real, out);
        break;
    case MT_MEASURE_ANGLE:
        real = turn(a, m->dir[0], e);
        real = turn(a, m->dir[1], s) && real;
        real = turn(b, m->dir[0], f) && real;
        angle_jet(e, s, f, moving, second, real, out);
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
    relative_expand(&j, out);
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
    relative_clear(out, second, SPAN_CHORD | SPAN_TURN_A, false);
    cx_rotate3(a->r, s != NULL ? s : ZERO3, w);
    out->value = cx_dot3(f, a->x) + cx_dot3(f, w);
    relative_add_vec(out->g + AT_CHORD, -1.0, f);
    cx_cross3(w, f, n);
    relative_add_vec(out->g + AT_TURN_A, 1.0, n);
    if (with_second) {
        relative_add_rotation(out, AT_TURN_A, 1.0, f, w);
    }
}

void mt_measure_point(const mt_cx *s, const mt_cx *f, const mt_pose *a, bool second,
                      mt_jet *out)
{
    mt_relative_jet j;
    mt_measure_relative_point(s, f, a, second, &j);
    relative_expand(&j, out);
    for (int k = 6; k < 9; k++) {
        out->g[k] = 0.0; /* of the ground */
    }
}
