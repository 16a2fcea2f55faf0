/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Parameters into program nodes, and their values. Which definition counts: an override of the
 * configuration, else an input of the caller, else the parameter's own expression. Emission
 * follows the dependences depth first with an explicit stack, so a long chain cannot overflow
 * the C stack; the model was checked for cycles.
 */
#include "model/values.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/text.h"

/* First parameter in the expression that has no node yet, or -1. */
static int missing_operand(const mt_expr *e, const mt_node *nodes)
{
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_PARAM && nodes[e->code[i].param] == MT_NO_NODE) {
            return e->code[i].param;
        }
    }
    return -1;
}

/* What emission reads and fills. */
typedef struct emission {
    const mt_model *model;
    const mt_num *override; /* [n_parameters] the configuration's number, MT_ABSENT: none */
    const int *is_input;
    mt_program *program;
    mt_node *nodes;
    int *stack; /* model->n_parameters + 1 places */
} emission;

/* One parameter and all that it waits for, deepest first. */
static mt_status emit(const emission *x, int parameter, mt_err *err)
{
    mt_node *const nodes = x->nodes;
    int depth = 0;
    x->stack[0] = parameter;
    while (depth >= 0) {
        const int p = x->stack[depth];
        if (nodes[p] != MT_NO_NODE) {
            depth--;
            continue;
        }
        const mt_num over = x->override[p];
        const bool input = over == MT_ABSENT && x->is_input != NULL && x->is_input[p] >= 0;
        const mt_number *const number =
            &x->model->nums[over == MT_ABSENT ? x->model->parameters[p].value : over];
        const int waits_for = input ? -1 : missing_operand(&number->expr, nodes);
        if (waits_for >= 0) {
            if (depth >= x->model->n_parameters) {
                return mt_fail(err, MT_E_INTERNAL, "parameter \"%s\" depends on itself",
                               x->model->parameters[p].name.s);
            }
            x->stack[++depth] = waits_for;
            continue;
        }
        nodes[p] = input ? mt_program_input(x->program, x->is_input[p], number->addr)
                         : mt_program_expr(x->program, &number->expr, nodes, number->addr);
        MT_TRY(mt_arena_check(x->program->mem, err)); /* what waits would wait for ever */
    }
    return MT_OK;
}

mt_status mt_emit_parameters(const mt_model *model, int configuration, const int *is_input,
                             mt_program *program, mt_node *nodes, mt_arena *mem, mt_err *err)
{
    const int n = model->n_parameters;
    int *const stack = mt_arena_int(mem, (size_t)n + 1);
    mt_num *const override = mt_arena_alloc(mem, (size_t)n, sizeof *override);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        nodes[i] = MT_NO_NODE;
        override[i] = MT_ABSENT;
    }
    const mt_configuration *const c =
        configuration < 0 ? NULL : &model->configurations[configuration];
    for (int i = c == NULL ? -1 : c->n_overrides - 1; i >= 0; i--) { /* the first one counts */
        override[c->overrides[i].parameter] = c->overrides[i].value;
    }
    const emission x = {model, override, is_input, program, nodes, stack};
    for (int i = 0; i < n; i++) {
        MT_TRY(emit(&x, i, err));
    }
    return MT_OK;
}

/* A program with the parameters of a configuration (MT_ABSENT: of the file), some of them
 * inputs; nodes[n_parameters]. */
static mt_status begin_parameter_program(const mt_model *model, int configuration, int n_inputs,
                                         const int *inputs, mt_arena *mem, mt_program *program,
                                         mt_node **nodes, mt_err *err)
{
    const size_t n = (size_t)model->n_parameters;
    int *const is_input = mt_arena_int(mem, n);
    *nodes = mt_arena_int(mem, n);
    MT_TRY(mt_program_init(program, n_inputs, mem, err));
    for (size_t i = 0; i < n; i++) {
        is_input[i] = MT_ABSENT;
    }
    for (int i = 0; i < n_inputs; i++) {
        is_input[inputs[i]] = i;
    }
    return mt_emit_parameters(model, configuration, is_input, program, *nodes, mem, err);
}

/* NOLINTNEXTLINE(readability-function-size) */
mt_status mt_numbers_new(const mt_model *model, int configuration, int n_inputs,
                         const int *inputs, int n, const mt_number *numbers, mt_arena *mem,
                         mt_numbers *out, mt_err *err)
{
    mt_node *parameters = NULL;
    mt_program *const program = &out->program;
    *out = (mt_numbers){.n = n, .nodes = mt_arena_int(mem, (size_t)n)};
    MT_TRY(begin_parameter_program(model, configuration, n_inputs, inputs, mem, program,
                                   &parameters, err));
    for (int i = 0; i < n; i++) {
        out->nodes[i] = mt_program_expr(program, &numbers[i].expr, parameters, numbers[i].addr);
    }
    MT_TRY(mt_program_finish(program, err));
    out->all = mt_arena_f64(mem, (size_t)program->count, 1);
    return mt_arena_check(mem, err);
}

