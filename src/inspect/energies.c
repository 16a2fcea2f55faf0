/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energies of the modes of one configuration as records. */
#include "inspect/energies.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/text.h"

/* What sixteen digits leave of sums of a few dozen terms, as a part of the whole. */
static const double ROUNDING = 64.0 * DBL_EPSILON;

/* Reading the question */

static mt_status find_point(const mt_model *model, const char *name, mt_arena *mem, int *out,
                            mt_err *err)
{
    const char **const names = mt_arena_alloc(mem, (size_t)model->n_points, sizeof *names);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < model->n_points; i++) {
        names[i] = model->points[i].name.s;
        if (strcmp(names[i], name) == 0) {
            *out = i;
            return MT_OK;
        }
    }
    const char *const near = mt_text_nearest(name, names, model->n_points);
    return mt_fail(err, MT_E_USAGE, "--energy-about: the model has no point \"%s\"%s%s%s", name,
                   near == NULL ? "" : "; did you mean \"", near == NULL ? "" : near,
                   near == NULL ? "" : "\"?");
}

static mt_status find_axes(const char *name, mt_energy_axes *out, mt_err *err)
{
    for (int i = 0; i < MT_ENERGY_AXES_COUNT; i++) {
        if (strcmp(mt_energy_axes_names[i], name) == 0) {
            *out = (mt_energy_axes)i;
            return MT_OK;
        }
    }
    return mt_fail(err, MT_E_USAGE,
                   "--axes: \"%s\" is none of global, principal, torque_roll_x, torque_roll_y "
                   "and torque_roll_z",
                   name);
}

mt_status mt_energies_take(const mt_model *model, mt_analysis *a,
                           const mt_energies_question *question, int n, mt_arena *mem,
                           mt_energies *out, mt_err *err)
{
    *out = (mt_energies){.about = {.point = MT_ABSENT}, .n = n};
    if (question->about != NULL) {
        MT_TRY(find_point(model, question->about, mem, &out->about.point, err));
    }
    if (question->axes != NULL) {
        MT_TRY(find_axes(question->axes, &out->about.axes, err));
    }
    MT_TRY(mt_energy_owners_find(a->sys, mem, &out->owners, err));
    out->shares = mt_arena_alloc(mem, (size_t)n, sizeof *out->shares);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < n; i++) {
        const bool same = i > 0 && out->shares[i - 1].first + out->shares[i - 1].modes > i;
        if (same) { /* of one frequency */
            out->shares[i] = out->shares[i - 1];
        } else {
            MT_TRY(mt_analysis_energy_shares(a, i, &out->owners, &out->about, mem,
                                             &out->shares[i], err));
        }
    }
    return MT_OK;
}

/* Records */

/* In percent, without rounding. */
static double percent(double share)
{
    return fabs(share) <= ROUNDING ? 0.0 : 100.0 * share;
}

/* Members of the six directions; all bodies have the first two. */
#define DIRECTION(name, k, what) MT_F_NUMBER_OR_NULL(name, percent[k], what)
#define PLANE(number, along) \
    number("x_percent", percent[0], along " x."), number("y_percent", percent[1], along " y.")
#define SPACE(along, about)                                  \
    DIRECTION("z_percent", 2, along " z; null: none."),      \
        DIRECTION("rx_percent", 3, about " x; null: none."), \
        DIRECTION("ry_percent", 4, about " y; null: none."), \
        DIRECTION("rz_percent", 5, about " z; null: none.")

#define THIS mt_energy_body_row
static const mt_field body_fields[] = {
    MT_F_TEXT("body", body, "The body, or flexible link."),
    MT_F_CHOICE("axes", axes, mt_energy_axes_names, "The axes of its directions."),
    MT_F_NUMBER("percent", total, "Its share of the kinetic energy, in all directions [%]."),
    PLANE(MT_F_NUMBER, "Share of its motion along"),
    SPACE("Share of its motion along", "Share of its rotation about"),
};
const mt_record mt_energy_body_record =
    MT_F_RECORD_OF(body_fields, "kinetic_energy",
                   "Shares of a mode's kinetic energy [%]; below 0 where axes couple.");
#undef THIS

