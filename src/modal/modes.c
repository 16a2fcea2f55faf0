/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is read of modes: signs, correlation, indices, kinds, clusters, and errors by
 * energies. */
#include "modal/modes.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "linalg/dense.h"
#include "modal/damped.h"

/*
 * The sign of an eigenvector is free; a rule must give the same one on every machine and along
 * a search. "The largest entry is positive" alone does not: a symmetrical structure has mirror
 * entries of equal size and, in its antisymmetrical modes, of opposite sign, and rounding picks
 * the larger. Vectors of modes that are not clustered are accurate to about n eps s / gap, far
 * better than 1e-6 unless modes are nearly repeated or the spread is extreme; so entries within
 * TIE of the largest count as equal and their order decides. A structure whose entries differ
 * by just TIE flips; no rule is continuous, and engineers draw equal entries far more often
 * than those.
 */

static const double TIE = 1e-6;

void mt_modal_fix_sign(int n, int r, double *phi)
{
    for (int j = 0; j < r; j++) {
        double *const v = phi + (ptrdiff_t)j * n;
        double most = 0.0;
        for (int i = 0; i < n; i++) {
            most = fmax(most, fabs(v[i]));
        }
        int first = 0;
        while (first < n && !(fabs(v[first]) >= (1.0 - TIE) * most)) {
            first++;
        }
        if (first < n && v[first] < 0.0) {
            for (int i = 0; i < n; i++) {
                v[i] = -v[i];
            }
        }
    }
}

/* Modal assurance criterion, for single shapes and for subspaces. Shapes are scaled by their
 * largest entry first, so squares neither over- nor underflow. */

/* cos^2 of the angle between a and b. */
static double mac_pair(int ns, const double *a, const double *b)
{
    const double size_a = mt_max_abs(ns, a);
    const double size_b = mt_max_abs(ns, b);
    if (!(size_a > 0.0 && size_b > 0.0 && isfinite(size_a) && isfinite(size_b))) {
        return nan("");
    }
    double ab = 0.0;
    double aa = 0.0;
    double bb = 0.0;
    for (int i = 0; i < ns; i++) {
        const double x = a[i] / size_a;
        const double z = b[i] / size_b;
        ab += x * z;
        aa += x * x;
        bb += z * z;
    }
    return fmin(ab * ab / (aa * bb), 1.0);
}

void mt_mac_matrix(int ns, int ra, const double *a, int rb, const double *b, double *mac)
{
    for (int j = 0; j < rb; j++) {
        for (int i = 0; i < ra; i++) {
            mac[i + (ptrdiff_t)j * ra] =
                mac_pair(ns, a + (ptrdiff_t)i * ns, b + (ptrdiff_t)j * ns);
        }
    }
}

mt_status mt_mac_pair(int ra, int rb, const double *mac, int *pair, mt_arena *scratch,
                      mt_err *err)
{
    return mt_assign(ra, rb, mac, pair, scratch, err);
}

/* Orthonormal basis of span(a) in u (ns x min(ns, r)), leading *rank columns. */
static mt_status basis(int ns, int r, const double *a, double *u, int *rank, mt_arena *scratch,
                       mt_err *err)
{
    const int least = ns < r ? ns : r;
    double *const copy = mt_arena_f64(scratch, (size_t)ns, (size_t)r);
    double *const s = mt_arena_f64(scratch, (size_t)least, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int j = 0; j < r; j++) { /* each shape has its own scale: none may hide another */
        const double size = mt_max_abs(ns, a + (ptrdiff_t)j * ns);
        for (int i = 0; i < ns; i++) {
            const ptrdiff_t ij = i + (ptrdiff_t)j * ns;
            copy[ij] = size > 0.0 ? a[ij] / size : a[ij];
        }
    }
    MT_TRY(mt_svd(ns, r, copy, s, u, NULL, scratch, err));
    *rank = 0;
    while (*rank < least && s[*rank] > mt_modal_tolerance(ns > r ? ns : r) * s[0]) {
        (*rank)++;
    }
    return MT_OK;
}

