/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The model over the box of the variables.
 *
 * The numbers of the model where the variables stand at their bounds. A search goes there: a
 * diameter of 0 or a wall of no thickness is found now, and named with its variable, not as a
 * failure of some evaluation. Looked at are the designs with one variable at a bound and the
 * corners of the box (all 2^n for n <= MOST_ENUMERATED, else the two at which all variables are
 * least or greatest); of variables that take rows of a catalogue together the rows, and in the
 * corners their first and last. Designs that a limit of the study forbids do not count.
 *
 * A variable that shapes the geometry may take joints out of the redundancy that the mechanism
 * lives on: a tilted hinge of a planar four-bar in space, one crank of a parallelogram with
 * three. At any other value the mechanism cannot be closed, or has lost a motion: its
 * frequencies are no function that a search could follow. Said where the study is read.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "mechanics/linear.h"
#include "mechanics/products.h"
#include "model/lint.h"
#include "model/values.h"
#include "study/check.h"

/* Conditions
 *
 * What an if() chooses is a question of the parameters that keep their values: a design that
 * the search moves over a condition's edge would have a jump there. */

static bool has_condition(const mt_expr *e)
{
    for (int i = 0; i < e->length; i++) {
        if (e->code[i].op == MT_OP_IF) {
            return true;
        }
    }
    return false;
}

/* The expressions of a study that follow the design, with their addresses in its file: the
 * first `most` of list; returns their number. */
static int list_expressions(const mt_study *s, int most, mt_number *list)
{
    int n = 0;
    for (int i = 0; i < s->n_goals + s->n_objectives + s->n_published; i++) {
        const int objective = i - s->n_goals;
        const int published = objective - s->n_objectives;
        const mt_number of =
            objective < 0
                ? (mt_number){.expr = s->goals[i].expression, .addr = s->goals[i].addr}
            : published < 0 ? (mt_number){.expr = s->objectives[objective].expression,
                                          .addr = s->objectives[objective].addr}
                            : (mt_number){.expr = s->published[published].quantity,
                                          .addr = s->published[published].addr};
        const bool has =
            of.expr.length > 0 && (i >= s->n_goals || s->goals[i].expression_text != NULL);
        if (has && n < most) {
            list[n] = of;
        }
        n += has;
    }
    return n;
}

/* Where a condition depends on a variable: told at that variable, or at the study's own
 * expression. */
static void tell_undecided(mt_study_check *c, const mt_program *p, bool own)
{
    const mt_variable *const v = &c->study->variables[p->undecided_input];
    int line = 0;
    int column = 0;
    char where[64] = "";
    if (own) {
        const mt_addr goal = mt_diag_member(c->diags, p->undecided_addr, "expression");
        const mt_addr other = mt_diag_member(c->diags, goal, "minimise");
        mt_diag_error(c->diags, mt_diag_member(c->diags, other, "quantity"),
                      "the condition of an if() depends on \"%s\", which is a variable: the "
                      "expression would jump; a condition holds numbers, and parameters that "
                      "keep their values",
                      v->parameter_name.s);
        return;
    }
    if (mt_model_locate(c->model, p->undecided_addr, &line, &column)) {
        (void)mt_snprintf(where, sizeof where, " (line %d, column %d)", line, column);
    }
    mt_diag_error(
        c->diags, v->parameter_name.addr,
        "\"%s\" cannot be a variable: the condition of an if() in the model%s depends "
        "on it, and the mechanism would jump; a condition holds numbers, and "
        "parameters that keep their values",
        v->parameter_name.s, where);
}

/* The numbers of one configuration (MT_ABSENT: the study's own expressions) with the variables
 * as inputs; false: told. */
static bool decide(mt_study_check *c, int configuration, const int *is_input, int n,
                   const mt_number *numbers, mt_arena *mem)
{
    mt_program p;
    const size_t n_parameters = (size_t)c->model->n_parameters;
    mt_node *const nodes = mt_arena_int(mem, n_parameters + 1);
    if (mt_program_init(&p, c->study->n_variables, mem, NULL) != MT_OK ||
        mt_emit_parameters(c->model, configuration, is_input, &p, nodes, mem, NULL) != MT_OK) {
        return true;
    }
    const bool by_model = p.undecided;
    for (int i = 0; i < n; i++) {
        (void)mt_program_expr(&p, &numbers[i].expr, nodes, numbers[i].addr);
    }
    if (p.undecided) {
        tell_undecided(c, &p, configuration == MT_ABSENT && !by_model);
    }
    return !p.undecided;
}

