/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A result: made, filled, copied and taken back; what users of the library read of it; which
 * points of a large grid are shown whole. */
#include "result/result.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"

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

const char *mt_result_warning(const mt_result *result, int i)
{
    return i < result->n_doubts ? result->doubts[i].text : NULL;
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

/* What users of the library read from a result. */

static const mt_recommendation *find_design(const mt_result *result, int rank)
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
    const mt_recommendation *const r = find_design(result, rank);
    return r != NULL && r->feasible ? 1 : 0;
}

double mt_result_value(const mt_result *result, int rank, const char *parameter)
{
    const mt_recommendation *const r = find_design(result, rank);
    for (int i = 0; r != NULL && parameter != NULL && i < r->n_parameters; i++) {
        if (strcmp(r->parameters[i].name, parameter) == 0) {
            return r->parameters[i].recommended;
        }
    }
    return nan("");
}

double mt_result_hz(const mt_result *result, int rank, const char *configuration, int mode)
{
    const mt_recommendation *const r = find_design(result, rank);
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
    const mt_recommendation *const r = find_design(result, rank);
    return r == NULL ? 0 : r->n_reasons;
}

const char *mt_result_reason(const mt_result *result, int rank, int i)
{
    const mt_recommendation *const r = find_design(result, rank);
    return r != NULL && i >= 0 && i < r->n_reasons ? r->reasons[i].text : NULL;
}

/* Which points of a large grid are shown whole. */

static bool counts_point(const mt_trade_selection *s, int k)
{
    const mt_trade_point *const p = &s->trade->points[k];
    return (!s->front || p->pareto) && (!s->found || p->best.n_parameters > 0);
}

static int count_points(const mt_trade_result *trade, bool front, bool found)
{
    const mt_trade_selection s = {.trade = trade, .front = front, .found = found};
    int n = 0;
    for (int k = 0; k < trade->n_points; k++) {
        n += counts_point(&s, k) ? 1 : 0;
    }
    return n;
}

mt_trade_selection mt_trade_select(const mt_trade_result *trade)
{
    mt_trade_selection s = {.trade = trade, .each = 1};
    if (trade->n_points <= MT_TRADE_WHOLE) {
        return s;
    }
    s.found = count_points(trade, false, true) > 0;
    s.front = count_points(trade, true, s.found) > 0;
    s.each = (count_points(trade, s.front, s.found) + MT_TRADE_WHOLE - 1) / MT_TRADE_WHOLE;
    return s;
}

bool mt_trade_is_selected(mt_trade_selection *s, int k)
{
    return counts_point(s, k) && s->met++ % s->each == 0;
}
