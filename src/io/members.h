/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_MEMBERS_H
#define IO_MEMBERS_H

#include <stddef.h>

#include "io/reader.h"

/*
 * Objects read by their tables. A row says everything about a member: its name, what it may
 * hold, where its value goes, and the sentence of the JSON Schema. mt_members_read reads all
 * rows that have a function to read with, in the order of the table; the others are read by the
 * object's own reader (mt_object_value). A document adds types of its own as functions
 * (mt_key_read). Absent members leave the struct as it is: it holds the defaults; or, where the
 * table says so, they are read as well, and each row knows what its absence means.
 *
 * The macros write rows, with THIS for the struct; the compiler checks the type of its member.
 * Behind the sentence more may be said: `.otherwise` (the default, as JSON), `.examples`,
 * `.pattern`.
 */
/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
#define MT_M_PLACE(of, m)        (offsetof(THIS, m) * _Generic(&((THIS *)NULL)->m, of * : 1U))
#define MT_M_ROW(row)            .possible = MT_POSSIBLE_##row
#define MT_M_TO(function, of, m) .read = (function), .at = MT_M_PLACE(of, m)

/* const char *; mt_name; a string that nobody reads */
#define MT_M_TEXT(label, m, ...)                                                      \
    {                                                                                 \
        .name = (label), .type = MT_KEY_TEXT, MT_M_TO(mt_read_text, const char *, m), \
        .says = __VA_ARGS__                                                           \
    }
#define MT_M_REF(label, must, m, ...)                             \
    {                                                             \
        .name = (label), .type = MT_KEY_TEXT, .required = (must), \
        MT_M_TO(mt_read_ref, mt_name, m), .says = __VA_ARGS__     \
    }
#define MT_M_FREE(label, ...)                                     \
    {                                                             \
        .name = (label), .type = MT_KEY_TEXT, .says = __VA_ARGS__ \
    }
/* "format", of a document: the list of its only name */
#define MT_M_FORMAT(list)                                                           \
    {                                                                               \
        .name = "format", .type = MT_KEY_TEXT, .required = true, .choices = (list), \
        .n_choices = MT_COUNT(list), .says = "Kind and version of this file."       \
    }
/* Names of warnings that the document accepts where warnings are given at once: they go to its
 * reader */
#define MT_M_ACCEPTED(...)                                                                   \
    {                                                                                        \
        .name = "accepted", .type = MT_KEY_LIST, .read = mt_read_accepted,                   \
        .choices = mt_warning_names, .n_choices = MT_WARNING_NAME_COUNT, .says = __VA_ARGS__ \
    }
/* bool */
#define MT_M_FLAG(label, must, m, ...)                            \
    {                                                             \
        .name = (label), .type = MT_KEY_BOOL, .required = (must), \
        MT_M_TO(mt_read_flag, bool, m), .says = __VA_ARGS__       \
    }
/* double, a number without parameters */
#define MT_M_VALUE(label, must, m, row, ...)                                      \
    {                                                                             \
        .name = (label), .type = MT_KEY_VALUE, .required = (must), MT_M_ROW(row), \
        MT_M_TO(mt_read_value, double, m), .says = __VA_ARGS__                    \
    }
/* A member that its object's reader reads */
#define MT_M_JUST(label, kind, must, row, ...)                                     \
    {                                                                              \
        .name = (label), .type = MT_KEY_##kind, .required = (must), MT_M_ROW(row), \
        .says = __VA_ARGS__                                                        \
    }
/* An object, and a list of objects, that their object's reader reads */
#define MT_M_OBJECT(label, table)                              \
    {                                                          \
        .name = (label), .type = MT_KEY_OBJECT, .of = &(table) \
    }
#define MT_M_LIST_OF(label, table, ...)                                           \
    {                                                                             \
        .name = (label), .type = MT_KEY_LIST, .of = &(table), .says = __VA_ARGS__ \
    }
/* "description" and "source", which every object may have */
#define MT_M_DESCRIPTION MT_M_FREE("description", "Free text for people.")
#define MT_M_ORIGIN      "Where it comes from: a table, a page, a test report."
#define MT_M_SOURCE      MT_M_FREE("source", MT_M_ORIGIN)
/* mt_name_list */
#define MT_M_REFS(label, m, ...)                                                      \
    {                                                                                 \
        .name = (label), .type = MT_KEY_LIST, MT_M_TO(mt_read_refs, mt_name_list, m), \
        .says = __VA_ARGS__                                                           \
    }
/* int, a whole number from `from` to `to` */
#define MT_M_COUNT(label, must, m, from, to, ...)                                          \
    {                                                                                      \
        .name = (label), .type = MT_KEY_COUNT, .required = (must), MT_M_ROW(WHOLE),        \
        MT_M_TO(mt_read_count, int, m), .least = (from), .most = (to), .says = __VA_ARGS__ \
    }
