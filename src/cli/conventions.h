/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_CONVENTIONS_H
#define CLI_CONVENTIONS_H

#include "base/text.h"
#include "io/write_json.h"
#include "model/model.h"

/* The interpretation of a sign, an axis or an order of bodies. */
typedef struct mt_convention {
    const char *pointer; /* pointer of the member in the model's file */
    double value;        /* value of the member; NaN: not a number */
    /* of joints, springs, dampers and loads: the body (of a gear the joint) relative to which
     * the second one moves; NULL: neither */
    const char *first;
    const char *second;
    const char *text; /* a sentence without a full stop */
} mt_convention;

typedef struct mt_convention_list {
    mt_arena *mem; /* not owned; holds the texts, and remembers a shortage */
    mt_convention *items;
    int n;
    int capacity;
} mt_convention_list;

/* Append the conventions of a configuration, one per number that has one, to a list (out->mem
 * set, else zeroed). value [n_nums] as of mt_model_numbers. */
void mt_cli_find_conventions(const mt_model *model, int configuration, const double *value,
                             mt_convention_list *out);
/* Print the conventions as a limited number of lines; nothing where the list is empty. */
void mt_cli_print_conventions(const mt_convention_list *list, mt_text *out);
/* Write all conventions as the member "conventions" of the open object. */
void mt_cli_json_conventions(mt_json_writer *w, const mt_convention_list *list);

#endif
