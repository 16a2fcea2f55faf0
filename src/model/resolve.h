/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_RESOLVE_H
#define MODEL_RESOLVE_H

#include "model/model.h"

/* Resolve and check; every problem goes to diags (duplicate names, unknown names with "did you
 * mean", wrong list lengths, joint types not in this dimension, cycles of `like` and of
 * parameters with their path "a -> b -> a" per configuration, a point mass where an orientation
 * is needed, reserved names, names with a dot, a point named like a parameter where `at` is
 * ambiguous ...). An item that a reader could not read completely (its faults are in diags
 * already) carries a type of ..._TYPE_COUNT (joint, spring), 0 elements (link) or no name in
 * `on` (sensor) and is only checked for its name. The form of names is the reader's to check.
 * Returns MT_E_INPUT where diags holds errors, else MT_OK; MT_E_MEMORY. */
mt_status mt_model_resolve(mt_model *model, mt_diags *diags, mt_err *err);

#endif
