/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks whether a system is a tree, and orders its bodies: breadth first from the ground, then
 * from the first body of each part that nothing connects to it. */
#include "tree/tree.h"

#include "tree/tree_priv.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "base/interrupt.h"

enum { FREE = -2 }; /* what a body hangs on that hangs on nothing */

/* A gap below this times the model length is rounding of the drawing's own numbers. */
static const double DRAWN_CLOSED = 1e-13;

/* What ties two bodies: a constraint, a spring, a mass that they share. */
typedef enum tie_kind { TIE_JOINT, TIE_SPRING, TIE_MASS } tie_kind;
typedef struct tie {
    tie_kind kind;
    int which;
    int body[2]; /* MT_GROUND: the ground */
} tie;

typedef struct order {
    const mt_system *sys;
    const double *value;
    int n_ties;
    tie *ties;
    int *first; /* [bodies + 2] of each body's ties in `list`; the ground is the last body */
    int *list;  /* [2 n_ties] */
    int *above; /* [bodies] body that it hangs on, MT_GROUND or FREE */
    int *place; /* [bodies] in the order; -1: not there yet */
} order;

static void add_tie(order *o, tie_kind kind, int which, const int body[2])
{
    o->ties[o->n_ties++] = (tie){kind, which, {body[0], body[1]}};
}

static bool acts(const order *o, int spring)
{
    const mt_spring_def *const s = &o->sys->springs[spring];
    return !s->damper &&
           (o->value[s->stiffness] != 0.0 || s->free != MT_NO_NODE || s->preload != MT_NO_NODE);
}

static void collect_ties(order *o)
{
    const mt_system *const sys = o->sys;
    for (int i = 0; i < sys->n_constraints; i++) {
        add_tie(o, TIE_JOINT, i, sys->measures[sys->constraints[i].measure[0]].body);
    }
    for (int i = 0; i < sys->n_springs; i++) {
        if (acts(o, i)) {
            add_tie(o, TIE_SPRING, i, sys->measures[sys->springs[i].measure[0]].body);
        }
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        const int *const body = sys->inertias[i].body;
        if (body[0] != body[1] && body[0] != MT_GROUND && body[1] != MT_GROUND) {
            add_tie(o, TIE_MASS, i, body);
        }
    }
}

/* Each body's ties, by counting. */
static void sort_ties(order *o)
{
    const int nb = o->sys->n_bodies;
    for (int i = 0; i < 2 * o->n_ties; i++) {
        const int b = o->ties[i / 2].body[i % 2];
        o->first[(b == MT_GROUND ? nb : b) + 1]++;
    }
    for (int b = 0; b <= nb; b++) {
        o->first[b + 1] += o->first[b];
    }
    for (int i = (2 * o->n_ties) - 1; i >= 0; i--) { /* each list ends up in order */
        const int b = o->ties[i / 2].body[i % 2];
        o->list[--o->first[(b == MT_GROUND ? nb : b) + 1]] = i / 2;
    }
    for (int b = 0; b <= nb; b++) { /* the starts stand one too far */
        o->first[b] = o->first[b + 1];
    }
    o->first[nb + 1] = 2 * o->n_ties;
}

static void tell_loop(const order *o, const tie *e, char *why)
{
    const mt_system *const sys = o->sys;
    const char *const name = e->kind == TIE_JOINT
                                 ? sys->joints[sys->constraints[e->which].joint].name
                             : e->kind == TIE_SPRING ? sys->springs[e->which].name
                                                     : NULL;
    if (name == NULL) {
        (void)mt_snprintf(why, MT_TREE_WHY, "a mass that two bodies share is part of a loop");
    } else {
        (void)mt_snprintf(why, MT_TREE_WHY, "%s \"%s\" is part of a loop",
                          e->kind == TIE_JOINT ? "joint" : "spring", name);
    }
}

/* Visit all bodies connected to body b (MT_GROUND: the ground); false where a connection closes
 * a loop. */