static mt_status subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err)
{
    double *const ua = mt_arena_f64(scratch, (size_t)ns, (size_t)ra);
    double *const ub = mt_arena_f64(scratch, (size_t)ns, (size_t)rb);
    double *const c = mt_arena_f64(scratch, (size_t)ra, (size_t)rb);
    MT_TRY(mt_arena_check(scratch, err));
    int rank_a = 0;
    int rank_b = 0;
    MT_TRY(basis(ns, ra, a, ua, &rank_a, scratch, err));
    MT_TRY(basis(ns, rb, b, ub, &rank_b, scratch, err));
    mt_gemm(true, false, rank_a, rank_b, ns, 1.0, ua, ns, ub, ns, 0.0, c, rank_a);
    MT_TRY(mt_svd(rank_a, rank_b, c, cos2, NULL, NULL, scratch, err));
    const int least = rank_a < rank_b ? rank_a : rank_b;
    const int wanted = ra < rb ? ra : rb;
    for (int i = 0; i < wanted; i++) {
        cos2[i] = i < least ? fmin(cos2[i] * cos2[i], 1.0) : nan("");
    }
    return MT_OK;
}

mt_status mt_mac_subspace(int ns, int ra, const double *a, int rb, const double *b,
                          double *cos2, mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    const mt_status rc = subspace(ns, ra, a, rb, b, cos2, scratch, err);
    mt_arena_rewind(scratch, mark);
    return rc;
}

double mt_mac_derivative(int ns, const double *a, const double *da, const double *b)
{
    const double ab = mt_dot(ns, a, b);
    const double aa = mt_dot(ns, a, a);
    const double bb = mt_dot(ns, b, b);
    const double mac = ab * ab / (aa * bb);
    return 2.0 * ab * mt_dot(ns, da, b) / (aa * bb) - 2.0 * mac * mt_dot(ns, a, da) / aa;
}

/* Indices and frequencies. */

static const double TWO_PI = 6.283185307179586476925;

const double *mt_modal_shape(const mt_modes *modes, int i)
{
    return i < modes->shaped ? modes->y + ((ptrdiff_t)i * modes->n) : NULL;
}

double mt_modal_hz(const mt_modes *modes, int i)
{
    if (modes->kind[i] == MT_MODE_UNSTABLE || modes->kind[i] == MT_MODE_UNDECIDED) {
        return nan("");
    }
    return modes->kind[i] == MT_MODE_RIGID_BODY ? 0.0 : sqrt(modes->lambda[i]) / TWO_PI;
}

double mt_modal_error_hz(const mt_modes *modes, int i)
{
    const double e = modes->error[i];
    const double lambda = modes->lambda[i];
    if (isnan(mt_modal_hz(modes, i))) {
        return nan("");
    }
    /* sqrt(lambda) - sqrt(lambda - e), without cancellation */
    return e < lambda ? e / (sqrt(lambda) + sqrt(lambda - e)) / TWO_PI : sqrt(e) / TWO_PI;
}

double mt_modal_hz_slope(double dlambda, double hz)
{
    return hz > 0.0 ? dlambda / (2.0 * TWO_PI * TWO_PI * hz) : nan("");
}

bool mt_modal_indexed(const mt_modes *modes)
{
    return modes->n_unstable == 0 && modes->n_undecided == 0;
}

int mt_modal_vibrations(const mt_modes *modes)
{
    return modes->all - modes->n_rigid;
}

int mt_modal_flexible(const mt_modes *modes, int index)
{
    if (!mt_modal_indexed(modes) || index < 1) {
        return -1;
    }
    int seen = 0;
    for (int i = 0; i < modes->count; i++) {
        seen += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
        if (seen == index) {
            return i;
        }
    }
    return -1;
}

int mt_modal_index(const mt_modes *modes, int pos)
{
    int index = 0;
    for (int i = 0; i <= pos; i++) {
        index += modes->kind[i] == MT_MODE_FLEXIBLE ? 1 : 0;
    }
    return index;
}

int mt_modal_cluster(const mt_modes *modes, int i, int *size)
{
    int first = i;
    int end = i + 1;
    while (first > 0 && modes->cluster[first - 1] == modes->cluster[i]) {
        first--;
    }
    while (end < modes->count && modes->cluster[end] == modes->cluster[i]) {
        end++;
    }
    *size = end - first;
    return first;
}

/* Kinds and clusters of computed eigenvalues. */

