/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Rigid-body motions follow: in (y, r) with K = diag(I, 0), r minimises the kinetic energy of
 * y,
 *     M_rr r = -M_ry y,    A = M_yy - M_yr M_rr^-1 M_ry,    A y = y / lambda.
 */
#include "analysis/lowest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/interrupt.h"
#include "linalg/dense.h"

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

typedef struct operation {
    const mt_tree *tree;
    double *v;    /* motion of all bodies */
    double *f;    /* work */
    double *r;    /* [n_rigid] */
    double *m_yr; /* n_x x n_rigid */
    double *m_rr; /* its Cholesky factor */
    mt_arena *scratch;
} operation;

static mt_status apply(void *context, const double *x, double *y, mt_err *err)
{
    const operation *const o = context;
    const mt_tree *const t = o->tree;
    MT_TRY(mt_interrupt_check(t->sys->model->interrupt, err));
    mt_tree_motion(t, x, NULL, o->v);
    mt_tree_momentum(t, o->v, o->f, y, o->r);
    if (t->n_rigid > 0) {
        mt_tri_solve(false, t->n_rigid, 1, o->m_rr, o->r, t->n_rigid);
        mt_tri_solve(true, t->n_rigid, 1, o->m_rr, o->r, t->n_rigid);
        mt_gemv(false, t->n_x, t->n_rigid, -1.0, o->m_yr, t->n_x, o->r, 1.0, y);
    }
    return MT_OK;
}

static mt_status below(void *context, double tau, int *count, bool *certain, mt_err *err)
{
    const operation *const o = context;
    MT_TRY(mt_interrupt_check(o->tree->sys->model->interrupt, err));
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

static mt_status solve(mt_lowest *l, int count, mt_err *err)
{
    const mt_tree *const t = l->tree;
    const size_t motions = (size_t)t->n * (size_t)t->s;
    operation o = {.tree = t, .scratch = &l->mem};
    bool regular = false;
    o.v = mt_arena_f64(&l->mem, motions, 1);
    o.f = mt_arena_f64(&l->mem, motions, 1);
    o.r = mt_arena_f64(&l->mem, (size_t)t->n_rigid, 1);
    MT_TRY(mt_arena_check(&l->mem, err));
    MT_TRY(free_motions(&o, &regular, &l->mem, err));
    if (!regular) {
        (void)mt_snprintf(l->why, sizeof l->why, "a motion without stiffness has no mass");
        l->tree = NULL;
        return MT_OK;
    }
    const mt_lowest_problem p = {.n = t->n_x,
                                 .n_rigid = t->n_rigid,
                                 .count = count,
                                 .steps = t->depth,
                                 .apply = apply,
                                 .below = below,
                                 .context = &o};
    return mt_modal_lowest(&p, &l->mem, &l->found, err);
}

mt_status mt_lowest_new(const mt_model *model, int configuration, int n_inputs,
                        const int *inputs, const double *at, int count, mt_lowest **out,
                        mt_err *err)
{
    mt_lowest *const l = calloc(1, sizeof *l);
    *out = NULL;
    if (l == NULL) {
        return mt_fail_memory(err);
    }
    mt_status rc = mt_arena_init(&l->mem, 0, err);
    rc = rc == MT_OK ? mt_system_new(model, configuration, n_inputs, inputs, at, &l->sys, err)
                     : rc;
    rc = rc == MT_OK ? mt_tree_new(l->sys, at, &l->mem, &l->tree, l->why, err) : rc;
    rc = rc == MT_OK && l->tree != NULL ? solve(l, count, err) : rc;
    if (rc != MT_OK) {
        mt_lowest_delete(l);
        return mt_err_in(err, rc, "configuration \"%s\"",
                         model->configurations[configuration].name.s);
    }
    *out = l;
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
