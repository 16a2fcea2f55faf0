/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goals of types "response" and "vibration": ports, frequencies, and the profile, which is a
 * file beside the study, or one that is part of the program. */
#include "study/read_priv.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "environment/read_profile.h"
#include "io/shipped.h"

static const char SHIPPED[] = "problems/profiles/";
static const char ENDING[] = ".json";
static const char AIRCRAFT[] = "problems/aircraft.json";

/* A goal being read. */
typedef struct reading {
    mt_study_reader *s;
    const mt_goal_kind *kind;
    const mt_object *o;
} reading;

static mt_addr found(const reading *g, mt_goal_slot slot)
{
    const int at = mt_goal_member_at(g->kind, slot);
    return at < 0 ? MT_NO_ADDR : g->o->found[at];
}

/* Address of the member; that of the goal where it is absent. */
static mt_addr limit_member_addr(const reading *g, mt_goal_slot slot)
{
    const int at = mt_goal_member_at(g->kind, slot);
    return at < 0 ? g->o->addr : mt_object_place(&g->s->r, g->o, g->kind->members[at].name);
}

static mt_name name_at(const reading *g, mt_goal_slot slot)
{
    mt_name name = mt_reader_ref(&g->s->r, found(g, slot));
    name.addr = limit_member_addr(g, slot);
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

const mt_vibration *mt_read_study_profile(mt_study_reader *s, mt_name name)
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
    (void)mt_object_one_of(&g->s->r, g->o, mt_goal_member_name(g->kind, MT_SLOT_BAND), 2);
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
    response_limit->profile = mt_read_study_profile(g->s, response_limit->profile_name);
}

void mt_read_study_response_limit(mt_study_reader *s, const mt_object *o, mt_goal *goal)
{
    const reading g = {.s = s, .kind = mt_goal_kind_of(goal->type), .o = o};
    mt_response_limit *const response_limit =
        mt_arena_alloc(&s->study->mem, 1, sizeof *response_limit);
    if (response_limit == NULL) {
        return;
    }
    *response_limit = mt_response_limit_default();
    goal->response_limit = response_limit;
    response_limit->input = name_at(&g, MT_SLOT_INPUT);
    response_limit->output = name_at(&g, MT_SLOT_OUTPUT);
    if (mt_goal_member_at(g.kind, MT_SLOT_PROFILE) >= 0) {
        read_profile(&g, response_limit);
    } else if (mt_goal_member_at(g.kind, MT_SLOT_MEASUREMENT) >= 0) {
        mt_read_study_measured(s, o, goal);
    } else {
        read_frequencies(&g, response_limit);
    }
}
