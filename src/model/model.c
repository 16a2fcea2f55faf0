/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model is made of: its items by name, the kinds of joints, units and kinds of
 * parameters. */
#include "model/model.h"

#include "modetune/model.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "expr/units.h"

/* A name of so many bytes. */
typedef struct part {
    const char *s;
    size_t length;
} part;

static int compare_with_name(const void *context, const void *key, int i)
{
    const mt_names *const t = context;
    const part *const name = key;
    const int order = strncmp(name->s, t->items[i].name, name->length);
    return order != 0 || t->items[i].name[name->length] == '\0' ? order : -1;
}

void mt_names_add(mt_names *t, mt_arena *mem, const char *name, int value, bool *taken)
{
    const part key = {name, strlen(name)};
    *taken = mt_sorted_find(&t->order, compare_with_name, t, &key) >= 0;
    if (*taken) {
        return;
    }
    mt_named *const items = mt_arena_grow(mem, t->items, t->count, &t->room, sizeof *items);
    if (items == NULL) {
        return;
    }
    t->items = items;
    if (mt_sorted_add(&t->order, mem, compare_with_name, t, &key)) {
        t->items[t->count++] = (mt_named){name, value};
    }
}

int mt_names_find(const mt_names *t, const char *name, size_t length, bool *found)
{
    const part key = {name, length};
    const int i = mt_sorted_find(&t->order, compare_with_name, t, &key);
    *found = i >= 0;
    return *found ? t->items[i].value : MT_ABSENT;
}

static const mt_joint_kind KINDS[] = {
    [MT_JOINT_FIXED] = {.in = {true, true},
                        .closes = MT_CLOSES_ALL,
                        .most_at = 2,
                        .turns = {{true, true}, {true, true}},
                        .holds = {0x23, 0x3F}},
    [MT_JOINT_REVOLUTE] = {.in = {true, true},
                           .coordinate = MT_COORDINATE_ANGLE,
                           .closes = MT_CLOSES_ALL,
                           .least_at = 1,
                           .most_at = 2,
                           .axis = {false, true},
                           .turns = {{false, false}, {true, true}},
                           .holds = {0x03, 0x1F}},
    [MT_JOINT_PRISMATIC] = {.in = {true, true},
                            .coordinate = MT_COORDINATE_DISPLACEMENT,
                            .closes = MT_CLOSES_ACROSS,
                            .least_at = 1,
                            .most_at = 2,
                            .axis = {true, true},
                            .turns = {{true, true}, {true, true}},
                            .holds = {0x21, 0x3B}},
    [MT_JOINT_PIN_IN_SLOT] = {.in = {true, false},
                              .coordinate = MT_COORDINATE_DISPLACEMENT,
                              .closes = MT_CLOSES_ACROSS,
                              .least_at = 1,
                              .most_at = 2,
                              .axis = {true, true},
                              .turns = {{true, false}, {true, false}},
                              .holds = {0x01, 0x00}},
    [MT_JOINT_DISTANCE] = {.in = {true, true},
                           .closes = MT_CLOSES_LENGTH,
                           .least_at = 2,
                           .most_at = 2},
    [MT_JOINT_CYLINDRICAL] = {.in = {false, true},
                              .coordinate = MT_COORDINATE_ANGLE,
                              .closes = MT_CLOSES_ACROSS,
                              .least_at = 1,
                              .most_at = 2,
                              .axis = {false, true},
                              .turns = {{true, true}, {true, true}},
                              .holds = {0x00, 0x1B}},
    [MT_JOINT_SPHERICAL] = {.in = {false, true},
                            .closes = MT_CLOSES_ALL,
                            .least_at = 1,
                            .most_at = 2,
                            .holds = {0x00, 0x07}},
    [MT_JOINT_UNIVERSAL] = {.in = {false, true},
                            .closes = MT_CLOSES_ALL,
                            .least_at = 1,
                            .most_at = 2,
                            .axis = {false, true},
                            .axis_b = true,
                            .turns = {{true, true}, {true, true}},
                            .holds = {0x00, 0x07}},
    [MT_JOINT_PLANAR] = {.in = {false, true},
                         .closes = MT_CLOSES_ALONG,
                         .least_at = 1,
                         .most_at = 2,
                         .axis = {false, true},
                         .turns = {{true, true}, {true, true}},
                         .holds = {0x00, 0x1C}},
    [MT_JOINT_POINT_ON_LINE] = {.in = {false, true},
                                .coordinate = MT_COORDINATE_DISPLACEMENT,
                                .closes = MT_CLOSES_ACROSS,
                                .least_at = 1,
                                .most_at = 2,
                                .axis = {false, true},
                                .turns = {{true, false}, {true, false}},
                                .holds = {0x00, 0x03}},
    [MT_JOINT_POINT_ON_PLANE] = {.in = {false, true},
                                 .closes = MT_CLOSES_ALONG,
                                 .least_at = 1,
                                 .most_at = 2,
                                 .axis = {false, true},
                                 .turns = {{true, false}, {true, false}},
                                 .holds = {0x00, 0x04}},
    [MT_JOINT_ORIENTATION] = {.in = {true, true},
                              .turns = {{true, true}, {true, true}},
                              .article = "an",
                              .holds = {0x20, 0x38}},
    [MT_JOINT_GEAR] = {.in = {true, true}, .couples = true},
    [MT_JOINT_RACK] = {.in = {true, true}, .couples = true},
};