/*
 * Neighbours closer than CLUSTER_GAP of their size are one cluster. The eigenvector of a single
 * mode, and with it any gradient that uses it, describes the system for relative parameter
 * changes up to about the gap only; sqrt(eps) is the smallest step that a search with 16 digits
 * can make and judge, so a gap below that is a repeated mode to every user of these numbers.
 * Mirror modes of a symmetrical structure agree to rounding, 1e-14 or so; distinct modes as
 * close as this have not been met. Eigenvalues that differ by less than their error bound
 * cannot be told apart either.
 */
static const double CLUSTER_GAP = 1.5e-8;

/* First of the n_rigid consecutive values with the smallest magnitudes (lambda ascends, so they
 * are consecutive). */
static int first_rigid(const mt_modes *modes, int n_rigid)
{
    int first = 0;
    while (first + n_rigid < modes->count &&
           fabs(modes->lambda[first + n_rigid]) < fabs(modes->lambda[first])) {
        first++;
    }
    return first;
}

static mt_mode_kind kind_of_mode(double lambda, double noise, bool strained, bool decide)
{
    if (lambda < -noise) {
        return MT_MODE_UNSTABLE;
    }
    if (lambda <= noise && strained) {
        return MT_MODE_UNDECIDED;
    }
    return decide && lambda <= noise ? MT_MODE_RIGID_BODY : MT_MODE_FLEXIBLE;
}

double mt_modal_classify(mt_modes *modes, int n_rigid, const double *noise,
                         const bool *strained)
{
    double rigid_most = 0.0;
    const bool decide = n_rigid < 0;
    const int rigid = decide || n_rigid <= modes->count ? n_rigid : modes->count;
    const int first = decide ? modes->count : first_rigid(modes, rigid);
    modes->n_rigid = 0;
    modes->n_held = 0;
    modes->n_undecided = 0;
    modes->n_unstable = modes->n_unstable_condensed;
    for (int i = 0; i < modes->count; i++) {
        const double zero = noise == NULL ? modes->error_bound : noise[i];
        const bool moves = strained != NULL && strained[i];
        const bool given = !decide && i >= first && i < first + rigid;
        const mt_mode_kind kind =
            given ? MT_MODE_RIGID_BODY : kind_of_mode(modes->lambda[i], zero, moves, decide);
        modes->kind[i] = kind;
        modes->n_rigid += kind == MT_MODE_RIGID_BODY ? 1 : 0;
        if (given) {
            rigid_most = fmax(rigid_most, fabs(modes->lambda[i]));
            modes->n_held += fabs(modes->lambda[i]) > zero ? 1 : 0;
        }
        modes->n_unstable += kind == MT_MODE_UNSTABLE ? 1 : 0;
        modes->n_undecided += kind == MT_MODE_UNDECIDED ? 1 : 0;
        if (kind == MT_MODE_RIGID_BODY ||
            (kind == MT_MODE_FLEXIBLE && modes->lambda[i] < 0.0)) {
            modes->lambda[i] = 0.0;
        }
    }
    return rigid_most;
}

void mt_modal_find_clusters(mt_modes *modes)
{
    int number = 0;
    for (int i = 0; i < modes->count; i++) {
        if (i > 0) {
            const double a = modes->lambda[i - 1];
            const double b = modes->lambda[i];
            const double noise =
                fmin(modes->error_bound, fmax(modes->error[i - 1], modes->error[i]));
            const double tol = CLUSTER_GAP * fmax(fabs(a), fabs(b)) + noise;
            number += b - a <= tol ? 0 : 1;
        }
        modes->cluster[i] = number;
    }
}

/*
 * Quotients of energies. A solve with matrices returns shapes whose residual is at most r_i
 * (its backward error); the eigenvalue that goes with a shape is then known to r_i, but the
 * quotient
 *     rho_i = y^T K y / y^T M y
 * is known to r_i^2 / gap_i, gap_i being the distance to the other eigenvalues: an error of the
 * shape enters twice. What remains is the rounding of the quotient itself, and that is small
 * where it is summed term by term, for there no stiff spring meets a soft one before its (tiny)
 * elongation is squared. Shapes are known to p eps at best, which stiff springs of the scale s
 * answer with (p eps)^2 s.
 */

/* An error below this part of lambda is nobody's concern: results are promised to that. */
static const double FINE = 1e-9;
/* p of the above. */
static const double SHAPE_ULPS = 16.0;

