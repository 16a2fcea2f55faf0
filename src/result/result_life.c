/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The life of a result: made, filled, copied, taken back. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/number.h"
#include "result/result.h"

mt_status mt_result_new(mt_result **out, mt_err *err)
{
    *out = NULL;
    mt_result *const result = malloc(sizeof *result);
    if (result == NULL) {
        return mt_fail_memory(err);
    }
    mt_record_clear(&mt_result_record, result);
    result->status = MT_RESULT_INTERRUPTED;
    const mt_status rc = mt_arena_init(&result->mem, 0, err);
    if (rc != MT_OK) {
        free(result);
        return rc;
    }
    *out = result;
    return MT_OK;
}

void mt_result_delete(mt_result *result)
{
    if (result != NULL) {
        mt_arena_free(&result->mem);
        free(result);
    }
}

double mt_result_shown(double value, double factor)
{
    if (!(factor > 0.0) || factor == 1.0) {
        return value;
    }
    const double number = value / factor;
    if (!isfinite(number)) {
        return number;
    }
    const double few = mt_few_digits(number);
    return fabs(few * factor - value) <= DBL_EPSILON * fabs(value) ? few : number;
}

mt_result_mark mt_result_get_mark(const mt_result *result)
{
    return (mt_result_mark){.n_unidentifiable = result->n_unidentifiable,
                            .n_weight_sensitivity = result->n_weight_sensitivity,
                            .n_certificates = result->n_certificates,
                            .n_relaxations = result->n_relaxations,
                            .n_published = result->n_published,
                            .n_warnings = result->n_warnings};
}

void mt_result_take_back(mt_result *result, const mt_result_mark *mark)
{
    result->n_unidentifiable = mark->n_unidentifiable;
    result->n_weight_sensitivity = mark->n_weight_sensitivity;
    result->n_certificates = mark->n_certificates;
    result->n_relaxations = mark->n_relaxations;
    result->n_published = mark->n_published;
    result->n_warnings = mark->n_warnings;
}

mt_status mt_result_take_warnings(mt_result *result, const mt_warning_list *list, mt_err *err)
{
    result->doubts = mt_arena_alloc(&result->mem, (size_t)list->n, sizeof *result->doubts);
    result->facts = mt_arena_alloc(&result->mem, (size_t)list->n, sizeof *result->facts);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < list->n; i++) {
        if (list->items[i].level == MT_LEVEL_WARNING) {
            result->doubts[result->n_doubts++] = list->items[i];
        } else if (list->items[i].level == MT_LEVEL_NOTE) {
            result->facts[result->n_facts++] = list->items[i];
        }
    }
    return MT_OK;
}

mt_status mt_recommendation_copy(const mt_recommendation *from, const mt_recommendation *like,
                                 mt_arena *mem, mt_recommendation *out, mt_err *err)
{
    *out = *from;
    mt_record_own(&mt_design_record, out, like, from->n_parameters, mem);
    return mt_arena_check(mem, err);
}

mt_status mt_result_own(mt_result *result, mt_err *err)
{
    mt_record_own(&mt_result_record, result, NULL, result->n_variables, &result->mem);
    return mt_arena_check(&result->mem, err);
}
