/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_COPY_H
#define MODEL_COPY_H

#include "io/reader.h"
#include "io/write_json.h"
#include "model/expand.h"
#include "model/item.h"

/*
 * What repeats and includes have in common: a document is written anew, with what it had and
 * copies of items, each at a place of its own.
 */
/* Lists that items are copied of: an object of points, then lists of objects. */
enum { MT_COPIED_LISTS = 8 };
extern const char *const mt_copied_lists[MT_COPIED_LISTS];

/* Names of one space exclude each other. */
typedef enum mt_space {
    MT_OF_POINTS,
    MT_OF_PARTS,
    MT_OF_JOINTS,
    MT_OF_SPRINGS,
    MT_OF_LOADS,
    MT_OF_SENSORS,
    MT_SPACES
} mt_space;
extern const mt_space mt_space_of[MT_COPIED_LISTS];

/* JSON Schema of a direction of plain numbers */
#define MT_DIRECTION \
    "\"type\": \"array\", \"minItems\": 3, \"maxItems\": 3, \"items\": {\"type\": \"number\"}"

/* Of all files of a model together. */
typedef struct mt_expansion {
    const mt_io_options *opt;
    mt_included_list *files;
    int n_files;
    int depth;
    int dimension; /* of the present document */
    long values;
    const char *paths[MT_EXPAND_DEPTH + 1]; /* of the files that are being read */
    const char *names[MT_EXPAND_DEPTH + 1]; /* as seen from the model */
} mt_expansion;

/* One pass over one document. docs[0] is that document. */
typedef struct mt_maker {
    mt_reader r;
    mt_expansion *all;
    const char *path;
    mt_arena mem;
    mt_text text;
    mt_json_writer w;
    mt_json_origin *origins;
    int n_origins;
    int cap_origins;
    const char **notes;
    int n_notes;
    int cap_notes;
    mt_json **docs;
    const char **files;
    int *by;
    int n_docs;
    int errors; /* noted before */
    int dimension;
    const mt_unit *length; /* the file's unit; NULL: SI */
} mt_maker;

/* A number, or an expression in SI. */
typedef struct num {
    const char *s; /* NULL: v */
    double v;
} mt_term;

/* How a copy is made from what it copies. */
typedef struct copy {
    mt_maker *m;
    const mt_json *doc;
    int doc_index;
    int note;
    mt_addr item; /* the object that is being copied */
    /* names: of a repeat those of `own` get the suffix, of an include all get the prefix */
    const char *suffix;
    const mt_names *own; /* [MT_SPACES]; NULL: of an include */
    const char *prefix;
    const mt_names *symbols; /* parameters and curves that get the prefix */
    const char *ground;      /* NULL: the ground */
    mt_addr ground_addr;     /* in docs[0] */
    const mt_unit *length;   /* of the document; NULL: SI */
    bool still;              /* R is 1 and t is 0 */
    bool parallel;           /* R is 1 */
    bool mirrored;
    mt_addr bound; /* in docs[0]: an object of values of parameters; MT_NO_ADDR */
    mt_term R[9];  /* by rows */
    mt_term t[3];  /* in the unit of the new document */
} mt_copy;

/* What is added to a document: to which of its members, and how. */
typedef struct addition {
    void *context;
    bool (*any)(const void *context, const char *list);
    void (*put)(mt_maker *m, void *context, const char *list);
    mt_addr from;     /* where lists that are new come from */
    const char *drop; /* a member that is left out; NULL: none */
} mt_addition;

/* How copies stand to what they copy: turned about an axis through a position, or mirrored in
 * the plane through it, then moved. */
typedef struct mt_motion {
    bool turns;
    bool mirrors;
    double axis[3]; /* a unit vector; of a mirror across the plane */
    mt_term angle;
    mt_term about[3];
    mt_term step[3];
} mt_motion;

/* Begin to write a document anew. room: number of documents besides the first; names: empty,
 * for its parameters, as long as m. To be ended by mt_maker_finish, also on failure. */
mt_status mt_maker_begin(mt_maker *m, mt_json *doc, const char *path, mt_expansion *all,
                         int room, mt_names *names, mt_err *err);
/* Write it with what is added and turn the old document into it. The other documents become
 * its own. Fails: MT_E_INPUT where anything has been noted as wrong since the beginning. */
mt_status mt_maker_end(mt_maker *m, const mt_addition *what, mt_err *err);
void mt_maker_finish(mt_maker *m);
/* True where nothing more is written: too much, or out of memory. */
bool mt_maker_is_full(const mt_maker *m);
/* Index of what messages add about copies; -1 out of memory. */
int mt_maker_note(mt_maker *m, const char *text);
int mt_maker_line(const mt_json *doc, mt_addr addr);

/* A copy of what document `doc_index` has, in its place. With a prefix: of an include. */
mt_copy mt_copy_begin(mt_maker *m, int doc_index, const char *prefix);
/* Move it `times` times. */
void mt_copy_move(mt_copy *c, const mt_motion *motion, int times);
/* Write the copy of an item of this list of the document. */
void mt_copy_item(mt_copy *c, const char *list, mt_addr item);

/* The unit vector of a member of plain numbers of a matched object: an axis, in two dimensions
 * that of the plane and not to be given, or another direction. False (noted) where wrong. */
bool mt_read_axis(mt_maker *m, const mt_object *o, const char *member, double *u);
/* A number or an expression of the document itself, in this unit; false (noted) where wrong. */
bool mt_read_own(mt_maker *m, mt_addr value, const mt_unit *unit, mt_term *out);
/* Coordinates or the name of a point; an absent one is the origin. */
bool mt_read_place(mt_maker *m, mt_addr value, mt_term *out);

#endif
