/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model file: how it is read, how its parts come together, and the stages in which it is
 * resolved and checked. */
#include "model/read.h"

#include "modetune/model.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "expr/kind.h"
#include "io/file.h"
#include "io/json.h"
#include "io/reader.h"
#include "model/expand.h"
#include "model/item.h"
#include "model/lint.h"
#include "model/model.h"
#include "model/values.h"

/* The last stage: what the numbers are, in every configuration. Faults are errors, doubts
 * warnings; what several configurations share is said once. */

static bool is_told(const mt_warning_list *list, int n, const mt_warning *d)
{
    for (int i = 0; i < n; i++) {
        const mt_warning *const other = &list->items[i];
        if (other->addr == d->addr && strcmp(other->text, d->text) == 0) {
            return true;
        }
    }
    return false;
}

/* Report a warning, with the configuration where an override caused it. */
static void report_warning(mt_resolve *f, const mt_warning *d, const mt_configuration *c)
{
    const bool own = c->n_overrides > 0;
    const char *const in = own ? " in configuration \"" : "";
    if (d->level == MT_LEVEL_FAULT) {
        mt_diag_error(f->d, d->addr, "%s%s%s%s", d->text, in, own ? c->name.s : "",
                      own ? "\"" : "");
    } else if (d->level == MT_LEVEL_WARNING) {
        mt_diag_warning(f->d, d->addr, "%s%s%s%s", d->text, in, own ? c->name.s : "",
                        own ? "\"" : "");
    }
}

/* Only where there is no error so far. */
static void resolve_values(mt_resolve *f)
{
    mt_model *const m = f->m;
    mt_arena texts = {.first = NULL};
    mt_warning_list list = mt_warning_list_default(&texts);
    const bool sound = f->d->errors == 0;
    double *const value = mt_arena_f64(&texts, (size_t)m->n_nums, 1);
    bool ok = value != NULL;
    for (int pass = 0; pass < 2 && sound && ok; pass++) {
        for (int c = 0; c < m->n_configurations && ok; c++) {
            const bool own = m->configurations[c].n_overrides > 0;
            const int first = list.n;
            if (own != (pass == 1)) {
                continue; /* the file's own values first */
            }
            ok = mt_model_numbers(m, c, 0, NULL, NULL, &texts, value, NULL) == MT_OK;
            if (ok) {
                mt_model_lint(m, c, value, true, &list);
            }
            for (int i = first; i < list.n && ok; i++) {
                if (!is_told(&list, i, &list.items[i])) {
                    report_warning(f, &list.items[i], &m->configurations[c]);
                }
            }
        }
    }
    if (!ok || mt_arena_failed(&texts)) {
        mt_arena_fail(&m->mem);
    }
    mt_arena_free(&texts);
}

/* Resolving and checking a model, stage by stage; and its name spaces. */

/* Enter one name; a second use is noted. */
static void enter(mt_resolve *f, mt_names *table, mt_name name, int value, const char *what)
{
    bool taken = false;
    if (name.s == NULL) {
        return;
    }
    mt_names_add(table, &f->m->mem, name.s, value, &taken);
    if (taken) {
        mt_diag_error(f->d, name.addr, "the name \"%s\" is taken by another %s", name.s, what);
    }
}

/* One name space: a list of items with a member `name`. */
#define ENTER_ALL(f, table, list, what)                                      \
    for (int i = 0; i < (f)->m->n_##list; i++) {                             \
        enter((f), &(f)->m->tables->table, (f)->m->list[i].name, i, (what)); \
    }

