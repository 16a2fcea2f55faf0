/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_RESOLVE_PRIV_H
#define MODEL_RESOLVE_PRIV_H

#include "model/names.h"

/* What the files finish_*.c share while a model is resolved and checked. Problems go to diags,
 * and the model's arena remembers a shortage; a function returns nothing. */
typedef struct mt_resolve {
    mt_model *m;
    mt_diags *d;
    int *order; /* [n_configurations] those that others are like first */
} mt_resolve;

/* The index of a name, which is looked up in a table; MT_ABSENT where it is not there (noted:
 * unknown `what` "x"; did you mean "y"?). A name that is absent itself gives MT_ABSENT without
 * a message. */
int mt_resolve_find(mt_resolve *f, mt_name name, const mt_names *table, const char *what);
/* Note: unknown `what` "x", with the nearest of the names in the table, or of `more` names
 * besides. */
void mt_resolve_unknown(mt_resolve *f, mt_name name, const mt_names *table, const char *what,
                        const char *const *more, int n_more);
void mt_resolve_position(mt_resolve *f, mt_position *p);
/* What stands where a body may. */
void mt_resolve_attach(mt_resolve *f, mt_attach *a);
/* True where both hold on to the same. */
bool mt_resolve_same_attach(const mt_attach *a, const mt_attach *b);
/* Whether the body is a point mass. */
bool mt_resolve_is_point_mass(const mt_resolve *f, const mt_attach *a);
/* Two positions that are the same by the way they are written, whatever the parameters are. */
bool mt_resolve_same_position(const mt_model *m, const mt_position *a, const mt_position *b);
/* The presence of an item's parts in every configuration that holds the item; `what`
 * "joint". */
void mt_resolve_needs(mt_resolve *f, mt_name item, const char *what, const mt_presence *in,
                      const mt_presence *part, const char *part_what, const char *part_name);
void mt_resolve_needs_attach(mt_resolve *f, mt_name item, const char *what,
                             const mt_presence *in, const mt_attach *part);
/* "beam.h3": hinge 3 of link "beam", *link and its 0-based *hinge; a hinge that the link has
 * not is noted and leaves them MT_ABSENT. False where the name has no such form. */
bool mt_resolve_hinge(mt_resolve *f, mt_name name, int *link, int *hinge);
/* "a -> b -> c -> a" in words that a line can hold: of a long circle the first names and the
 * last. Begins with .first, and the others are added in order. */
enum { MT_RING_NAME = 48, MT_RING_FIRST = 8, MT_RING_LAST = 4, MT_RING_TEXT = 1024 };
typedef struct mt_resolve_ring {
    const char *first;
    int count;                        /* of those added */
    const char *start[MT_RING_FIRST]; /* the first of them */
    const char *last[MT_RING_LAST];   /* the last of them: number i at i % MT_RING_LAST */
    char text[MT_RING_TEXT];
} mt_resolve_ring;
void mt_resolve_ring_add(mt_resolve_ring *ring, const char *name);
/* Write ring->text. */
void mt_resolve_ring_end(mt_resolve_ring *ring);
/* The address of a number; MT_NO_ADDR where it is absent. */
mt_addr mt_resolve_addr(const mt_model *m, mt_num num);

/* The stages, in order. */
void mt_resolve_configurations(mt_resolve *f);
/* Of those: names in what is written of damping; before anything is inherited. */
void mt_resolve_damping(mt_resolve *f);
void mt_resolve_presence(mt_resolve *f);
void mt_resolve_links(mt_resolve *f);
void mt_resolve_joints(mt_resolve *f);
void mt_resolve_springs(mt_resolve *f);
void mt_resolve_loads(mt_resolve *f);
void mt_resolve_sensors(mt_resolve *f);
void mt_resolve_drives(mt_resolve *f);
void mt_resolve_cycles(mt_resolve *f);
/* Only where nothing is wrong so far. */
void mt_resolve_values(mt_resolve *f);

#endif