static void decide_all(mt_study_check *c, mt_arena *mem)
{
    const mt_study *const s = c->study;
    const mt_model *const m = c->model;
    const int n = list_expressions(s, 0, NULL);
    mt_number *const own = mt_arena_alloc(mem, (size_t)n, sizeof *own);
    int *const is_input = mt_arena_int(mem, (size_t)m->n_parameters + 1);
    bool any = false;
    if (mt_arena_failed(mem)) {
        return;
    }
    (void)list_expressions(s, n, own);
    for (int i = 0; i < m->n_nums + n; i++) {
        any = any || has_condition(i < m->n_nums ? &m->nums[i].expr : &own[i - m->n_nums].expr);
    }
    for (int i = 0; i < m->n_parameters; i++) {
        is_input[i] = MT_ABSENT;
    }
    for (int i = 0; i < s->n_variables; i++) {
        if (s->variables[i].parameter != MT_ABSENT) {
            is_input[s->variables[i].parameter] = i;
        }
    }
    bool decided = any && decide(c, MT_ABSENT, is_input, n, own, mem);
    for (int i = 0; i < m->n_configurations && decided; i++) {
        decided = decide(c, i, is_input, m->n_nums, m->nums, mem);
    }
}

static void check_conditions(mt_study_check *c)
{
    mt_arena mem = {0};
    if (mt_arena_init(&mem, 0, NULL) == MT_OK) {
        decide_all(c, &mem);
    }
    if (mt_arena_failed(&mem)) {
        mt_arena_fail(&c->study->mem);
    }
    mt_arena_free(&mem);
}

/* The box whose modes are counted alike */

static void widen_box_bounds(mt_count_box *box, int at, double x)
{
    if (isfinite(x)) {
        box->lower[at] = fmin(box->lower[at], x);
        box->upper[at] = fmax(box->upper[at], x);
    }
}

/* Index of a parameter in the box, added where missing. */
static int box_parameter_index(mt_count_box *box, const mt_study *s, int parameter)
{
    for (int i = 0; i < box->n; i++) {
        if (box->parameter[i] == parameter) {
            return i;
        }
    }
    const double original = s->original[parameter];
    box->parameter[box->n] = parameter;
    box->lower[box->n] = original;
    box->upper[box->n] = original;
    box->at[box->n] = original;
    return box->n++;
}

static void add_variable(mt_count_box *box, const mt_study *s, const mt_variable *v)
{
    const int at = box_parameter_index(box, s, v->parameter);
    const double part = MT_HAS(v->tolerance_percent) ? v->tolerance_percent / 100.0 : 0.0;
    const double ends[2] = {v->lower, v->upper};
    for (int k = 0; k < 2; k++) {
        widen_box_bounds(box, at, ends[k] * (1.0 - part));
        widen_box_bounds(box, at, ends[k] * (1.0 + part));
    }
}

static void fill_counted(mt_study_check *c)
{
    mt_study *const s = c->study;
    const size_t room = (size_t)s->n_variables + MT_MAX_VARY + 1;
    mt_count_box *const box = &s->counted;
    *box = (mt_count_box){.parameter = mt_arena_int(&s->mem, room),
                          .lower = mt_arena_f64(&s->mem, room, 1),
                          .upper = mt_arena_f64(&s->mem, room, 1),
                          .at = mt_arena_f64(&s->mem, room, 1)};
    if (mt_arena_failed(&s->mem)) {
        return;
    }
    for (int i = 0; i < s->n_variables && s->original != NULL; i++) {
        if (s->variables[i].parameter != MT_ABSENT) {
            add_variable(box, s, &s->variables[i]);
        }
    }
    for (int k = 0; k < s->trade.n_vary && s->original != NULL; k++) {
        const mt_vary *const v = &s->trade.vary[k];
        const bool bound = v->kind == MT_VARY_BOUND && v->variable != MT_ABSENT;
        const int parameter = bound ? s->variables[v->variable].parameter
                              : v->kind == MT_VARY_PARAMETER ? v->parameter
                                                             : MT_ABSENT;
        for (int i = 0; i < v->n_values && parameter != MT_ABSENT; i++) {
            widen_box_bounds(box, box_parameter_index(box, s, parameter), v->values[i]);
        }
    }
}