static void resolve_names(mt_resolve *f)
{
    mt_model *const m = f->m;
    *m->tables = (mt_model_names){0};
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_name name = m->parameters[i].name;
        if (name.s != NULL && mt_expr_reserved(name.s)) {
            mt_diag_error(f->d, name.addr, "\"%s\" is a function or constant of expressions",
                          name.s);
        }
    }
    ENTER_ALL(f, parameters, parameters, "parameter")
    ENTER_ALL(f, points, points, "point")
    ENTER_ALL(f, bodies, bodies, "body or link")
    for (int i = 0; i < m->n_links; i++) {
        enter(f, &m->tables->bodies, m->links[i].name, -1 - i, "body or link");
    }
    ENTER_ALL(f, joints, joints, "joint")
    ENTER_ALL(f, springs, springs, "spring or damper")
    ENTER_ALL(f, loads, loads, "load")
    ENTER_ALL(f, sensors, sensors, "sensor")
    ENTER_ALL(f, modes, modes, "mode")
    ENTER_ALL(f, configurations, configurations, "configuration")
    bool found = false;
    const int i = mt_names_find(&m->tables->bodies, "ground", strlen("ground"), &found);
    if (found) {
        const mt_name name = i >= 0 ? m->bodies[i].name : m->links[-1 - i].name;
        mt_diag_error(f->d, name.addr, "\"ground\" is the fixed world and cannot be a name");
    }
}

static void resolve_bodies(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_bodies; i++) {
        const mt_body *const b = &f->m->bodies[i];
        mt_resolve_position(f, &f->m->bodies[i].centre);
        if (b->axes.given && (b->point_mass || f->m->dimension == 2)) {
            mt_diag_error(f->d, b->axes.addr, "body \"%s\" has no \"axes\": %s", b->name.s,
                          b->point_mass ? "without inertia_kg_m2 it is a point mass"
                                        : "in two dimensions it turns about z alone");
        } else if (f->m->dimension != 0) {
            mt_resolve_axes(f, b->name, "body", &b->axes);
        }
    }
}

/* A model without configurations has one, "default". */
static void ensure_configuration(mt_resolve *f)
{
    mt_model *const m = f->m;
    if (m->n_configurations > 0) {
        return;
    }
    m->configurations = mt_arena_alloc(&m->mem, 1, sizeof *m->configurations);
    if (m->configurations == NULL) {
        return;
    }
    m->n_configurations = 1;
    m->cap_configurations = 1;
    m->configurations[0] =
        (mt_configuration){.name = {.s = "default", .addr = MT_NO_ADDR}, .like = MT_ABSENT};
    m->configurations[0].like_name.addr = MT_NO_ADDR;
    for (int k = 0; k < 3; k++) {
        m->configurations[0].gravity[k] = MT_ABSENT;
    }
}

/* Check the cost of all configurations together. Beyond the limit, nothing else is checked. */
static bool fits(const mt_model *m, mt_diags *diags)
{
    const double parts = (double)m->n_nums + m->n_bodies + m->n_links + m->n_joints +
                         m->n_springs + m->n_loads + m->n_sensors;
    if (m->n_configurations < 2 || (double)m->n_configurations * parts <= MT_MAX_CONFIGURED) {
        return true;
    }
    mt_diag_error(diags, m->configurations[0].name.addr,
                  "%d configurations of %.0f numbers and items are too many: at most %d as the "
                  "product",
                  m->n_configurations, parts, (int)MT_MAX_CONFIGURED);
    return false;
}

mt_status mt_model_resolve(mt_model *model, mt_diags *diags, mt_err *err)
{
    static void (*const stages[])(mt_resolve *) = {
        ensure_configuration, resolve_names,      mt_resolve_configurations,
        resolve_bodies,       mt_resolve_links,   mt_resolve_joints,
        mt_resolve_forces,    mt_resolve_sensors, mt_resolve_drives,
        mt_resolve_cycles,    resolve_values,
    };
    mt_resolve f = {.m = model, .d = diags};
    const int n_stages = fits(model, diags) ? MT_COUNT(stages) : 0;
    for (int i = 0; i < n_stages && !mt_arena_failed(&model->mem); i++) {
        stages[i](&f);
    }
    MT_TRY(mt_arena_check(&model->mem, err));
    MT_TRY(mt_arena_check(diags->mem, err));
    if (diags->errors > 0) {
        return mt_fail(err, MT_E_INPUT, "%s%s", diags->count > 0 ? diags->items[0].text : "",
                       diags->errors > 1 ? " (and more)" : "");
    }
    return MT_OK;
}

/* The file: its root, points and bodies. */

/* In two dimensions one moment; in three three moments, or six with the products; none: a point
 * mass. */
