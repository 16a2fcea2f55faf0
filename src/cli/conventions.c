/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The conventions of the model's schema, said of this model's numbers. The coordinate q of a
 * joint is how far its second body stands from the first, about the axis (right-handed; in two
 * dimensions counter-clockwise) or along it; a spring there has the energy
 * k (q - free)^2 / 2 + preload q, so that it acts with -k (q - free) - preload on the second
 * body.
 */
#include "cli/conventions.h"

#include <math.h>
#include <stddef.h>

#include "model/joint.h"

/* So many lines tell what is meant; a large model repeats itself. */
enum { MOST_LINES = 24 };

typedef struct writer {
    const mt_model *m;
    int configuration;
    const double *value;
    mt_text *out;
    int lines;
    int left; /* not written any more */
} writer;

/* Is another line wanted? Begins it. */
static bool begins(writer *w)
{
    if (w->lines == MOST_LINES) {
        w->left++;
        return false;
    }
    mt_text_add(w->out, w->lines++ == 0 ? "  conventions\n    " : "    ");
    return true;
}

/* A number that is given and not 0. */
static bool has(const writer *w, mt_num num, double *v)
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

static const char *about(const writer *w)
{
    return w->m->dimension == 2 ? "clockwise" : "against the axis";
}

static const char *along(const writer *w)
{
    return w->m->dimension == 2 ? "counter-clockwise" : "about the axis";
}

static void write_products(writer *w)
{
    static const char *const names[] = {"xy", "xz", "yz"};
    for (int i = 0; i < w->m->n_bodies; i++) {
        const mt_body *const b = &w->m->bodies[i];
        double v = 0.0;
        bool any = false;
        if (!mt_model_present(&b->in, w->configuration) || w->m->dimension == 2) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            any = any || has(w, b->inertia[3 + k], &v);
        }
        if (!any || !begins(w)) {
            continue;
        }
        mt_text_addf(w->out, "body \"%s\": inertia", b->name.s);
        for (int k = 0; k < 3; k++) {
            if (has(w, b->inertia[3 + k], &v)) {
                mt_text_addf(w->out, " %s %g", names[k], v);
            }
        }
        mt_text_add(w->out, ": elements of the tensor, minus the integrals of x y, x z, y z "
                            "over the mass (a CAD system's positive integrals change sign)\n");
    }
}

static void write_torsion(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, s->joint, s->bodies);
    double v = 0.0;
    if (has(w, s->preload, &v) && begins(w)) {
        mt_text_addf(w->out,
                     "spring \"%s\": preload_n_m %g turns \"%s\" against \"%s\" %s, as drawn\n",
                     s->name.s, v, of.second, of.first, v > 0.0 ? about(w) : along(w));
    }
    if (has(w, s->free_angle, &v) && begins(w)) {
        mt_text_addf(w->out,
                     "spring \"%s\": no torque where \"%s\" is turned by %g rad %s against "
                     "\"%s\", from the drawing\n",
                     s->name.s, of.second, fabs(v), v > 0.0 ? along(w) : about(w), of.first);
    }
}

static void write_axial(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, s->joint, s->bodies);
    double v = 0.0;
    if (!has(w, s->preload, &v) || !begins(w)) {
        return;
    }
    if (s->joint_name.s != NULL) {
        mt_text_addf(w->out,
                     "spring \"%s\": preload_n %g pushes \"%s\" %s the axis of \"%s\"\n",
                     s->name.s, v, of.second, v > 0.0 ? "against" : "along", s->joint_name.s);
    } else {
        mt_text_addf(w->out, "spring \"%s\": preload_n %g is %s: it %s\n", s->name.s, v,
                     v > 0.0 ? "tension" : "compression",
                     v > 0.0 ? "draws its two points together" : "pushes its two points apart");
    }
}

