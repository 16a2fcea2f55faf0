/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Modal damping. With N = M Phi, Phi^T M Phi = I, F_j = 2 zeta_j omega_j:  C = N F N^T = M G M,
 * G = Phi F Phi^T. Of a derivative (dK, dM; kappa = Phi^T dK Phi, mu = Phi^T dM Phi)
 *     dC = dM G M + M G dM + N Q N^T,      Q = Phi^T M dG M Phi,
 * and with phi_i^T M dphi_j = (kappa_ij - lambda_j mu_ij)/(lambda_j - lambda_i), -mu_jj/2 on
 * the diagonal (Fox and Kapoor 1968; M dphi_j lies in the range of N where M is singular, too)
 *     Q_ij = [F_j (kappa_ij - lambda_j mu_ij) - F_i (kappa_ij - lambda_i mu_ij)]
 *            / (lambda_j - lambda_i)
 *          = D_ij (kappa_ij - lambda_j mu_ij) - F_i mu_ij
 *     D_ij = (F_j - F_i)/(lambda_j - lambda_i)
 *     Q_jj = dF_j - F_j mu_jj,       dF_j = 2 omega_j dzeta_j + F_j dlambda_j/(2 lambda_j).
 * Of two vibrations with one ratio, D = 2 zeta/(omega_i + omega_j): nothing cancels, and where
 * they coincide Q is that of the function F(lambda), whatever basis the cluster has.
 */
#include "analysis/damping.h"

#include <math.h>
#include <string.h>

#include "analysis/count.h"
#include "analysis/tracking.h"
#include "linalg/dense.h"
#include "mechanics/products.h"

typedef struct mt_damping_work work;

/* The ratio of each mode: by name, by index, for all. */
static mt_status find_ratios(mt_analysis *a, work *w, mt_err *err)
{
    const mt_damping_def *const d = &a->sys->damping;
    const mt_modes *const modes = &a->modes;
    const int slack = a->n_null - a->n_rigid; /* a family's vibrations of 0 Hz (count.h) */
    const bool listed = d->n_ratios > 0 || d->n_named > 0;
    if (listed && !mt_modal_indexed(modes)) {
        return mt_fail(err, MT_E_DOMAIN,
                       "configuration \"%s\" %s, so that its modes have no index and damping "
                       "ratios no mode",
                       mt_analysis_configuration(a),
                       modes->n_unstable > 0
                           ? "is unstable"
                           : "has an undecided mode (rounding hides whether it is stable)");
    }
    if (d->n_ratios > a->n_most - a->n_null) {
        return mt_fail(
            err, MT_E_INPUT,
            "damping lists ratios for %d vibration modes, but configuration \"%s\" has "
            "%d of them",
            d->n_ratios, mt_analysis_configuration(a), a->n_most - a->n_null);
    }
    for (int i = 0; i < w->r; i++) {
        const int index = listed ? mt_modal_index(modes, i) - slack : 0;
        const bool own = index >= 1 && index <= d->n_ratios;
        const bool vibrates = modes->kind[i] == MT_MODE_FLEXIBLE;
        w->ratio[i] = !vibrates ? MT_NO_NODE : own ? d->ratios[index - 1] : d->ratio;
    }
    if (d->n_named == 0) {
        return MT_OK;
    }
    mt_track *const tracks =
        mt_arena_alloc(&a->damping_mem, (size_t)d->n_named, sizeof *tracks);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    for (int i = 0; i < d->n_named; i++) {
        if (a->named_shape[i] == NULL) {
            const mt_named_mode *const m = &a->sys->model->modes[d->named[i]];
            return mt_fail(err, MT_E_INPUT,
                           "damping names mode \"%s\", vibration mode %d of configuration "
                           "\"%s\", which has none at the original design",
                           m->name.s, m->index, mt_analysis_configuration(a));
        }
    }
    MT_TRY(mt_track_match(a, d->n_named, a->named_shape, tracks, err));
    for (int i = 0; i < d->n_named; i++) {
        if (tracks[i].pos >= 0) {
            w->ratio[tracks[i].pos] = d->named_ratios[i];
        }
    }
    return MT_OK;
}

