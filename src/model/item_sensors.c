/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors: on a body, on a link at a fraction of its length, or at the centre of one rigid
 * element; and named modes. */
#include <limits.h>
#include <string.h>

#include "model/item.h"

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

enum { ROTATIONS = 8 | 16 | 32, PLANAR = 1 | 2 | 32 };

/* A link without a part: the sensor sits on it at `fraction`. */
static bool on_whole_link(mt_resolve *f, mt_sensor *s)
{
    bool found = false; /* tells absent (-1) from link 0, which has the same value */
    const char *const on = s->on_name.s == NULL ? "" : s->on_name.s;
    const int part = mt_names_find(&f->m->tables->bodies, on, strlen(on), &found);
    const int link = found && part < 0 ? -1 - part : MT_ABSENT;
    if (link == MT_ABSENT) {
        return false;
    }
    s->on_kind = MT_ATTACH_LINK_START;
    s->on = link;
    s->element = MT_ABSENT;
    double value = 0.0;
    if (s->fraction == MT_ABSENT) {
        mt_diag_error(f->d, s->on_name.addr,
                      "sensor \"%s\" sits on a link and needs \"fraction\"", s->name.s);
    } else if (mt_expr_is_constant(&f->m->nums[s->fraction].expr, &value) &&
               !(value >= 0.0 && value <= 1.0)) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->fraction),
                      "fraction %g is not within 0 and 1", value);
    }
    if (s->at.given) {
        mt_diag_error(f->d, s->at.addr,
                      "a sensor on a link has no \"at\": its place is \"fraction\"");
    }
    return true;
}

static void on_part(mt_resolve *f, mt_sensor *s)
{
    mt_attach a = {.name = s->on_name};
    const int before = f->d->errors;
    mt_resolve_attach(f, &a);
    s->on_kind = a.kind;
    s->on = a.index;
    s->element = a.element;
    if (f->d->errors > before) {
        return;
    }
    if (a.kind != MT_ATTACH_BODY && a.kind != MT_ATTACH_LINK_ELEMENT) {
        mt_diag_error(f->d, s->on_name.addr,
                      "a sensor sits on a body, a link (with \"fraction\") or an element of "
                      "one, not on \"%s\"",
                      s->on_name.s);
    } else if (s->fraction != MT_ABSENT) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, s->fraction),
                      "\"fraction\" is for a sensor on a whole link");
    }
    if (!mt_resolve_is_point_mass(f, &a)) {
        return;
    }
    if ((s->directions & ROTATIONS) != 0) {
        mt_diag_error(f->d, mt_diag_member(f->d, s->addr, "directions"),
                      "\"%s\" is a point mass, which does not turn", s->on_name.s);
    }
    if (s->at.given && !mt_resolve_same_position(f->m, &s->at, &f->m->bodies[a.index].centre)) {
        mt_diag_error(f->d, s->at.addr,
                      "\"%s\" is a point mass: its motion is known at its centre only",
                      s->on_name.s);
    }
}

void mt_resolve_sensors(mt_resolve *f)
{
    for (int i = 0; i < f->m->n_sensors; i++) {
        mt_sensor *const s = &f->m->sensors[i];
        mt_resolve_position(f, &s->at);
        if (s->on_name.s == NULL) {
            continue; /* could not be read */
        }
        if (!on_whole_link(f, s)) {
            on_part(f, s);
        }
        if (f->m->dimension == 2 && (s->directions & ~(unsigned)PLANAR) != 0) {
            mt_diag_error(f->d, mt_diag_member(f->d, s->addr, "directions"),
                          "directions in two dimensions are x, y and r");
        }
    }
}
