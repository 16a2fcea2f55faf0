/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mechanism linearised: stages that have not moved are skipped. */
#include "mechanics/linear.h"

#include "mechanics/linear_priv.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/run.h"
#include "linalg/dense.h"
#include "mechanics/couplings.h"
#include "mechanics/eliminate.h"
#include "mechanics/free_spin.h"
#include "mechanics/geometry.h"
#include "mechanics/singular.h"
#include "mechanics/tangent.h"

/* Stages. */

enum { WORD = 64 };

static void include_terms(const mt_program *p, const mt_term_list *list, uint64_t *set)
{
    for (int i = 0; i < list->n_terms; i++) {
        if (list->terms[i].varies) {
            mt_program_include_inputs(p, list->terms[i].coefficient, set);
        }
    }
}

static uint64_t *new_set(mt_arena *mem, int words)
{
    return mt_arena_alloc(mem, (size_t)words + 1, sizeof(uint64_t));
}

/* lists[MT_TERM_KINDS]. In mem; a failure is the arena's. */
static void stages_init(mt_stages *s, const mt_system *sys, const mt_term_list *lists,
                        mt_arena *mem)
{
    const mt_program *const p = &sys->program;
    s->n_inputs = sys->n_inputs;
    s->words = p->words;
    s->loaded = new_set(mem, p->words);
    s->stiffness = new_set(mem, p->words);
    s->mass = new_set(mem, p->words);
    s->all = new_set(mem, p->words);
    s->none = new_set(mem, p->words);
    for (int i = 0; i < MT_STAGES; i++) {
        s->at[i] = mt_arena_f64(mem, (size_t)s->n_inputs, 1);
    }
    if (mt_arena_failed(mem)) {
        return;
    }
    for (int w = 0; w < p->words; w++) {
        s->loaded[w] = sys->shape[w] | sys->forces[w];
    }
    include_terms(p, &lists[MT_TERM_STIFFNESS], s->stiffness);
    include_terms(p, &lists[MT_TERM_MASS], s->mass);
    for (int i = 0; i < s->n_inputs; i++) {
        s->all[i / WORD] |= (uint64_t)1 << (unsigned)(i % WORD);
    }
}

/* True where the set is empty. */
static bool stages_empty(const mt_stages *s, const uint64_t *set)
{
    for (int w = 0; w < s->words; w++) {
        if (set[w] != 0) {
            return false;
        }
    }
    return true;
}

bool mt_stages_has(const uint64_t *set, int input)
{
    return (set[input / WORD] >> (unsigned)(input % WORD) & 1U) != 0;
}

static uint64_t bits_of(double x)
{
    uint64_t bits = 0;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* True where the inputs of the set have the same bits. */
static bool stages_same(const mt_stages *s, const uint64_t *set, const double *at,
                        const double *inputs)
{
    for (int i = 0; i < s->n_inputs; i++) {
        if (mt_stages_has(set, i) && bits_of(at[i]) != bits_of(inputs[i])) {
            return false;
        }
    }
    return true;
}

bool mt_stages_begin(mt_stages *s, mt_stage_id stage, const uint64_t *set, const double *inputs)
{
    if (s->valid[stage] && stages_same(s, set, s->at[stage], inputs)) {
        s->counts.skipped[stage]++;
        return false;
    }
    s->valid[stage] = false;
    s->started_s = mt_profile_now(s->profile);
    return true;
}

static void mark_stage_valid(mt_stages *s, mt_stage_id stage, const double *inputs)
{
    for (int i = 0; i < s->n_inputs; i++) {
        s->at[stage][i] = inputs[i];
    }
    s->valid[stage] = true;
}

/* Instead of done: the results were taken from another system. */
static void stages_shared(mt_stages *s, mt_stage_id stage, const double *inputs)
{
    mark_stage_valid(s, stage, inputs);
    s->counts.shared[stage]++;
}

void mt_stages_done(mt_stages *s, mt_stage_id stage, const double *inputs)
{
    mark_stage_valid(s, stage, inputs);
    s->counts.done[stage]++;
    s->counts.seconds[stage] += mt_profile_now(s->profile) - s->started_s;
}

/*
 * Reduced rows r = Z^T f, and which of their entries are nothing but rounding.
 *
 * A spring that acts against what the joints block has r = 0. What is computed instead is
 * rounding, and no size of r by itself can tell: a short r may be a real, small lever. The
 * error is known, though: with bounds dz of the basis (carried through its elimination) and df
 * of the row,
 *     |dr_c| <= sum_k |f_k| dz_kc + df_k |z_kc|.
 * An entry below that is exactly 0: each is judged against the terms that it is the sum of,
 * before they cancel.
 */

/* Relative rounding of an entry of a row; coordinates far from the origin lose as many digits
 * more in the arms. */
static const double ROW_ULPS = 4.0;

/* The largest coordinate, at least the model length [m]. */
static double extent_of(const mt_linear *lin)
{
    double extent = lin->sys->length_m;
    for (int b = 0; b < lin->sys->n_bodies; b++) {
        for (int k = 0; k < 3; k++) {
            extent = fmax(extent, fabs(creal(lin->position.at.pose[b].x[k])));
        }
    }
    return extent;
}

/* Diagonal of M over all states. */
static void diagonal_mass(const mt_linear *lin, double *mass)
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const int other = t->pair ? (2 * t->first) + 1 - i : i;
        const double *const a = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)i * MT_LOCAL);
        const double *const b = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)other * MT_LOCAL);
        const double c = lin->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = mt_local_dof(lin->sys, t->body, k);
            if (dof >= 0) {
                mass[dof] += c * a[k] * b[k];
            }
        }
    }
}

/* Replace the basis of the elimination by one local to the bodies, with bounds of its
 * errors. After the elimination and the rows. */
