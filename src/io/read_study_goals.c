/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "io/read_study_priv.h"

#include <string.h>

/* Each type of goal has a table of its own, which begins with what all have; limits have no
 * mode, bands none of their own. */
#define GOAL_KEYS(X)                                       \
    X(GOAL_TYPE, "type", MT_KEY_TEXT, true)                \
    X(GOAL_DESCRIPTION, "description", MT_KEY_TEXT, false) \
    X(GOAL_SOURCE, "source", MT_KEY_TEXT, false)           \
    X(GOAL_TOLERANCE, "tolerance_percent", MT_KEY_NUMBER, false)
#define PLACE_KEYS(X)                                          \
    GOAL_KEYS(X)                                               \
    X(GOAL_CONFIGURATION, "configuration", MT_KEY_TEXT, false) \
    X(GOAL_CONFIGURATIONS, "configurations", MT_KEY_LIST, false)
#define MODE_KEYS(X) \
    PLACE_KEYS(X)    \
    X(GOAL_MODE, "mode", MT_KEY_TEXT_OR_COUNT, true)
enum { MODE_KEYS(MT_STUDY_KEY_ENUM) GOAL_KEY_COUNT };

#define FREQUENCY_KEYS(X)                                              \
    X(FREQUENCY_TARGET, "target_hz", MT_KEY_NUMBER, false)             \
    X(FREQUENCY_REFERENCE, "reference", MT_KEY_TEXT, false)            \
    X(FREQUENCY_REFERENCE_MODE, "reference_mode", MT_KEY_COUNT, false) \
    X(FREQUENCY_AT_LEAST, "at_least_hz", MT_KEY_NUMBER, false)         \
    X(FREQUENCY_AT_MOST, "at_most_hz", MT_KEY_NUMBER, false)           \
    X(FREQUENCY_WEIGHT, "weight", MT_KEY_NUMBER, false)