static void read_inertia(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    enum { MOMENTS = 3, ALL = 6 };
    mt_body *const b = item;
    const int dimension = mt_model_reader_of(r)->m->dimension;
    int n = 0;
    for (int k = 0; k < ALL; k++) {
        b->inertia[k] = MT_ABSENT;
    }
    b->point_mass = value == MT_NO_ADDR;
    const mt_num *const nums = mt_read_nums(mt_model_reader_of(r), key, value, &n);
    if (nums == NULL) {
        return;
    }
    const bool fits = dimension == 2 ? n == 1 : n == MOMENTS || n == ALL;
    if (!fits && dimension != 0) {
        mt_diag_error(r->diags, value, "must be %s: the model has %d dimensions",
                      dimension == 2 ? "one number"
                                     : "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz]",
                      dimension);
        return;
    }
    memcpy(b->inertia, nums, (size_t)n * sizeof *nums);
}

#define THIS mt_body
static const mt_key BODY[] = {
    MT_I_NAME("body"),
    MT_I_NUM("mass_kg", false, mass, NOT_NEGATIVE, "Mass [kg]. Absent: 0."),
    MT_M_JUST(
        "inertia_kg_m2", NUMBER_OR_LIST, false, INERTIA,
        "About the centre of mass, along `axes` [kg m^2]. Two dimensions: a number. Three: "
        "[xx, "
        "yy, zz] or [xx, yy, zz, xy, xz, yz], elements of the tensor: xy is minus the integral "
        "of x y over the mass, so that products of inertia that a CAD system gives as positive "
        "integrals change sign. None of the principal moments is more than the other two "
        "together. Absent: a point mass, which has no orientation.",
        .read = read_inertia, .least = 3, .most = 6),
    MT_I_AXES,
    MT_I_POSITION("centre", true, centre, "Centre of mass [m]."),
    MT_I_IN,
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
    MT_I_ORIGIN,
};
#undef THIS
const mt_key_table mt_body_keys = {MT_I_TABLE("body", BODY, mt_body),
                                   .says =
                                       "A rigid body, or without inertia_kg_m2 a point mass."};

/* In the order of mt_dimension. */
static const mt_key UNITS[] = {
    {.name = "length",
     .type = MT_KEY_TEXT,
     .choices = mt_length_names,
     .n_choices = MT_COUNT(mt_length_names),
     .says = "Unit of coordinates: points, at, centre, from, to. Absent: m."},
    {.name = "angle",
     .type = MT_KEY_TEXT,
     .choices = mt_angle_names,
     .n_choices = MT_COUNT(mt_angle_names),
     .says =
         "Unit of angles. Every angle of a model names its unit; with this member, expressions "
         "of parameters that are angles are checked for bare numbers. Absent: rad."},
    {.name = "speed",
     .type = MT_KEY_TEXT,
     .choices = mt_speed_names,
     .n_choices = MT_COUNT(mt_speed_names),
     .says = "Unit of speeds. Absent: Hz."},
};
static const mt_key_table units_keys = {
    .what = "units",
    .keys = UNITS,
    .n = MT_COUNT(UNITS),
    .says = "Units of numbers whose member names none. Members that end in a unit (_m, _rad, "
            "_hz) and parameters that have one stay in that. Expressions (strings) are always "
            "in SI units: \"150*mm\", \"10*deg\" say otherwise."};

static void read_file_units(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_read_units(r, value, key->of, ((mt_model *)item)->units);
}

static void read_accepted(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    (void)key;
    ((mt_model *)item)->accepted = mt_reader_accepted(r, value);
}

/* Points by name, for reading positions. Duplicates are left to mt_model_resolve. */
static void index_points(mt_model *model)
{
    mt_names *const table = &model->tables->points;
    bool taken = false;
    *table = (mt_names){0};
    for (int i = 0; i < model->n_points; i++) {
        const char *const name = model->points[i].name.s;
        if (name != NULL) {
            mt_names_add(table, &model->mem, name, i, &taken);
        }
    }
}

static void read_points(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    mt_model *const m = item;
    mt_items i = mt_reader_items(r, object);
    (void)key;
    m->points = mt_reader_room(r, &i, sizeof *m->points);
    while (mt_items_next(&i)) {
        mt_point *const p = &m->points[m->n_points++];
        p->name = mt_reader_member_name(r, i.at, MT_NAME_ITEM);
        mt_read_coordinates(mt_model_reader_of(r), i.at, p->x);
    }
    index_points(m);
}

