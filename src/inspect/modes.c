/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Natural frequencies and shapes of one configuration as records. */
#include "inspect/modes.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <string.h>

#include "analysis/analysis.h"
#include "analysis/damping.h"
#include "answer/warnings.h"
#include "modal/damped.h"
#include "result/write.h"

/* A table on paper tells the error of a frequency from this part of it on: the digits that it
 * prints. */
static const double TOLD_ERROR = 1e-6;

int mt_modes_index(const mt_modes *modes, int pos)
{
    const bool has = modes->kind[pos] == MT_MODE_FLEXIBLE && modes->n_undecided == 0;
    return has ? mt_modal_index(modes, pos) : 0;
}

static const char *const mode_kinds[] = {[MT_MODE_FLEXIBLE] = "flexible",
                                         [MT_MODE_RIGID_BODY] = "rigid_body",
                                         [MT_MODE_UNSTABLE] = "unstable",
                                         [MT_MODE_UNDECIDED] = "undecided"};

/* The number of positions to show for `count` requested vibration modes (0: all), including
 * rigid-body and unstable ones. */
static int modes_shown(const mt_modes *modes, int count)
{
    int flexible = 0;
    for (int i = 0; i < modes->count; i++) {
        if (modes->kind[i] == MT_MODE_FLEXIBLE && count > 0 && ++flexible > count) {
            return i;
        }
    }
    return modes->count;
}

static const char *const damped_kinds[] = {[MT_DAMPED_OSCILLATING] = "oscillating",
                                           [MT_DAMPED_OVERDAMPED] = "overdamped",
                                           [MT_DAMPED_RIGID_BODY] = "rigid_body",
                                           [MT_DAMPED_UNSTABLE] = "unstable",
                                           [MT_DAMPED_UNDECIDED] = "undecided"};

/* 1-based number of an oscillating mode; 0 for the others, and where one is undecided. */
static int index_of(const mt_damped_modes *d, int i)
{
    int index = 0;
    for (int k = 0; k <= i; k++) {
        index += d->kind[k] == MT_DAMPED_OSCILLATING ? 1 : 0;
    }
    return d->kind[i] == MT_DAMPED_OSCILLATING && mt_damped_indexed(d) ? index : 0;
}

/* A value of a root, or NaN of an undecided one, which is only known to be small. */
static double decided_value(const mt_damped_modes *d, int i, double x)
{
    return d->kind[i] == MT_DAMPED_UNDECIDED ? nan("") : x;
}

bool mt_modes_has_damped(const mt_damped_modes *d, int i, int count)
{
    return count == 0 || index_of(d, i) <= count;
}

/* NaN where there is no oscillation. */
static double damped_hz(const mt_damped_modes *d, int i)
{
    return d->im[i] > 0.0 ? mt_damped_hz(d, i) : nan("");
}

#define THIS mt_damped_row
static const mt_field damped_fields[] = {
    MT_F_COUNT_OR_NULL("index", index, 1,
                       "Number among the oscillating modes, from 1; null: none."),
    MT_F_CHOICE("kind", kind, damped_kinds,
                "What it is; of an undecided one rounding hides whether it is stable."),
    MT_F_NUMBER_OR_NULL("natural_frequency_hz", natural_hz,
                        "Natural frequency: the size of the pole."),
    MT_F_NUMBER_OR_NULL("natural_frequency_error_hz", natural_error_hz,
                        "Bound of its error; null: of all modes, none."),
    MT_F_NUMBER_OR_NULL("damped_frequency_hz", damped_hz,
                        "Frequency of its oscillation; null: it does not oscillate."),
    MT_F_NUMBER_OR_NULL("damping_ratio_percent", ratio_percent,
                        "Damping ratio, in per cent of the critical damping."),
    MT_F_NUMBER_OR_NULL("decay_per_s", decay_per_s, "Rate at which it decays."),
    MT_F_NUMBER("residual", residual, "Residual relative to rounding."),
};
const mt_record mt_damped_record = MT_F_RECORD_OF(
    damped_fields, "damped_mode", "A mode with damping, a root of the equations of motion.");
#undef THIS

