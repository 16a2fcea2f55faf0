/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_EXPAND_H
#define MODEL_EXPAND_H

#include "io/json.h"
#include "io/options.h"
#include "model/model.h"

/*
 * "repeat" and "include" of a model file. They are written out before anything else is read:
 * the document becomes one without them (mt_json_become), in which every value knows where it
 * comes from.
 */
/* Files that were included. */
typedef struct mt_included_list {
    int n;
    int capacity;
    mt_included *items; /* [n], in mem */
    mt_arena *mem;      /* not owned */
} mt_included_list;

/* MT_EXPAND_COPIES of one item, MT_EXPAND_REPEATS of one file, MT_EXPAND_FILES included, each
 * at most MT_EXPAND_DEPTH below the model, and MT_EXPAND_VALUES written in all. */
enum {
    MT_EXPAND_COPIES = 10000,
    MT_EXPAND_REPEATS = 200,
    MT_EXPAND_FILES = 1000,
    MT_EXPAND_DEPTH = 16,
    MT_EXPAND_VALUES = 3000000
};

/**
 * Write out the repeats and includes of a model file; a document without any stays as it is.
 * @param[in,out] doc    what is wrong is noted in it
 * @param[in]     path   of the file, from whose folder files are included
 * @param[in]     opt    NULL: defaults
 * @param[in,out] files  the included files are added; may be NULL
 * Fails: MT_E_INPUT (see mt_json_status), MT_E_MEMORY.
 */
mt_status mt_model_expand(mt_json *doc, const char *path, const mt_io_options *opt,
                          mt_included_list *files, mt_err *err);

#endif
