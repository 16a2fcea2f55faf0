/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune info: of a model what each configuration weighs and how it can move; of other files
 * what they hold. */
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include "answer/warnings.h"
#include "base/format.h"
#include "base/text.h"
#include "cli/cli.h"
#include "cli/file_info.h"
#include "expr/interpolant.h"
#include "inspect/at_rest.h"
#include "io/write_json.h"
#include "mechanics/info.h"
#include "mechanics/linear.h"
#include "model/model.h"
#include "model/values.h"
#include "report/table.h"

/* The interpretation of a sign, an axis or an order of bodies. */
typedef struct convention {
    const char *pointer; /* pointer of the member in the model's file */
    double value;        /* value of the member; NaN: not a number */
    /* of joints, springs, dampers and loads: the body (of a gear the joint) relative to which
     * the second one moves; NULL: neither */
    const char *first;
    const char *second;
    const char *text; /* a sentence without a full stop */
} convention;

typedef struct convention_list {
    mt_arena *mem; /* not owned; holds the texts, and remembers a shortage */
    convention *items;
    int n;
    int capacity;
} convention_list;

/*
 * The conventions of the model's schema, said of this model's numbers. The coordinate q of a
 * joint is how far its second body stands from the first, about the axis (right-handed; in two
 * dimensions counter-clockwise) or along it; a spring there has the energy
 * k (q - free)^2 / 2 + preload q, so that it acts with -k (q - free) - preload on the second
 * body.
 */

/* So many lines tell people what is meant; a large model repeats itself. */
enum { MOST_LINES = 24 };
/* Components of unit vectors below this are rounding. */
static const double ROUNDED = 1e-12;

typedef struct writer {
    const mt_model *m;
    int configuration;
    const double *value;
    convention_list *out;
} writer;

/* A number that is given and not 0. */
static bool has_nonzero_value(const writer *w, mt_num num, double *v)
{
    *v = num == MT_ABSENT ? 0.0 : w->value[num];
    return *v != 0.0;
}

/* What a joint or hinge, or two bodies, are called; the second body moves against the first. */
typedef struct pair {
    const char *first;
    const char *second;
} pair;

static pair pair_of(const writer *w, int joint, const mt_attach *bodies)
{
    const mt_attach *const of = joint >= 0 ? w->m->joints[joint].bodies : bodies;
    const char *const first = of == NULL ? NULL : of[0].name.s;
    const char *const second = of == NULL ? NULL : of[1].name.s;
    return (pair){first == NULL ? "the element before" : first,
                  second == NULL ? "the element behind" : second};
}

/* Which member of which item a sentence is about, whose value it is, and between which bodies
 * it acts. */
typedef struct subject {
    const char *list; /* "springs", with index -1 the whole pointer */
    int index;
    const char *member; /* "preload_n_m" */
    double value;
    pair of;
} subject;

static void add_convention(writer *w, const subject *s, const char *fmt, ...) MT_PRINTF(3, 4);

static void add_convention(writer *w, const subject *s, const char *fmt, ...)
{
    convention_list *const out = w->out;
    va_list args;
    va_start(args, fmt);
    const char *const text = mt_arena_vprintf(out->mem, fmt, args);
    va_end(args);
    convention *const items =
        mt_arena_grow(out->mem, out->items, out->n, &out->capacity, sizeof *items);
    if (items == NULL) {
        return;
    }
    items[out->n++] = (convention){
        .pointer = s->index < 0 ? s->list
                                : mt_arena_printf(out->mem, "/%s/%d%s%s", s->list, s->index,
                                                  s->member == NULL ? "" : "/",
                                                  s->member == NULL ? "" : s->member),
        .value = s->value,
        .first = s->of.first,
        .second = s->of.second,
        .text = text,
    };
    out->items = items;
}

static const char *about(const writer *w)
{
    return w->m->dimension == 2 ? "clockwise" : "against the axis";
}

static const char *rotation_sense(const writer *w)
{
    return w->m->dimension == 2 ? "counter-clockwise" : "about the axis";
}

static void write_products(writer *w)
{
    static const char *const names[] = {"xy", "xz", "yz"};
    static const char *const members[] = {"inertia_kg_m2/3", "inertia_kg_m2/4",
                                          "inertia_kg_m2/5"};
    for (int i = 0; i < w->m->n_bodies; i++) {
        const mt_body *const b = &w->m->bodies[i];
        const char *text = "";
        double v = 0.0;
        subject first = {.list = "bodies", .index = i, .member = NULL};
        if (!mt_model_present(&b->in, w->configuration) || w->m->dimension == 2) {
            continue;
        }
        for (int k = 0; k < 3 && text != NULL; k++) {
            if (has_nonzero_value(w, b->inertia[3 + k], &v)) {
                text = mt_arena_printf(w->out->mem, "%s %s %g", text, names[k], v);
                first.value = first.member == NULL ? v : first.value;
                first.member = first.member == NULL ? members[k] : first.member;
            }
        }
        if (text != NULL && *text != '\0') {
            add_convention(
                w, &first,
                "body \"%s\": inertia%s: elements of the tensor, minus the integrals of x y, x "
                "z, y z over the mass (a CAD system's positive integrals change sign)",
                b->name.s, text);
        }
    }
}

