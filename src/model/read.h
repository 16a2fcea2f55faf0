/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_READ_H
#define MODEL_READ_H

#include "base/diagnostics.h"
#include "io/json.h"
#include "io/options.h"
#include "io/reader.h"
#include "model/model.h"

/**
 * Read, resolve and check a model file (format "modetune-model/1").
 * @param[in]  opt       NULL: defaults
 * @param[out] out       the model, owned by the caller (mt_model_delete); NULL on failure
 * @param[out] messages  every diagnostic, warnings included, is added; may be NULL
 * Fails: MT_E_INPUT (err: the first diagnostic), MT_E_SYSTEM, MT_E_MEMORY.
 */
mt_status mt_model_load(const char *path, const mt_io_options *opt, mt_model **out,
                        mt_diagnostics *messages, mt_err *err);
/* As mt_model_load, from a parsed document; problems go to its diagnostics. `file` names it in
 * err and in the model. */
mt_status mt_model_from_json(mt_json *doc, const char *file, mt_model **out, mt_err *err);

/* All key tables of a model file, `what` being the name of the definition in the schema; *n is
 * their number. */
const mt_key_table *const *mt_model_key_tables(int *n);
/* The types that members of a model share; *n is their number. */
const mt_schema_type *mt_model_types(int *n);

/* Resolve names and check the model; every problem goes to diags (duplicate names, unknown
 * names with suggestions, wrong list lengths, joint types not in this dimension, cycles of
 * `like` and of parameters with their path "a -> b -> a" per configuration, a point mass where
 * an orientation is needed, reserved names, names with a dot, a point named like a parameter
 * where `at` is ambiguous ...). An item that a reader could not read completely (its errors are
 * in diags already) has a type of ..._TYPE_COUNT (joint, spring), 0 elements (link) or no name
 * in `on` (sensor); only its name is checked. The form of names is checked by the reader.
 * Returns MT_E_INPUT where diags holds errors; MT_E_MEMORY. */
mt_status mt_model_resolve(mt_model *model, mt_diags *diags, mt_err *err);

#endif