mt_damped_row mt_damped_row_of(const mt_damped_modes *d, int i, bool for_people)
{
    const bool rigid = d->kind[i] == MT_DAMPED_RIGID_BODY;
    return (mt_damped_row){
        .index = index_of(d, i),
        .kind = for_people && rigid ? "rigid body" : damped_kinds[d->kind[i]],
        .natural_hz = decided_value(d, i, mt_damped_natural_hz(d, i)),
        .natural_error_hz = nan(""),
        .damped_hz = decided_value(d, i, damped_hz(d, i)),
        .ratio_percent = decided_value(d, i, 100.0 * mt_damped_ratio(d, i)),
        .decay_per_s = decided_value(d, i, 0.0 - d->re[i]),
        .residual = d->residual[i],
    };
}

/* All rows, *n of them in mem; error: of |s| as a part of it, or NULL. */
static mt_damped_row *damped_rows_of(const mt_damped_modes *d, const double *error, int count,
                                     mt_arena *mem, int *n)
{
    mt_damped_row *const out = mt_arena_alloc(mem, (size_t)d->count, sizeof *out);
    *n = 0;
    for (int i = 0; i < d->count && out != NULL; i++) {
        if (mt_modes_has_damped(d, i, count)) {
            out[*n] = mt_damped_row_of(d, i, false);
            out[*n].natural_error_hz =
                error == NULL ? nan("") : error[i] * mt_damped_natural_hz(d, i);
            (*n)++;
        }
    }
    return out;
}

/* Shapes. */

/* Parts of the largest component of a mode: what sixteen digits leave of a sum of a few dozen
 * terms of that size; and what nobody sees in a table. */
static const double ROUNDING = 64.0 * DBL_EPSILON;
static const double UNSEEN = 1e-12;

/* Shapes at given channels of the given positions: value ns x n. */
static mt_status shapes_at(mt_analysis *a, int ns, const int *channels, int n,
                           const int *positions, double *value, mt_err *err)
{
    for (int i = 0; i < n; i++) {
        MT_TRY(mt_analysis_shape(a, positions[i], ns, channels, value + ((ptrdiff_t)i * ns),
                                 NULL, err));
    }
    return MT_OK;
}

/* Sensors as they are, or all states, named by body and direction. */
static mt_status name_them(const mt_system *sys, int modes, mt_arena *mem, mt_mode_shapes *out,
                           mt_err *err)
{
    static const char *const directions[] = {"x", "y", "z", "rx", "ry", "rz"};
    out->sensors = sys->n_channels > 0;
    out->n = out->sensors ? sys->n_channels : sys->nq;
    out->name = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->name);
    out->head = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->head);
    out->value = mt_arena_f64(mem, (size_t)out->n, (size_t)modes);
    out->turns = mt_arena_alloc(mem, (size_t)out->n, sizeof *out->turns);
    out->largest = mt_arena_f64(mem, (size_t)modes, 1);
    out->length_m = sys->length_m;
    for (int k = 0; k < sys->n_channels && !mt_arena_failed(mem); k++) {
        const mt_channel_kind kind = sys->channels[k].kind;
        out->name[k] = mt_arena_strdup(mem, sys->channels[k].name);
        out->turns[k] = mt_channel_turns(kind);
    }
    for (int b = 0; b < sys->n_bodies && !out->sensors && !mt_arena_failed(mem); b++) {
        for (int d = 0; d < MT_COUNT(directions); d++) {
            const int q = sys->bodies[b].dof[d];
            if (q >= 0) {
                out->name[q] =
                    mt_arena_printf(mem, "%s.%s", sys->bodies[b].name, directions[d]);
                out->turns[q] = d >= 3;
            }
        }
    }
    for (int k = 0; k < out->n && !mt_arena_failed(mem); k++) {
        out->head[k] = mt_arena_printf(mem, "%s_%s", out->name[k],
                                       out->turns[k] ? "rad_per_m_sqrt_kg" : "per_sqrt_kg");
    }
    return mt_arena_check(mem, err);
}

static mt_status at_sensors(mt_analysis *a, int modes, mt_arena *mem, mt_mode_shapes *out,
                            mt_err *err)
{
    int *const channels = mt_arena_int(mem, (size_t)out->n);
    int *const positions = mt_arena_int(mem, (size_t)modes);
    MT_TRY(mt_arena_check(mem, err));
    for (int k = 0; k < out->n; k++) {
        channels[k] = k;
    }
    for (int i = 0; i < modes; i++) {
        positions[i] = i;
    }
    return shapes_at(a, out->n, channels, modes, positions, out->value, err);
}