/* long and unsigned long, the same */
#define MT_M_LONG(label, must, m, from, to, ...)                                           \
    {                                                                                      \
        .name = (label), .type = MT_KEY_COUNT, .required = (must), MT_M_ROW(WHOLE),        \
        MT_M_TO(mt_read_long, long, m), .least = (from), .most = (to), .says = __VA_ARGS__ \
    }
#define MT_M_ULONG(label, m, from, to, ...)                                      \
    {                                                                            \
        .name = (label), .type = MT_KEY_COUNT, MT_M_ROW(WHOLE),                  \
        MT_M_TO(mt_read_ulong, unsigned long, m), .least = (from), .most = (to), \
        .says = __VA_ARGS__                                                      \
    }
/* An enum, the index of one of a list of names (`.least`: what the first one is, where that is
 * not 0); `kind` in messages: "role" */
#define MT_M_CHOICE(label, must, m, of, kind, list, ...)                   \
    {                                                                      \
        .name = (label), .type = MT_KEY_TEXT, .required = (must),          \
        MT_M_TO(mt_read_choice, of, m), .what = (kind), .choices = (list), \
        .n_choices = MT_COUNT(list), .says = __VA_ARGS__                   \
    }
/* An object whose members go into the struct itself */
#define MT_M_INNER(label, table)                                                      \
    {                                                                                 \
        .name = (label), .type = MT_KEY_OBJECT, .read = mt_read_inner, .of = &(table) \
    }
/* An object whose members go into a struct of its own, a member of the struct */
#define MT_M_PART(label, must, m, part, table, ...)                          \
    {                                                                        \
        .name = (label), .type = MT_KEY_OBJECT, .required = (must),          \
        MT_M_TO(mt_read_inner, part, m), .of = &(table), .says = __VA_ARGS__ \
    }
/* Structs and their number (int); a list that must not be empty is called `kind` in messages,
 * else NULL. An item that is no such object is left out. */
#define MT_M_ITEMS(label, must, m, n, item, kind, table, ...)                           \
    {                                                                                   \
        .name = (label), .type = MT_KEY_LIST, .required = (must),                       \
        MT_M_TO(mt_read_items, item *, m), .other = MT_M_PLACE(int, n), .what = (kind), \
        .of = &(table), .says = __VA_ARGS__                                             \
    }
/* NOLINTEND(bugprone-macro-parentheses) */

struct mt_object {
    mt_addr addr;
    const mt_key_table *table;
    int errors; /* noted before it was matched */
    mt_addr found[MT_MAX_KEYS];
    bool read[MT_MAX_KEYS]; /* already */
};

/* As mt_reader_object. */
bool mt_object_match(mt_reader *r, mt_addr value, const mt_key_table *table, mt_object *out);
/* The value of a member; MT_NO_ADDR where it is absent or of a wrong type. */
mt_addr mt_object_value(const mt_object *o, const char *member);
/* True where the member is present, also of a wrong type. */
bool mt_object_has(const mt_reader *r, const mt_object *o, const char *member);
/* True where anything of the object has been noted as wrong since it was matched. */
bool mt_object_wrong(const mt_reader *r, const mt_object *o);
/* The address of a member, also of a wrong type; the object's own where it is absent. */
mt_addr mt_object_place(const mt_reader *r, const mt_object *o, const char *member);
/* The one of n members (neighbours in the table, from `first` on) that is there, as an index
 * from 0; MT_ABSENT where none or several are (noted). */
int mt_object_one_of(mt_reader *r, const mt_object *o, const char *first, int n);

/* Read the row of a member before the others, which mt_object_read then leaves out. */
void mt_object_read_first(mt_reader *r, mt_object *o, const char *member, void *item);
/* Read the rows of a matched object into the struct, in the table's order. */
void mt_object_read(mt_reader *r, const mt_object *o, void *item);
/* Leave out n members (neighbours in the table, from `first` on), as if of a wrong type. */
void mt_object_leave_out(mt_object *o, const char *first, int n);
/* Match an object with its table and read it: the table's defaults, `check`, rows, `finish`.
 * Returns false (noted) where the value is no such object (of a table that reads absent members
 * true: all of them are absent), or where it is not known which of the members that exclude
 * each other is meant. */
bool mt_members_read(mt_reader *r, mt_addr value, const mt_key_table *table, void *item);

/* The items of a list, or the single one that is written without it, read by their table; *n:
 * how many are kept. what: as of mt_reader_some_items; NULL: the list may be empty. */
void *mt_members_list(mt_reader *r, mt_addr list, const char *what, const mt_key_table *of,
                      int *n);

/* mt_key_read of the types that every document has. */
void mt_read_text(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_ref(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_refs(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_flag(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_value(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_accepted(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_count(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_long(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_ulong(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_choice(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_inner(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_items(mt_reader *r, const mt_key *key, mt_addr value, void *item);

#endif