/* Springs, then dampers, into one list. */
static void read_springs(mt_reader *r, const mt_key *key, mt_addr list, void *item)
{
    mt_model *const m = item;
    mt_items items = mt_reader_items(r, list);
    mt_items all = {.count = m->n_springs + items.count};
    mt_spring *const springs = mt_reader_room(r, &all, sizeof *springs);
    if (springs == NULL) {
        return;
    }
    if (m->n_springs > 0) {
        memcpy(springs, m->springs, (size_t)m->n_springs * sizeof *springs);
    }
    m->springs = springs;
    while (mt_items_next(&items)) {
        (void)mt_members_read(r, items.at, key->of, &springs[m->n_springs++]);
    }
}

/* Structs that begin with their name, as members of an object. */
_Static_assert(offsetof(mt_named_mode, name) == 0 && offsetof(mt_configuration, name) == 0,
               "structs by name begin with it");

static void read_by_name(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    int *const n = (int *)(void *)((char *)item + key->other);
    mt_items items = mt_reader_items(r, object);
    char *const room = mt_reader_room(r, &items, key->of->size);
    while (mt_items_next(&items)) {
        void *const one = room + ((size_t)*n * key->of->size);
        (void)mt_members_read(r, items.at, key->of, one);
        *(mt_name *)one = mt_reader_member_name(r, items.at, (mt_name_form)key->least);
        ++*n;
    }
    memcpy((char *)item + key->at, &room, sizeof room);
}

/* All numbers but those of configurations are read, from which the units of parameters
 * follow. */
static void read_configurations(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    mt_read_settle_units(mt_model_reader_of(r));
    read_by_name(r, key, object, item);
}

static const char *const FORMATS[] = {"modetune-model/1"};