static bool visit_connected(order *o, mt_tree *t, int b, char *why)
{
    const int at = b == MT_GROUND ? o->sys->n_bodies : b;
    for (int i = o->first[at]; i < o->first[at + 1]; i++) {
        const tie *const e = &o->ties[o->list[i]];
        const int other = e->body[0] == b ? e->body[1] : e->body[0];
        const bool back = b != MT_GROUND && o->above[b] == other;
        if (back || (other != MT_GROUND && o->place[other] >= 0 && o->above[other] == b)) {
            continue; /* one more tie of an edge that there is */
        }
        if (other == MT_GROUND || o->place[other] >= 0) {
            tell_loop(o, e, why);
            return false;
        }
        o->above[other] = b;
        o->place[other] = t->n;
        t->before[t->n] = b == MT_GROUND ? -1 : o->place[b];
        t->body[t->n++] = other;
    }
    return true;
}

static bool find_order(order *o, mt_tree *t, char *why)
{
    int done = 0;
    if (!visit_connected(o, t, MT_GROUND, why)) {
        return false;
    }
    for (int root = 0; root < o->sys->n_bodies || done < t->n;) {
        if (done < t->n) {
            if (!visit_connected(o, t, t->body[done++], why)) {
                return false;
            }
        } else if (o->place[root++] < 0) {
            o->above[root - 1] = FREE;
            o->place[root - 1] = t->n;
            t->before[t->n] = -1;
            t->body[t->n++] = root - 1;
        }
    }
    return true;
}

/* The edges' own constraints and springs, as lists in order. */
static void list_edges(mt_tree *t, const order *o)
{
    memset(t->first_constraint, 0xFF, (size_t)t->n * sizeof(int)); /* -1 */
    memset(t->first_spring, 0xFF, (size_t)t->n * sizeof(int));
    for (int i = o->n_ties - 1; i >= 0; i--) {
        const tie *const e = &o->ties[i];
        const int a = e->body[0];
        const int b = e->body[1];
        const int owner = o->place[b != MT_GROUND && o->above[b] == a ? b : a];
        if (e->kind == TIE_JOINT) {
            t->next_constraint[e->which] = t->first_constraint[owner];
            t->first_constraint[owner] = e->which;
        } else if (e->kind == TIE_SPRING) {
            t->next_spring[e->which] = t->first_spring[owner];
            t->first_spring[owner] = e->which;
        }
    }
}

static mt_status order_bodies(mt_tree_maker *m, mt_arena *mem, mt_arena *scratch, bool *is_tree,
                              mt_err *err)
{
    mt_tree *const t = m->t;
    const mt_system *const sys = t->sys;
    const size_t nb = (size_t)sys->n_bodies;
    const size_t most =
        (size_t)sys->n_constraints + (size_t)sys->n_springs + (size_t)sys->n_inertias;
    order o = {.sys = sys, .value = m->data.value};
    o.ties = mt_arena_alloc(scratch, most, sizeof *o.ties);
    o.first = mt_arena_int(scratch, nb + 2);
    o.list = mt_arena_int(scratch, 2 * most);
    o.above = mt_arena_int(scratch, nb);
    t->place = mt_arena_int(mem, nb);
    t->first_constraint = mt_arena_int(mem, nb);
    t->first_spring = mt_arena_int(mem, nb);
    t->next_constraint = mt_arena_int(mem, (size_t)sys->n_constraints);
    t->next_spring = mt_arena_int(mem, (size_t)sys->n_springs);
    o.place = t->place;
    t->body = mt_arena_int(mem, nb);
    t->before = mt_arena_int(mem, nb);
    MT_TRY(mt_arena_check(scratch, err));
    MT_TRY(mt_arena_check(mem, err));
    memset(o.place, 0xFF, nb * sizeof *o.place); /* -1 */
    collect_ties(&o);
    sort_ties(&o);
    *is_tree = find_order(&o, t, m->why);
    if (*is_tree) {
        list_edges(t, &o);
    }
    return MT_OK;
}

/* True where the system has properties that the recursions do not cover; checked before the
 * order. */
