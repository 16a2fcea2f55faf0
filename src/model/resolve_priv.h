/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_RESOLVE_PRIV_H
#define MODEL_RESOLVE_PRIV_H

#include "model/names.h"

/* Shared by the files resolve_*.c while a model is resolved and checked. Problems go to diags,
 * and a shortage of memory to the model's arena; the functions return no status. */
typedef struct mt_resolve {
    mt_model *m;
    mt_diags *d;
    int *order; /* [n_configurations], each after the one that it is like */
} mt_resolve;

/* Index of a name in a table; MT_ABSENT where it is unknown, with the error: unknown `what`
 * "x"; did you mean "y"? An absent name gives MT_ABSENT without an error. */
int mt_resolve_find(mt_resolve *f, mt_name name, const mt_names *table, const char *what);
/* Error: unknown `what` "x", with the nearest name of the table or of `more`. */
void mt_resolve_unknown(mt_resolve *f, mt_name name, const mt_names *table, const char *what,
                        const char *const *more, int n_more);
void mt_resolve_position(mt_resolve *f, mt_position *p);
/* Resolve an attachment. */
void mt_resolve_attach(mt_resolve *f, mt_attach *a);
/* True where both attach to the same part. */
bool mt_resolve_same_attach(const mt_attach *a, const mt_attach *b);
/* True where the body is a point mass. */
bool mt_resolve_is_point_mass(const mt_resolve *f, const mt_attach *a);
/* True where two positions are written the same way and so are equal for all parameters. */
bool mt_resolve_same_position(const mt_model *m, const mt_position *a, const mt_position *b);
/* Check that a part of an item is present in every configuration of the item; `what`
 * "joint". */
void mt_resolve_needs(mt_resolve *f, mt_name item, const char *what, const mt_presence *in,
                      const mt_presence *part, const char *part_what, const char *part_name);
void mt_resolve_needs_attach(mt_resolve *f, mt_name item, const char *what,
                             const mt_presence *in, const mt_attach *part);
/* "beam.h3": hinge 3 of link "beam", *link and its 0-based *hinge; an unknown hinge is an error
 * and leaves both MT_ABSENT. False where the name does not have this form. */
bool mt_resolve_hinge(mt_resolve *f, mt_name name, int *link, int *hinge);
/* Text "a -> b -> c -> a" of a cycle, of limited length: a long cycle is cut to its first and
 * last names. Initialise .first, then add the other names in order. */
enum { MT_RING_NAME = 48, MT_RING_FIRST = 8, MT_RING_LAST = 4, MT_RING_TEXT = 1024 };
typedef struct mt_resolve_ring {
    const char *first;
    int count;                        /* names added */
    const char *start[MT_RING_FIRST]; /* the first names added */
    const char *last[MT_RING_LAST];   /* the last names added: number i at i % MT_RING_LAST */
    char text[MT_RING_TEXT];
} mt_resolve_ring;
void mt_resolve_ring_add(mt_resolve_ring *ring, const char *name);
/* Write ring->text. */
void mt_resolve_ring_end(mt_resolve_ring *ring);
/* The address of a number; MT_NO_ADDR where it is absent. */
mt_addr mt_resolve_addr(const mt_model *m, mt_num num);

/* The stages, in order. */
void mt_resolve_configurations(mt_resolve *f);
/* Part of it: names in damping, before anything is inherited. */
void mt_resolve_damping(mt_resolve *f);
void mt_resolve_presence(mt_resolve *f);
void mt_resolve_links(mt_resolve *f);
void mt_resolve_joints(mt_resolve *f);
void mt_resolve_springs(mt_resolve *f);
void mt_resolve_loads(mt_resolve *f);
void mt_resolve_sensors(mt_resolve *f);
void mt_resolve_drives(mt_resolve *f);
void mt_resolve_cycles(mt_resolve *f);
/* Only where there is no error so far. */
void mt_resolve_values(mt_resolve *f);

#endif
