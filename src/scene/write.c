/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/write.h"

#include <math.h>
#include <stddef.h>

#include "io/write_json.h"

/* Significant digits: of a place a picture of ten thousand pixels has fewer; motions;
 * frequencies as tables have them, and some. */
enum { PLACE = 6, MOTION = 5, HZ = 9, VALUE = 9 };
static const double SHARE_STEP = 1e-6;

static void put_numbers(mt_json_writer *w, const char *name, int n, const double *x, int digits)
{
    mt_json_open_flat(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_put_rounded(w, NULL, x[i], digits);
    }
    mt_json_close(w);
}

/* Rounded down, so that what adds up to 1 never adds up to more. */
static void put_shares(mt_json_writer *w, const char *name, int n, const double *x)
{
    mt_json_open_flat(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_put_rounded(w, NULL, floor(x[i] / SHARE_STEP) * SHARE_STEP, PLACE);
    }
    mt_json_close(w);
}

static void put_place(mt_json_writer *w, const char *name, const double x[3])
{
    put_numbers(w, name, 3, x, PLACE);
}

static void put_axis(mt_json_writer *w, bool has, const double x[3])
{
    if (has) {
        put_place(w, "axis", x);
    } else {
        mt_json_put_null(w, "axis");
    }
}

static void put_pair(mt_json_writer *w, const int body[2])
{
    mt_json_open_flat(w, "bodies", '[');
    mt_json_put_integer(w, NULL, body[0]);
    mt_json_put_integer(w, NULL, body[1]);
    mt_json_close(w);
}

