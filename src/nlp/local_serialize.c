/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A local search as a record: the designs where it stands, and what it knows about them.
 * Values and slopes there are evaluated anew.
 */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "nlp/local.h"

/* Writes or reads the values that do not follow from the design alone, and those that check the
 * others. */
static void serialize_point(const mt_nlp_engine *e, mt_nlp_point *p, mt_serializer *serializer)
{
    mt_serializer_numbers(serializer, (size_t)e->n, p->t);
    mt_serializer_numbers(serializer, 1, &p->f);
    mt_serializer_numbers(serializer, 1, &p->violation);
    mt_serializer_numbers(serializer, 1, &p->squares);
    mt_serializer_numbers(serializer, 1, &p->kkt);
    mt_serializer_int(serializer, &p->n_loose, 0, INT_MAX);
    mt_serializer_flag(serializer, &p->isolated);
}

/* Evaluates everything else at the design of p; false where the values differ. */
static bool evaluate_again(mt_nlp_engine *e, mt_nlp_point *p, mt_nlp_point *at)
{
    const bool same = mt_nlp_evaluate(e, p->t, true, at) && at->f == p->f &&
                      at->violation == p->violation && at->squares == p->squares &&
                      memcmp(at->t, p->t, (size_t)e->n * sizeof *p->t) == 0;
    at->kkt = p->kkt;
    at->n_loose = p->n_loose;
    at->isolated = p->isolated;
    return same;
}

static void serialize_state(const mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer)
{
    int stage = (int)s->stage;
    mt_serializer_int(serializer, &stage, MT_NLP_OBJECTIVE, MT_NLP_SQUARES);
    s->stage = (mt_nlp_stage)stage;
    mt_serializer_int(serializer, &s->n_rows, 0, e->nlp->n_eq);
    for (int i = 0; i < s->n_rows; i++) {
        mt_serializer_int(serializer, &s->rows[i], 0, e->nlp->n_eq - 1);
    }
    mt_serializer_flag(serializer, &s->restored);
    mt_serializer_flag(serializer, &s->abandoned);
    mt_serializer_flag(serializer, &s->curve);
    mt_serializer_flag(serializer, &s->polished);
    mt_serializer_numbers(serializer, (size_t)e->n, s->from);
    mt_serializer_numbers(serializer, 1, &s->kkt);
}

static bool read(mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer)
{
    mt_nlp_local got = mt_nlp_local_new(e, &e->scratch);
    mt_nlp_point *const p = mt_nlp_point_new(e, &e->scratch);
    mt_nlp_point *const last = mt_nlp_point_new(e, &e->scratch);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return false;
    }
    serialize_state(e, &got, serializer);
    serialize_point(e, got.p, serializer);
    bool same = true;
    if (got.stage == MT_NLP_OBJECTIVE) {
        serialize_point(e, got.last, serializer);
        same = mt_serializer_is_read(serializer) && evaluate_again(e, got.last, last);
    }
    if (!same || !mt_serializer_is_read(serializer) || !evaluate_again(e, got.p, p)) {
        return false;
    }
    mt_nlp_point_copy(e, s->p, p);
    if (got.stage == MT_NLP_OBJECTIVE) {
        mt_nlp_point_copy(e, s->last, last);
    }
    memcpy(s->rows, got.rows, (size_t)got.n_rows * sizeof *s->rows);
    memcpy(s->from, got.from, (size_t)e->n * sizeof *s->from);
    s->stage = got.stage;
    s->n_rows = got.n_rows;
    s->restored = got.restored;
    s->abandoned = got.abandoned;
    s->curve = got.curve;
    s->polished = got.polished;
    s->kkt = got.kkt;
    return true;
}

bool mt_nlp_local_serialize(mt_nlp_engine *e, mt_nlp_local *s, mt_serializer *serializer)
{
    bool begun = s->begun;
    mt_serializer_flag(serializer, &begun);
    if (!serializer->reads) {
        serialize_state(e, s, serializer);
        serialize_point(e, s->p, serializer);
        if (s->stage == MT_NLP_OBJECTIVE) {
            serialize_point(e, s->last, serializer);
        }
        return !serializer->failed;
    }
    /* what is evaluated here was counted when the record was made */
    const mt_nlp_engine before = *e;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    e->opt.max_evals = LONG_MAX;
    const bool same = !serializer->failed && begun == s->begun && read(e, s, serializer);
    mt_arena_rewind(&e->scratch, mark);
    e->opt.max_evals = before.opt.max_evals;
    e->evals = before.evals;
    e->refused = before.refused;
    e->refused_err = before.refused_err;
    serializer->failed = !same;
    return same;
}
