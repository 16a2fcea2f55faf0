/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "nlp/steps.h"

#include <limits.h>
#include <string.h>

#include "nlp/merit.h"

mt_steps mt_steps_new(int most, mt_arena *mem)
{
    return (mt_steps){.most = most, .at = mt_arena_alloc(mem, (size_t)most, sizeof(mt_step))};
}

/* True where a ranks before b; use of the tolerances makes no difference. */
static bool is_before(const mt_step *a, const mt_step *b)
{
    const mt_merit x = {mt_is_held(a->violation), a->squares, 1, &a->f};
    const mt_merit y = {mt_is_held(b->violation), b->squares, 1, &b->f};
    return mt_merit_before(&x, &y, MT_EQUAL_FOUND);
}

static bool is_alike(const mt_step *a, const mt_step *b)
{
    return a->stage == b->stage && a->round == b->round;
}

/* The last step of its stage and round; NULL: none. */
static const mt_step *last_of(const mt_steps *steps, const mt_step *step)
{
    for (int i = steps->n - 1; i >= 0; i--) {
        if (is_alike(&steps->at[i], step)) {
            return &steps->at[i];
        }
    }
    return NULL;
}

/* Drops every other step between the first and the last of each stage and round; where none
 * lies between, the oldest. */
static void thin(mt_steps *steps)
{
    mt_step *const at = steps->at;
    bool drop = true;
    int kept = 1;
    for (int i = 1; i + 1 < steps->n; i++) {
        const bool inner = is_alike(&at[i - 1], &at[i]) && is_alike(&at[i], &at[i + 1]);
        if (!inner || !drop) {
            at[kept++] = at[i];
        }
        drop = inner && !drop;
    }
    at[kept++] = at[steps->n - 1];
    if (kept == steps->n) {
        kept--;
        memmove(at, at + 1, (size_t)kept * sizeof *at);
    }
    steps->n = kept;
}

static void append_step(mt_steps *steps, const mt_step *step)
{
    if (steps->at == NULL) {
        return;
    }
    if (steps->n == steps->most) {
        thin(steps);
    }
    steps->at[steps->n++] = *step;
}

void mt_steps_add(mt_steps *steps, const mt_step *step)
{
    const mt_step *const last = steps->at == NULL ? NULL : last_of(steps, step);
    if (last == NULL || is_before(step, last)) {
        append_step(steps, step);
    }
}

void mt_steps_append(mt_steps *steps, const mt_steps *more, long evals, int stage, int round)
{
    for (int i = 0; i < more->n; i++) {
        mt_step one = more->at[i];
        one.evals += evals;
        one.stage += stage;
        one.round += round;
        mt_steps_add(steps, &one);
    }
}

void mt_steps_settle(mt_steps *steps, const mt_step *end)
{
    mt_step one = *end;
    one.round = 0;
    for (int i = 0; i < steps->n; i++) {
        if (steps->at[i].stage == one.stage && steps->at[i].round > one.round) {
            one.round = steps->at[i].round;
        }
    }
    const mt_step *const last = last_of(steps, &one);
    if (last != NULL && is_before(last, &one)) {
        one.round++;
    }
    append_step(steps, &one);
}

void mt_steps_serialize(mt_steps *steps, mt_serializer *serializer)
{
    int n = steps->n;
    mt_serializer_int(serializer, &n, 0, steps->most);
    for (int i = 0; i < n && !serializer->failed; i++) {
        mt_step *const s = &steps->at[i];
        if (serializer->reads) {
            *s = (mt_step){.evals = 0};
        }
        mt_serializer_long(serializer, &s->evals, 0, LONG_MAX);
        mt_serializer_numbers(serializer, 1, &s->f);
        mt_serializer_numbers(serializer, 1, &s->violation);
        mt_serializer_numbers(serializer, 1, &s->squares);
    }
    steps->n = serializer->failed ? 0 : n;
}