const mt_joint_kind *mt_joint_kind_of(mt_joint_type type)
{
    return &KINDS[type];
}

const char *mt_joint_article(mt_joint_type type)
{
    return KINDS[type].article != NULL ? KINDS[type].article : "a";
}

mt_status mt_model_new(mt_model **out, mt_err *err)
{
    *out = NULL;
    mt_model *const model = calloc(1, sizeof *model);
    if (model == NULL) {
        return mt_fail_memory(err);
    }
    (void)mt_arena_init(&model->mem, 0, NULL);
    model->tables = mt_arena_alloc(&model->mem, 1, sizeof *model->tables);
    if (model->tables == NULL) {
        mt_model_delete(model);
        return mt_fail_memory(err);
    }
    for (int k = 0; k < 3; k++) {
        model->gravity[k] = MT_ABSENT;
    }
    *out = model;
    return MT_OK;
}

void mt_model_delete(mt_model *model)
{
    if (model == NULL) {
        return;
    }
    mt_arena_free(&model->mem);
    free(model);
}

mt_num mt_model_add_num(mt_model *model, mt_expr expr, mt_addr addr)
{
    mt_number *const nums =
        mt_arena_grow(&model->mem, model->nums, model->n_nums, &model->cap_nums, sizeof *nums);
    if (nums == NULL) {
        return MT_ABSENT;
    }
    model->nums = nums;
    nums[model->n_nums] = (mt_number){.expr = expr, .addr = addr};
    return model->n_nums++;
}

int mt_model_lookup(const void *model, const char *name, size_t length)
{
    const mt_model *const m = model;
    const mt_names *const table = &m->tables->parameters;
    bool found = false;
    const int i = mt_names_find(table, name, length, &found);
    if (found || table->count > 0) {
        return i;
    }
    /* a model made in memory, not finished yet */
    for (int k = 0; k < m->n_parameters; k++) {
        const char *const s = m->parameters[k].name.s;
        if (s != NULL && strlen(s) == length && memcmp(s, name, length) == 0) {
            return k;
        }
    }
    return MT_ABSENT;
}

static int find_name(const mt_names *table, const char *name)
{
    bool found = false;
    return name == NULL ? MT_ABSENT : mt_names_find(table, name, strlen(name), &found);
}

int mt_model_find_parameter(const mt_model *model, const char *name)
{
    return find_name(&model->tables->parameters, name);
}

int mt_model_find_configuration(const mt_model *model, const char *name)
{
    return find_name(&model->tables->configurations, name);
}