/* A member of spring number i of the model, of those of the file's list. */
static subject of_spring(const writer *w, const mt_spring *s, const char *member, double value,
                         pair of)
{
    int index = 0;
    for (const mt_spring *k = w->m->springs; k < s; k++) {
        index += k->damper == s->damper ? 1 : 0;
    }
    return (subject){s->damper ? "dampers" : "springs", index, member, value, of};
}

static void write_torsion(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, s->joint, s->bodies);
    double v = 0.0;
    if (has_nonzero_value(w, s->preload, &v)) {
        const subject at = of_spring(w, s, "preload_n_m", v, of);
        add_convention(
            w, &at, "spring \"%s\": preload_n_m %g turns \"%s\" against \"%s\" %s, as drawn",
            s->name.s, v, of.second, of.first, v > 0.0 ? about(w) : rotation_sense(w));
    }
    if (has_nonzero_value(w, s->free_angle, &v)) {
        const subject at = of_spring(w, s, "free_angle_rad", v, of);
        add_convention(
            w, &at,
            "spring \"%s\": no torque where \"%s\" is turned by %g rad %s against \"%s\", from "
            "the drawing",
            s->name.s, of.second, fabs(v), v > 0.0 ? rotation_sense(w) : about(w), of.first);
    }
}

static void write_axial(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, s->joint, s->bodies);
    double v = 0.0;
    if (!has_nonzero_value(w, s->preload, &v)) {
        return;
    }
    const subject at = of_spring(w, s, "preload_n", v, of);
    if (s->joint_name.s != NULL) {
        add_convention(w, &at,
                       "spring \"%s\": preload_n %g pushes \"%s\" %s the axis of \"%s\"",
                       s->name.s, v, of.second, v > 0.0 ? "against" : "along", s->joint_name.s);
    } else {
        add_convention(w, &at, "spring \"%s\": preload_n %g is %s: it %s", s->name.s, v,
                       v > 0.0 ? "tension" : "compression",
                       v > 0.0 ? "draws its two points together"
                               : "pushes its two points apart");
    }
}

/* "along the drawing's x, y, z" or, of axes of its own, where these point. */
static const char *axes_text(const writer *w, const mt_axes *axes)
{
    static const char *const names[] = {"x", "y", "z"};
    const bool plane = w->m->dimension == 2;
    const char *text = "along its own axes ";
    double e[3][3];
    if (!axes->given) {
        return plane ? "along the drawing's x, y" : "along the drawing's x, y, z";
    }
    (void)mt_axes_of(axes, w->value, e);
    for (int i = 0; i < w->m->dimension && text != NULL; i++) {
        for (int k = 0; k < 3; k++) { /* what rounding leaves of 0 */
            e[i][k] = fabs(e[i][k]) < ROUNDED ? 0.0 : e[i][k];
        }
        text = plane ? mt_arena_printf(w->out->mem, "%s%s%s (%.4g, %.4g)", text,
                                       i > 0 ? ", " : "", names[i], e[i][0], e[i][1])
                     : mt_arena_printf(w->out->mem, "%s%s%s (%.4g, %.4g, %.4g)", text,
                                       i > 0 ? ", " : "", names[i], e[i][0], e[i][1], e[i][2]);
    }
    return text == NULL ? "" : text;
}

static void write_bushing(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, MT_ABSENT, s->bodies);
    const subject at = of_spring(w, s, s->n_at > 0 ? "at" : NULL, nan(""), of);
    add_convention(
        w, &at,
        "%s \"%s\": %s, carried by \"%s\"; about %s of \"%s\", where its forces act on both",
        s->damper ? "damper" : "spring", s->name.s, axes_text(w, &s->axes), of.first,
        s->n_at > 0 ? "the point" : "the centre", of.second);
}

/* What a joint yields: where its axes point. */
static void write_compliances(writer *w)
{
    for (int i = 0; i < w->m->n_joints; i++) {
        const mt_joint *const j = &w->m->joints[i];
        if (!mt_model_present(&j->in, w->configuration) || j->compliance == NULL) {
            continue;
        }
        const pair of = pair_of(w, i, NULL);
        const subject at = {"joints", i, "compliance", nan(""), of};
        const bool plane = w->m->dimension == 2;
        const char *const axes = !j->has_axis ? axes_text(w, &j->compliance->axes)
                                 : plane      ? "across its axis and along it"
                                              : "across its axis (twice) and along it";
        add_convention(
            w, &at,
            "joint \"%s\": yields %s, carried by \"%s\", on a carrier \"%s.bearing\" "
            "without mass",
            j->name.s, axes, of.first, j->name.s);
    }
}

