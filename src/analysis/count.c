/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How many rigid-body modes a family of designs has: the least number of null directions of
 *     K(x) = K0 + sum_t c_t(x) R_t R_t^T
 * over its box. At fixed geometry, with K0 >= 0 and c_t >= 0, the null space of K(x) is that of
 * K0 and of all R_t^T with c_t(x) > 0: the least is met wherever every coefficient that can be
 * positive is, and no more is asked of the coefficients than whether they vanish over the whole
 * box (interval arithmetic).
 *
 * Where geometry or loads depend on the design, K(x) is still analytic in x but for kinks of
 * the expressions: the rank that one design has, almost all have, and the greatest rank among a
 * few designs in general position is that of the family.
 */
#include "analysis/count.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/format.h"

/* Designs in general position besides corners and middle; their coordinates are fractions of i
 * times roots of primes, equally spread (Weyl). */
enum { FIRST_DESIGNS = 3, SPREAD_DESIGNS = 8 };
/* A part of a spring's row along the mode below this, relative to both, is rounding. */
static const double NO_PART = 1e-6;

/* k (n x n, lower) += size (a b^T + b a^T)/2. */
static void add_pair(ptrdiff_t n, double size, const double *a, const double *b, double *k)
{
    for (ptrdiff_t j = 0; j < n; j++) {
        for (ptrdiff_t i = j; i < n; i++) {
            k[i + (j * n)] += 0.5 * size * ((a[i] * b[j]) + (a[j] * b[i]));
        }
    }
}

/* A term that holds counts with its own size, or 1 where that is 0: any size will do. */
static double size_of_term(const mt_linear *lin, const mt_term *term)
{
    const double now = mt_linear_value(lin, term->coefficient);
    return now != 0.0 && isfinite(now) ? (term->pair ? now : fabs(now)) : 1.0;
}

mt_status mt_analysis_free_directions(const mt_linear *lin, const mt_mass_factor *mass,
                                      const bool *holds, mt_arena *scratch, int *n, mt_err *err)
{
    const mt_term_list *const list = mt_linear_terms(lin, MT_TERM_STIFFNESS);
    const mt_reduced r = mt_linear_reduced(lin);
    const ptrdiff_t order = r.n;
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const k = mt_arena_f64(scratch, (size_t)order, (size_t)order);
    double *const c = mt_arena_f64(scratch, (size_t)list->n_rows, 1);
    const mt_stiffness_factor factor = {.rows = list->n_rows,
                                        .b = r.b,
                                        .c = c,
                                        .noise = r.noise,
                                        .interrupt = mt_linear_system(lin)->run->interrupt};
    mt_modal_options opt = mt_modal_options_default();
    mt_modes modes;
    bool squares = !r.loaded;
    MT_TRY(mt_arena_check(scratch, err));
    for (int t = 0; t < list->n_terms; t++) {
        const mt_term *const term = &list->terms[t];
        if (!holds[t]) {
            continue;
        }
        const double size = size_of_term(lin, term);
        const double *const a = mt_linear_row(lin, MT_TERM_STIFFNESS, term->first);
        squares = squares && !term->pair;
        c[term->first] = term->pair ? 0.0 : size;
        add_pair(order, size, a, term->pair ? a + order : a, k);
    }
    opt.vectors = false;
    opt.accuracy = MT_MODAL_ACCURACY;
    const mt_status rc =
        mt_modal_solve(k, mass, squares ? &factor : NULL, &opt, scratch, &modes, err);
    *n = rc == MT_OK ? modes.n_rigid : 0;
    mt_arena_rewind(scratch, mark);
    return rc;
}

/* The box of the program's inputs: that of the family, and one position where a caller drives a
 * joint. */
typedef struct family {
    mt_analysis *a; /* of its own inputs, owned */
    int n;
    double *lower;
    double *upper;
    double *at;
    double *x; /* work */
} family;

/* Structural: see above. */
static mt_status count_terms(family *f, mt_arena *mem, int *n_rigid, mt_err *err)
{
    const mt_linear *const lin = f->a->lin;
    const mt_program *const p = &mt_linear_system(lin)->program;
    const mt_term_list *const list = mt_linear_terms(lin, MT_TERM_STIFFNESS);
    double *const lo = mt_arena_f64(mem, (size_t)p->count, 1);
    double *const hi = mt_arena_f64(mem, (size_t)p->count, 1);
    bool *const holds = mt_arena_alloc(mem, (size_t)list->n_terms, sizeof *holds);
    MT_TRY(mt_arena_check(mem, err));
    mt_program_interval(p, f->lower, f->upper, lo, hi);
    for (int t = 0; t < list->n_terms; t++) {
        const mt_node c = list->terms[t].coefficient;
        /* an enclosure may be a rounding wider than [0, 0] */
        holds[t] = !(lo[c] >= -DBL_MIN && hi[c] <= DBL_MIN);
    }
    return mt_analysis_free_directions(lin, &f->a->mass, holds, mem, n_rigid, err);
}

