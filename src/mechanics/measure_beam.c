/* SPDX-License-Identifier: GPL-3.0-or-later */
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
#include "mechanics/measure_priv.h"

/* out = u . d, u fixed to body a (side 0) or b (side 1), d = x_b - x_a. */
static void reach_jet(int side, const mt_cx *u, const mt_cx *d, const mt_relative_jet *length,
                      mt_relative_jet *out)
{
    const int turn = side == 0 ? MT_AT_TURN_A : MT_AT_TURN_B;
    const unsigned span = MT_SPAN_CHORD | (side == 0 ? MT_SPAN_TURN_A : MT_SPAN_TURN_B);
    mt_cx n[3];
    mt_relative_clear(out, length->second, span, length->real);
    out->value = cx_dot3(u, d);
    mt_relative_add_vec(out->g + MT_AT_CHORD, 1.0, u);
    cx_cross3(u, d, n);
    mt_relative_add_vec(out->g + turn, 1.0, n);
    if (length->second) {
        mt_relative_add_rotation(out, turn, 1.0, u, d);
        mt_relative_add_cross(out, turn, u);
    }
}

/* out = p/q. */
static void quotient_jet(const mt_relative_jet *p, const mt_relative_jet *q,
                         mt_relative_jet *out)
{
    const mt_cx f = cx_div(p->value, q->value);
    const mt_cx per = cx_div(1.0, q->value);
    const mt_cx per2 = cx_mul(per, per);
    const mt_chain2 c = {.f = f,
                         .fp = per,
                         .fq = -cx_mul(f, per),
                         .fpp = 0.0,
                         .fpq = -per2,
                         .fqq = 2.0 * cx_mul(f, per2)};
    mt_relative_chain(&c, p, q, out);
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
    mt_angle_over_sine(cosine.value, g);
    for (int k = plane ? 1 : 0; k < 2; k++) {
        reach_jet(side, e[k == 0 ? 2 : 1], d, length, &reach);
        quotient_jet(&reach, length, &sine);
        const mt_chain2 c = {.f = cx_mul(g[0], sine.value),
                             .fp = g[0],
                             .fq = cx_mul(g[1], sine.value),
                             .fpp = 0.0,
                             .fpq = g[1],
                             .fqq = cx_mul(g[2], sine.value)};
        mt_relative_chain(&c, &sine, &cosine, &angle);
        mt_relative_add(&s[k], k == 0 ? 1.0 : -1.0, &angle);
    }
}

void mt_beam_parts_fill(const mt_measure_data *m, mt_cx (*e)[3], mt_cx (*f)[3], const mt_cx *d,
                        mt_second second, bool real, mt_beam_parts *out)
{
    const bool plane = m->beam.plane;
    mt_relative_jet cosine;
    mt_cx g[3];
    mt_relative_cosine(e, f, second, real, g, &cosine);
    for (int k = plane ? 2 : 1; k < 3; k++) {
        mt_relative_rotation(e, f, k, &cosine, g, &out->phi[k]);
    }
    if (!plane) {
        mt_relative_twist(e, f, second, real, &out->phi[0]);
    }
    for (int k = 0; k < 2; k++) {
        mt_relative_clear(&out->s[k], second, 0, real);
    }
    mt_relative_distance(NULL, NULL, d, second, real, &out->length);
    add_end(0, e, d, &out->length, plane, out->s);
    add_end(1, f, d, &out->length, plane, out->s);
}

static void stretch_jet(const mt_beam_numbers *b, const mt_beam_parts *p, mt_relative_jet *out)
{
    mt_relative_jet bow;
    mt_relative_clear(&bow, out->second, 0, out->real);
    for (int k = b->plane ? 1 : 0; k < 2; k++) {
        const mt_cx mu2 = cx_mul(b->shape[k], b->shape[k]);
        mt_relative_add_product(&bow, 1.0 / 24.0, &p->phi[1 + k], &p->phi[1 + k]);
        mt_relative_add_product(&bow, mu2 / 40.0, &p->s[k], &p->s[k]);
    }
    mt_relative_add(out, 1.0, &p->length);
    mt_relative_add_product(out, 1.0, &p->length, &bow);
    out->value -= b->length;
    if (!b->plane) {
        mt_relative_add_product(out, 0.5 * cx_div(b->polar, b->length), &p->phi[0], &p->phi[0]);
    }
}

/* -phi1 (mu3 phi2^2 + mu2 phi3^2)/4. */
static void twist_bow(const mt_beam_numbers *b, const mt_beam_parts *p, mt_relative_jet *out)
{
    mt_relative_jet bow;
    mt_relative_clear(&bow, out->second, 0, out->real);
    mt_relative_add_product(&bow, b->shape[1], &p->phi[1], &p->phi[1]);
    mt_relative_add_product(&bow, b->shape[0], &p->phi[2], &p->phi[2]);
    mt_relative_add_product(out, -0.25, &p->phi[0], &bow);
}

void mt_beam_strain_fill(const mt_measure_data *m, const mt_beam_parts *p, mt_relative_jet *out)
{
    const mt_beam_numbers *const b = &m->beam;
    const int k = m->component == MT_BEAM_BEND_2 || m->component == MT_BEAM_SWAY_2 ? 0 : 1;
    const int other = 1 - k;
    const double sign = k == 1 ? 1.0 : -1.0;
    mt_relative_clear(out, p->length.second, 0, p->length.real);
    switch ((mt_beam_strain)m->component) {
    case MT_BEAM_STRETCH:
        stretch_jet(b, p, out);
        break;
    case MT_BEAM_TWIST:
        mt_relative_add(out, 1.0, &p->phi[0]);
        mt_relative_add_product(out, 0.5 * b->shape[0], &p->s[0], &p->phi[2]);
        mt_relative_add_product(out, -0.5 * b->shape[1], &p->s[1], &p->phi[1]);
        twist_bow(b, p, out);
        break;
    case MT_BEAM_BEND_2:
    case MT_BEAM_BEND_3:
        mt_relative_add(out, 1.0, &p->phi[1 + k]);
        if (!b->plane) {
            mt_relative_add_product(out, -0.5 * sign * b->shape[other], &p->phi[0],
                                    &p->s[other]);
        }
        break;
    case MT_BEAM_SWAY_2:
    case MT_BEAM_SWAY_3:
        mt_relative_add(out, 1.0, &p->s[k]);
        if (!b->plane) {
            mt_relative_add_product(out, sign / 3.0, &p->phi[0], &p->phi[1 + other]);
        }
        break;
    case MT_BEAM_STRAINS:
        break;
    }
}
