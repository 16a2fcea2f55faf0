/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_RESOLVE_H
#define MODEL_RESOLVE_H

#include "model/model.h"

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
