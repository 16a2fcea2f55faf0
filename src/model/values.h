/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_VALUES_H
#define MODEL_VALUES_H

#include "expr/program.h"
#include "model/model.h"

/*
 * Values at the original design: every parameter has the value of the model's file, without
 * overrides of configurations.
 */

/**
 * @param[in]  model   resolved (no cycles among parameters)
 * @param[out] values  [n_parameters], each in its parameter's unit
 * @param[out] bad     may be NULL: the parameter without a finite value where MT_E_DOMAIN is
 *                     returned, otherwise MT_ABSENT
 * Scratch from mem is returned. O(total length of the expressions). Fails: MT_E_DOMAIN, the
 * message names the parameter; MT_E_MEMORY, MT_E_INTERNAL (a cycle).
 */
mt_status mt_model_original_values(const mt_model *model, mt_arena *mem, double *values,
                                   int *bad, mt_err *err);

/**
 * The value of an expression of the model's parameters at the given parameter values.
 * @param[in]  values  [n_parameters]
 * Scratch from mem is returned. Fails: MT_E_DOMAIN (the value is not finite), MT_E_MEMORY.
 */
mt_status mt_model_expr_value(const mt_model *model, const double *values, const mt_expr *e,
                              mt_arena *mem, double *out, mt_err *err);

/* Add all parameters of a configuration (MT_ABSENT: of the file) to a program; is_input[p] >=
 * 0: parameter p is that input (NULL: no inputs; an override takes precedence over an input).
 * nodes[n_parameters]. The model must have no cycles. Fails: MT_E_MEMORY, MT_E_INTERNAL (a
 * cycle). */
mt_status mt_emit_parameters(const mt_model *model, int configuration, const int *is_input,
                             mt_program *program, mt_node *nodes, mt_arena *mem, mt_err *err);

/**
 * Values of all parameters in a configuration (MT_ABSENT: in the file) at given inputs;
 * parameters that depend on them follow.
 * @param[out] value  [n_parameters]
 * Scratch from mem is returned. Fails: MT_E_DOMAIN, MT_E_MEMORY, MT_E_INTERNAL.
 */
mt_status mt_model_parameters(const mt_model *model, int configuration, int n_inputs,
                              const int *inputs, const double *at, mt_arena *mem, double *value,
                              mt_err *err);

/*
 * Numbers of a configuration (MT_ABSENT: of the file) as functions of some parameters, compiled
 * once for many designs.
 */
typedef struct mt_numbers {
    mt_program program;
    int n;
    mt_node *nodes; /* [n] */
    double *all;    /* [program.count] of the last design */
} mt_numbers;

/**
 * @param[in]  inputs   [n_inputs] parameters; others follow from them
 * @param[in]  numbers  [n] of the model, or other expressions of its parameters
 * In mem; the model must outlive it. O(total length of the expressions). Fails: MT_E_MEMORY,
 * MT_E_INTERNAL.
 */
mt_status mt_numbers_new(const mt_model *model, int configuration, int n_inputs,
                         const int *inputs, int n, const mt_number *numbers, mt_arena *mem,
                         mt_numbers *out, mt_err *err);
/**
 * @param[in]  at     [n_inputs]
 * @param[out] value  [n]; NaN where a number, or one that it depends on, is not finite
 * @param[out] whole  may be NULL; true: all numbers and all parameters are finite
 */
void mt_numbers_at(const mt_numbers *numbers, const double *at, double *value, bool *whole);

/* mt_numbers_new and mt_numbers_at for one design and one number of the model; MT_ABSENT: 0.
 * Constant numbers cost nothing. NaN: not finite. Scratch from mem is returned. Fails:
 * MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_model_number(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_num number, mt_arena *mem,
                          double *value, mt_err *err);

/* mt_numbers_new and mt_numbers_at for one design and all numbers of the model: value[n_nums].
 * Scratch from mem is returned. Fails: MT_E_MEMORY, MT_E_INTERNAL. */
mt_status mt_model_numbers(const mt_model *model, int configuration, int n_inputs,
                           const int *inputs, const double *at, mt_arena *mem, double *value,
                           mt_err *err);

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