#define THIS mt_model
static const mt_key MODEL[] = {
    MT_M_FREE("$schema", "This schema, for the editor."),
    {.name = "format",
     .type = MT_KEY_TEXT,
     .required = true,
     .choices = FORMATS,
     .n_choices = MT_COUNT(FORMATS),
     .says = "Kind and version of this file."},
    MT_M_TEXT("name", name, "What the model is called."),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_FREE("source", "Where it comes from: a table, a page, a test report."),
    MT_M_JUST("accepted", LIST, false, NONE,
              "Names of warnings that you know and accept: they become notes.",
              .examples = "[[\"density\"]]", .read = read_accepted, .choices = mt_warning_names,
              .n_choices = MT_WARNING_NAME_COUNT),
    {.name = "units", .type = MT_KEY_OBJECT, .read = read_file_units, .of = &units_keys},
    MT_M_COUNT("dimension", true, dimension, 2, 3, "2: plane, coordinates x and y; 3: space.",
               .schema = "\"type\": \"integer\", \"enum\": [2, 3]"),
    MT_M_LIST_OF("include", mt_include_keys,
                 "Sub-assemblies from other model files, each with a place and a prefix."),
    MT_M_LIST_OF("repeat", mt_repeat_keys,
                 "Copies of items around an axis, along a line or behind a mirror; each may "
                 "copy what those before it made, and what is included."),
    MT_I_VECTOR("gravity_m_per_s2", gravity, has_gravity, GRAVITY,
                "Acceleration of gravity in all configurations that do not give their own "
                "[m/s^2]. Absent: none.",
                .examples = "[[0, -9.81]]"),
    MT_M_JUST("curves", OBJECT, false, NONE,
              "Measured curves by name, which expressions read: \"interp(rubber, x)\".",
              .schema = MT_I_BY_NAME(MT_I_NAMES_WORD, MT_I_OF("curve")),
              .read = mt_read_curves),
    MT_M_JUST("parameters", OBJECT, false, ANY,
              "Named numbers that expressions may use and studies may change.",
              .schema = MT_I_BY_NAME(MT_I_NAMES_WORD,
                                     "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, "
                                     "{\"$ref\": \"#/definitions/parameter\"}]"),
              .read = mt_read_parameters),
    MT_M_JUST("points", OBJECT, false, POINT,
              "Named points in the reference position, in the file's units of length (m where "
              "it says none).",
              .schema = MT_I_BY_NAME(MT_I_NAMES_ITEM, MT_I_OF("vector")), .read = read_points),
    MT_M_ITEMS("bodies", false, bodies, n_bodies, mt_body, NULL, mt_body_keys,
               "Rigid bodies and point masses."),
    MT_M_ITEMS("links", false, links, n_links, mt_link, NULL, mt_link_keys, "Flexible links."),
    MT_M_ITEMS("joints", false, joints, n_joints, mt_joint, NULL, mt_joint_keys,
               "Joints between bodies, links and the ground."),
    MT_M_LIST_OF("springs", mt_spring_keys,
                 "Springs; unstressed in the reference position unless they say otherwise.",
                 .read = read_springs),
    MT_M_LIST_OF("dampers", mt_damper_keys, "Viscous dampers.", .read = read_springs),
    MT_M_ITEMS("loads", false, loads, n_loads, mt_load, NULL, mt_load_keys,
               "Dead loads: forces and moments of constant size and direction. Equilibrium is "
               "found under them, and their geometric stiffness counts."),
    MT_M_PART("damping", false, damping, mt_damping, mt_damping_keys, NULL),
    MT_M_ITEMS("sensors", false, sensors, n_sensors, mt_sensor, NULL, mt_sensor_keys,
               "Where shapes are compared: MAC and pairing use the sensors whose names both "
               "sides have."),
    MT_I_NAMED("modes", read_by_name, modes, mt_named_mode, TITLE, mt_mode_keys,
               "Names for vibration modes, which are then tracked by their shape.",
               .schema = MT_I_BY_NAME(MT_I_NAMES_TITLE, MT_I_OF("mode"))),
    MT_I_NAMED("configurations", read_configurations, configurations, mt_configuration, ITEM,
               mt_configuration_keys,
               "Named states of the mechanism. Absent or empty: one, called \"default\", that "
               "contains everything.",
               .schema = MT_I_BY_NAME(MT_I_NAMES_ITEM, MT_I_OF("configuration"))),
};
#undef THIS
const mt_key_table mt_model_keys = {
    .what = "",
    .keys = MODEL,
    .n = MT_COUNT(MODEL),
    .absent = true,
    .says = "One mechanism: bodies, flexible links, joints and springs in their reference "
            "position, and its configurations. SI units, global coordinates."};

const mt_schema_type *mt_model_types(int *n)
{
    static const mt_schema_type types[] = {
        {.name = "number",
         .says =
             "A number in the unit that the member names, else the file's or the "
             "parameter's, else SI; or an expression of the parameters as a string, in SI "
             "units: + - * / ^, sqrt, sin, min ..., interp(curve, x), pi, deg, rpm, mm, cm, "
             "inch, ft.",
         .schema = "\"type\": [\"number\", \"string\"], \"examples\": [0.25, \"2*m\", "
                   "\"10*deg\", \"150*mm\"]"},
        {.name = "vector",
         .says = "x, y, and in three dimensions z; each a number or an expression.",
         .schema = "\"type\": \"array\", \"minItems\": 2, \"maxItems\": 3, \"items\": "
                   "{\"$ref\": \"#/definitions/number\"}"},
        {.name = "position",
         .says = "The name of a point, or coordinates, in the file's units of length.",
         .schema = "\"anyOf\": [{\"type\": \"string\"}, {\"$ref\": \"#/definitions/vector\"}]"},
        {.name = "at",
         .says = "One position, or the pair of positions on the first and the second body as "
                 "drawn; then the loop is closed first.",
         .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/position\"}, {\"type\": \"array\", "
                   "\"minItems\": 2, \"maxItems\": 2, \"items\": {\"$ref\": "
                   "\"#/definitions/position\"}}]"},
        {.name = "origin",
         .says = "Where the value comes from.",
         .schema =
             "\"type\": \"string\", \"enum\": [\"published\", \"identified\", \"assumed\"]"},
    };
    *n = MT_COUNT(types);
    return types;
}

