/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_SETTING_H
#define MODEL_SETTING_H

#include "model/model.h"

/* Context for reading numbers typed by hand. */
typedef struct mt_typing {
    const mt_model *model;
    const double *values;     /* [n_parameters] for expressions */
    const char *const *names; /* [n_parameters] */
    mt_arena *mem;
} mt_typing;
/* All in mem. Fails: MT_E_MEMORY. */
mt_status mt_typing_new(const mt_model *model, const double *values, mt_arena *mem,
                        mt_typing *out, mt_err *err);
/* Read a bare number, possibly signed, in `unit` (NULL: SI), or an expression in SI, which is
 * refused where it is suspicious for numbers in the unit `judged` (mt_kind_complaint). Fails:
 * MT_E_INPUT, MT_E_USAGE, MT_E_DOMAIN (it has no value), MT_E_MEMORY. */
mt_status mt_model_read_typed(const mt_typing *with, const char *text, const mt_unit *unit,
                              const mt_unit *judged, double *out, mt_err *err);

/**
 * Values that replace those of the model's file, each as a text NAME=VALUE ("k=1.1*k"). A bare
 * number is in the parameter's unit; an expression is in SI and evaluated at the file's values,
 * so the order does not matter.
 * @param[in]  original  [n_parameters] the file's own values (model/values.h)
 * @param[out] out       [n] in the order of the texts, in mem
 * Fails: MT_E_USAGE (unknown parameter, with a suggestion; one that is set twice; an expression
 * without a value, or with a bare number where a unit is needed), MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_model_read_settings(const mt_model *model, const double *original, int n,
                                 const char *const *texts, mt_arena *mem, mt_setting **out,
                                 mt_err *err);

#endif