static mt_status find_modal(mt_analysis *a, work *w, mt_err *err)
{
    const mt_modes *const modes = &a->modes;
    const mt_reduced k = mt_linear_reduced(a->lin);
    const size_t n = (size_t)w->n;
    if (!a->sys->damping.modal) {
        return MT_OK;
    }
    if (modes->shaped < modes->all) {
        return mt_fail(err, MT_E_INTERNAL,
                       "damping ratios asked for after a solve without all shapes");
    }
    w->r = modes->all;
    w->zeta = mt_arena_f64(&a->damping_mem, (size_t)w->r, 1);
    w->omega = mt_arena_f64(&a->damping_mem, (size_t)w->r, 1);
    w->f = mt_arena_f64(&a->damping_mem, (size_t)w->r, 1);
    w->ratio = mt_arena_alloc(&a->damping_mem, (size_t)w->r, sizeof *w->ratio);
    w->n_phi = mt_arena_f64(&a->damping_mem, n, (size_t)w->r);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    MT_TRY(find_ratios(a, w, err));
    mt_symm(w->n, w->r, k.m, modes->y, w->n_phi);
    for (int j = 0; j < w->r; j++) {
        if (w->ratio[j] != MT_NO_NODE) {
            w->zeta[j] = mt_linear_value(a->lin, w->ratio[j]);
            w->omega[j] = sqrt(fmax(modes->lambda[j], 0.0));
            w->f[j] = 2.0 * w->zeta[j] * w->omega[j];
        }
    }
    return MT_OK;
}

static double value_or_zero(const mt_analysis *a, mt_node node)
{
    return node == MT_NO_NODE ? 0.0 : mt_linear_value(a->lin, node);
}

static double slope_of(const mt_analysis *a, mt_node node, int p)
{
    return node == MT_NO_NODE ? 0.0 : mt_linear_slope(a->lin, node, p);
}

/* c += alpha M + beta K + N F N^T. */
static mt_status add_to_dampers(mt_analysis *a, work *w, mt_err *err)
{
    const mt_damping_def *const d = &a->sys->damping;
    const mt_reduced k = mt_linear_reduced(a->lin);
    const ptrdiff_t n = w->n;
    const double alpha = value_or_zero(a, d->mass);
    const double beta = value_or_zero(a, d->stiffness);
    double *const nf = mt_arena_f64(&a->damping_mem, (size_t)n, (size_t)w->r);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    for (ptrdiff_t i = 0; i < n * n; i++) {
        w->c[i] += (alpha * k.m[i]) + (beta * k.k[i]);
    }
    for (ptrdiff_t j = 0; j < w->r; j++) {
        for (ptrdiff_t i = 0; i < n; i++) {
            nf[i + (j * n)] = w->f[j] * w->n_phi[i + (j * n)];
        }
    }
    if (w->r > 0) {
        mt_gemm(false, true, w->n, w->n, w->r, 1.0, nf, w->n, w->n_phi, w->n, 1.0, w->c, w->n);
        mt_symmetrise_lower(w->n, w->c);
    }
    return MT_OK;
}

/* Once for each solve. */
static mt_status prepare_damping_work(mt_analysis *a, work **out, mt_err *err)
{
    *out = a->damping;
    if (*out != NULL) {
        return MT_OK;
    }
    mt_arena_clear(&a->damping_mem);
    work *const w = mt_arena_alloc(&a->damping_mem, 1, sizeof *w);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    w->n = mt_linear_freedoms(a->lin);
    w->c = mt_arena_f64(&a->damping_mem, (size_t)w->n, (size_t)w->n);
    if (mt_linear_structural(a->lin, NULL)) {
        w->h = mt_arena_f64(&a->damping_mem, (size_t)w->n, (size_t)w->n);
    }
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    mt_linear_damping(a->lin, w->c);
    if (w->h != NULL) {
        (void)mt_linear_structural(a->lin, w->h);
    }
    MT_TRY(find_modal(a, w, err));
    MT_TRY(add_to_dampers(a, w, err));
    a->damping = w;
    *out = w;
    return MT_OK;
}

