/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a configuration's own setting drops of the one that it would inherit: it takes the place
 * of the whole of the other. */
#include "model/lint_priv.h"

#include <stddef.h>

static void warn_of_dropped_member(mt_lint *j, mt_addr addr, const char *member,
                                   const char *text)
{
    (void)mt_lint_addr(
        j, mt_warning_add(j->out, MT_LEVEL_WARNING, "dropped", "%s", text == NULL ? "" : text),
        addr,
        mt_arena_printf(j->out->mem, "/configurations/%s/%s",
                        j->model->configurations[j->configuration].name.s, member));
}

/* The same joint, trimmed by the inherited drive and locked by the own one, which does not
 * mention the hold. */
static void lint_hold(mt_lint *j, const mt_drive *own, const mt_drive *other)
{
    if (own->given && !own->inherited && other->given && other->trim && !own->hold_given) {
        warn_of_dropped_member(
            j, own->addr, "drive",
            mt_arena_printf(j->out->mem,
                            "drops the inherited \"hold\", which trims \"%s\": this drive "
                            "locks \"%s\"; write \"hold\": \"lock\" if that is meant",
                            other->trim_name.s == NULL ? "" : other->trim_name.s,
                            own->joint_name.s == NULL ? "" : own->joint_name.s));
    }
}

static void lint_damping(mt_lint *j, const mt_damping *own, const mt_damping *other)
{
    const struct {
        bool dropped;
        const char *member;
    } members[] = {
        {other->ratio != MT_ABSENT && own->ratio == MT_ABSENT, "ratio"},
        {other->n_ratios > 0 && own->n_ratios == 0, "ratios"},
        {other->n_named > 0 && own->n_named == 0, "modes"},
        {other->mass != MT_ABSENT && own->mass == MT_ABSENT, "mass_per_s"},
        {other->stiffness != MT_ABSENT && own->stiffness == MT_ABSENT, "stiffness_s"},
    };
    const char *dropped = NULL;
    for (int i = 0; i < MT_COUNT(members) && own->given && !own->inherited; i++) {
        if (other->given && members[i].dropped) {
            dropped = mt_arena_printf(j->out->mem, "%s%s\"%s\"", dropped == NULL ? "" : dropped,
                                      dropped == NULL ? "" : ", ", members[i].member);
        }
    }
    if (dropped != NULL) {
        warn_of_dropped_member(
            j, own->addr, "damping",
            mt_arena_printf(j->out->mem,
                            "drops the inherited %s: a configuration's own damping takes the "
                            "place of all that it would inherit",
                            dropped));
    }
}

void mt_lint_inherited(mt_lint *j)
{
    const mt_configuration *const c = &j->model->configurations[j->configuration];
    const mt_configuration *const parent =
        c->like == MT_ABSENT ? NULL : &j->model->configurations[c->like];
    if (parent != NULL) {
        lint_hold(j, &c->drive, &parent->drive);
    }
    lint_damping(j, &c->damping, parent == NULL ? &j->model->damping : &parent->damping);
}
