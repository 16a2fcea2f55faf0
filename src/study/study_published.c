/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_priv.h"

/* Check the criterion of a published value: a tolerance, absolute or relative, or limits; a
 * value that is not comparable needs none. Limits need no value: beside them it is only
 * shown. */
static void check_judgement(mt_study_check *c, const mt_published *p)
{
    const bool absolute = mt_check_given(c, p->tolerance, p->addr, "tolerance");
    const bool relative = mt_check_given(c, p->tolerance_percent, p->addr, "tolerance_percent");
    const bool value = mt_check_given(c, p->value, p->addr, "value");
    const bool limits = MT_HAS(p->at_least) || MT_HAS(p->at_most);
    if (!value && !limits) {
        mt_diag_error(c->diags, p->addr, "give \"value\", \"at_least\" or \"at_most\"");
    } else if (limits && (absolute || relative)) {
        mt_diag_error(
            c->diags,
            mt_diag_member(c->diags, p->addr, absolute ? "tolerance" : "tolerance_percent"),
            "a tolerance excludes limits");
    } else if (absolute && relative) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, p->addr, "tolerance_percent"),
                      "\"tolerance_percent\" excludes \"tolerance\"");
    } else if (!limits && !absolute && !relative && p->role != MT_ROLE_NOT_COMPARABLE) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, p->addr, "value"),
                      "\"value\" needs \"tolerance\", \"tolerance_percent\" or a limit");
    }
    if (p->at_least > p->at_most) {
        mt_diag_error(c->diags, p->addr, "at_most (%g) is below at_least (%g)", p->at_most,
                      p->at_least);
    }
}

static void check_status(mt_study_check *c, const mt_published *p)
{
    const bool judged = mt_check_given(c, p->value, p->addr, "value") || MT_HAS(p->at_least) ||
                        MT_HAS(p->at_most) || MT_HAS(p->tolerance) ||
                        MT_HAS(p->tolerance_percent);
    if (judged) {
        mt_diag_error(c->diags, p->addr, "a published status has no value, limit or tolerance");
    }
    if (p->original) {
        mt_diag_error(c->diags, p->addr, "a published status belongs to no design");
    }
}

static void check_mode(mt_study_check *c, mt_published *p)
{
    p->configuration = p->configuration_name.s != NULL
                           ? mt_check_configuration(c, c->model, p->configuration_name)
                           : mt_check_only_configuration(c, c->model, p->addr);
    const int index = mt_check_mode(c, &p->mode);
    if (p->kind == MT_PUBLISHED_MAC) {
        p->reference = mt_check_reference(c, p->reference_name);
        mt_check_reference_mode(c, p->reference, p->reference_mode, index, true, p->addr);
        mt_check_common_sensors(c, p->reference, p->reference_name.addr);
    }
}

void mt_study_check_published(mt_study_check *c)
{
    for (int i = 0; i < c->study->n_published; i++) {
        mt_published *const p = &c->study->published[i];
        p->parameter = mt_check_parameter(c, p->parameter_name);
        if (p->kind == MT_PUBLISHED_FREQUENCY || p->kind == MT_PUBLISHED_MAC) {
            check_mode(c, p);
        }
        if (p->kind == MT_PUBLISHED_STATUS) {
            check_status(c, p);
        } else {
            check_judgement(c, p);
        }
    }
}
