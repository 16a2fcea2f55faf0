/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rigid-body motions follow: in (y, r) with K = diag(I, 0), r minimises the kinetic energy of
 * y,
 *     M_rr r = -M_ry y,    A = M_yy - M_yr M_rr^-1 M_ry,    A y = y / lambda.
 */
#include "analysis/lowest.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/run.h"
#include "linalg/dense.h"
#include "modal/modes.h"
#include "modal/sparse.h"

double mt_lowest_bodies(const mt_model *model, int configuration)
{
    double bodies = 0.0;
    for (int i = 0; i < model->n_bodies; i++) {
        bodies += mt_model_present(&model->bodies[i].in, configuration) ? 1.0 : 0.0;
    }
    for (int i = 0; i < model->n_links; i++) {
        const mt_link *const l = &model->links[i];
        bodies += mt_model_present(&l->in, configuration) ? (double)l->elements + 1.0 : 0.0;
    }
    return bodies;
}

/* What the search for modes consists of, where the progress is told. */
static const char ITERATIONS[] = "iterations";

typedef struct mt_lowest_operation operation;

/* What follows a motion is solved for, and what that leaves once more. */
enum { SOLUTIONS = 2 };

/* r[n_rigid] := M_rr^-1 r. */
static void lowest_solve_free(const operation *o)
{
    mt_tri_solve(false, o->tree->n_rigid, 1, o->m_rr, o->r, o->tree->n_rigid);
    mt_tri_solve(true, o->tree->n_rigid, 1, o->m_rr, o->r, o->tree->n_rigid);
}

static mt_status multiply_by_condensed_mass(const operation *o, const double *x, double *y,
                                            mt_err *err)
{
    const mt_tree *const t = o->tree;
    MT_TRY(mt_interrupt_check(t->sys->run->interrupt, err));
    mt_progress_done(t->sys->run->progress, o->told);
    mt_tree_motion(t, x, NULL, o->v);
    mt_tree_momentum(t, o->v, o->f, y, o->r);
    if (t->n_rigid > 0) {
        lowest_solve_free(o);
        mt_gemv(false, t->n_x, t->n_rigid, -1.0, o->m_yr, t->n_x, o->r, 1.0, y);
    }
    return MT_OK;
}

static mt_status apply_condensed_mass(void *context, int count, const double *x, double *y,
                                      mt_err *err)
{
    const operation *const o = context;
    for (int c = 0; c < count; c++) {
        const ptrdiff_t at = (ptrdiff_t)o->tree->n_x * c;
        MT_TRY(multiply_by_condensed_mass(o, x + at, y + at, err));
    }
    return MT_OK;
}

/* As apply_condensed_mass, from the momentum of the whole motion (x, along): x and the motion
 * that follows cancel in the motion itself. *open: the mass of the remaining error of
 * `along`. */
static void apply_to_whole_motion(const operation *o, const double *x, double *y, double *open)
{
    const mt_tree *const t = o->tree;
    const int n = t->n_rigid;
    memset(o->along, 0, (size_t)n * sizeof *o->along);
    for (int step = 0; step <= (n > 0 ? SOLUTIONS : 0); step++) {
        mt_tree_motion(t, x, o->along, o->v);
        mt_tree_momentum(t, o->v, o->f, y, o->r);
        memcpy(o->left, o->r, (size_t)n * sizeof *o->left);
        lowest_solve_free(o);
        mt_axpy(n, step < SOLUTIONS ? -1.0 : 0.0, o->r, o->along);
    }
    *open = mt_dot(n, o->left, o->r);
}

static mt_status refine_quotients(void *context, int count, const double *x, double *y,
                                  mt_lowest_quotient *own, mt_err *err)
{
    const operation *const o = context;
    for (int i = 0; i < count; i++) {
        const ptrdiff_t at = (ptrdiff_t)o->tree->n_x * i;
        mt_tree_quotient q;
        double open = 0.0;
        MT_TRY(mt_interrupt_check(o->tree->sys->run->interrupt, err));
        apply_to_whole_motion(o, x + at, y + at, &open);
        mt_tree_rate(o->tree, x + at, o->along, o->v, o->f, &q);
        own[i] =
            (mt_lowest_quotient){.lambda = q.lambda, .noise = q.noise + fabs(open / q.mass)};
    }
    return MT_OK;
}

