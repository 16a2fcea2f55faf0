/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_SETTING_H
#define MODEL_SETTING_H

#include "model/model.h"

/* What numbers typed by hand are read with. */
typedef struct mt_typing {
    const mt_model *model;
    const double *values;     /* [n_parameters] of expressions */
    const char *const *names; /* [n_parameters] */
    mt_arena *mem;
} mt_typing;
/* All in mem. Fails: MT_E_MEMORY. */
mt_status mt_typing_new(const mt_model *model, const double *values, mt_arena *mem,
                        mt_typing *out, mt_err *err);
/* A number alone, signed perhaps, in this unit (NULL: SI); an expression is in SI, and refused
 * where it cannot be meant by somebody who thinks in the unit `judged` (mt_kind_complaint).
 * Fails: MT_E_INPUT, MT_E_USAGE, MT_E_DOMAIN (it has no value), MT_E_MEMORY. */
mt_status mt_model_read_typed(const mt_typing *with, const char *text, const mt_unit *unit,
                              const mt_unit *judged, double *out, mt_err *err);

/**
 * Values that parameters get instead of those in the model's file, each as a text NAME=VALUE
 * ("k=1.1*k"). A number alone is in the parameter's unit; an expression is in SI, and evaluated
 * at the file's own values, so order does not matter.
 * @param[in]  original  [n_parameters] the file's own values (model/values.h)
 * @param[out] out       [n] in the order of the texts, in mem
 * Fails: MT_E_USAGE (no parameter of this name, with what may have been meant; one that is set
 * twice; an expression without a value, or with a number that has no unit where one is needed),
 * MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_model_read_settings(const mt_model *model, const double *original, int n,
                                 const char *const *texts, mt_arena *mem, mt_setting **out,
                                 mt_err *err);

#endif
