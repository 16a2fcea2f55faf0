/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What users of the library read from a result. */
#include <math.h>
#include <string.h>

#include "result/result.h"

static const mt_recommendation *design(const mt_result *result, int rank)
{
    if (rank == 0) {
        return result == NULL ? NULL : &result->baseline;
    }
    return result != NULL && rank > 0 && rank <= result->n_recommendations
               ? &result->recommendations[rank - 1]
               : NULL;
}

mt_result_status mt_result_outcome(const mt_result *result)
{
    return result == NULL ? MT_RESULT_STATUS_COUNT : result->status;
}

const char *mt_result_summary(const mt_result *result)
{
    if (result == NULL) {
        return NULL;
    }
    return result->status_text == NULL ? "" : result->status_text;
}

int mt_result_recommendations(const mt_result *result)
{
    return result == NULL ? 0 : result->n_recommendations;
}

int mt_result_feasible(const mt_result *result, int rank)
{
    const mt_recommendation *const r = design(result, rank);
    return r != NULL && r->feasible ? 1 : 0;
}

double mt_result_value(const mt_result *result, int rank, const char *parameter)
{
    const mt_recommendation *const r = design(result, rank);
    for (int i = 0; r != NULL && parameter != NULL && i < r->n_parameters; i++) {
        if (strcmp(r->parameters[i].name, parameter) == 0) {
            return r->parameters[i].recommended;
        }
    }
    return nan("");
}

double mt_result_hz(const mt_result *result, int rank, const char *configuration, int mode)
{
    const mt_recommendation *const r = design(result, rank);
    for (int i = 0; r != NULL && configuration != NULL && i < r->n_frequencies; i++) {
        const mt_result_frequency *const f = &r->frequencies[i];
        if (f->mode == mode && strcmp(f->configuration, configuration) == 0) {
            return f->recommended_hz;
        }
    }
    return nan("");
}

int mt_result_reasons(const mt_result *result, int rank)
{
    const mt_recommendation *const r = design(result, rank);
    return r == NULL ? 0 : r->n_reasons;
}

const char *mt_result_reason(const mt_result *result, int rank, int i)
{
    const mt_recommendation *const r = design(result, rank);
    return r != NULL && i >= 0 && i < r->n_reasons ? r->reasons[i].text : NULL;
}