/* Bounds */

enum { MOST_ENUMERATED = 6 };
/* A search takes far longer than to look at a hundred million numbers: what asks for more is no
 * study. */
static const double MOST_WORK = 1e8;

typedef struct corners {
    mt_study_check *c;
    mt_arena mem;
    int n;         /* variables */
    int *inputs;   /* [n] */
    double *x;     /* [n] */
    double *value; /* [n_nums] */
    mt_numbers limits;
    const mt_goal **limited; /* [limits.n] the goals of these expressions */
    double *limit_value;     /* [limits.n] */
    mt_numbers *numbers;     /* [n_configurations], of those that count */
    mt_warning_list told;
    mt_status rc; /* memory ran out */
} corners;

static bool is_asked(const mt_study *s, int c)
{
    bool any = false;
    for (int g = 0; g < s->n_goals; g++) {
        any = any || s->goals[g].n_configurations > 0;
    }
    return !any || mt_study_asks(s, c);
}

/* Expressions of the limits, compiled once. */
static mt_status compile_limits(corners *k)
{
    const mt_study *const s = k->c->study;
    const size_t n_goals = (size_t)s->n_goals;
    mt_number *const list = mt_arena_alloc(&k->mem, n_goals, sizeof *list);
    int n = 0;
    k->limited = mt_arena_alloc(&k->mem, n_goals, sizeof(mt_goal *));
    k->limit_value = mt_arena_f64(&k->mem, n_goals, 1);
    MT_TRY(mt_arena_check(&k->mem, NULL));
    for (int g = 0; g < s->n_goals; g++) {
        if (s->goals[g].expression_text != NULL) {
            k->limited[n] = &s->goals[g];
            list[n++] = (mt_number){.expr = s->goals[g].expression, .addr = s->goals[g].addr};
        }
    }
    return mt_numbers_new(k->c->model, MT_ABSENT, k->n, k->inputs, n, list, &k->mem, &k->limits,
                          NULL);
}

/* ... and the numbers of every configuration that counts. */
static mt_status compile_corner_numbers(corners *k)
{
    const mt_model *const m = k->c->model;
    MT_TRY(compile_limits(k));
    k->numbers = mt_arena_alloc(&k->mem, (size_t)m->n_configurations, sizeof *k->numbers);
    MT_TRY(mt_arena_check(&k->mem, NULL));
    for (int c = 0; c < m->n_configurations; c++) {
        if (is_asked(k->c->study, c)) {
            MT_TRY(mt_numbers_new(m, c, k->n, k->inputs, m->n_nums, m->nums, &k->mem,
                                  &k->numbers[c], NULL));
        }
    }
    return MT_OK;
}

/* True where every limit of an expression holds at x. Equalities are the search's to find. */
static bool is_allowed(corners *k)
{
    bool allowed = false;
    mt_numbers_at(&k->limits, k->x, k->limit_value, &allowed);
    for (int i = 0; i < k->limits.n && allowed; i++) {
        const double v = k->limit_value[i];
        allowed = !(v < k->limited[i]->at_least) && !(v > k->limited[i]->at_most);
    }
    return k->rc == MT_OK && allowed;
}

/* Note all problems of the design x in every configuration that counts. */
static void lint_corner(corners *k, mt_warning_list *out)
{
    const mt_model *const m = k->c->model;
    for (int c = 0; c < m->n_configurations && k->rc == MT_OK; c++) {
        if (is_asked(k->c->study, c)) {
            mt_numbers_at(&k->numbers[c], k->x, k->value, NULL);
            mt_model_lint(m, c, k->value, false, out);
        }
    }
    k->rc = mt_arena_failed(out->mem) ? MT_E_MEMORY : k->rc;
}

static const mt_warning *fault_at(const mt_warning_list *list, mt_addr addr)
{
    for (int i = 0; i < list->n; i++) {
        if (list->items[i].level == MT_LEVEL_FAULT && list->items[i].addr == addr) {
            return &list->items[i];
        }
    }
    return NULL;
}