const mt_key_table *const *mt_model_key_tables(int *n)
{
    static const mt_key_table *const tables[] = {
        &mt_model_keys,   &mt_curve_keys,   &mt_parameter_keys,
        &mt_body_keys,    &mt_axes_keys,    &mt_link_keys,
        &mt_section_keys, &mt_shear_keys,   &mt_compliance_keys,
        &mt_joint_keys,   &mt_spring_keys,  &mt_damper_keys,
        &mt_sensor_keys,  &mt_mode_keys,    &mt_configuration_keys,
        &mt_drive_keys,   &mt_hold_keys,    &mt_load_keys,
        &units_keys,      &mt_damping_keys, &mt_include_keys,
        &mt_rotate_keys,  &mt_repeat_keys,  &mt_polar_keys,
        &mt_linear_keys,  &mt_mirror_keys,
    };
    *n = MT_COUNT(tables);
    return tables;
}

/* Everything behind the format: first what the others are measured in and refer to. Points
 * stand before what is at them in the table. */
static void read_model_root(mt_model_reader *mr, mt_object *root)
{
    static const char *const first[] = {"dimension", "units", "curves", "parameters"};
    for (int i = 0; i < MT_COUNT(first); i++) {
        mt_object_read_first(&mr->r, root, first[i], mr->m);
    }
    if (!mt_arena_failed(&mr->m->mem)) {
        mt_object_read(&mr->r, root, mr->m);
        mt_read_warning_units(mr);
    }
}

static int compare_addrs(const void *a, const void *b)
{
    const mt_addr x = *(const mt_addr *)a;
    const mt_addr y = *(const mt_addr *)b;
    return (x > y) - (x < y);
}

/* Addresses that are kept: of every number, and of what else is told by its place when the
 * document is gone. */
typedef struct place_list {
    int *addrs;
    int n;
} place_list;

static void add_place(place_list *list, mt_addr addr)
{
    if (addr != MT_NO_ADDR) {
        list->addrs[list->n++] = addr;
    }
}

static void add_configuration_places(const mt_model *m, int c, place_list *list)
{
    const mt_configuration *const own = &m->configurations[c];
    for (int i = 0; i < own->n_drives; i++) {
        const mt_drive *const drive = &own->drives[i];
        const bool here = drive->owner == c;
        add_place(list, here ? drive->addr : MT_NO_ADDR);
        add_place(list, here && drive->trim ? drive->trim_name.addr : MT_NO_ADDR);
    }
    add_place(list,
              own->damping.given && !own->damping.inherited ? own->damping.addr : MT_NO_ADDR);
}

static void add_places(const mt_model *m, place_list *list)
{
    for (int i = 0; i < m->n_nums; i++) {
        add_place(list, m->nums[i].addr);
    }
    for (int i = 0; i < m->n_joints; i++) {
        add_place(list, m->joints[i].name.addr);
        add_place(list, m->joints[i].n_at > 0 ? m->joints[i].at[0].addr : MT_NO_ADDR);
        add_place(list, m->joints[i].n_at > 1 ? m->joints[i].at[1].addr : MT_NO_ADDR);
    }
    for (int i = 0; i < m->n_springs; i++) {
        add_place(list, m->springs[i].name.addr);
        add_place(list, m->springs[i].n_at > 0 ? m->springs[i].at[0].addr : MT_NO_ADDR);
        add_place(list, m->springs[i].n_at > 1 ? m->springs[i].at[1].addr : MT_NO_ADDR);
    }
    for (int i = 0; i < m->n_links; i++) {
        add_place(list, m->links[i].name.addr);
    }
    for (int i = 0; i < m->n_loads; i++) {
        add_place(list, m->loads[i].at.given ? m->loads[i].at.addr : MT_NO_ADDR);
    }
    for (int c = 0; c < m->n_configurations; c++) {
        add_configuration_places(m, c, list);
    }
}

