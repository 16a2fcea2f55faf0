/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dampers and loss factors as matrices: sums of the same rows as those of the springs. */
#include "mechanics/linear_priv.h"

#include <string.h>

#include "linalg/dense.h"

double mt_linear_loss(const mt_linear *lin, const mt_term *t)
{
    return t->loss == MT_NO_NODE ? 0.0 : lin->value[t->loss] * lin->value[t->coefficient];
}

void mt_linear_damping(const mt_linear *lin, double *c)
{
    const mt_term_list *const list = &lin->list[MT_TERM_DAMPING];
    memset(c, 0, (size_t)lin->n * (size_t)lin->n * sizeof *c);
    for (int i = 0; i < list->n_terms; i++) {
        const double value = lin->value[list->terms[i].coefficient];
        if (value != 0.0) {
            mt_linear_add_term(lin, MT_TERM_DAMPING, &list->terms[i], value, c);
        }
    }
    mt_symmetrise_lower(lin->n, c);
}

bool mt_linear_structural(const mt_linear *lin, double *h)
{
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    bool any = false;
    if (h != NULL) {
        memset(h, 0, (size_t)lin->n * (size_t)lin->n * sizeof *h);
    }
    for (int i = 0; i < list->n_terms; i++) {
        const double value = mt_linear_loss(lin, &list->terms[i]);
        any = any || value != 0.0;
        if (value != 0.0 && h != NULL) {
            mt_linear_add_term(lin, MT_TERM_STIFFNESS, &list->terms[i], value, h);
        }
    }
    if (h != NULL) {
        mt_symmetrise_lower(lin->n, h);
    }
    return any;
}