/* Size of component k of column i, an angle times the model's length. */
static double component_size(const mt_mode_shapes *s, int k, int i)
{
    return fabs(s->value[k + ((ptrdiff_t)i * s->n)]) * (s->turns[k] ? s->length_m : 1.0);
}

/* phi nq x modes, over all states. What is rounding of the largest displacement becomes 0. */
static void clean(const mt_system *sys, int modes, const double *phi, const mt_mode_shapes *s)
{
    for (int i = 0; i < modes; i++) {
        const double *const x = phi + ((ptrdiff_t)i * sys->nq);
        double most = 0.0;
        for (int k = 0; k < s->n; k++) {
            most = fmax(most, component_size(s, k, i));
        }
        for (int k = 0; k < 6 * sys->n_bodies; k++) {
            const int dof = sys->bodies[k / 6].dof[k % 6];
            const double size = dof < 0 ? 0.0 : fabs(x[dof]);
            most = fmax(most, size * (k % 6 >= 3 ? sys->length_m : 1.0));
        }
        s->largest[i] = most;
        for (int k = 0; k < s->n; k++) {
            if (component_size(s, k, i) <= ROUNDING * most) {
                s->value[k + ((ptrdiff_t)i * s->n)] = 0.0;
            }
        }
    }
}

/* Room for the motions of all bodies. */
static mt_status room_for(const mt_system *sys, int modes, mt_arena *mem, double **phi,
                          mt_err *err)
{
    *phi = mt_arena_f64(mem, (size_t)sys->nq, (size_t)modes);
    return mt_arena_check(mem, err);
}

/* Shapes of the first `modes` positions, in mem. Components within rounding of the largest are
 * 0. */
static mt_status shapes_of(mt_analysis *a, int modes, mt_arena *mem, mt_mode_shapes *out,
                           mt_err *err)
{
    double *phi = NULL;
    MT_TRY(name_them(a->sys, modes, mem, out, err));
    MT_TRY(room_for(a->sys, modes, mem, &phi, err));
    mt_linear_expand(a->lin, modes, a->modes.y, phi);
    if (out->sensors) {
        MT_TRY(at_sensors(a, modes, mem, out, err));
    } else {
        memcpy(out->value, phi, (size_t)a->sys->nq * (size_t)modes * sizeof *phi);
    }
    clean(a->sys, modes, phi, out);
    return MT_OK;
}

static mt_status shapes_of_lowest(mt_lowest *l, int modes, mt_arena *mem, mt_mode_shapes *out,
                                  mt_err *err)
{
    double *phi = NULL;
    MT_TRY(name_them(l->sys, modes, mem, out, err));
    MT_TRY(room_for(l->sys, modes, mem, &phi, err));
    MT_TRY(mt_lowest_shapes(l, modes, phi, err));
    if (out->sensors) {
        MT_TRY(mt_lowest_sense(l, modes, out->value, err));
    } else {
        memcpy(out->value, phi, (size_t)l->sys->nq * (size_t)modes * sizeof *phi);
    }
    clean(l->sys, modes, phi, out);
    return MT_OK;
}

double mt_modes_component(const mt_mode_shapes *shapes, int k, int i)
{
    return component_size(shapes, k, i) <= UNSEEN * shapes->largest[i]
               ? 0.0
               : shapes->value[k + ((ptrdiff_t)i * shapes->n)];
}

/* Modes. */

#define THIS mt_mode_row
static const mt_field mode_fields[] = {
    MT_F_COUNT_OR_NULL("index", index, 1,
                       "Number among the vibration modes, from 1; null: none."),
    MT_F_TEXT_OR_NULL("name", name, "Name that the model gives it."),
    MT_F_NUMBER_OR_NULL("frequency_hz", hz,
                        "Natural frequency; null: unstable or undecided, it has none."),
    MT_F_NUMBER_OR_NULL("frequency_error_hz", error_hz,
                        "Bound of its error; null: it has no frequency."),
    MT_F_CHOICE("kind", kind, mode_kinds,
                "What it is; of an undecided one rounding hides whether it is stable."),
    MT_F_NUMBER("omega_squared", omega_squared, "Eigenvalue [rad^2/s^2]."),
    MT_F_NUMBER("omega_squared_error", omega_squared_error, "Bound of its error [rad^2/s^2]."),
    MT_F_COUNT("repeated", repeated, 1, "How many modes share its frequency."),
    MT_F_NUMBER("residual", residual, "Residual relative to rounding."),
    MT_F_NUMBER("orthogonality", orthogonality, "Loss of orthogonality relative to rounding."),
    MT_F_NUMBERS_BY_VARIABLE(
        "shape", shape,
        "With --shapes: the mass-normalised shape at the sensors, or without sensors the "
        "motions of the bodies, by name [1/sqrt(kg) and rad/(m sqrt(kg))].",
        MT_F_WHEN(with_shape)),
    MT_F_RECORD("energy", energy, mt_energy_row, mt_energy_record,
                "With --energy: who has its energy.", MT_F_WHEN(with_energy)),
};
const mt_record mt_mode_record = MT_F_RECORD_OF(mode_fields, "mode", "A mode.");
#undef THIS