static void one_variable(corners *k, int i, bool upper)
{
    const mt_variable *const v = &k->c->study->variables[i];
    const mt_addr own = mt_diag_member(k->c->diags, v->addr, upper ? "upper" : "lower");
    mt_warning_list list = mt_warning_list_default(&k->mem);
    k->x[i] = upper ? v->upper : v->lower;
    if (is_allowed(k)) {
        lint_corner(k, &list);
    }
    for (int d = 0; d < list.n; d++) {
        if (list.items[d].level == MT_LEVEL_FAULT &&
            fault_at(&k->told, list.items[d].addr) == NULL) {
            mt_diag_error(k->c->diags,
                          v->n_catalogue > 0 ? mt_diag_member(k->c->diags, v->addr, "catalogue")
                                             : own,
                          "with %s at %g%s%s, %s", v->parameter_name.s,
                          mt_unit_from_si(v->shown, k->x[i]), v->shown == NULL ? "" : " ",
                          mt_unit_name(v->shown, ""), list.items[d].text);
            mt_warning_copy(&k->told, &list.items[d]);
        }
    }
    k->x[i] = v->original;
}

/* Operations of a design: numbers of every configuration that counts, parameters for every
 * limit. */
static double work_of_one(const corners *k)
{
    const mt_study *const s = k->c->study;
    const mt_model *const m = k->c->model;
    double each = m->n_parameters;
    for (int c = 0; c < m->n_configurations; c++) {
        each += is_asked(s, c) ? (double)m->n_nums : 0.0;
    }
    for (int g = 0; g < s->n_goals; g++) {
        each += s->goals[g].expression_text != NULL ? (double)m->n_parameters : 0.0;
    }
    return each;
}

/* ... and of all. */
static double count_work(const corners *k)
{
    return ((2.0 * k->n) + (double)(1U << MOST_ENUMERATED)) * work_of_one(k);
}

/* Every row of a catalogue of parts, as rows alone are designs, unless that is too much work;
 * i: the first of the variables that take one. */
static void every_row(corners *k, int i)
{
    const mt_variable *const v = &k->c->study->variables[i];
    const mt_catalogue_rows *const rows = v->rows;
    if ((double)rows->n_rows * work_of_one(k) > MOST_WORK) {
        return;
    }
    for (int row = 0; row < rows->n_rows && k->rc == MT_OK; row++) {
        mt_warning_list list = mt_warning_list_default(&k->mem);
        memcpy(k->x + i, rows->value + ((ptrdiff_t)row * rows->n),
               (size_t)rows->n * sizeof *k->x);
        if (is_allowed(k)) {
            lint_corner(k, &list);
        }
        for (int d = 0; d < list.n; d++) {
            if (list.items[d].level == MT_LEVEL_FAULT &&
                fault_at(&k->told, list.items[d].addr) == NULL) {
                mt_diag_error(k->c->diags, mt_diag_member(k->c->diags, v->addr, "catalogue"),
                              "with row %d%s%s of \"%s\", %s", rows->number[row],
                              rows->names == NULL ? "" : ", ",
                              rows->names == NULL ? "" : rows->names[row], rows->catalogue,
                              list.items[d].text);
                mt_warning_copy(&k->told, &list.items[d]);
            }
        }
    }
    for (int j = i; j < i + rows->n; j++) {
        k->x[j] = k->c->study->variables[j].original;
    }
}

/* Reset variables that the fault does not need to their original values. */
static void reset_unneeded_variables(corners *k, mt_addr addr)
{
    for (int i = 0; i < k->n && k->rc == MT_OK; i++) {
        mt_warning_list list = mt_warning_list_default(&k->mem);
        const double had = k->x[i];
        if (k->c->study->variables[i].rows != NULL) {
            continue; /* the rest of its row would be of no design */
        }
        k->x[i] = k->c->study->variables[i].original;
        if (is_allowed(k)) {
            lint_corner(k, &list);
        }
        k->x[i] = fault_at(&list, addr) != NULL ? k->x[i] : had;
    }
}

