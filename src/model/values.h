/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_VALUES_H
#define MODEL_VALUES_H

#include "expr/program.h"
#include "model/model.h"

/*
 * Values at the original design: every parameter at the value that the model's file gives it,
 * no configuration's overrides.
 */

/**
 * @param[in]  model   finished (no cycles among parameters)
 * @param[out] values  [n_parameters], each in its parameter's unit
 * @param[out] bad     may be NULL: the parameter without a finite value where MT_E_DOMAIN is
 *                     returned, else MT_ABSENT
 * Scratch comes from mem and goes back. O(total length of the expressions).
 * Fails: MT_E_DOMAIN, the message names the parameter; MT_E_MEMORY, MT_E_INTERNAL (a cycle).
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

/* Emit all parameters of a configuration (MT_ABSENT: of the file) into a program; is_input[p]
 * >= 0: parameter p is that input (NULL: none is; an override wins over an input).
 * nodes[n_parameters]. The model has been checked for cycles. Fails: MT_E_MEMORY, MT_E_INTERNAL
 * (a cycle). */
mt_status mt_emit_parameters(const mt_model *model, int configuration, const int *is_input,
                             mt_program *program, mt_node *nodes, mt_arena *mem, mt_err *err);

/**
 * Values of all parameters in a configuration (MT_ABSENT: in the file) where some are inputs,
 * those made of others following.
 * @param[out] value  [n_parameters]
 * Scratch from mem, given back. Fails: MT_E_DOMAIN, MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_model_parameters(const mt_model *model, int configuration, int n_inputs,
                              const int *inputs, const double *at, mt_arena *mem, double *value,
                              mt_err *err);

/*
 * Numbers of a configuration (MT_ABSENT: of the file) as functions of some parameters: compiled
 * once, for many designs.
 */
typedef struct mt_numbers {
    mt_program program;
    int n;
    mt_node *nodes; /* [n] */
    double *all;    /* [program.count] of the last design */
} mt_numbers;

/**
 * @param[in]  inputs   [n_inputs] parameters, others follow from them
 * @param[in]  numbers  [n] of the model, or other expressions of its parameters
 * Lives in mem, with the model. O(total length of the expressions). Fails: MT_E_MEMORY,
 * MT_E_INTERNAL.
 */
mt_status mt_numbers_new(const mt_model *model, int configuration, int n_inputs,
                         const int *inputs, int n, const mt_number *numbers, mt_arena *mem,
                         mt_numbers *out, mt_err *err);
/**
 * @param[in]  at     [n_inputs]
 * @param[out] value  [n]; NaN where a number has no finite value (or stands behind one that has
 *                    none)
 * @param[out] whole  may be NULL; true: all of them, and all parameters, have a finite value
 * Fails: MT_E_INTERNAL.
 */
mt_status mt_numbers_at(const mt_numbers *numbers, const double *at, double *value, bool *whole,
                        mt_err *err);

/* Both, for one design and one number of the model, MT_ABSENT: 0. One that depends on nothing
 * costs nothing. NaN: it has no finite value. Scratch from mem, given back. Fails: MT_E_MEMORY,
 * MT_E_INTERNAL. */
mt_status mt_model_number(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_num number, mt_arena *mem,
                          double *value, mt_err *err);

/* Both, for one design and all numbers of the model: value[n_nums]. Scratch from mem, given
 * back. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_model_numbers(const mt_model *model, int configuration, int n_inputs,
                           const int *inputs, const double *at, mt_arena *mem, double *value,
                           mt_err *err);

#endif
