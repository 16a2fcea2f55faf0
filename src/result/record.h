/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_RECORD_H
#define RESULT_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/arena.h"
#include "base/base.h"
#include "base/workers.h"
#include "io/reader.h"

/*
 * The members of a struct as a table. Writer, reader, copier and checks of results walk these
 * tables and depend on no struct, and the JSON Schema is written from them: every member that
 * has a name is written, and there are no others; required are those that files of this format
 * have always had. A record is plain: its texts and lists lie in an arena that the record does
 * not own.
 */
typedef enum mt_field_type {
    MT_FIELD_FORMAT, /* a constant text, of no struct: kind and version of the file */
    MT_FIELD_TEXT,   /* const char * */
    MT_FIELD_CHOICE, /* const char *, one of `choices` */
    MT_FIELD_ENUM,   /* an enum whose names are `choices` */
    MT_FIELD_NUMBER, /* double; null is NaN */
    MT_FIELD_VALUE,  /* double, or const char * (at `other`) where that is not NULL */
    MT_FIELD_COUNT,  /* int, `least` or more; null is what is less */
    MT_FIELD_LONG,   /* long, 0 or more; the same */
    MT_FIELD_FLAG,   /* bool */
    MT_FIELD_RECORD, /* a struct */
    MT_FIELD_OPTION, /* a pointer to a struct; null is NULL */
    /* a pointer to structs; of this and the next two, the int count is at `other` */
    MT_FIELD_LIST,
    MT_FIELD_TEXTS,   /* const char ** */
    MT_FIELD_NUMBERS, /* double *; in one line */
    /* double *, one for each variable of the study, or channel of a shape, by its name */
    MT_FIELD_BY_VARIABLE,
    MT_FIELD_TYPE_COUNT
} mt_field_type;

typedef struct mt_record mt_record;

typedef struct mt_field {
    const char *name; /* NULL: copied, but neither written nor read */
    size_t offset;
    size_t other; /* of a `later` text that is never NULL: the text that stands for it */
    const mt_record *record;
    const char *const *choices;
    mt_field_type type;
    int least;
    int n_choices;
    int digits;         /* of a list of numbers: significant digits written; 0: all */
    const char *format; /* of a format: the text */
    const char *says;   /* the sentence of the schema; NULL: that of the record */
    /* Keywords of the schema besides those of the type, which the reader does not check here;
     * of a list of numbers they are its items'. NULL: none */
    const char *rules;
    /* In one line: a record, each of a list of records, a list of texts. */
    bool flat;
    bool nullable;         /* of a list: NULL is null, else NULL is empty */
    bool numbers_nullable; /* of numbers by variable: single ones may be NaN */
    /* Files that older programs wrote may lack it. It is read as mt_record_clear leaves it; of
     * a LONG that is never null as less than `least`. Such a LONG is not written, nor is a text
     * or choice that is NULL and never null. */
    bool later;
    /* Of a text: older programs wrote it in place of the record that holds it, whose other
     * members are `later` all. */
    bool alone;
    /* Of what is written and never read (answers of commands). It is there only where the bool
     * at `when` is true; a value is a truth value where the bool at `truth` is true; numbers
     * stand as far apart as the int at `step` says. */
    bool optional;
    bool logical;
    bool strided;
    size_t when;
    size_t truth;
    size_t step;
} mt_field;

struct mt_record {
    size_t size; /* size of the struct */
    int n;
    const mt_field *fields; /* in the order in which they are written */
    const char *name; /* of its definition in the schema; NULL: it stands where it is used */
    const char *says; /* the sentence of the schema; NULL: its one member says it */
    bool bare;        /* written as the value of its one member: lists of lists */
};

/*
 * Macros that write the tables, with THIS for the struct. The compiler checks every member's
 * type: MT_F_MEMBER is the member's offset times 1 where its type is `of`, and does not compile
 * otherwise. The sentence comes last; behind it `.rules` may be given, or MT_F_WHEN.
 */
/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
#define MT_F_MEMBER(of, m) (offsetof(THIS, m) * _Generic(&((THIS *)NULL)->m, of * : 1U))
#define MT_F_FIELD(json, kind, or_null, of, m) \
    .name = (json), .type = (kind), .nullable = (or_null), .offset = MT_F_MEMBER(of, m)
#define MT_F_TRUTH(m)     .logical = true, .truth = MT_F_MEMBER(bool, m)
#define MT_F_ONE_OF(list) .choices = (list), .n_choices = MT_COUNT(list)
#define MT_F_EVERY(m)     .strided = true, .step = MT_F_MEMBER(int, m)
#define MT_F_WHEN(m)      .optional = true, .when = MT_F_MEMBER(bool, m)

