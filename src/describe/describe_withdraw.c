/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a fresh analysis that disagrees (describe_verify.c) makes of a result. */
#include <string.h>

#include "describe/describe.h"

static bool doubted(const mt_recommendation *rec)
{
    return rec->disagreement != NULL;
}

bool mt_describe_is_doubted(const mt_result *result)
{
    bool any = doubted(&result->baseline);
    for (int i = 0; i < result->n_recommendations; i++) {
        any = any || doubted(&result->recommendations[i]);
    }
    return any;
}

/* Withdraw the proven grade of a design: its proof rests on results that disagree, at any
 * design of the study. */
static void disgrade(mt_recommendation *rec)
{
    rec->tolerance_box = NULL;
    rec->worst_case = rec->worst_case == NULL ? NULL : "sampled";
    if (doubted(rec)) {
        rec->grade = "not verified";
    } else if (rec->feasible && rec->grade != NULL &&
               strcmp(rec->grade, "feasible and proven") == 0) {
        rec->grade = "feasible";
    }
}

mt_status mt_describe_withdraw(mt_result *result, mt_err *err)
{
    disgrade(&result->baseline);
    for (int i = 0; i < result->n_recommendations; i++) {
        disgrade(&result->recommendations[i]);
    }
    for (int i = 0; i < result->n_certificates; i++) {
        mt_certificate *const c = &result->certificates[i];
        c->proven = false;
        c->text = mt_arena_printf(
            &result->mem,
            "Withdrawn, because recomputed values differ from those it rests on: %s", c->text);
    }
    return mt_arena_check(&result->mem, err);
}