/* Keep where every number stands: the document is gone when a value turns out to be wrong. */
static void note_places(mt_model_reader *mr)
{
    mt_model *const m = mr->m;
    size_t drives = 0;
    for (int c = 0; c < m->n_configurations; c++) {
        drives += (size_t)m->configurations[c].n_drives;
    }
    const size_t most = (size_t)m->n_nums + (3 * ((size_t)m->n_joints + (size_t)m->n_springs)) +
                        (size_t)m->n_links + (size_t)m->n_loads + (size_t)m->n_configurations +
                        (2 * drives);
    m->places = mt_arena_alloc(&m->mem, most, sizeof *m->places);
    const mt_arena_mark mark = mt_arena_get_mark(&m->mem);
    place_list list = {.addrs = mt_arena_int(&m->mem, most)};
    int *const lines = mt_arena_int(&m->mem, most);
    int *const columns = mt_arena_int(&m->mem, most);
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    add_places(m, &list);
    qsort(list.addrs, (size_t)list.n, sizeof *list.addrs, compare_addrs);
    mt_json_locates(mr->r.doc, list.n, list.addrs, lines, columns);
    for (int i = 0; i < list.n; i++) {
        m->places[i] = (mt_place){.addr = list.addrs[i],
                                  .line = lines[i],
                                  .column = columns[i],
                                  .file = mt_json_file(mr->r.doc, list.addrs[i])};
    }
    m->n_places = list.n;
    mt_arena_rewind(&m->mem, mark);
    /* the document's names of files, behind what was scratch; neighbours share theirs */
    const char *last = NULL;
    for (int i = 0; i < m->n_places; i++) {
        mt_place *const p = &m->places[i];
        if (p->file != NULL && (last == NULL || strcmp(p->file, last) != 0)) {
            last = mt_arena_strdup(&m->mem, p->file);
        }
        p->file = p->file == NULL ? NULL : last;
    }
}

/* Set parameters of the model as if its file gave these values. */
static void set(mt_model_reader *mr, int n, const mt_setting *settings)
{
    mt_model *const m = mr->m;
    m->settings = mt_arena_alloc(&m->mem, (size_t)n, sizeof *settings);
    for (int i = 0; i < n && !mt_arena_failed(&m->mem); i++) {
        const mt_num value = m->parameters[settings[i].parameter].value;
        (void)mt_expr_number(settings[i].value, &m->mem, &m->nums[value].expr, NULL);
        m->settings[m->n_settings++] = settings[i];
    }
}

/* Where such a value has no effect; and what it was where the model is wrong with it. */
static void write_settings(mt_model_reader *mr)
{
    const mt_model *const m = mr->m;
    const bool wrong = mr->r.diags->errors > 0;
    for (int i = 0; i < m->n_settings; i++) {
        const mt_parameter *const p = &m->parameters[m->settings[i].parameter];
        if (wrong) {
            mt_diag_warning(mr->r.diags, m->nums[p->value].addr, "is set to %.17g",
                            m->settings[i].value);
        }
        for (int c = 0; c < m->n_configurations; c++) {
            const mt_configuration *const own = &m->configurations[c];
            for (int k = 0; k < own->n_overrides; k++) {
                if (own->overrides[k].parameter == m->settings[i].parameter) {
                    mt_diag_warning(mr->r.diags, own->overrides[k].parameter_name.addr,
                                    "configuration \"%s\" has its own value of \"%s\": to "
                                    "set it changes nothing there",
                                    own->name.s, p->name.s);
                }
            }
        }
    }
}

/* The settings are n; opt: from where files are included. */
static mt_status from_json(mt_json *doc, const char *file, const mt_io_options *opt, int n,
                           const mt_setting *settings, mt_model **out, mt_err *err)
{
    mt_model *m = NULL;
    *out = NULL;
    MT_TRY(mt_model_new(&m, err));
    mt_included_list files = {.mem = &m->mem};
    const mt_status expanded = mt_model_expand(doc, file, opt, &files, err);
    if (expanded != MT_OK) {
        mt_model_delete(m);
        return expanded == MT_E_INPUT ? mt_json_status(doc, file, err) : expanded;
    }
    m->n_included = files.n;
    m->included = files.items;
    mt_model_reader mr = {.r = {.doc = doc,
                                .diags = mt_json_diags(doc),
                                .mem = &m->mem,
                                .lookup = mt_model_lookup,
                                .context = m},
                          .m = m};
    mt_object root;
    if (mt_reader_format(&mr.r, "modetune-model/1", "model file") &&
        mt_object_match(&mr.r, MT_JSON_ROOT, &mt_model_keys, &root)) {
        read_model_root(&mr, &root);
        set(&mr, n, settings);
        (void)mt_model_resolve(m, mr.r.diags, NULL); /* the arenas remember a shortage */
        write_settings(&mr);
        note_places(&mr);
        m->path = mt_arena_strdup(&m->mem, file);
    }
    const mt_status rc = mt_reader_status(&mr.r, file, err);
    if (rc != MT_OK) {
        mt_model_delete(m);
        return rc;
    }
    *out = m;
    return MT_OK;
}