/* Of the error of either, gaps below this leave less than three digits of r^2 / gap. */
static const double CLOSE = 1e3;
enum { GROUP = 8 };

/* Distance between neighbours beyond their errors; at most 0: they may be the same. */
static double gap_between(const mt_modes *modes, int i, int k)
{
    const double far = fabs(modes->lambda[k] - modes->lambda[i]);
    return far - modes->error[k] - modes->error[i];
}

static bool is_close(const mt_modes *modes, int i)
{
    return !(gap_between(modes, i, i + 1) > CLOSE * fmax(modes->error[i], modes->error[i + 1]));
}

int mt_modal_groups(const mt_modes *modes, int count, int *group)
{
    int pairs = 0;
    for (int i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && is_close(modes, end - 1); end++) {
        }
        const int size = end - i;
        for (int k = i; k < end; k++) {
            group[k] = size <= GROUP ? i : k;
        }
        pairs += size <= GROUP ? size * (size - 1) / 2 : 0;
    }
    return pairs;
}

void mt_modal_pair_shapes(const mt_modes *modes, int count, const int *group, double *y)
{
    const double half = sqrt(0.5);
    for (int i = 0; i < count; i++) {
        for (int k = i + 1; k < count && group[k] == group[i]; k++, y += modes->n) {
            for (int j = 0; j < modes->n; j++) {
                y[j] = half * (mt_modal_shape(modes, i)[j] + mt_modal_shape(modes, k)[j]);
            }
        }
    }
}

/* |y_i^T (K - lambda M) y_k| at most, from the shape of the pair at `pair`. */
static double coupling(const mt_mode_energies *e, double lambda, int i, int k, int pair)
{
    const double stiffness = e->stiffness[pair] - (0.5 * (e->stiffness[i] + e->stiffness[k]));
    const double mass = e->mass[pair] - (0.5 * (e->mass[i] + e->mass[k]));
    const double stiffness_noise =
        e->stiffness_noise[pair] + (0.5 * (e->stiffness_noise[i] + e->stiffness_noise[k]));
    const double mass_noise =
        e->mass_noise[pair] + (0.5 * (e->mass_noise[i] + e->mass_noise[k]));
    return fabs(stiffness - (lambda * mass)) + stiffness_noise + (fabs(lambda) * mass_noise);
}

/* lambda[end - first] of the modes first .. end - 1, whose pairs start at *pair; returns their
 * error. */
static double quotients(const mt_modes *modes, const mt_mode_energies *e, int first, int end,
                        int *pair, double *lambda)
{
    const double shape = SHAPE_ULPS * DBL_EPSILON;
    double coupled[GROUP] = {0.0};
    double noise = 0.0;
    double r = 0.0;
    double most = 0.0;
    for (int i = first; i < end; i++) {
        const double rho = e->stiffness[i] / e->mass[i];
        const double own =
            (e->stiffness_noise[i] + (fabs(rho) * e->mass_noise[i])) / e->mass[i];
        lambda[i - first] = rho;
        noise = fmax(noise, isfinite(rho + own) ? own : HUGE_VAL);
        r = fmax(r, modes->error[i]);
        for (int k = i + 1; k < end; k++, (*pair)++) {
            const double c = coupling(e, rho, i, k, *pair) / fmin(e->mass[i], e->mass[k]);
            coupled[i - first] += c;
            coupled[k - first] += c;
        }
    }
    for (int i = first; i < end; i++) {
        most = fmax(most, coupled[i - first]);
    }
    r *= sqrt(end - first);
    const double below = first > 0 ? gap_between(modes, first - 1, first) : HUGE_VAL;
    const double above = end < modes->all ? gap_between(modes, end - 1, end) : HUGE_VAL;
    const double gap = fmin(below, above);
    const double mixed = gap > r ? r * (r / gap) : r;
    return noise + most + mixed + shape * shape * modes->scale;
}

static void swap_numbers(double *a, double *b)
{
    const double keep = *a;
    *a = *b;
    *b = keep;
}

/* Quotients of neighbours may pass each other, and so may a mode that becomes a rigid body's,
 * at 0, and one before it that is undecided. */