mt_status mt_analysis_damping(mt_analysis *a, double *c, double *h, bool *structural,
                              mt_err *err)
{
    work *w = NULL;
    MT_TRY(prepare_damping_work(a, &w, err));
    const size_t bytes = (size_t)w->n * (size_t)w->n * sizeof *c;
    if (c != NULL) {
        memcpy(c, w->c, bytes);
    }
    if (h != NULL && w->h != NULL) {
        memcpy(h, w->h, bytes);
    } else if (h != NULL) {
        memset(h, 0, bytes);
    }
    if (structural != NULL) {
        *structural = w->h != NULL;
    }
    return MT_OK;
}

/* D_ij; NaN where it has no limit. */
static double divided(const mt_analysis *a, const work *w, int i, int j)
{
    const mt_modes *const m = &a->modes;
    const bool both = w->ratio[i] != MT_NO_NODE && w->ratio[j] != MT_NO_NODE;
    if (both && w->zeta[i] == w->zeta[j]) {
        return 2.0 * w->zeta[i] / (w->omega[i] + w->omega[j]);
    }
    if (w->f[i] == 0.0 && w->f[j] == 0.0) {
        return 0.0;
    }
    return m->cluster[i] == m->cluster[j] ? nan("")
                                          : (w->f[j] - w->f[i]) / (m->lambda[j] - m->lambda[i]);
}

/* q := Q of input p, r x r, of kappa (overwritten) and mu. */
static void modal_slope(const mt_analysis *a, const work *w, int p, const double *mu, double *q)
{
    const mt_modes *const m = &a->modes;
    const ptrdiff_t r = w->r;
    for (int j = 0; j < w->r; j++) {
        for (int i = 0; i < w->r; i++) {
            double *const at = q + i + (j * r);
            const double mu_ij = mu[i + (j * r)];
            const double force = *at - (m->lambda[j] * mu_ij);
            if (i != j) {
                const double part = force != 0.0 ? divided(a, w, i, j) * force : 0.0;
                const bool torn = m->cluster[i] == m->cluster[j] &&
                                  slope_of(a, w->ratio[i], p) != slope_of(a, w->ratio[j], p);
                *at = torn ? nan("") : part - (w->f[i] * mu_ij);
                continue;
            }
            const double turns = w->zeta[j] == 0.0 ? 0.0 : w->zeta[j] * force / w->omega[j];
            *at = (2.0 * w->omega[j] * slope_of(a, w->ratio[j], p)) + turns - (w->f[j] * mu_ij);
        }
    }
}

/* q := Q (r x r), dm := (dM/dp) Phi (n x r). */
static mt_status modal_turn(mt_analysis *a, const work *w, int p, double *q, double *dm,
                            mt_err *err)
{
    const int n = w->n;
    const int r = w->r;
    const double *const y = a->modes.y;
    double *const dk = mt_arena_f64(&a->damping_mem, (size_t)n, (size_t)r);
    double *const mu = mt_arena_f64(&a->damping_mem, (size_t)r, (size_t)r);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    MT_TRY(mt_linear_products(a->lin, p, r, y, dk, dm, err));
    mt_gemm(true, false, r, r, n, 1.0, y, n, dk, n, 0.0, q, r);
    mt_gemm(true, false, r, r, n, 1.0, y, n, dm, n, 0.0, mu, r);
    modal_slope(a, w, p, mu, q);
    return MT_OK;
}