static void report_corner(corners *k, const mt_warning *fault)
{
    const mt_study *const s = k->c->study;
    const char *where = "";
    mt_addr addr = MT_NO_ADDR;
    reset_unneeded_variables(k, fault->addr);
    for (int i = 0; i < k->n && where != NULL; i++) {
        const mt_variable *const v = &s->variables[i];
        if (k->x[i] != v->original) {
            where = mt_arena_printf(&k->mem, "%s%s%s at %g%s%s", where,
                                    where[0] == '\0' ? "" : " and ", v->parameter_name.s,
                                    mt_unit_from_si(v->shown, k->x[i]),
                                    v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""));
            addr = addr == MT_NO_ADDR ? v->addr : addr;
        }
    }
    if (where == NULL) {
        k->rc = MT_E_MEMORY;
        return;
    }
    const char *const text = mt_arena_printf(
        &k->c->study->mem,
        "with %s, %s: add a goal of type \"limit\" that keeps the search away from there",
        where, fault->text);
    mt_check_warn_result(k->c, text);
    mt_diag_warning(k->c->diags, addr, "%s", text == NULL ? "" : text);
    mt_warning_copy(&k->told, fault);
}

static void go_to_corner(corners *k, unsigned which)
{
    const mt_study *const s = k->c->study;
    for (int i = 0; i < k->n; i++) {
        const mt_variable *const v = &s->variables[i];
        const mt_catalogue_rows *const rows = v->rows;
        const int bit = i - (rows == NULL ? 0 : v->column); /* the same for all of a row */
        const bool upper =
            k->n <= MOST_ENUMERATED ? (which >> (unsigned)bit & 1U) != 0U : which != 0U;
        k->x[i] = rows != NULL
                      ? rows->value[((upper ? rows->n_rows - 1 : 0) * rows->n) + v->column]
                  : upper ? v->upper
                          : v->lower;
    }
}

static void one_corner(corners *k, unsigned which)
{
    mt_warning_list list = mt_warning_list_default(&k->mem);
    go_to_corner(k, which);
    if (is_allowed(k)) {
        lint_corner(k, &list);
    }
    for (int d = 0; d < list.n && k->rc == MT_OK && mt_diag_has_room(k->c->diags); d++) {
        if (list.items[d].level == MT_LEVEL_FAULT &&
            fault_at(&k->told, list.items[d].addr) == NULL) {
            go_to_corner(k, which);
            report_corner(k, &list.items[d]);
        }
    }
}

static void look_at_all(corners *k)
{
    const mt_study *const s = k->c->study;
    const unsigned n_corners = k->n <= MOST_ENUMERATED ? 1U << (unsigned)k->n : 2U;
    for (int i = 0; i < k->n; i++) {
        k->inputs[i] = s->variables[i].parameter;
        k->x[i] = s->variables[i].original;
    }
    k->rc = compile_corner_numbers(k);
    for (int i = 0; i < k->n && k->rc == MT_OK; i++) {
        const mt_variable *const v = &s->variables[i];
        if (v->rows == NULL) {
            one_variable(k, i, false);
            one_variable(k, i, true);
        } else if (v->column == 0) {
            every_row(k, i);
        }
    }
    for (unsigned w = 0; k->n > 1 && w < n_corners && k->rc == MT_OK; w++) {
        one_corner(k, w);
    }
    k->rc = mt_arena_failed(&k->mem) ? MT_E_MEMORY : k->rc;
}

static void check_corners(mt_study_check *c)
{
    const mt_model *const m = c->model;
    const size_t n = (size_t)c->study->n_variables;
    corners k = {.c = c, .n = c->study->n_variables};
    if (n == 0) {
        return;
    }
    if (mt_arena_init(&k.mem, 0, NULL) != MT_OK) {
        mt_arena_fail(&c->study->mem);
        return;
    }
    if (count_work(&k) > MOST_WORK) {
        mt_diag_error(c->diags, c->study->variables[0].addr,
                      "%d variables are too many for a model of %d numbers in so many "
                      "configurations and limits: every bound is checked with all of them",
                      k.n, m->n_nums);
        mt_arena_free(&k.mem);
        return;
    }
    k.told = mt_warning_list_default(&k.mem);
    k.inputs = mt_arena_int(&k.mem, n);
    k.x = mt_arena_f64(&k.mem, n, 1);
    k.value = mt_arena_f64(&k.mem, (size_t)m->n_nums, 1);
    k.rc = mt_arena_check(&k.mem, NULL);
    if (k.rc == MT_OK) {
        look_at_all(&k);
    }
    if (k.rc != MT_OK) {
        mt_arena_fail(&c->study->mem);
    }
    mt_arena_free(&k.mem);
}

