/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READER_H
#define IO_READER_H

#include <stddef.h>

#include "base/diagnostics.h"
#include "base/document.h"
#include "base/possible.h"
#include "expr/expr.h"
#include "expr/kind.h"
#include "io/json.h"

/*
 * Shared by the readers of models and studies. Objects are checked against key tables, values
 * against types; every problem is noted (mt_json_diags) and reading goes on. A problem that a
 * JSON Schema can see as well (unknown or missing member, wrong type, wrong choice, bad form of
 * a name, wrong count where it is fixed) is noted by mt_diag_structure, others by
 * mt_diag_error: schema and reader agree on the former. The address MT_NO_ADDR means "not
 * given" and is accepted everywhere: the result is then the default that each function names,
 * without a message.
 */
/* The members matched last, with their rows. Objects are nested, and each reads its numbers
 * soon after it was matched. */
enum { MT_MATCHED = 256 };
struct mt_key;
typedef struct mt_matched {
    mt_addr addr;
    const struct mt_key *key;
} mt_matched;

typedef struct mt_reader {
    mt_json *doc;
    mt_diags *diags;       /* of doc */
    mt_arena *mem;         /* owns copies of what is read */
    mt_expr_lookup lookup; /* parameters of expressions; NULL: none */
    const void *context;
    const char *const *names; /* candidates for "did you mean" in expressions */
    int n_names;
    const mt_interpolant *curves; /* of expressions */
    int n_curves;
    mt_kind_lookup kinds; /* kinds of the parameters, with the context of lookup */
    mt_matched matched[MT_MATCHED];
    unsigned n_matched;            /* number matched so far; the last ones are kept */
    mt_warning_list *warning_list; /* of mt_reader_check_range; NULL: warn at once */
    mt_accepted accepted;          /* accepted warnings, where warnings are given at once */
} mt_reader;

/* id, JSON types, name in messages */
#define MT_KEY_TYPE_LIST(X)                                                                    \
    X(MT_KEY_ANY, 63, "any value")                                                             \
    X(MT_KEY_TEXT, MT_JSON_STRING, "a string")                                                 \
    X(MT_KEY_NUMBER, MT_JSON_NUMBER | MT_JSON_STRING, "a number or an expression")             \
    X(MT_KEY_COUNT, MT_JSON_NUMBER, "a whole number")                                          \
    X(MT_KEY_VALUE, MT_JSON_NUMBER, "a number")                                                \
    X(MT_KEY_BOOL, MT_JSON_BOOL, "true or false")                                              \
    X(MT_KEY_LIST, MT_JSON_ARRAY, "a list")                                                    \
    X(MT_KEY_NUMBERS, MT_JSON_ARRAY, "a list")                                                 \
    X(MT_KEY_OBJECT, MT_JSON_OBJECT, "an object")                                              \
    X(MT_KEY_LIST_OR_OBJECT, MT_JSON_ARRAY | MT_JSON_OBJECT, "a list or an object")            \
    X(MT_KEY_TEXT_LIST_OR_OBJECT, MT_JSON_STRING | MT_JSON_ARRAY | MT_JSON_OBJECT,             \
      "a name, a list or an object")                                                           \
    X(MT_KEY_TEXT_OR_LIST, MT_JSON_STRING | MT_JSON_ARRAY, "a string or a list")               \
    X(MT_KEY_TEXT_OR_OBJECT, MT_JSON_STRING | MT_JSON_OBJECT, "a string or an object")         \
    X(MT_KEY_TEXT_OR_COUNT, MT_JSON_NUMBER | MT_JSON_STRING, "a name or a whole number")       \
    X(MT_KEY_OBJECT_OR_LIST, MT_JSON_OBJECT | MT_JSON_ARRAY, "an object or a list of objects") \
    X(MT_KEY_NUMBER_OR_LIST, MT_JSON_NUMBER | MT_JSON_STRING | MT_JSON_ARRAY,                  \
      "a number, an expression or a list of them")                                             \
    X(MT_KEY_NUMBER_OR_OBJECT, MT_JSON_NUMBER | MT_JSON_STRING | MT_JSON_OBJECT,               \
      "a number, an expression or an object")
#define MT_KEY_TYPE_ENUM(id, types, text) id,
typedef enum mt_key_type { MT_KEY_TYPE_LIST(MT_KEY_TYPE_ENUM) MT_KEY_TYPE_COUNT } mt_key_type;
#undef MT_KEY_TYPE_ENUM

