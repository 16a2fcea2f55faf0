/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A local search as a record: the designs where it stands, and what it knows about them.
 * Values and slopes there are evaluated anew.
 */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "nlp/local.h"

/* The numbers that a design alone does not give, and those that tell whether it gives the
 * others again. */
static void tape_point(const mt_nlp_engine *e, mt_nlp_point *p, mt_tape *tape)
{
    mt_tape_numbers(tape, (size_t)e->n, p->t);
    mt_tape_numbers(tape, 1, &p->f);
    mt_tape_numbers(tape, 1, &p->violation);
    mt_tape_numbers(tape, 1, &p->squares);
    mt_tape_numbers(tape, 1, &p->kkt);
    mt_tape_int(tape, &p->n_loose, 0, INT_MAX);
}

/* Everything else at the design of p; false where its numbers come out otherwise. */
static bool evaluate_again(mt_nlp_engine *e, mt_nlp_point *p, mt_nlp_point *at)
{
    const bool same = mt_nlp_evaluate(e, p->t, true, at) && at->f == p->f &&
                      at->violation == p->violation && at->squares == p->squares &&
                      memcmp(at->t, p->t, (size_t)e->n * sizeof *p->t) == 0;
    at->kkt = p->kkt;
    at->n_loose = p->n_loose;
    return same;
}

static void tape_state(const mt_nlp_engine *e, mt_nlp_local *s, mt_tape *tape)
{
    int aim = (int)s->aim;
    mt_tape_int(tape, &aim, MT_NLP_OBJECTIVE, MT_NLP_SQUARES);
    s->aim = (mt_nlp_aim)aim;
    mt_tape_int(tape, &s->n_rows, 0, e->nlp->n_eq);
    for (int i = 0; i < s->n_rows; i++) {
        mt_tape_int(tape, &s->rows[i], 0, e->nlp->n_eq - 1);
    }
    mt_tape_flag(tape, &s->restored);
    mt_tape_flag(tape, &s->abandoned);
    mt_tape_flag(tape, &s->curve);
    mt_tape_flag(tape, &s->polished);
    mt_tape_numbers(tape, (size_t)e->n, s->from);
    mt_tape_numbers(tape, 1, &s->kkt);
}

static bool read(mt_nlp_engine *e, mt_nlp_local *s, mt_tape *tape)
{
    mt_nlp_local got = mt_nlp_local_new(e, &e->scratch);
    mt_nlp_point *const p = mt_nlp_point_new(e, &e->scratch);
    mt_nlp_point *const last = mt_nlp_point_new(e, &e->scratch);
    if (!mt_nlp_has_room(e, &e->scratch)) {
        return false;
    }
    tape_state(e, &got, tape);
    tape_point(e, got.p, tape);
    bool same = true;
    if (got.aim == MT_NLP_OBJECTIVE) {
        tape_point(e, got.last, tape);
        same = mt_tape_is_read(tape) && evaluate_again(e, got.last, last);
    }
    if (!same || !mt_tape_is_read(tape) || !evaluate_again(e, got.p, p)) {
        return false;
    }
    mt_nlp_point_copy(e, s->p, p);
    if (got.aim == MT_NLP_OBJECTIVE) {
        mt_nlp_point_copy(e, s->last, last);
    }
    memcpy(s->rows, got.rows, (size_t)got.n_rows * sizeof *s->rows);
    memcpy(s->from, got.from, (size_t)e->n * sizeof *s->from);
    s->aim = got.aim;
    s->n_rows = got.n_rows;
    s->restored = got.restored;
    s->abandoned = got.abandoned;
    s->curve = got.curve;
    s->polished = got.polished;
    s->kkt = got.kkt;
    return true;
}

bool mt_nlp_local_tape(mt_nlp_engine *e, mt_nlp_local *s, mt_tape *tape)
{
    bool begun = s->begun;
    mt_tape_flag(tape, &begun);
    if (!tape->reads) {
        tape_state(e, s, tape);
        tape_point(e, s->p, tape);
        if (s->aim == MT_NLP_OBJECTIVE) {
            tape_point(e, s->last, tape);
        }
        return !tape->failed;
    }
    /* what is evaluated here was counted when the record was made */
    const mt_nlp_engine before = *e;
    const mt_arena_mark mark = mt_arena_get_mark(&e->scratch);
    e->opt.max_evals = LONG_MAX;
    const bool same = !tape->failed && begun == s->begun && read(e, s, tape);
    mt_arena_rewind(&e->scratch, mark);
    e->opt.max_evals = before.opt.max_evals;
    e->evals = before.evals;
    e->refused = before.refused;
    e->refused_err = before.refused_err;
    tape->failed = !same;
    return same;
}
