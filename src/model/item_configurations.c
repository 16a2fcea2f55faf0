/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Configurations: their drives, their damping, what they override and what they take over from
 * others. */
#include <string.h>

#include "io/reader.h"
#include "model/item.h"
#include "model/model.h"

/* Damping of a model and of its configurations. */

/* name -> ratio of the named modes. */
static void read_named(mt_reader *r, const mt_key *key, mt_addr object, void *item)
{
    mt_damping *const d = item;
    mt_items items = mt_reader_items(r, object);
    d->named = mt_reader_room(r, &items, sizeof *d->named);
    while (mt_items_next(&items)) {
        mt_mode_ratio *const m = &d->named[d->n_named++];
        m->mode_name = mt_reader_member_name(r, items.at, MT_NAME_TITLE);
        m->mode = MT_ABSENT;
        m->ratio = mt_read_num(mt_model_reader_of(r), items.at, key->possible, NULL);
    }
}

static void damping_defaults(void *item, mt_addr addr, int which)
{
    mt_damping *const d = item;
    (void)which;
    d->given = addr != MT_NO_ADDR;
    d->addr = addr;
}

#define THIS mt_damping
static const mt_key DAMPING[] = {
    MT_I_NUM(
        "ratio", false, ratio, RATIO,
        "Damping ratio of every vibration mode that ratios and modes leave out; not negative.",
        .examples = "[0.02]"),
    MT_I_NUMS("ratios", LIST, ratios, n_ratios, RATIO, 1, MT_MAX_LIST,
              "Damping ratios of vibration modes 1, 2, ...; not negative."),
    MT_M_JUST("modes", OBJECT, false, RATIO,
              "Damping ratios of modes that the model names; not negative.",
              .schema = MT_I_BY_NAME("", MT_I_OF("number")), .read = read_named),
    MT_I_NUM("mass_per_s", false, mass, NOT_NEGATIVE,
             "Proportional damping: C has so many times the mass matrix [1/s]; not negative."),
    MT_I_NUM("stiffness_s", false, stiffness, NOT_NEGATIVE,
             "Proportional damping: C has so many times the stiffness matrix [s], the tangent "
             "stiffness with all loads and preload; not negative."),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_damping_keys = {
    MT_I_TABLE("damping", DAMPING, mt_damping), .defaults = damping_defaults,
    .says = "Damping besides dampers and loss factors: C = mass_per_s M + stiffness_s K + M "
            "Phi diag(2 ratio_j omega_j) Phi^T M. That of a configuration takes the place of "
            "all of the one that it would inherit."};

/* True where configuration c inherits the damping of `owner` through `like`. */
static bool takes_over(const mt_model *m, int c, int owner)
{
    while (c != owner && c != MT_ABSENT && !m->configurations[c].damping.given) {
        c = m->configurations[c].like;
    }
    return c == owner;
}

/* owner: the configuration; MT_ABSENT: the model. */
static void check_named(mt_resolve *f, mt_damping *d, int owner)
{
    const mt_model *const m = f->m;
    for (int i = 0; i < d->n_named; i++) {
        mt_mode_ratio *const own = &d->named[i];
        own->mode = mt_resolve_find(f, own->mode_name, &m->tables->modes, "mode");
        if (own->mode == MT_ABSENT) {
            continue;
        }
        const mt_named_mode *const mode = &m->modes[own->mode];
        if (mode->configuration == MT_ABSENT) {
            continue; /* noted where the mode stands */
        }
        if (!takes_over(m, mode->configuration, owner)) {
            mt_diag_error(f->d, own->mode_name.addr,
                          "mode \"%s\" is named in configuration \"%s\", which has another "
                          "damping",
                          mode->name.s, m->configurations[mode->configuration].name.s);
        }
        for (int k = 0; k < i; k++) {
            const mt_named_mode *const other =
                d->named[k].mode == MT_ABSENT ? NULL : &m->modes[d->named[k].mode];
            if (other != NULL && other->configuration == mode->configuration &&
                other->index == mode->index) {
                mt_diag_error(f->d, own->mode_name.addr, "\"%s\" and \"%s\" name the same mode",
                              other->name.s, mode->name.s);
            }
        }
    }
}

/* Names in damping, before anything is inherited. */
static void resolve_damping(mt_resolve *f)
{
    check_named(f, &f->m->damping, MT_ABSENT);
    for (int c = 0; c < f->m->n_configurations; c++) {
        check_named(f, &f->m->configurations[c].damping, c);
    }
}

/* Configurations and their drives. */

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
    d->joint = MT_ABSENT;
    d->trim_spring = MT_ABSENT;
    d->position = MT_ABSENT;
    d->addr = addr;
}