#define MT_F_FORMAT(json, value, ...)                                                   \
    {                                                                                   \
        .name = (json), .type = MT_FIELD_FORMAT, .format = (value), .says = __VA_ARGS__ \
    }
#define MT_F_TEXT(json, m, ...)                                                      \
    {                                                                                \
        MT_F_FIELD(json, MT_FIELD_TEXT, false, const char *, m), .says = __VA_ARGS__ \
    }
#define MT_F_TEXT_OR_NULL(json, m, ...)                                             \
    {                                                                               \
        MT_F_FIELD(json, MT_FIELD_TEXT, true, const char *, m), .says = __VA_ARGS__ \
    }
#define MT_F_CHOICE(json, m, list, ...)                                               \
    {                                                                                 \
        MT_F_FIELD(json, MT_FIELD_CHOICE, false, const char *, m), MT_F_ONE_OF(list), \
            .says = __VA_ARGS__                                                       \
    }
#define MT_F_CHOICE_OR_NULL(json, m, list, ...)                                      \
    {                                                                                \
        MT_F_FIELD(json, MT_FIELD_CHOICE, true, const char *, m), MT_F_ONE_OF(list), \
            .says = __VA_ARGS__                                                      \
    }
#define MT_F_ENUM(json, m, of, list, ...)                                                     \
    {                                                                                         \
        MT_F_FIELD(json, MT_FIELD_ENUM, false, of, m), MT_F_ONE_OF(list), .says = __VA_ARGS__ \
    }
#define MT_F_NUMBER(json, m, ...)                                                \
    {                                                                            \
        MT_F_FIELD(json, MT_FIELD_NUMBER, false, double, m), .says = __VA_ARGS__ \
    }
#define MT_F_NUMBER_OR_NULL(json, m, ...)                                       \
    {                                                                           \
        MT_F_FIELD(json, MT_FIELD_NUMBER, true, double, m), .says = __VA_ARGS__ \
    }
#define MT_F_VALUE_OR_NULL(json, m, text, ...)                            \
    {                                                                     \
        MT_F_FIELD(json, MT_FIELD_VALUE, true, double, m),                \
            .other = MT_F_MEMBER(const char *, text), .says = __VA_ARGS__ \
    }
#define MT_F_COUNT(json, m, from, ...)                                                        \
    {                                                                                         \
        MT_F_FIELD(json, MT_FIELD_COUNT, false, int, m), .least = (from), .says = __VA_ARGS__ \
    }
#define MT_F_COUNT_OR_NULL(json, m, from, ...)                                               \
    {                                                                                        \
        MT_F_FIELD(json, MT_FIELD_COUNT, true, int, m), .least = (from), .says = __VA_ARGS__ \
    }
#define MT_F_LONG(json, m, ...)                                              \
    {                                                                        \
        MT_F_FIELD(json, MT_FIELD_LONG, false, long, m), .says = __VA_ARGS__ \
    }
#define MT_F_LONG_OR_NULL(json, m, from, ...)                                                \
    {                                                                                        \
        MT_F_FIELD(json, MT_FIELD_LONG, true, long, m), .least = (from), .says = __VA_ARGS__ \
    }
#define MT_F_FLAG(json, m, ...)                                              \
    {                                                                        \
        MT_F_FIELD(json, MT_FIELD_FLAG, false, bool, m), .says = __VA_ARGS__ \
    }
#define MT_F_RECORD(json, m, of, what, ...)                                  \
    {                                                                        \
        MT_F_FIELD(json, MT_FIELD_RECORD, false, of, m), .record = &(what),  \
                                                         .says = __VA_ARGS__ \
    }
#define MT_F_RECORD_FLAT(json, m, of, what, ...)                                          \
    {                                                                                     \
        MT_F_FIELD(json, MT_FIELD_RECORD, false, of, m), .record = &(what), .flat = true, \
                                                         .says = __VA_ARGS__              \
    }
#define MT_F_OPTION(json, m, of, what, ...)                                   \
    {                                                                         \
        MT_F_FIELD(json, MT_FIELD_OPTION, true, of *, m), .record = &(what),  \
                                                          .says = __VA_ARGS__ \
    }