static mt_status count_modes_below(void *context, double tau, int known, int *count,
                                   bool *certain, mt_err *err)
{
    (void)known;
    const operation *const o = context;
    MT_TRY(mt_interrupt_check(o->tree->sys->run->interrupt, err));
    return mt_tree_count(o->tree, tau, o->scratch, count, certain, err);
}

/* Masses of the rigid-body motions; *regular: each has some. */
static mt_status free_motions(operation *o, bool *regular, mt_arena *mem, mt_err *err)
{
    const mt_tree *const t = o->tree;
    const size_t n = (size_t)t->n_rigid;
    o->m_yr = mt_arena_f64(mem, (size_t)t->n_x, n);
    o->m_rr = mt_arena_f64(mem, n, n);
    double *const none = mt_arena_f64(mem, (size_t)t->n_x, 1);
    double *const unit = mt_arena_f64(mem, n, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (size_t j = 0; j < n; j++) {
        unit[j] = 1.0;
        mt_tree_motion(t, none, unit, o->v);
        mt_tree_momentum(t, o->v, o->f, o->m_yr + ((size_t)t->n_x * j), o->m_rr + (n * j));
        unit[j] = 0.0;
    }
    int bad = -1;
    const mt_status rc = n == 0 ? MT_OK : mt_cholesky((int)n, o->m_rr, &bad, NULL);
    *regular = rc == MT_OK;
    return rc == MT_OK || rc == MT_E_NOT_SPD ? MT_OK : mt_fail(err, rc, "free motions");
}

static mt_status solve_lowest_modes(mt_lowest *l, mt_lowest_want want, mt_err *err)
{
    const mt_tree *const t = l->tree;
    const size_t motions = (size_t)t->n * (size_t)t->s;
    operation *const o = mt_arena_alloc(&l->mem, 1, sizeof *o);
    bool regular = false;
    double *const v = mt_arena_f64(&l->mem, motions, 1);
    double *const f = mt_arena_f64(&l->mem, motions, 1);
    double *const r = mt_arena_f64(&l->mem, (size_t)t->n_rigid, 3);
    MT_TRY(mt_arena_check(&l->mem, err));
    *o = (operation){.tree = t,
                     .v = v,
                     .f = f,
                     .r = r,
                     .along = r + t->n_rigid,
                     .left = r + ((ptrdiff_t)2 * t->n_rigid),
                     .scratch = &l->mem};
    l->operation = o;
    MT_TRY(free_motions(o, &regular, &l->mem, err));
    if (!regular) {
        (void)mt_snprintf(l->why, sizeof l->why, "a motion without stiffness has no mass");
        l->tree = NULL;
        return MT_OK;
    }
    l->way = MT_LOWEST_TREE;
    l->mass_kg = mt_tree_mass(t);
    const mt_lowest_problem p = {.n = t->n_x,
                                 .most = t->n_x,
                                 .n_rigid = t->n_rigid,
                                 .count = want.count,
                                 .shapes = want.shapes,
                                 .apply = apply_condensed_mass,
                                 .refine = refine_quotients,
                                 .below = count_modes_below,
                                 .context = o};
    mt_progress *const progress = t->sys->run->progress;
    o->told = mt_progress_begin(progress, ITERATIONS, 0);
    const mt_status rc = mt_modal_lowest(&p, &l->mem, &l->found, err);
    mt_progress_end(progress, o->told);
    return rc;
}

enum { WHY_SIZE = MT_ABSOLUTE_WHY + MT_SPARSE_WHY };

/* The iterations in coordinates of the bodies. */
typedef struct turns {
    const mt_run *run;
    bool told; /* where the progress is */
} turns;

static mt_status check_stop_request(void *context, mt_err *err)
{
    const turns *const t = context;
    mt_progress_done(t->run->progress, t->told);
    return mt_interrupt_check(t->run->interrupt, err);
}

/* Geometric stiffness of the loads in equilibrium. */
static mt_status load_bodies(mt_lowest *l, const mt_sparse_problem *p, mt_absolute_load *load,
                             bool *is, char *why, mt_err *err)
{
    const size_t rows = (size_t)p->a.n_rows;
    double *const f = mt_arena_f64(&l->mem, (size_t)p->n, 1);
    load->mu = mt_arena_f64(&l->mem, rows, 1);
    load->open = mt_arena_f64(&l->mem, rows, 1);
    MT_TRY(mt_arena_check(&l->mem, err));
    MT_TRY(mt_absolute_forces(&l->bodies, l->at, f, &l->mem, err));
    MT_TRY(mt_modal_balance(p, f, load->mu, load->open, is, err));
    if (!*is) {
        (void)mt_snprintf(why, MT_ABSOLUTE_WHY,
                          "sixteen digits do not hold its joints' forces");
        return MT_OK;
    }
    return mt_absolute_load_new(&l->bodies, l->at, &l->mem, load, is, why, err);
}

/* False where a small motion under load does not determine the modes: dependent equations may
 * become independent next to the equilibrium, and free motions are not bounded. */
static bool is_held(const mt_lowest *l, char *why)
{
    const mt_absolute *const o = &l->bodies;
    const mt_modes *const m = &l->found.modes;
    const bool dependent = o->n - o->a.n_rows < m->n;
    if (dependent || m->n_rigid > 0) {
        (void)mt_snprintf(why, MT_SPARSE_WHY, "%s",
                          dependent ? "equations of loaded joints follow from others"
                                    : "it is free to move under its load");
    }
    return !dependent && m->n_rigid == 0;
}

/* In coordinates of the bodies, in the drawn or equilibrium position. *rests: closed and in
 * equilibrium. */
static mt_status solve_bodies(mt_lowest *l, mt_lowest_want want, const mt_state *settled,
                              bool *is, bool *rests, char *why, mt_err *err)
{
    mt_absolute_load *const load = mt_arena_alloc(&l->mem, 1, sizeof *load);
    turns t = {.run = l->sys->run};
    mt_err own = {.code = MT_OK};
    mt_absolute *const o = &l->bodies;
    MT_TRY(mt_arena_check(&l->mem, err));
    *load = (mt_absolute_load){.mu = NULL};
    t.told = mt_progress_begin(t.run->progress, "matrices of the bodies", 0);
    const mt_status made = mt_absolute_new(l->sys, l->at, settled, &l->mem, o, is, why, err);
    mt_progress_end(t.run->progress, t.told);
    MT_TRY(made);
    mt_sparse_problem p = {.n = o->n,
                           .k = o->k,
                           .m = o->m,
                           .a = o->a,
                           .part = o->part,
                           .unit = o->unit,
                           .count = want.count,
                           .shapes = want.shapes,
                           .check = check_stop_request,
                           .context = &t};
    if (*is && l->sys->loaded) {
        MT_TRY(load_bodies(l, &p, load, is, why, err));
        p.g = &load->g;
        p.g_noise = load->noise;
    }
    l->problem = p;
    l->problem.check = NULL;
    l->problem.context = NULL;
    *rests = *is;
    if (!*is) {
        return MT_OK;
    }
    t.told = mt_progress_begin(t.run->progress, ITERATIONS, 0);
    const mt_status rc = mt_modal_sparse(&p, &l->mem, &l->found, &l->mu, is, why, &own);
    mt_progress_end(t.run->progress, t.told);
    if (rc == MT_E_NO_CONVERGENCE) {
        *is = false;
        (void)mt_snprintf(why, WHY_SIZE, "%s", own.text);
    } else if (rc != MT_OK) {
        return mt_fail(err, rc, "%s", own.text);
    }
    *is = *is && (!l->sys->loaded || is_held(l, why));
    return MT_OK;
}

/* Find the equilibrium under loads, without dense matrices, once; *is: found. */
static mt_status find_loaded_equilibrium(mt_lowest *l, bool *is, char *why, mt_err *err)
{
    mt_data data;
    mt_placement at;
    mt_err own = {.code = MT_OK};
    mt_status rc = MT_E_EQUILIBRIUM;
    if (!l->sought) {
        l->sought = true;
        MT_TRY(mt_absolute_stand(l->sys, NULL, l->at, &data, &at, &l->mem, err));
        rc = mt_position_solve(l->sys, &data, NULL, MT_POSITION_SPARSE, &l->mem, &l->position,
                               &own);
    }
    *is = rc == MT_OK;
    if (mt_is_final(rc)) {
        return mt_fail(err, rc, "%s", own.text);
    }
    if (!*is) {
        (void)mt_snprintf(why, WHY_SIZE,
                          "without dense matrices no place is found where it settles");
        l->position.sys = NULL;
    }
    return MT_OK;
}

/* In coordinates of the bodies, where those of a tree are not to be had. An equilibrium that
 * was found for the tree is that of the bodies, too, where they do not rest as drawn. */
static mt_status solve_sparse(mt_lowest *l, mt_lowest_want want, mt_err *err)
{
    const size_t told = strlen(l->why);
    char why[WHY_SIZE] = "";
    bool is = false;
    bool rests = false;
    const mt_system *const found = l->position.sys;
    l->position.sys = NULL;
    MT_TRY(solve_bodies(l, want, NULL, &is, &rests, why, err));
    if (!is && !rests && l->sys->loaded && !l->sys->driven && !want.drawn) {
        l->position.sys = found;
        is = found != NULL;
        if (!is) {
            MT_TRY(find_loaded_equilibrium(l, &is, why, err));
        }
        if (is) {
            MT_TRY(solve_bodies(l, want, &l->position, &is, &rests, why, err));
        }
    }
    if (is) {
        l->way = MT_LOWEST_SPARSE;
        l->mass_kg = l->bodies.mass_kg;
        l->equations = l->sys->n_constraints;
        return MT_OK;
    }
    (void)mt_snprintf(l->why + told, sizeof l->why - told, "; nor the sparse one, as %s", why);
    return MT_OK;
}

/* As a tree, in its drawn position or where it settles under its loads. */
static mt_status make_tree(mt_lowest *l, mt_lowest_want want, mt_err *err)
{
    const mt_run *const run = l->sys->run;
    const mt_arena_mark mark = mt_arena_get_mark(&l->mem);
    bool moves = false;
    bool told = mt_progress_begin(run->progress, "order of the bodies", 0);
    const mt_status rc =
        mt_tree_new(l->sys, l->at, NULL, &l->mem, &l->tree, &moves, l->why, err);
    mt_progress_end(run->progress, told);
    MT_TRY(rc);
    if (l->tree == NULL) {
        mt_arena_rewind(&l->mem, mark);
    }
    if (l->tree != NULL || !moves || !l->sys->loaded || want.drawn) {
        return MT_OK;
    }
    char why[WHY_SIZE] = "";
    bool is = false;
    told = mt_progress_begin(run->progress, "equilibrium", 0);
    const mt_status found = find_loaded_equilibrium(l, &is, why, err);
    mt_progress_end(run->progress, told);
    MT_TRY(found);
    return is ? mt_tree_new(l->sys, l->at, &l->position, &l->mem, &l->tree, &moves, why, err)
              : MT_OK;
}

mt_status mt_lowest_new(const mt_system_def *def, mt_lowest_want want, mt_lowest **out,
                        mt_err *err)
{
    const mt_run *const run = mt_run_or_none(def->run);
    mt_lowest *const l = calloc(1, sizeof *l);
    *out = NULL;
    if (l == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = mt_arena_init(&l->mem, 0, err);
    l->at = mt_arena_f64(&l->mem, (size_t)def->n_inputs, 1);
    rc = rc == MT_OK ? mt_arena_check(&l->mem, err) : rc;
    for (int i = 0; i < def->n_inputs && rc == MT_OK; i++) {
        l->at[i] = def->at[i];
    }
    const bool told = mt_progress_begin(run->progress, "equations", 0);
    rc = rc == MT_OK ? mt_system_new_of(def, &l->sys, err) : rc;
    mt_progress_end(run->progress, told);
    rc = rc == MT_OK ? make_tree(l, want, err) : rc;
    rc = rc == MT_OK && l->tree != NULL ? solve_lowest_modes(l, want, err) : rc;
    rc = rc == MT_OK && l->tree == NULL && !want.tree ? solve_sparse(l, want, err) : rc;
    if (rc != MT_OK) {
        mt_lowest_delete(l);
        return mt_err_in(err, rc, "configuration \"%s\"",
                         def->model->configurations[def->configuration].name.s);
    }
    *out = l;
    return MT_OK;
}

typedef struct motions {
    double *x; /* n_x x n */
    double *r; /* n_rigid x n */
    double *v; /* s n x n */
} motions;

/* Room for n modes in mem. */
static mt_status make_motions_room(const mt_lowest *l, int n, motions *out, mt_arena *mem,
                                   mt_err *err)
{
    const mt_tree *const t = l->tree;
    out->x = mt_arena_f64(mem, (size_t)t->n_x, (size_t)n);
    out->r = mt_arena_f64(mem, (size_t)t->n_rigid, (size_t)n);
    out->v = mt_arena_f64(mem, (size_t)t->n * (size_t)t->s, (size_t)n);
    return mt_arena_check(mem, err);
}

/* The mode at a position as column i, of unit mass: of x = 0 that is r^T M_rr r; else x^T A x =
 * 1/lambda, and r follows. */
static void write_mode_of_unit_mass(const mt_lowest *l, int position, int i, const motions *to)
{
    const mt_tree *const t = l->tree;
    const operation *const o = l->operation;
    const double lambda = l->found.modes.lambda[position];
    double *const x = to->x + ((ptrdiff_t)t->n_x * i);
    double *const r = to->r + ((ptrdiff_t)t->n_rigid * i);
    double *const v = to->v + ((ptrdiff_t)t->n * t->s * i);
    memset(x, 0, (size_t)t->n_x * sizeof *x);
    memset(r, 0, (size_t)t->n_rigid * sizeof *r);
    if (position < t->n_rigid) {
        r[position] = 1.0;
        mt_tri_solve(true, t->n_rigid, 1, o->m_rr, r, t->n_rigid);
    } else {
        double open = 0.0;
        apply_to_whole_motion(o, l->found.x + ((ptrdiff_t)t->n_x * (position - t->n_rigid)), x,
                              &open);
        mt_axpy(t->n_rigid, sqrt(lambda), o->along, r);
        memset(x, 0, (size_t)t->n_x * sizeof *x);
        mt_axpy(t->n_x, sqrt(lambda),
                l->found.x + ((ptrdiff_t)t->n_x * (position - t->n_rigid)), x);
    }
    mt_tree_motion(t, x, r, v);
}

const mt_state *mt_lowest_settled(const mt_lowest *l)
{
    return l->position.sys == NULL ? NULL : &l->position;
}

mt_status mt_lowest_shapes(mt_lowest *l, int n, double *phi, mt_err *err)
{
    const int nq = l->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&l->mem);
    motions m;
    if (l->way == MT_LOWEST_TREE) {
        MT_TRY(make_motions_room(l, 1, &m, &l->mem, err));
    }
    for (int i = 0; i < n; i++) {
        double *const to = phi + ((ptrdiff_t)nq * i);
        if (l->way == MT_LOWEST_TREE) {
            write_mode_of_unit_mass(l, i, 0, &m);
            mt_tree_states(l->tree, m.v, to);
        } else {
            mt_absolute_shape(&l->bodies, l->found.x + ((ptrdiff_t)l->bodies.n * i), to);
        }
    }
    mt_modal_fix_sign(nq, n, phi);
    mt_arena_rewind(&l->mem, mark);
    return MT_OK;
}

mt_status mt_lowest_sense(mt_lowest *l, int n, double *value, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&l->mem);
    double *const phi = mt_arena_f64(&l->mem, (size_t)l->sys->nq, (size_t)n);
    MT_TRY(mt_arena_check(&l->mem, err));
    MT_TRY(mt_lowest_shapes(l, n, phi, err));
    MT_TRY(mt_absolute_sense(l->sys, mt_lowest_settled(l), l->at, n, phi, value, &l->mem, err));
    mt_arena_rewind(&l->mem, mark);
    return MT_OK;
}

