/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_REASONS_PRIV_H
#define DESCRIBE_DESCRIBE_REASONS_PRIV_H

#include "describe/describe.h"

/* The reasons of one recommendation, while they are written. */
typedef struct mt_sentences {
    const mt_problem *p;
    const mt_design *design;
    mt_result *result;
    mt_recommendation *rec;
    int capacity;
    mt_reason of; /* kind and subject of the next sentences */
} mt_sentences;

/* Set the kind and the subject of the next sentences: a parameter, a goal (its pointer) or
 * NULL. */
void mt_sentence_of(mt_sentences *s, const char *kind, const char *about);
/* Add a sentence. */
void mt_add_sentence(mt_sentences *s, const char *fmt, ...) MT_PRINTF(2, 3);

/* Append a name to a list, "a, b and c"; left: the number of names still to come. Returns NULL,
 * or the list so far, when out of memory. */
const char *mt_add_listed_sentences(mt_sentences *s, const char *list, const char *name,
                                    int left);

/* Add sentences about the positions of modes between the bands and about modes on an edge.
 * Nothing without bands. */
void mt_add_bands_sentences(mt_sentences *s);
/* Add sentences about the margins of goals over the tolerances of the variables. Nothing
 * without tolerances. */
void mt_add_worst_sentences(mt_sentences *s);
/* Add sentences about the gain from relaxing requirements, edges of bands and active bounds:
 * their multipliers in the objective's unit, or, where a frequency is missed, the effect of
 * moving a bound. */
void mt_add_prices_sentences(mt_sentences *s);

#endif
