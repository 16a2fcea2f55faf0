/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * "static": a number of the mechanism at rest (mechanics/statics.h), with r of a configuration
 *     q = r(own) - r(against),
 * r a displacement or a force at the equilibrium, the compliance C of a unit load there, or the
 * stiffness 1/C, whose slope is -dC / C^2. The slopes of equilibrium and multipliers are those
 * of the implicit function.
 */
#include <math.h>
#include <string.h>

#include "mechanics/statics.h"
#include "problem/configuration.h"
#include "problem/evaluate.h"
#include "problem/goals.h"
#include "problem/requirement.h"
#include "response/ports.h"

/* What is read of one configuration. */
typedef struct mt_rest_reading {
    int view;
    mt_static of; /* of a compliance: the sensor */
    int pushed;   /* channel of the unit load; -1: none */
} rest_reading;

/* The value of one configuration, and its slope over the inputs (NULL: not wanted). */
static mt_status read_rest(mt_analysis *a, const rest_reading *r, mt_static_quantity quantity,
                           double *value, double *slope, mt_err *err)
{
    if (r->pushed < 0) {
        MT_TRY(mt_static_value(a->lin, &r->of, value, err));
        return slope == NULL ? MT_OK : mt_static_slopes(a->lin, &r->of, slope, err);
    }
    if (a->modes.n_rigid > 0) {
        return mt_fail(err, MT_E_USAGE,
                       "something is free to move as a rigid body, so that no load at rest has "
                       "an answer of finite size");
    }
    if (a->modes.n_unstable + a->modes.n_undecided > 0) {
        return mt_fail(err, MT_E_DOMAIN, "the equilibrium is not stable");
    }
    MT_TRY(mt_static_compliance(a->lin, r->of.index, r->pushed, value, slope, err));
    if (quantity == MT_STATIC_COMPLIANCE) {
        return MT_OK;
    }
    const double c = *value;
    if (!(fabs(c) > 0.0)) {
        return mt_fail(err, MT_E_DOMAIN, "nothing gives way there: the stiffness is infinite");
    }
    *value = 1.0 / c;
    for (int k = 0; k < a->sys->n_inputs && slope != NULL; k++) {
        slope[k] = -slope[k] / (c * c);
    }
    return MT_OK;
}

/* A failure at the address of the member: `name` is unknown, or has no such number here. */
static mt_status at_member(const mt_requirement *d, const char *member, mt_status rc,
                           const mt_err *own, mt_err *err)
{
    return rc == MT_OK ? MT_OK
           : rc == MT_E_MEMORY
               ? mt_fail_memory(err)
               : mt_fail(err, MT_E_INPUT, "/goals/%d/%s: %s", d->goal_index, member, own->text);
}

/* Finds output and input of the goal in the configuration of a view. */
static mt_status find_ports(mt_problem *p, const mt_requirement *d, rest_reading *r,
                            mt_err *err)
{
    const mt_static_limit *const s = d->goal->static_limit;
    const mt_system *const sys = p->views[r->view].original->sys;
    mt_err own = {.code = MT_OK};
    mt_port port;
    MT_TRY(at_member(d, "output", mt_port_at_rest(sys, s->output.s, &p->mem, &port, &own), &own,
                     err));
    r->of = mt_port_static(&port);
    r->pushed = -1;
    if (s->input.s == NULL) {
        return MT_OK;
    }
    if (r->of.kind != MT_STATIC_SENSOR) {
        return mt_fail(
            err, MT_E_INPUT,
            "/goals/%d/output: under a unit load the output is the displacement of a "
            "sensor, not \"%s\"",
            d->goal_index, s->output.s);
    }
    MT_TRY(
        at_member(d, "input", mt_port_input(sys, s->input.s, &p->mem, &port, &own), &own, err));
    r->pushed = port.index;
    return port.kind == MT_PORT_SENSOR
               ? MT_OK
               : mt_fail(err, MT_E_INPUT,
                         "/goals/%d/input: \"%s\" is a motion of the ground: a unit load is a "
                         "force along the direction of a sensor",
                         d->goal_index, s->input.s);
}

/* Tries one reading at the original design: what is not determined by the structure is said,
 * what another design may have is left to the search. */