/* Modes and their pairs within clusters, position n_rigid + i being mode i. */
typedef struct pairs {
    int n; /* modes: those asked for, and all that are repeated with the last of them */
    int count;
    int (*pair)[2];
    double *lambda; /* [n] mean of the cluster */
} pairs;

static mt_status find_pairs(const mt_lowest *l, int n, pairs *p, mt_arena *mem, mt_err *err)
{
    const mt_modes *const m = &l->found.modes;
    const int rigid = m->n_rigid;
    for (int size = 0; p->n < n; p->n += size) {
        (void)mt_modal_cluster(m, rigid + p->n, &size);
        p->count += size * (size + 1) / 2;
    }
    p->pair = mt_arena_alloc(mem, (size_t)p->count, sizeof *p->pair);
    p->lambda = mt_arena_f64(mem, (size_t)p->n, 1);
    MT_TRY(mt_arena_check(mem, err));
    int at = 0;
    for (int i = 0; i < p->n; i++) {
        int size = 0;
        const int first = mt_modal_cluster(m, rigid + i, &size);
        for (int k = first; k < first + size; k++) {
            p->lambda[i] += m->lambda[k] / size;
        }
        for (int k = i; k < first + size - rigid; k++, at++) {
            p->pair[at][0] = i;
            p->pair[at][1] = k;
        }
    }
    return MT_OK;
}

