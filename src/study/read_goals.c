/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals, and the responses that results show: ports, frequencies, and the profile, which is a
 * file beside the study or one that is part of the program. */
#include "study/read_priv.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "environment/vibration.h"
#include "io/shipped.h"

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

static const char SHIPPED[] = "problems/profiles/";
static const char ENDING[] = ".json";
static const char AIRCRAFT[] = "problems/aircraft.json";

static mt_name name_at(const reading *g, mt_goal_slot slot)
{
    mt_name name = mt_reader_ref(&g->s->r, found(g, slot));
    name.addr = goal_member_addr(g, slot);
    return name;
}

/* True where the text is a name, not a path, of a profile built into the program, and no such
 * file exists. */
static bool is_shipped(const mt_study_reader *s, const char *name, const char *file)
{
    return strpbrk(name, "/.") == NULL && mt_files_lack(&s->files.files, file);
}

/* The built-in profile of that name; NULL: none (noted, with the nearest). */
static const mt_shipped *shipped(mt_study_reader *s, mt_name name)
{
    const char *const path = mt_arena_printf(s->r.mem, "%s%s%s", SHIPPED, name.s, ENDING);
    const mt_shipped *const own = path == NULL ? NULL : mt_shipped_find(path);
    int n = 0;
    int n_names = 0;
    const mt_shipped *const all = mt_shipped_all(&n);
    const char **const names = mt_arena_alloc(s->r.mem, (size_t)n, sizeof *names);
    if (own != NULL) {
        return own;
    }
    for (int i = 0; i < n && names != NULL; i++) {
        if (strncmp(all[i].path, SHIPPED, strlen(SHIPPED)) == 0) {
            const char *const file = all[i].path + strlen(SHIPPED);
            names[n_names++] = mt_arena_strndup(s->r.mem, file, strlen(file) - strlen(ENDING));
        }
    }
    if (names == NULL || mt_arena_failed(s->r.mem)) {
        return NULL;
    }
    const char *const near = mt_text_nearest(name.s, names, n_names);
    if (near == NULL) {
        mt_diag_error(s->r.diags, name.addr,
                      "there is no file \"%s\", and no profile of the program is called so: "
                      "\"modetune profile\" lists them",
                      name.s);
    } else {
        mt_diag_error(
            s->r.diags, name.addr,
            "there is no file \"%s\", and no profile of the program is called so; did "
            "you mean \"%s\"?",
            name.s, near);
    }
    return NULL;
}

static void note_input(mt_study_reader *s, const char *name, const char *sha256)
{
    for (int i = 0; i < s->study->n_inputs; i++) {
        if (strcmp(s->study->inputs[i].name, name) == 0) {
            return; /* the catalogue of several profiles */
        }
    }
    mt_read_study_note_input(s, name, sha256);
}

/* The profile, and the catalogue of aircraft that its rotors are in; `own`: both are part of
 * the program. */
static void note_inputs(mt_study_reader *s, const char *profile, bool own,
                        const mt_vibration *v)
{
    const char *const catalogue = own ? mt_aircraft_own_name : v->aircraft_name;
    char *const file = own ? mt_arena_printf(s->r.mem, "profile %s of modetune", profile)
                           : mt_arena_strdup(s->r.mem, profile);
    if (file == NULL) {
        return;
    }
    note_input(s, file, v->sha256);
    if (v->aircraft_name == NULL) {
        return;
    }
    if (catalogue == mt_aircraft_own_name) {
        note_input(s, catalogue, v->aircraft.sha256);
        return;
    }
    char *const joined = mt_file_join(profile, catalogue);
    if (joined == NULL) {
        mt_arena_fail(s->r.mem);
        return;
    }
    note_input(s, joined, v->aircraft.sha256);
    free(joined);
}

/* From a file, or from the texts that are given in opt. */
static mt_vibration *load_from(mt_study_reader *s, mt_name name, const char *path, bool own,
                               const mt_io_options *opt)
{
    const int told = s->model_messages->count;
    mt_vibration *v = NULL;
    mt_err why = {.code = MT_OK};
    const mt_status rc = mt_vibration_load_within(path, opt, &v, s->model_messages, &why);
    if (rc == MT_OK) {
        note_inputs(s, name.s, own, v);
    } else {
        mt_read_study_note_failure(s, name, path, rc, &why, s->model_messages->count > told);
    }
    return v;
}

static mt_vibration *load_limit_profile(mt_study_reader *s, mt_name name)
{
    char *const joined = mt_file_join(s->study->path, name.s);
    mt_vibration *v = NULL;
    if (joined == NULL) {
        mt_arena_fail(s->r.mem);
        return NULL;
    }
    if (!is_shipped(s, name.s, joined)) {
        v = load_from(s, name, joined, false, &s->files);
    } else {
        const mt_shipped *const own = shipped(s, name);
        const mt_shipped *const aircraft = mt_shipped_find(AIRCRAFT);
        mt_io_options opt = s->files;
        if (own != NULL) {
            const mt_file_text texts[] = {{.path = own->path, .text = own->bytes},
                                          {.path = aircraft->path, .text = aircraft->bytes}};
            opt.files = (mt_files){.given = texts, .n = MT_COUNT(texts), .only = true};
            v = load_from(s, name, own->path, true, &opt);
        }
    }
    free(joined);
    return v;
}

/* A profile of vibration that the study names, each read once; NULL: no name, or it could not
 * be read (noted). */