#define THIS mt_energy_spring_row
static const mt_field spring_fields[] = {
    MT_F_TEXT("spring", spring, "The spring, or flexible link."),
    MT_F_NUMBER("percent", total, "Its share of the strain energy [%]."),
    PLANE(MT_F_NUMBER_OR_NULL, "Of a bushing alone: share of its component"),
    SPACE("Of a bushing alone: share of its component",
          "Of a bushing alone: share of its rotation"),
};
const mt_record mt_energy_spring_record =
    MT_F_RECORD_OF(spring_fields, "strain_energy",
                   "Shares of a mode's strain energy [%]; of a component below 0 where the "
                   "bushing's matrix couples.");
#undef THIS

#define THIS mt_energy_row
static const mt_field energy_fields[] = {
    MT_F_COUNT("modes", modes, 1,
               "Number of modes of its frequency, over which shares are summed."),
    MT_F_LIST("kinetic", kinetic, n_kinetic, mt_energy_body_row, mt_energy_body_record,
              "By body: their sum is 100 % for each mode of the frequency."),
    MT_F_NUMBER("kinetic_sum_percent", kinetic_sum, "Sum of all shares [%], as computed."),
    MT_F_LIST_OR_NULL("strain", strain, n_strain, mt_energy_spring_row, mt_energy_spring_record,
                      "By spring; null: a mode at 0 Hz strains nothing."),
    MT_F_NUMBER_OR_NULL("loads_percent", loads,
                        "Share of the stiffness that gravity, loads and preloads give, which "
                        "belongs to no spring [%]; of either sign."),
    MT_F_NUMBER_OR_NULL("strain_sum_percent", strain_sum,
                        "Sum of all shares of strain and of loads [%], as computed."),
};
const mt_record mt_energy_record =
    MT_F_RECORD_OF(energy_fields, "mode_energy", "Who has the energy of a mode.");
#undef THIS

/* True where any body of the owner has the direction. */
static bool has_direction(const mt_system *sys, const mt_energy_owner *o, int k)
{
    bool any = false;
    for (int b = o->first; b < o->first + o->count; b++) {
        any = any || sys->bodies[b].dof[k] >= 0;
    }
    return any;
}

static mt_energy_body_row body_row_of(const mt_system *sys, const mt_energies *e,
                                      const mt_energy_shares *s, int b)
{
    const mt_energy_axes axes = s->global[b] ? MT_ENERGY_AXES_GLOBAL : e->about.axes;
    const double *const own = s->motion + ((ptrdiff_t)b * MT_ENERGY_DIRECTIONS);
    mt_energy_body_row row = {.body = e->owners.bodies[b].name,
                              .axes = mt_energy_axes_names[axes]};
    double sum = 0.0;
    for (int k = 0; k < MT_ENERGY_DIRECTIONS; k++) {
        row.percent[k] =
            has_direction(sys, &e->owners.bodies[b], k) ? percent(own[k]) : nan("");
        sum += own[k];
    }
    row.total = percent(sum);
    return row;
}

static mt_energy_spring_row spring_row_of(const mt_energies *e, const mt_energy_shares *s,
                                          int k)
{
    const mt_energy_owner *const o = &e->owners.springs[k];
    const double *const own = s->strain + ((ptrdiff_t)k * MT_ENERGY_DIRECTIONS);
    mt_energy_spring_row row = {.spring = o->name, .components = o->bushing};
    double sum = 0.0;
    for (int i = 0; i < MT_ENERGY_DIRECTIONS; i++) {
        row.percent[i] = o->bushing ? percent(own[i]) : nan("");
        sum += own[i];
    }
    row.total = percent(sum);
    return row;
}

mt_energy_row mt_energy_row_of(const mt_system *sys, const mt_energies *e, int i, mt_arena *mem)
{
    const mt_energy_shares *const s = &e->shares[i];
    const bool strained = isfinite(s->strain_sum);
    mt_energy_row row = {.modes = s->modes,
                         .loads = strained ? percent(s->loads) : nan(""),
                         .kinetic_sum = 100.0 * s->motion_sum,
                         .strain_sum = strained ? 100.0 * s->strain_sum : nan("")};
    row.kinetic = mt_arena_alloc(mem, (size_t)e->owners.n_bodies, sizeof *row.kinetic);
    for (int b = 0; b < e->owners.n_bodies && row.kinetic != NULL; b++) {
        row.kinetic[row.n_kinetic++] = body_row_of(sys, e, s, b);
    }
    row.strain = strained
                     ? mt_arena_alloc(mem, (size_t)e->owners.n_springs + 1, sizeof *row.strain)
                     : NULL;
    for (int k = 0; k < e->owners.n_springs && row.strain != NULL; k++) {
        row.strain[row.n_strain++] = spring_row_of(e, s, k);
    }
    return row;
}