/* Hz by one input of the modes of one cluster, from the forms of their pairs. */
static mt_status slopes_of_cluster(int size, const double *form, double hz, double *slope,
                                   mt_arena *scratch, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(scratch);
    double *const matrix = mt_arena_f64(scratch, (size_t)size, (size_t)size);
    MT_TRY(mt_arena_check(scratch, err));
    for (int a = 0; a < size; a++) {
        for (int b = a; b < size; b++) {
            matrix[b + (size * a)] = *form++;
        }
    }
    MT_TRY(mt_eig_sym(size, matrix, slope, false, scratch, err));
    for (int a = 0; a < size; a++) {
        slope[a] = mt_modal_hz_slope(slope[a], hz);
    }
    mt_arena_rewind(scratch, mark);
    return MT_OK;
}

static mt_status fill_slopes(const mt_lowest *l, const pairs *p, const double *form, int n,
                             double *hz_per_unit, mt_arena *scratch, mt_err *err)
{
    const mt_modes *const m = &l->found.modes;
    double *const slope = mt_arena_f64(scratch, (size_t)p->n, 1);
    MT_TRY(mt_arena_check(scratch, err));
    for (int k = 0; k < l->sys->n_inputs; k++) {
        const double *at = form + ((ptrdiff_t)p->count * k);
        for (int i = 0, size = 0; i < p->n; i += size) {
            (void)mt_modal_cluster(m, m->n_rigid + i, &size);
            MT_TRY(slopes_of_cluster(size, at, mt_modal_hz(m, m->n_rigid + i), slope + i,
                                     scratch, err));
            at += (ptrdiff_t)size * (size + 1) / 2;
        }
        memcpy(hz_per_unit + ((ptrdiff_t)n * k), slope, (size_t)n * sizeof *slope);
    }
    return MT_OK;
}

