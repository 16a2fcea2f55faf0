/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Parameters that refer to each other in a circle. In a configuration an override stands in
 * place of the parameter's own expression, so circles are searched in every configuration with
 * overrides. Depth-first with an explicit stack: a chain of parameters may be as long as the
 * file allows.
 */
#include "model/resolve_priv.h"

#include <stdarg.h>
#include <string.h>

#include "base/format.h"

enum { UNSEEN, ON_PATH, DONE };

typedef struct search {
    mt_resolve *f;
    mt_num *value; /* [n_parameters] the expression in force */
    int *state;    /* [n_parameters] */
    int *stack;    /* [n_parameters] parameters on the path */
    int *next; /* [n_parameters] where the reading of the expression at that depth goes on */
    int depth;
    const char *configuration; /* NULL: the model as it stands */
} search;

void mt_resolve_ring_add(mt_resolve_ring *ring, const char *name)
{
    if (ring->count < MT_RING_FIRST) {
        ring->start[ring->count] = name;
    } else {
        ring->last[ring->count % MT_RING_LAST] = name;
    }
    ring->count++;
}

MT_PRINTF(3, 4)
static void ring_write(mt_resolve_ring *ring, size_t *length, const char *fmt, ...)
{
    const size_t left = sizeof ring->text - *length;
    va_list args;
    va_start(args, fmt);
    const int n = mt_vsnprintf(ring->text + *length, left, fmt, args);
    va_end(args);
    *length += n < 0 ? 0 : (size_t)n < left ? (size_t)n : left - 1;
}

static void ring_name(mt_resolve_ring *ring, size_t *length, const char *arrow,
                      const char *name)
{
    ring_write(ring, length, "%s%.*s%s", arrow, (int)MT_RING_NAME, name,
               strlen(name) > MT_RING_NAME ? "..." : "");
}

void mt_resolve_ring_end(mt_resolve_ring *ring)
{
    static const char arrow[] = " -> ";
    const int end = MT_RING_FIRST + MT_RING_LAST;
    size_t length = 0;
    ring_name(ring, &length, "", ring->first);
    for (int i = 0; i < ring->count && i < MT_RING_FIRST; i++) {
        ring_name(ring, &length, arrow, ring->start[i]);
    }
    if (ring->count > end) {
        ring_write(ring, &length, "%s(%d more)", arrow, ring->count - end);
    }
    for (int i = ring->count > end ? ring->count - MT_RING_LAST : MT_RING_FIRST;
         i < ring->count; i++) {
        ring_name(ring, &length, arrow, ring->last[i % MT_RING_LAST]);
    }
    ring_name(ring, &length, arrow, ring->first);
}

static void note_cycle(const search *s, int again)
{
    const mt_model *const m = s->f->m;
    int from = s->depth - 1;
    while (s->stack[from] != again) {
        from--;
    }
    mt_resolve_ring ring = {.first = m->parameters[again].name.s};
    for (int i = from + 1; i < s->depth; i++) {
        mt_resolve_ring_add(&ring, m->parameters[s->stack[i]].name.s);
    }
    mt_resolve_ring_end(&ring);
    const mt_addr addr = mt_resolve_addr(m, s->value[again]);
    if (s->configuration == NULL) {
        mt_diag_error(s->f->d, addr, "parameters refer to each other in a circle: %s",
                      ring.text);
    } else {
        mt_diag_error(s->f->d, addr,
                      "in configuration \"%s\" parameters refer to each other in a circle: %s",
                      s->configuration, ring.text);
    }
}

/* Next parameter that the expression on top of the stack refers to; MT_ABSENT at its end. */
static int next_operand(const search *s)
{
    const int top = s->depth - 1;
    const mt_num num = s->value[s->stack[top]];
    if (num == MT_ABSENT) {
        return MT_ABSENT;
    }
    const mt_expr *const e = &s->f->m->nums[num].expr;
    while (s->next[top] < e->length) {
        const mt_code *const code = &e->code[s->next[top]++];
        if (code->op == MT_OP_PARAM) {
            return code->param;
        }
    }
    return MT_ABSENT;
}

static void push_parameter(search *s, int parameter)
{
    s->state[parameter] = ON_PATH;
    s->stack[s->depth] = parameter;
    s->next[s->depth] = 0;
    s->depth++;
}

/* Search from one parameter; true when a circle was found. */
static bool circle_from(search *s, int parameter)
{
    s->depth = 0;
    push_parameter(s, parameter);
    while (s->depth > 0) {
        const int operand = next_operand(s);
        if (operand == MT_ABSENT) {
            s->state[s->stack[--s->depth]] = DONE;
        } else if (s->state[operand] == ON_PATH) {
            note_cycle(s, operand);
            return true;
        } else if (s->state[operand] == UNSEEN) {
            push_parameter(s, operand);
        }
    }
    return false;
}

/* Every circle that is reached; the parameters of one are not entered again. */
static bool circles(search *s)
{
    const int n = s->f->m->n_parameters;
    bool any = false;
    for (int i = 0; i < n; i++) {
        s->state[i] = UNSEEN;
    }
    for (int i = 0; i < n; i++) {
        if (s->state[i] == UNSEEN && circle_from(s, i)) {
            any = true;
            for (int k = 0; k < s->depth; k++) {
                s->state[s->stack[k]] = DONE;
            }
        }
    }
    return any;
}

static void values_with_overrides(const mt_model *m, const mt_configuration *c, mt_num *value)
{
    for (int i = 0; i < m->n_parameters; i++) {
        value[i] = m->parameters[i].value;
    }
    for (int i = 0; c != NULL && i < c->n_overrides; i++) {
        if (c->overrides[i].parameter != MT_ABSENT) {
            value[c->overrides[i].parameter] = c->overrides[i].value;
        }
    }
}

void mt_resolve_cycles(mt_resolve *f)
{
    mt_model *const m = f->m;
    const size_t n = (size_t)m->n_parameters;
    search s = {.f = f,
                .value = mt_arena_int(&m->mem, n),
                .state = mt_arena_int(&m->mem, n),
                .stack = mt_arena_int(&m->mem, n),
                .next = mt_arena_int(&m->mem, n)};
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    values_with_overrides(m, NULL, s.value);
    if (circles(&s)) {
        return; /* configurations would repeat it */
    }
    for (int c = 0; c < m->n_configurations; c++) {
        if (m->configurations[c].n_overrides > 0) {
            s.configuration = m->configurations[c].name.s;
            values_with_overrides(m, &m->configurations[c], s.value);
            (void)circles(&s);
        }
    }
}