static void drive_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    const mt_drive *const d = item;
    (void)which;
    const bool displaced = mt_object_value(o, "position_m") != MT_NO_ADDR;
    if (d->release && (d->position_is_angle || displaced || d->hold_given)) {
        mt_diag_error(r->diags, o->addr,
                      "a joint that is free has neither a position nor a hold");
    } else if (!d->release && d->position_is_angle == displaced) {
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
    MT_M_FLAG("free", false, release,
              "true: the joint, which the configuration that this one is like drives, is not "
              "driven; without position and hold.",
              .otherwise = "false"),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_drive_keys = {MT_I_TABLE("drive", DRIVE, mt_drive),
                                    .defaults = drive_defaults, .finish = drive_finish,
                                    .says = "A joint that is put to a position."};

/* One drive, or a list of them. */
static void read_drives(mt_reader *r, const mt_key *key, mt_addr value, void *item)
{
    mt_configuration *const c = item;
    const bool list = value != MT_NO_ADDR && mt_json_type_of(r->doc, value) == MT_JSON_ARRAY;
    mt_read_items(r, key, value, item);
    c->n_own_drives = c->n_drives;
    for (int i = 0; i < c->n_drives; i++) {
        c->drives[i].item = list ? i : -1;
    }
}

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
             "replaced one by one, drives joint by joint, gravity and damping as a whole."),
    MT_M_JUST("parameters", OBJECT, false, ANY,
              "Parameters with another value in this configuration.",
              .schema = MT_I_BY_NAME(MT_I_NAMES_WORD, MT_I_OF("number")),
              .read = read_overrides),
    MT_I_VECTOR("gravity_m_per_s2", gravity, has_gravity, GRAVITY,
                "Acceleration of gravity in this configuration [m/s^2]."),
    {.name = "drive",
     .type = MT_KEY_OBJECT_OR_LIST,
     .read = read_drives,
     .at = MT_M_PLACE(mt_drive *, drives),
     .other = MT_M_PLACE(int, n_drives),
     .most = MT_DRIVES_MOST,
     .of = &mt_drive_keys,
     .says = "The joint, or a list of the joints, that are put to positions; a joint that the "
             "configuration is like drives stays driven unless it is named here. Several "
             "joints are moved together, in proportion, from the drawing to their positions; "
             "each needs a freedom of its own."},
    MT_M_PART("damping", false, damping, mt_damping, mt_damping_keys, NULL),
    MT_M_DESCRIPTION,
    MT_M_SOURCE,
};
#undef THIS
const mt_key_table mt_configuration_keys = {
    MT_I_TABLE("configuration", CONFIGURATION, mt_configuration),
    .says = "A state of the mechanism."};

/* Configurations: `like`, what is inherited through it (overrides, gravity, drives), and which
 * items each contains. */

enum { UNSEEN, ON_PATH, DONE };

/* "a -> b -> a": from configuration c along `like` back to c. */
static void note_like_cycle(mt_resolve *f, int c)
{
    const mt_configuration *const all = f->m->configurations;
    mt_resolve_ring ring = {.first = all[c].name.s};
    for (int at = all[c].like; at != c; at = all[at].like) {
        mt_resolve_ring_add(&ring, all[at].name.s);
    }
    mt_resolve_ring_end(&ring);
    mt_diag_error(f->d, all[c].like_name.addr,
                  "configurations are like each other in a circle: %s", ring.text);
}

/* Walk along `like` from c; a walk that meets itself is cut there. state [n_configurations]. */
static void check_like(mt_resolve *f, int c, int *state)
{
    mt_configuration *const all = f->m->configurations;
    int at = c;
    while (at != MT_ABSENT && state[at] == UNSEEN) {
        state[at] = ON_PATH;
        at = all[at].like;
    }
    const int again = at != MT_ABSENT && state[at] == ON_PATH ? at : MT_ABSENT;
    for (at = c; at != MT_ABSENT && state[at] == ON_PATH; at = all[at].like) {
        state[at] = DONE;
    }
    if (again != MT_ABSENT) {
        note_like_cycle(f, again);
        all[again].like = MT_ABSENT;
    }
}

