/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far an answer is complete. */
#include "result/result.h"

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