static void write_inertia_axes(writer *w)
{
    for (int i = 0; i < w->m->n_bodies; i++) {
        const mt_body *const b = &w->m->bodies[i];
        const subject at = {.list = "bodies", .index = i, .member = "axes", .value = nan("")};
        if (mt_model_present(&b->in, w->configuration) && b->axes.given) {
            add_convention(w, &at, "body \"%s\": inertia %s", b->name.s,
                           axes_text(w, &b->axes));
        }
    }
}

static void write_springs(writer *w)
{
    for (int i = 0; i < w->m->n_springs; i++) {
        const mt_spring *const s = &w->m->springs[i];
        if (!mt_model_present(&s->in, w->configuration)) {
            continue;
        }
        switch (s->type) {
        case MT_SPRING_TORSION:
            write_torsion(w, s);
            break;
        case MT_SPRING_AXIAL:
        case MT_SPRING_BAR:
            write_axial(w, s);
            break;
        case MT_SPRING_BUSHING:
            write_bushing(w, s);
            break;
        case MT_SPRING_TYPE_COUNT:
            break;
        }
    }
}

static void write_gears(writer *w)
{
    for (int i = 0; i < w->m->n_joints; i++) {
        const mt_joint *const j = &w->m->joints[i];
        double v = 0.0;
        if (!mt_model_present(&j->in, w->configuration)) {
            continue;
        }
        if (has_nonzero_value(w, j->ratio, &v)) {
            const subject at = {
                "joints", i, "ratio", v, {j->gear_joints[0].s, j->gear_joints[1].s}};
            add_convention(
                w, &at,
                "gear \"%s\": \"%s\" turns %g times as far as \"%s\", each about its own axis",
                j->name.s, j->gear_joints[1].s, v, j->gear_joints[0].s);
        }
        if (has_nonzero_value(w, j->ratio_m_per_rad, &v)) {
            const subject at = {
                "joints", i, "ratio_m_per_rad", v, {j->gear_joints[0].s, j->gear_joints[1].s}};
            add_convention(
                w, &at,
                "rack \"%s\": \"%s\" slides by %g m along its axis when \"%s\" turns by 1 rad",
                j->name.s, j->gear_joints[1].s, v, j->gear_joints[0].s);
        }
    }
}

static void write_load(writer *w, int i)
{
    const mt_load *const load = &w->m->loads[i];
    double v = 0.0;
    const bool on_joint = load->joint_name.s != NULL;
    const pair of =
        on_joint ? pair_of(w, load->joint, NULL) : (pair){"ground", load->on.name.s};
    if (load->has_moment && has_nonzero_value(w, load->moment, &v)) {
        const subject at = {"loads", i, "moment_n_m", v, of};
        add_convention(w, &at, "load \"%s\": moment_n_m %g turns \"%s\" %s%s%s%s", load->name.s,
                       v, of.second, v > 0.0 ? rotation_sense(w) : about(w),
                       on_joint ? ", and \"" : "", on_joint ? of.first : "",
                       on_joint ? "\" the other way" : "");
    } else if (load->has_force && on_joint && has_nonzero_value(w, load->force[0], &v)) {
        const subject at = {"loads", i, "force_n", v, of};
        add_convention(
            w, &at,
            "load \"%s\": force_n %g pushes \"%s\" %s the axis, and \"%s\" the other way",
            load->name.s, v, of.second, v > 0.0 ? "along" : "against", of.first);
    }
}

static void write_loads(writer *w)
{
    for (int i = 0; i < w->m->n_loads; i++) {
        if (mt_model_present(&w->m->loads[i].in, w->configuration)) {
            write_load(w, i);
        }
    }
}

static void write_sections(writer *w)
{
    const char *const axis = w->m->dimension == 2 ? "z, out of the plane" : "its hinge axis";
    for (int i = 0; i < w->m->n_links; i++) {
        const mt_link *const l = &w->m->links[i];
        const bool rectangle = l->section.shape == MT_SECTION_RECTANGLE;
        if (!mt_model_present(&l->in, w->configuration) ||
            (!rectangle && l->section.shape != MT_SECTION_GENERAL)) {
            continue;
        }
        const subject at = {.list = "links", .index = i, .member = "section", .value = nan("")};
        add_convention(w, &at,
                       rectangle ? "link \"%s\": width_m is along %s, height_m across it"
                                 : "link \"%s\": second_moment_m4 is for bending about %s",
                       l->name.s, axis);
    }
}

