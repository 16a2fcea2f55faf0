/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which configurations have the same geometry, or one but for the position of a drive. */
#include "mechanics/geometry.h"

#include <stdlib.h>
#include <string.h>

#include "mechanics/system.h"

/*
 * Two systems of one model, node by node. Both are flattened by the same code from the items in
 * the model's order, so what is the same stands at the same place of every list; two numbers
 * are the same where their expressions are, operation by operation down to inputs and
 * constants. Programs number their nodes differently: `map` remembers which nodes have been
 * found equal.
 */

typedef struct pair {
    const mt_system *a;
    const mt_system *b;
    mt_node *map; /* [a->program.count] the node of b that is the same; MT_NO_NODE: not known */
} pair;

/* Depth: that of the expressions. */
static bool same_node(pair *p, mt_node a, mt_node b)
{
    if (a == MT_NO_NODE || b == MT_NO_NODE) {
        return a == b;
    }
    if (p->map[a] != MT_NO_NODE) {
        return p->map[a] == b; /* a program holds equal nodes once */
    }
    const mt_program_node *const x = &p->a->program.nodes[a];
    const mt_program_node *const y = &p->b->program.nodes[b];
    const bool same = x->op == y->op && x->input == y->input && x->value == y->value &&
                      same_node(p, x->a, y->a) && same_node(p, x->b, y->b);
    p->map[a] = same ? b : MT_NO_NODE;
    return same;
}

static bool same_nodes(pair *p, int n, const mt_node *a, const mt_node *b)
{
    for (int i = 0; i < n; i++) {
        if (!same_node(p, a[i], b[i])) {
            return false;
        }
    }
    return true;
}

static bool same_ints(int n, const int *a, const int *b)
{
    return memcmp(a, b, (size_t)n * sizeof *a) == 0;
}

static bool same_vecs(pair *p)
{
    for (int i = 0; i < p->a->n_vecs; i++) {
        const mt_vec_def *const x = &p->a->vecs[i];
        const mt_vec_def *const y = &p->b->vecs[i];
        const bool nodes = x->kind != MT_VEC_NODES && x->kind != MT_VEC_UNIT;
        if (x->kind != y->kind || x->axis != y->axis || x->helper != y->helper ||
            !(nodes || same_nodes(p, 3, x->node, y->node))) {
            return false;
        }
    }
    return true;
}

static bool same_measures(pair *p)
{
    for (int i = 0; i < p->a->n_measures; i++) {
        const mt_measure_def *const x = &p->a->measures[i];
        const mt_measure_def *const y = &p->b->measures[i];
        if (x->kind != y->kind || x->component != y->component ||
            !same_ints(2, x->body, y->body) || !same_ints(2, x->point, y->point) ||
            !same_ints(3, x->dir, y->dir) ||
            !same_nodes(p, MT_BEAM_NUMBERS, x->beam, y->beam)) {
            return false;
        }
    }
    return true;
}

static bool same_bodies(const pair *p)
{
    for (int i = 0; i < p->a->n_bodies; i++) {
        const mt_state_body *const x = &p->a->bodies[i];
        const mt_state_body *const y = &p->b->bodies[i];
        if (strcmp(x->name, y->name) != 0 || x->centre != y->centre ||
            !same_ints(6, x->dof, y->dof)) {
            return false;
        }
    }
    return true;
}

/* Number of constraints without those of drives, which are the last. */
static int own_constraints(const mt_system *sys)
{
    return sys->n_constraints - sys->n_drives;
}

static bool same_constraints(pair *p)
{
    for (int i = 0; i < own_constraints(p->a); i++) {
        const mt_constraint_def *const x = &p->a->constraints[i];
        const mt_constraint_def *const y = &p->b->constraints[i];
        if (x->terms != y->terms || x->joint != y->joint || x->drawn != y->drawn ||
            !same_ints(x->terms, x->measure, y->measure) ||
            !same_nodes(p, x->terms, x->coefficient, y->coefficient) ||
            !same_node(p, x->target, y->target)) {
            return false;
        }
    }
    return true;
}

/* sizes: with their numbers, not only where they act. */
static bool same_springs(pair *p, bool sizes)
{
    for (int i = 0; i < p->a->n_springs; i++) {
        const mt_spring_def *const x = &p->a->springs[i];
        const mt_spring_def *const y = &p->b->springs[i];
        if (strcmp(x->name, y->name) != 0 || x->damper != y->damper ||
            !same_ints(2, x->measure, y->measure)) {
            return false;
        }
        if (sizes &&
            (!same_node(p, x->stiffness, y->stiffness) || !same_node(p, x->free, y->free) ||
             !same_node(p, x->preload, y->preload))) {
            return false;
        }
    }
    return true;
}

static bool same_inertias(pair *p, bool sizes)
{
    for (int i = 0; i < p->a->n_inertias; i++) {
        const mt_inertia_def *const x = &p->a->inertias[i];
        const mt_inertia_def *const y = &p->b->inertias[i];
        if (x->kind != y->kind || x->bending != y->bending || !same_ints(2, x->body, y->body) ||
            !same_ints(2, x->point, y->point) || !same_ints(3, x->dir, y->dir) ||
            (sizes && !same_node(p, x->coefficient, y->coefficient)) ||
            !same_nodes(p, 2, x->shape, y->shape)) {
            return false;
        }
    }
    return true;
}

