/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recommendation from one result into another, which may outlive it. */
#include <string.h>

#include "result/result.h"

typedef struct copier {
    mt_arena *mem;
    bool failed;
} copier;

static const char *text(copier *c, const char *s)
{
    const char *const own = s == NULL ? NULL : mt_arena_strdup(c->mem, s);
    c->failed = c->failed || (s != NULL && own == NULL);
    return own;
}

static void *list(copier *c, const void *items, int n, size_t size)
{
    void *const own = mt_arena_alloc(c->mem, (size_t)n, size);
    c->failed = c->failed || own == NULL;
    if (own != NULL && n > 0) {
        memcpy(own, items, (size_t)n * size);
    }
    return own;
}

static void copy_parameters(copier *c, mt_recommendation *r)
{
    r->parameters = list(c, r->parameters, r->n_parameters, sizeof *r->parameters);
    for (int i = 0; i < r->n_parameters && !c->failed; i++) {
        mt_result_parameter *const p = &r->parameters[i];
        p->name = text(c, p->name);
        p->unit = text(c, p->unit);
        p->at_bound = text(c, p->at_bound);
    }
}

static void copy_frequencies(copier *c, mt_recommendation *r)
{
    r->frequencies = list(c, r->frequencies, r->n_frequencies, sizeof *r->frequencies);
    for (int i = 0; i < r->n_frequencies && !c->failed; i++) {
        mt_result_frequency *const f = &r->frequencies[i];
        f->configuration = text(c, f->configuration);
        f->name = text(c, f->name);
        f->reference = text(c, f->reference);
        f->slack = text(c, f->slack);
        if (f->sensitivity != NULL) {
            f->sensitivity = list(c, f->sensitivity, r->n_parameters, sizeof(double));
        }
    }
}

static void copy_bands(copier *c, mt_recommendation *r)
{
    r->clearances = list(c, r->clearances, r->n_clearances, sizeof *r->clearances);
    for (int i = 0; i < r->n_clearances && !c->failed; i++) {
        mt_result_clearance *const one = &r->clearances[i];
        one->configuration = text(c, one->configuration);
        one->band = text(c, one->band);
        one->side = text(c, one->side);
    }
    r->gaps = list(c, r->gaps, r->n_gaps, sizeof *r->gaps);
    for (int i = 0; i < r->n_gaps && !c->failed; i++) {
        r->gaps[i].configuration = text(c, r->gaps[i].configuration);
        r->gaps[i].band = text(c, r->gaps[i].band);
    }
}

static void copy_motions(copier *c, mt_recommendation *r)
{
    r->motions = list(c, r->motions, r->n_motions, sizeof *r->motions);
    for (int i = 0; i < r->n_motions && !c->failed; i++) {
        mt_result_motion *const m = &r->motions[i];
        m->pointer = text(c, m->pointer);
        m->drive = text(c, m->drive);
        m->unit = text(c, m->unit);
        m->band = text(c, m->band);
        m->grade = text(c, m->grade);
        m->text = text(c, m->text);
    }
}

static void copy_tolerances(copier *c, mt_recommendation *r)
{
    if (r->tolerance_box == NULL) {
        return;
    }
    mt_tolerance_box *const box = list(c, r->tolerance_box, 1, sizeof *box);
    r->tolerance_box = box;
    if (c->failed) {
        return;
    }
    box->edge = text(c, box->edge);
    box->variables = list(c, box->variables, box->n_variables, sizeof *box->variables);
    for (int i = 0; i < box->n_variables && !c->failed; i++) {
        box->variables[i].name = text(c, box->variables[i].name);
        box->variables[i].edge = text(c, box->variables[i].edge);
    }
}

static void copy_words(copier *c, mt_recommendation *r)
{
    r->grade = text(c, r->grade);
    r->disagreement = text(c, r->disagreement);
    r->score_unit = text(c, r->score_unit);
    r->worst_case = text(c, r->worst_case);
    r->goals = list(c, r->goals, r->n_goals, sizeof *r->goals);
    for (int i = 0; i < r->n_goals && !c->failed; i++) {
        r->goals[i].text = text(c, r->goals[i].text);
        r->goals[i].pointer = text(c, r->goals[i].pointer);
        if (r->goals[i].worst_at != NULL) {
            r->goals[i].worst_at =
                list(c, r->goals[i].worst_at, r->n_parameters, sizeof(double));
        }
    }
    r->reasons = list(c, r->reasons, r->n_reasons, sizeof *r->reasons);
    for (int i = 0; i < r->n_reasons && !c->failed; i++) {
        r->reasons[i] = text(c, r->reasons[i]);
    }
}

mt_status mt_recommendation_copy(const mt_recommendation *from, mt_arena *mem,
                                 mt_recommendation *out, mt_err *err)
{
    copier c = {.mem = mem};
    *out = *from;
    copy_parameters(&c, out);
    copy_frequencies(&c, out);
    copy_bands(&c, out);
    copy_motions(&c, out);
    copy_tolerances(&c, out);
    copy_words(&c, out);
    return c.failed ? mt_fail_memory(err) : MT_OK;
}