int mt_model_find_mode(const mt_model *model, const char *name)
{
    return find_name(&model->tables->modes, name);
}

int mt_model_find_joint(const mt_model *model, const char *name)
{
    return find_name(&model->tables->joints, name);
}

int mt_model_find_spring(const mt_model *model, const char *name)
{
    return find_name(&model->tables->springs, name);
}

int mt_model_find_sensor(const mt_model *model, const char *name)
{
    return find_name(&model->tables->sensors, name);
}

/* NULL: it is not known. */
static const mt_place *place_at(const mt_model *model, mt_addr addr)
{
    int first = 0;
    int last = model->n_places - 1;
    while (first <= last) {
        const int middle = first + (last - first) / 2;
        const mt_place *const p = &model->places[middle];
        if (p->addr == addr) {
            return p;
        }
        if (p->addr < addr) {
            first = middle + 1;
        } else {
            last = middle - 1;
        }
    }
    return NULL;
}

bool mt_model_locate(const mt_model *model, mt_addr addr, int *line, int *column)
{
    const mt_place *const p = place_at(model, addr);
    if (p != NULL) {
        *line = p->line;
        *column = p->column;
    }
    return p != NULL;
}

const char *mt_model_file(const mt_model *model, mt_addr addr)
{
    const mt_place *const p = place_at(model, addr);
    return p == NULL || p->file == NULL ? model->path : p->file;
}

bool mt_model_present(const mt_presence *in, int configuration)
{
    return in->present == NULL || in->present[configuration];
}

#define NAME_CASE(id, name) \
    case id:                \
        return name;

const char *mt_joint_type_name(mt_joint_type type)
{
    switch (type) {
        MT_JOINT_LIST(NAME_CASE)
    case MT_JOINT_TYPE_COUNT:
        break;
    }
    return "unknown";
}

const char *mt_spring_type_name(mt_spring_type type)
{
    switch (type) {
        MT_SPRING_LIST(NAME_CASE)
    case MT_SPRING_TYPE_COUNT:
        break;
    }
    return "unknown";
}

const mt_unit *mt_parameter_si(const mt_parameter *parameter)
{
    return parameter->unit == NULL ? NULL : mt_unit_find(parameter->unit);
}

const mt_unit *mt_model_shown(const mt_model *model, mt_dimension dimension)
{
    const mt_unit *const unit = model->units[dimension];
    return unit == NULL || mt_unit_is_si(unit) ? NULL : unit;
}

const mt_unit *mt_model_number_unit(const mt_model *model, int parameter)
{
    const mt_parameter *const p = &model->parameters[parameter];
    for (int d = 0; d < MT_DIMENSION_COUNT && p->written == NULL; d++) {
        if (p->kind == mt_kind_of_dimension((mt_dimension)d)) {
            return model->units[d];
        }
    }
    return p->written;
}

mt_kind mt_model_kind(const void *model, int parameter)
{
    return ((const mt_model *)model)->parameters[parameter].kind;
}

const char *mt_model_title(const mt_model *model)
{
    return model == NULL ? NULL : model->name;
}

int mt_model_dimension(const mt_model *model)
{
    return model == NULL ? 0 : model->dimension;
}

int mt_model_parameter_count(const mt_model *model)
{
    return model == NULL ? 0 : model->n_parameters;
}

const char *mt_model_parameter_name(const mt_model *model, int parameter)
{
    return model != NULL && parameter >= 0 && parameter < model->n_parameters
               ? model->parameters[parameter].name.s
               : NULL;
}

const char *mt_model_parameter_unit(const mt_model *model, int parameter)
{
    return mt_model_parameter_name(model, parameter) == NULL
               ? NULL
               : model->parameters[parameter].unit;
}

int mt_model_parameter_follows(const mt_model *model, int parameter)
{
    double value = 0.0;
    return mt_model_parameter_name(model, parameter) != NULL &&
           !mt_expr_is_constant(&model->nums[model->parameters[parameter].value].expr, &value);
}

int mt_model_configuration_count(const mt_model *model)
{
    return model == NULL ? 0 : model->n_configurations;
}

