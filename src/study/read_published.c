/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

/* The first five say what is published, in the order of mt_published_kind. */
#define PUBLISHED_KEYS(X)                                                               \
    X(PUBLISHED_PARAMETER, "parameter", MT_KEY_TEXT, false)                             \
    X(PUBLISHED_QUANTITY, "quantity", MT_KEY_TEXT, false)                               \
    X(PUBLISHED_FREQUENCY, "frequency", MT_KEY_OBJECT, false)                           \
    X(PUBLISHED_MAC, "mac", MT_KEY_OBJECT, false)                                       \
    X(PUBLISHED_STATUS, "status", MT_KEY_TEXT, false)                                   \
    X(PUBLISHED_VALUE, "value", MT_KEY_NUMBER, false, ANY)                              \
    X(PUBLISHED_AT_LEAST, "at_least", MT_KEY_NUMBER, false, LIMIT)                      \
    X(PUBLISHED_AT_MOST, "at_most", MT_KEY_NUMBER, false, LIMIT)                        \
    X(PUBLISHED_TOLERANCE, "tolerance", MT_KEY_NUMBER, false, POSITIVE)                 \
    X(PUBLISHED_TOLERANCE_PERCENT, "tolerance_percent", MT_KEY_NUMBER, false, POSITIVE) \
    X(PUBLISHED_DESIGN, "design", MT_KEY_TEXT, false)                                   \
    X(PUBLISHED_ROLE, "role", MT_KEY_TEXT, false)                                       \
    X(PUBLISHED_LABEL, "label", MT_KEY_TEXT, false)                                     \
    X(PUBLISHED_DESCRIPTION, "description", MT_KEY_TEXT, false)                         \
    X(PUBLISHED_SOURCE, "source", MT_KEY_TEXT, false)
enum { PUBLISHED_KEYS(MT_STUDY_KEY_ENUM) PUBLISHED_KEY_COUNT };
static const mt_key KEYS[] = {PUBLISHED_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_published_keys = {"published", KEYS, PUBLISHED_KEY_COUNT};

/* A published frequency's keys are the first ones of a MAC's. */
#define MODE_KEYS(X)                                           \
    X(MODE_CONFIGURATION, "configuration", MT_KEY_TEXT, false) \
    X(MODE_MODE, "mode", MT_KEY_TEXT_OR_COUNT, true, WHOLE)
#define MAC_KEYS(X)                                  \
    MODE_KEYS(X)                                     \
    X(MAC_REFERENCE, "reference", MT_KEY_TEXT, true) \
    X(MAC_REFERENCE_MODE, "reference_mode", MT_KEY_COUNT, false, WHOLE)
enum { MAC_KEYS(MT_STUDY_KEY_ENUM) MAC_KEY_COUNT };
static const mt_key MODE[] = {MODE_KEYS(MT_STUDY_KEY)};
static const mt_key MAC[] = {MAC_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_published_frequency_keys = {"published_frequency", MODE,
                                                        MT_COUNT(MODE)};
const mt_key_table mt_study_published_mac_keys = {"published_mac", MAC, MT_COUNT(MAC)};

static void read_mode(mt_study_reader *s, mt_addr value, bool mac, mt_published *p)
{
    const mt_key_table *const table =
        mac ? &mt_study_published_mac_keys : &mt_study_published_frequency_keys;
    mt_study_object o;
    if (value == MT_NO_ADDR || !mt_read_study_object(s, value, table, &o)) {
        return;
    }
    p->configuration_name = mt_reader_ref(&s->r, o.found[MODE_CONFIGURATION]);
    p->mode = mt_read_study_mode(s, &o, MODE_MODE);
    if (mac) {
        p->reference_name = mt_reader_ref(&s->r, o.found[MAC_REFERENCE]);
        p->reference_mode = mt_read_study_index(s, o.found[MAC_REFERENCE_MODE]);
    }
}

/* Read the published quantity. */
static void read_subject(mt_study_reader *s, const mt_study_object *o, mt_published *p)
{
    int n = 0;
    const char *const *const statuses = mt_study_statuses(&n);
    p->parameter_name = mt_reader_ref(&s->r, o->found[PUBLISHED_PARAMETER]);
    mt_read_study_expr(s, o->found[PUBLISHED_QUANTITY], &p->quantity, &p->quantity_text);
    read_mode(s, o->found[PUBLISHED_FREQUENCY], false, p);
    read_mode(s, o->found[PUBLISHED_MAC], true, p);
    const int status =
        mt_reader_choice(&s->r, o->found[PUBLISHED_STATUS], "status", statuses, n);
    p->status = status == MT_ABSENT ? NULL : statuses[status];
}

/* The number published and how it is to be judged. */
static void read_judgement(mt_study_reader *s, const mt_study_object *o, mt_published *p)
{
    static const char *const designs[] = {"recommended", "original"};
    const char *roles[MT_ROLE_COUNT];
    for (int i = 0; i < MT_ROLE_COUNT; i++) {
        roles[i] = mt_role_name((mt_role)i);
    }
    const char *const name = p->parameter_name.s; /* NULL: of something else */
    p->value = mt_read_study_value(s, o->found[PUBLISHED_VALUE], name);
    p->at_least = mt_read_study_value(s, o->found[PUBLISHED_AT_LEAST], name);
    p->at_most = mt_read_study_value(s, o->found[PUBLISHED_AT_MOST], name);
    p->tolerance = mt_read_study_value(s, o->found[PUBLISHED_TOLERANCE], name);
    for (int key = PUBLISHED_VALUE; key <= PUBLISHED_TOLERANCE; key++) {
        mt_read_study_check_requirement(s, &p->quantity, o->found[key]);
    }
    p->tolerance_percent = mt_read_study_number(s, o->found[PUBLISHED_TOLERANCE_PERCENT]);
    const int role =
        mt_reader_choice(&s->r, o->found[PUBLISHED_ROLE], "role", roles, MT_ROLE_COUNT);
    p->role = role == MT_ABSENT ? p->role : (mt_role)role;
    p->original = mt_reader_choice(&s->r, o->found[PUBLISHED_DESIGN], "design", designs,
                                   MT_COUNT(designs)) == 1;
}

static bool read_published(mt_study_reader *s, mt_addr value, mt_published *p)
{
    mt_study_object o;
    if (!mt_read_study_object(s, value, &mt_study_published_keys, &o)) {
        return false;
    }
    const int kind = mt_read_study_one_of(s, &o, PUBLISHED_PARAMETER, MT_PUBLISHED_KIND_COUNT);
    *p = mt_published_default(kind == MT_ABSENT ? MT_PUBLISHED_STATUS : (mt_published_kind)kind,
                              value);
    read_subject(s, &o, p);
    read_judgement(s, &o, p);
    p->label = mt_reader_text(&s->r, o.found[PUBLISHED_LABEL]);
    p->source = mt_reader_text(&s->r, o.found[PUBLISHED_SOURCE]);
    return kind != MT_ABSENT;
}

void mt_read_study_published(mt_study_reader *s, mt_addr list)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, list);
    study->published = mt_reader_room(&s->r, &items, sizeof *study->published);
    while (mt_items_next(&items)) {
        mt_published *const p = &study->published[study->n_published];
        study->n_published += read_published(s, items.at, p) ? 1 : 0;
    }
}
