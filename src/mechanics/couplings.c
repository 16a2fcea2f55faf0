/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A spring with a matrix, V = 1/2 x^T C x over its measures x, as a sum of squares. With the
 * rows f_a of the measures, its part of K is sum_ab C_ab f_a f_b^T: terms that cancel where the
 * joints block a direction, or where C is far softer one way than the other. By Cholesky with
 * diagonal pivoting of the matrix scaled to unit diagonal,
 *     C = sum_k l_k l_k^T,    K = sum_k b_k b_k^T,    b_k = sum_a l_k(a) f_a,
 * each b_k is a row like that of any other spring: with a length, an error (that of the f_a,
 * and eps / L_kk of L), and exactly 0 where it is rounding.
 */
#include "mechanics/couplings.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>

enum { ORDER = 6 };
/* Pivots of the scaled matrix below this are rounding of its entries. */
static const double PIVOT_ULPS = 16.0 * ORDER;

typedef struct group {
    int n;
    int measure[ORDER];
    int row[ORDER];         /* of the list */
    double c[ORDER][ORDER]; /* C, then the scaled matrix */
    double root[ORDER];     /* sqrt(C_aa) */
    double l[ORDER][ORDER]; /* [k][a] */
    double pivot[ORDER];    /* L_kk of the scaled matrix */
    int rank;
} group;

static const char *spring_name(const mt_linear *lin, int term)
{
    return lin->sys->springs[lin->list[MT_TERM_STIFFNESS].terms[term].source].name;
}

/* End of the spring that begins with term `first`. */
static int spring_end(const mt_linear *lin, int first)
{
    const int n = lin->list[MT_TERM_STIFFNESS].n_terms;
    int end = first + 1;
    while (end < n && spring_name(lin, end) == spring_name(lin, first)) {
        end++;
    }
    return end;
}

void mt_couplings_find(const mt_linear *lin, mt_coupling *coupling)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    for (int first = 0; first < list->n_terms;) {
        const int end = spring_end(lin, first);
        bool pair = false;
        bool varies = false;
        for (int i = first; i < end; i++) {
            pair = pair || list->terms[i].pair;
            varies = varies || list->terms[i].varies;
        }
        for (; first < end; first++) {
            coupling[first] = !pair    ? MT_COUPLING_NONE
                              : varies ? MT_COUPLING_VARIES
                                       : MT_COUPLING_WHOLE;
        }
    }
}

/* Place of a measure in the group; -1 where there are too many. */
static int measure_in_group(group *g, int measure, int row)
{
    for (int a = 0; a < g->n; a++) {
        if (g->measure[a] == measure) {
            return a;
        }
    }
    if (g->n == ORDER) {
        return -1;
    }
    g->measure[g->n] = measure;
    g->row[g->n] = row;
    return g->n++;
}

static bool gather_coupled_springs(const mt_linear *lin, int first, int end, group *g)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    for (int i = first; i < end; i++) {
        const mt_term *const t = &list->terms[i];
        const int *const measure = lin->sys->springs[t->source].measure;
        const int a = measure_in_group(g, measure[0], t->first);
        const int b = t->pair ? measure_in_group(g, measure[1], t->first + 1) : a;
        if (a < 0 || b < 0) {
            return false;
        }
        const double c = lin->value[t->coefficient];
        g->c[a][b] += t->pair ? 0.5 * c : c;
        g->c[b][a] += t->pair ? 0.5 * c : 0.0;
    }
    return true;
}

/* Scale C to unit diagonal; false where a diagonal entry is negative, or is 0 with a coupling
 * in its row. */
static bool scale(group *g)
{
    for (int a = 0; a < g->n; a++) {
        if (!(g->c[a][a] >= 0.0)) {
            return false;
        }
        g->root[a] = sqrt(g->c[a][a]);
    }
    for (int a = 0; a < g->n; a++) {
        for (int b = 0; b < g->n; b++) {
            const double both = g->root[a] * g->root[b];
            if (!(both > 0.0) && g->c[a][b] != 0.0) {
                return false;
            }
            g->c[a][b] = both > 0.0 ? g->c[a][b] / both : 0.0;
        }
    }
    return true;
}

/* The largest diagonal entry that is left. */
static int next_pivot(const group *g, const bool *used)
{
    int at = -1;
    for (int a = 0; a < g->n; a++) {
        at = !used[a] && (at < 0 || g->c[a][a] > g->c[at][at]) ? a : at;
    }
    return at;
}

