/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_DIAGNOSTICS_H
#define BASE_DIAGNOSTICS_H

#include "modetune/read.h"

#include <stdbool.h>

#include "base/arena.h"
#include "base/text.h"

/*
 * All problems found in an input, in the order found. An address is a number that the reader of
 * the file assigns (for JSON: the index of the value in document order); only that reader turns
 * it into file:line:column and a JSON pointer. MT_NO_ADDR: the problem has no location (a model
 * built in memory).
 */
typedef int mt_addr;
/* MT_DIAG_LIMIT problems are kept. The first MT_DIAG_SUGGESTIONS of them get a suggestion,
 * which costs a walk through all names. */
enum { MT_NO_ADDR = -1, MT_DIAG_LIMIT = 200, MT_DIAG_SUGGESTIONS = 50 };

typedef struct mt_diag {
    mt_addr addr;
    mt_severity severity;
    bool structural; /* a schema of the format finds this error as well */
    const char *text;
} mt_diag;

/* The address of an object's member in a document; MT_NO_ADDR where it has none so called. */
typedef mt_addr (*mt_diag_lookup)(const void *document, mt_addr object, const char *member);

typedef struct mt_diags {
    mt_arena *mem;         /* not owned */
    const void *document;  /* of the addresses; NULL: none */
    mt_diag_lookup lookup; /* in the document */
    mt_diag *items;
    int count;
    int capacity;
    int errors;     /* number of errors, including those beyond the limit */
    int structural; /* number of structural errors, including those beyond the limit */
    int warnings;   /* number of warnings, including those beyond the limit */
} mt_diags;

/* Empty list with its texts in mem; a shortage is kept in mem (mt_arena_check). */
mt_diags mt_diags_default(mt_arena *mem);
/* Add a problem; beyond MT_DIAG_LIMIT it is counted only. */
void mt_diag_error(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);
/* Add an error of structure (types, names of members, choices), which a schema finds as
 * well. */
void mt_diag_structure(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);
/* True where another problem would be kept. */
bool mt_diag_has_room(const mt_diags *d);
/* True for the first MT_DIAG_SUGGESTIONS errors, which get a suggestion ("did you mean"). */
bool mt_diag_may_suggest(const mt_diags *d);
/* The address of an object's member, wrong values included; the object's own where it has none
 * of that name, where member is NULL, or where there is no document. O(members). */
mt_addr mt_diag_member(const mt_diags *d, mt_addr object, const char *member);
void mt_diag_warning(mt_diags *d, mt_addr addr, const char *fmt, ...) MT_PRINTF(3, 4);

/* A problem with its location; file, pointer and message are offsets of NUL-terminated texts in
 * `parts`. */
typedef struct mt_diagnostic {
    mt_severity severity;
    int line; /* 0: no location and no pointer */
    int column;
    size_t file;
    size_t pointer;
    size_t message;
} mt_diagnostic;

/* Messages about files. Zeroed: an empty list. A lack of memory sets `lines.failed`. */
struct mt_diagnostics {
    mt_text lines; /* as the program prints them */
    mt_text parts;
    mt_diagnostic *items; /* heap */
    int count;
    int capacity;
    int left_out;
};

/* Location of a value in a file. */
typedef struct mt_diagnostic_place {
    const char *file;
    int line; /* 0: no location */
    int column;
    const char *pointer; /* NULL or empty: none */
} mt_diagnostic_place;

/* Add one; texts are copied. In message and line, what a terminal would obey is made visible
 * and long texts are cut; the pointer is kept as it is. */
void mt_diagnostics_add(mt_diagnostics *d, mt_severity severity,
                        const mt_diagnostic_place *place, const char *message);
/* Adds "file: n more not shown". */
void mt_diagnostics_leave_out(mt_diagnostics *d, const char *file, int n);
/* Append the messages of `more` to d. */
void mt_diagnostics_append(mt_diagnostics *d, const mt_diagnostics *more);
/* Index of the first error; -1: none. */
int mt_diagnostics_first_error(const mt_diagnostics *d);
/* Free the contents of a struct that is not itself on the heap; it is empty afterwards. */
void mt_diagnostics_free(mt_diagnostics *d);

/*
 * A message about the model that comes before the results: a note (a property that surprises
 * where it is not intended: "2 free motions"), a warning (an allowed but suspicious value: a
 * margin of 0.1 %), or a fault (an impossible value: a negative mass).
 */
