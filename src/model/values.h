/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_VALUES_H
#define MODEL_VALUES_H

#include "model/model.h"

/*
 * Values at the original design: every parameter at the value that the model's file gives it, no configuration's overrides.
 */

/**
 * @param[in]  model   finished (no cycles among parameters)
 * @param[out] values  [n_parameters], each in its parameter's unit
 * @param[out] bad     may be NULL: the parameter without a finite value where MT_E_DOMAIN is returned, else MT_ABSENT
 * Scratch comes from mem and goes back. O(total length of the expressions).
 * Fails: MT_E_DOMAIN, the message names the parameter; MT_E_INPUT (a cycle: the model was not checked), MT_E_MEMORY.
 */
mt_status mt_model_original_values(const mt_model *model, mt_arena *mem, double *values,
                                   int *bad, mt_err *err);

/**
 * The value of one expression of the model's parameters where these have the given values.
 * @param[in]  values  [n_parameters]
 * Scratch from mem, given back. Fails: MT_E_DOMAIN (the value is not finite), MT_E_MEMORY.
 */
mt_status mt_model_expr_value(const mt_model *model, const double *values, const mt_expr *e,
                              mt_arena *mem, double *out, mt_err *err);

#endif