static void write_drive(writer *w, const mt_drive *d)
{
    double v = 0.0;
    if (d->joint == MT_ABSENT || !has_nonzero_value(w, d->position, &v)) {
        return;
    }
    const pair of = pair_of(w, d->joint, NULL);
    const char *const way = d->position_is_angle ? v > 0.0 ? rotation_sense(w) : about(w)
                            : v > 0.0 ? "along the axis"
                                                 : "against the axis";
    const char *const owner = w->m->configurations[d->owner].name.s;
    const char *const item = d->item < 0 ? "" : mt_arena_printf(w->out->mem, "%d/", d->item);
    const subject at = {mt_arena_printf(w->out->mem, "/configurations/%s/drive/%s%s", owner,
                                        item,
                                        d->position_is_angle ? "position_rad" : "position_m"),
                        -1, NULL, v, of};
    add_convention(w, &at, "drive: \"%s\" stands %g %s %s against \"%s\", from the drawing",
                   of.second, fabs(v), d->position_is_angle ? "rad" : "m", way, of.first);
}

/* Append the conventions of a configuration, one per number that has one, to a list (out->mem
 * set, else zeroed). value [n_nums] as of mt_model_numbers. */
static void cli_find_conventions(const mt_model *model, int configuration, const double *value,
                                 convention_list *out)
{
    writer w = {.m = model, .configuration = configuration, .value = value, .out = out};
    const mt_configuration *const own = &model->configurations[configuration];
    for (int i = 0; i < own->n_drives; i++) {
        write_drive(&w, &own->drives[i]);
    }
    write_compliances(&w);
    write_inertia_axes(&w);
    write_products(&w);
    write_sections(&w);
    write_gears(&w);
    write_springs(&w);
    write_loads(&w);
}

/* Print the conventions as a limited number of lines; nothing where the list is empty. */
static void cli_print_conventions(const convention_list *list, mt_text *out)
{
    for (int i = 0; i < list->n && i < MOST_LINES; i++) {
        mt_text_add(out, i == 0 ? "  conventions\n" : "");
        mt_text_addf(out, "    %s\n", list->items[i].text);
    }
    if (list->n > MOST_LINES) {
        mt_text_addf(out, "    and %d more of these kinds\n", list->n - MOST_LINES);
    }
}

/* Write all conventions as the member "conventions" of the open object. */
static void cli_json_conventions(mt_json_writer *w, const convention_list *list)
{
    mt_json_open(w, "conventions", '[');
    for (int i = 0; i < list->n; i++) {
        const convention *const c = &list->items[i];
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "pointer", c->pointer);
        mt_json_put_number(w, "value", c->value);
        mt_json_put_string(w, "first", c->first);
        mt_json_put_string(w, "second", c->second);
        mt_json_put_string(w, "text", c->text);
        mt_json_close(w);
    }
    mt_json_close(w);
}

/* The command. */

enum { DIGITS = 6, SPATIAL = 6, MOST_RATIOS = 6 };

static const char *const inertia_member[SPATIAL] = {"xx", "yy", "zz", "xy", "xz", "yz"};

typedef struct view {
    const mt_loaded_model *s;
    int c;
    mt_analysis *a;
    mt_info info;
    mt_nearness nearness;
    mt_arena mem;
    mt_warning_list warning_list;
    convention_list conventions;
    mt_rest_rows rest;
} view;

static void json_units(mt_json_writer *w, const mt_loaded_model *s)
{
    const mt_model *const m = s->model;
    mt_json_open_flat(w, "units", '{');
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        mt_json_put_string(w, mt_dimension_name((mt_dimension)d),
                           m->units[d] == NULL ? mt_dimension_si((mt_dimension)d)
                                               : m->units[d]->name);
    }
    mt_json_close(w);
    mt_json_open(w, "converted", '[');
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_parameter *const p = &m->parameters[i];
        if (p->written != NULL) {
            mt_json_open_flat(w, NULL, '{');
            mt_json_put_string(w, "parameter", p->name.s);
            mt_json_put_number(w, "number", mt_unit_written(p->written, s->original[i]));
            mt_json_put_string(w, "number_unit", p->written->name);
            mt_json_put_number(w, "value", s->original[i]);
            mt_json_put_string(w, "unit", p->unit);
            mt_json_close(w);
        }
    }
    mt_json_close(w);
}

/* A measured curve of the model, which interp() reads. */
typedef struct curve_row {
    const char *name;
    int points;
    double from;
    double to;
} curve_row;

#define THIS curve_row
static const mt_field curve_fields[] = {
    MT_F_TEXT("name", name, "Its name."),
    MT_F_COUNT("points", points, 2, "How many points it has."),
    MT_F_NUMBER("from", from, "Where it begins, in SI: before that it has no value."),
    MT_F_NUMBER("to", to, "Where it ends, in SI."),
};
static const mt_record curve_record =
    MT_F_RECORD_OF(curve_fields, "curve", "A measured curve of the model.");
#undef THIS

static curve_row curve_row_of(const mt_interpolant *curve)
{
    return (curve_row){curve->name, curve->n, curve->x[0], curve->x[curve->n - 1]};
}