bool mt_modes_is_rough(const mt_modes *m, int i)
{
    return m->kind[i] == MT_MODE_FLEXIBLE &&
           mt_modal_error_hz(m, i) > TOLD_ERROR * mt_modal_hz(m, i);
}

mt_mode_row mt_mode_row_of(const mt_modes_view *v, int i, bool for_people)
{
    const mt_modes *const m = v->m;
    const int index = mt_modes_index(m, i);
    int size = 1;
    (void)mt_modal_cluster(m, i, &size);
    return (mt_mode_row){
        .index = index,
        .name = mt_mode_name(v->s, v->c, index),
        .hz = mt_modal_hz(m, i),
        .error_hz = for_people && !mt_modes_is_rough(m, i) ? nan("") : mt_modal_error_hz(m, i),
        .kind = for_people && m->kind[i] == MT_MODE_RIGID_BODY ? "rigid body"
                                                               : mode_kinds[m->kind[i]],
        .omega_squared = m->lambda[i],
        .omega_squared_error = m->error[i],
        .repeated = size,
        .residual = m->residual[i],
        .orthogonality = m->orthogonality[i],
        .with_shape = v->shapes.n > 0,
        .shape = v->shapes.n > 0 ? v->shapes.value + ((ptrdiff_t)i * v->shapes.n) : NULL,
    };
}

double mt_modes_complete_below_hz(const mt_lowest *l)
{
    return sqrt(l->found.tau) / (2.0 * 3.14159265358979323846);
}

int mt_modes_redundant(const mt_lowest *l)
{
    return l != NULL && l->way == MT_LOWEST_SPARSE
               ? l->equations - (l->sys->nq - l->found.modes.n)
               : 0;
}

const mt_state *mt_modes_position(const mt_modes_view *v)
{
    if (v->a != NULL) {
        return mt_linear_position(v->a->lin);
    }
    return v->l != NULL ? mt_lowest_settled(v->l) : NULL;
}

/* Effective masses. */

#define THIS mt_effective_row
static const mt_field effective_fields[] = {
    MT_F_TEXT("direction", direction,
              "Of the ground: \"x\", \"y\", \"z\" along, \"rx\", \"ry\", \"rz\" about a global "
              "axis."),
    MT_F_TEXT("unit", unit, "Of the masses: \"kg\", about an axis \"kg m^2\"."),
    MT_F_NUMBER(
        "total", total,
        "Mass, or moment of inertia, of all that no fixed joints hold to the ground, in "
        "the unit that `unit` names."),
    MT_F_NUMBER("sum", sum,
                "Sum of the effective masses of the modes that are listed, in the same unit."),
    MT_F_NUMBER_OR_NULL("sum_percent", sum_percent,
                        "That in percent of the total; null: the total is 0."),
    MT_F_NUMBERS("participation", participation, n_modes,
                 "Participation factor of each of the modes, of the mass-normalised "
                 "shape [sqrt(kg) or m sqrt(kg)]."),
    MT_F_NUMBERS("effective_mass", mass, n_modes,
                 "Effective modal mass of each, in the same unit: the square of that."),
};
static const mt_record effective_record = MT_F_RECORD_OF(
    effective_fields, "effective_mass", "What modes have of a ground that moves one way.");
#undef THIS

static void sum_effective(const mt_base_motion *b, int k, mt_effective_row *out)
{
    out->direction = mt_base_motion_name(b->axis[k]);
    out->unit = b->axis[k] < 3 ? "kg" : "kg m^2";
    out->total = b->total[k];
    for (int i = 0; i < out->n_modes; i++) {
        out->mass[i] = out->participation[i] * out->participation[i];
        out->sum += out->mass[i];
    }
    out->sum_percent = out->total > 0.0 ? 100.0 * out->sum / out->total : nan("");
}

