/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors, named modes and configurations. */
#include "model/read_priv.h"

#include <limits.h>
#include <string.h>

#include "io/reader.h"

#define SENSOR_KEYS(X)                                                                         \
    X(SENSOR_NAME, "name", TEXT, true, NONE,                                                   \
      "Name of the sensor: a letter or _, then letters, digits, _, + and -.",                  \
      .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$")                                                 \
    X(SENSOR_ON, "on", TEXT, true, NONE,                                                       \
      "A body, a link (then with fraction), or a rigid element of a link (\"L.3\").")          \
    X(SENSOR_AT, "at", TEXT_OR_LIST, false, POINT,                                             \
      "Position on a body [m]. Absent: its centre of mass.",                                   \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/position\"}]")                         \
    X(SENSOR_FRACTION, "fraction", NUMBER, false, PART,                                        \
      "Position on a link: 0 at its start, 1 at its end [1].", .examples = "[\"1/18\"]")       \
    X(SENSOR_DIRECTIONS, "directions", LIST, false, NONE,                                      \
      "What it measures: translations x, y, z and rotations rx, ry, rz; in two dimensions x, " \
      "y, r. Absent: all translations.",                                                       \
      .schema = "\"type\": \"array\", \"minItems\": 1, \"items\": {\"type\": \"string\", "     \
                "\"enum\": [\"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\", \"r\"]}")             \
    X(SENSOR_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")           \
    X(SENSOR_SOURCE, "source", TEXT, false, NONE,                                              \
      "Where it comes from: a table, a page, a test report.")
enum { SENSOR_KEYS(MT_READ_ENUM) SENSOR_COUNT };
MT_READ_TABLE(mt_sensor_keys, "sensor", SENSOR_KEYS, .says = "A sensor.");

#define MODE_KEYS(X)                                                                        \
    X(MODE_CONFIGURATION, "configuration", TEXT, true, NONE,                                \
      "The configuration in which it is counted.")                                          \
    X(MODE_INDEX, "index", COUNT, true, WHOLE,                                              \
      "Counted from 1 by ascending frequency; rigid-body modes have no index.", .least = 1, \
      .most = 2147483647)                                                                   \
    X(MODE_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")          \
    X(MODE_SOURCE, "source", TEXT, false, NONE,                                             \
      "Where it comes from: a table, a page, a test report.")
enum { MODE_KEYS(MT_READ_ENUM) MODE_COUNT };
MT_READ_TABLE(mt_mode_keys, "mode", MODE_KEYS,
              .says = "A vibration mode of the original design.");

#define CONFIGURATION_KEYS(X)                                                                \
    X(CONFIGURATION_LIKE, "like", TEXT, false, NONE,                                         \
      "Configuration whose items and settings are taken over; parameters given here are "    \
      "replaced one by one, gravity, drive and damping as a whole. An own drive must be of " \
      "the joint that the inherited one drives.")                                            \
    X(CONFIGURATION_PARAMETERS, "parameters", OBJECT, false, ANY,                            \
      "Parameters with another value in this configuration.",                                \
      .schema = "\"type\": \"object\", \"propertyNames\": {\"pattern\": "                    \
                "\"^[A-Za-z_][A-Za-z0-9_]*$\"}, \"additionalProperties\": {\"$ref\": "       \
                "\"#/definitions/number\"}")                                                 \
    X(CONFIGURATION_GRAVITY, "gravity_m_per_s2", LIST, false, GRAVITY,                       \
      "Acceleration of gravity in this configuration [m/s^2].",                              \
      .schema = "\"allOf\": [{\"$ref\": \"#/definitions/vector\"}]")                         \
    X(CONFIGURATION_DRIVE, "drive", OBJECT, false, NONE, NULL,                               \
      .schema = "\"$ref\": \"#/definitions/drive\"")                                         \
    X(CONFIGURATION_DAMPING, "damping", OBJECT, false, NONE, NULL,                           \
      .schema = "\"$ref\": \"#/definitions/damping\"")                                       \
    X(CONFIGURATION_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")  \
    X(CONFIGURATION_SOURCE, "source", TEXT, false, NONE,                                     \
      "Where it comes from: a table, a page, a test report.")
enum { CONFIGURATION_KEYS(MT_READ_ENUM) CONFIGURATION_COUNT };
MT_READ_TABLE(mt_configuration_keys, "configuration", CONFIGURATION_KEYS,
              .says = "A state of the mechanism.");

#define DRIVE_KEYS(X)                                                                         \
    X(DRIVE_JOINT, "joint", TEXT, true, NONE, "The joint.")                                   \
    X(DRIVE_RAD, "position_rad", NUMBER, false, ANGLE,                                        \
      "Angle from the reference position [rad], at most 1000 either way; joints that turn.",  \
      .examples = "[\"10*deg\"]")                                                             \
    X(DRIVE_M, "position_m", NUMBER, false, STROKE,                                           \
      "Displacement from the reference position [m], at most 1000 times the size of the "     \
      "drawing either way; joints that slide.")                                               \
    X(DRIVE_HOLD, "hold", TEXT_OR_OBJECT, false, NONE,                                        \
      "\"lock\": it is locked there; {\"trim\": S}: spring S is re-trimmed so that it holds " \
      "the position.",                                                                        \
      .otherwise = "\"lock\"",                                                                \
      .schema = "\"anyOf\": [{\"type\": \"string\", \"enum\": [\"lock\"]}, {\"$ref\": "       \
                "\"#/definitions/hold\"}]")                                                   \
    X(DRIVE_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")           \
    X(DRIVE_SOURCE, "source", TEXT, false, NONE,                                              \
      "Where it comes from: a table, a page, a test report.")
enum { DRIVE_KEYS(MT_READ_ENUM) DRIVE_COUNT };
MT_READ_TABLE(mt_drive_keys, "drive", DRIVE_KEYS, .says = "A joint that is put to a position.");

#define HOLD_KEYS(X)                                                                   \
    X(HOLD_TRIM, "trim", TEXT, true, NONE, "The spring whose rest position is moved.") \
    X(HOLD_DESCRIPTION, "description", TEXT, false, NONE, "Free text for people.")     \
    X(HOLD_SOURCE, "source", TEXT, false, NONE,                                        \
      "Where it comes from: a table, a page, a test report.")
enum { HOLD_KEYS(MT_READ_ENUM) HOLD_COUNT };
MT_READ_TABLE(mt_hold_keys, "hold", HOLD_KEYS, .says = "A spring holds the position.");

static unsigned read_directions(mt_model_reader *mr, mt_addr value)
{
    static const char *const names[] = {"x", "y", "z", "rx", "ry", "rz", "r"};
    enum { PLANAR_TRANSLATIONS = 3, TRANSLATIONS = 7, BIT_RZ = 5, SHORT_R = 6 };
    if (value == MT_NO_ADDR) {
        return mr->m->dimension == 2 ? PLANAR_TRANSLATIONS : TRANSLATIONS;
    }
    unsigned directions = 0;
    mt_items items = mt_reader_items(&mr->r, value);
    if (items.count == 0) {
        mt_diag_structure(mr->r.diags, value, "must not be empty");
    }
    while (mt_items_next(&items)) {
        const int k = mt_reader_choice(&mr->r, items.at, "direction", names, MT_COUNT(names));
        if (k == MT_ABSENT) {
            continue;
        }
        if (k == SHORT_R && mr->m->dimension == 3) {
            mt_diag_error(mr->r.diags, items.at,
                          "\"r\" is for two dimensions: name rx, ry or rz");
        }
        directions |= 1U << (k == SHORT_R ? BIT_RZ : k);
    }
    return directions;
}

static void read_sensor(mt_model_reader *mr, mt_addr value, mt_sensor *s)
{
    const int before = mr->r.diags->errors;
    mt_addr at[SENSOR_COUNT];
    (void)mt_reader_object(&mr->r, value, &mt_sensor_keys, at);
    *s = (mt_sensor){
        .on = MT_ABSENT, .element = MT_ABSENT, .directions_addr = at[SENSOR_DIRECTIONS]};
    s->name = mt_reader_name(&mr->r, at[SENSOR_NAME]);
    s->on_name = mt_reader_ref(&mr->r, at[SENSOR_ON]);
    s->at = mt_read_position(mr, at[SENSOR_AT]);
    s->fraction = mt_read_num(mr, at[SENSOR_FRACTION]);
    s->directions = read_directions(mr, at[SENSOR_DIRECTIONS]);
    if (mr->r.diags->errors > before) {
        s->on_name.s = NULL;
    }
}

void mt_read_sensors(mt_model_reader *mr, mt_addr list)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, list);
    m->sensors = mt_reader_room(&mr->r, &i, sizeof *m->sensors);
    while (mt_items_next(&i)) {
        read_sensor(mr, i.at, &m->sensors[m->n_sensors++]);
    }
}

void mt_read_modes(mt_model_reader *mr, mt_addr object)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, object);
    m->modes = mt_reader_room(&mr->r, &i, sizeof *m->modes);
    while (mt_items_next(&i)) {
        mt_named_mode *const mode = &m->modes[m->n_modes++];
        mt_addr at[MODE_COUNT];
        (void)mt_reader_object(&mr->r, i.at, &mt_mode_keys, at);
        *mode = (mt_named_mode){.configuration = MT_ABSENT, .index_addr = at[MODE_INDEX]};
        mode->name = mt_reader_member_name(&mr->r, i.at, MT_NAME_TITLE);
        mode->configuration_name = mt_reader_ref(&mr->r, at[MODE_CONFIGURATION]);
        mode->index = mt_reader_count(&mr->r, at[MODE_INDEX], 1, INT_MAX, 0);
    }
}

static mt_drive read_drive(mt_model_reader *mr, mt_addr value)
{
    static const char *const holds[] = {"lock"};
    mt_drive d = {
        .joint = MT_ABSENT, .position = MT_ABSENT, .trim_spring = MT_ABSENT, .addr = value};
    mt_addr at[DRIVE_COUNT];
    d.given = mt_reader_object(&mr->r, value, &mt_drive_keys, at);
    if (!d.given) {
        return d;
    }
    d.joint_name = mt_reader_ref(&mr->r, at[DRIVE_JOINT]);
    const mt_num angle = mt_read_num(mr, at[DRIVE_RAD]);
    const mt_num distance = mt_read_num(mr, at[DRIVE_M]);
    d.position_is_angle = at[DRIVE_RAD] != MT_NO_ADDR;
    d.position = d.position_is_angle ? angle : distance;
    if (d.position_is_angle == (at[DRIVE_M] != MT_NO_ADDR)) {
        mt_diag_error(mr->r.diags, value, "give either \"position_rad\" or \"position_m\"");
    }
    d.hold_given = at[DRIVE_HOLD] != MT_NO_ADDR;
    if (at[DRIVE_HOLD] == MT_NO_ADDR ||
        mt_json_type_of(mr->r.doc, at[DRIVE_HOLD]) == MT_JSON_STRING) {
        (void)mt_reader_choice(&mr->r, at[DRIVE_HOLD], "hold", holds, MT_COUNT(holds));
    } else {
        mt_addr hold[HOLD_COUNT];
        (void)mt_reader_object(&mr->r, at[DRIVE_HOLD], &mt_hold_keys, hold);
        d.trim = true;
        d.trim_name = mt_reader_ref(&mr->r, hold[HOLD_TRIM]);
    }
    return d;
}

/* A bare number is in the parameter's own unit. */
static void read_override(mt_model_reader *mr, mt_addr value, mt_override *o)
{
    const mt_model *const m = mr->m;
    const char *const name = o->parameter_name.s;
    const int parameter = name == NULL ? MT_ABSENT : mt_model_lookup(m, name, strlen(name));
    const bool known = parameter != MT_ABSENT;
    o->value = mt_read_num_in(mr, value, known ? m->parameters[parameter].written : NULL);
    if (known && o->value != MT_ABSENT) {
        mt_reader_check_kind(&mr->r, value, &m->nums[o->value].expr,
                             mt_model_number_unit(m, parameter));
    }
}

/* name -> number of the parameters that this configuration overrides. */
static void read_overrides(mt_model_reader *mr, mt_addr object, mt_configuration *c)
{
    mt_items items = mt_reader_items(&mr->r, object);
    c->overrides = mt_reader_room(&mr->r, &items, sizeof *c->overrides);
    while (mt_items_next(&items)) {
        mt_override *const o = &c->overrides[c->n_overrides++];
        o->parameter_name = mt_reader_member_name(&mr->r, items.at, MT_NAME_PARAMETER);
        o->parameter = MT_ABSENT;
        read_override(mr, items.at, o);
    }
}

void mt_read_configurations(mt_model_reader *mr, mt_addr object)
{
    mt_model *const m = mr->m;
    mt_items i = mt_reader_items(&mr->r, object);
    m->configurations = mt_reader_room(&mr->r, &i, sizeof *m->configurations);
    while (mt_items_next(&i)) {
        mt_configuration *const c = &m->configurations[m->n_configurations++];
        mt_addr at[CONFIGURATION_COUNT];
        (void)mt_reader_object(&mr->r, i.at, &mt_configuration_keys, at);
        *c = (mt_configuration){.like = MT_ABSENT};
        c->name = mt_reader_member_name(&mr->r, i.at, MT_NAME_ITEM);
        c->like_name = mt_reader_ref(&mr->r, at[CONFIGURATION_LIKE]);
        read_overrides(mr, at[CONFIGURATION_PARAMETERS], c);
        c->has_gravity = mt_read_vector(mr, at[CONFIGURATION_GRAVITY], c->gravity);
        c->drive = read_drive(mr, at[CONFIGURATION_DRIVE]);
        c->damping = mt_read_damping(mr, at[CONFIGURATION_DAMPING]);
    }
}
