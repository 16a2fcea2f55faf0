/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/result.h"

#include <math.h>
#include <stdlib.h>

mt_status mt_result_new(mt_result **out, mt_err *err)
{
    *out = NULL;
    mt_result *const result = calloc(1, sizeof *result);
    if (result == NULL) {
        return mt_fail_memory(err);
    }
    const mt_status rc = mt_arena_init(&result->mem, 0, err);
    if (rc != MT_OK) {
        free(result);
        return rc;
    }
    result->status = MT_RESULT_INTERRUPTED;
    result->baseline = mt_recommendation_default();
    result->run.distinct_designs = -1;
    result->run.found_once = -1;
    result->run.estimated_missing = nan("");
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

mt_result_mark mt_result_get_mark(const mt_result *result)
{
    return (mt_result_mark){.n_undetermined = result->n_undetermined,
                            .n_spread = result->n_spread,
                            .n_certificates = result->n_certificates,
                            .n_relaxations = result->n_relaxations,
                            .n_published = result->n_published,
                            .n_warnings = result->n_warnings};
}

void mt_result_take_back(mt_result *result, const mt_result_mark *mark)
{
    result->n_undetermined = mark->n_undetermined;
    result->n_spread = mark->n_spread;
    result->n_certificates = mark->n_certificates;
    result->n_relaxations = mark->n_relaxations;
    result->n_published = mark->n_published;
    result->n_warnings = mark->n_warnings;
}

mt_recommendation mt_recommendation_default(void)
{
    return (mt_recommendation){
        .score = nan(""),
        .change = nan(""),
        .misfit = nan(""),
        .violation_percent = nan(""),
        .clearance_percent = nan(""),
        .kkt_residual = nan(""),
    };
}

mt_result_frequency mt_result_frequency_default(void)
{
    return (mt_result_frequency){
        .original_hz = nan(""),
        .recommended_hz = nan(""),
        .target_hz = nan(""),
        .at_least_hz = nan(""),
        .at_most_hz = nan(""),
        .error_percent = nan(""),
        .lowest_hz = nan(""),
        .highest_hz = nan(""),
        .mac = nan(""),
        .share = nan(""),
        .rival_share = nan(""),
        .residual = nan(""),
        .orthogonality = nan(""),
    };
}

mt_result_published mt_result_published_default(void)
{
    return (mt_result_published){
        .published = nan(""),
        .computed = nan(""),
        .difference = nan(""),
        .difference_percent = nan(""),
    };
}

mt_certificate mt_certificate_default(void)
{
    return (mt_certificate){.reachable_lower_hz = nan(""), .reachable_upper_hz = nan("")};
}

mt_tolerance_box mt_tolerance_box_default(void)
{
    return (mt_tolerance_box){.all_percent = nan("")};
}

mt_result_motion mt_result_motion_default(void)
{
    return (mt_result_motion){.from = nan(""),
                              .to = nan(""),
                              .least_clearance_percent = nan(""),
                              .margin_percent = nan(""),
                              .at = nan(""),
                              .hz = nan("")};
}

#define NAME_CASE(id, name) \
    case id:                \
        return name;

const char *mt_result_status_name(mt_result_status status)
{
    switch (status) {
        MT_RESULT_STATUS_LIST(NAME_CASE)
    case MT_RESULT_STATUS_COUNT:
        break;
    }
    return "unknown";
}