static void sort_modes(mt_modes *modes, bool *strained)
{
    for (int i = 1; i < modes->count; i++) {
        for (int k = i; k > 0 && modes->lambda[k] < modes->lambda[k - 1]; k--) {
            const bool keep = strained[k];
            strained[k] = strained[k - 1];
            strained[k - 1] = keep;
            const mt_mode_kind kind = modes->kind[k];
            modes->kind[k] = modes->kind[k - 1];
            modes->kind[k - 1] = kind;
            swap_numbers(&modes->lambda[k], &modes->lambda[k - 1]);
            swap_numbers(&modes->error[k], &modes->error[k - 1]);
            if (modes->residual != NULL && k < modes->shaped) {
                swap_numbers(&modes->residual[k], &modes->residual[k - 1]);
                swap_numbers(&modes->orthogonality[k], &modes->orthogonality[k - 1]);
            }
            for (int j = 0; j < modes->n && k < modes->shaped; j++) {
                double *const at = modes->y + j + (ptrdiff_t)k * modes->n;
                swap_numbers(at, at - modes->n);
            }
        }
    }
}

int mt_modal_doubtful(const mt_modes *modes)
{
    int count = 0;
    const bool exact = modes->from_factor && modes->error_bound == 0.0;
    for (int i = 0; i < modes->count; i++) {
        const bool rough = modes->kind[i] == MT_MODE_FLEXIBLE
                               ? !(modes->error[i] < FINE * fabs(modes->lambda[i]))
                               : !exact;
        count = rough ? i + 1 : count;
    }
    return count;
}

bool mt_modal_rough(const mt_modes *modes)
{
    bool rough = false;
    for (int i = 0; i < modes->shaped; i++) {
        rough = rough || (modes->kind[i] == MT_MODE_FLEXIBLE &&
                          !(modes->error[i] < FINE * modes->lambda[i]));
    }
    return rough;
}

/* Take the quotients where they are more accurate, group by group, with the errors and gaps
 * before the change. */
static void take_quotients(mt_mode_energies *e, mt_modes *modes)
{
    for (int i = 0; i < e->count; i++) {
        modes->error[i] += e->given_noise[i] / e->mass[i];
    }
    for (int i = 0, end, pair = e->count; i < e->count; i = end) {
        double lambda[GROUP];
        for (end = i + 1; e->group != NULL && end < e->count && e->group[end] == i; end++) {
        }
        const double error = quotients(modes, e, i, end, &pair, lambda);
        for (int k = i; k < end; k++) {
            const bool surer = error < modes->error[k];
            e->stiffness[k] = surer ? lambda[k - i] : modes->lambda[k];
            e->mass[k] = surer ? error : modes->error[k];
        }
    }
    /* those that have no shape stay behind those that have one */
    const double next = modes->shaped < modes->count ? modes->lambda[modes->shaped] : HUGE_VAL;
    for (int i = 0; i < e->count; i++) {
        const double beyond = fmax(e->stiffness[i] - next, 0.0);
        modes->lambda[i] = beyond > 0.0 ? next : e->stiffness[i];
        modes->error[i] = e->mass[i] + beyond;
    }
}

void mt_modal_judge(mt_mode_energies *e, int n_rigid, mt_modes *modes)
{
    const bool exact = modes->from_factor && modes->error_bound == 0.0;
    const int held = modes->n_held;
    take_quotients(e, modes);
    for (int i = e->count; i < modes->count; i++) {
        e->strained[i] = true;
    }
    sort_modes(modes, e->strained);
    for (int i = 0; i < modes->count; i++) {
        e->mass[i] = fabs(modes->lambda[i]);
    }
    if (exact) { /* the rank has decided */
        (void)mt_modal_classify(modes, modes->n_rigid, NULL, NULL);
    } else {
        (void)mt_modal_classify(modes, n_rigid, modes->error, e->strained);
    }
    modes->n_held = 0;
    for (int i = 0; i < modes->count; i++) {
        const bool rigid = n_rigid >= 0 && modes->kind[i] == MT_MODE_RIGID_BODY;
        modes->error[i] += modes->lambda[i] == 0.0 ? e->mass[i] : 0.0;
        modes->n_held += rigid && e->mass[i] > MT_MODAL_HELD * modes->error[i] ? 1 : 0;
    }
    modes->n_held = exact ? held : modes->n_held;
    sort_modes(modes, e->strained);
    mt_modal_find_clusters(modes);
}