static const mt_vibration *limit_profile(mt_study_reader *s, mt_name name)
{
    mt_study *const study = s->study;
    if (name.s == NULL) {
        return NULL;
    }
    for (int i = 0; i < study->n_profiles; i++) {
        if (strcmp(study->profiles[i].name.s, name.s) == 0) {
            return study->profiles[i].profile;
        }
    }
    mt_study_profile *const all = mt_arena_grow(&study->mem, study->profiles, study->n_profiles,
                                                &study->cap_profiles, sizeof *all);
    if (all == NULL) {
        return NULL;
    }
    study->profiles = all;
    all[study->n_profiles] =
        (mt_study_profile){.name = name, .profile = load_limit_profile(s, name)};
    return all[study->n_profiles++].profile;
}

/* A band, or one frequency. */
static void read_frequencies(const reading *g, mt_response_limit *response_limit)
{
    double edges[2];
    (void)mt_object_one_of(&g->s->r, &g->o, mt_goal_member_name(g->kind, MT_SLOT_BAND), 2);
    if (found(g, MT_SLOT_AT) != MT_NO_ADDR) {
        response_limit->lower_hz = mt_read_study_number(g->s, found(g, MT_SLOT_AT));
        response_limit->upper_hz = response_limit->lower_hz;
    } else if (found(g, MT_SLOT_BAND) != MT_NO_ADDR &&
               mt_read_study_pair(g->s, found(g, MT_SLOT_BAND), found(g, MT_SLOT_BAND),
                                  edges)) {
        response_limit->lower_hz = edges[0];
        response_limit->upper_hz = edges[1];
    }
}

static void read_profile(const reading *g, mt_response_limit *response_limit)
{
    const int which = mt_reader_choice(&g->s->r, found(g, MT_SLOT_QUANTITY), "quantity",
                                       &mt_response_limit_names[MT_RESPONSE_LIMIT_RMS],
                                       MT_RESPONSE_LIMIT_QUANTITIES - MT_RESPONSE_LIMIT_RMS);
    response_limit->quantity =
        (mt_response_limit_quantity)(MT_RESPONSE_LIMIT_RMS + (which == MT_ABSENT ? 0 : which));
    response_limit->profile_name = name_at(g, MT_SLOT_PROFILE);
    response_limit->profile = limit_profile(g->s, response_limit->profile_name);
}

/* The members of a goal on ports that is compared with a measurement. */
static void read_measured_response(const reading *g, mt_response_limit *response_limit)
{
    mt_reader *const r = &g->s->r;
    const mt_addr band = found(g, MT_SLOT_BAND);
    double edges[2];
    response_limit->measurement_name = mt_reader_ref(r, found(g, MT_SLOT_MEASUREMENT));
    response_limit->coherence = mt_reader_flag(r, found(g, MT_SLOT_COHERENCE), false);
    if (band != MT_NO_ADDR && mt_read_study_pair(g->s, band, band, edges)) {
        response_limit->lower_hz = edges[0];
        response_limit->upper_hz = edges[1];
    }
}

/* The members of a goal about ports. */
static void read_response_limit(const reading *g)
{
    mt_response_limit *const response_limit =
        mt_arena_alloc(&g->s->study->mem, 1, sizeof *response_limit);
    if (response_limit == NULL) {
        return;
    }
    *response_limit = mt_response_limit_default();
    g->goal->response_limit = response_limit;
    response_limit->input = name_at(g, MT_SLOT_INPUT);
    response_limit->output = name_at(g, MT_SLOT_OUTPUT);
    if (mt_goal_member_at(g->kind, MT_SLOT_PROFILE) >= 0) {
        read_profile(g, response_limit);
    } else if (mt_goal_member_at(g->kind, MT_SLOT_MEASUREMENT) >= 0) {
        read_measured_response(g, response_limit);
    } else {
        read_frequencies(g, response_limit);
    }
}

static void response_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_study_response *)item = mt_study_response_default(addr);
}

static void response_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_response_limit *const limit = &((mt_study_response *)item)->response_limit;
    (void)o;
    (void)which;
    limit->profile = limit_profile(mt_study_reader_of(r), limit->profile_name);
}

#define THIS mt_study_response
static const mt_key RESPONSE[] = {
    MT_M_REF("configuration", false, configuration_name,
             "Name of a configuration of the model. Absent: its only one."),
    MT_M_REF("input", true, response_limit.input,
             "A port as `modetune response` has it: \"grip.y\", the force along a sensor's "
             "direction; \"base.y\", the ground's acceleration, or \"base.y:displacement\".",
             .examples = "[\"base.y\"]"),
    MT_M_REF("output", true, response_limit.output,
             "A port as `modetune response` has it: a sensor's motion (\"grip.y\", its "
             "displacement, or \"grip.y:acceleration\"), a force (\"spring.NAME\", "
             "\"damper.NAME\", \"joint.NAME.x\").",
             .examples = "[\"grip.y:acceleration\"]"),
    MT_S_PAIR("band_hz", true, response_limit.lower_hz, response_limit.upper_hz, RANGE,
              "From where to where it is shown.", .examples = "[[5, 500]]"),
    MT_M_REF("profile", false, response_limit.profile_name,
             "The vibration profile that the ground follows: a file, relative to this one, or "
             "the name of one that is part of the program (`modetune profile`). The input is "
             "an acceleration of the ground."),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_TEXT("source", source, "Where it comes from: a table, a page, a test report."),
};
#undef THIS
const mt_key_table mt_study_response_keys = {
    .what = "response",
    .keys = RESPONSE,
    .n = MT_COUNT(RESPONSE),
    .size = sizeof(mt_study_response),
    .defaults = response_defaults,
    .finish = response_finish,
    .says = "What a forced vibration is caused by, and what it is seen in."};

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
            read_response_limit(&g);
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
