/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search/infeasible_presolve.h"

#include "prove/reach.h"
#include "search/proof.h"

/* Multiplications of branch and bound: a millisecond, or a box. */
static const double LITTLE = 1e6;

/* A limit on an expression is not known by its requirement: where one is left out, all are. */
static void leave_out_requirement(mt_proof *proof, int requirement)
{
    mt_certify *const c = &proof->question;
    int n = 0;
    for (int i = 0; i < c->n_limits; i++) {
        if (proof->limit_requirement[i] != requirement) {
            proof->limits[n++] = proof->limits[i];
        }
    }
    c->n_limits = n;
    c->n_bounds = requirement >= 0 ? 0 : c->n_bounds;
}

static mt_status prove_infeasible(const mt_infeasible_presolve_question *q, mt_proof *proof,
                                  mt_arena *mem, bool *out, mt_err *err)
{
    const mt_certify *const c = &proof->question;
    mt_certify_search found = {0};
    MT_TRY(mt_certify_out_of_reach(c, mem, out, err));
    if (*out || c->n_bands + c->n_limits + c->n_bounds == 0) {
        return MT_OK;
    }
    MT_TRY(mt_proof_query(proof, q->most > 0.0 ? q->most : LITTLE, mem, &found, err));
    *out = found.proven && found.n_found == 0;
    if (*out && q->boxes != NULL) {
        *q->boxes = found.boxes;
    }
    return MT_OK;
}

mt_status mt_infeasible_presolve(const mt_infeasible_presolve_question *q, mt_arena *mem,
                                 bool *out, mt_err *err)
{
    mt_proof proof;
    *out = false;
    mt_status rc = mt_proof_init(&proof, q->c, mem, err);
    if (rc == MT_OK && proof.possible) {
        leave_out_requirement(&proof, q->but);
        proof.question.n_bands = q->bands ? proof.question.n_bands : 0;
        proof.question.progress = NULL; /* not the answer's own */
        proof.spent = q->counted ? proof.spent : NULL;
        rc = prove_infeasible(q, &proof, mem, out, err);
    }
    mt_proof_free(&proof);
    return rc;
}