static bool same_channels(pair *p)
{
    for (int i = 0; i < p->a->n_channels; i++) {
        const mt_channel_def *const x = &p->a->channels[i];
        const mt_channel_def *const y = &p->b->channels[i];
        if (x->kind != y->kind || x->axis != y->axis || x->point != y->point ||
            !same_ints(2, x->body, y->body) || !same_ints(3, x->dir, y->dir) ||
            !same_nodes(p, 2, x->shape, y->shape) || !same_node(p, x->fraction, y->fraction)) {
            return false;
        }
    }
    return true;
}

static bool same_loads(pair *p)
{
    for (int i = 0; i < p->a->n_loads; i++) {
        const mt_load_def *const x = &p->a->loads[i];
        const mt_load_def *const y = &p->b->loads[i];
        if (x->measure != y->measure || x->body != y->body || x->point != y->point ||
            !same_nodes(p, 3, x->force, y->force) || !same_node(p, x->size, y->size)) {
            return false;
        }
    }
    return true;
}

static bool same_counts(const mt_system *a, const mt_system *b)
{
    return a->model == b->model && a->n_inputs == b->n_inputs && a->nq == b->nq &&
           a->n_vecs == b->n_vecs && a->n_measures == b->n_measures &&
           a->n_bodies == b->n_bodies && own_constraints(a) == own_constraints(b) &&
           a->n_joints == b->n_joints && a->n_springs == b->n_springs &&
           a->n_inertias == b->n_inertias && a->n_loads == b->n_loads &&
           same_ints(a->n_inputs, a->inputs, b->inputs);
}

/* True where both drive the same joints in the same order, and hold them the same way; or one
 * of them has no drive and no loads, and a trimmed spring holds the one joint of the other. */
static bool same_drives(const mt_system *a, const mt_system *b)
{
    if (!a->driven || !b->driven) {
        const mt_system *const driven = a->driven ? a : b;
        return a->driven != b->driven && driven->n_drives == 1 && driven->n_trims == 1 &&
               !(a->driven ? b : a)->loaded;
    }
    bool same = a->n_drives == b->n_drives && a->n_trims == b->n_trims;
    for (int i = 0; i < a->n_drives && same; i++) {
        same = a->drives[i].joint == b->drives[i].joint &&
               a->drives[i].spring == b->drives[i].spring;
    }
    return same;
}

/* True where at most one of the joints is driven to another position; *joint: it; -1: none. */
static bool one_drive(pair *p, int *joint)
{
    const mt_system *const driven = p->a->driven ? p->a : p->b;
    int n = 0;
    const bool both = p->a->driven && p->b->driven;
    *joint = both ? -1 : driven->drives[0].joint;
    for (int i = 0; i < driven->n_drives && both; i++) {
        if (!same_node(p, p->a->drives[i].position, p->b->drives[i].position)) {
            *joint = driven->drives[i].joint;
            n++;
        }
    }
    return n <= 1;
}

/* Fails: MT_E_MEMORY. */
static mt_status pair_of(const mt_system *a, const mt_system *b, pair *p, mt_err *err)
{
    *p = (pair){.a = a, .b = b};
    p->map = malloc(((size_t)a->program.count + 1) * sizeof *p->map);
    if (p->map == NULL) {
        return mt_fail_memory(err);
    }
    for (int i = 0; i < a->program.count; i++) {
        p->map[i] = MT_NO_NODE;
    }
    return MT_OK;
}

/* True where positions, directions, measures and constraints are the same. */
static bool same_geometry(pair *p)
{
    return same_vecs(p) && same_measures(p) && same_bodies(p) && same_constraints(p);
}

mt_status mt_system_same_shape(const mt_system *a, const mt_system *b, bool *same, mt_err *err)
{
    pair p;
    *same = false;
    if (!same_counts(a, b) || a->n_channels != b->n_channels || a->dimension != b->dimension ||
        a->driven || b->driven || a->n_loads > 0 || a->drawn_closed != b->drawn_closed ||
        a->geometry_fixed != b->geometry_fixed || a->length_m != b->length_m ||
        memcmp(a->shape, b->shape, (size_t)a->program.words * sizeof *a->shape) != 0) {
        return MT_OK;
    }
    MT_TRY(pair_of(a, b, &p, err));
    *same = same_geometry(&p) && same_springs(&p, false) && same_inertias(&p, false) &&
            same_channels(&p);
    free(p.map);
    return MT_OK;
}

mt_status mt_system_same_drive(const mt_system *a, const mt_system *b, bool *same, int *joint,
                               mt_err *err)
{
    pair p;
    *same = false;
    *joint = -1;
    if (!same_drives(a, b) || !same_counts(a, b)) {
        return MT_OK;
    }
    MT_TRY(pair_of(a, b, &p, err));
    *same = one_drive(&p, joint) && same_geometry(&p) && same_springs(&p, true) &&
            same_inertias(&p, true) && same_loads(&p);
    free(p.map);
    return MT_OK;
}