static bool has_form(const mt_tree_maker *m)
{
    const mt_system *const sys = m->t->sys;
    if (sys->driven) {
        (void)mt_snprintf(m->why, MT_TREE_WHY, "a joint is driven");
        return false;
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        if (sys->constraints[i].terms > 1) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "joint \"%s\" couples two others",
                              sys->joints[sys->constraints[i].joint].name);
            return false;
        }
    }
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const double k = s->damper ? 0.0 : m->data.value[s->stiffness];
        if (k < 0.0 || (s->measure[0] != s->measure[1] && k != 0.0)) {
            (void)mt_snprintf(m->why, MT_TREE_WHY, "spring \"%s\" %s", s->name,
                              k < 0.0 ? "has a negative stiffness" : "couples directions");
            return false;
        }
    }
    return true;
}

/* True where the joints are closed in the drawn position. */
static bool is_closed(mt_tree_maker *m)
{
    const mt_system *const sys = m->t->sys;
    if (sys->drawn_closed) {
        return true;
    }
    mt_data_targets(&m->data);
    for (int i = 0; i < sys->n_constraints; i++) {
        const mt_constraint_def *const c = &sys->constraints[i];
        const mt_measure_def *const def = &sys->measures[c->measure[0]];
        const mt_measure_data measure = mt_data_measure(&m->data, def);
        const double gap = creal(mt_measure_value(&measure, mt_pose_of(m->pose, def->body[0]),
                                                  mt_pose_of(m->pose, def->body[1]), NULL)) -
                           creal(m->data.target[i]);
        if (!(fabs(gap) <= DRAWN_CLOSED * sys->length_m)) {
            (void)mt_snprintf(m->why, MT_TREE_WHY,
                              "joint \"%s\" is not closed in the reference "
                              "position",
                              sys->joints[c->joint].name);
            return false;
        }
    }
    return true;
}

static mt_status make_edges(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const size_t n = (size_t)t->n;
    const size_t s = (size_t)t->s;
    int *const depth = mt_arena_int(mem, n);
    t->point = mt_arena_alloc(mem, n, sizeof *t->point);
    t->y_at = mt_arena_int(mem, n + 1);
    t->free_dof_at = mt_arena_int(mem, n + 1);
    t->arm = mt_arena_f64(mem, 3, n);
    t->mass = mt_arena_f64(mem, n * s, s);
    t->basis = mt_arena_f64(mem, s, (size_t)t->sys->nq);
    t->length = mt_arena_f64(mem, n, 1);
    t->condition = mt_arena_f64(mem, n, 1);
    t->lost = mt_arena_f64(mem, (size_t)t->sys->nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < t->n && *is_tree; i++) {
        const mt_state_body *const body = &t->sys->bodies[t->body[i]];
        const mt_pose *const before =
            mt_pose_of(m->pose, t->before[i] < 0 ? MT_GROUND : t->body[t->before[i]]);
        int n_y = 0;
        int n_free_dofs = 0;
        t->point[i] = body->dof[MT_TREE_MOTION - 1] < 0;
        for (int k = 0; k < 3; k++) {
            t->arm[k + ((ptrdiff_t)3 * i)] =
                creal(m->pose[t->body[i]].x[k]) - creal(before->x[k]);
        }
        double basis[MT_TREE_MOTION * MT_TREE_MOTION];
        *is_tree = mt_tree_edge(m, i, basis, &n_y, &n_free_dofs);
        memcpy(t->basis + (s * (size_t)(t->y_at[i] + t->free_dof_at[i])), basis,
               s * (size_t)(n_y + n_free_dofs) * sizeof *basis);
        t->y_at[i + 1] = t->y_at[i] + n_y;
        t->free_dof_at[i + 1] = t->free_dof_at[i] + n_free_dofs;
        depth[i] = 1 + (t->before[i] < 0 ? 0 : depth[t->before[i]]);
        t->depth = depth[i] > t->depth ? depth[i] : t->depth;
    }
    return MT_OK;
}

