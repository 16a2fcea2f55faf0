/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model file: the root, parameters, points and bodies, and how the parts come together. */
#include "model/read.h"

#include "model/read_priv.h"

#include "modetune/model.h"

#include <stdlib.h>
#include <string.h>

#include "expr/kind.h"
#include "io/file.h"
#include "io/json.h"
#include "io/reader.h"
#include "model/names.h"
#include "model/resolve.h"
#include "model/setting.h"
#include "model/values.h"

#define MODEL_KEYS(X)                                                                         \
    X(MODEL_SCHEMA, "$schema", TEXT, false, NONE, "This schema, for the editor.")             \
    X(MODEL_FORMAT, "format", TEXT, true, NONE, "Kind and version of this file.",             \
      .schema = "\"type\": \"string\", \"enum\": [\"modetune-model/1\"]")                     \
    X(MODEL_NAME, "name", TEXT, false, NONE, "What the model is called.")                     \
    X(MODEL_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")           \
    X(MODEL_SOURCE, "source", TEXT, false, NONE,                                              \
      "Where it comes from: a table, a page, a test report.")                                 \
    X(MODEL_ACCEPTED, "accepted", LIST, false, NONE,                                          \
      "Names of warnings that you know and accept: they become notes.",                       \
      .examples = "[[\"density\"]]", .choices = mt_warning_names,                             \
      .n_choices = MT_WARNING_NAME_COUNT)                                                     \
    X(MODEL_UNITS, "units", OBJECT, false, NONE, NULL,                                        \
      .schema = "\"$ref\": \"#/definitions/units\"")                                          \
    X(MODEL_DIMENSION, "dimension", COUNT, true, WHOLE,                                       \
      "2: plane, coordinates x and y; 3: space.",                                             \
      .schema = "\"type\": \"integer\", \"enum\": [2, 3]")                                    \
    X(MODEL_GRAVITY, "gravity_m_per_s2", LIST, false, GRAVITY,                                \
      "Acceleration of gravity in all configurations that do not give their own [m/s^2]. "    \
      "Absent: none.",                                                                        \
      .examples = "[[0, -9.81]]",                                                             \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/vector\"}]")                          \
    X(MODEL_PARAMETERS, "parameters", OBJECT, false, ANY,                                     \
      "Named numbers that expressions may use and studies may change.",                       \
      .schema =                                                                               \
          "\"type\": \"object\", \"propertyNames\": {\"pattern\": "                           \
          "\"^[A-Za-z_][A-Za-z0-9_]*$\"}, \"additionalProperties\": {\"anyOf\": [{\"$ref\": " \
          "\"#/definitions/number\"}, {\"$ref\": \"#/definitions/parameter\"}]}")             \
    X(MODEL_POINTS, "points", OBJECT, false, POINT,                                           \
      "Named points in the reference position, in the file's units of length (m where it "    \
      "says none).",                                                                          \
      .schema = "\"type\": \"object\", \"propertyNames\": {\"pattern\": "                     \
                "\"^[A-Za-z_][A-Za-z0-9_+-]*$\"}, \"additionalProperties\": {\"$ref\": "      \
                "\"#/definitions/vector\"}")                                                  \
    X(MODEL_BODIES, "bodies", LIST, false, NONE, "Rigid bodies and point masses.",            \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/body\"}")         \
    X(MODEL_LINKS, "links", LIST, false, NONE, "Flexible links.",                             \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/link\"}")         \
    X(MODEL_JOINTS, "joints", LIST, false, NONE,                                              \
      "Joints between bodies, links and the ground.",                                         \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/joint\"}")        \
    X(MODEL_SPRINGS, "springs", LIST, false, NONE,                                            \
      "Springs; unstressed in the reference position unless they say otherwise.",             \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/spring\"}")       \
    X(MODEL_DAMPERS, "dampers", LIST, false, NONE, "Viscous dampers.",                        \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/damper\"}")       \
    X(MODEL_LOADS, "loads", LIST, false, NONE,                                                \
      "Dead loads: forces and moments of constant size and direction. Equilibrium is found "  \
      "under them, and their geometric stiffness counts.",                                    \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/load\"}")         \
    X(MODEL_DAMPING, "damping", OBJECT, false, NONE, NULL,                                    \
      .schema = "\"$ref\": \"#/definitions/damping\"")                                        \
    X(MODEL_SENSORS, "sensors", LIST, false, NONE,                                            \
      "Where shapes are compared: MAC and pairing use the sensors whose names both sides "    \
      "have.",                                                                                \
      .schema = "\"type\": \"array\", \"items\": {\"$ref\": \"#/definitions/sensor\"}")       \
    X(MODEL_MODES, "modes", OBJECT, false, NONE,                                              \
      "Names for vibration modes, which are then tracked by their shape.",                    \
      .schema = "\"type\": \"object\", \"propertyNames\": {\"minLength\": 1}, "               \
                "\"additionalProperties\": {\"$ref\": \"#/definitions/mode\"}")               \
    X(MODEL_CONFIGURATIONS, "configurations", OBJECT, false, NONE,                            \
      "Named states of the mechanism. Absent or empty: one, called \"default\", that "        \
      "contains everything.",                                                                 \
      .schema = "\"type\": \"object\", \"propertyNames\": {\"pattern\": "                     \
                "\"^[A-Za-z_][A-Za-z0-9_+-]*$\"}, \"additionalProperties\": {\"$ref\": "      \
                "\"#/definitions/configuration\"}")
enum { MODEL_KEYS(MT_READ_ENUM) MODEL_COUNT };
MT_READ_TABLE(
    mt_model_keys, "", MODEL_KEYS,
    .says = "One mechanism: bodies, flexible links, joints and springs in their reference "
            "position, and its configurations. SI units, global coordinates.");

#define PARAMETER_KEYS(X)                                                                      \
    X(PARAMETER_VALUE, "value", NUMBER, true, ANY,                                             \
      "Its value: a number in its unit, or an expression, which is in SI units and may "       \
      "depend on other parameters.")                                                           \
    X(PARAMETER_UNIT, "unit", TEXT, false, NONE,                                               \
      "Unit of the number, which wins over the file's; of SI, for people and tables, or one "  \
      "that is converted: mm, N/mm, GPa, g, lb, ... Numbers that override it (in "             \
      "configurations, --set) are in it, too. \"g\" is a gram, or 9.80665 m/s^2 of a "         \
      "parameter that gravity is made of.",                                                    \
      .schema =                                                                                \
          "\"type\": \"string\", \"enum\": [\"1\", \"m\", \"m^2\", \"m^3\", \"m^4\", \"kg\", " \
          "\"kg/m\", \"kg/m^2\", \"kg/m^3\", \"kg m\", \"kg m^2\", \"s\", \"1/s\", \"Hz\", "   \
          "\"rad\", \"rad/s\", \"m/s\", \"m/s^2\", \"N\", \"N/m\", \"N/m^2\", \"Pa\", \"N "    \
          "m\", \"N m^2\", \"N m/rad\", \"N s/m\", \"N m s/rad\", \"m/rad\", \"rad/m\", "      \
          "\"J\", \"W\", \"mm\", \"cm\", \"in\", \"ft\", \"deg\", \"rpm\", \"mg\", \"g\", "    \
          "\"t\", \"oz\", \"lb\", \"slug\", \"lbf s^2/in\", \"g/mm\", \"g/m\", \"kg/mm\", "    \
          "\"lb/in\", \"lb/ft\", \"g/m^2\", \"g/cm^2\", \"kg/mm^2\", \"lb/ft^2\", "            \
          "\"g/cm^3\", \"kg/dm^3\", \"t/m^3\", \"g/mm^3\", \"kg/cm^3\", \"kg/mm^3\", "         \
          "\"t/mm^3\", \"lb/in^3\", \"lb/ft^3\", \"slug/ft^3\", \"g mm\", \"g cm\", \"g m\", " \
          "\"kg mm\", \"kg cm\", \"lb in\", \"lb ft\", \"g mm^2\", \"g cm^2\", \"kg mm^2\", "  \
          "\"kg cm^2\", \"t mm^2\", \"t m^2\", \"lb in^2\", \"lb ft^2\", \"slug ft^2\", "      \
          "\"lbf in s^2\", \"um\", \"km\", \"mm^2\", \"cm^2\", \"in^2\", \"ft^2\", \"mm^3\", " \
          "\"cm^3\", \"in^3\", \"ft^3\", \"mm^4\", \"cm^4\", \"in^4\", \"ft^4\", \"ms\", "     \
          "\"min\", \"kHz\", \"mrad\", \"mm/s\", \"in/s\", \"ft/s\", \"km/h\", \"mm/s^2\", "   \
          "\"in/s^2\", \"ft/s^2\", \"mN\", \"daN\", \"kN\", \"MN\", \"lbf\", \"kip\", "        \
          "\"kgf\", \"N/cm\", \"N/mm\", \"N/um\", \"kN/m\", \"kN/mm\", \"MN/m\", \"lbf/in\", " \
          "\"lbf/ft\", \"kip/in\", \"kip/ft\", \"kPa\", \"MPa\", \"GPa\", \"bar\", \"psi\", "  \
          "\"ksi\", \"Msi\", \"N/mm^2\", \"kN/mm^2\", \"kN/m^2\", \"lbf/in^2\", "              \
          "\"lbf/ft^2\", \"N mm\", \"N cm\", \"kN m\", \"kN mm\", \"lbf in\", \"lbf ft\", "    \
          "\"N mm^2\", \"kN m^2\", \"kN mm^2\", \"N mm/rad\", \"N cm/rad\", \"kN m/rad\", "    \
          "\"kN mm/rad\", \"MN m/rad\", \"N m/mrad\", \"lbf in/rad\", \"lbf ft/rad\", \"N "    \
          "m/deg\", \"N mm/deg\", \"kN m/deg\", \"lbf in/deg\", \"lbf ft/deg\", \"N s/mm\", "  \
          "\"kN s/m\", \"kN s/mm\", \"lbf s/in\", \"lbf s/ft\", \"N mm s/rad\", \"kN m "       \
          "s/rad\", \"lbf in s/rad\", \"lbf ft s/rad\", \"N m s/deg\", \"N mm s/deg\", "       \
          "\"deg/s\", \"mm/rad\", \"cm/rad\", \"in/rad\", \"mm/deg\", \"rad/mm\", \"deg/m\", " \
          "\"deg/mm\", \"mJ\", \"kJ\", \"kW\", \"%\"]")                                        \
    X(PARAMETER_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")        \
    X(PARAMETER_SOURCE, "source", TEXT, false, NONE,                                           \
      "Where it comes from: a table, a page, a test report.")                                  \
    X(PARAMETER_ORIGIN, "origin", TEXT, false, NONE, NULL,                                     \
      .schema = "\"$ref\": \"#/definitions/origin\"")
enum { PARAMETER_KEYS(MT_READ_ENUM) PARAMETER_COUNT };
MT_READ_TABLE(mt_parameter_keys, "parameter", PARAMETER_KEYS,
              .says = "A parameter with its documentation.");

#define BODY_KEYS(X)                                                                           \
    X(BODY_NAME, "name", TEXT, true, NONE,                                                     \
      "Name of the body: a letter or _, then letters, digits, _, + and -.",                    \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                                 \
    X(BODY_MASS, "mass_kg", NUMBER, false, NOT_NEGATIVE, "Mass [kg]. Absent: 0.")              \
    X(BODY_INERTIA, "inertia_kg_m2", NUMBER_OR_LIST, false, INERTIA,                           \
      "About the centre of mass, global axes [kg m^2]. Two dimensions: a number. Three: [xx, " \
      "yy, zz] or [xx, yy, zz, xy, xz, yz], elements of the tensor: xy is minus the integral " \
      "of x y over the mass, so that products of inertia that a CAD system gives as positive " \
      "integrals change sign. None of the principal moments is more than the other two "       \
      "together. Absent: a point mass, which has no orientation.",                             \
      .schema = "\"anyOf\": [{\"$ref\": \"#/definitions/number\"}, {\"type\": \"array\", "     \
                "\"minItems\": 3, \"maxItems\": 6, \"items\": {\"$ref\": "                     \
                "\"#/definitions/number\"}}]")                                                 \
    X(BODY_CENTRE, "centre", TEXT_OR_LIST, true, POINT, "Centre of mass [m].",                 \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/position\"}]")                         \
    X(BODY_IN, "in", LIST, false, NONE,                                                        \
      "Names of the configurations that contain this item; absent: all of them. "              \
      "Configurations that are `like` one of them contain it as well.",                        \
      .schema = "\"type\": \"array\", \"items\": {\"type\": \"string\"}")                      \
    X(BODY_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")             \
    X(BODY_SOURCE, "source", TEXT, false, NONE,                                                \
      "Where it comes from: a table, a page, a test report.")                                  \
    X(BODY_ORIGIN, "origin", TEXT, false, NONE, NULL,                                          \
      .schema = "\"$ref\": \"#/definitions/origin\"")
enum { BODY_KEYS(MT_READ_ENUM) BODY_COUNT };
MT_READ_TABLE(mt_body_keys, "body", BODY_KEYS,
              .says = "A rigid body, or without inertia_kg_m2 a point mass.");

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

const mt_schema_type *mt_model_types(int *n)
{
    static const mt_schema_type types[] = {
        {.name = "number",
         .says = "A number in the unit that the member names, else the file's or the "
                 "parameter's, else SI; or an expression of the parameters as a string, in SI "
                 "units: + - * / ^, sqrt, sin, min ..., pi, deg, rpm, mm, cm, inch, ft.",
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
        &mt_model_keys,   &mt_parameter_keys, &mt_body_keys,  &mt_link_keys,
        &mt_section_keys, &mt_shear_keys,     &mt_joint_keys, &mt_spring_keys,
        &mt_damper_keys,  &mt_sensor_keys,    &mt_mode_keys,  &mt_configuration_keys,
        &mt_drive_keys,   &mt_hold_keys,      &mt_load_keys,  &units_keys,
        &mt_damping_keys,
    };
    *n = MT_COUNT(tables);
    return tables;
}

static mt_origin read_origin(mt_model_reader *mr, mt_addr value)
{
    static const char *const names[] = {"published", "identified", "assumed"};
    /* the list lacks the first origin, none; MT_ABSENT is -1 */
    return (mt_origin)(mt_reader_choice(&mr->r, value, "origin", names, MT_COUNT(names)) + 1);
}

static void read_parameter(mt_model_reader *mr, mt_addr value, mt_parameter *p)
{
    mt_addr at[PARAMETER_COUNT];
    if (!mt_reader_type(&mr->r, value, MT_KEY_NUMBER_OR_OBJECT)) {
        return;
    }
    if (mt_json_type_of(mr->r.doc, value) != MT_JSON_OBJECT) {
        p->value = mt_read_num(mr, value);
        return;
    }
    (void)mt_reader_object(&mr->r, value, &mt_parameter_keys, at);
    mt_read_parameter_unit(mr, at[PARAMETER_UNIT], p);
    p->value = mt_read_num_in(mr, at[PARAMETER_VALUE], p->written);
    p->description = mt_reader_text(&mr->r, at[PARAMETER_DESCRIPTION]);
    p->source = mt_reader_text(&mr->r, at[PARAMETER_SOURCE]);
    p->origin = read_origin(mr, at[PARAMETER_ORIGIN]);
}

/* Expressions of lengths, angles and speeds, when all parameters are known: a parameter without
 * a unit is what its expression makes it. */
static void check_kinds(mt_model_reader *mr)
{
    const mt_model *const m = mr->m;
    for (int i = 0; i < m->n_parameters; i++) {
        if (m->parameters[i].value != MT_ABSENT) {
            const mt_number *const number = &m->nums[m->parameters[i].value];
            mt_reader_check_kind(&mr->r, number->addr, &number->expr,
                                 mt_model_number_unit(m, i));
        }
    }
}

/* Parameters are entered by name first: expressions may look ahead. */
static void read_parameters(mt_model_reader *mr, mt_addr object)
{
    mt_model *const m = mr->m;
    mt_items items = mt_reader_items(&mr->r, object);
    const int n = items.count;
    int n_more = 0;
    const char *const *const more = mt_expr_names(&n_more);
    const char **const names =
        mt_arena_alloc(&m->mem, (size_t)n + (size_t)n_more, sizeof *names);
    m->parameters = mt_reader_room(&mr->r, &items, sizeof *m->parameters);
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    m->cap_parameters = n;
    int n_names = 0;
    while (mt_items_next(&items)) {
        mt_parameter *const p = &m->parameters[m->n_parameters++];
        p->name = mt_reader_member_name(&mr->r, items.at, MT_NAME_PARAMETER);
        p->value = MT_ABSENT;
        if (p->name.s != NULL) {
            names[n_names++] = p->name.s;
        }
    }
    for (int i = 0; i < n_more; i++) {
        names[n_names++] = more[i];
    }
    mr->r.names = names;
    mr->r.n_names = n_names;
    mt_model_index_parameters(m);
    items = mt_reader_items(&mr->r, object);
    for (int k = 0; !mt_arena_failed(&m->mem) && mt_items_next(&items); k++) {
        read_parameter(mr, items.at, &m->parameters[k]);
    }
    mt_model_find_kinds(m);
    mr->r.kinds = mt_model_kind;
    check_kinds(mr);
}

static void read_points(mt_model_reader *mr, mt_addr object)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, object);
    m->points = mt_reader_room(&mr->r, &i, sizeof *m->points);
    while (mt_items_next(&i)) {
        mt_point *const p = &m->points[m->n_points++];
        p->name = mt_reader_member_name(&mr->r, i.at, MT_NAME_ITEM);
        (void)mt_read_coordinates(mr, i.at, p->x);
    }
    mt_model_index_points(m);
}

/* In two dimensions one moment; in three three moments, or six with the products; none: a point
 * mass. */
static void read_inertia(mt_model_reader *mr, mt_addr value, mt_body *b)
{
    enum { MOMENTS = 3, ALL = 6 };
    int n = 0;
    for (int k = 0; k < ALL; k++) {
        b->inertia[k] = MT_ABSENT;
    }
    b->point_mass = value == MT_NO_ADDR;
    const mt_num *const nums = mt_read_nums(mr, value, true, MOMENTS, ALL, &n);
    if (nums == NULL) {
        return;
    }
    const bool fits = mr->m->dimension == 2 ? n == 1 : n == MOMENTS || n == ALL;
    if (!fits && mr->m->dimension != 0) {
        mt_diag_error(mr->r.diags, value, "must be %s: the model has %d dimensions",
                      mr->m->dimension == 2 ? "one number"
                                            : "[xx, yy, zz] or [xx, yy, zz, xy, xz, yz]",
                      mr->m->dimension);
        return;
    }
    memcpy(b->inertia, nums, (size_t)n * sizeof *nums);
}

static void read_bodies(mt_model_reader *mr, mt_addr list)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, list);
    m->bodies = mt_reader_room(&mr->r, &i, sizeof *m->bodies);
    while (mt_items_next(&i)) {
        mt_body *const b = &m->bodies[m->n_bodies++];
        mt_addr at[BODY_COUNT];
        (void)mt_reader_object(&mr->r, i.at, &mt_body_keys, at);
        b->name = mt_reader_name(&mr->r, at[BODY_NAME]);
        b->mass = mt_read_num(mr, at[BODY_MASS]);
        read_inertia(mr, at[BODY_INERTIA], b);
        b->centre = mt_read_position(mr, at[BODY_CENTRE]);
        b->in = mt_read_presence(mr, at[BODY_IN]);
        (void)read_origin(mr, at[BODY_ORIGIN]);
    }
}

