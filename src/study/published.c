/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Published values that a study is held against. */
#include "study/published.h"

#include <math.h>

#include "study/check.h"
#include "study/reader.h"

/* Names */

/* a study that was interrupted says nothing that could be published */
#define STATUS_NAME(id, name) name,
const char *const mt_study_status_names[] = {MT_RESULT_STATUS_LIST(STATUS_NAME)};

#define NAME_CASE(id, name) \
    case id:                \
        return name;

const char *mt_role_name(mt_role role)
{
    switch (role) {
        MT_ROLE_LIST(NAME_CASE)
    case MT_ROLE_COUNT:
        break;
    }
    return "unknown";
}

const char *mt_published_kind_name(mt_published_kind kind)
{
    switch (kind) {
        MT_PUBLISHED_LIST(NAME_CASE)
    case MT_PUBLISHED_KIND_COUNT:
        break;
    }
    return "unknown";
}

/* Reading */

#define THIS mt_published
#define PUBLISHED_MODE_ROWS                                        \
    MT_M_REF("configuration", false, configuration_name,           \
             "Configuration of the model. Absent: its only one."), \
        MT_S_MODE("mode", mode, "Which mode: index from 1 or name.")
static const mt_key FREQUENCY[] = {PUBLISHED_MODE_ROWS};
static const mt_key MAC[] = {
    PUBLISHED_MODE_ROWS,
    MT_M_REF("reference", true, reference_name, "Name of one of the study's references."),
    MT_S_INDEX("reference_mode", reference_mode,
               "Mode of the reference. Absent: the same index as \"mode\"."),
};
const mt_key_table mt_study_published_frequency_keys = {
    .what = "published_frequency",
    .keys = FREQUENCY,
    .n = MT_COUNT(FREQUENCY),
    .says = "Which natural frequency was published."};
const mt_key_table mt_study_published_mac_keys = {.what = "published_mac",
                                                  .keys = MAC,
                                                  .n = MT_COUNT(MAC),
                                                  .says = "Which MAC was published."};

static const char *const DESIGNS[] = {"recommended", "original"};
static const char *const ROLES[] = {
#define ROLE(id, name) name,
    MT_ROLE_LIST(ROLE)
#undef ROLE
};

/* The first five say what is published, in the order of mt_published_kind. */
static const mt_key PUBLISHED[] = {
    MT_M_REF("parameter", false, parameter_name, "Name of a parameter."),
    MT_S_EXPR("quantity", false, quantity, quantity_text,
              "Expression of parameters, evaluated at the design.",
              .examples = "[\"(K_T1+K_T8)/2\"]"),
    MT_M_INNER("frequency", mt_study_published_frequency_keys),
    MT_M_INNER("mac", mt_study_published_mac_keys),
    {.name = "status",
     .type = MT_KEY_TEXT,
     .choices = mt_study_status_names,
     .n_choices = MT_STUDY_STATUSES,
     .says = "The status that the study must end with."},
    MT_S_VALUE("value", false, value, parameter_name, ANY,
               "The published value: the parameter's unit, Hz, or none for a MAC. Needs a "
               "tolerance, or a limit, which then decides."),
    MT_S_VALUE("at_least", false, at_least, parameter_name, LIMIT,
               "The computed value must not be below this."),
    MT_S_VALUE("at_most", false, at_most, parameter_name, LIMIT,
               "The computed value must not be above this."),
    MT_S_VALUE("tolerance", false, tolerance, parameter_name, POSITIVE,
               "Greatest difference, in the unit of the value."),
    MT_S_NUMBER("tolerance_percent", false, tolerance_percent, POSITIVE,
                "Greatest difference, in percent of the value."),
    {.name = "design",
     .type = MT_KEY_TEXT,
     .choices = DESIGNS,
     .n_choices = MT_COUNT(DESIGNS),
     .says = "The design that is judged.",
     .otherwise = "\"recommended\""},
    MT_M_CHOICE("role", false, role, mt_role, "role", ROLES,
                "\"calibrates\": the model was adjusted to it; \"verifies\": held back; "
                "\"not_comparable\": shown, not judged.",
                .otherwise = "\"verifies\""),
    MT_M_TEXT("label", label, "Its name in tables. Absent: made from the other members."),
    MT_M_DESCRIPTION,
    MT_M_TEXT("source", source, "Where it comes from: a table, a page, a test report."),
};
#undef THIS

static void published_defaults(void *item, mt_addr addr, int which)
{
    const mt_published_kind kind =
        which == MT_ABSENT ? MT_PUBLISHED_STATUS : (mt_published_kind)which;
    *(mt_published *)item = (mt_published){
        .kind = kind,
        .parameter = MT_ABSENT,
        .configuration = MT_ABSENT,
        .mode = {.named = MT_ABSENT},
        .reference = MT_ABSENT,
        .value = nan(""),
        .tolerance = nan(""),
        .tolerance_percent = nan(""),
        .at_least = nan(""),
        .at_most = nan(""),
        .role = MT_ROLE_VERIFIES,
        .addr = addr,
    };
}

static void published_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    static const char *const compared[] = {"value", "at_least", "at_most", "tolerance"};
    mt_published *const p = item;
    const int status = mt_reader_choice(r, mt_object_value(o, "status"), "status",
                                        mt_study_status_names, MT_STUDY_STATUSES);
    (void)which;
    p->status = status == MT_ABSENT ? NULL : mt_study_status_names[status];
    p->original = mt_reader_choice(r, mt_object_value(o, "design"), "design", DESIGNS,
                                   MT_COUNT(DESIGNS)) == 1;
    for (int i = 0; i < MT_COUNT(compared); i++) {
        mt_read_study_check_requirement(mt_study_reader_of(r), &p->quantity,
                                        mt_object_value(o, compared[i]));
    }
}

const mt_key_table mt_study_published_keys = {
    .what = "published",
    .keys = PUBLISHED,
    .n = MT_COUNT(PUBLISHED),
    .one_of = 5,
    .size = sizeof(mt_published),
    .defaults = published_defaults,
    .finish = published_finish,
    .says = "A published number to compare with: a parameter, a quantity, a frequency, a MAC, "
            "or the study's status."};

/* Checks */

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