/* dcx += (d(N F N^T)/dp) x = dM Phi F z + N (F (dM Phi)^T x + Q z), z = N^T x. */
static mt_status add_modal(mt_analysis *a, const work *w, int p, int cols, const double *x,
                           double *dcx, mt_err *err)
{
    const int n = w->n;
    const int r = w->r;
    double *const dm = mt_arena_f64(&a->damping_mem, (size_t)n, (size_t)r);
    double *const q = mt_arena_f64(&a->damping_mem, (size_t)r, (size_t)r);
    double *const z = mt_arena_f64(&a->damping_mem, (size_t)r, (size_t)cols);
    double *const g = mt_arena_f64(&a->damping_mem, (size_t)r, (size_t)cols);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    MT_TRY(modal_turn(a, w, p, q, dm, err));
    mt_gemm(true, false, r, cols, n, 1.0, w->n_phi, n, x, n, 0.0, z, r);
    mt_gemm(true, false, r, cols, n, 1.0, dm, n, x, n, 0.0, g, r);
    for (int c = 0; c < cols; c++) {
        for (int j = 0; j < r; j++) {
            g[j + ((ptrdiff_t)c * r)] *= w->f[j];
        }
    }
    mt_gemm(false, false, r, cols, r, 1.0, q, r, z, r, 1.0, g, r);
    mt_gemm(false, false, n, cols, r, 1.0, w->n_phi, n, g, r, 1.0, dcx, n);
    for (int c = 0; c < cols; c++) {
        for (int j = 0; j < r; j++) {
            z[j + ((ptrdiff_t)c * r)] *= w->f[j];
        }
    }
    mt_gemm(false, false, n, cols, r, 1.0, dm, n, z, r, 1.0, dcx, n);
    return MT_OK;
}

/* dcx += (d(alpha M + beta K)/dp) x. */
static mt_status add_proportional(mt_analysis *a, const work *w, int p, int cols,
                                  const double *x, double *dcx, mt_err *err)
{
    const mt_damping_def *const d = &a->sys->damping;
    const mt_reduced k = mt_linear_reduced(a->lin);
    const int n = w->n;
    const size_t size = (size_t)n * (size_t)cols;
    if (d->mass == MT_NO_NODE && d->stiffness == MT_NO_NODE) {
        return MT_OK;
    }
    double *const dk = mt_arena_f64(&a->damping_mem, size, 1);
    double *const dm = mt_arena_f64(&a->damping_mem, size, 1);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    MT_TRY(mt_linear_products(a->lin, p, cols, x, dk, dm, err));
    const int whole = n * cols;
    mt_axpy(whole, value_or_zero(a, d->mass), dm, dcx);
    mt_axpy(whole, value_or_zero(a, d->stiffness), dk, dcx);
    mt_symm(n, cols, k.m, x, dm);
    mt_symm(n, cols, k.k, x, dk);
    mt_axpy(whole, slope_of(a, d->mass, p), dm, dcx);
    mt_axpy(whole, slope_of(a, d->stiffness, p), dk, dcx);
    return MT_OK;
}

mt_status mt_analysis_damping_products(mt_analysis *a, int p, int cols, const double *x,
                                       double *dcx, double *dhx, mt_err *err)
{
    work *w = NULL;
    if (!a->with_gradient) {
        return mt_fail(err, MT_E_INTERNAL, "derivatives asked for after a solve without them");
    }
    MT_TRY(prepare_damping_work(a, &w, err));
    MT_TRY(mt_linear_damping_products(a->lin, p, cols, x, dcx, dhx, err));
    const mt_arena_mark mark = mt_arena_get_mark(&a->damping_mem);
    mt_status rc = add_proportional(a, w, p, cols, x, dcx, err);
    rc = rc == MT_OK && w->r > 0 ? add_modal(a, w, p, cols, x, dcx, err) : rc;
    mt_arena_rewind(&a->damping_mem, mark);
    return rc;
}

mt_status mt_analysis_ratio_modes(mt_analysis *a, mt_ratio_modes *out, mt_err *err)
{
    work *w = NULL;
    MT_TRY(prepare_damping_work(a, &w, err));
    *out = (mt_ratio_modes){.r = w->r, .y = a->modes.y, .f = w->f};
    return MT_OK;
}

