/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef VIBRATION_FRF_H
#define VIBRATION_FRF_H

#include "base/arena.h"
#include "response/poles.h"

/*
 * A frequency response prepared for evaluation at real frequencies w: with p_k = -i s_k and
 * rho_k = -i r_k
 *     H(w) = sum_k rho_k / (w - p_k) + c_0 + c_1 w + c_2 w^2,    p_k = re_k + i im_k,
 * where re_k is the frequency of a pole and im_k = -Re s_k its decay rate. Conjugate pairs come
 * first, as neighbours, and are summed as one fraction: it keeps all digits far from both
 * poles, where the two summands cancel each other. Undamped poles of residue 0 are left out.
 */
typedef struct mt_frf {
    int n;       /* poles that are not left out */
    int n_pairs; /* entries 2 i and 2 i + 1, i < n_pairs, are a conjugate pair */
    double *re;  /* [n] [rad/s] */
    double *im;
    double complex *rho; /* [n] */
    int *index;          /* [n] index in the pole sum */
    double *slope; /* [n_pairs] 2 Re r and 2 Re(r conj s): the numerator of the fraction is */
    double *constant; /* constant - i w slope */
    double *size;     /* [n_pairs] size of the summands of the constant */
    double complex c[3];
    int growing; /* mt_pole_sum_growing; -1: none */
} mt_frf;

/* A frequency anchor + t [rad/s] that keeps all digits of t, the distance from a nearby
 * pole. */
typedef struct mt_near {
    double anchor;
    double t;
} mt_near;

/* Why a response has no finite number. */
typedef enum mt_forced_end {
    MT_FORCED_FINITE,
    MT_FORCED_INFINITE, /* an undamped pole lies within the frequencies of the input */
    MT_FORCED_UNSTABLE  /* a pole grows without excitation: there is no steady response */
} mt_forced_end;

/* "finite", "infinite", "unstable", in the order of mt_forced_end. */
enum { MT_FORCED_ENDS = MT_FORCED_UNSTABLE + 1 };
extern const char *const mt_forced_end_names[MT_FORCED_ENDS];
const char *mt_forced_end_name(mt_forced_end end);

/* Fails: MT_E_DOMAIN (a number that is not finite), MT_E_MEMORY. O(n^2). */
mt_status mt_frf_init(mt_frf *h, const mt_pole_sum *sum, mt_arena *mem, mt_err *err);

/* H(w). size: NULL, or the sum of the summands' sizes; rounding errs by at most n + 8 units in
 * its last place. O(n). */
double complex mt_frf_value(const mt_frf *h, mt_near w, double *size);
/* H, H' and H'' by w in jet[3]. */
void mt_frf_jet(const mt_frf *h, mt_near w, double complex *jet);
/* w - p_k. */
double complex mt_frf_from_pole(const mt_frf *h, int k, mt_near w);

/* weight dH(w) = sum_k (by_s_k ds_k + by_residue_k dr_k) + sum_j by_d_j dd_j. The factors are
 * added to by_s and by_residue, as long as the pole sum, and to by_d, of length 3. */
void mt_frf_pull(const mt_frf *h, mt_near w, double complex weight, double complex *by_s,
                 double complex *by_residue, double complex *by_d);

/* The kind of the response to an input within [lower, upper] [rad/s]. Where it is not finite,
 * *pole is the index of the responsible pole in the sum. */
mt_forced_end mt_frf_judge(const mt_frf *h, double lower, double upper, int *pole);

/* re + i im, finite. */
static inline double complex mt_frf_complex(double re, double im)
{
    return re + (im * (double complex)I);
}
/* a / b, |b| far from overflow and underflow. */
double complex mt_frf_ratio(double complex a, double complex b);
/* a b, finite. */
double complex mt_frf_times(double complex a, double complex b);

#endif
