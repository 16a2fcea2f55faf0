/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef BASE_WARNING_H
#define BASE_WARNING_H

#include <stdbool.h>

#include "base/arena.h"
#include "base/diag.h"

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

/* Number of notes and warnings kept, and of faults besides, so that no warning displaces a
 * fault. */
enum { MT_WARNING_LIMIT = 1000 };

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
/* Copy an item with all its texts into another list. */
void mt_warning_copy(mt_warning_list *list, const mt_warning *item);

#endif
