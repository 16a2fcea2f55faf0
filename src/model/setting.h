/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_SETTING_H
#define MODEL_SETTING_H

#include "model/model.h"

/**
 * Values that parameters get instead of those in the model's file, each as a text NAME=VALUE
 * ("k=1.1*k"). An expression is evaluated at the file's own values, so order does not matter.
 * @param[in]  original  [n_parameters] the file's own values (model/values.h)
 * @param[out] out       [n] in the order of the texts, in mem
 * Fails: MT_E_USAGE (no parameter of this name, with what may have been meant; one that is set
 * twice; an expression without a value), MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_model_read_settings(const mt_model *model, const double *original, int n,
                                 const char *const *texts, mt_arena *mem, mt_setting **out,
                                 mt_err *err);

#endif