typedef struct mt_key mt_key;
typedef struct mt_key_table mt_key_table;
/* Read a member's value into the struct, where its row says. */
typedef void (*mt_key_read)(mt_reader *r, const mt_key *key, mt_addr value, void *item);

/* A row of a table of members (io/members.h has the macros that write them). */
struct mt_key {
    const char *name;
    mt_key_read read; /* NULL: by the object's own reader, or by nobody */
    size_t at;        /* where its value goes in the struct */
    size_t other;     /* where what belongs to it is: the count of a list */
    const char *what; /* of a choice, or a list that must not be empty, in messages */
    const char *const *choices;
    const mt_key_table *of; /* of an object, or of the items of a list */
    /* for the JSON Schema: the sentence; default, examples and the type itself as JSON, where
     * the columns do not say it; the form of a string */
    const char *says;
    const char *otherwise;
    const char *examples;
    const char *schema;
    const char *pattern;
    mt_key_type type;
    mt_possible_id possible; /* row of its numbers; MT_POSSIBLE_NONE: no numbers */
    int least;               /* of a whole number; of the items of a list; of an enum */
    int most;
    int n_choices;
    bool required;
};

/* An object matched with its table: the address of every member (MT_NO_ADDR: absent or of a
 * wrong type). */
typedef struct mt_object mt_object;

/* The members of one kind of object. `what` names its definition in the JSON Schema; "" for the
 * root. Messages use the JSON pointer instead. */
struct mt_key_table {
    const char *what;
    const mt_key *keys;
    int n;
    int one_of;  /* the first so many members exclude each other, and one is there; 0: none */
    size_t size; /* of the struct */
    /* Rows are read where their members are absent, too (MT_NO_ADDR); a struct begins as 0 */
    bool absent;
    /* Fill a new struct; which: of the members that exclude each other, MT_ABSENT: none */
    void (*defaults)(void *item, mt_addr addr, int which);
    /* Note what is wrong with members together, before rows are read; what cannot be read
     * then is left out (mt_object_leave_out) */
    void (*check)(mt_reader *r, mt_object *o);
    /* Read what rows cannot say, after them */
    void (*finish)(mt_reader *r, const mt_object *o, int which, void *item);
    /* for the JSON Schema: the sentence, examples, and what holds of members together, as
     * JSON */
    const char *says;
    const char *examples;
    const char *rules;
};

/* A type that members of a document share, in its JSON Schema: the sentence, and the rest as
 * JSON. */
typedef struct mt_schema_type {
    const char *name;
    const char *says;
    const char *schema;
} mt_schema_type;

enum { MT_MAX_KEYS = 40 }; /* a table has at most as many */

/**
 * Match an object with a table; unknown and missing members and those of a wrong type are
 * noted.
 * @param[out] found [table->n] address of each member, in the table's order; MT_NO_ADDR where
 *   absent or of a wrong type
 * Returns false (all of found MT_NO_ADDR) where value is MT_NO_ADDR or not an object; the
 * latter is noted.
 */
bool mt_reader_object(mt_reader *r, mt_addr value, const mt_key_table *table, mt_addr *found);
/* Check a number (NaN: not known), the value of a recently matched member or an item of it,
 * against the member's row: an impossible value is noted ("weight (0) must be above 0"), an
 * implausible one becomes a warning. */
void mt_reader_check_range(mt_reader *r, mt_addr member, mt_addr value, double number);
/* The same check by this row for a number named `name`: for numbers of different kinds in one
 * member. */
void mt_reader_check_range_of(mt_reader *r, const char *name, mt_addr value, double number,
                              mt_possible_id row);
/* Give a warning of this name: kept for the file's list, or reported at once unless the file
 * accepts it. */
void mt_reader_warning(mt_reader *r, mt_addr value, const char *name, const char *fmt, ...)
    MT_PRINTF(4, 5);
/* False, and noted with the consequence ("this is not a study"), where the document's "format"
 * is another text: its members would be matched with the wrong table. True also where it is
 * missing or not a text, which the key table notes. */
bool mt_reader_format(mt_reader *r, const char *format, const char *not_this);
/* True where the value is of this type; noted where not ("must be a number or an expression,
 * not a list"). */
bool mt_reader_type(mt_reader *r, mt_addr value, mt_key_type type);

/* The items of a list or the members of an object (io/json.h); none where value is MT_NO_ADDR,
 * or neither list nor object. */
mt_items mt_reader_items(const mt_reader *r, mt_addr value);
/* The items where a single item may be written without the list: any value but a list is its
 * own only item. */