/* Forms of the pairs by every input. */
static mt_status forms_of_tree(const mt_lowest *l, const pairs *p, double *form, char *why,
                               mt_arena *mem, mt_err *err)
{
    motions m;
    if (l->tree->settled_at != NULL) {
        (void)mt_snprintf(why, MT_TREE_WHY,
                          "the position where it settles moves with it, which is computed only "
                          "for all modes");
        return MT_OK;
    }
    MT_TRY(make_motions_room(l, p->n, &m, mem, err));
    for (int i = 0; i < p->n; i++) {
        write_mode_of_unit_mass(l, l->tree->n_rigid + i, i, &m);
    }
    const mt_tree_modes modes = {.n = p->n,
                                 .x = m.x,
                                 .r = m.r,
                                 .v = m.v,
                                 .lambda = p->lambda,
                                 .n_pairs = p->count,
                                 .pair = (const int(*)[2])p->pair};
    return mt_tree_slopes(l->tree, l->at, &modes, form, why, mem, err);
}

static mt_status forms_of_bodies(const mt_lowest *l, const pairs *p, double *form, char *why,
                                 mt_arena *mem, mt_err *err)
{
    const mt_absolute *const o = &l->bodies;
    const ptrdiff_t rigid = l->found.modes.n_rigid;
    const mt_absolute_modes modes = {.n = p->n,
                                     .x = l->found.x + (rigid * o->n),
                                     .mu = l->mu + (rigid * o->a.n_rows),
                                     .lambda = p->lambda,
                                     .n_pairs = p->count,
                                     .pair = (const int(*)[2])p->pair,
                                     .dependent = o->n - o->a.n_rows < l->found.modes.n};
    return mt_absolute_slopes(o, l->at, &modes, form, why, mem, err);
}

