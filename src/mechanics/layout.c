/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/layout.h"

#include <string.h>

/* Bodies and the ways between them: neighbours of body b are other[start[b]] ..
 * other[start[b + 1] - 1]. */
typedef struct graph {
    int n;
    int *start;
    int *other;
    int *turn; /* [n] bodies in the order in which they are met */
    int *met;  /* [n] in which walk; 0: not yet */
} graph;

typedef void visit_pair(void *context, int a, int b);

/* All pairs of bodies (equal ones too) that an energy or an equation couples. */
static void visit_measure(const mt_measure_def *m, visit_pair *visit, void *context)
{
    if (m->body[0] != MT_GROUND && m->body[1] != MT_GROUND) {
        visit(context, m->body[0], m->body[1]);
    }
}

static void visit_couplings(const mt_system *sys, visit_pair *visit, void *context)
{
    for (int i = 0; i < sys->n_springs; i++) {
        visit_measure(&sys->measures[sys->springs[i].measure[0]], visit, context);
    }
    for (int i = 0; i < sys->n_loads; i++) {
        if (sys->loads[i].measure >= 0) {
            visit_measure(&sys->measures[sys->loads[i].measure], visit, context);
        }
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        for (int t = 0; t < sys->constraints[i].terms; t++) {
            visit_measure(&sys->measures[sys->constraints[i].measure[t]], visit, context);
        }
    }
}

/* Bodies of an equation, each side of each term; how many. */
static int bodies_of(const mt_system *sys, const mt_constraint_def *c, int body[4])
{
    int n = 0;
    for (int t = 0; t < c->terms; t++) {
        for (int side = 0; side < 2; side++) {
            const int b = sys->measures[c->measure[t]].body[side];
            if (b != MT_GROUND) {
                body[n++] = b;
            }
        }
    }
    return n;
}

static void count_pair(void *context, int a, int b)
{
    graph *const g = context;
    g->start[a + 1]++;
    g->start[b + 1]++;
}

static void note_pair(void *context, int a, int b)
{
    graph *const g = context;
    g->other[g->start[a]++] = b;
    g->other[g->start[b]++] = a;
}

/* An equation of two terms (a gear) couples the bodies of both. */
static void visit_equations(const mt_system *sys, visit_pair *visit, void *context)
{
    for (int i = 0; i < sys->n_constraints; i++) {
        int body[4];
        const int n = bodies_of(sys, &sys->constraints[i], body);
        for (int k = 2; k < n; k++) {
            visit(context, body[0], body[k]);
        }
    }
}

static bool graph_init(graph *g, const mt_system *sys, mt_arena *mem)
{
    const size_t n = (size_t)sys->n_bodies;
    g->n = sys->n_bodies;
    g->start = mt_arena_int(mem, n + 2);
    g->turn = mt_arena_int(mem, n);
    g->met = mt_arena_int(mem, n);
    if (mt_arena_failed(mem)) {
        return false;
    }
    visit_couplings(sys, count_pair, g);
    visit_equations(sys, count_pair, g);
    for (int b = 0; b < g->n; b++) {
        g->start[b + 1] += g->start[b];
    }
    g->other = mt_arena_int(mem, (size_t)g->start[g->n]);
    if (mt_arena_failed(mem)) {
        return false;
    }
    visit_couplings(sys, note_pair, g);
    visit_equations(sys, note_pair, g);
    memmove(g->start + 1, g->start, n * sizeof *g->start);
    g->start[0] = 0;
    return true;
}

/* Bodies within reach of `from`, breadth first, into turn[at..]; returns where they end. */
static int number_connected_bodies(graph *g, int from, int at, int number)
{
    int end = at;
    g->turn[end++] = from;
    g->met[from] = number;
    for (; at < end; at++) {
        const int b = g->turn[at];
        for (int k = g->start[b]; k < g->start[b + 1]; k++) {
            if (g->met[g->other[k]] != number) {
                g->met[g->other[k]] = number;
                g->turn[end++] = g->other[k];
            }
        }
    }
    return end;
}

/* Every part of the mechanism from one of its ends: the last body that a walk comes to, twice.
 * */
static void walk_all(graph *g)
{
    int number = 0;
    int end = 0;
    for (int b = 0; b < g->n; b++) {
        if (g->met[b] == 0) {
            const int at = end;
            end = number_connected_bodies(g, b, at, ++number);
            end = number_connected_bodies(g, g->turn[end - 1], at, ++number);
            end = number_connected_bodies(g, g->turn[end - 1], at, ++number);
        }
    }
}