/* Coordinates: the springs' own where nothing loads. */
static mt_status choose_coordinates(mt_tree_maker *m, mt_arena *mem, bool *is_tree, mt_err *err)
{
    mt_tree *const t = m->t;
    const size_t n = (size_t)t->n;
    const size_t s = (size_t)t->s;
    const int n_y = t->y_at[t->n];
    const int free_dofs = t->free_dof_at[t->n];
    t->n_x = t->geometric_stiffness == NULL ? n_y : n_y + free_dofs;
    t->n_rigid = n_y + free_dofs - t->n_x;
    if (t->n_rigid > MT_TREE_FREE_DOFS) {
        *is_tree = false;
        (void)mt_snprintf(m->why, MT_TREE_WHY,
                          "%d of its motions meet no stiffness, more than %d", t->n_rigid,
                          (int)MT_TREE_FREE_DOFS);
    }
    if (t->geometric_stiffness == NULL) {
        return MT_OK;
    }
    t->transport = mt_arena_f64(mem, n * s, s);
    t->settled = mt_arena_f64(mem, n * s, s);
    t->scaled = mt_arena_f64(mem, s, (size_t)t->n_x);
    MT_TRY(mt_arena_check(mem, err));
    mt_arena work = {.first = NULL};
    MT_TRY(mt_arena_init(&work, 0, err));
    const mt_status rc = mt_tree_factor(t, &work, is_tree, err);
    mt_arena_free(&work);
    if (rc == MT_OK && !*is_tree) {
        (void)mt_snprintf(m->why, MT_TREE_WHY,
                          "it is free to move, or not stable, under its load");
    }
    return rc;
}

static mt_status make_tree(mt_tree_maker *m, const double *inputs, mt_arena *mem,
                           mt_arena *scratch, bool *is_tree, mt_err *err)
{
    const mt_system *const sys = m->t->sys;
    double *const value = mt_arena_f64(scratch, (size_t)sys->program.count, 1);
    m->pose = mt_arena_alloc(scratch, (size_t)sys->n_bodies, sizeof *m->pose);
    MT_TRY(mt_data_init(&m->data, sys, scratch, err));
    MT_TRY(mt_program_eval(&sys->program, inputs, value, NULL, err));
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    m->data.value = value;
    *is_tree = has_form(m);
    if (!*is_tree) {
        return MT_OK;
    }
    mt_data_vecs(&m->data);
    mt_data_drawn(&m->data, m->pose);
    *is_tree = is_closed(m);
    if (*is_tree) {
        MT_TRY(order_bodies(m, mem, scratch, is_tree, err));
    }
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    if (*is_tree) {
        MT_TRY(make_edges(m, mem, is_tree, err));
    }
    MT_TRY(mt_interrupt_check(sys->run->interrupt, err));
    if (*is_tree) {
        MT_TRY(mt_tree_masses(m, mem, is_tree, err));
    }
    if (*is_tree && sys->loaded) {
        MT_TRY(mt_tree_loads(m, mem, is_tree, err));
    }
    if (*is_tree) {
        MT_TRY(choose_coordinates(m, mem, is_tree, err));
    }
    return MT_OK;
}

mt_status mt_tree_new(const mt_system *sys, const double *inputs, mt_arena *mem, mt_tree **out,
                      char why[MT_TREE_WHY], mt_err *err)
{
    mt_arena scratch = {.first = NULL};
    mt_tree *const t = mt_arena_alloc(mem, 1, sizeof *t);
    mt_tree_maker m = {.t = t, .why = why};
    bool is_tree = false;
    *out = NULL;
    why[0] = '\0';
    MT_TRY(mt_arena_check(mem, err));
    *t = (mt_tree){.sys = sys, .s = sys->dimension == 2 ? 3 : MT_TREE_MOTION};
    mt_status rc = mt_arena_init(&scratch, 0, err);
    rc = rc == MT_OK ? make_tree(&m, inputs, mem, &scratch, &is_tree, err) : rc;
    mt_arena_free(&scratch);
    *out = rc == MT_OK && is_tree ? t : NULL;
    return rc;
}