static mt_status find_effective(mt_modes_view *v, mt_err *err)
{
    const mt_system *const sys = v->l != NULL ? v->l->sys : v->a->sys;
    const double *const inputs = v->l != NULL ? v->l->at : v->s->at;
    const size_t shown = (size_t)v->shown;
    double gamma[MT_BASE_MOTIONS];
    mt_base_motion b;
    double *const phi = mt_arena_f64(&v->mem, (size_t)sys->nq, shown);
    MT_TRY(mt_arena_check(&v->mem, err));
    MT_TRY(mt_base_motion_new(sys, mt_modes_position(v), inputs, v->question.about_m, &v->mem,
                              &b, err));
    if (v->l != NULL) {
        MT_TRY(mt_lowest_shapes(v->l, v->shown, phi, err));
    } else {
        mt_linear_expand(v->a->lin, v->shown, v->a->modes.y, phi);
    }
    v->n_effective = b.n;
    v->effective = mt_arena_alloc(&v->mem, (size_t)b.n, sizeof *v->effective);
    for (int k = 0; k < b.n && v->effective != NULL; k++) {
        v->effective[k].n_modes = v->shown;
        v->effective[k].participation = mt_arena_f64(&v->mem, shown, 1);
        v->effective[k].mass = mt_arena_f64(&v->mem, shown, 1);
    }
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < v->shown; i++) {
        mt_base_motion_participation(&b, sys->nq, phi + ((ptrdiff_t)i * sys->nq), gamma);
        for (int k = 0; k < b.n; k++) {
            v->effective[k].participation[i] = gamma[k];
        }
    }
    for (int k = 0; k < b.n; k++) {
        sum_effective(&b, k, &v->effective[k]);
    }
    return MT_OK;
}

#define THIS mt_equilibrium_row
static const mt_field equilibrium_fields[] = {
    MT_F_FLAG("solved", solved, "Loads act, and their equilibrium was found."),
    MT_F_COUNT("iterations", iterations, 0, "Iterations that it took."),
    MT_F_NUMBER("residual", residual, "Part of the forces at work that is left."),
    MT_F_NUMBER("gap_m", gap_m, "Largest violation of a joint."),
    MT_F_NUMBER("largest_motion_m", largest_motion_m,
                "Largest displacement of a mass centre from the reference position."),
    MT_F_NUMBER("largest_turn_rad", largest_turn_rad,
                "Largest rotation of a body from the reference position."),
};
static const mt_record equilibrium_record =
    MT_F_RECORD_OF(equilibrium_fields, NULL, "The equilibrium.");
#undef THIS

#define THIS mt_modes_row
static const mt_field configuration_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_LIST("doubts", warnings, n_warnings, mt_warning, mt_warning_record,
              "What is suspicious in the model."),
    MT_F_LIST("facts", notes, n_notes, mt_warning, mt_warning_record,
              "What the model leaves open, or simplifies."),
    MT_F_ENUM("method", method, mt_lowest_method, mt_lowest_method_names,
              "\"dense\": all modes were found; \"tree\", \"sparse\": the lowest ones of a "
              "large mechanism."),
    MT_F_NUMBER_OR_NULL("complete_below_hz", complete_below_hz,
                        "Below this frequency no mode is missing; null: none is missing at "
                        "all."),
    MT_F_COUNT("freedoms", freedoms, 0, "Number of degrees of freedom."),
    MT_F_COUNT_OR_NULL("vibration_modes", vibration_modes, 0,
                       "Number of vibration modes; null: not counted, of the lowest ones "
                       "only."),
    MT_F_COUNT("rigid_body_modes", rigid_body_modes, 0, "Number of modes of frequency 0."),
    MT_F_COUNT("unstable_modes", unstable_modes, 0, "Number of modes that grow."),
    MT_F_COUNT("undecided_modes", undecided_modes, 0,
               "Number of modes of which rounding hides whether they are stable."),
    MT_F_COUNT_OR_NULL("massless_directions", massless_directions, 0,
                       "Number of directions without mass, which follow statically; null: not "
                       "counted, of the lowest ones only."),
    MT_F_LIST("modes", modes, n_modes, mt_mode_row, mt_mode_record,
              "The modes, lowest first: as many vibrations as --count says."),
    MT_F_LIST("damped_modes", damped, n_damped, mt_damped_row, mt_damped_record,
              "With --damped: the modes with damping.", MT_F_WHEN(with_damping)),
    MT_F_NUMBERS("about_m", about_m, n_about,
                 "With --effective-mass: the point that rotations of the ground are about [m].",
                 MT_F_WHEN(with_effective)),
    MT_F_LIST("effective_mass", effective, n_effective, mt_effective_row, effective_record,
              "With --effective-mass: participation factors and effective modal masses, by "
              "direction of the ground.",
              MT_F_WHEN(with_effective)),
    MT_F_LIST_OR_NULL("redundant_constraints", redundant, n_redundant, mt_joints_row,
                      mt_joints_record,
                      "Sets of joints whose equations depend on each other; null: there are "
                      "some, which were not looked for."),
    MT_F_RECORD("equilibrium", equilibrium, mt_equilibrium_row, equilibrium_record,
                "Where the modes are: at rest under the loads."),
};
const mt_record mt_modes_record =
    MT_F_RECORD_OF(configuration_fields, "configuration", "A configuration, answered.");
