/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_PANELS_H
#define VIBRATION_PANELS_H

#include "vibration/frf.h"

/*
 * An interval of frequencies cut into panels on which a response is smooth. A panel with centre
 * c and half width h has Bernstein ellipses: foci at its ends, semi-axes (r +- 1/r) h / 2. A
 * function that is analytic within the ellipse r and at most M there is integrated by Gauss's
 * rule with n nodes to
 *     |error| <= (64/15) M h r^(-2 n) / (1 - r^(-2))     (Trefethen, SIAM Review 50, 2008)
 * Panels are halved until all poles, their conjugates and, for powers of w, 0 lie outside the
 * ellipse MT_PANEL_CLEAR; bounds are taken on MT_PANEL_INNER. The ends of a panel are stored as
 * distances from the nearest pole (or end of the interval), so that the distance from a pole
 * has all its digits for any narrow resonance.
 */
#define MT_PANEL_CLEAR 3.0
#define MT_PANEL_INNER 2.5
enum { MT_GAUSS_NODES = 24 };

typedef struct mt_panel {
    double anchor; /* from anchor + a to anchor + b [rad/s] */
    double a;
    double b;
} mt_panel;

/* Gauss's rule on [-1, 1]. */
typedef struct mt_gauss {
    double node[MT_GAUSS_NODES];
    double weight[MT_GAUSS_NODES];
} mt_gauss;

void mt_panels_gauss(mt_gauss *g);

/* Iterator over the panels of [lower, upper], one after another: mt_panels_begin, then
 * mt_panels_next until it returns false. */
enum { MT_PANEL_DEPTH = 96 };
typedef struct mt_panels {
    const mt_frf *h;
    double upper;
    double exponent;
    double at;   /* the anchor of the last half */
    double next; /* the following one */
    bool right;  /* the half that ends at `next` has not been returned yet */
    bool narrow; /* halving reached its limit: a pole lies on the interval */
    int depth;
    mt_panel stack[MT_PANEL_DEPTH];
} mt_panels;

/* The integrand is the response, its conjugate and w^exponent. */
void mt_panels_begin(mt_panels *p, const mt_frf *h, double lower, double upper,
                     double exponent);
bool mt_panels_next(mt_panels *p, mt_panel *out);

/* True where the pole lies outside the ellipse `clear` of the panel. */
bool mt_panels_clears(const mt_frf *h, int k, const mt_panel *panel, double clear);
/* A bound of |H| on the ellipse MT_PANEL_INNER of a panel whose ellipse MT_PANEL_CLEAR contains
 * no pole. */
double mt_panels_bound(const mt_frf *h, const mt_panel *panel);
/* The truncation error of Gauss's rule divided by M h, see above. */
double mt_panels_truncation(void);

#endif
