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
void mt_say_of(mt_sentences *s, const char *kind, const char *about);
/* Add a sentence. */
void mt_say(mt_sentences *s, const char *fmt, ...) MT_PRINTF(2, 3);

/* A list of names with one more at its end, "a, b and c"; left: how many are to come behind it.
 * NULL, or what is there: out of memory. */
const char *mt_say_listed(mt_sentences *s, const char *list, const char *name, int left);

/* How the modes lie between the bands and which of them stand on an edge.
 * Nothing without bands. */
void mt_say_bands(mt_sentences *s);
/* How surely goals hold over the tolerances of the variables. Nothing
 * without these. */
void mt_say_worst(mt_sentences *s);
/* What the demands, the edges of bands and the active bounds cost: their
 * multipliers in the objective's unit, or, where a frequency is missed, what more room at a
 * bound would do for it. */
void mt_say_prices(mt_sentences *s);

#endif