#undef THIS

static mt_equilibrium_row equilibrium_row_of(const mt_modes_view *v)
{
    /* what is answered without an analysis is at rest as drawn */
    const mt_state drawn = {.equilibrium.active = v->l != NULL && v->l->sys->loaded};
    const mt_state *const settled = mt_modes_position(v);
    const mt_state *const at = settled == NULL ? &drawn : settled;
    return (mt_equilibrium_row){
        .solved = at->equilibrium.active,
        .iterations = at->iterations,
        .residual = at->equilibrium.residual,
        .gap_m = at->gap_m,
        .largest_motion_m = at->moved_m,
        .largest_turn_rad = at->turned_rad,
    };
}

static mt_status modes_row_of(mt_modes_view *v, mt_modes_row *out, mt_err *err)
{
    const mt_modes *const m = v->m;
    *out = (mt_modes_row){
        .configuration = mt_loaded_model_configuration(v->s, v->c),
        .method = v->l == NULL ? MT_LOWEST_NONE : v->l->way,
        .complete_below_hz = v->l == NULL ? nan("") : mt_modes_complete_below_hz(v->l),
        .freedoms = m->n,
        /* of the lowest ones these take the directions without mass, which are not sought */
        .vibration_modes = v->l == NULL ? mt_modal_vibrations(m) : -1,
        .rigid_body_modes = m->n_rigid,
        .unstable_modes = m->n_unstable,
        .undecided_modes = m->n_undecided,
        .massless_directions = v->l == NULL ? m->n_condensed : -1,
        .n_modes = v->shown,
        .with_damping = v->question.damped,
        .with_effective = v->n_effective > 0,
        .effective = v->effective,
        .n_effective = v->n_effective,
        .n_about = 3,
        .about_m = v->question.about_m,
        .equilibrium = equilibrium_row_of(v),
    };
    const mt_warning_list *const list = &v->warning_list;
    out->warnings = mt_warning_pick(list, MT_LEVEL_WARNING, &v->mem, &out->n_warnings);
    out->notes = mt_warning_pick(list, MT_LEVEL_NOTE, &v->mem, &out->n_notes);
    out->modes = mt_arena_alloc(&v->mem, (size_t)v->shown, sizeof *out->modes);
    for (int i = 0; i < v->shown && out->modes != NULL; i++) {
        out->modes[i] = mt_mode_row_of(v, i, false);
        out->modes[i].with_energy = v->energies.n > 0;
        if (v->energies.n > 0) {
            out->modes[i].energy = mt_energy_row_of(v->a->sys, &v->energies, i, &v->mem);
        }
    }
    if (v->question.damped) {
        out->damped =
            damped_rows_of(v->damped, v->few.error, v->question.count, &v->mem, &out->n_damped);
    }
    if (v->a != NULL) {
        MT_TRY(mt_redundant_rows(v->a->lin, &v->mem, &out->n_redundant, &out->redundant, err));
    } else if (mt_modes_redundant(v->l) ==
               0) { /* else there are some; which, is not looked for */
        out->redundant = mt_arena_alloc(&v->mem, 1, sizeof *out->redundant);
    }
    return mt_arena_check(&v->mem, err);
}