mt_status mt_analysis_ratio_slope(mt_analysis *a, int p, double *q, mt_err *err)
{
    work *w = NULL;
    MT_TRY(prepare_damping_work(a, &w, err));
    const mt_arena_mark mark = mt_arena_get_mark(&a->damping_mem);
    double *const dm = mt_arena_f64(&a->damping_mem, (size_t)w->n, (size_t)w->r);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    const mt_status rc = modal_turn(a, w, p, q, dm, err);
    mt_arena_rewind(&a->damping_mem, mark);
    return rc;
}

mt_status mt_analysis_ratio_force(mt_analysis *a, const double *w, double *out, mt_err *err)
{
    work *k = NULL;
    MT_TRY(prepare_damping_work(a, &k, err));
    for (ptrdiff_t j = 0; j < k->r; j++) {
        const double force = k->f[j] * mt_dot(k->n, a->modes.y + (j * k->n), w);
        mt_axpy(k->n, force, k->n_phi + (j * k->n), out);
    }
    return MT_OK;
}

/*
 * Roots s of (s^2 M + s C + K + i H) y = 0 and their derivatives: with symmetric matrices y is
 * its own left eigenvector, so y^T times the derivative of the equation leaves
 *     ds (y^T (2 s M + C) y) = -y^T (s^2 dM + s dC + dK + i dH) y.
 */

mt_status mt_analysis_damped(mt_analysis *a, const mt_damped_modes **out, mt_err *err)
{
    MT_TRY(mt_analysis_damping(a, NULL, NULL, NULL, err));
    work *const w = a->damping;
    if (!w->solved) {
        const mt_reduced r = mt_linear_reduced(a->lin);
        const mt_damped_problem p = {
            .n = r.n, .k = r.k, .c = w->c, .h = w->h, .mass = &a->mass, .modes = &a->modes};
        MT_TRY(mt_modal_damped(&p, &a->damping_mem, &w->damped, err));
        w->solved = true;
    }
    *out = &w->damped;
    return MT_OK;
}

int mt_damped_oscillating(const mt_damped_modes *d, int index)
{
    int at = -1;
    int seen = 0;
    for (int i = 0; i < d->count; i++) {
        if (d->kind[i] == MT_DAMPED_UNSTABLE || d->kind[i] == MT_DAMPED_UNDECIDED) {
            return -1;
        }
        seen += d->kind[i] == MT_DAMPED_OSCILLATING ? 1 : 0;
        at = at < 0 && seen == index ? i : at;
    }
    return at;
}

mt_status mt_analysis_damped_of(mt_analysis *a, int pos, int *out, mt_err *err)
{
    const mt_damped_modes *d = NULL;
    const mt_reduced r = mt_linear_reduced(a->lin);
    double best = -1.0;
    *out = -1;
    MT_TRY(mt_analysis_damped(a, &d, err));
    const mt_arena_mark mark = mt_arena_get_mark(&a->damping_mem);
    double *const m_phi = mt_arena_f64(&a->damping_mem, (size_t)r.n, 1);
    double *const m_y = mt_arena_f64(&a->damping_mem, (size_t)r.n, 1);
    mt_status rc = mt_arena_check(&a->damping_mem, err);
    if (rc == MT_OK) {
        mt_symm(r.n, 1, r.m, mt_modal_shape(&a->modes, pos), m_phi);
    }
    for (int i = 0; i < d->count && rc == MT_OK; i++) {
        double share = 0.0;
        double whole = 0.0;
        for (int part = 0; part < 2; part++) {
            const double *const y = (part == 0 ? d->y_re : d->y_im) + ((ptrdiff_t)i * r.n);
            const double along = mt_dot(r.n, m_phi, y);
            mt_symm(r.n, 1, r.m, y, m_y);
            share += along * along;
            whole += mt_dot(r.n, y, m_y);
        }
        if (d->kind[i] == MT_DAMPED_OSCILLATING && whole > 0.0 && share / whole > best) {
            best = share / whole;
            *out = i;
        }
    }
    mt_arena_rewind(&a->damping_mem, mark);
    return rc;
}