static void json_curves(mt_json_writer *w, const mt_model *m)
{
    mt_json_open(w, "curves", '[');
    for (int i = 0; i < m->n_curves; i++) {
        const curve_row row = curve_row_of(&m->curves[i]);
        mt_record_put_object(w, NULL, &curve_record, &row, 0, NULL);
    }
    mt_json_close(w);
}

static void write_curves(mt_text *out, const mt_model *m)
{
    mt_text_add(out, m->n_curves > 0 ? "Curves\n" : "");
    for (int i = 0; i < m->n_curves; i++) {
        const curve_row row = curve_row_of(&m->curves[i]);
        mt_text_addf(out, "  %s: %d points, from %.10g to %.10g (SI)\n", row.name, row.points,
                     row.from, row.to);
    }
    mt_text_add(out, m->n_curves > 0 ? "\n" : "");
}

static double info_value(const view *v, mt_node node)
{
    return node == MT_NO_NODE ? nan("") : mt_linear_value(v->a->lin, node);
}

static const char *named_mode(const view *v, int i)
{
    return v->s->model->modes[v->a->sys->damping.named[i]].name.s;
}

static void json_damping(mt_json_writer *w, const view *v)
{
    const mt_damping_def *const d = &v->a->sys->damping;
    mt_json_open(w, "damping", '{');
    mt_json_put_integer(w, "dampers", v->info.dampers);
    mt_json_put_number(w, "least_loss_factor", v->info.least_loss);
    mt_json_put_number(w, "most_loss_factor", v->info.most_loss);
    mt_json_put_number(w, "ratio", info_value(v, d->ratio));
    mt_json_open_flat(w, "ratios", '[');
    for (int k = 0; k < d->n_ratios; k++) {
        mt_json_put_number(w, NULL, info_value(v, d->ratios[k]));
    }
    mt_json_close(w);
    mt_json_open(w, "modes", '{');
    for (int k = 0; k < d->n_named; k++) {
        mt_json_put_number(w, named_mode(v, k), info_value(v, d->named_ratios[k]));
    }
    mt_json_close(w);
    mt_json_put_number(w, "mass_per_s", info_value(v, d->mass));
    mt_json_put_number(w, "stiffness_s", info_value(v, d->stiffness));
    mt_json_close(w);
}

/* One part of the line "damping": "ratio 0.02 of mode 1". */
static void put_part(mt_text *out, int *n, const char *before, double x, const char *after)
{
    if (!isnan(x)) {
        char a[MT_NUMBER_TEXT];
        mt_text_addf(out, "%s%s%s%s", *n > 0 ? ", " : "  damping     ", before,
                     mt_report_number(x, DIGITS, a), after);
        ++*n;
    }
}

static void text_ratios(mt_text *out, int *n, const view *v)
{
    const mt_damping_def *const d = &v->a->sys->damping;
    const bool listed = d->n_ratios + d->n_named > 0;
    for (int k = 0; k < d->n_named && k < MOST_RATIOS; k++) {
        const char *const of =
            mt_arena_printf(v->warning_list.mem, " of \"%s\"", named_mode(v, k));
        put_part(out, n, "ratio ", info_value(v, d->named_ratios[k]), of == NULL ? "" : of);
    }
    for (int k = 0; k < d->n_ratios && k < MOST_RATIOS; k++) {
        char of[32];
        (void)mt_snprintf(of, sizeof of, " of mode %d", k + 1);
        put_part(out, n, "ratio ", info_value(v, d->ratios[k]), of);
    }
    if (d->n_named > MOST_RATIOS || d->n_ratios > MOST_RATIOS) {
        mt_text_add(out, ", ...");
    }
    put_part(out, n, "ratio ", info_value(v, d->ratio), listed ? " of other modes" : "");
}

/* Write the line "damping"; nothing without damping. */
static void text_damping(mt_text *out, const view *v)
{
    const mt_damping_def *const d = &v->a->sys->damping;
    const int dampers = v->info.dampers;
    char most[MT_NUMBER_TEXT + 8] = "";
    int n = 0;
    if (dampers > 0) {
        mt_text_addf(out, "  damping     %d damper%s", dampers, dampers == 1 ? "" : "s");
        n++;
    }
    if (v->info.most_loss > v->info.least_loss) {
        char a[MT_NUMBER_TEXT];
        (void)mt_snprintf(most, sizeof most, " to %s",
                          mt_report_number(v->info.most_loss, DIGITS, a));
    }
    put_part(out, &n, "loss factors ", v->info.least_loss, most);
    text_ratios(out, &n, v);
    put_part(out, &n, "", info_value(v, d->mass), " 1/s of the mass");
    put_part(out, &n, "", info_value(v, d->stiffness), " s of the stiffness");
    mt_text_add(out, n > 0 ? "\n" : "");
}

