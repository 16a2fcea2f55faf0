/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/stages.h"

#include <string.h>

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

void mt_stages_init(mt_stages *s, const mt_system *sys, const mt_term_list *lists,
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

bool mt_stages_empty(const mt_stages *s, const uint64_t *set)
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

bool mt_stages_same(const mt_stages *s, const uint64_t *set, const double *at,
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
    if (s->valid[stage] && mt_stages_same(s, set, s->at[stage], inputs)) {
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

void mt_stages_shared(mt_stages *s, mt_stage_id stage, const double *inputs)
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