#define MT_F_LIST(json, m, n, of, what, ...)                                     \
    {                                                                            \
        MT_F_FIELD(json, MT_FIELD_LIST, false, of *, m),                         \
            .other = MT_F_MEMBER(int, n), .record = &(what), .says = __VA_ARGS__ \
    }
#define MT_F_LIST_OR_NULL(json, m, n, of, what, ...)                                           \
    {                                                                                          \
        MT_F_FIELD(json, MT_FIELD_LIST, true, of *, m), .other = MT_F_MEMBER(int, n),          \
                                                        .record = &(what), .says = __VA_ARGS__ \
    }
#define MT_F_TEXTS(json, m, n, ...)                                \
    {                                                              \
        MT_F_FIELD(json, MT_FIELD_TEXTS, false, const char **, m), \
            .other = MT_F_MEMBER(int, n), .says = __VA_ARGS__      \
    }
#define MT_F_CHOICES(json, m, n, list, ...)                                      \
    {                                                                            \
        MT_F_FIELD(json, MT_FIELD_TEXTS, false, const char **, m),               \
            .other = MT_F_MEMBER(int, n), MT_F_ONE_OF(list), .says = __VA_ARGS__ \
    }
#define MT_F_NUMBERS(json, m, n, ...)                                                         \
    {                                                                                         \
        MT_F_FIELD(json, MT_FIELD_NUMBERS, false, double *, m), .other = MT_F_MEMBER(int, n), \
                                                                .says = __VA_ARGS__           \
    }
#define MT_F_NUMBERS_ROUNDED(json, m, n, most, ...)                             \
    {                                                                           \
        MT_F_FIELD(json, MT_FIELD_NUMBERS, false, double *, m),                 \
            .other = MT_F_MEMBER(int, n), .digits = (most), .says = __VA_ARGS__ \
    }
#define MT_F_BY_VARIABLE(json, m, ...)                                                        \
    {                                                                                         \
        MT_F_FIELD(json, MT_FIELD_BY_VARIABLE, false, double *, m), .numbers_nullable = true, \
                                                                    .says = __VA_ARGS__       \
    }
#define MT_F_BY_VARIABLE_OR_NULL(json, m, ...)                                               \
    {                                                                                        \
        MT_F_FIELD(json, MT_FIELD_BY_VARIABLE, true, double *, m), .numbers_nullable = true, \
                                                                   .says = __VA_ARGS__       \
    }
#define MT_F_NUMBERS_BY_VARIABLE(json, m, ...)                                          \
    {                                                                                   \
        MT_F_FIELD(json, MT_FIELD_BY_VARIABLE, false, double *, m), .says = __VA_ARGS__ \
    }
#define MT_F_UNWRITTEN_TEXT(m)                                 \
    {                                                          \
        MT_F_FIELD(NULL, MT_FIELD_TEXT, true, const char *, m) \
    }
#define MT_F_RECORD_OF(fields, name, says)                              \
    {                                                                   \
        sizeof(THIS), MT_COUNT(fields), (fields), (name), (says), false \
    }
#define MT_F_BARE_RECORD_OF(fields)                                \
    {                                                              \
        sizeof(THIS), MT_COUNT(fields), (fields), NULL, NULL, true \
    }
/* NOLINTEND(bugprone-macro-parentheses) */

/* Set a struct to unknown: numbers NaN, counts below their least, lists empty, the rest
 * zero. */
void mt_record_clear(const mt_record *record, void *item);
/* Replace every text and list of a struct by a copy in mem, which remembers a shortage;
 * n_variables: of the study. Texts and lists that `like` (of the same record, living as long as
 * mem; NULL: none) has in the same place with the same content are shared with it: neither
 * struct may be changed afterwards. */
void mt_record_own(const mt_record *record, void *item, const void *like, int n_variables,
                   mt_arena *mem);
/* Serialize a whole struct. Read data lies in mem; where the serializer failed the struct is
 * not usable. */
void mt_record_serialize(const mt_record *record, void *item, int n_variables,
                         mt_serializer *serializer, mt_arena *mem);
/* True where the document is an object whose "format", the first field of its record, is not
 * another text; a missing one is noted. kind: of file, in words. */
bool mt_record_check_format(mt_reader *r, const mt_record *record, const char *kind);

/* The pointer stored at a member, of any pointed-to type. */
static inline void *mt_record_get_pointer(const void *at)
{
    void *pointer = NULL;
    memcpy(&pointer, at, sizeof pointer);
    return pointer;
}

static inline void mt_record_set_pointer(void *at, const void *pointer)
{
    memcpy(at, &pointer, sizeof pointer);
}

#endif