/* States of the bodies in their turn, each equation as soon as its bodies are there. */
static void give_places(const mt_system *sys, const graph *g, const int *first, const int *next,
                        mt_layout *o)
{
    int place = 0;
    for (int t = 0; t < g->n; t++) {
        const int b = g->turn[t];
        for (int k = 0; k < 6; k++) {
            if (sys->bodies[b].dof[k] >= 0) {
                o->state[sys->bodies[b].dof[k]] = place++;
            }
        }
        for (int i = first[t] - 1; i >= 0; i = next[i] - 1) {
            o->equation[i] = place++;
        }
    }
}

static void touch(mt_envelope *e, int i, int j)
{
    const int low = i < j ? i : j;
    const int high = i < j ? j : i;
    e->first[high] = e->first[high] < low ? e->first[high] : low;
    e->last[low] = e->last[low] > high ? e->last[low] : high;
}

typedef struct pattern {
    const mt_system *sys;
    mt_layout *o;
} pattern;

static void touch_pair(void *context, int a, int b)
{
    const pattern *const p = context;
    for (int k = 0; k < 36; k++) {
        const int i = p->sys->bodies[a].dof[k / 6];
        const int j = p->sys->bodies[b].dof[k % 6];
        if (i >= 0 && j >= 0) {
            touch(&p->o->envelope, p->o->state[i], p->o->state[j]);
        }
    }
}

static void find_envelope(const mt_system *sys, mt_layout *o)
{
    mt_envelope *const e = &o->envelope;
    pattern p = {.sys = sys, .o = o};
    for (int i = 0; i < e->n; i++) {
        e->first[i] = i;
        e->last[i] = i;
    }
    for (int b = 0; b < sys->n_bodies; b++) {
        touch_pair(&p, b, b);
    }
    visit_couplings(sys, touch_pair, &p);
    for (int i = 0; i < sys->n_constraints; i++) {
        int body[4];
        const int n = bodies_of(sys, &sys->constraints[i], body);
        for (int k = 0; k < 6 * n; k++) {
            const int dof = sys->bodies[body[k / 6]].dof[k % 6];
            if (dof >= 0) {
                touch(e, o->equation[i], o->state[dof]);
            }
        }
    }
}

/* Set the positions of rows, and the cost of a factorisation. closed[n]: zeroed. */
static void measure_envelope(mt_layout *o, int *closed)
{
    mt_envelope *const e = &o->envelope;
    int open = 0;
    for (int i = 0; i < e->n; i++) {
        e->row[i] = (ptrdiff_t)e->count - e->first[i];
        e->count += (size_t)(i - e->first[i]) + 1;
        closed[e->last[i]]++;
    }
    for (int i = 0; i < e->n; i++) {
        open++;
        e->front = e->front > open ? e->front : open;
        o->work += (double)closed[i] * open * open;
        open -= closed[i];
    }
}

const mt_layout *mt_layout_new(const mt_system *sys, mt_arena *mem)
{
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    mt_layout *const o = mt_arena_alloc(mem, 1, sizeof *o);
    graph g = {.n = 0};
    if (mt_arena_failed(mem)) {
        return NULL;
    }
    o->state = mt_arena_int(mem, nq);
    o->equation = mt_arena_int(mem, m);
    o->envelope = (mt_envelope){.n = sys->nq + sys->n_constraints,
                                .first = mt_arena_int(mem, nq + m),
                                .last = mt_arena_int(mem, nq + m),
                                .row = mt_arena_alloc(mem, nq + m, sizeof(ptrdiff_t))};
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    int *const turn_of = mt_arena_int(mem, (size_t)sys->n_bodies);
    int *const first = mt_arena_int(mem, (size_t)sys->n_bodies + 1);
    int *const next = mt_arena_int(mem, m);
    int *const closed = mt_arena_int(mem, nq + m);
    if (!graph_init(&g, sys, mem)) {
        return NULL;
    }
    walk_all(&g);
    for (int t = 0; t < g.n; t++) {
        turn_of[g.turn[t]] = t;
    }
    for (int i = sys->n_constraints - 1; i >= 0; i--) {
        int body[4];
        int last = 0;
        for (int k = bodies_of(sys, &sys->constraints[i], body) - 1; k >= 0; k--) {
            last = turn_of[body[k]] > last ? turn_of[body[k]] : last;
        }
        next[i] = first[last];
        first[last] = i + 1;
    }
    give_places(sys, &g, first, next, o);
    find_envelope(sys, o);
    measure_envelope(o, closed);
    mt_arena_rewind(mem, mark);
    return o;
}
