/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Responses that results show. Names of ports are looked up where the mechanism is known
 * (problem/problem_responses.c). */
#include "study/study_priv.h"

void mt_study_check_responses(mt_study_check *c)
{
    for (int i = 0; i < c->study->n_responses; i++) {
        mt_study_response *const r = &c->study->responses[i];
        r->configuration = r->configuration_name.s == NULL
                               ? mt_check_only_configuration(c, c->model, r->addr)
                               : mt_check_configuration(c, c->model, r->configuration_name);
        const mt_shake *const s = &r->shake;
        if (MT_HAS(s->lower_hz) && MT_HAS(s->upper_hz) &&
            (!(s->lower_hz > 0.0) || !(s->lower_hz < s->upper_hz))) {
            mt_diag_error(
                c->diags, s->band_addr,
                "band_hz (%g to %g) must be two frequencies above 0 in ascending order",
                s->lower_hz, s->upper_hz);
        }
    }
}