void mt_numbers_at(const mt_numbers *numbers, const double *at, double *value, bool *whole)
{
    const bool all = mt_program_values(&numbers->program, at, numbers->all);
    for (int i = 0; i < numbers->n; i++) {
        value[i] = numbers->all[numbers->nodes[i]];
    }
    if (whole != NULL) {
        *whole = all;
    }
}

/* NOLINTNEXTLINE(readability-function-size) */
mt_status mt_model_number(const mt_model *model, int configuration, int n_inputs,
                          const int *inputs, const double *at, mt_num number, mt_arena *mem,
                          double *value, mt_err *err)
{
    *value = 0.0;
    if (number == MT_ABSENT || mt_expr_is_constant(&model->nums[number].expr, value)) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_numbers numbers;
    const mt_status rc = mt_numbers_new(model, configuration, n_inputs, inputs, 1,
                                        &model->nums[number], mem, &numbers, err);
    if (rc == MT_OK) {
        mt_numbers_at(&numbers, at, value, NULL);
    }
    mt_arena_rewind(mem, mark);
    return rc;
}

mt_status mt_model_numbers(const mt_model *model, int configuration, int n_inputs,
                           const int *inputs, const double *at, mt_arena *mem, double *value,
                           mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    mt_numbers numbers;
    const mt_status rc = mt_numbers_new(model, configuration, n_inputs, inputs, model->n_nums,
                                        model->nums, mem, &numbers, err);
    if (rc == MT_OK) {
        mt_numbers_at(&numbers, at, value, NULL);
    }
    mt_arena_rewind(mem, mark);
    return rc;
}

/* What parameters are asked at: a configuration (MT_ABSENT: the file), and inputs. */
typedef struct setting {
    int configuration;
    int n_inputs;
    const int *inputs;
    const double *at;
} setting;

/* *bad: where a value is not finite, the first parameter in order of evaluation that has
 * none. */
static mt_status evaluate_parameters(const mt_model *model, const setting *set, mt_arena *mem,
                                     double *value, int *bad, mt_err *err)
{
    mt_node *nodes = NULL;
    mt_program program;
    MT_TRY(begin_parameter_program(model, set->configuration, set->n_inputs, set->inputs, mem,
                                   &program, &nodes, err));
    MT_TRY(mt_program_finish(&program, err));
    double *const all = mt_arena_f64(mem, (size_t)program.count, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_node without = MT_NO_NODE;
    const mt_status rc = mt_program_eval(&program, set->at, all, &without, err);
    for (int i = 0; rc == MT_OK && i < model->n_parameters; i++) {
        value[i] = all[nodes[i]];
    }
    /* the node belongs to the first parameter that it spoils: one whose node follows it
     * first */
    for (int i = 0; rc == MT_E_DOMAIN && i < model->n_parameters; i++) {
        if (nodes[i] >= without && (*bad == MT_ABSENT || nodes[i] < nodes[*bad])) {
            *bad = i;
        }
    }
    return rc;
}

mt_status mt_model_parameters(const mt_model *model, int configuration, int n_inputs,
                              const int *inputs, const double *at, mt_arena *mem, double *value,
                              mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const setting set = {configuration, n_inputs, inputs, at};
    int bad = MT_ABSENT;
    const mt_status rc = evaluate_parameters(model, &set, mem, value, &bad, err);
    mt_arena_rewind(mem, mark);
    return rc;
}

mt_status mt_model_original_values(const mt_model *model, mt_arena *mem, double *values,
                                   int *bad, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const setting set = {MT_ABSENT, 0, NULL, NULL};
    int which = MT_ABSENT;
    const mt_status rc = evaluate_parameters(model, &set, mem, values, &which, err);
    mt_arena_rewind(mem, mark);
    if (bad != NULL) {
        *bad = which;
    }
    return which == MT_ABSENT ? rc
                              : mt_fail(err, rc, "parameter \"%s\" has no finite value",
                                        model->parameters[which].name.s);
}

static mt_status expr_value(const mt_model *model, const double *values, const mt_expr *e,
                            mt_arena *mem, double *out, mt_err *err)
{
    mt_program program;
    mt_node *const nodes = mt_arena_int(mem, (size_t)model->n_parameters);
    MT_TRY(mt_program_init(&program, 0, mem, err));
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_PARAM) {
            nodes[e->code[i].param] = mt_program_const(&program, values[e->code[i].param]);
        }
    }
    const mt_node node = mt_program_expr(&program, e, nodes, MT_NO_ADDR);
    MT_TRY(mt_program_finish(&program, err));
    double *const all = mt_arena_f64(mem, (size_t)program.count, 1);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_program_eval(&program, NULL, all, NULL, err));
    *out = all[node];
    return MT_OK;
}