static void take_pivot(group *g, int at, bool *used)
{
    double *const l = g->l[g->rank];
    const double root = sqrt(g->c[at][at]);
    g->pivot[g->rank] = root;
    used[at] = true;
    l[at] = root;
    for (int a = 0; a < g->n; a++) {
        l[a] = used[a] ? l[a] : g->c[a][at] / root;
    }
    for (int a = 0; a < g->n; a++) {
        for (int b = 0; b < g->n; b++) {
            g->c[a][b] -= used[a] || used[b] ? 0.0 : l[a] * l[b];
        }
    }
    g->rank++;
}

/* False where the remaining matrix is not positive definite. */
static bool factor_coupling(group *g)
{
    const double tol = PIVOT_ULPS * DBL_EPSILON;
    bool used[ORDER] = {false};
    bool nothing = true;
    int at = next_pivot(g, used);
    while (at >= 0 && g->c[at][at] > tol) {
        take_pivot(g, at, used);
        at = next_pivot(g, used);
    }
    for (int a = 0; a < g->n; a++) {
        for (int b = 0; b < g->n; b++) {
            nothing = nothing && (used[a] || used[b] || fabs(g->c[a][b]) <= tol);
        }
    }
    return nothing;
}

static void write(mt_linear *lin, const group *g, int first_row, int end_row)
{
    const ptrdiff_t rows = lin->list[MT_TERM_STIFFNESS].n_rows;
    for (int k = first_row; k < end_row; k++) {
        lin->factor_c[k] = k < first_row + g->rank ? 1.0 : 0.0;
    }
    for (int k = 0; k < g->rank; k++) {
        for (ptrdiff_t c = 0; c < lin->n; c++) {
            double sum = 0.0;
            double noise = 0.0;
            for (int a = 0; a < g->n; a++) {
                const ptrdiff_t at = c + (g->row[a] * (ptrdiff_t)lin->n);
                const double r = lin->reduced[MT_TERM_STIFFNESS][at];
                const double l = g->l[k][a] * g->root[a];
                const double unsure = PIVOT_ULPS * DBL_EPSILON * g->root[a] / g->pivot[k];
                sum += l * r;
                noise += (fabs(l) * lin->noise[at]) + (unsure * fabs(r));
            }
            lin->factor_b[first_row + k + (c * rows)] = fabs(sum) <= noise ? 0.0 : sum;
            lin->factor_noise[first_row + k + (c * rows)] = noise;
        }
    }
}

/* The rows as the measures have them. */
static void restore_measure_rows(mt_linear *lin, int first_row, int end_row)
{
    const ptrdiff_t rows = lin->list[MT_TERM_STIFFNESS].n_rows;
    for (ptrdiff_t r = first_row; r < end_row; r++) {
        for (ptrdiff_t c = 0; c < lin->n; c++) {
            lin->factor_b[r + (c * rows)] = lin->reduced[MT_TERM_STIFFNESS][c + (r * lin->n)];
            lin->factor_noise[r + (c * rows)] = lin->noise[c + (r * lin->n)];
        }
    }
}

/* Terms `first` .. `end` - 1 of one coupled spring. False for an indefinite matrix; the rows
 * are then those of the measures. O(6 n). */
static bool square_spring(mt_linear *lin, int first, int end)
{
    const mt_term *const terms = lin->list[MT_TERM_STIFFNESS].terms;
    const int first_row = terms[first].first;
    const int end_row = terms[end - 1].first + terms[end - 1].count;
    group g = {0};
    if (!gather_coupled_springs(lin, first, end, &g) || !scale(&g) || !factor_coupling(&g)) {
        restore_measure_rows(lin, first_row, end_row);
        return false;
    }
    write(lin, &g, first_row, end_row);
    return true;
}

void mt_couplings_square(mt_linear *lin, mt_coupling kind)
{
    const int n = lin->list[MT_TERM_STIFFNESS].n_terms;
    for (int first = 0, end = 0; first < n; first = end) {
        end = lin->coupling[first] == kind ? spring_end(lin, first) : first + 1;
        const bool square = lin->coupling[first] == kind && square_spring(lin, first, end);
        for (int i = first; i < end && lin->coupling[i] == kind; i++) {
            lin->squared[i] = square;
        }
    }
}

void mt_couplings_add(const mt_linear *lin, const mt_term *t, double *k)
{
    const ptrdiff_t n = lin->n;
    const ptrdiff_t rows = lin->list[MT_TERM_STIFFNESS].n_rows;
    for (int r = t->first; r < t->first + t->count; r++) {
        for (ptrdiff_t j = 0; j < n && lin->factor_c[r] > 0.0; j++) {
            const double b = lin->factor_b[r + (j * rows)];
            for (ptrdiff_t i = j; i < n && b != 0.0; i++) {
                k[i + (j * n)] += lin->factor_b[r + (i * rows)] * b;
            }
        }
    }
}