/* order[n_configurations]: all configurations, each after the one that it is like. chain
 * [n_configurations] is work; state [n_configurations] is 0 on entry. */
static void find_order(mt_resolve *f, int *chain, int *state)
{
    const int n = f->m->n_configurations;
    int done = 0;
    for (int c = 0; c < n; c++) {
        int depth = 0;
        for (int at = c; at != MT_ABSENT && state[at] == UNSEEN;
             at = f->m->configurations[at].like) {
            state[at] = DONE;
            chain[depth++] = at;
        }
        while (depth > 0) {
            f->order[done++] = chain[--depth];
        }
    }
}

/* Own overrides first, then inherited ones that are not overridden. overridden [n_parameters]
 * is false before and after. */
static void inherit_overrides(mt_resolve *f, mt_configuration *c, bool *overridden)
{
    const mt_configuration *const parent = &f->m->configurations[c->like];
    const int own = c->n_overrides;
    if (parent->n_overrides == 0) {
        return;
    }
    mt_override *const all =
        mt_arena_alloc(&f->m->mem, (size_t)own + (size_t)parent->n_overrides, sizeof *all);
    if (all == NULL) {
        return;
    }
    if (own > 0) {
        memcpy(all, c->overrides, (size_t)own * sizeof *all);
    }
    c->overrides = all;
    for (int i = 0; i < own; i++) {
        if (all[i].parameter != MT_ABSENT) {
            overridden[all[i].parameter] = true;
        }
    }
    for (int i = 0; i < parent->n_overrides; i++) {
        const int parameter = parent->overrides[i].parameter;
        if (parameter == MT_ABSENT || !overridden[parameter]) {
            all[c->n_overrides++] = parent->overrides[i];
        }
    }
    for (int i = 0; i < own; i++) {
        if (all[i].parameter != MT_ABSENT) {
            overridden[all[i].parameter] = false;
        }
    }
}

static const mt_drive *drive_named(int n, const mt_drive *drives, const char *joint)
{
    for (int i = 0; i < n && joint != NULL; i++) {
        if (drives[i].joint_name.s != NULL && strcmp(drives[i].joint_name.s, joint) == 0) {
            return &drives[i];
        }
    }
    return NULL;
}

/* A joint is driven once, and only a driven one can be released. parent: NULL: none. */
static void check_own_drives(mt_resolve *f, const mt_configuration *c,
                             const mt_configuration *parent)
{
    for (int i = 0; i < c->n_drives; i++) {
        const mt_drive *const own = &c->drives[i];
        const char *const joint = own->joint_name.s;
        if (drive_named(i, c->drives, joint) != NULL) {
            mt_diag_error(f->d, own->joint_name.addr, "joint \"%s\" is driven twice", joint);
        } else if (own->release && joint != NULL &&
                   (parent == NULL ||
                    drive_named(parent->n_drives, parent->drives, joint) == NULL)) {
            mt_diag_error(f->d, own->addr,
                          "joint \"%s\" is free already: the configuration is like none that "
                          "drives it",
                          joint);
        }
    }
}

/* Own drives, and inherited ones of other joints; what is released is gone. */
static void inherit_drives(mt_resolve *f, mt_configuration *c, const mt_configuration *parent)
{
    const int inherited = parent == NULL ? 0 : parent->n_drives;
    const size_t most = (size_t)c->n_drives + (size_t)inherited;
    check_own_drives(f, c, parent);
    mt_drive *const all = mt_arena_alloc(&f->m->mem, most, sizeof *all);
    int n = 0;
    for (int i = 0; i < c->n_drives && all != NULL; i++) {
        if (!c->drives[i].release) {
            all[n++] = c->drives[i];
            all[n - 1].owner = (int)(c - f->m->configurations);
        }
    }
    for (int i = 0; i < inherited && all != NULL; i++) {
        const mt_drive *const other = &parent->drives[i];
        if (drive_named(c->n_drives, c->drives, other->joint_name.s) == NULL) {
            all[n++] = *other;
        }
    }
    if (n > MT_DRIVES_MOST) {
        mt_diag_error(f->d, c->name.addr, "%d joints are driven: at most %d can be", n,
                      (int)MT_DRIVES_MOST);
        n = MT_DRIVES_MOST;
    }
    c->drives = all;
    c->n_drives = n;
}