mt_items mt_reader_one_or_items(const mt_reader *r, mt_addr value);
/* The items of a list that must not be empty; noted ("the list of bands is empty") where given
 * and empty. what: "the list of bands". */
mt_items mt_reader_some_items(mt_reader *r, mt_addr value, const char *what);
/* The first two items, MT_NO_ADDR where missing; returns the number of items. */
int mt_reader_pair(const mt_reader *r, mt_addr value, mt_addr *first, mt_addr *second);
/* Zeroed memory in r->mem for all items of a walk; out of memory (noted) gives NULL and ends
 * the walk. */
void *mt_reader_room(mt_reader *r, mt_items *items, size_t size);

/* Copy of a string into r->mem; NULL where absent or not a string (noted). */
const char *mt_reader_text(mt_reader *r, mt_addr value);
/* A string that refers to something, unchecked; s == NULL where absent or wrong. */
mt_name mt_reader_ref(mt_reader *r, mt_addr value);
/* A string that names a new item: form [A-Za-z_][A-Za-z0-9_+-]*, noted where not. */
mt_name mt_reader_name(mt_reader *r, mt_addr value);
/* The forms of names of items: item (as mt_reader_name), parameter (without + and -), title
 * (any text, not empty). */
typedef enum mt_name_form { MT_NAME_ITEM, MT_NAME_PARAMETER, MT_NAME_TITLE } mt_name_form;
/* The name of a member of a free object (parameters, points, modes, ...) as the name of a new
 * item; its addr is the name's. */
mt_name mt_reader_member_name(mt_reader *r, mt_addr value, mt_name_form form);
/* A list of strings that refer to something; an absent one gives count 0. */
mt_name_list mt_reader_refs(mt_reader *r, mt_addr value);
/* The same of a member that by its key is one string, or a list that is not empty. */
mt_name_list mt_reader_one_or_refs(mt_reader *r, const mt_key *key, mt_addr value);
/* The index of the string among n names; MT_ABSENT where absent or none (noted, with "did you
 * mean" and the known ones). what: "type". */
int mt_reader_choice(mt_reader *r, mt_addr value, const char *what, const char *const *names,
                     int n);
/* The names of warnings in a list; unknown ones are noted. */
mt_accepted mt_reader_accepted(mt_reader *r, mt_addr value);
/* A whole number within least..most; fallback where absent or wrong (noted). 9, 9.0 and 9e0 are
 * whole. */
int mt_reader_count(mt_reader *r, mt_addr value, int least, int most, int fallback);
bool mt_reader_flag(mt_reader *r, mt_addr value, bool fallback);
/* A number or an expression; false (out is zeroed) where absent, wrong (noted), or out of
 * memory. */
bool mt_reader_expr(mt_reader *r, mt_addr value, mt_expr *out);
/* As mt_reader_expr, for a text that is not a value of its own. */
bool mt_reader_expr_text(mt_reader *r, mt_addr addr, const char *text, mt_expr *out);

/* MT_E_MEMORY, or mt_json_status of the document. */
mt_status mt_reader_status(const mt_reader *r, const char *file, mt_err *err);

/*
 * Numbers in units other than SI. A bare number (of JSON) is in the unit that applies at its
 * place; an expression (a string) is in SI, so an expression there that looks like a bare
 * number, or has one among its terms, is refused with the correct form.
 */
/* The units that "units" of a model or a study may name. */
enum { MT_LENGTH_NAMES = 5, MT_ANGLE_NAMES = 2, MT_SPEED_NAMES = 2 };
extern const char *const mt_length_names[MT_LENGTH_NAMES];
extern const char *const mt_angle_names[MT_ANGLE_NAMES];
extern const char *const mt_speed_names[MT_SPEED_NAMES];
/* Read "units" of a model or a study by its table, in the order of mt_dimension: the unit of
 * each dimension, NULL where none is given. */
void mt_read_units(mt_reader *r, mt_addr value, const mt_key_table *table,
                   const mt_unit *units[MT_DIMENSION_COUNT]);
/* As mt_reader_expr, with a bare number in this unit (NULL: SI). */
bool mt_reader_expr_in(mt_reader *r, mt_addr value, const mt_unit *unit, mt_expr *out);
/* Compare the dimension of an expression, given as text at the value, with that of this unit,
 * which applies to bare numbers there; a mismatch is noted. No check where the unit is NULL or
 * SI, or for bare numbers. */
void mt_reader_check_kind(mt_reader *r, mt_addr value, const mt_expr *e, const mt_unit *unit);

#endif