static void put_body(mt_json_writer *w, const mt_scene_body *b)
{
    static const char *const kinds[] = {
        [MT_SCENE_GROUND] = "ground", [MT_SCENE_BODY] = "body", [MT_SCENE_LINK] = "link"};
    mt_json_open_flat(w, NULL, '{');
    mt_json_put_string(w, "name", b->name);
    mt_json_put_string(w, "kind", kinds[b->kind]);
    mt_json_put_rounded(w, "mass", b->mass, VALUE);
    put_place(w, "at", b->at);
    if (b->ellipsoid == NULL) {
        mt_json_put_null(w, "ellipsoid");
    } else {
        mt_json_open(w, "ellipsoid", '{');
        put_place(w, "radii", b->ellipsoid->radii);
        mt_json_open(w, "axes", '[');
        for (int i = 0; i < 3; i++) {
            put_place(w, NULL, b->ellipsoid->axes[i]);
        }
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void put_joint(mt_json_writer *w, const mt_scene_view *v, const mt_scene_joint *j)
{
    mt_json_open_flat(w, NULL, '{');
    mt_json_put_string(w, "name", j->name);
    mt_json_put_string(w, "type", j->type);
    put_pair(w, j->body);
    if (j->rod) {
        put_place(w, "from", j->end[0]);
    } else {
        mt_json_put_null(w, "from");
    }
    put_place(w, "at", j->at);
    put_axis(w, j->has_axis, j->axis);
    mt_json_put_rounded(w, "distance", j->distance, PLACE);
    mt_json_put_string(w, "far", j->far == MT_ABSENT ? NULL : v->bodies[j->far].name);
    mt_json_close(w);
}

static void put_springs(mt_json_writer *w, const char *name, const char *number, int n,
                        const mt_scene_spring *springs)
{
    mt_json_open(w, name, '[');
    for (int i = 0; i < n; i++) {
        const mt_scene_spring *const s = &springs[i];
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "name", s->name);
        mt_json_put_string(w, "type", s->type);
        put_pair(w, s->body);
        put_place(w, "from", s->end[0]);
        put_place(w, "to", s->end[1]);
        put_axis(w, s->has_axis, s->axis);
        mt_json_put_rounded(w, number, s->stiffness, VALUE);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void put_arrows(mt_json_writer *w, const char *name, int n, const mt_scene_arrow *arrows)
{
    mt_json_open(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "name", arrows[i].name);
        mt_json_put_integer(w, "body", arrows[i].body);
        put_place(w, "at", arrows[i].at);
        put_place(w, "axis", arrows[i].axis);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void put_mode(mt_json_writer *w, const mt_scene_view *v, const mt_scene_mode *m)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_integer(w, "mode", m->index);
    mt_json_put_rounded(w, "hz", m->hz, HZ);
    mt_json_put_string(w, "name", m->name);
    mt_json_put_string(w, "note", m->note);
    mt_json_open_flat(w, "motion", '[');
    for (int b = 0; b < v->n_bodies; b++) {
        put_numbers(w, NULL, 6, m->motion + ((ptrdiff_t)6 * b), MOTION);
    }
    mt_json_close(w);
    mt_json_open(w, "energy", '{');
    put_shares(w, "springs", v->n_springs, m->spring_share);
    put_shares(w, "bodies", v->n_bodies, m->body_share);
    mt_json_close(w);
    mt_json_close(w);
}

static void put_position(mt_json_writer *w, const mt_scene_view *v, const mt_scene_position *p)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_rounded(w, "at", p->at, VALUE);
    if (p->pose == NULL) {
        mt_json_put_null(w, "poses");
    } else {
        mt_json_open_flat(w, "poses", '[');
        for (int b = 0; b < v->n_bodies; b++) {
            put_numbers(w, NULL, 12, p->pose + ((ptrdiff_t)12 * b), PLACE);
        }
        mt_json_close(w);
    }
    put_numbers(w, "hz", p->n_hz, p->hz, HZ);
    mt_json_put_string(w, "error", p->why);
    mt_json_close(w);
}

static void put_drive(mt_json_writer *w, const mt_scene_view *v)
{
    const mt_scene_drive *const d = v->drive;
    if (d == NULL) {
        mt_json_put_null(w, "drive");
        return;
    }
    mt_json_open(w, "drive", '{');
    mt_json_put_string(w, "joint", d->joint);
    mt_json_put_string(w, "unit", d->angle ? "rad" : "m");
    mt_json_put_rounded(w, "at", d->at, VALUE);
    mt_json_put_string(w, "error", d->why);
    mt_json_open(w, "positions", '[');
    for (int i = 0; i < d->n_positions; i++) {
        put_position(w, v, &d->positions[i]);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static void put_still(mt_json_writer *w, const mt_scene_view *v)
{
    mt_json_open(w, "bodies", '[');
    for (int i = 0; i < v->n_bodies; i++) {
        put_body(w, &v->bodies[i]);
    }
    mt_json_close(w);
    mt_json_open(w, "points", '[');
    for (int i = 0; i < v->n_points; i++) {
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "name", v->points[i].name);
        mt_json_put_integer(w, "body", v->points[i].body);
        put_place(w, "at", v->points[i].at);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_open(w, "lines", '[');
    for (int i = 0; i < v->n_lines; i++) {
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_integer(w, "body", v->lines[i].body);
        put_place(w, "from", v->lines[i].from);
        put_place(w, "to", v->lines[i].to);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_open(w, "joints", '[');
    for (int i = 0; i < v->n_joints; i++) {
        put_joint(w, v, &v->joints[i]);
    }
    mt_json_close(w);
}

static void put_view(mt_json_writer *w, const mt_scene_view *v)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "name", v->name);
    mt_json_put_string(w, "error", v->error);
    put_still(w, v);
    put_springs(w, "springs", "stiffness", v->n_springs, v->springs);
    put_springs(w, "dampers", "damping", v->n_dampers, v->dampers);
    put_arrows(w, "sensors", v->n_sensors, v->sensors);
    put_arrows(w, "loads", v->n_loads, v->loads);
    put_arrows(w, "rotors", 0, NULL); /* a model has none */
    mt_json_open(w, "modes", '[');
    for (int i = 0; i < v->n_modes; i++) {
        put_mode(w, v, &v->modes[i]);
    }
    mt_json_close(w);
    put_drive(w, v);
    mt_json_close(w);
}

static void put_design(mt_json_writer *w, const mt_scene_design *d)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "label", d->label);
    mt_json_put_integer(w, "rank", d->rank);
    mt_json_open(w, "parameters", '[');
    for (int i = 0; i < d->n_parameters; i++) {
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "name", d->parameters[i].name);
        mt_json_put_rounded(w, "value", d->parameters[i].value, VALUE);
        mt_json_put_string(w, "unit", d->parameters[i].unit);
        mt_json_put_string(w, "display_unit", d->parameters[i].display_unit);
        mt_json_put_number(w, "display_factor", d->parameters[i].display_factor);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_open(w, "configurations", '[');
    for (int i = 0; i < d->n_views; i++) {
        put_view(w, &d->views[i]);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static void put_scene(mt_json_writer *w, const mt_scene *scene)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "format", "modetune-scene/1");
    mt_json_put_string(w, "model", scene->name);
    mt_json_put_integer(w, "dimension", scene->dimension);
    mt_json_put_rounded(w, "size", scene->size, PLACE);
    if (scene->has_gravity) {
        put_place(w, "gravity", scene->gravity);
    } else {
        mt_json_put_null(w, "gravity");
    }
    mt_json_open(w, "designs", '[');
    for (int i = 0; i < scene->n_designs; i++) {
        put_design(w, &scene->designs[i]);
    }
    mt_json_close(w);
    mt_json_open(w, "joints", '[');
    for (int i = 0; i < scene->n_joints; i++) {
        const mt_scene_off *const o = &scene->joints[i];
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "configuration", o->configuration);
        mt_json_put_string(w, "joint", o->joint->name);
        mt_json_put_string(w, "type", o->joint->type);
        mt_json_put_string(w, "body", o->body);
        mt_json_put_rounded(w, "distance", o->joint->distance, PLACE);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static mt_status write_scene(const mt_scene *scene, bool tight, mt_text *out, mt_err *err)
{
    mt_json_writer w = mt_json_writer_default(out);
    w.tight = tight;
    put_scene(&w, scene);
    if (mt_json_done(&w)) {
        return MT_OK;
    }
    return out->failed ? mt_fail_memory(err)
                       : mt_fail(err, MT_E_INTERNAL, "the scene is not a JSON document");
}

mt_status mt_scene_write(const mt_scene *scene, mt_text *out, mt_err *err)
{
    return write_scene(scene, false, out, err);
}

mt_status mt_scene_write_page(const mt_scene *scene, mt_text *out, mt_err *err)
{
    return write_scene(scene, true, out, err);
}
