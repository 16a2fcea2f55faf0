/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESPONSE_FORCED_H
#define RESPONSE_FORCED_H

/*
 * Matrices of forced vibration about an equilibrium; motions e^{i w t}, s = i w, w > 0:
 *     (s^2 M + s C + K + i H) x = [B_0 + s B_1 + s^2 B_2] u,
 *     y = [S_0 + s S_1 + s^2 S_2] x + [D_0 + s D_1 + s^2 D_2 + E_1/s + E_2/s^2] u.
 * K, M, C (viscous damping) and H (structural damping: loss factor times stiffness) are real
 * symmetric, n x n, column-major, both triangles. Powers of s are time derivatives: an output
 * acceleration uses S_2, a prescribed ground displacement u acts through B_2 (an acceleration
 * through B_0). E: motion in space of a point on the ground, where u is the ground's
 * acceleration or velocity.
 */
enum { MT_FORCED_POWERS = 3 };

typedef struct mt_forced {
    int n;
    const double *k;
    const double *m;
    const double *c; /* NULL: no viscous damping */
    const double *h; /* NULL: no structural damping */
    int n_in;
    int n_out;
    const double *b[MT_FORCED_POWERS]; /* n x n_in; NULL: 0 */
    const double *s[MT_FORCED_POWERS]; /* n x n_out: column o is the row of output o; NULL: 0 */
    const double *s_im; /* n x n_out: imaginary part of S_0 (a lossy spring's force); NULL: 0 */
    const double *d[MT_FORCED_POWERS]; /* n_out x n_in; NULL: 0 */
    const double *d_im;                /* n_out x n_in: imaginary part of D_0; NULL: 0 */
    const double *e[2];                /* n_out x n_in: E_1, E_2; NULL: 0 */
} mt_forced;

#endif