mt_status mt_lowest_sensitivity(mt_lowest *l, int n, double *hz_per_unit, char why[MT_TREE_WHY],
                                mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&l->mem);
    pairs p = {.n = 0};
    MT_TRY(find_pairs(l, n, &p, &l->mem, err));
    double *const form = mt_arena_f64(&l->mem, (size_t)p.count, (size_t)l->sys->n_inputs);
    MT_TRY(mt_arena_check(&l->mem, err));
    MT_TRY((l->way == MT_LOWEST_TREE ? forms_of_tree : forms_of_bodies)(l, &p, form, why,
                                                                        &l->mem, err));
    if (why[0] == '\0') {
        MT_TRY(fill_slopes(l, &p, form, n, hz_per_unit, &l->mem, err));
    }
    mt_arena_rewind(&l->mem, mark);
    return MT_OK;
}

void mt_lowest_delete(mt_lowest *l)
{
    if (l != NULL) {
        mt_system_delete(l->sys);
        mt_arena_free(&l->mem);
        free(l);
    }
}

/*
 * In (y, r) of the tree K = diag(I, 0). With r = -M_rr^-1 M_ry x + L^-T a, L L^T = M_rr, what
 * follows x and what is free have no mass in common, and a force (g_y, g_r) there is
 *     g_y - M_yr M_rr^-1 g_r  by x,    L^-1 g_r  by a.
 *     In coordinates of the bodies the rigid-body modes are R, R^T M R = I, and a force g is
 *     g - M R R^T g  by x,    R^T g  by a.
 */

