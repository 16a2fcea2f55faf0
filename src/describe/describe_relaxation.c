/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moves that let a design exist, as records and sentences. */
#include "describe/describe_relaxation.h"

#include <math.h>
#include <string.h>

#include "problem/configuration.h"

static const double PERCENT = 100.0;
/* Sentences of more moves than that do not help. */
enum { MOST = 8 };

static void name_goal(const mt_problem *p, const mt_move *m, mt_arena *mem, mt_relaxation *out)
{
    const mt_requirement *const d = &p->requirements[m->requirement];
    const mt_goal_kind *const kind = mt_goal_kind_of(d->goal->type);
    const mt_goal_slot slot = m->target  ? MT_SLOT_EQUALS
                              : m->upper ? MT_SLOT_AT_MOST
                                         : MT_SLOT_AT_LEAST;
    const char *const member = mt_goal_member_name(kind, slot);
    out->kind = "goal";
    out->pointer = mt_arena_printf(mem, "/goals/%d", d->goal_index);
    const char *const unit = mt_study_goal_unit(p->study, d->goal);
    const mt_unit *const shown = mt_study_requirement_unit(p->study, &d->goal->expression);
    out->unit = unit[0] != '\0' ? unit : NULL;
    out->display_unit = mt_unit_name(shown, NULL);
    out->display_factor = mt_unit_display(shown);
    out->what = d->view < 0
                    ? mt_arena_printf(mem, "%s of goal %s", member, out->pointer)
                    : mt_arena_printf(mem, "%s of goal %s (\"%s\")", member, out->pointer,
                                      mt_configuration_name(p, &p->views[d->view]));
}

static void name_edge(const mt_problem *p, const mt_move *m, mt_arena *mem, mt_relaxation *out)
{
    const mt_avoidance *const c = &p->avoidances[m->avoidance];
    const mt_band *const band = &c->bands.items[m->band];
    const bool margin =
        band->lower_hz != band->base_lower_hz || band->upper_hz != band->base_upper_hz;
    out->kind = "band";
    out->pointer = mt_arena_printf(mem, "/goals/%d", c->goal_index);
    out->unit = "Hz";
    out->what = mt_arena_printf(mem, "%s edge of the band \"%s\"%s in \"%s\"",
                                m->upper ? "upper" : "lower", band->label,
                                margin ? " (with its margin)" : "",
                                mt_configuration_name(p, &p->views[c->view]));
}

static void name_bound(const mt_problem *p, const mt_move *m, mt_arena *mem, mt_relaxation *out)
{
    const mt_variable *const v = &p->study->variables[m->variable];
    out->kind = "bound";
    out->pointer = mt_arena_printf(mem, "/variables/%d", m->variable);
    out->unit = p->study->model->parameters[v->parameter].unit;
    out->display_unit = mt_unit_name(v->shown, NULL);
    out->display_factor = mt_unit_display(v->shown);
    out->what = mt_arena_printf(mem, "%s bound of %s", m->upper ? "upper" : "lower",
                                v->parameter_name.s);
}

/* "k1 = 12.3, k2 = 4" */
static const char *design_text(const mt_problem *p, const double *x, mt_arena *mem)
{
    const char *text = "";
    for (int i = 0; i < p->n; i++) {
        const mt_variable *const v = &p->study->variables[i];
        text = mt_arena_printf(mem, "%s%s%s = %.6g%s%s", text, i > 0 ? ", " : "",
                               v->parameter_name.s, mt_unit_from_si(v->shown, x[i]),
                               v->shown == NULL ? "" : " ", mt_unit_name(v->shown, ""));
    }
    return text;
}

static mt_status describe_move(const mt_problem *p, const mt_move *m, mt_arena *mem,
                               mt_relaxation *out, mt_err *err)
{
    *out = (mt_relaxation){.from = m->from, .to = m->to, .display_factor = nan("")};
    out->change_percent =
        fabs(m->from) > 0.0 ? PERCENT * (m->to - m->from) / fabs(m->from) : nan("");
    switch (m->kind) {
    case MT_MOVE_BOUND:
        name_bound(p, m, mem, out);
        break;
    case MT_MOVE_EDGE:
        name_edge(p, m, mem, out);
        break;
    case MT_MOVE_GOAL:
        name_goal(p, m, mem, out);
        break;
    }
    out->design = mt_arena_f64(mem, (size_t)p->n, 1);
    const char *const design = design_text(p, m->x, mem);
    const char *const unit = out->display_unit != NULL ? out->display_unit : out->unit;
    const double factor = out->display_unit != NULL ? out->display_factor : 1.0;
    MT_TRY(mt_arena_check(mem, err));
    memcpy(out->design, m->x, (size_t)p->n * sizeof *out->design);
    const char *const percent =
        fabs(m->from) > 0.0 ? mt_arena_printf(mem, " (%+.3g %%)", out->change_percent) : "";
    out->text =
        mt_arena_printf(mem,
                        "Changing the %s from %.6g to %.6g%s%s%s, and nothing else, lets a "
                        "design meet all goals: %s.",
                        out->what, m->from / factor, m->to / factor, unit != NULL ? " " : "",
                        unit != NULL ? unit : "", percent, design);
    return mt_arena_check(mem, err);
}

mt_status mt_describe_relaxations(const mt_problem *p, const mt_moves *moves, mt_result *result,
                                  mt_err *err)
{
    const int n = moves->n < MOST ? moves->n : MOST;
    result->relaxations = mt_arena_alloc(&result->mem, (size_t)n, sizeof *result->relaxations);
    MT_TRY(mt_arena_check(&result->mem, err));
    for (int i = 0; i < n; i++) {
        MT_TRY(describe_move(p, &moves->items[i], &result->mem, &result->relaxations[i], err));
        result->n_relaxations = i + 1;
    }
    return MT_OK;
}