typedef enum mt_warning_level {
    MT_LEVEL_NOTE,
    MT_LEVEL_WARNING,
    MT_LEVEL_FAULT,
    MT_LEVEL_COUNT
} mt_warning_level;

typedef struct mt_warning {
    mt_warning_level level;
    const char *kind;          /* a short stable name: "margin", "free_motion" */
    const char *text;          /* a sentence without a full stop */
    const char *configuration; /* NULL: of the whole file */
    const char *pointer;       /* JSON pointer; NULL: not known */
    const char *file;          /* NULL: not known */
    int line;                  /* 0: not known */
    int column;
    mt_addr addr; /* for the reader of the file, which derives pointer, file, line and column */
    double size;  /* deviation in a unit of the kind; the largest comes first */
} mt_warning;

/* Names of warnings, by which a file accepts them: name, meaning. */
#define MT_WARNING_NAMES(X)                                                            \
    X("angle", "an angle above 2 pi without a unit in a trigonometric function")       \
    X("band", "a band without width")                                                  \
    X("bounds", "bounds of a variable, powers of ten apart or away from the original") \
    X("bushing", "a bushing whose two points are apart")                               \
    X("damping", "a damping ratio or loss factor that looks like per cent")            \
    X("density", "a density that no solid has")                                        \
    X("drive", "a drive beyond a turn, or beyond the drawing")                         \
    X("dropped", "an own setting of a configuration that drops inherited ones")        \
    X("frequency", "a lowest frequency that no mechanism has")                         \
    X("gap", "two points of a joint that are drawn apart")                             \
    X("gravity", "gravity that points up")                                             \
    X("inertia", "a radius of gyration beyond a body's size")                          \
    X("level", "a level of vibration that none has")                                   \
    X("margin", "a margin that looks like a factor")                                   \
    X("mass", "a mass that no mechanism has")                                          \
    X("modulus", "a modulus that no solid has")                                        \
    X("no_effect", "bands, or a shape of one number, without effect")                  \
    X("off", "a joint or spring that lies off what it holds")                          \
    X("reference", "measured frequencies that are all off by 2 pi or 60")              \
    X("section", "a section that is too thick or too thin")                            \
    X("size", "a drawing that is too large or too small")                              \
    X("speed", "a speed that looks like turns per minute")                             \
    X("speed_range", "a range of speeds that looks like per cent")                     \
    X("spread", "a factor of weights so large that one goal decides")                  \
    X("spring", "a spring that acts against what joints forbid")                       \
    X("target", "a target far from the original frequency")                            \
    X("tolerance", "a tolerance within which almost anything, or nothing, lies")       \
    X("unit", "a number in another unit than its member")                              \
    X("weight", "a goal without a weight beside others of a misfit")
enum {
/* NOLINTNEXTLINE(bugprone-macro-parentheses): a term of a sum */
#define MT_WARNING_COUNT_ONE(name, of) +1
    MT_WARNING_NAME_COUNT = 0 MT_WARNING_NAMES(MT_WARNING_COUNT_ONE)
#undef MT_WARNING_COUNT_ONE
};
extern const char *const mt_warning_names[MT_WARNING_NAME_COUNT];

/* Names of the warnings that a file accepts; owned by the file's arena. */
typedef struct mt_accepted {
    int n;
    const char **names;
} mt_accepted;

typedef struct mt_warning_list {
    mt_arena *mem; /* not owned */
    mt_warning *items;
    int n;
    int capacity;
} mt_warning_list;

/* Empty list with its texts in mem; a shortage is kept in mem (mt_arena_check). */
mt_warning_list mt_warning_list_default(mt_arena *mem);
/* Add one with a formatted text; returns it (valid until the next addition), NULL where none
 * was added: out of memory, or beyond MT_WARNING_LIMIT. */
mt_warning *mt_warning_add(mt_warning_list *list, mt_warning_level level, const char *kind,
                           const char *fmt, ...) MT_PRINTF(4, 5);
/* Sort items first .. n - 1 by descending size; equal sizes keep their order. */
void mt_warning_sort(mt_warning_list *list, int first);
/* Turn accepted warnings from `first` on into notes that say so. */
void mt_warning_accept(mt_warning_list *list, int first, const mt_accepted *accepted);
/* The items of that level, *n of them in mem, which remembers a shortage; texts are shared. */
mt_warning *mt_warning_pick(const mt_warning_list *list, mt_warning_level level, mt_arena *mem,
                            int *n);
/* Copy an item with all its texts into another list. */
void mt_warning_copy(mt_warning_list *list, const mt_warning *item);

#endif