/* Everything behind the format. Points and parameters come first: positions and expressions
 * refer to them. */
static void read_model_root(mt_model_reader *mr, const mt_addr *at)
{
    mt_model *const m = mr->m;
    m->name = mt_reader_text(&mr->r, at[MODEL_NAME]);
    m->description = mt_reader_text(&mr->r, at[MODEL_DESCRIPTION]);
    m->accepted = mt_reader_accepted(&mr->r, at[MODEL_ACCEPTED]);
    m->dimension = mt_reader_count(&mr->r, at[MODEL_DIMENSION], 2, 3, 0);
    m->dimension_addr = at[MODEL_DIMENSION];
    mt_read_units(&mr->r, at[MODEL_UNITS], &units_keys, m->units);
    read_parameters(mr, at[MODEL_PARAMETERS]);
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    m->has_gravity = mt_read_vector(mr, at[MODEL_GRAVITY], m->gravity);
    read_points(mr, at[MODEL_POINTS]);
    read_bodies(mr, at[MODEL_BODIES]);
    mt_read_links(mr, at[MODEL_LINKS]);
    mt_read_joints(mr, at[MODEL_JOINTS]);
    mt_read_springs(mr, at[MODEL_SPRINGS], at[MODEL_DAMPERS]);
    mt_read_loads(mr, at[MODEL_LOADS]);
    mt_read_sensors(mr, at[MODEL_SENSORS]);
    mt_read_modes(mr, at[MODEL_MODES]);
    m->damping = mt_read_damping(mr, at[MODEL_DAMPING]);
    mt_read_settle_units(mr);
    mt_read_configurations(mr, at[MODEL_CONFIGURATIONS]);
    mt_read_warning_units(mr);
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
        const mt_configuration *const own = &m->configurations[c];
        const bool drives = own->drive.given && !own->drive.inherited;
        add_place(list, drives ? own->drive.addr : MT_NO_ADDR);
        add_place(list, drives && own->drive.trim ? own->drive.trim_name.addr : MT_NO_ADDR);
        add_place(list, own->damping.given && !own->damping.inherited ? own->damping.addr
                                                                      : MT_NO_ADDR);
    }
}