static mt_status json_redundant(mt_json_writer *w, view *v, mt_err *err)
{
    int n = 0;
    mt_joints_row *rows = NULL;
    MT_TRY(mt_redundant_rows(v->a->lin, &v->mem, &n, &rows, err));
    mt_json_open(w, "redundant_constraints", '[');
    for (int k = 0; k < n; k++) {
        mt_record_put_object(w, NULL, &mt_joints_record, &rows[k], 0, NULL);
    }
    mt_json_close(w);
    return MT_OK;
}

static void json_rest(mt_json_writer *w, const mt_rest_rows *rest)
{
    mt_json_open(w, "at_rest", '[');
    for (int i = 0; i < rest->n; i++) {
        mt_record_put_object(w, NULL, &mt_rest_record, &rest->rows[i], 0, NULL);
    }
    mt_json_close(w);
    mt_json_put_integer(w, "at_rest_left_out", rest->left_out);
}

/* What there is at rest, a line for each sensor, spring and joint. */
static void text_rest(mt_text *out, view *v)
{
    const mt_rest_rows *const rest = &v->rest;
    int lines = 0;
    for (int i = 0, end = 0; i < rest->n && lines < MOST_LINES; i = end, lines++) {
        const int owner = mt_rest_owner(&rest->rows[i]);
        while (end < rest->n && mt_rest_owner(&rest->rows[end]) == owner &&
               strncmp(rest->rows[end].output, rest->rows[i].output, (size_t)owner) == 0) {
            end++;
        }
        const char *const text = mt_rest_text(rest, i, end, DIGITS, &v->mem);
        if (i == 0) {
            mt_text_add(out,
                        "  at rest     sensors against the reference position; what joints "
                        "do to their second body\n");
        }
        mt_text_addf(out, "    %.*s: %s\n", owner, rest->rows[i].output,
                     text == NULL ? "" : text);
        if (lines + 1 == MOST_LINES && end < rest->n) {
            mt_text_addf(out, "    ... and %d numbers more (--format json)\n", rest->n - end);
        }
    }
}

static mt_status write_info_json(mt_json_writer *w, view *v, mt_err *err)
{
    const mt_info *const i = &v->info;
    const bool planar = v->s->model->dimension == 2;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", mt_loaded_model_configuration(v->s, v->c));
    json_units(w, v->s);
    json_curves(w, v->s->model);
    mt_json_put_warnings(w, "doubts", &v->warning_list, MT_LEVEL_WARNING);
    mt_json_put_warnings(w, "facts", &v->warning_list, MT_LEVEL_NOTE);
    mt_json_put_number(w, "mass_kg", i->mass_kg);
    mt_json_open_flat(w, "centre_m", '[');
    for (int k = 0; k < v->s->model->dimension; k++) {
        mt_json_put_number(w, NULL, i->centre_m[k]);
    }
    mt_json_close(w);
    mt_json_open_flat(w, "inertia_kg_m2", '{');
    for (int k = planar ? 2 : 0; k < (planar ? 3 : SPATIAL); k++) {
        mt_json_put_number(w, inertia_member[k], i->inertia_kg_m2[k]);
    }
    mt_json_close(w);
    mt_json_put_integer(w, "states", i->states);
    mt_json_put_integer(w, "equations", i->equations);
    mt_json_put_integer(w, "freedoms", i->freedoms);
    mt_json_put_integer(w, "idle_spins", i->free_spins);
    mt_json_put_integer(w, "redundant_equations", i->redundant);
    MT_TRY(json_redundant(w, v, err));
    mt_json_put_number(w, "equilibrium_residual", i->residual);
    mt_json_put_number(w, "gap_m", i->gap_m);
    json_rest(w, &v->rest);
    json_damping(w, v);
    cli_json_conventions(w, &v->conventions);
    mt_record_put_object(w, "dead_centre", &mt_dead_centre_record,
                         mt_dead_centre_row_of(&v->nearness, &v->mem), 0, NULL);
    mt_json_close(w);
    return mt_arena_check(&v->mem, err);
}

static const char *point_text(const double *x, int n, char *text, size_t size)
{
    char s[3][MT_NUMBER_TEXT];
    for (int k = 0; k < 3; k++) {
        (void)mt_report_number(k < n ? x[k] : nan(""), DIGITS, s[k]);
    }
    (void)mt_snprintf(text, size, n == 3 ? "%s, %s, %s" : "%s, %s", s[0], s[1], s[2]);
    return text;
}

/* Write the conventions of a configuration; nothing where they equal those of the one before
 * (*last, which is taken over). */
static void write_conventions(mt_text *out, const view *v, mt_text *last)
{
    mt_text text = {.s = NULL};
    cli_print_conventions(&v->conventions, &text);
    if (text.s != NULL && (last->s == NULL || strcmp(last->s, text.s) != 0)) {
        mt_text_add(out, text.s);
    }
    out->failed = out->failed || text.failed;
    mt_text_free(last);
    *last = text;
}