/* Directions that have mass at almost all designs of the box: the rank of M with every
 * coefficient that can be positive. Products of inertia stay as they are. */
static mt_status count_masses(const family *f, mt_arena *mem, int *n_most, mt_err *err)
{
    const mt_linear *const lin = f->a->lin;
    const mt_program *const p = &mt_linear_system(lin)->program;
    const mt_term_list *const list = mt_linear_terms(lin, MT_TERM_MASS);
    const ptrdiff_t n = mt_linear_freedoms(lin);
    double *const lo = mt_arena_f64(mem, (size_t)p->count, 1);
    double *const hi = mt_arena_f64(mem, (size_t)p->count, 1);
    double *const m = mt_arena_f64(mem, (size_t)n, (size_t)n);
    mt_mass_factor factor;
    MT_TRY(mt_arena_check(mem, err));
    mt_program_interval(p, f->lower, f->upper, lo, hi);
    memcpy(m, mt_linear_reduced(lin).m, (size_t)(n * n) * sizeof *m);
    for (int t = 0; t < list->n_terms; t++) {
        const mt_term *const term = &list->terms[t];
        const mt_node c = term->coefficient;
        if (term->pair || mt_linear_value(lin, c) != 0.0 || !(hi[c] > DBL_MIN)) {
            continue;
        }
        const double size = isfinite(hi[c]) ? hi[c] : 1.0;
        for (int r = 0; r < term->count; r++) {
            const double *const row = mt_linear_row(lin, MT_TERM_MASS, term->first + r);
            for (ptrdiff_t j = 0; j < n; j++) {
                mt_axpy((int)n, size * row[j], row, m + (j * n));
            }
        }
    }
    MT_TRY(mt_modal_factor_mass((int)n, m, mem, &factor, err));
    *n_most = factor.rank > *n_most ? factor.rank : *n_most;
    return MT_OK;
}

/* Design number k: 0 and 1 corners, 2 the middle, then spread. */
static void place_design(const family *f, int k)
{
    static const double PRIMES[] = {2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0};
    for (int i = 0; i < f->n; i++) {
        const double root = sqrt(PRIMES[i % MT_COUNT(PRIMES)]);
        const int round = i / MT_COUNT(PRIMES);
        const double turn = (double)(k - 2) * root * (double)(1 + round);
        const double part = k < 2 ? (double)k : k == 2 ? 0.5 : turn - floor(turn);
        f->x[i] = f->lower[i] + (part * (f->upper[i] - f->lower[i]));
    }
}

static mt_status count_designs(family *f, int *n_rigid, mt_err *err)
{
    const mt_analysis_options opt = {.accuracy = MT_MODAL_ACCURACY};
    for (int k = 0; k < FIRST_DESIGNS + SPREAD_DESIGNS; k++) {
        mt_err ignored = {0};
        place_design(f, k);
        f->a->n_rigid = -1;
        const mt_status rc = mt_analysis_solve(f->a, f->x, &opt, &ignored);
        if (mt_is_final(rc)) {
            return mt_fail(err, rc, "%s", ignored.text);
        }
        /* what cannot be analysed, or is unstable, says nothing of the others */
        if (rc == MT_OK && mt_modal_indexed(&f->a->modes) && f->a->modes.n_rigid < *n_rigid) {
            *n_rigid = f->a->modes.n_rigid;
        }
    }
    return MT_OK;
}

static mt_status open_family(const mt_analysis *a, const mt_count_box *box,
                             const mt_system_drive *drive, double position, mt_arena *mem,
                             family *f, mt_err *err)
{
    const size_t room = (size_t)box->n + 1;
    f->n = box->n + (drive != NULL ? 1 : 0);
    f->lower = mt_arena_f64(mem, room, 1);
    f->upper = mt_arena_f64(mem, room, 1);
    f->at = mt_arena_f64(mem, room, 1);
    f->x = mt_arena_f64(mem, room, 1);
    MT_TRY(mt_arena_check(mem, err));
    memcpy(f->lower, box->lower, (size_t)box->n * sizeof *f->lower);
    memcpy(f->upper, box->upper, (size_t)box->n * sizeof *f->upper);
    memcpy(f->at, box->at, (size_t)box->n * sizeof *f->at);
    f->lower[box->n] = position;
    f->upper[box->n] = position;
    f->at[box->n] = position;
    const mt_system_def def = {.model = a->sys->model,
                               .run = a->sys->run,
                               .configuration = a->sys->configuration,
                               .drive = drive,
                               .n_inputs = box->n,
                               .inputs = box->parameter,
                               .at = f->at};
    return mt_analysis_new_of(&def, 0, &f->a, err);
}