/* Keep where every number stands: the document is gone when a value turns out to be wrong. */
static void note_places(mt_model_reader *mr)
{
    mt_model *const m = mr->m;
    const size_t most = (size_t)m->n_nums + (3 * ((size_t)m->n_joints + (size_t)m->n_springs)) +
                        (size_t)m->n_links + (size_t)m->n_loads +
                        (3 * (size_t)m->n_configurations);
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
        m->places[i] =
            (mt_place){.addr = list.addrs[i], .line = lines[i], .column = columns[i]};
    }
    m->n_places = list.n;
    mt_arena_rewind(&m->mem, mark);
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

static mt_status from_json(mt_json *doc, const char *file, int n, const mt_setting *settings,
                           mt_model **out, mt_err *err)
{
    mt_model *m = NULL;
    *out = NULL;
    MT_TRY(mt_model_new(&m, err));
    mt_model_reader mr = {.r = {.doc = doc,
                                .diags = mt_json_diags(doc),
                                .mem = &m->mem,
                                .lookup = mt_model_lookup,
                                .context = m},
                          .m = m};
    mt_addr at[MODEL_COUNT];
    if (mt_reader_format(&mr.r, "modetune-model/1", "model file") &&
        mt_reader_object(&mr.r, MT_JSON_ROOT, &mt_model_keys, at)) {
        read_model_root(&mr, at);
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
    return from_json(doc, file, 0, NULL, out, err);
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
                                    const mt_overrides *asked, mt_json **doc, mt_model **model,
                                    mt_err *err)
{
    mt_model *const plain = *model;
    mt_setting *settings = NULL;
    mt_status rc = read_settings(plain, asked, &settings, err);
    if (rc == MT_OK) {
        mt_json_delete(*doc);
        rc = mt_json_parse(file->bytes, file->length, doc, err);
        *model = NULL;
        rc = rc == MT_OK ? from_json(*doc, path, asked->n_sets, settings, model, err) : rc;
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
        rc = mt_model_from_json(doc, path, out, err);
    } else if (rc == MT_E_INPUT) {
        rc = mt_json_status(doc, path, err);
    }
    const mt_overrides *const asked = opt == NULL ? NULL : opt->asked;
    if (rc == MT_OK && *out != NULL && asked != NULL && asked->n_sets > 0) {
        rc = read_with_settings(&file, path, asked, &doc, out, err);
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