/* Roundings of a force for each body that it goes through. */
static const double RECURSION_ULPS = 2.0;
/* Roundings of what rigid-body modes take of a force. */
static const double FREE_ULPS = 64.0;

static bool of_tree(const mt_lowest *l)
{
    return l->way == MT_LOWEST_TREE;
}

static mt_status check_interrupt(const mt_lowest *l, mt_err *err)
{
    return mt_interrupt_check(l->sys->run->interrupt, err);
}

mt_status mt_lowest_open_forced(mt_lowest *l, bool *is, mt_err *err)
{
    const mt_modes *const m = &l->found.modes;
    *is = l->way != MT_LOWEST_NONE;
    if (l->way != MT_LOWEST_SPARSE || l->solver != NULL) {
        return MT_OK;
    }
    const double first = m->n_rigid < m->count ? m->lambda[m->n_rigid] : 0.0;
    MT_TRY(mt_sparse_solver_new(&l->problem, m->n_rigid == 0, first, &l->mem, &l->solver, err));
    *is = l->solver != NULL;
    l->work = mt_arena_f64(&l->mem, (size_t)l->bodies.n, 1);
    return mt_arena_check(&l->mem, err);
}

int mt_lowest_coordinates(const mt_lowest *l)
{
    return of_tree(l) ? l->tree->n_x : l->bodies.n;
}

int mt_lowest_free(const mt_lowest *l)
{
    return of_tree(l) ? l->tree->n_rigid : l->found.modes.n_rigid;
}

double mt_lowest_shift(const mt_lowest *l)
{
    return of_tree(l) ? 0.0 : mt_sparse_solver_shift(l->solver);
}

const double *mt_lowest_mode(const mt_lowest *l, int i)
{
    const ptrdiff_t n = mt_lowest_coordinates(l);
    return l->found.x + (n * (of_tree(l) ? i : i + l->found.modes.n_rigid));
}

const double *mt_lowest_dual(const mt_lowest *l, const double *x, double *work)
{
    if (of_tree(l)) {
        return x;
    }
    mt_sparse_solver_stiffness(l->solver, x, work);
    return work;
}

void mt_lowest_push_init(const mt_lowest *l, mt_arena *mem, mt_lowest_push *p)
{
    const size_t n = (size_t)mt_lowest_coordinates(l);
    *p = (mt_lowest_push){.x = mt_arena_f64(mem, n, 1)};
    p->a = mt_arena_f64(mem, (size_t)mt_lowest_free(l), 1);
    p->dual = of_tree(l) ? NULL : mt_arena_f64(mem, n, 1);
}

/* x[] of forces x and o->r; a[] (NULL: not asked for). Returns the size of x before. */
static double part(const mt_lowest *l, double *x, double *a)
{
    const mt_tree *const t = l->tree;
    const struct mt_lowest_operation *const o = l->operation;
    const double size = mt_norm2(t->n_x, x);
    if (t->n_rigid == 0) {
        return size;
    }
    if (a != NULL) {
        memcpy(a, o->r, (size_t)t->n_rigid * sizeof *a);
        mt_tri_solve(false, t->n_rigid, 1, o->m_rr, a, t->n_rigid);
    }
    lowest_solve_free(o);
    mt_gemv(false, t->n_x, t->n_rigid, -1.0, o->m_yr, t->n_x, o->r, 1.0, x);
    return size;
}

