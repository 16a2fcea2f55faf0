/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses that results show. Names of ports are looked up where the mechanism is known
 * (problem/problem.c). */
#include "study/study_priv.h"

void mt_study_check_responses(mt_study_check *c)
{
    for (int i = 0; i < c->study->n_responses; i++) {
        mt_study_response *const r = &c->study->responses[i];
        r->configuration = r->configuration_name.s == NULL
                               ? mt_check_only_configuration(c, c->model, r->addr)
                               : mt_check_configuration(c, c->model, r->configuration_name);
        mt_check_range(c, &r->response_limit, r->addr);
    }
}
