/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DESCRIBE_DESCRIBE_REASONS_PRIV_H
#define DESCRIBE_DESCRIBE_REASONS_PRIV_H

#include "describe/describe.h"

/* The reasons of one recommendation while they are written. */
typedef struct mt_sentences {
    const mt_problem *p;
    const mt_design *design;
    mt_result *result;
    mt_recommendation *rec;
    int capacity;
    mt_reason of; /* kind of what is said from now on, and what it is about */
} mt_sentences;

/* From now on sentences are of this kind, about a parameter, a goal (its pointer) or NULL. */
void mt_sentence_of(mt_sentences *s, const char *kind, const char *about);
/* Add a sentence. */
void mt_add_sentence(mt_sentences *s, const char *fmt, ...) MT_PRINTF(2, 3);

/* A list of names with one more at its end, "a, b and c"; left: how many are to come behind it.
 * NULL, or what is there: out of memory. */
const char *mt_add_listed_sentences(mt_sentences *s, const char *list, const char *name,
                                    int left);

/* How the modes lie between the bands and which of them stand on an edge.
 * Nothing without bands. */
void mt_add_bands_sentences(mt_sentences *s);
/* How surely goals hold over the tolerances of the variables. Nothing
 * without these. */
void mt_add_worst_sentences(mt_sentences *s);
/* What the requirements, the edges of bands and the active bounds cost: their
 * multipliers in the objective's unit, or, where a frequency is missed, what more room at a
 * bound would do for it. */
void mt_add_prices_sentences(mt_sentences *s);

#endif
