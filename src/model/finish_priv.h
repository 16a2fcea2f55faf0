/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_FINISH_PRIV_H
#define MODEL_FINISH_PRIV_H

#include "model/names.h"

/* What the files finish_*.c share while a model is resolved and checked. Problems go to diags,
 * and the model's arena remembers a shortage; a function returns nothing. */
typedef struct mt_finish {
    mt_model *m;
    mt_diags *d;
    int *order; /* [n_configurations] those that others are like first */
} mt_finish;

/* The index of a name, which is looked up in a table; MT_ABSENT where it is not there (noted:
 * unknown `what` "x"; did you mean "y"?). A name that is absent itself gives MT_ABSENT without
 * a message. */
int mt_finish_find(mt_finish *f, mt_name name, const mt_names *table, const char *what);
/* Note: unknown `what` "x", with the nearest of the names in the table, or of `more` names
 * besides. */
void mt_finish_unknown(mt_finish *f, mt_name name, const mt_names *table, const char *what,
                       const char *const *more, int n_more);
void mt_finish_position(mt_finish *f, mt_position *p);
/* What stands where a body may. */
void mt_finish_attach(mt_finish *f, mt_attach *a);
/* True where both hold on to the same. */
bool mt_finish_same_attach(const mt_attach *a, const mt_attach *b);
/* Whether the body is a point mass. */
bool mt_finish_is_point_mass(const mt_finish *f, const mt_attach *a);
/* Two positions that are the same by the way they are written, whatever the parameters are. */
bool mt_finish_same_position(const mt_model *m, const mt_position *a, const mt_position *b);
/* The presence of an item's parts in every configuration that holds the item; `what`
 * "joint". */
void mt_finish_needs(mt_finish *f, mt_name item, const char *what, const mt_presence *in,
                     const mt_presence *part, const char *part_what, const char *part_name);
void mt_finish_needs_attach(mt_finish *f, mt_name item, const char *what, const mt_presence *in,
                            const mt_attach *part);
/* "beam.h3": hinge 3 of link "beam", *link and its 0-based *hinge; a hinge that the link has
 * not is noted and leaves them MT_ABSENT. False where the name has no such form. */
bool mt_finish_hinge(mt_finish *f, mt_name name, int *link, int *hinge);
/* "a -> b -> c -> a" in words that a line can hold: of a long circle the first names and the
 * last. Begins with .first, and the others are added in order. */
enum { MT_RING_NAME = 48, MT_RING_FIRST = 8, MT_RING_LAST = 4, MT_RING_TEXT = 1024 };
typedef struct mt_finish_ring {
    const char *first;
    int count;                        /* of those added */
    const char *start[MT_RING_FIRST]; /* the first of them */
    const char *last[MT_RING_LAST];   /* the last of them: number i at i % MT_RING_LAST */
    char text[MT_RING_TEXT];
} mt_finish_ring;
void mt_finish_ring_add(mt_finish_ring *ring, const char *name);
/* Write ring->text. */
void mt_finish_ring_end(mt_finish_ring *ring);
/* The address of a number; MT_NO_ADDR where it is absent. */
mt_addr mt_finish_addr(const mt_model *m, mt_num num);

/* The stages, in order. */
void mt_finish_configurations(mt_finish *f);
/* Of those: names in what is written of damping; before anything is inherited. */
void mt_finish_damping(mt_finish *f);
void mt_finish_presence(mt_finish *f);
void mt_finish_links(mt_finish *f);
void mt_finish_joints(mt_finish *f);
void mt_finish_springs(mt_finish *f);
void mt_finish_loads(mt_finish *f);
void mt_finish_sensors(mt_finish *f);
void mt_finish_drives(mt_finish *f);
void mt_finish_cycles(mt_finish *f);
/* Only where nothing is wrong so far. */
void mt_finish_values(mt_finish *f);

#endif
