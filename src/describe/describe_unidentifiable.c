/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <string.h>

#include "describe/describe.h"

/* Entries of a direction below this part of the largest are rounding. */
static const double PART_OF_DIRECTION = 1e-3;
/* The search's own tolerance where no goal sets one: residuals count as unchanged below it
 * (nlp.h). */
static const double RESIDUAL_TOLERANCE = 1e-6;

/* "K_T2", or "0.71 ln a - 0.71 ln b". */
static const char *direction_text(const mt_problem *p, const double *v, mt_arena *mem)
{
    double largest = 0.0;
    int parts = 0;
    const char *text = "";
    for (int i = 0; i < p->n; i++) {
        largest = fmax(largest, fabs(v[i]));
    }
    for (int i = 0; i < p->n; i++) {
        parts += fabs(v[i]) > PART_OF_DIRECTION * largest ? 1 : 0;
    }
    for (int i = 0; i < p->n && text != NULL; i++) {
        const char *const name = p->study->variables[i].parameter_name.s;
        if (!(fabs(v[i]) > PART_OF_DIRECTION * largest)) {
            continue;
        }
        if (parts == 1) {
            return name;
        }
        const bool first = text[0] == '\0';
        const char *const plus = first ? "" : " + ";
        const char *const minus = first ? "-" : " - ";
        text = mt_arena_printf(mem, "%s%s%.2g %s%s", text, v[i] < 0.0 ? minus : plus,
                               fabs(v[i]), MT_HAS(p->scale[i]) ? "" : "ln ", name);
    }
    return text;
}

mt_status mt_describe_unidentifiable(const mt_problem *p, const mt_nlp_result *found,
                                     mt_result *result, mt_err *err)
{
    double tolerance = RESIDUAL_TOLERANCE;
    for (int i = 0; i < p->n_requirements; i++) {
        tolerance = fmax(tolerance, p->requirements[i].tolerance);
    }
    result->unidentifiable = mt_arena_alloc(&result->mem, (size_t)found->n_unidentifiable,
                                            sizeof *result->unidentifiable);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int k = 0; k < found->n_unidentifiable; k++) {
        const double *const v = found->unidentifiable + ((ptrdiff_t)k * p->n);
        mt_unidentifiable_direction *const u = &result->unidentifiable[k];
        u->direction = mt_arena_f64(&result->mem, (size_t)p->n, 1);
        u->text = direction_text(p, v, &result->mem);
        u->effect_percent = 100.0 * tolerance * found->unidentifiable_effect[k];
        MT_TRY(mt_arena_check(&result->mem, err));
        memcpy(u->direction, v, (size_t)p->n * sizeof *v);
        result->n_unidentifiable++;
    }
    return MT_OK;
}
