/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_SPECTRAL_H
#define VIBRATION_SPECTRAL_H

#include "environment/vibration.h"
#include "vibration/frf.h"

enum { MT_GAUSS_NODES = 24 };

/* A part of a range of frequencies on which a response is smooth. */
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

/*
 * Response to stationary random excitation: an input with the one-sided density G(f), straight
 * between its breakpoints in log-log scales and 0 outside, gives an output with
 *     G_y(f) = |H(2 pi f)|^2 G(f),        RMS^2 = integral of G_y df.
 * Each segment takes the method with the smaller error bound:
 *   - in closed form, |H|^2 in partial fractions over the poles and their conjugates: O(n)
 *     logarithms for each segment, and a few nodes where G is not constant;
 *   - by Gauss's rule on panels that are halved towards the resonances (see spectral.c),
 *     whose terms are all positive: it is as exact as H itself.
 * A bound includes rounding and truncation; poles and residues are taken as exact.
 */
typedef struct mt_spectral {
    const mt_pole_sum *sum;
    mt_frf h;
    mt_gauss gauss;
    double complex *rest; /* [n] conj H at p_k without the pole's own conjugate */
    double *rest_size;    /* size of its summands */
} mt_spectral;

typedef enum mt_spectral_method {
    MT_SPECTRAL_BEST,
    MT_SPECTRAL_CLOSED,
    MT_SPECTRAL_PANELS
} mt_spectral_method;

typedef struct mt_spectral_answer {
    mt_forced_end end; /* numbers are NaN where it is not MT_FORCED_FINITE */
    int pole;          /* index of the responsible pole; else -1 */
    double rms;        /* [unit of H times unit of the input] */
    double bound;      /* bound of |error of rms| */
    int n_closed;      /* number of segments in closed form */
} mt_spectral_answer;

/* Prepare a pole sum, which is borrowed, for densities and RMS; all in mem. Residues of
 * undamped poles that are rounding only should be 0. Fails: MT_E_DOMAIN, MT_E_MEMORY.
 * O(n^2). */
mt_status mt_spectral_init(mt_spectral *r, const mt_pole_sum *sum, mt_arena *mem, mt_err *err);

/* The density of the response at a frequency [Hz]; 0 outside of the input's. Infinite at an
 * undamped pole. */
double mt_spectral_psd(const mt_spectral *r, const mt_psd *input, double hz);

mt_spectral_answer mt_spectral_rms(const mt_spectral *r, const mt_psd *input,
                                   mt_spectral_method way);

/* Bound of the error of the root of a number, from the bound of that number's error. */
double mt_spectral_root_bound(double bound, double root);

/*
 * The derivative of the RMS for any change dH of the response:
 *     d RMS = Re integral conj(H) dH G df / RMS = Re sum_i weight_i dH(w_i) + error,
 * exact to 1e-15 sum_i |weight_i dH(w_i)| where dH is a sum over the same poles, single and
 * double (as by changes of poles and residues), except for the rounding of w_i next to narrow
 * resonances: eps w_i / (damping of the pole) of dH.
 */
typedef struct mt_spectral_nodes {
    int n;
    double *omega;          /* [n] [rad/s] */
    double complex *weight; /* [n] */
} mt_spectral_nodes;
/* The nodes of the derivative, in mem; none where the RMS is 0 or not finite. */
mt_status mt_spectral_slope_nodes(const mt_spectral *r, const mt_psd *input, mt_arena *mem,
                                  mt_spectral_nodes *out, mt_err *err);

/*
 * The derivative of the RMS by poles and residues:
 *     d RMS = Re [ sum_k (by_s_k ds_k + by_residue_k dr_k) + sum_j by_d_j dd_j ],
 * of the pole sum, each conjugate on its own.
 * @param[out] by_s, by_residue  sum->n; 0 of poles that are left out (undamped, residue 0)
 * @param[out] by_d              3
 */
void mt_spectral_slopes(const mt_spectral *r, const mt_psd *input, double complex *by_s,
                        double complex *by_residue, double complex *by_d);

#endif
