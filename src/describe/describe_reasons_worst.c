/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sentences about the tolerances of the variables: how surely goals hold over them. */
#include "describe/describe_reasons_priv.h"

#include <string.h>

#include "problem/tolerance.h"

void mt_add_worst_sentences(mt_sentences *s)
{
    static const double PERCENT = 100.0;
    const char *text = ""; /* "k1 2 %, k2 5 %" */
    int n = 0;
    if (s->rec->worst_case == NULL) {
        return;
    }
    for (int i = 0; i < s->p->n; i++) {
        const double percent = PERCENT * mt_tolerance_of_variable(s->p, i);
        if (percent > 0.0) {
            text =
                mt_arena_printf(&s->result->mem, "%s%s%s %.6g %%", text, n++ == 0 ? "" : ", ",
                                s->p->study->variables[i].parameter_name.s, percent);
        }
    }
    mt_sentence_of(s, "hold", NULL);
    if (strcmp(s->rec->worst_case, "proven") == 0) {
        mt_add_sentence(
            s,
            "Goals are judged at the worst corner of the tolerances (%s), which is proven "
            "to be the worst case.",
            text);
    } else {
        mt_add_sentence(
            s,
            "Goals are judged by the worst of the corners of the tolerances (%s) and of "
            "samples within them: sampled, not proven.",
            text);
    }
}