static mt_status reduce_basis(mt_linear *lin, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const mass = mt_arena_f64(&lin->scratch, (size_t)lin->sys->nq, 1);
    lin->e.n = lin->sys->nq - lin->e.qr.rank; /* idle spins may have been left out of it */
    lin->n = lin->e.n;
    lin->e.z = mt_arena_f64(&lin->reduced_mem, (size_t)lin->sys->nq, (size_t)lin->n);
    lin->z_error = mt_arena_f64(&lin->reduced_mem, (size_t)lin->sys->nq, (size_t)lin->n);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    diagonal_mass(lin, mass);
    MT_TRY(mt_eliminate_local(lin->a, mass, extent_of(lin), &lin->scratch, &lin->e,
                              lin->z_error, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Rounding errors of the entries of a row over local freedoms. */
static void row_error(const double row[MT_LOCAL], double extent, double error[MT_LOCAL])
{
    double most = 0.0; /* of the translations: what an arm stands on */
    for (int k = 0; k < MT_LOCAL; k++) {
        most = k % 6 < 3 && fabs(row[k]) > most ? fabs(row[k]) : most;
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        const double arm = k % 6 < 3 ? 0.0 : most * extent;
        error[k] = ROW_ULPS * DBL_EPSILON * (fabs(row[k]) + arm);
    }
}

/* Rounding errors of the entries of the rows over the states. */
static mt_status row_errors(mt_linear *lin, int kind, double extent, mt_err *err)
{
    const mt_term_list *const list = &lin->list[kind];
    double *at =
        mt_arena_f64(&lin->reduced_mem, (size_t)lin->full[kind].start[list->n_rows], 1);
    lin->full_error[kind] = at;
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    for (int i = 0; i < list->n_rows; i++) {
        const int *const body = list->terms[list->row_term[i]].body;
        const double *const row = lin->rows[kind] + ((ptrdiff_t)i * MT_LOCAL);
        double error[MT_LOCAL];
        row_error(row, extent, error);
        for (int k = 0; k < MT_LOCAL; k++) {
            if (row[k] != 0.0 && mt_local_dof(lin->sys, body, k) >= 0) {
                *at++ = error[k];
            }
        }
    }
    return MT_OK;
}

/* Rows of the basis and of the bounds of its errors, without the entries that are 0 in both:
 * the basis is local to the bodies. */
typedef struct basis_rows {
    int *start;  /* [nq + 1] */
    int *column; /* [start[nq]], as the others */
    double *z;
    double *error;
} basis_rows;

/* In scratch. */
static mt_status take_basis_rows(mt_linear *lin, basis_rows *out, mt_err *err)
{
    const ptrdiff_t nq = lin->sys->nq;
    const size_t entries = (size_t)nq * (size_t)lin->n;
    int at = 0;
    out->start = mt_arena_int(&lin->scratch, (size_t)nq + 1);
    out->column = mt_arena_int(&lin->scratch, entries);
    out->z = mt_arena_f64(&lin->scratch, entries, 1);
    out->error = mt_arena_f64(&lin->scratch, entries, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (ptrdiff_t j = 0; j < nq; j++) {
        out->start[j] = at;
        for (int c = 0; c < lin->n; c++) {
            const double z = lin->e.z[j + (c * nq)];
            const double error = lin->z_error[j + (c * nq)];
            if (z != 0.0 || error != 0.0) {
                out->column[at] = c;
                out->z[at] = z;
                out->error[at++] = error;
            }
        }
    }
    out->start[nq] = at;
    return MT_OK;
}

/* out[n] = Z^T row, error[n] its bound. */
static void project_row(const mt_linear *lin, int kind, size_t row, const basis_rows *basis,
                        double *out, double *error)
{
    const mt_rows *const rows = &lin->full[kind];
    for (int k = rows->start[row]; k < rows->start[row + 1]; k++) {
        const int j = rows->index[k];
        const double value = rows->value[k];
        const double df = lin->full_error[kind][k];
        for (int at = basis->start[j]; at < basis->start[j + 1]; at++) {
            const int c = basis->column[at];
            out[c] += value * basis->z[at];
            error[c] += (fabs(value) * basis->error[at]) + (df * fabs(basis->z[at]));
        }
    }
}

static mt_status reduce_rows(mt_linear *lin, int kind, const basis_rows *basis, mt_err *err)
{
    const mt_term_list *const list = &lin->list[kind];
    const size_t n = (size_t)lin->n;
    const size_t rows = (size_t)list->n_rows;
    const bool kept = kind == MT_TERM_STIFFNESS;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const error =
        mt_arena_f64(kept ? &lin->reduced_mem : &lin->scratch, n, kept ? rows : 1);
    lin->reduced[kind] = mt_arena_f64(&lin->reduced_mem, n, rows);
    MT_TRY(mt_arena_check(kept ? &lin->reduced_mem : &lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    for (size_t i = 0; i < rows; i++) {
        double *const out = lin->reduced[kind] + (i * n);
        double *const bound = error + (kept ? i * n : 0);
        memset(bound, 0, n * sizeof *bound);
        project_row(lin, kind, i, basis, out, bound);
        for (size_t c = 0; c < n; c++) {
            out[c] = fabs(out[c]) <= bound[c] ? 0.0 : out[c];
        }
    }
    mt_rows_of_columns(lin->n, list->n_rows, lin->reduced[kind], &lin->reduced_mem,
                       &lin->entries[kind]);
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    if (kept) {
        lin->noise = error;
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* reduced = Z^T row for all rows of all kinds at the present position; entries that are
 * rounding are set to 0, and rows without others are blocked. After the basis; in the memory of
 * the geometry. O(rows n). */
static mt_status reduce_all_rows(mt_linear *lin, mt_err *err)
{
    const double extent = extent_of(lin);
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    basis_rows basis;
    MT_TRY(take_basis_rows(lin, &basis, err));
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        MT_TRY(row_errors(lin, kind, extent, err));
        MT_TRY(reduce_rows(lin, kind, &basis, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* Geometries that configurations of one shape share. */

/* Room for one more system and n more geometries. */
static bool grow_geometry_pool(mt_geometries *pool, int n)
{
    mt_linear **const systems =
        realloc((void *)pool->systems, ((size_t)pool->n + 1) * sizeof(mt_linear *));
    if (systems != NULL) {
        pool->systems = systems;
    }
    mt_geometry **const all =
        realloc((void *)pool->all, ((size_t)pool->n_all + (size_t)n) * sizeof(mt_geometry *));
    if (all != NULL) {
        pool->all = all;
    }
    return systems != NULL && all != NULL;
}

static void enter(mt_geometries *pool, mt_linear *lin)
{
    pool->systems[pool->n++] = lin;
    lin->pool = pool;
}

static void dissolve(mt_geometries *pool)
{
    for (int i = 0; i < pool->n_all; i++) {
        mt_arena_free(&pool->all[i]->mem);
        free(pool->all[i]);
    }
    free((void *)pool->all);
    free((void *)pool->systems);
    free(pool);
}

/* Create one for a system that shares with none. Fails: MT_E_MEMORY. */
static mt_status open_geometry(mt_linear *lin, mt_err *err)
{
    const size_t n = (size_t)lin->sys->n_inputs;
    mt_geometries *const pool = calloc(1, sizeof *pool);
    mt_geometry *const g = calloc(1, sizeof *g + (n * sizeof g->at[0]));
    if (pool == NULL || g == NULL || !grow_geometry_pool(pool, 1) ||
        mt_arena_init(&g->mem, 0, err) != MT_OK) {
        if (pool != NULL) {
            dissolve(pool);
        }
        free(g);
        return mt_fail_memory(err);
    }
    g->users = 1;
    pool->all[pool->n_all++] = g;
    lin->geometry = g;
    enter(pool, lin);
    return MT_OK;
}

/* Invalidate geometries made by a system that is deleted: their closure's factors point into
 * it. */
static void forget_maker(const mt_geometries *pool, const mt_linear *maker)
{
    for (int i = 0; i < pool->n; i++) {
        mt_linear *const other = pool->systems[i];
        if (other->geometry->maker == maker) {
            other->stages.valid[MT_STAGE_GEOMETRY] = false;
        }
    }
    for (int i = 0; i < pool->n_all; i++) {
        if (pool->all[i]->maker == maker) {
            pool->all[i]->made = false;
        }
    }
}

/* Remove the system; the geometry it made is no longer used. */
static void leave_geometry(mt_linear *lin)
{
    mt_geometries *const pool = lin->pool;
    if (pool == NULL) {
        return;
    }
    forget_maker(pool, lin);
    lin->geometry->users--;
    for (int i = 0; i < pool->n; i++) {
        if (pool->systems[i] == lin) {
            pool->systems[i] = pool->systems[--pool->n];
            break;
        }
    }
    if (pool->n == 0) {
        dissolve(pool);
    }
    lin->pool = NULL;
}

static void stand_on(mt_linear *lin, mt_geometry *g)
{
    lin->geometry->users--;
    g->users++;
    lin->geometry = g;
}

/* Use an empty geometry that no other system uses. */
static void renew_geometry(mt_linear *lin)
{
    const mt_geometries *const pool = lin->pool;
    for (int i = 0; i < pool->n_all && lin->geometry->users > 1; i++) {
        if (pool->all[i]->users == 0) {
            stand_on(lin, pool->all[i]);
        }
    }
    mt_geometry *const g = lin->geometry;
    assert(g->users == 1);
    g->made = false;
    g->sloped = false;
    mt_arena_clear(&g->mem);
}

/* Mark it as valid for these inputs. */
static void mark_geometry_made(mt_linear *lin, const double *inputs)
{
    mt_geometry *const g = lin->geometry;
    g->before_tangent = mt_arena_get_mark(&g->mem);
    g->maker = lin;
    g->position = lin->position;
    g->e = lin->e;
    g->a = lin->a;
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        g->rows[kind] = lin->rows[kind];
        g->full[kind] = lin->full[kind];
    }
    for (int i = 0; i < lin->sys->n_inputs; i++) {
        g->at[i] = inputs[i];
    }
    g->made = true;
}

static void adopt(mt_linear *lin)
{
    const mt_geometry *const g = lin->geometry;
    lin->position = g->position;
    lin->position.sys = lin->sys;
    lin->e = g->e;
    lin->a = g->a;
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        lin->rows[kind] = g->rows[kind];
        lin->full[kind] = g->full[kind];
    }
    mt_data_vecs(&lin->data);
    mt_data_targets(&lin->data);
    mt_data_rest(&lin->data, lin->position.reference.pose);
}

/* Use a geometry that another system made with the same bits of the inputs of `moves`. False:
 * none. */
static bool take_geometry(mt_linear *lin, const uint64_t *moves, const double *inputs)
{
    const mt_geometries *const pool = lin->pool;
    for (int i = 0; i < pool->n_all && pool->n > 1; i++) {
        mt_geometry *const g = pool->all[i];
        if (g->made && stages_same(&lin->stages, moves, g->at, inputs)) {
            stand_on(lin, g);
            adopt(lin);
            return true;
        }
    }
    return false;
}

/* lin, which shares with none yet, shares with `with` from now on. Fails: MT_E_MEMORY. */
static mt_status join_geometries(mt_linear *lin, mt_linear *with, mt_err *err)
{
    mt_geometries *const own = lin->pool;
    assert(own->n == 1);
    if (!grow_geometry_pool(with->pool, own->n_all)) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < own->n_all; i++) {
        with->pool->all[with->pool->n_all++] = own->all[i];
    }
    own->n_all = 0;
    enter(with->pool, lin);
    dissolve(own);
    return MT_OK;
}

/* Linearisation. */

void mt_linear_delete(mt_linear *lin)
{
    if (lin != NULL) {
        mt_arena_free(&lin->scratch);
        mt_arena_free(&lin->reduced_mem);
        mt_arena_free(&lin->start.mem);
        leave_geometry(lin);
        mt_arena_free(&lin->base);
        mt_profile_add(lin->stages.profile, &lin->stages.counts);
        free(lin);
    }
}

/* Jets that are kept take a kilobyte each: few enough that a processor's cache has them. */
enum { MOST_JETS = 1000 };

/* Nothing is kept of systems with many measures. */
static void init_jets(mt_jets *jets, const mt_system *sys, mt_arena *mem)
{
    const size_t measures = (size_t)sys->n_measures;
    int n = 2 * sys->n_springs;
    for (int i = 0; i < sys->n_constraints; i++) {
        n += sys->constraints[i].terms;
    }
    *jets = (mt_jets){.pose = NULL};
    if (n > MOST_JETS) {
        return;
    }
    jets->n = n;
    jets->pose = mt_arena_alloc(mem, (size_t)sys->n_bodies, sizeof *jets->pose);
    jets->turn = mt_arena_f64(mem, measures, 1);
    jets->known = mt_arena_alloc(mem, (size_t)n, sizeof *jets->known);
    jets->jet = mt_arena_alloc(mem, (size_t)n, sizeof *jets->jet);
    jets->vec = mt_arena_alloc(mem, (size_t)sys->n_vecs, sizeof *jets->vec);
    jets->beam = mt_arena_f64(mem, measures, MT_BEAM_NUMBERS);
}

/* What equilibria keep from design to design. */
static mt_status init_start(mt_linear *lin, mt_err *err)
{
    lin->start = (mt_newton_start){.rows = -1};
    init_jets(&lin->start.jets, lin->sys, &lin->base);
    init_jets(&lin->start.end, lin->sys, &lin->base);
    lin->data.start = &lin->start;
    MT_TRY(mt_arena_check(&lin->base, err));
    return mt_arena_init(&lin->start.mem, 0, err);
}

static mt_status init_linear(mt_linear *lin, const mt_system *sys, mt_err *err)
{
    const size_t count = (size_t)sys->program.count;
    lin->sys = sys;
    MT_TRY(mt_arena_init(&lin->base, 0, err));
    MT_TRY(open_geometry(lin, err));
    MT_TRY(mt_arena_init(&lin->reduced_mem, 0, err));
    MT_TRY(mt_arena_init(&lin->scratch, 0, err));
    lin->value = mt_arena_f64(&lin->base, count, 1);
    lin->grad = mt_arena_f64(&lin->base, count, (size_t)sys->n_inputs);
    MT_TRY(mt_arena_check(&lin->base, err));
    MT_TRY(mt_data_init(&lin->data, sys, &lin->base, err));
    MT_TRY(mt_data_init(&lin->dual, sys, &lin->base, err));
    if (sys->loaded || sys->driven) {
        MT_TRY(init_start(lin, err));
    }
    lin->data.value = lin->value;
    lin->dual.value = lin->value;
    lin->dual.grad = lin->grad;
    MT_TRY(mt_placement_init(&lin->last, sys, &lin->base, err));
    MT_TRY(mt_placement_init(&lin->home, sys, &lin->base, err));
    lin->home_at = mt_arena_f64(&lin->base, (size_t)sys->n_inputs, 1);
    MT_TRY(mt_terms_new(sys, &lin->base, lin->list, err));
    const size_t terms = (size_t)lin->list[MT_TERM_STIFFNESS].n_terms;
    lin->coupling = mt_arena_alloc(&lin->base, terms, sizeof *lin->coupling);
    lin->squared = mt_arena_alloc(&lin->base, terms, sizeof *lin->squared);
    MT_TRY(mt_arena_check(&lin->base, err));
    mt_couplings_find(lin, lin->coupling);
    stages_init(&lin->stages, sys, lin->list, &lin->base);
    lin->forced = mt_arena_alloc(&lin->base, (size_t)lin->stages.words, sizeof *lin->forced);
    lin->stages.profile = sys->run->profile;
    return mt_arena_check(&lin->base, err);
}

mt_status mt_linear_new(const mt_system *sys, mt_linear **out, mt_err *err)
{
    mt_linear *const lin = calloc(1, sizeof *lin);
    *out = NULL;
    if (lin == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = init_linear(lin, sys, err);
    if (rc != MT_OK) {
        mt_linear_delete(lin);
        return rc;
    }
    *out = lin;
    return MT_OK;
}

/* Rows of K are gradients, which forces that are told one by one have already. */
static void stiffness_rows(const mt_linear *lin, mt_cx *rows)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    int at = 0;
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        mt_cx *const own = rows + ((ptrdiff_t)t->first * MT_LOCAL);
        while (at < lin->n_pieces && lin->pieces[at].spring >= 0 &&
               lin->pieces[at].spring < t->source) {
            at++;
        }
        if (at == lin->n_pieces || lin->pieces[at].spring != t->source) {
            mt_term_rows(&lin->data, MT_TERM_STIFFNESS, t, lin->position.at.pose, own);
            continue;
        }
        for (int k = 0; k < t->count * MT_LOCAL; k++) {
            own[k] = lin->pieces[at + (k / MT_LOCAL)].g[k % MT_LOCAL];
        }
    }
}

static mt_status evaluate_rows(mt_linear *lin, mt_err *err)
{
    for (int kind = 0; kind < MT_TERM_KINDS; kind++) {
        const mt_term_list *const list = &lin->list[kind];
        const size_t size = (size_t)list->n_rows * MT_LOCAL;
        lin->rows[kind] = mt_arena_f64(&lin->geometry->mem, size, 1);
        const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
        mt_cx *const rows = mt_arena_alloc(&lin->scratch, size, sizeof *rows);
        MT_TRY(mt_arena_check(&lin->geometry->mem, err));
        MT_TRY(mt_arena_check(&lin->scratch, err));
        if (kind == MT_TERM_STIFFNESS && lin->pieces != NULL) {
            stiffness_rows(lin, rows);
        } else {
            mt_rows_eval(&lin->data, (mt_term_kind)kind, list, lin->position.at.pose, rows);
        }
        for (size_t i = 0; i < size; i++) {
            lin->rows[kind][i] = creal(rows[i]);
        }
        mt_arena_rewind(&lin->scratch, mark);
        mt_rows_over_states(lin->sys, list, lin->rows[kind], &lin->geometry->mem,
                            &lin->full[kind]);
        MT_TRY(mt_arena_check(&lin->geometry->mem, err));
    }
    return MT_OK;
}

/* Forces below this many times the rounding of the positions are none: what Newton leaves of a
 * spring that nothing stretches. */
static const double NO_FORCE = 1e4;

/* Constraints at the final position, and the geometric stiffness where something loads the
 * mechanism. */
static mt_status constrain(mt_linear *lin, mt_err *err)
{
    const mt_system *const sys = lin->sys;
    const ptrdiff_t nq = sys->nq;
    mt_lagrangian l;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    const bool loaded = lin->position.equilibrium.active;
    const mt_newton_residual *const left = &lin->position.equilibrium.left;
    const int all = sys->n_constraints;
    lin->m = all - sys->n_trims;
    MT_TRY(mt_lagrangian_init(&l, sys, loaded, &lin->scratch, err));
    mt_cx *const lambda = mt_arena_alloc(&lin->scratch, (size_t)all, sizeof *lambda);
    lin->a = mt_arena_f64(&lin->geometry->mem, (size_t)lin->m, (size_t)nq);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_arena_check(&lin->geometry->mem, err));
    for (int i = 0; i < all && loaded; i++) {
        lambda[i] = lin->position.equilibrium.lambda[i] + left->lambda[i];
    }
    for (int i = 0; i < sys->n_trims; i++) {
        l.trim_force.of[i] = lin->position.equilibrium.trim_force.of[i] + left->trim.of[i];
    }
    if (loaded) {
        MT_TRY(mt_lagrangian_want_terms(&l, sys, &lin->geometry->mem, err));
        l.left = left->q;
        l.rest = lin->position.reference.pose;
        l.jets = &lin->start.end;
    }
    mt_lagrangian_eval(&lin->data, MT_ENERGY_PHYSICAL, lin->position.drawn, &lin->position.at,
                       all, loaded ? lambda : NULL,
                       loaded ? MT_CURVATURE_GEOMETRIC : MT_CURVATURE_NONE, &l);
    for (ptrdiff_t j = 0; j < nq; j++) {
        for (ptrdiff_t i = 0; i < lin->m; i++) {
            lin->a[i + (j * lin->m)] = l.a[i + (j * all)];
        }
    }
    /* a driven mechanism that nothing else loads often goes to its place without stretching a
     * spring: then the position does not depend on any stiffness */
    lin->unstressed = loaded && sys->geometry_fixed && !sys->loaded &&
                      l.force_scale <= NO_FORCE * l.force_noise;
    lin->kg = NULL;
    lin->kg_terms = l.terms;
    lin->pieces = l.pieces;
    lin->push = l.push;
    lin->n_pieces = l.n_pieces;
    if (loaded && !lin->unstressed) {
        lin->kg = mt_arena_f64(&lin->geometry->mem, (size_t)nq, (size_t)nq);
        MT_TRY(mt_arena_check(&lin->geometry->mem, err));
        memcpy(lin->kg, l.h, (size_t)(nq * nq) * sizeof *lin->kg);
        mt_rows_of_columns((int)nq, (int)nq, lin->kg, &lin->geometry->mem, &lin->kg_rows);
        MT_TRY(mt_arena_check(&lin->geometry->mem, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    MT_TRY(mt_eliminate_factor(sys, lin->m, lin->a, &lin->geometry->mem, &lin->e, err));
    return mt_singular_refuse(&lin->data, &lin->position.at, &lin->e, &lin->scratch, err);
}

/* out (n x n) += c times the term's rows, lower triangle. */
static void add_term_square(const mt_linear *lin, int kind, const mt_term *t, double c,
                            double *out)
{
    const mt_rows *const rows = &lin->entries[kind];
    if (t->pair) {
        mt_rows_pair(rows, t->first, t->first + 1, c, lin->n, out);
        return;
    }
    for (int r = t->first; r < t->first + t->count; r++) {
        mt_rows_square(rows, r, c, lin->n, out);
    }
}

/* True where the sum can be left as it is after an interrupt; the caller checks again. */
static bool is_left(const mt_linear *lin)
{
    return lin->n >= MT_INTERRUPT_ORDER && mt_interrupted(lin->sys->run->interrupt);
}

/* out (n x n) += sum of the terms' contributions, lower triangle; which: 0 terms without
 * inputs, 1 terms with, 2 all. Springs with couplings that depend on no input are added as a
 * whole (add_couplings). */
static void add_terms(const mt_linear *lin, int kind, int which, double *out)
{
    const mt_term_list *const list = &lin->list[kind];
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        const double c = lin->value[t->coefficient];
        const bool apart = kind == MT_TERM_STIFFNESS && lin->coupling[i] == MT_COUPLING_WHOLE;
        if (is_left(lin)) {
            return;
        }
        if ((which == 2 || t->varies == (which == 1)) && c != 0.0 && !apart) {
            add_term_square(lin, kind, t, c, out);
        }
    }
}

/* k += the coupled springs that depend on no input, by their squares where possible, which
 * makes cancelling entries exactly 0. */
static void add_couplings(const mt_linear *lin, double *k)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        if (lin->coupling[i] == MT_COUPLING_WHOLE && lin->squared[i]) {
            mt_couplings_add(lin, t, k);
        } else if (lin->coupling[i] == MT_COUPLING_WHOLE) {
            add_term_square(lin, MT_TERM_STIFFNESS, t, lin->value[t->coefficient], k);
        }
    }
}

void mt_linear_add_load(const mt_linear *lin, double scale, const double *phi, double *out)
{
    for (int j = 0; j < lin->sys->nq && lin->kg != NULL; j++) {
        if (phi[j] != 0.0) {
            mt_rows_axpy(&lin->kg_rows, j, scale * phi[j], out);
        }
    }
}

/* lin->g_fixed := Z^T Kg Z, of which both are sparse. */
static mt_status reduce_load(mt_linear *lin, mt_err *err)
{
    const int nq = lin->sys->nq;
    const ptrdiff_t n = lin->n;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const kz = mt_arena_f64(&lin->scratch, (size_t)nq, 1);
    mt_rows z;
    mt_rows_of_columns(nq, lin->n, lin->e.z, &lin->scratch, &z);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (ptrdiff_t c = 0; c < n; c++) {
        memset(kz, 0, (size_t)nq * sizeof *kz);
        mt_linear_add_load(lin, 1.0, lin->e.z + (c * nq), kz);
        for (int r = 0; r < lin->n; r++) {
            lin->g_fixed[r + (c * n)] = mt_rows_dot(&z, r, kz);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

static mt_status fixed_parts(mt_linear *lin, mt_err *err)
{
    const size_t n = (size_t)lin->n;
    lin->k = mt_arena_f64(&lin->reduced_mem, n, n);
    lin->m_r = mt_arena_f64(&lin->reduced_mem, n, n);
    lin->k_fixed = mt_arena_f64(&lin->reduced_mem, n, n);
    lin->m_fixed = mt_arena_f64(&lin->reduced_mem, n, n);
    const size_t rows = (size_t)lin->list[MT_TERM_STIFFNESS].n_rows;
    lin->factor_b = mt_arena_f64(&lin->reduced_mem, rows, n);
    lin->factor_c = mt_arena_f64(&lin->reduced_mem, rows, 1);
    lin->factor_noise = mt_arena_f64(&lin->reduced_mem, rows, n);
    lin->factor_g = mt_arena_f64(&lin->reduced_mem, n, n);
    lin->g_fixed = mt_arena_f64(&lin->reduced_mem, n, n);
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    if (lin->kg != NULL) {
        MT_TRY(reduce_load(lin, err));
        memcpy(lin->k_fixed, lin->g_fixed, n * n * sizeof *lin->k_fixed);
    }
    add_terms(lin, MT_TERM_STIFFNESS, 0, lin->k_fixed);
    add_terms(lin, MT_TERM_MASS, 0, lin->m_fixed);
    for (size_t r = 0; r < rows; r++) {
        for (size_t c = 0; c < n; c++) {
            lin->factor_b[r + (c * rows)] = lin->reduced[MT_TERM_STIFFNESS][c + (r * n)];
            lin->factor_noise[r + (c * rows)] = lin->noise[c + (r * n)];
        }
    }
    mt_couplings_square(lin, MT_COUPLING_WHOLE);
    add_couplings(lin, lin->k_fixed);
    return MT_OK;
}

static void assemble_mass(mt_linear *lin)
{
    const size_t n = (size_t)lin->n;
    memcpy(lin->m_r, lin->m_fixed, n * n * sizeof *lin->m_r);
    add_terms(lin, MT_TERM_MASS, 1, lin->m_r);
    mt_symmetrise_lower(lin->n, lin->m_r);
    lin->mass_version++;
}

static void assemble_stiffness(mt_linear *lin)
{
    const size_t n = (size_t)lin->n;
    const mt_term_list *const stiffness = &lin->list[MT_TERM_STIFFNESS];
    memcpy(lin->k, lin->k_fixed, n * n * sizeof *lin->k);
    add_terms(lin, MT_TERM_STIFFNESS, 1, lin->k);
    mt_symmetrise_lower(lin->n, lin->k);
    mt_couplings_square(lin, MT_COUPLING_VARIES);
    memcpy(lin->factor_g, lin->g_fixed, n * n * sizeof *lin->factor_g);
    lin->has_factor_g = lin->kg != NULL;
    for (int i = 0; i < stiffness->n_terms; i++) {
        const mt_term *const t = &stiffness->terms[i];
        const double c = lin->value[t->coefficient];
        const bool square = !t->pair && c >= 0.0;
        if (lin->squared[i]) {
            continue; /* the rows of its spring stand there already */
        }
        for (int r = 0; r < t->count; r++) {
            lin->factor_c[t->first + r] = square ? c : 0.0;
        }
        if (!square) {
            add_term_square(lin, MT_TERM_STIFFNESS, t, c, lin->factor_g);
            lin->has_factor_g = true;
        }
    }
    lin->stiffness_version++;
}

static mt_status find_position(mt_linear *lin, const double *inputs, mt_err *err)
{
    const bool again = !lin->follow && lin->has_home &&
                       stages_same(&lin->stages, lin->sys->places, lin->home_at, inputs);
    const mt_placement *const last = lin->follow && lin->has_last ? &lin->last : NULL;
    renew_geometry(lin);
    mt_arena_clear(&lin->scratch); /* of what a failure left */
    mt_data_vecs(&lin->data);
    return mt_position_solve(lin->sys, &lin->data, again ? &lin->home : last,
                             again ? MT_POSITION_AGAIN : MT_POSITION_QUICK, &lin->geometry->mem,
                             &lin->position, err);
}

static void keep_last(mt_linear *lin)
{
    if (lin->sys->driven) {
        mt_placement_copy(lin->sys, &lin->position.driven, &lin->last);
        lin->has_last = true;
    }
}

/* Of the first update alone: what later ones give depends on no others. */
static void keep_home(mt_linear *lin, const double *inputs)
{
    lin->has_home = !lin->follow && lin->sys->driven && lin->position.direct;
    if (lin->has_home) {
        mt_placement_copy(lin->sys, &lin->position.driven, &lin->home);
    }
    if (lin->has_home && lin->sys->n_inputs > 0) {
        memcpy(lin->home_at, inputs, (size_t)lin->sys->n_inputs * sizeof *inputs);
    }
}

static mt_status find_position_and_rows(mt_linear *lin, const double *inputs, mt_err *err)
{
    const bool first = !lin->had_first;
    lin->had_first = true;
    MT_TRY(find_position(lin, inputs, err));
    MT_TRY(constrain(lin, err));
    keep_last(lin); /* not from a dead centre: which way led on would be open */
    if (first) {
        keep_home(lin, inputs);
    }
    MT_TRY(mt_interrupt_check(lin->sys->run->interrupt, err));
    MT_TRY(evaluate_rows(lin, err));
    return mt_interrupt_check(lin->sys->run->interrupt, err);
}

static mt_status reduce_matrices(mt_linear *lin, mt_err *err)
{
    lin->stages.valid[MT_STAGE_STIFFNESS] = false;
    lin->stages.valid[MT_STAGE_MASS] = false;
    mt_arena_clear(&lin->reduced_mem);
    mt_arena_clear(&lin->scratch);
    MT_TRY(reduce_basis(lin, err));
    MT_TRY(mt_free_spin_remove(lin, err));
    MT_TRY(reduce_all_rows(lin, err));
    MT_TRY(mt_interrupt_check(lin->sys->run->interrupt, err));
    MT_TRY(fixed_parts(lin, err));
    return mt_interrupt_check(lin->sys->run->interrupt, err);
}

static mt_status where_in_model(const mt_linear *lin, mt_node bad, mt_status rc, mt_err *err)
{
    const mt_model *const model = lin->sys->model;
    for (int i = 0; i < model->n_parameters && bad != MT_NO_NODE; i++) {
        if (model->nums[model->parameters[i].value].addr == lin->sys->program.nodes[bad].addr) {
            return mt_err_in(err, rc, "parameter \"%s\"", model->parameters[i].name.s);
        }
    }
    return rc;
}

static mt_status run_program(mt_linear *lin, const double *inputs, bool with_gradient,
                             mt_err *err)
{
    const mt_program *const p = &lin->sys->program;
    mt_stages *const st = &lin->stages;
    mt_node bad = MT_NO_NODE;
    st->valid[MT_STAGE_PROGRAM] =
        st->valid[MT_STAGE_PROGRAM] && (lin->graded || !with_gradient);
    if (!mt_stages_begin(st, MT_STAGE_PROGRAM, st->all, inputs)) {
        return MT_OK;
    }
    lin->graded = with_gradient;
    double *const grad = with_gradient ? lin->grad : NULL;
    mt_status rc = MT_OK;
    if (!lin->started) {
        rc = mt_program_eval(p, inputs, lin->value, &bad, err);
        lin->started = rc == MT_OK;
    }
    if (rc == MT_OK) {
        rc = mt_program_again(p, inputs, lin->value, grad, &bad, err);
    }
    if (rc != MT_OK) {
        return where_in_model(lin, bad, rc, err);
    }
    mt_stages_done(st, MT_STAGE_PROGRAM, inputs);
    return MT_OK;
}

/* The inputs that the geometry depends on. */
static const uint64_t *moves_with(const mt_linear *lin)
{
    const mt_system *const sys = lin->sys;
    const bool forced = sys->loaded || (sys->driven && !lin->unstressed);
    return forced ? lin->stages.loaded : sys->shape;
}

static mt_status run_geometry(mt_linear *lin, const double *inputs, mt_err *err)
{
    mt_stages *const st = &lin->stages;
    const uint64_t *const moves = moves_with(lin);
    if (!mt_stages_begin(st, MT_STAGE_GEOMETRY, moves, inputs)) {
        return MT_OK;
    }
    lin->tangent = NULL;
    st->valid[MT_STAGE_TANGENT] = false;
    st->valid[MT_STAGE_REDUCTION] = false;
    if (take_geometry(lin, moves, inputs)) {
        stages_shared(st, MT_STAGE_GEOMETRY, inputs);
        return MT_OK;
    }
    MT_TRY(find_position_and_rows(lin, inputs, err));
    mark_geometry_made(lin, inputs);
    mt_stages_done(st, MT_STAGE_GEOMETRY, inputs);
    return MT_OK;
}

/* Besides the geometry: pivots of a basis that has to be made again are chosen by the
 * masses. */
static const uint64_t *reduces_with(const mt_linear *lin)
{
    const bool once = stages_empty(&lin->stages, moves_with(lin));
    return lin->free_spin_varies ? lin->stages.all
                                 : (once ? lin->stages.none : lin->stages.mass);
}

static mt_status run_tangent(mt_linear *lin, const double *inputs, mt_err *err)
{
    mt_stages *const st = &lin->stages;
    const uint64_t *const moves = moves_with(lin);
    if (stages_empty(st, moves)) {
        lin->tangent = NULL;
        return MT_OK;
    }
    mt_geometry *const g = lin->geometry;
    if (mt_stages_begin(st, MT_STAGE_TANGENT, moves, inputs)) {
        if (g->sloped && lin->pool->n > 1) {
            lin->tangent = g->tangent;
            stages_shared(st, MT_STAGE_TANGENT, inputs);
            return MT_OK;
        }
        mt_arena_rewind(&g->mem, g->before_tangent);
        MT_TRY(mt_tangent_update(lin, moves, err));
        g->tangent = lin->tangent;
        g->sloped = true;
        mt_stages_done(st, MT_STAGE_TANGENT, inputs);
    }
    return MT_OK;
}

mt_status mt_linear_update(mt_linear *lin, const double *inputs, bool with_gradient,
                           mt_err *err)
{
    mt_stages *const st = &lin->stages;
    MT_TRY(mt_interrupt_check(lin->sys->run->interrupt, err));
    MT_TRY(run_program(lin, inputs, with_gradient, err));
    MT_TRY(run_geometry(lin, inputs, err));
    if (mt_stages_begin(st, MT_STAGE_REDUCTION, reduces_with(lin), inputs)) {
        MT_TRY(reduce_matrices(lin, err));
        mt_stages_done(st, MT_STAGE_REDUCTION, inputs);
    }
    if (mt_stages_begin(st, MT_STAGE_STIFFNESS, st->stiffness, inputs)) {
        assemble_stiffness(lin);
        mt_stages_done(st, MT_STAGE_STIFFNESS, inputs);
    }
    if (mt_stages_begin(st, MT_STAGE_MASS, st->mass, inputs)) {
        assemble_mass(lin);
        mt_stages_done(st, MT_STAGE_MASS, inputs);
    }
    if (is_left(lin)) { /* of a sum, too */
        st->valid[MT_STAGE_REDUCTION] = false;
        return mt_fail(err, MT_E_INTERRUPTED, "interrupted");
    }
    return with_gradient ? run_tangent(lin, inputs, err) : MT_OK;
}

mt_status mt_linear_set_inputs(mt_linear *lin, const double *inputs, mt_err *err)
{
    MT_TRY(mt_interrupt_check(lin->sys->run->interrupt, err));
    MT_TRY(run_program(lin, inputs, false, err));
    lin->stages.valid[MT_STAGE_GEOMETRY] = false;
    lin->stages.valid[MT_STAGE_TANGENT] = false;
    lin->stages.valid[MT_STAGE_REDUCTION] = false;
    MT_TRY(find_position(lin, inputs, err));
    keep_last(lin);
    return MT_OK;
}

void mt_linear_follow(mt_linear *lin, bool on)
{
    lin->follow = on;
    lin->has_last = false;
    lin->stages.valid[MT_STAGE_GEOMETRY] = false;
}

void mt_linear_first_input(mt_linear *lin, int first)
{
    assert(lin->pool->n == 1);
    lin->first_input = first;
    lin->stages.valid[MT_STAGE_TANGENT] = false;
}

const mt_system *mt_linear_system(const mt_linear *lin)
{
    return lin->sys;
}

const mt_state *mt_linear_position(const mt_linear *lin)
{
    return &lin->position;
}

int mt_linear_freedoms(const mt_linear *lin)
{
    return lin->n;
}

int mt_linear_equations(const mt_linear *lin)
{
    return lin->m;
}

mt_reduced mt_linear_reduced(const mt_linear *lin)
{
    return (mt_reduced){.n = lin->n,
                        .k = lin->k,
                        .m = lin->m_r,
                        .stiffness_version = lin->stiffness_version,
                        .mass_version = lin->mass_version,
                        .loaded = lin->kg != NULL,
                        .rows = lin->list[MT_TERM_STIFFNESS].n_rows,
                        .b = lin->factor_b,
                        .c = lin->factor_c,
                        .noise = lin->factor_noise,
                        .g = lin->has_factor_g ? lin->factor_g : NULL};
}

const mt_term_list *mt_linear_terms(const mt_linear *lin, mt_term_kind kind)
{
    return &lin->list[kind];
}

const double *mt_linear_row(const mt_linear *lin, mt_term_kind kind, int row)
{
    return lin->reduced[kind] + ((ptrdiff_t)row * lin->n);
}

const double *mt_linear_fixed(const mt_linear *lin, mt_term_kind kind)
{
    assert(kind == MT_TERM_STIFFNESS || kind == MT_TERM_MASS);
    return kind == MT_TERM_STIFFNESS ? lin->k_fixed : lin->m_fixed;
}

mt_stages *mt_linear_stages(mt_linear *lin)
{
    return &lin->stages;
}

double mt_linear_value(const mt_linear *lin, mt_node node)
{
    return lin->value[node];
}

double mt_linear_slope(const mt_linear *lin, mt_node node, int input)
{
    return lin->grad[((ptrdiff_t)node * lin->sys->n_inputs) + input];
}

int mt_linear_free_spins(const mt_linear *lin, const bool **free_spins)
{
    if (free_spins != NULL) {
        *free_spins = lin->free_spins;
    }
    return lin->n_free_spins;
}

void mt_linear_expand(const mt_linear *lin, int cols, const double *y, double *phi)
{
    mt_gemm(false, false, lin->sys->nq, cols, lin->n, 1.0, lin->e.z, lin->sys->nq, y, lin->n,
            0.0, phi, lin->sys->nq);
}

/* Stages shared with another evaluator. */

/* Only geometry that an input moves is worth sharing; loaded or driven systems depend on more
 * than their shape. */
static mt_status can_share(const mt_system *a, const mt_system *b, bool *can, mt_err *err)
{
    *can = false;
    const bool plain = !a->loaded && !a->driven && !b->loaded && !b->driven;
    return plain && !a->geometry_fixed ? mt_system_same_shape(a, b, can, err) : MT_OK;
}

mt_status mt_linear_share(mt_linear *lin, mt_linear *with, bool *shared, mt_err *err)
{
    *shared = false;
    if (lin->pool->n > 1 || lin->first_input != with->first_input) {
        return MT_OK;
    }
    MT_TRY(can_share(lin->sys, with->sys, shared, err));
    const mt_status rc = *shared ? join_geometries(lin, with, err) : MT_OK;
    *shared = *shared && rc == MT_OK;
    return rc;
}

/* Dampers and loss factors as matrices: sums of the same rows as those of the springs. */

double mt_linear_loss(const mt_linear *lin, const mt_term *t)
{
    return t->loss == MT_NO_NODE ? 0.0 : lin->value[t->loss] * lin->value[t->coefficient];
}

void mt_linear_damping(const mt_linear *lin, double *c)
{
    const mt_term_list *const list = &lin->list[MT_TERM_DAMPING];
    memset(c, 0, (size_t)lin->n * (size_t)lin->n * sizeof *c);
    for (int i = 0; i < list->n_terms; i++) {
        const double value = lin->value[list->terms[i].coefficient];
        if (value != 0.0) {
            add_term_square(lin, MT_TERM_DAMPING, &list->terms[i], value, c);
        }
    }
    mt_symmetrise_lower(lin->n, c);
}

bool mt_linear_structural(const mt_linear *lin, double *h)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    bool any = false;
    if (h != NULL) {
        memset(h, 0, (size_t)lin->n * (size_t)lin->n * sizeof *h);
    }
    for (int i = 0; i < list->n_terms; i++) {
        const double value = mt_linear_loss(lin, &list->terms[i]);
        any = any || value != 0.0;
        if (value != 0.0 && h != NULL) {
            add_term_square(lin, MT_TERM_STIFFNESS, &list->terms[i], value, h);
        }
    }
    if (h != NULL) {
        mt_symmetrise_lower(lin->n, h);
    }
    return any;
}

/* What the elimination found, in the user's words: redundant joints, directions named by
 * body. */

int mt_linear_redundant(const mt_linear *lin)
{
    return lin->m - lin->e.qr.rank;
}

mt_status mt_linear_redundant_set(mt_linear *lin, int k, mt_arena *mem, mt_joint_names *out,
                                  mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    double *const null = mt_arena_f64(&lin->scratch, (size_t)lin->m, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(mt_eliminate_left_null(&lin->e, k, null, &lin->scratch, err));
    MT_TRY(mt_name_joints(lin->sys, lin->m, null, mem, out, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

mt_status mt_linear_nearness(mt_linear *lin, mt_arena *mem, mt_nearness *out, mt_err *err)
{
    return mt_singular_nearness(&lin->data, &lin->position.at, &lin->e, &lin->scratch, mem, out,
                                err);
}

void mt_linear_name_direction(const mt_linear *lin, const double *y, char *text, size_t size)
{
    mt_name_motion(lin->sys, &lin->e, y, text, size);
}