static void write_bushing(writer *w, const mt_spring *s)
{
    const pair of = pair_of(w, MT_ABSENT, s->bodies);
    if (begins(w)) {
        mt_text_addf(w->out,
                     "%s \"%s\": along the drawing's x, y%s, carried by \"%s\"; about %s of "
                     "\"%s\", where its forces act on both\n",
                     s->damper ? "damper" : "spring", s->name.s,
                     w->m->dimension == 2 ? "" : ", z", of.first,
                     s->n_at > 0 ? "the point" : "the centre", of.second);
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
        if (has(w, j->ratio, &v) && begins(w)) {
            mt_text_addf(w->out,
                         "gear \"%s\": \"%s\" turns %g times as far as \"%s\", each about "
                         "its own axis\n",
                         j->name.s, j->gear_joints[1].s, v, j->gear_joints[0].s);
        }
        if (has(w, j->ratio_m_per_rad, &v) && begins(w)) {
            mt_text_addf(
                w->out,
                "rack \"%s\": \"%s\" slides by %g m along its axis when \"%s\" turns by "
                "1 rad\n",
                j->name.s, j->gear_joints[1].s, v, j->gear_joints[0].s);
        }
    }
}

static void write_load(writer *w, const mt_load *load)
{
    double v = 0.0;
    const pair of = pair_of(w, load->joint, NULL);
    const bool on_joint = load->joint_name.s != NULL;
    if (load->has_moment && has(w, load->moment, &v) && begins(w)) {
        mt_text_addf(w->out, "load \"%s\": moment_n_m %g turns \"%s\" %s%s%s%s\n", load->name.s,
                     v, on_joint ? of.second : load->on.name.s, v > 0.0 ? along(w) : about(w),
                     on_joint ? ", and \"" : "", on_joint ? of.first : "",
                     on_joint ? "\" the other way" : "");
    } else if (load->has_force && on_joint && has(w, load->force[0], &v) && begins(w)) {
        mt_text_addf(w->out,
                     "load \"%s\": force_n %g pushes \"%s\" %s the axis, and \"%s\" the other "
                     "way\n",
                     load->name.s, v, of.second, v > 0.0 ? "along" : "against", of.first);
    }
}

static void write_loads(writer *w)
{
    for (int i = 0; i < w->m->n_loads; i++) {
        if (mt_model_present(&w->m->loads[i].in, w->configuration)) {
            write_load(w, &w->m->loads[i]);
        }
    }
}

static void write_sections(writer *w)
{
    for (int i = 0; i < w->m->n_links; i++) {
        const mt_link *const l = &w->m->links[i];
        const mt_section_shape shape = l->section.shape;
        if (!mt_model_present(&l->in, w->configuration) ||
            (shape != MT_SECTION_RECTANGLE && shape != MT_SECTION_GENERAL) || !begins(w)) {
            continue;
        }
        const char *const axis =
            w->m->dimension == 2 ? "z, out of the plane" : "its hinge axis";
        mt_text_addf(w->out,
                     shape == MT_SECTION_RECTANGLE
                         ? "link \"%s\": width_m is along %s, height_m across it\n"
                         : "link \"%s\": second_moment_m4 is for bending about %s\n",
                     l->name.s, axis);
    }
}

static void write_drive(writer *w)
{
    const mt_drive *const d = &w->m->configurations[w->configuration].drive;
    double v = 0.0;
    if (!d->given || d->joint == MT_ABSENT || !has(w, d->position, &v) || !begins(w)) {
        return;
    }
    const pair of = pair_of(w, d->joint, NULL);
    const char *const way = d->position_is_angle ? v > 0.0 ? along(w) : about(w)
                            : v > 0.0 ? "along the axis"
                                                 : "against the axis";
    mt_text_addf(w->out, "drive: \"%s\" stands %g %s %s against \"%s\", from the drawing\n",
                 of.second, fabs(v), d->position_is_angle ? "rad" : "m", way, of.first);
}

void mt_cli_write_conventions(const mt_model *model, int configuration, const double *value,
                              mt_text *out)
{
    writer w = {.m = model, .configuration = configuration, .value = value, .out = out};
    write_drive(&w);
    write_products(&w);
    write_sections(&w);
    write_gears(&w);
    write_springs(&w);
    write_loads(&w);
    if (w.left > 0) {
        mt_text_addf(out, "    and %d more of these kinds\n", w.left);
    }
}
