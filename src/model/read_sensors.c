/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors, named modes and configurations. */
#include "model/read_priv.h"

#include <limits.h>
#include <string.h>

#include "io/reader.h"

static const char *const DIRECTIONS[] = {"x", "y", "z", "rx", "ry", "rz", "r"};

static void read_directions(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    enum { PLANAR_TRANSLATIONS = 3, TRANSLATIONS = 7, BIT_RZ = 5, SHORT_R = 6 };
    const int dimension = mt_model_reader_of(r)->m->dimension;
    mt_sensor *const s = item;
    mt_items items = mt_reader_items(r, value);
    if (value == MT_NO_ADDR) {
        s->directions = dimension == 2 ? PLANAR_TRANSLATIONS : TRANSLATIONS;
    } else if (items.count == 0) {
        mt_diag_structure(r->diags, value, "must not be empty");
    }
    while (mt_items_next(&items)) {
        const int k = mt_reader_choice(r, items.at, "direction", key->choices, key->n_choices);
        if (k == SHORT_R && dimension == 3) {
            mt_diag_error(r->diags, items.at, "\"r\" is for two dimensions: name rx, ry or rz");
        }
        s->directions |= k == MT_ABSENT ? 0 : 1U << (k == SHORT_R ? BIT_RZ : k);
    }
}

static void sensor_defaults(void *item, mt_addr addr, int which)
{
    mt_sensor *const s = item;
    (void)which;
    s->on = MT_ABSENT;
    s->element = MT_ABSENT;
    s->addr = addr;
}

static void sensor_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_sensor *const s = item;
    (void)which;
    s->on_name.s = mt_object_wrong(r, o) ? NULL : s->on_name.s;
}