/* True where the rank of K depends on which coefficients vanish. Couplings that vary may cancel
 * the terms that they couple. */
static bool is_structural(const mt_linear *lin)
{
    const mt_term_list *const list = mt_linear_terms(lin, MT_TERM_STIFFNESS);
    const mt_system *const sys = mt_linear_system(lin);
    bool structural = sys->geometry_fixed && !sys->loaded && !mt_linear_reduced(lin).loaded;
    for (int t = 0; t < list->n_terms; t++) {
        structural = structural && !(list->terms[t].pair && list->terms[t].varies);
    }
    return structural;
}

static mt_status count_modes_in_box(mt_analysis *a, const mt_count_box *box,
                                    const mt_system_drive *drive, double position,
                                    mt_arena *mem, mt_err *err)
{
    family f = {.a = NULL};
    int n_rigid = a->n_null;
    mt_status rc = open_family(a, box, drive, position, mem, &f, err);
    if (rc == MT_OK && f.a != NULL && a->modes.n_condensed > 0) {
        rc = count_masses(&f, mem, &a->n_most, err);
    }
    if (rc == MT_OK && f.a != NULL && n_rigid > 0) {
        n_rigid = f.a->n_rigid < n_rigid ? f.a->n_rigid : n_rigid;
        rc = is_structural(f.a->lin) ? count_terms(&f, mem, &n_rigid, err)
                                     : count_designs(&f, &n_rigid, err);
        a->n_rigid = n_rigid;
    }
    mt_analysis_delete(f.a);
    return rc;
}

mt_status mt_analysis_count(mt_analysis *a, const mt_count_box *box,
                            const mt_system_drive *drive, double position, mt_err *err)
{
    mt_arena mem;
    if (box == NULL || box->n == 0 || (a->n_null == 0 && a->modes.n_condensed == 0)) {
        return MT_OK;
    }
    MT_TRY(mt_arena_init(&mem, 0, err));
    const mt_status rc = count_modes_in_box(a, box, drive, position, &mem, err);
    mt_arena_free(&mem);
    return rc;
}

int mt_analysis_named(const mt_analysis *a, int index)
{
    return mt_modal_flexible(&a->modes, index + a->n_null - a->n_rigid);
}

bool mt_analysis_is_infinite(const mt_analysis *a, int index)
{
    return mt_modal_indexed(&a->modes) && index > mt_modal_vibrations(&a->modes) &&
           index <= a->n_most - a->n_rigid;
}

/* True where row . y differs from 0 by more than rounding for a vector of the cluster. */
static bool acts_on(const mt_analysis *a, const double *row, int first, int size)
{
    const ptrdiff_t n = mt_linear_freedoms(a->lin);
    for (int k = first; k < first + size; k++) {
        const double *const y = mt_modal_shape(&a->modes, k);
        double part = 0.0;
        double most = 0.0;
        for (ptrdiff_t i = 0; i < n; i++) {
            part += row[i] * y[i];
            most = fmax(most, fabs(row[i] * y[i]));
        }
        if (fabs(part) > NO_PART * most) {
            return true;
        }
    }
    return false;
}

bool mt_analysis_slack(const mt_analysis *a, int pos, char *text, size_t size)
{
    const mt_linear *const lin = a->lin;
    const mt_term_list *const list = mt_linear_terms(lin, MT_TERM_STIFFNESS);
    size_t used = 0;
    const char *last = NULL;
    text[0] = '\0';
    if (a->modes.y == NULL || a->modes.kind[pos] != MT_MODE_FLEXIBLE ||
        a->modes.lambda[pos] > a->modes.error[pos]) {
        return false;
    }
    int cluster = 1;
    const int first = mt_modal_cluster(&a->modes, pos, &cluster);
    for (int t = 0; t < list->n_terms && used < size; t++) {
        const mt_term *const term = &list->terms[t];
        const char *const name = a->sys->springs[term->source].name;
        const double *const row = mt_linear_row(lin, MT_TERM_STIFFNESS, term->first);
        const bool told = last != NULL && strcmp(last, name) == 0;
        if (!told && term->varies && mt_linear_value(lin, term->coefficient) == 0.0 &&
            acts_on(a, row, first, cluster)) {
            const int wrote =
                mt_snprintf(text + used, size - used, "%s\"%s\"", used > 0 ? ", " : "", name);
            used += wrote > 0 ? (size_t)wrote : 0;
            last = name;
        }
    }
    return true;
}