static mt_status try_reading(mt_problem *p, const mt_requirement *d, const rest_reading *r,
                             double *value, mt_err *err)
{
    mt_err own = {.code = MT_OK};
    const mt_status rc = read_rest(p->views[r->view].original, r,
                                   d->goal->static_limit->quantity, value, NULL, &own);
    if (rc == MT_E_USAGE) {
        return at_member(d, r->pushed < 0 ? "output" : "input", rc, &own, err);
    }
    return mt_pass_final(rc, &own, err);
}

/* A demand of 0 is met within parts of what there is at the original design. */
static mt_status compile_static(mt_problem *p, mt_requirement *d, mt_err *err)
{
    const mt_static_limit *const s = d->goal->static_limit;
    double value[2] = {0.0, 0.0};
    d->n_rest = s->against == MT_ABSENT ? 1 : 2;
    d->rest = mt_arena_alloc(&p->mem, (size_t)d->n_rest, sizeof *d->rest);
    MT_TRY(mt_arena_check(&p->mem, err));
    d->rest[0].view = d->view;
    if (d->n_rest > 1) {
        MT_TRY(mt_problem_add_configuration(p, s->against, &d->rest[1].view, err));
    }
    for (int i = 0; i < d->n_rest; i++) {
        MT_TRY(find_ports(p, d, &d->rest[i], err));
        MT_TRY(try_reading(p, d, &d->rest[i], &value[i], err));
    }
    const double size = fabs(value[0] - value[1]);
    d->size = size > 0.0 && isfinite(size) ? size : 1.0;
    return MT_OK;
}

/* Reads one configuration after its solve; the other one of a difference may not have been
 * solved with a gradient. */
static mt_status read_view(mt_workspace *w, const mt_requirement *d, const rest_reading *r,
                           double *value, double *slope, mt_err *err)
{
    mt_configuration_work *const view = &w->views[r->view];
    mt_err own = {.code = MT_OK};
    if (!view->solved || (slope != NULL && !view->analysis->with_gradient)) {
        MT_TRY(mt_configuration_solve(w, view, slope != NULL, err));
    }
    const mt_status rc =
        read_rest(view->analysis, r, d->goal->static_limit->quantity, value, slope, &own);
    return rc == MT_OK || mt_is_final(rc)
               ? mt_pass_final(rc, &own, err)
               : mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": %s",
                         mt_analysis_configuration(view->analysis), own.text);
}

static mt_status evaluate_static(mt_workspace *w, const mt_requirement *d, int pos, double *q,
                                 double *slope, mt_err *err)
{
    (void)pos;
    double other = 0.0;
    MT_TRY(read_view(w, d, &d->rest[0], q, slope, err));
    if (d->n_rest > 1) {
        MT_TRY(read_view(w, d, &d->rest[1], &other, slope == NULL ? NULL : w->work, err));
        *q -= other;
    }
    for (int k = 0; k < w->p->n && slope != NULL; k++) {
        const double moved = slope[k] - (d->n_rest > 1 ? w->work[k] : 0.0);
        slope[k] = moved * mt_workspace_dx_dt(w, k);
    }
    return MT_OK;
}

/* "static displacement of grip.z", "static moment of joint.pivot.rx". */
static const char *about(const mt_requirement *d, mt_arena *mem)
{
    static const char *const quantities[] = {"compliance", "stiffness"};
    const mt_static_limit *const s = d->goal->static_limit;
    if (s->input.s != NULL) {
        return mt_arena_printf(mem, "static %s of %s to %s", quantities[s->quantity],
                               s->output.s, s->input.s);
    }
    const bool moves = d->rest[0].of.kind == MT_STATIC_SENSOR;
    const bool turns = strcmp(s->unit, moves ? "rad" : "N m") == 0;
    return mt_arena_printf(mem, "static %s of %s",
                           moves ? (turns ? "rotation" : "displacement")
                                 : (turns ? "moment" : "force"),
                           s->output.s);
}

static const char *static_subject(const mt_requirement *d, const char *what, mt_arena *mem)
{
    const mt_static_limit *const s = d->goal->static_limit;
    const char *const number = about(d, mem);
    return number == NULL ? NULL
           : s->against_name.s == NULL
               ? mt_arena_printf(mem, "%s: %s", what, number)
               : mt_arena_printf(mem, "%s: %s against \"%s\"", what, number, s->against_name.s);
}

const mt_goal_ops mt_goal_static = {.quantity = MT_QUANTITY_OTHER,
                                    .compile = compile_static,
                                    .value = evaluate_static,
                                    .subject = static_subject,
                                    .equals = "at"};