const char *mt_model_configuration_name(const mt_model *model, int configuration)
{
    return model != NULL && configuration >= 0 && configuration < model->n_configurations
               ? model->configurations[configuration].name.s
               : NULL;
}

/* Axes of an item's own. */
enum { SPACE = 3 };
/* Sine of the angle between two vectors; below it they are parallel. */
static const double PARALLEL = 1e-9;

static double value_of(mt_num num, const double *value)
{
    return num == MT_ABSENT ? 0.0 : value[num];
}

/* e := the vector, of unit length; false where it has none. */
static bool axis_of(const mt_vector x, const double *value, double e[SPACE])
{
    double largest = 0.0;
    for (int k = 0; k < SPACE; k++) {
        e[k] = value_of(x[k], value);
        largest = fmax(largest, fabs(e[k]));
    }
    for (int k = 0; k < SPACE && largest > 0.0; k++) {
        e[k] /= largest;
    }
    const double length = hypot(hypot(e[0], e[1]), e[2]);
    for (int k = 0; k < SPACE && length > 0.0; k++) {
        e[k] /= length;
    }
    return length > 0.0;
}

/* out := a x b, of unit length; false where they are parallel. */
static bool across(const double a[SPACE], const double b[SPACE], double out[SPACE])
{
    for (int k = 0; k < SPACE; k++) {
        const int i = (k + 1) % SPACE;
        const int j = (k + 2) % SPACE;
        out[k] = (a[i] * b[j]) - (a[j] * b[i]);
    }
    const double sine = hypot(hypot(out[0], out[1]), out[2]);
    for (int k = 0; k < SPACE && sine > PARALLEL; k++) {
        out[k] /= sine;
    }
    return sine > PARALLEL;
}

static void turn_axes(const mt_axes *a, const double *value, double e[SPACE][SPACE])
{
    const bool one = a->n_angles == 1;
    const double about_x = one ? 0.0 : value_of(a->angles[0], value);
    const double about_y = one ? 0.0 : value_of(a->angles[1], value);
    const double about_z = value_of(a->angles[one ? 0 : 2], value);
    const double s[] = {sin(about_x), sin(about_y), sin(about_z)};
    const double c[] = {cos(about_x), cos(about_y), cos(about_z)};
    e[0][0] = c[1] * c[2];
    e[0][1] = c[1] * s[2];
    e[0][2] = -s[1];
    e[1][0] = (s[0] * s[1] * c[2]) - (c[0] * s[2]);
    e[1][1] = (s[0] * s[1] * s[2]) + (c[0] * c[2]);
    e[1][2] = s[0] * c[1];
    (void)across(e[0], e[1], e[2]);
}

mt_axes_fault mt_axes_of(const mt_axes *a, const double *value, double e[SPACE][SPACE])
{
    static const double drawn[SPACE][SPACE] = {
        {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    double other[SPACE];
    for (int i = 0; i < SPACE; i++) {
        for (int k = 0; k < SPACE; k++) {
            e[i][k] = drawn[i][k];
        }
    }
    if (a->given && a->n_angles > 0) {
        turn_axes(a, value, e);
        return MT_AXES_SOUND;
    }
    if (!a->given || !a->has_x) {
        return MT_AXES_SOUND;
    }
    if (!axis_of(a->x, value, e[0])) {
        return MT_AXES_NO_X;
    }
    if (!a->has_y && !a->has_z) { /* in the plane */
        return across(e[2], e[0], e[1]) ? MT_AXES_SOUND : MT_AXES_PARALLEL;
    }
    if (!axis_of(a->has_y ? a->y : a->z, value, other)) {
        return MT_AXES_NO_OTHER;
    }
    const bool apart = a->has_y ? across(e[0], other, e[2]) && across(e[2], e[0], e[1])
                                : across(other, e[0], e[1]) && across(e[0], e[1], e[2]);
    return apart ? MT_AXES_SOUND : MT_AXES_PARALLEL;
}