/* Redundant joints */

/* Names configuration c's variables that break a redundancy; each variable once over all
 * configurations. */
static mt_status report_broken_redundancies(mt_study_check *c, mt_linear *lin, bool *told,
                                            mt_err *err)
{
    const mt_study *const s = c->study;
    for (int i = 0; i < s->n_variables; i++) {
        mt_independence what;
        if (told[i]) {
            continue;
        }
        MT_TRY(mt_linear_independence(lin, i, &c->study->mem, &what, err));
        told[i] = what.opens || what.blocks;
        if (told[i]) {
            mt_diag_error(
                c->diags, s->variables[i].addr,
                what.opens
                    ? "\"%s\" cannot vary alone: with any other value than %g, joints %s "
                      "do not close in configuration \"%s\", where equations of theirs "
                      "are redundant; make the other lengths depend on it, or give the "
                      "joints the freedom that they need"
                    : "\"%s\" cannot vary: only at %g are equations of joints %s "
                      "redundant in configuration \"%s\"; with any other value they "
                      "block a motion, and its frequency is gone at once; give the joints "
                      "the freedom that they need",
                c->model->parameters[s->variables[i].parameter].name.s,
                mt_unit_from_si(s->variables[i].shown, s->variables[i].original),
                what.joints.text,
                c->model->configurations[mt_linear_system(lin)->configuration].name.s);
        }
    }
    return MT_OK;
}

/* Check one configuration for redundancies. Failures are ignored: they occur again, with their
 * reason, when the study is solved. */
static mt_status check_configuration_redundancies(mt_study_check *c, int configuration,
                                                  const int *inputs, const double *at,
                                                  bool *told, mt_err *err)
{
    mt_system *sys = NULL;
    mt_linear *lin = NULL;
    mt_status rc =
        mt_system_new(c->model, configuration, c->study->n_variables, inputs, at, &sys, err);
    if (rc == MT_OK && !sys->geometry_fixed) {
        rc = mt_linear_new(sys, &lin, err);
        rc = rc == MT_OK ? mt_linear_update(lin, at, false, err) : rc;
        if (rc == MT_OK && mt_linear_redundant(lin) > 0) {
            rc = mt_linear_update(lin, at, true, err);
            rc = rc == MT_OK ? report_broken_redundancies(c, lin, told, err) : rc;
        }
    }
    mt_linear_delete(lin);
    mt_system_delete(sys);
    return rc;
}

static mt_status check_redundancies(mt_study_check *c, mt_arena *mem)
{
    const mt_study *const s = c->study;
    const size_t n = (size_t)s->n_variables;
    MT_TRY(mt_arena_init(mem, 0, NULL));
    int *const inputs = mt_arena_int(mem, n);
    double *const at = mt_arena_f64(mem, n, 1);
    bool *const told = mt_arena_alloc(mem, n, sizeof *told);
    MT_TRY(mt_arena_check(mem, NULL));
    for (size_t i = 0; i < n; i++) {
        inputs[i] = s->variables[i].parameter;
        at[i] = s->variables[i].original;
    }
    for (int i = 0; i < c->model->n_configurations; i++) {
        if (mt_study_asks(s, i) &&
            check_configuration_redundancies(c, i, inputs, at, told, NULL) == MT_E_MEMORY) {
            return MT_E_MEMORY;
        }
    }
    return MT_OK;
}

static void check_redundant(mt_study_check *c)
{
    mt_arena mem = {0};
    if (c->study->n_variables > 0 && check_redundancies(c, &mem) == MT_E_MEMORY) {
        mt_arena_fail(&c->study->mem);
    }
    mt_arena_free(&mem);
}

void mt_study_check_bounds(mt_study_check *c)
{
    fill_counted(c);
    check_conditions(c);
    if (c->diags->errors == 0 && !mt_arena_failed(&c->study->mem)) {
        check_corners(c);
    }
    if (c->diags->errors == 0 && !mt_arena_failed(&c->study->mem)) {
        check_redundant(c);
    }
}