static void write_info_text(mt_text *out, view *v, mt_text *last)
{
    const mt_info *const i = &v->info;
    const int n = v->s->model->dimension;
    char a[3 * MT_NUMBER_TEXT + 8];
    mt_text_addf(out, "%s\n", mt_loaded_model_configuration(v->s, v->c));
    mt_cli_print_warnings(&v->warning_list, out);
    mt_text_addf(out, "  mass        %s kg\n", mt_report_number(i->mass_kg, DIGITS, a));
    mt_text_addf(out, "  centre      (%s) m\n", point_text(i->centre_m, n, a, sizeof a));
    if (n == 2) {
        mt_text_addf(out, "  inertia     %s kg m^2 about the centre\n",
                     mt_report_number(i->inertia_kg_m2[2], DIGITS, a));
    } else {
        char b[3 * MT_NUMBER_TEXT + 8];
        mt_text_addf(out,
                     "  inertia     xx, yy, zz %s; xy, xz, yz %s kg m^2 about the centre\n",
                     point_text(i->inertia_kg_m2, 3, a, sizeof a),
                     point_text(i->inertia_kg_m2 + 3, 3, b, sizeof b));
    }
    mt_text_addf(out, "  mobility    %d freedom%s = %d states - %d independent of %d equations",
                 i->freedoms, i->freedoms == 1 ? "" : "s", i->states,
                 i->equations - i->redundant, i->equations);
    if (i->free_spins > 0) {
        mt_text_addf(out, " - %d idle spin%s", i->free_spins, i->free_spins == 1 ? "" : "s");
    }
    mt_text_add(out, "\n");
    text_damping(out, v);
    if (mt_linear_position(v->a->lin)->equilibrium.active) {
        mt_text_addf(out, "  equilibrium residual %.1e, largest gap of a joint %.1e m\n",
                     i->residual, i->gap_m);
        text_rest(out, v);
    }
    write_conventions(out, v, last);
    mt_text_add(out, "\n");
}

/* "170 mm = 0.17 m": of every parameter that the file gives in a unit other than SI. */
static void write_units(mt_text *out, const mt_loaded_model *s)
{
    const mt_model *const m = s->model;
    int told = 0;
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        if (m->units[d] != NULL) {
            mt_text_addf(out, "%s%s in %s", told++ == 0 ? "Units: " : ", ",
                         mt_dimension_name((mt_dimension)d), m->units[d]->name);
        }
    }
    mt_text_add(out, told > 0 ? "; expressions in SI units\n" : "");
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_parameter *const p = &m->parameters[i];
        if (p->written != NULL) {
            mt_text_add(out, told++ == 0 ? "Parameters in other units than SI\n" : "");
            mt_text_addf(out, "  %s: %.10g %s = %.10g %s\n", p->name.s,
                         mt_unit_from_si(p->written, s->original[i]), p->written->name,
                         s->original[i], p->unit);
        }
    }
    mt_text_add(out, told > 0 ? "\n" : "");
}

static mt_table table_new(void)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mass [kg]", "mass_kg", MT_ALIGN_POINT);
    mt_table_column(&t, "x [m]", "centre_x_m", MT_ALIGN_POINT);
    mt_table_column(&t, "y [m]", "centre_y_m", MT_ALIGN_POINT);
    mt_table_column(&t, "z [m]", "centre_z_m", MT_ALIGN_POINT);
    for (int k = 0; k < SPATIAL; k++) {
        char member[32];
        (void)mt_snprintf(member, sizeof member, "inertia_%s_kg_m2", inertia_member[k]);
        mt_table_column(&t, member, member, MT_ALIGN_POINT);
    }
    mt_table_column(&t, "states", "states", MT_ALIGN_RIGHT);
    mt_table_column(&t, "equations", "equations", MT_ALIGN_RIGHT);
    mt_table_column(&t, "freedoms", "freedoms", MT_ALIGN_RIGHT);
    mt_table_column(&t, "redundant", "redundant_equations", MT_ALIGN_RIGHT);
    return t;
}

static void fill_table(mt_table *t, const view *v)
{
    const mt_info *const i = &v->info;
    mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
    mt_table_number(t, i->mass_kg, DIGITS);
    for (int k = 0; k < 3; k++) {
        mt_table_number(t, i->centre_m[k], DIGITS);
    }
    for (int k = 0; k < SPATIAL; k++) {
        mt_table_number(t, i->inertia_kg_m2[k], DIGITS);
    }
    mt_table_integer(t, i->states);
    mt_table_integer(t, i->equations);
    mt_table_integer(t, i->freedoms);
    mt_table_integer(t, i->redundant);
}