/* Settings in force: own, else those of the configuration it is like, else the model's. */
static void inherit(mt_resolve *f, mt_configuration *c, bool *overridden)
{
    const mt_configuration *const parent =
        c->like == MT_ABSENT ? NULL : &f->m->configurations[c->like];
    for (int i = 0; i < c->n_overrides; i++) {
        mt_override *const o = &c->overrides[i];
        o->parameter =
            mt_resolve_find(f, o->parameter_name, &f->m->tables->parameters, "parameter");
    }
    if (parent != NULL) {
        inherit_overrides(f, c, overridden);
    }
    const bool model_has = parent == NULL && f->m->has_gravity;
    if (!c->has_gravity && (model_has || (parent != NULL && parent->has_gravity))) {
        c->has_gravity = true;
        memcpy(c->gravity, model_has ? f->m->gravity : parent->gravity, sizeof c->gravity);
    }
    inherit_drives(f, c, parent);
    if (!c->damping.given) {
        c->damping = parent != NULL ? parent->damping : f->m->damping;
        c->damping.inherited = true;
    }
}

/* present[c]: c is named, or the configuration that c is like contains the item. */
static void resolve_presence(mt_resolve *f, mt_presence *in)
{
    mt_model *const m = f->m;
    if (!in->given) {
        return;
    }
    bool *const present = mt_arena_alloc(&m->mem, (size_t)m->n_configurations, sizeof *present);
    if (present == NULL) {
        return;
    }
    for (int i = 0; i < in->names.count; i++) {
        const int c =
            mt_resolve_find(f, in->names.items[i], &m->tables->configurations, "configuration");
        if (c != MT_ABSENT) {
            present[c] = true;
        }
    }
    for (int i = 0; i < m->n_configurations; i++) {
        const int c = f->order[i];
        const int like = m->configurations[c].like;
        present[c] = present[c] || (like != MT_ABSENT && present[like]);
    }
    in->present = present;
}

static void resolve_all_presence(mt_resolve *f)
{
    mt_model *const m = f->m;
    for (int i = 0; i < m->n_bodies; i++) {
        resolve_presence(f, &m->bodies[i].in);
    }
    for (int i = 0; i < m->n_links; i++) {
        resolve_presence(f, &m->links[i].in);
    }
    for (int i = 0; i < m->n_joints; i++) {
        resolve_presence(f, &m->joints[i].in);
    }
    for (int i = 0; i < m->n_springs; i++) {
        resolve_presence(f, &m->springs[i].in);
    }
    for (int i = 0; i < m->n_loads; i++) {
        resolve_presence(f, &m->loads[i].in);
    }
}

void mt_resolve_configurations(mt_resolve *f)
{
    mt_model *const m = f->m;
    const size_t n = (size_t)m->n_configurations;
    int *const walked = mt_arena_int(&m->mem, n);
    int *const state = mt_arena_int(&m->mem, n);
    int *const chain = mt_arena_int(&m->mem, n);
    bool *const overridden =
        mt_arena_alloc(&m->mem, (size_t)m->n_parameters, sizeof *overridden);
    f->order = mt_arena_int(&m->mem, n);
    if (mt_arena_failed(&m->mem)) {
        return;
    }
    for (int i = 0; i < m->n_modes; i++) {
        mt_named_mode *const mode = &m->modes[i];
        mode->configuration = mt_resolve_find(f, mode->configuration_name,
                                              &m->tables->configurations, "configuration");
    }
    for (int c = 0; c < m->n_configurations; c++) {
        mt_configuration *const it = &m->configurations[c];
        it->like =
            mt_resolve_find(f, it->like_name, &m->tables->configurations, "configuration");
    }
    for (int c = 0; c < m->n_configurations; c++) {
        check_like(f, c, walked);
    }
    find_order(f, chain, state);
    resolve_damping(f);
    for (int i = 0; i < m->n_configurations; i++) {
        inherit(f, &m->configurations[f->order[i]], overridden);
    }
    resolve_all_presence(f);
}

/* A drive in force names a joint that the configuration contains and can move, and a spring
 * that it contains. */