static void part_of_tree(const mt_lowest *l, mt_lowest_push *p)
{
    const double unit = RECURSION_ULPS * (1.0 + l->tree->depth) * DBL_EPSILON;
    p->size = part(l, p->x, p->a);
    p->noise = unit * p->size;
    p->loose = unit * mt_norm2(l->tree->n_rigid, p->a);
}

/* x -= R R^T M x; work[n]. */
static void clear_of_free(const mt_lowest *l, double *x, double *work)
{
    const int n = l->bodies.n;
    const int rigid = l->found.modes.n_rigid;
    if (rigid == 0) {
        return;
    }
    mt_sparse_solver_mass(l->solver, x, work);
    for (int i = 0; i < rigid; i++) {
        const double *const r = l->found.x + ((ptrdiff_t)n * i);
        mt_axpy(n, -mt_dot(n, r, work), r, x);
    }
}

/* The largest error of a mode's energy as a part of it: so much of its shape is rounding. */
static double rough(const mt_lowest *l)
{
    const mt_modes *const m = &l->found.modes;
    double most = 0.0;
    for (int i = m->n_rigid; i < m->count; i++) {
        most = fmax(most, m->error[i] / fabs(m->lambda[i]));
    }
    return most;
}

/* Of the force p->dual. */
static mt_status part_of_bodies(const mt_lowest *l, mt_lowest_push *p, mt_err *err)
{
    const int n = l->bodies.n;
    const int rigid = l->found.modes.n_rigid;
    double *const work = l->work;
    double noise = 0.0;
    double sum = 0.0;
    for (int i = 0; i < rigid; i++) {
        const double *const r = l->found.x + ((ptrdiff_t)n * i);
        p->a[i] = mt_dot(n, r, p->dual);
        for (int j = 0; j < n; j++) {
            sum += fabs(r[j] * p->dual[j]);
        }
    }
    for (int i = 0; i < rigid; i++) {
        mt_sparse_solver_mass(l->solver, l->found.x + ((ptrdiff_t)n * i), work);
        mt_axpy(n, -p->a[i], work, p->dual);
    }
    MT_TRY(mt_sparse_solver_solve(l->solver, p->dual, p->x, &noise, err));
    clear_of_free(l, p->x, work);
    p->size = sqrt(fmax(mt_dot(n, p->x, mt_lowest_dual(l, p->x, work)), 0.0));
    p->noise = noise + (rough(l) * p->size);
    p->loose = FREE_ULPS * DBL_EPSILON * sum;
    return MT_OK;
}

mt_status mt_lowest_force(const mt_lowest *l, const double *force, mt_lowest_push *p,
                          mt_err *err)
{
    MT_TRY(check_interrupt(l, err));
    if (!of_tree(l)) {
        mt_absolute_push(&l->bodies, force, p->dual);
        return part_of_bodies(l, p, err);
    }
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_push(l->tree, force, o->f);
    mt_tree_gather(l->tree, o->f, p->x, o->r);
    part_of_tree(l, p);
    return MT_OK;
}

mt_status mt_lowest_admit(const mt_lowest *l, double *x, mt_err *err)
{
    if (of_tree(l)) {
        return MT_OK;
    }
    if (l->bodies.a.n_rows > 0) {
        mt_sparse_solver_stiffness(l->solver, x, l->work);
        MT_TRY(mt_sparse_solver_solve(l->solver, l->work, x, NULL, err));
    }
    clear_of_free(l, x, l->work);
    return MT_OK;
}

mt_status mt_lowest_momentum(const mt_lowest *l, const double *x, double *y, mt_err *err)
{
    if (of_tree(l)) {
        return mt_lowest_mass(l, x, y, err);
    }
    mt_sparse_solver_mass(l->solver, x, y);
    return MT_OK;
}

mt_status mt_lowest_mass(const mt_lowest *l, const double *x, double *y, mt_err *err)
{
    MT_TRY(check_interrupt(l, err));
    if (!of_tree(l)) {
        mt_sparse_solver_mass(l->solver, x, l->work);
        MT_TRY(mt_sparse_solver_solve(l->solver, l->work, y, NULL, err));
        clear_of_free(l, y, l->work);
        return MT_OK;
    }
    const struct mt_lowest_operation *const o = l->operation;
    mt_tree_motion(l->tree, x, NULL, o->v);
    mt_tree_momentum(l->tree, o->v, o->f, y, o->r);
    (void)part(l, y, NULL);
    return MT_OK;
}