/* What is written in turn. */
typedef struct sinks {
    mt_json_writer *w;
    mt_table *t;
    mt_text *out;
    mt_text *last; /* conventions, as they were said last */
} sinks;

static mt_status find_conventions(view *v, mt_err *err)
{
    const mt_model *const m = v->s->model;
    double *const value = mt_arena_f64(&v->mem, (size_t)m->n_nums, 1);
    MT_TRY(mt_arena_check(&v->mem, err));
    MT_TRY(
        mt_model_numbers(m, v->c, v->s->n_inputs, v->s->inputs, v->s->at, &v->mem, value, err));
    v->conventions = (convention_list){.mem = &v->mem};
    cli_find_conventions(m, v->c, value, &v->conventions);
    return mt_arena_check(&v->mem, err);
}

static mt_status show_configuration_info(const mt_args *args, view *v, const sinks *to,
                                         mt_err *err)
{
    MT_TRY(mt_loaded_model_analyse(v->s, v->c, 1, &v->a, err));
    MT_TRY(mt_info_fill(v->a->lin, &v->info, err));
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    MT_TRY(mt_linear_nearness(v->a->lin, &v->mem, &v->nearness, err));
    v->warning_list = mt_warning_list_default(&v->mem);
    MT_TRY(mt_warnings_of_analysis(v->a, v->s->n_inputs, v->s->inputs, v->s->at,
                                   &v->warning_list, err));
    MT_TRY(find_conventions(v, err));
    MT_TRY(args->format == MT_FORMAT_CSV ? MT_OK
                                         : mt_rest_rows_of(v->a, &v->mem, &v->rest, err));
    switch (args->format) {
    case MT_FORMAT_JSON:
        return write_info_json(to->w, v, err);
    case MT_FORMAT_CSV:
        fill_table(to->t, v);
        return MT_OK;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        write_info_text(to->out, v, to->last);
        return mt_arena_check(&v->mem, err);
    }
    return MT_OK;
}

static int tell_model(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    mt_json_writer w = mt_json_writer_default(out);
    mt_table t = table_new();
    mt_text last = {.s = NULL};
    const sinks to = {.w = &w, .t = &t, .out = out, .last = &last};
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    if (list) {
        mt_json_open(&w, NULL, '[');
    }
    if (args->format == MT_FORMAT_TEXT) {
        write_units(out, &s);
        write_curves(out, s.model);
    }
    for (int i = 0; i < s.n_configurations; i++) {
        view v = {.s = &s, .c = s.configurations[i]};
        mt_err err = {.code = MT_OK};
        mt_loaded_model_warn_overridden(&s, v.c);
        const mt_status rc = show_configuration_info(args, &v, &to, &err);
        if (rc != MT_OK) {
            code = mt_exit_worse(code, mt_cli_failed(rc, &err));
        }
        if (rc != MT_OK && json) {
            mt_json_open(&w, NULL, '{');
            mt_json_put_string(&w, "configuration", mt_loaded_model_configuration(&s, v.c));
            mt_json_put_string(&w, "error", err.text);
            mt_json_close(&w);
        }
        mt_analysis_delete(v.a);
        mt_arena_free(&v.mem);
    }
    if (list) {
        mt_json_close(&w);
    }
    if (json) {
        code = mt_exit_worse(code, mt_cli_json_done(&w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&t, out);
    }
done:
    mt_table_free(&t);
    mt_text_free(&last);
    mt_loaded_model_free(&s);
    return code;
}

static int run_info(const mt_args *args, mt_text *out)
{
    bool is_model = false;
    const int code = mt_file_info(args, &is_model, out);
    return is_model ? tell_model(args, out) : code;
}

const mt_command mt_command_info = {
    .name = "info",
    .operands = "FILE",
    .least = 1,
    .most = 1,
    .summary = "what a file holds; of a model its masses, mobility and redundancies",
    .details =
        "Prints what a file holds that modetune reads or writes: a study, a result or its "
        "folder, a profile, a catalogue of aircraft, measured responses (CSV, universal "
        "files), "
        "a journal, an index, a scene. It gives kind, format and author, variables, goals, "
        "designs with their frequencies, tones, channels and ranges, the files that it names "
        "and "
        "whether they are found, and what is doubtful.\n"
        "Of a model it prints for each configuration, in the position about which it is "
        "linearised, the "
        "total mass, its centre and inertia, the degrees of freedom, and the sets of "
        "redundant joints; of an equilibrium the displacements of its sensors from the "
        "reference position, where nothing is loaded or driven, the forces of its springs, and "
        "what each joint's first body does to its second: its force, and its moment about the "
        "joint's point on the second body, along global axes. Where a number of the model "
        "depends on a sign, an axis or an "
        "order of bodies (preloads, free angles, moments, gear ratios, products of "
        "inertia, sections, bushings), it states how the number is understood.",
    .answer = {&mt_held_file_record, MT_ANSWER_HELD},
    .run = run_info,
};
