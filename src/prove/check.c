/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conditions under which bounds of the coefficients bound the modes, as far as the system's
 * structure shows them. */
#include "prove/check.h"

#include "base/format.h"
#include "prove/shaping.h"

static bool write_refusal(char *reason, const char *what, const char *name, const char *does)
{
    (void)mt_snprintf(reason, MT_REASON_SIZE, "%s \"%s\" %s", what, name, does);
    return false;
}

static bool loads_refused(const mt_system *sys, char *reason)
{
    if (!sys->loaded) {
        return true;
    }
    for (int i = 0; i < sys->n_springs && sys->n_loads == 0; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && (s->free != MT_NO_NODE || s->preload != MT_NO_NODE)) {
            return write_refusal(reason, "spring", s->name, "is preloaded");
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        if (sys->loads[i].name != NULL) {
            return write_refusal(reason, "load", sys->loads[i].name, "acts on the mechanism");
        }
    }
    (void)mt_snprintf(reason, MT_REASON_SIZE, "gravity loads the mechanism");
    return false;
}

/* True where the analysis was last solved at this value of the input. */
static bool stands_at(const mt_analysis *a, int input, double value)
{
    const mt_program *const p = &a->sys->program;
    for (int i = 0; i < p->count; i++) {
        if (p->nodes[i].op == MT_OP_PARAM && p->nodes[i].input == input) {
            return mt_linear_value(a->lin, i) == value;
        }
    }
    return false;
}

bool mt_enclosure_admits(const mt_analysis *a, const double *lower, const double *upper,
                         bool *frozen, char *reason)
{
    const mt_system *const sys = a->sys;
    if (!loads_refused(sys, reason)) {
        return false;
    }
    if (mt_linear_reduced(a->lin).loaded) {
        (void)mt_snprintf(reason, MT_REASON_SIZE,
                          "a driven joint or an equilibrium places the mechanism");
        return false;
    }
    mt_enclosure_shaping(a, frozen);
    for (int i = 0; i < sys->n_inputs; i++) {
        const bool fixed = lower[i] == upper[i] && stands_at(a, i, lower[i]);
        if (frozen[i] && !fixed) {
            return write_refusal(reason, "parameter",
                                 sys->model->parameters[sys->inputs[i]].name.s,
                                 "shapes the geometry");
        }
    }
    return true;
}