mt_status mt_modes_put(mt_modes_view *v, mt_json_writer *w, mt_err *err)
{
    mt_modes_row row;
    MT_TRY(modes_row_of(v, &row, err));
    mt_record_put_object(w, NULL, &mt_modes_record, &row, v->shapes.n, v->shapes.name);
    return MT_OK;
}

/* Undamped modes that are sought beyond those asked for, where the damped ones are to be found
 * from them, by attempt: damping reorders roots, and takes some from those that oscillate. */
static const int DAMPED_BESIDES[] = {8, 60};

/* The lowest damped modes; *is false: they need all modes, for the reason in why. */
static mt_status solve_few_damped(mt_modes_view *v, bool *is, char *why, mt_err *err)
{
    const mt_loaded_model *const s = v->s;
    for (int i = 0; i < MT_COUNT(DAMPED_BESIDES) && !(*is && v->few.enough); i++) {
        const mt_lowest_want want = {.count = v->question.count + DAMPED_BESIDES[i],
                                     .shapes = true};
        mt_lowest_delete(v->l);
        v->l = NULL;
        *is = false;
        MT_TRY(
            mt_loaded_model_lowest(s, v->c, s->n_inputs, s->inputs, s->at, want, &v->l, err));
        if (v->l == NULL) {
            return MT_OK;
        }
        const mt_status rc =
            mt_lowest_damped_modes(v->l, v->question.count, &v->mem, &v->few, is, why, err);
        if (rc != MT_OK) {
            return mt_err_in(err, rc, "%s: configuration \"%s\"", s->path,
                             mt_loaded_model_configuration(s, v->c));
        }
    }
    v->damped = &v->few.modes;
    return MT_OK;
}

/* Find the lowest modes only, where these are requested and there is a fast method. */
static mt_status solve_modes(mt_modes_view *v, mt_err *err)
{
    const mt_loaded_model *const s = v->s;
    const mt_modes_question *const q = &v->question;
    const mt_lowest_want want = {.count = q->count, .shapes = q->shapes || q->effective_mass};
    char why[MT_LOWEST_DAMPED_WHY] = "";
    bool is = true;
    const bool few = q->damped && q->count > 0 && q->count < INT_MAX / 2;
    if (q->energy) {
        MT_TRY(mt_loaded_model_admit_dense(s, v->c, "shares of energy take all modes", err));
    } else {
        MT_TRY(few ? solve_few_damped(v, &is, why, err)
                   : mt_loaded_model_lowest(s, v->c, s->n_inputs, s->inputs, s->at, want, &v->l,
                                            err));
    }
    if (v->l != NULL && !is) {
        mt_lowest_delete(v->l);
        v->l = NULL;
        MT_TRY(mt_loaded_model_admit_dense(s, v->c, why, err));
    }
    if (v->l != NULL) {
        v->m = &v->l->found.modes;
        return mt_warnings_of_lowest(v->l, s->n_inputs, s->inputs, s->at, &v->warning_list,
                                     err);
    }
    MT_TRY(
        mt_loaded_model_analyse(s, v->c, q->damped || q->energy ? 0 : want.count, &v->a, err));
    v->m = &v->a->modes;
    return mt_warnings_of_analysis(v->a, s->n_inputs, s->inputs, s->at, &v->warning_list, err);
}

mt_status mt_modes_view_take(const mt_loaded_model *s, int c, const mt_modes_question *question,
                             mt_modes_view *v, mt_err *err)
{
    v->s = s;
    v->c = c;
    v->question = *question;
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    v->warning_list = mt_warning_list_default(&v->mem);
    MT_TRY(solve_modes(v, err));
    v->shown = modes_shown(v->m, question->count);
    if (question->shapes) {
        MT_TRY(v->l != NULL ? shapes_of_lowest(v->l, v->shown, &v->mem, &v->shapes, err)
                            : shapes_of(v->a, v->shown, &v->mem, &v->shapes, err));
    }
    MT_TRY(question->effective_mass ? find_effective(v, err) : MT_OK);
    if (question->energy) {
        MT_TRY(mt_energies_take(s->model, v->a, &question->energies, v->shown, &v->mem,
                                &v->energies, err));
    }
    return question->damped && v->l == NULL ? mt_analysis_damped(v->a, &v->damped, err) : MT_OK;
}

void mt_modes_view_free(mt_modes_view *v)
{
    mt_lowest_delete(v->l);
    mt_analysis_delete(v->a);
    mt_arena_free(&v->mem);
    memset(v, 0, sizeof *v);
}