#define THIS mt_sensor
static const mt_key SENSOR[] = {
    MT_I_NAME("sensor"),
    MT_M_REF("on", true, on_name,
             "A body, a link (then with fraction), or a rigid element of a link (\"L.3\")."),
    MT_I_POSITION("at", false, at, "Position on a body [m]. Absent: its centre of mass."),
    MT_I_NUM("fraction", false, fraction, PART,
             "Position on a link: 0 at its start, 1 at its end [1].", .examples = "[\"1/18\"]"),
    MT_M_JUST("directions", LIST, false, NONE,
              "What it measures: translations x, y, z and rotations rx, ry, rz; in two "
              "dimensions x, y, r. Absent: all translations.",
              .read = read_directions, .least = 1, .choices = DIRECTIONS,
              .n_choices = MT_COUNT(DIRECTIONS)),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_sensor_keys = {MT_I_TABLE("sensor", SENSOR, mt_sensor),
                                     .defaults = sensor_defaults, .finish = sensor_finish,
                                     .says = "A sensor."};

#define THIS mt_named_mode
static const mt_key MODE[] = {
    MT_M_REF("configuration", true, configuration_name,
             "The configuration in which it is counted."),
    MT_M_COUNT("index", true, index, 1, INT_MAX,
               "Counted from 1 by ascending frequency; rigid-body modes have no index."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_mode_keys = {MT_I_TABLE("mode", MODE, mt_named_mode),
                                   .says = "A vibration mode of the original design."};

#define THIS mt_drive
static const mt_key HOLD[] = {
    MT_M_REF("trim", true, trim_name, "The spring whose rest position is moved."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
const mt_key_table mt_hold_keys = {
    .what = "hold", .keys = HOLD, .n = MT_COUNT(HOLD), .says = "A spring holds the position."};

/* One place for both positions; two of them are refused. */
static void read_angle(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_drive *const d = item;
    d->position_is_angle = value != MT_NO_ADDR;
    mt_item_num(r, key, value, item);
}

static void read_displacement(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_drive *const d = item;
    const mt_num angle = d->position;
    mt_item_num(r, key, value, item);
    d->position = d->position_is_angle ? angle : d->position;
}

/* "lock", or the spring that holds the position. */
static void read_hold(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    static const char *const holds[] = {"lock"};
    mt_drive *const d = item;
    (void)key;
    d->hold_given = value != MT_NO_ADDR;
    d->trim = d->hold_given && mt_json_type_of(r->doc, value) == MT_JSON_OBJECT;
    if (d->trim) {
        (void)mt_members_read(r, value, &mt_hold_keys, d);
    } else {
        (void)mt_reader_choice(r, value, "hold", holds, MT_COUNT(holds));
    }
}

static void drive_defaults(void *item, mt_addr addr, int which)
{
    mt_drive *const d = item;
    (void)which;
    d->given = addr != MT_NO_ADDR;
    d->joint = MT_ABSENT;
    d->trim_spring = MT_ABSENT;
    d->addr = addr;
}

static void drive_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    const mt_drive *const d = item;
    (void)which;
    if (d->given && d->position_is_angle == (mt_object_value(o, "position_m") != MT_NO_ADDR)) {
        mt_diag_error(r->diags, o->addr, "give either \"position_rad\" or \"position_m\"");
    }
}

static const mt_key DRIVE[] = {
    MT_M_REF("joint", true, joint_name, "The joint."),
    MT_M_JUST(
        "position_rad", NUMBER, false, ANGLE,
        "Angle from the reference position [rad], at most 1000 either way; joints that turn.",
        .examples = "[\"10*deg\"]", .read = read_angle, .at = MT_M_PLACE(mt_num, position)),
    MT_M_JUST("position_m", NUMBER, false, STROKE,
              "Displacement from the reference position [m], at most 1000 times the size of "
              "the drawing either way; joints that slide.",
              .read = read_displacement, .at = MT_M_PLACE(mt_num, position)),
    MT_M_JUST("hold", TEXT_OR_OBJECT, false, NONE,
              "\"lock\": it is locked there; {\"trim\": S}: spring S is re-trimmed so that it "
              "holds the position.",
              .otherwise = "\"lock\"",
              .schema = "\"anyOf\": [{\"type\": \"string\", \"enum\": [\"lock\"]}, {\"$ref\": "
                        "\"#/definitions/hold\"}]",
              .read = read_hold),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_drive_keys = {MT_I_TABLE("drive", DRIVE, mt_drive),
                                    .defaults = drive_defaults, .finish = drive_finish,
                                    .says = "A joint that is put to a position."};

/* A bare number is in the parameter's own unit. */
static void read_override(mt_model_reader *mr, mt_addr value, mt_override *o)
{
    const mt_model *const m = mr->m;
    const char *const name = o->parameter_name.s;
    const int parameter = name == NULL ? MT_ABSENT : mt_model_lookup(m, name, strlen(name));
    const bool known = parameter != MT_ABSENT;
    o->value = mt_read_num(mr, value, MT_POSSIBLE_NONE,
                           known ? m->parameters[parameter].written : NULL);
    if (known && o->value != MT_ABSENT) {
        mt_reader_check_kind(&mr->r, value, &m->nums[o->value].expr,
                             mt_model_number_unit(m, parameter));
    }
}

/* name -> number of the parameters that this configuration overrides. */
static void read_overrides(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    mt_configuration *const c = item;
    mt_items items = mt_reader_items(r, object);
    (void)key;
    c->overrides = mt_reader_room(r, &items, sizeof *c->overrides);
    while (mt_items_next(&items)) {
        mt_override *const o = &c->overrides[c->n_overrides++];
        o->parameter_name = mt_reader_member_name(r, items.at, MT_NAME_PARAMETER);
        o->parameter = MT_ABSENT;
        read_override(mt_model_reader_of(r), items.at, o);
    }
}

#define THIS mt_configuration
static const mt_key CONFIGURATION[] = {
    MT_M_REF("like", false, like_name,
             "Configuration whose items and settings are taken over; parameters given here are "
             "replaced one by one, gravity, drive and damping as a whole. An own drive must be "
             "of the joint that the inherited one drives."),
    MT_M_JUST("parameters", OBJECT, false, ANY,
              "Parameters with another value in this configuration.",
              .schema = MT_I_BY_NAME(MT_I_NAMES_WORD, MT_I_OF("number")),
              .read = read_overrides),
    MT_I_VECTOR("gravity_m_per_s2", gravity, has_gravity, GRAVITY,
                "Acceleration of gravity in this configuration [m/s^2]."),
    MT_M_STRUCT("drive", mt_drive, drive, mt_drive_keys),
    MT_M_STRUCT("damping", mt_damping, damping, mt_damping_keys),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_configuration_keys = {
    MT_I_TABLE("configuration", CONFIGURATION, mt_configuration),
    .says = "A state of the mechanism."};