mt_status mt_model_expr_value(const mt_model *model, const double *values, const mt_expr *e,
                              mt_arena *mem, double *out, mt_err *err)
{
    if (mt_expr_is_constant(e, out) && isfinite(*out)) {
        return MT_OK;
    }
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = expr_value(model, values, e, mem, out, err);
    mt_arena_rewind(mem, mark);
    return rc;
}

/* Values typed by hand, and those that replace the file's. */

static mt_status refuse_unknown_parameter(const mt_typing *r, const char *name, mt_err *err)
{
    const char *const nearest = mt_text_nearest(name, r->names, r->model->n_parameters);
    return nearest == NULL
               ? mt_fail(err, MT_E_USAGE, "unknown parameter \"%s\"", name)
               : mt_fail(err, MT_E_USAGE, "unknown parameter \"%s\"; did you mean \"%s\"?",
                         name, nearest);
}

/* Alone, signed perhaps. */
static bool is_bare(const mt_expr *e)
{
    return e->code[0].op == MT_OP_CONST && e->code[0].param == (int)MT_KIND_NUMBER &&
           (e->length == 1 || (e->length == 2 && e->code[1].op == MT_OP_NEG));
}

mt_status mt_model_read_typed(const mt_typing *with, const char *text, const mt_unit *unit,
                              const mt_unit *judged, double *out, mt_err *err)
{
    const mt_model *const m = with->model;
    char complaint[MT_KIND_TEXT];
    mt_expr e;
    const mt_expr_scope scope = {.lookup = mt_model_lookup,
                                 .context = m,
                                 .names = with->names,
                                 .n_names = m->n_parameters,
                                 .curves = m->curves,
                                 .n_curves = m->n_curves};
    MT_TRY(mt_expr_parse(text, &scope, with->mem, &e, err));
    if (!is_bare(&e) &&
        mt_kind_complaint(&e, judged, mt_model_kind, m, complaint, sizeof complaint)) {
        return mt_fail(err, MT_E_USAGE, "%s", complaint);
    }
    MT_TRY(mt_model_expr_value(m, with->values, &e, with->mem, out, err));
    *out = is_bare(&e) ? mt_unit_to_si(unit, *out) : *out;
    return MT_OK;
}

mt_status mt_typing_new(const mt_model *model, const double *values, mt_arena *mem,
                        mt_typing *out, mt_err *err)
{
    const size_t n = (size_t)model->n_parameters;
    const char **const names = mt_arena_alloc(mem, n, sizeof *names);
    *out = (mt_typing){model, values, names, mem};
    MT_TRY(mt_arena_check(mem, err));
    for (size_t i = 0; i < n; i++) {
        names[i] = model->parameters[i].name.s;
    }
    return MT_OK;
}

/* The n settings before this one are read. */
static mt_status read_setting(const mt_typing *r, const char *text, int n, mt_setting *all,
                              mt_err *err)
{
    const char *const equals = strchr(text, '=');
    if (equals == NULL || equals == text) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" is not NAME=VALUE", text);
    }
    const char *const name = mt_arena_strndup(r->mem, text, (size_t)(equals - text));
    MT_TRY(mt_arena_check(r->mem, err));
    const int parameter = mt_model_find_parameter(r->model, name);
    if (parameter == MT_ABSENT) {
        return refuse_unknown_parameter(r, name, err);
    }
    for (int i = 0; i < n; i++) {
        if (all[i].parameter == parameter) {
            return mt_fail(err, MT_E_USAGE, "parameter \"%s\" is set twice", name);
        }
    }
    double value = 0.0;
    const mt_status rc =
        mt_model_read_typed(r, equals + 1, r->model->parameters[parameter].written,
                            mt_model_number_unit(r->model, parameter), &value, err);
    if (rc != MT_OK) {
        return mt_err_in(err, rc == MT_E_MEMORY ? rc : MT_E_USAGE, "%s", text);
    }
    all[n] = (mt_setting){parameter, value, r->values[parameter]};
    return MT_OK;
}

mt_status mt_model_read_settings(const mt_model *model, const double *original, int n,
                                 const char *const *texts, mt_arena *mem, mt_setting **out,
                                 mt_err *err)
{
    mt_typing r;
    *out = mt_arena_alloc(mem, (size_t)n, sizeof **out);
    MT_TRY(mt_typing_new(model, original, mem, &r, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(read_setting(&r, texts[i], i, *out, err));
    }
    return MT_OK;
}
