/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#include <string.h>

/* The table of keys of each kind of goal, of the list that goal_kinds.h has of its members. */
#define KEY(slot, label, kind, given, row, ...) \
    {.name = (label),                           \
     .type = MT_KEY_##kind,                     \
     .required = (given),                       \
     .possible = MT_POSSIBLE_##row,             \
     .says = __VA_ARGS__},

#define KEYS(id, ...) static const mt_key id##_KEYS[] = {MT_GOAL_##id##_MEMBERS(KEY)};
MT_GOAL_LIST(KEYS)

#define TABLE(id, name, unit, measure, sentence, together) \
    {.what = "goal_" #name,                                \
     .keys = id##_KEYS,                                    \
     .n = MT_COUNT(id##_KEYS),                             \
     .says = (sentence),                                   \
     .rules = (together)},
const mt_key_table mt_study_goal_keys[MT_GOAL_TYPE_COUNT] = {MT_GOAL_LIST(TABLE)};

/* A goal being read. */
typedef struct reading {
    mt_study_reader *s;
    const mt_goal_kind *kind;
    mt_object o;
    mt_goal *goal;
} reading;

static mt_addr found(const reading *g, mt_goal_slot slot)
{
    const int at = mt_goal_member_at(g->kind, slot);
    return at < 0 ? MT_NO_ADDR : g->o.found[at];
}

static bool has_goal_member(const reading *g, mt_goal_slot slot)
{
    const int at = mt_goal_member_at(g->kind, slot);
    return at >= 0 && mt_object_has(&g->s->r, &g->o, g->kind->members[at].name);
}

/* Address of the member; that of the goal where it is absent. */
static mt_addr goal_member_addr(const reading *g, mt_goal_slot slot)
{
    const int at = mt_goal_member_at(g->kind, slot);
    return at < 0 ? g->o.addr : mt_object_place(&g->s->r, &g->o, g->kind->members[at].name);
}

/* One of n members that follow each other from `first` on: none or several are noted. */
static void one_of(const reading *g, mt_goal_slot first, int n)
{
    (void)mt_object_one_of(&g->s->r, &g->o, mt_goal_member_name(g->kind, first), n);
}

static void read_configurations(const reading *g)
{
    mt_study_reader *const s = g->s;
    const bool one = has_goal_member(g, MT_SLOT_CONFIGURATION);
    const mt_addr list = found(g, MT_SLOT_CONFIGURATIONS);
    if (one && has_goal_member(g, MT_SLOT_CONFIGURATIONS)) {
        one_of(g, MT_SLOT_CONFIGURATION, 2);
        return;
    }
    if (list != MT_NO_ADDR) {
        (void)mt_reader_some_items(&s->r, list, "the list of configurations");
        g->goal->configuration_names = mt_reader_refs(&s->r, list);
        return;
    }
    const mt_name name = mt_reader_ref(&s->r, found(g, MT_SLOT_CONFIGURATION));
    mt_name *const items = mt_arena_alloc(&s->study->mem, 1, sizeof *items);
    if (items != NULL && name.s != NULL) {
        items[0] = name;
        g->goal->configuration_names = (mt_name_list){1, items};
    }
}

static void read_reference(const reading *g)
{
    const int at = mt_goal_member_at(g->kind, MT_SLOT_REFERENCE);
    g->goal->reference_name = mt_reader_ref(&g->s->r, found(g, MT_SLOT_REFERENCE));
    g->goal->reference_name.addr = goal_member_addr(g, MT_SLOT_REFERENCE);
    g->goal->reference_mode = mt_read_study_index(g->s, found(g, MT_SLOT_REFERENCE_MODE));
    if (has_goal_member(g, MT_SLOT_REFERENCE_MODE) && !has_goal_member(g, MT_SLOT_REFERENCE) &&
        !g->kind->members[at].required) {
        mt_diag_structure(g->s->r.diags, goal_member_addr(g, MT_SLOT_REFERENCE_MODE),
                          "\"reference_mode\" goes with \"reference\"");
    }
}

static void read_bands(mt_study_reader *s, mt_addr list, mt_bands_source *source)
{
    mt_items items = mt_reader_some_items(&s->r, list, "the list of bands");
    source->intervals = mt_reader_room(&s->r, &items, sizeof *source->intervals);
    while (mt_items_next(&items)) {
        double edges[2];
        if (mt_read_study_pair(s, list, items.at, edges)) {
            source->intervals[source->n_intervals++] =
                (mt_band_hz){edges[0], edges[1], items.at};
        }
    }
}

/* One object, or a list of them: two members that exclude each other. */
static mt_items one_or_several(const reading *g, mt_goal_slot one, mt_goal_slot several,
                               const char *what)
{
    const mt_addr list = found(g, several);
    if (has_goal_member(g, one) && has_goal_member(g, several)) {
        one_of(g, one, 2);
    }
    return list == MT_NO_ADDR ? mt_reader_one_or_items(&g->s->r, found(g, one))
                              : mt_reader_some_items(&g->s->r, list, what);
}

static void read_rotors(const reading *g, mt_bands_source *source)
{
    mt_reader *const r = &g->s->r;
    mt_items items = one_or_several(g, MT_SLOT_ROTOR, MT_SLOT_ROTORS, "the list of rotors");
    source->rotors = mt_reader_room(r, &items, sizeof *source->rotors);
    while (mt_items_next(&items)) {
        if (mt_reader_type(r, items.at, MT_KEY_OBJECT)) {
            (void)mt_members_read(r, items.at, &mt_study_rotor_keys,
                                  &source->rotors[source->n_rotors++]);
        }
    }
}

static void read_machines(const reading *g, mt_bands_source *source)
{
    mt_reader *const r = &g->s->r;
    mt_items items =
        one_or_several(g, MT_SLOT_MACHINE, MT_SLOT_MACHINES, "the list of machines");
    source->machines = mt_reader_room(r, &items, sizeof *source->machines);
    while (mt_items_next(&items)) {
        if (mt_reader_type(r, items.at, MT_KEY_OBJECT)) {
            (void)mt_members_read(r, items.at, &mt_study_machine_keys,
                                  &source->machines[source->n_machines++]);
        }
    }
}

/* What makes bands, their margin, and how the search goes about them. */
static void read_avoid(const reading *g)
{
    static const mt_goal_slot makes[] = {MT_SLOT_BANDS, MT_SLOT_ROTOR, MT_SLOT_ROTORS,
                                         MT_SLOT_MACHINE, MT_SLOT_MACHINES};
    mt_study_reader *const s = g->s;
    mt_avoid *const avoid = mt_arena_alloc(&s->study->mem, 1, sizeof *avoid);
    bool any = false;
    if (avoid == NULL) {
        return;
    }
    *avoid = mt_avoid_default();
    g->goal->avoid = avoid;
    for (int i = 0; i < MT_COUNT(makes); i++) {
        any = any || has_goal_member(g, makes[i]);
    }
    if (!any) {
        one_of(g, MT_SLOT_BANDS, MT_COUNT(makes));
    }
    read_bands(s, found(g, MT_SLOT_BANDS), &avoid->source);
    read_rotors(g, &avoid->source);
    read_machines(g, &avoid->source);
    avoid->source.margin_percent = mt_read_study_number(s, found(g, MT_SLOT_MARGIN));
    avoid->source.up_to_hz = mt_read_study_number(s, found(g, MT_SLOT_UP_TO));
    avoid->cluster =
        mt_reader_count(&s->r, found(g, MT_SLOT_CLUSTER), 1, MT_MAX_CLUSTER, avoid->cluster);
}

/* The kind of goal that an object says it is; NULL (noted) where it says none. */
static const mt_key_table *table_of(mt_study_reader *s, mt_addr value)
{
    const char *names[MT_GOAL_TYPE_COUNT];
    for (int i = 0; i < MT_GOAL_TYPE_COUNT; i++) {
        names[i] = mt_goal_kind_of((mt_goal_type)i)->name;
    }
    if (!mt_reader_type(&s->r, value, MT_KEY_OBJECT)) {
        return NULL;
    }
    const mt_addr type = mt_json_member(s->r.doc, value, "type");
    if (type == MT_NO_ADDR) {
        mt_diag_structure(s->r.diags, value, "member \"type\" is missing");
    }
    const int which = mt_reader_choice(&s->r, type, "type of goal", names, MT_GOAL_TYPE_COUNT);
    return which == MT_ABSENT ? NULL : &mt_study_goal_keys[which];
}

/* Check the limits of an expression. */
static void check_requirements(const reading *g)
{
    static const mt_goal_slot slots[] = {MT_SLOT_EQUALS, MT_SLOT_AT_LEAST, MT_SLOT_AT_MOST};
    for (int i = 0; i < MT_COUNT(slots); i++) {
        mt_read_study_check_requirement(g->s, &g->goal->expression, found(g, slots[i]));
    }
}

/* Read every member of the kind into its slot. */
static bool read_goal(mt_study_reader *s, mt_addr value, mt_goal *goal)
{
    reading g = {.s = s, .goal = goal};
    const mt_key_table *const table = table_of(s, value);
    if (table == NULL || !mt_object_match(&s->r, value, table, &g.o)) {
        return false;
    }
    *goal = mt_goal_default((mt_goal_type)(table - mt_study_goal_keys), value);
    g.kind = mt_goal_kind_of(goal->type);
    goal->description = mt_reader_text(&s->r, found(&g, MT_SLOT_DESCRIPTION));
    for (int i = 0; i < g.kind->n; i++) {
        const mt_goal_slot slot = g.kind->members[i].slot;
        if (slot < MT_GOAL_NUMBERS) {
            const double number = mt_read_study_number(s, g.o.found[i]);
            goal->number[slot] = MT_HAS(number) ? number : goal->number[slot];
        } else if (slot == MT_SLOT_CONFIGURATION) {
            read_configurations(&g);
        } else if (slot == MT_SLOT_MODE) {
            goal->mode = mt_read_study_mode(s, &g.o, g.kind->members[i].name);
        } else if (slot == MT_SLOT_REFERENCE) {
            read_reference(&g);
        } else if (slot == MT_SLOT_EXPRESSION) {
            mt_read_study_expr(s, g.o.found[i], &goal->expression, &goal->expression_text);
        } else if (slot == MT_SLOT_BANDS) {
            read_avoid(&g);
        } else if (slot == MT_SLOT_OUTPUT) {
            mt_read_study_response_limit(s, &g.o, goal);
        }
    }
    goal->tolerance_given = has_goal_member(&g, MT_SLOT_TOLERANCE);
    check_requirements(&g);
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
