/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CONVENTIONS_H
#define CLI_CONVENTIONS_H

#include "base/text.h"
#include "io/write_json.h"
#include "model/model.h"

/* What a sign, an axis or an order of bodies was understood to mean. */
typedef struct mt_convention {
    const char *pointer; /* of the member in the model's file */
    double value;        /* of it; NaN: it is no number */
    /* of joints, springs, dampers and loads: the body (of a gear the joint) against which the
     * other one moves; NULL: neither */
    const char *first;
    const char *second;
    const char *text; /* a sentence without a full stop */
} mt_convention;

typedef struct mt_convention_list {
    mt_arena *mem; /* not owned; has the texts, and remembers where there is no memory */
    mt_convention *items;
    int n;
    int capacity;
} mt_convention_list;

/* Those of a configuration, one for each number that has one, appended to a list (out->mem set,
 * else zeroed). value [n_nums] as mt_model_numbers gives them. */
void mt_cli_find_conventions(const mt_model *model, int configuration, const double *value,
                             mt_convention_list *out);
/* As lines for people, of which there are not too many; nothing where the list is empty. */
void mt_cli_print_conventions(const mt_convention_list *list, mt_text *out);
/* All of them, as the member "conventions" of the object that is open. */
void mt_cli_json_conventions(mt_json_writer *w, const mt_convention_list *list);

#endif