/* y^T A y of the columns (Re y, Im y) and of the products ay of A with them. */
static double complex form(int n, const double *y, const double *ay)
{
    const double rr = mt_dot(n, y, ay);
    const double ii = mt_dot(n, y + n, ay + n);
    const double ri = mt_dot(n, y, ay + n) + mt_dot(n, y + n, ay);
    return mt_complex(rr - ii, ri);
}

/* Roots nearer than this many of their own roundings are one: residuals of a few n eps, and the
 * square root that a defective pair makes of them, lie below. */
static const double REPEATED = 1e-6;

static bool is_repeated(const mt_damped_modes *d, int i)
{
    const double size = hypot(d->re[i], d->im[i]);
    for (int k = 0; k < d->count; k++) {
        if (k != i && d->kind[k] != MT_DAMPED_RIGID_BODY &&
            hypot(d->re[k] - d->re[i], d->im[k] - d->im[i]) <= REPEATED * size) {
            return true;
        }
    }
    return !(size > 0.0);
}

/* y^T (2 s M + C) y. */
static double complex denominator(const mt_analysis *a, const work *w, const double *y,
                                  double complex s, double *ay)
{
    const mt_reduced r = mt_linear_reduced(a->lin);
    mt_symm(r.n, 2, r.m, y, ay);
    const double complex m = form(r.n, y, ay);
    mt_symm(r.n, 2, w->c, y, ay);
    return (2.0 * s * m) + form(r.n, y, ay);
}

static mt_status slopes_of_pole(mt_analysis *a, const work *w, int i, double *dre, double *dim,
                                mt_err *err)
{
    const int n = w->n;
    const size_t size = (size_t)n;
    const double complex s = mt_complex(w->damped.re[i], w->damped.im[i]);
    double *const y = mt_arena_f64(&a->damping_mem, size, 2);
    double *const one = mt_arena_f64(&a->damping_mem, size, 2);
    double *const two = mt_arena_f64(&a->damping_mem, size, 2);
    MT_TRY(mt_arena_check(&a->damping_mem, err));
    mt_axpy(n, 1.0, w->damped.y_re + ((ptrdiff_t)i * n), y);
    mt_axpy(n, 1.0, w->damped.y_im + ((ptrdiff_t)i * n), y + n);
    const double complex below = denominator(a, w, y, s, one);
    for (int p = 0; p < a->sys->n_inputs; p++) {
        MT_TRY(mt_linear_products(a->lin, p, 2, y, one, two, err));
        double complex above = form(n, y, one) + (s * s * form(n, y, two));
        MT_TRY(mt_analysis_damping_products(a, p, 2, y, one, two, err));
        above += (s * form(n, y, one)) + (mt_complex(0.0, 1.0) * form(n, y, two));
        const double complex ds = -above / below;
        dre[p] = creal(ds);
        dim[p] = w->damped.im[i] > 0.0 ? cimag(ds) : 0.0; /* a real root stays real */
    }
    return MT_OK;
}

mt_status mt_analysis_dpole(mt_analysis *a, int i, double *dre, double *dim, bool *repeated,
                            mt_err *err)
{
    const mt_damped_modes *d = NULL;
    MT_TRY(mt_analysis_damped(a, &d, err));
    const bool many = d->kind[i] == MT_DAMPED_RIGID_BODY || d->kind[i] == MT_DAMPED_UNDECIDED ||
                      is_repeated(d, i);
    if (repeated != NULL) {
        *repeated = many;
    }
    if (many) {
        for (int p = 0; p < a->sys->n_inputs; p++) {
            dre[p] = nan("");
            dim[p] = nan("");
        }
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(&a->damping_mem);
    const mt_status rc = slopes_of_pole(a, a->damping, i, dre, dim, err);
    mt_arena_rewind(&a->damping_mem, mark);
    return rc;
}
