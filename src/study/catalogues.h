/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_CATALOGUES_H
#define STUDY_CATALOGUES_H

#include "study/variables.h"

/*
 * Catalogues of parts: a table whose rows are the parts that can be had, such as tubes by their
 * diameter, wall and price. A variable takes one row, which sets several parameters at once:
 * columns are mapped to parameters, each to one or more, or not at all. A variable of n
 * parameters is read as n variables that share `rows` (variables.h).
 */
typedef struct mt_catalogue {
    mt_name name;
    mt_name file; /* s NULL: rows are in the study */
    mt_name_list columns;
    mt_name_list units;        /* by column, "": the parameter's; count 0: none is given */
    mt_name_list names;        /* of rows; count 0: none are given */
    double *tolerance_percent; /* [columns.count] NaN: none; NULL: none is given */
    int n_rows;
    /* [n_rows x columns.count] as written; NaN: wrong, which is noted, or a column of texts */
    double *number;
    bool *text;   /* [columns.count] of a table; NULL: all have numbers */
    mt_addr *row; /* [n_rows] addresses */
    bool wrong;   /* what is wrong has been noted */
    mt_addr addr;
} mt_catalogue;

extern const mt_key_table mt_study_parts_keys;

struct mt_study_reader;
/* Read "catalogues": the list of them in the study's memory, *n their number. */
mt_catalogue *mt_read_study_catalogues(struct mt_study_reader *s, mt_addr value, int *n);

struct mt_study_check;
/* Replace each variable that takes rows by one for each of its parameters. */
void mt_study_check_rows(struct mt_study_check *c);

#endif