enum { FREQUENCY_BASE = GOAL_KEY_COUNT - 1, FREQUENCY_KEYS(MT_STUDY_KEY_ENUM) FREQUENCY_COUNT };
static const mt_key FREQUENCY[] = {MODE_KEYS(MT_STUDY_KEY) FREQUENCY_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_frequency_keys = {"goal_frequency", FREQUENCY, FREQUENCY_COUNT};

#define SHAPE_KEYS(X)                                              \
    X(SHAPE_REFERENCE, "reference", MT_KEY_TEXT, true)             \
    X(SHAPE_REFERENCE_MODE, "reference_mode", MT_KEY_COUNT, false) \
    X(SHAPE_WEIGHT, "weight", MT_KEY_NUMBER, true)
enum { SHAPE_BASE = GOAL_KEY_COUNT - 1, SHAPE_KEYS(MT_STUDY_KEY_ENUM) SHAPE_COUNT };
static const mt_key SHAPE[] = {MODE_KEYS(MT_STUDY_KEY) SHAPE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_shape_keys = {"goal_shape", SHAPE, SHAPE_COUNT};

#define MAC_KEYS(X)                                              \
    X(MAC_REFERENCE, "reference", MT_KEY_TEXT, true)             \
    X(MAC_REFERENCE_MODE, "reference_mode", MT_KEY_COUNT, false) \
    X(MAC_AT_LEAST, "at_least", MT_KEY_NUMBER, true)
enum { MAC_BASE = GOAL_KEY_COUNT - 1, MAC_KEYS(MT_STUDY_KEY_ENUM) MAC_COUNT };
static const mt_key MAC[] = {MODE_KEYS(MT_STUDY_KEY) MAC_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_mac_keys = {"goal_mac", MAC, MAC_COUNT};

#define LIMIT_KEYS(X)                                    \
    X(LIMIT_EXPRESSION, "expression", MT_KEY_TEXT, true) \
    X(LIMIT_AT_LEAST, "at_least", MT_KEY_NUMBER, false)  \
    X(LIMIT_AT_MOST, "at_most", MT_KEY_NUMBER, false)    \
    X(LIMIT_EQUALS, "equals", MT_KEY_NUMBER, false)
enum { LIMIT_BASE = GOAL_CONFIGURATION - 1, LIMIT_KEYS(MT_STUDY_KEY_ENUM) LIMIT_COUNT };
static const mt_key LIMIT[] = {GOAL_KEYS(MT_STUDY_KEY) LIMIT_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_limit_keys = {"goal_limit", LIMIT, LIMIT_COUNT};

#define AVOID_KEYS(X)                                       \
    X(AVOID_BANDS, "bands_hz", MT_KEY_LIST, false)          \
    X(AVOID_ROTOR, "rotor", MT_KEY_OBJECT, false)           \
    X(AVOID_ROTORS, "rotors", MT_KEY_LIST, false)           \
    X(AVOID_MACHINE, "machine", MT_KEY_OBJECT, false)       \
    X(AVOID_MACHINES, "machines", MT_KEY_LIST, false)       \
    X(AVOID_MARGIN, "margin_percent", MT_KEY_NUMBER, false) \
    X(AVOID_UP_TO, "up_to_hz", MT_KEY_NUMBER, false)        \
    X(AVOID_CLUSTER, "cluster", MT_KEY_COUNT, false)
enum { AVOID_BASE = GOAL_MODE - 1, AVOID_KEYS(MT_STUDY_KEY_ENUM) AVOID_COUNT };
static const mt_key AVOID[] = {PLACE_KEYS(MT_STUDY_KEY) AVOID_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_avoid_keys = {"goal_avoid", AVOID, AVOID_COUNT};

static void read_configurations(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    const bool one = mt_read_study_has(s, o, GOAL_CONFIGURATION);
    const bool several = mt_read_study_has(s, o, GOAL_CONFIGURATIONS);
    goal->configurations_addr =
        mt_read_study_place(s, o, one ? GOAL_CONFIGURATION : GOAL_CONFIGURATIONS);
    if (one && several) {
        (void)mt_read_study_one_of(s, o, GOAL_CONFIGURATION, 2);
        return;
    }
    const mt_addr list = o->found[GOAL_CONFIGURATIONS];
    if (list != MT_NO_ADDR) {
        (void)mt_reader_some_items(&s->r, list, "the list of configurations");
        goal->configuration_names = mt_reader_refs(&s->r, list);
        return;
    }
    const mt_name name = mt_reader_ref(&s->r, o->found[GOAL_CONFIGURATION]);
    mt_name *const items = mt_arena_alloc(&s->study->mem, 1, sizeof *items);
    if (items == NULL) {
        s->r.out_of_memory = true;
    } else if (name.s != NULL) {
        items[0] = name;
        goal->configuration_names = (mt_name_list){1, items};
    }
}

static void read_frequency(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    goal->target_hz = mt_read_study_member(s, o, FREQUENCY_TARGET, &goal->target_addr);
    goal->reference_name = mt_reader_ref(&s->r, o->found[FREQUENCY_REFERENCE]);
    goal->reference_name.addr = mt_read_study_place(s, o, FREQUENCY_REFERENCE);
    goal->reference_mode = mt_read_study_index(s, o->found[FREQUENCY_REFERENCE_MODE]);
    if (mt_read_study_has(s, o, FREQUENCY_REFERENCE_MODE) &&
        !mt_read_study_has(s, o, FREQUENCY_REFERENCE)) {
        mt_diag_structure(s->r.diags, mt_read_study_place(s, o, FREQUENCY_REFERENCE_MODE),
                          "\"reference_mode\" goes with \"reference\"");
    }
    goal->at_least = mt_read_study_member(s, o, FREQUENCY_AT_LEAST, &goal->at_least_addr);
    goal->at_most = mt_read_study_member(s, o, FREQUENCY_AT_MOST, &goal->at_most_addr);
    goal->weight = mt_read_study_member(s, o, FREQUENCY_WEIGHT, &goal->weight_addr);
}

static void read_shape(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    goal->reference_name = mt_reader_ref(&s->r, o->found[SHAPE_REFERENCE]);
    goal->reference_mode = mt_read_study_index(s, o->found[SHAPE_REFERENCE_MODE]);
    goal->weight = mt_read_study_member(s, o, SHAPE_WEIGHT, &goal->weight_addr);
}

static void read_mac(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    goal->reference_name = mt_reader_ref(&s->r, o->found[MAC_REFERENCE]);
    goal->reference_mode = mt_read_study_index(s, o->found[MAC_REFERENCE_MODE]);
    goal->at_least = mt_read_study_member(s, o, MAC_AT_LEAST, &goal->at_least_addr);
}

static void read_limit(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    mt_read_study_expr(s, o->found[LIMIT_EXPRESSION], &goal->expression,
                       &goal->expression_text);
    goal->at_least = mt_read_study_member(s, o, LIMIT_AT_LEAST, &goal->at_least_addr);
    goal->at_most = mt_read_study_member(s, o, LIMIT_AT_MOST, &goal->at_most_addr);
    goal->equals = mt_read_study_member(s, o, LIMIT_EQUALS, &goal->equals_addr);
}

static void read_bands(mt_study_reader *s, mt_addr list, mt_bands_source *source)
{
    mt_items items = mt_reader_some_items(&s->r, list, "the list of bands");
    source->intervals = mt_reader_room(&s->r, &items, sizeof *source->intervals);
    while (mt_items_next(&items)) {
        double edges[2];
        if (mt_read_study_pair(s, items.at, edges)) {
            source->intervals[source->n_intervals++] =
                (mt_band_hz){edges[0], edges[1], items.at};
        }
    }
}

static void read_rotors(mt_study_reader *s, const mt_study_object *o, mt_bands_source *source)
{
    const mt_addr one = o->found[AVOID_ROTOR];
    const mt_addr list = o->found[AVOID_ROTORS];
    if (mt_read_study_has(s, o, AVOID_ROTOR) && mt_read_study_has(s, o, AVOID_ROTORS)) {
        (void)mt_read_study_one_of(s, o, AVOID_ROTOR, 2);
    }
    mt_items items = list == MT_NO_ADDR
                         ? mt_reader_one_or_items(&s->r, one)
                         : mt_reader_some_items(&s->r, list, "the list of rotors");
    source->rotors = mt_reader_room(&s->r, &items, sizeof *source->rotors);
    while (mt_items_next(&items)) {
        if (mt_reader_type(&s->r, items.at, MT_KEY_OBJECT)) {
            mt_read_study_rotor(s, items.at, &source->rotors[source->n_rotors++]);
        }
    }
}

static void read_machines(mt_study_reader *s, const mt_study_object *o, mt_bands_source *source)
{
    const mt_addr one = o->found[AVOID_MACHINE];
    const mt_addr list = o->found[AVOID_MACHINES];
    if (mt_read_study_has(s, o, AVOID_MACHINE) && mt_read_study_has(s, o, AVOID_MACHINES)) {
        (void)mt_read_study_one_of(s, o, AVOID_MACHINE, 2);
    }
    mt_items items = list == MT_NO_ADDR
                         ? mt_reader_one_or_items(&s->r, one)
                         : mt_reader_some_items(&s->r, list, "the list of machines");
    source->machines = mt_reader_room(&s->r, &items, sizeof *source->machines);
    while (mt_items_next(&items)) {
        if (mt_reader_type(&s->r, items.at, MT_KEY_OBJECT)) {
            mt_read_study_machine(s, items.at, &source->machines[source->n_machines++]);
        }
    }
}

static void read_avoid(mt_study_reader *s, const mt_study_object *o, mt_goal *goal)
{
    mt_avoid *const avoid = mt_arena_alloc(&s->study->mem, 1, sizeof *avoid);
    if (avoid == NULL) {
        s->r.out_of_memory = true;
        return;
    }
    *avoid = mt_avoid_default(goal->addr);
    goal->avoid = avoid;
    bool any = false;
    for (int key = AVOID_BANDS; key < AVOID_MARGIN; key++) {
        any = any || mt_read_study_has(s, o, key);
    }
    if (!any) {
        (void)mt_read_study_one_of(s, o, AVOID_BANDS, AVOID_MARGIN - AVOID_BANDS);
    }
    avoid->bands_addr = mt_read_study_place(s, o, AVOID_BANDS);
    read_bands(s, o->found[AVOID_BANDS], &avoid->source);
    read_rotors(s, o, &avoid->source);
    read_machines(s, o, &avoid->source);
    avoid->source.margin_percent =
        mt_read_study_member(s, o, AVOID_MARGIN, &avoid->margin_addr);
    avoid->source.up_to_hz = mt_read_study_member(s, o, AVOID_UP_TO, &avoid->up_to_addr);
    avoid->cluster =
        mt_reader_count(&s->r, o->found[AVOID_CLUSTER], 1, MT_MAX_CLUSTER, avoid->cluster);
}

static const struct {
    mt_goal_type type;
    const mt_key_table *table;
    void (*read)(mt_study_reader *s, const mt_study_object *o, mt_goal *goal);
} TYPES[] = {
    {MT_GOAL_FREQUENCY, &mt_study_frequency_keys, read_frequency},
    {MT_GOAL_SHAPE, &mt_study_shape_keys, read_shape},
    {MT_GOAL_MAC, &mt_study_mac_keys, read_mac},
    {MT_GOAL_LIMIT, &mt_study_limit_keys, read_limit},
    {MT_GOAL_AVOID, &mt_study_avoid_keys, read_avoid},
};

/* Which row of TYPES; MT_ABSENT (noted) where the type is missing or none of them. */
static int type_of(mt_study_reader *s, mt_addr value)
{
    const char *names[MT_COUNT(TYPES)];
    for (int i = 0; i < MT_COUNT(TYPES); i++) {
        names[i] = mt_goal_type_name(TYPES[i].type);
    }
    if (!mt_reader_type(&s->r, value, MT_KEY_OBJECT)) {
        return MT_ABSENT;
    }
    const mt_addr type = mt_json_member(s->r.doc, value, FREQUENCY[GOAL_TYPE].name);
    if (type == MT_NO_ADDR) {
        mt_diag_structure(s->r.diags, value, "member \"%s\" is missing",
                          FREQUENCY[GOAL_TYPE].name);
    }
    return mt_reader_choice(&s->r, type, "type of goal", names, MT_COUNT(TYPES));
}

static bool read_goal(mt_study_reader *s, mt_addr value, mt_goal *goal)
{
    const int row = type_of(s, value);
    mt_study_object o;
    if (row == MT_ABSENT || !mt_read_study_object(s, value, TYPES[row].table, &o)) {
        return false;
    }
    *goal = mt_goal_default(TYPES[row].type, value);
    goal->description = mt_reader_text(&s->r, o.found[GOAL_DESCRIPTION]);
    const double tolerance = mt_read_study_member(s, &o, GOAL_TOLERANCE, &goal->tolerance_addr);
    goal->tolerance_percent = MT_HAS(tolerance) ? tolerance : goal->tolerance_percent;
    if (goal->type != MT_GOAL_LIMIT) {
        read_configurations(s, &o, goal);
    }
    if (goal->type != MT_GOAL_LIMIT && goal->type != MT_GOAL_AVOID) {
        goal->mode = mt_read_study_mode(s, &o, GOAL_MODE);
    }
    TYPES[row].read(s, &o, goal);
    return true;
}

void mt_read_study_goals(mt_study_reader *s, mt_addr list)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, list);
    study->goals = mt_reader_room(&s->r, &items, sizeof *study->goals);
    while (mt_items_next(&items)) {
        study->n_goals += read_goal(s, items.at, &study->goals[study->n_goals]) ? 1 : 0;
    }
}