mt_status mt_model_from_json(mt_json *doc, const char *file, mt_model **out, mt_err *err)
{
    return from_json(doc, file, NULL, 0, NULL, out, err);
}

static int by_parameter(const void *a, const void *b)
{
    const mt_setting *const x = a;
    const mt_setting *const y = b;
    return (x->parameter > y->parameter) - (x->parameter < y->parameter);
}

/* Read overrides of this model's parameters. */
static mt_status read_settings(mt_model *m, const mt_overrides *asked, mt_setting **out,
                               mt_err *err)
{
    double *const original = mt_arena_f64(&m->mem, (size_t)m->n_parameters, 1);
    MT_TRY(mt_arena_check(&m->mem, err));
    MT_TRY(mt_model_original_values(m, &m->mem, original, NULL, err));
    const mt_status rc =
        mt_model_read_settings(m, original, asked->n_sets, asked->sets, &m->mem, out, err);
    if (rc == MT_OK) {
        qsort(*out, (size_t)asked->n_sets, sizeof **out, by_parameter);
    }
    return rc;
}

/* Read the file again with the overridden values; *doc is then another document. */
static mt_status read_with_settings(const mt_file *file, const char *path,
                                    const mt_io_options *opt, mt_json **doc, mt_model **model,
                                    mt_err *err)
{
    const mt_overrides *const asked = opt->asked;
    mt_model *const plain = *model;
    mt_setting *settings = NULL;
    mt_status rc = read_settings(plain, asked, &settings, err);
    if (rc == MT_OK) {
        mt_json_delete(*doc);
        rc = mt_json_parse(file->bytes, file->length, doc, err);
        *model = NULL;
        rc = rc == MT_OK ? from_json(*doc, path, opt, asked->n_sets, settings, model, err) : rc;
        mt_model_delete(plain);
    }
    return rc == MT_OK ? rc : mt_err_in(err, rc, "--set");
}

mt_status mt_model_load(const char *path, const mt_io_options *opt, mt_model **out,
                        mt_diagnostics *messages, mt_err *err)
{
    const size_t limit =
        opt != NULL && opt->max_bytes != 0 ? opt->max_bytes : MT_JSON_MAX_BYTES;
    mt_file file = {0};
    mt_json *doc = NULL;
    *out = NULL;
    MT_TRY(mt_files_read(opt == NULL ? NULL : &opt->files, path, opt == NULL ? NULL : opt->root,
                         limit, &file, err));
    mt_status rc = mt_json_parse(file.bytes, file.length, &doc, err);
    if (rc == MT_OK) {
        rc = from_json(doc, path, opt, 0, NULL, out, err);
    } else if (rc == MT_E_INPUT) {
        rc = mt_json_status(doc, path, err);
    }
    const mt_overrides *const asked = opt == NULL ? NULL : opt->asked;
    if (rc == MT_OK && *out != NULL && asked != NULL && asked->n_sets > 0) {
        rc = read_with_settings(&file, path, opt, &doc, out, err);
    }
    if (rc == MT_OK && *out != NULL) {
        (*out)->sha256 = mt_arena_strdup(&(*out)->mem, file.sha256);
        rc = mt_arena_check(&(*out)->mem, err);
    }
    if (doc != NULL && opt != NULL && opt->structural != NULL) {
        *opt->structural = mt_json_diags(doc)->structural;
    }
    if (doc != NULL && messages != NULL) {
        mt_json_report(doc, path, messages);
        rc = messages->lines.failed ? mt_fail_memory(err) : rc;
    }
    if (rc != MT_OK) {
        mt_model_delete(*out);
        *out = NULL;
    }
    mt_json_delete(doc);
    mt_file_free(&file);
    return rc;
}