static void check_drive(mt_resolve *f, int index, mt_drive *drive)
{
    mt_model *const m = f->m;
    mt_configuration *const c = &m->configurations[index];
    const bool inherited = drive->owner != index; /* unknown names are noted where it stands */
    drive->joint = inherited
                       ? mt_model_find_joint(m, drive->joint_name.s)
                       : mt_resolve_find(f, drive->joint_name, &m->tables->joints, "joint");
    drive->trim_spring =
        !drive->trim ? MT_ABSENT
        : inherited  ? mt_model_find_spring(m, drive->trim_name.s)
                     : mt_resolve_find(f, drive->trim_name, &m->tables->springs, "spring");
    if (drive->joint != MT_ABSENT && !mt_model_present(&m->joints[drive->joint].in, index)) {
        mt_diag_error(f->d, drive->addr,
                      "configuration \"%s\" drives joint \"%s\", which it does not contain",
                      c->name.s, drive->joint_name.s);
    }
    if (drive->trim_spring != MT_ABSENT) {
        const mt_spring *const spring = &m->springs[drive->trim_spring];
        if (spring->damper) {
            mt_diag_error(f->d, drive->trim_name.addr,
                          "\"%s\" is a damper: only a spring holds a position", spring->name.s);
        } else if (!mt_model_present(&spring->in, index)) {
            mt_diag_error(f->d, drive->addr,
                          "configuration \"%s\" trims spring \"%s\", which it does not contain",
                          c->name.s, spring->name.s);
        }
    }
}

/* position_rad for a joint that turns, position_m for one that slides. */
static void check_drive_unit(mt_resolve *f, const mt_drive *drive)
{
    const mt_joint *const joint = &f->m->joints[drive->joint];
    if (joint->type == MT_JOINT_TYPE_COUNT) {
        return;
    }
    const mt_coordinate coordinate = mt_joint_kind_of(joint->type)->coordinate;
    if (coordinate == MT_COORDINATE_NONE) {
        mt_diag_error(f->d, drive->joint_name.addr, "%s %s joint cannot be driven",
                      mt_joint_article(joint->type), mt_joint_type_name(joint->type));
    } else if (drive->position != MT_ABSENT &&
               drive->position_is_angle != (coordinate == MT_COORDINATE_ANGLE)) {
        mt_diag_error(f->d, mt_resolve_addr(f->m, drive->position),
                      "the position of a %s joint is given as \"%s\"",
                      mt_joint_type_name(joint->type),
                      coordinate == MT_COORDINATE_ANGLE ? "position_rad" : "position_m");
    }
}

/* A spring holds one joint; the error stands where this configuration says otherwise. */
static void check_trims(mt_resolve *f, int index)
{
    const mt_configuration *const c = &f->m->configurations[index];
    for (int i = 0; i < c->n_drives; i++) {
        const mt_drive *const d = &c->drives[i];
        for (int k = 0; k < i && d->trim_spring != MT_ABSENT; k++) {
            const mt_drive *const other = &c->drives[k];
            const bool same = other->trim_spring == d->trim_spring;
            const bool later = (d->owner == index) == (other->owner == index)
                                   ? d->addr > other->addr
                                   : d->owner == index;
            const mt_drive *const wrong = later ? d : other;
            if (same && wrong->owner == index) {
                mt_diag_error(
                    f->d, wrong->trim_name.addr,
                    "spring \"%s\" holds joint \"%s\" already: it cannot be trimmed to "
                    "hold \"%s\", too",
                    wrong->trim_name.s, (later ? other : d)->joint_name.s, wrong->joint_name.s);
            }
        }
    }
}

/* Into the order of the model's joints: which configuration lists them how makes no
 * difference. */
static void sort_drives(mt_configuration *c)
{
    for (int i = 1; i < c->n_drives; i++) {
        const mt_drive d = c->drives[i];
        int k = i;
        for (; k > 0 && c->drives[k - 1].joint > d.joint; k--) {
            c->drives[k] = c->drives[k - 1];
        }
        c->drives[k] = d;
    }
}

void mt_resolve_drives(mt_resolve *f)
{
    for (int c = 0; c < f->m->n_configurations; c++) {
        mt_configuration *const it = &f->m->configurations[c];
        for (int i = 0; i < it->n_drives; i++) {
            mt_drive *const drive = &it->drives[i];
            check_drive(f, c, drive);
            if (drive->owner == c && drive->joint != MT_ABSENT) {
                check_drive_unit(f, drive);
            }
        }
        sort_drives(it);
        check_trims(f, c);
    }
}
