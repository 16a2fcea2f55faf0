/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune modes: natural frequencies and shapes. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "analysis/analysis.h"
#include "analysis/damping.h"
#include "analysis/lowest_damped.h"
#include "answer/warnings.h"
#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "report/table.h"

/* Natural frequencies and shapes of one configuration, or of all. */

/* Shapes of modes at the sensors, or, without sensors, as motions of the bodies. */
typedef struct mode_shapes {
    bool sensors;
    int n;             /* channels; 0: none */
    const char **name; /* [n] "c1.y", "crank.rz" */
    const char **head; /* [n] the name in CSV, with its unit */
    bool *turns;       /* [n] it is an angle */
    double *value;     /* n x modes, mass-normalised */
    double length_m;   /* length at which an angle is compared with a displacement */
    double *largest;   /* [modes] largest displacement of a body or at a sensor */
} mode_shapes;

/* 1-based index of the vibration mode at position pos; 0 for rigid-body, unstable and undecided
 * modes, and for all modes where one is undecided. */
static int index_of_mode(const mt_modes *modes, int pos)
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

/* What modes --damped adds. */

enum { DIGITS = 6, RATIO_DIGITS = 2 };

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

static bool is_within_count(const mt_damped_modes *d, int i, int count)
{
    return count == 0 || index_of(d, i) <= count;
}

/* NaN where there is no oscillation. */
static double damped_hz(const mt_damped_modes *d, int i)
{
    return d->im[i] > 0.0 ? mt_damped_hz(d, i) : nan("");
}

/* A damped mode. */
typedef struct damped_row {
    int index; /* 0: none */
    const char *kind;
    double natural_hz;
    double natural_error_hz; /* NaN: not bounded */
    double damped_hz;
    double ratio_percent;
    double decay_per_s;
    double residual;
} damped_row;

#define THIS damped_row
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
static const mt_record damped_record = MT_F_RECORD_OF(
    damped_fields, "damped_mode", "A mode with damping, a root of the equations of motion.");
static const mt_record_column damped_columns[] = {
    MT_R_COLUMN(index, "damped mode", 0, MT_IN_TABLES),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_TABLES),
    MT_R_COLUMN(natural_hz, "natural [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(damped_hz, "damped [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(ratio_percent, "damping ratio [%]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(decay_per_s, "decay [1/s]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(residual, "residual", RATIO_DIGITS, MT_IN_TABLES),
};
static const mt_record_table damped_rows = MT_R_TABLE_OF(damped_record, damped_columns);
#undef THIS

/* for_people: its kind in words. */
static damped_row damped_row_of(const mt_damped_modes *d, int i, bool for_people)
{
    const bool rigid = d->kind[i] == MT_DAMPED_RIGID_BODY;
    return (damped_row){
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

/* Print the table with its notes. count: oscillating modes to show, 0: all. */
static void damped_print(const mt_damped_modes *d, int count, mt_text *out)
{
    mt_table t = mt_table_default();
    int overdamped = 0;
    mt_table_record_columns(&t, &damped_rows, MT_IN_TEXT);
    for (int i = 0; i < d->count; i++) {
        const damped_row row = damped_row_of(d, i, true);
        if (is_within_count(d, i, count)) {
            mt_table_record_row(&t, &damped_rows, MT_IN_TEXT, &row);
        }
        overdamped += d->kind[i] == MT_DAMPED_OVERDAMPED ? 1 : 0;
    }
    mt_text_add(out, "\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    if (overdamped > 0) {
        mt_text_addf(out, "  %d real root%s: %s without oscillation.\n", overdamped,
                     overdamped == 1 ? "" : "s", overdamped == 1 ? "it decays" : "they decay");
    }
}

/* Rows of CSV, each behind its configuration. */
static void damped_csv(const mt_damped_modes *d, int count, const char *configuration,
                       mt_table *t)
{
    for (int i = 0; i < d->count; i++) {
        const damped_row row = damped_row_of(d, i, false);
        if (is_within_count(d, i, count)) {
            mt_table_text(t, configuration);
            mt_table_record_row(t, &damped_rows, MT_IN_CSV, &row);
        }
    }
}

/* All rows, *n of them in mem; error: of |s| as a part of it, or NULL. */
static damped_row *damped_rows_of(const mt_damped_modes *d, const double *error, int count,
                                  mt_arena *mem, int *n)
{
    damped_row *const out = mt_arena_alloc(mem, (size_t)d->count, sizeof *out);
    *n = 0;
    for (int i = 0; i < d->count && out != NULL; i++) {
        if (is_within_count(d, i, count)) {
            out[*n] = damped_row_of(d, i, false);
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
static mt_status name_them(const mt_system *sys, int modes, mt_arena *mem, mode_shapes *out,
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

static mt_status at_sensors(mt_analysis *a, int modes, mt_arena *mem, mode_shapes *out,
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
static double component_size(const mode_shapes *s, int k, int i)
{
    return fabs(s->value[k + ((ptrdiff_t)i * s->n)]) * (s->turns[k] ? s->length_m : 1.0);
}

/* phi nq x modes, over all states. What is rounding of the largest displacement becomes 0. */
static void clean(const mt_system *sys, int modes, const double *phi, const mode_shapes *s)
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

/* A component of column i as shown in a table of a few digits: 0 where it is negligible
 * relative to the largest of its mode. */
static double shapes_shown(const mode_shapes *shapes, int k, int i)
{
    return component_size(shapes, k, i) <= UNSEEN * shapes->largest[i]
               ? 0.0
               : shapes->value[k + ((ptrdiff_t)i * shapes->n)];
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
static mt_status shapes_of(mt_analysis *a, int modes, mt_arena *mem, mode_shapes *out,
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

static mt_status shapes_of_lowest(mt_lowest *l, int modes, mt_arena *mem, mode_shapes *out,
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

/* The command. */

/* Without --count: more modes than this are rarely read, and of large mechanisms the lowest are
 * found in a small part of the time. */
enum { DEFAULT_MODES = 20 };
enum { HZ_DIGITS = 6 };
/* A table on paper tells the error of a frequency from this part of it on: the digits that it
 * prints. */
static const double TOLD_ERROR = 1e-6;
/* A greater part of the forces at work is left in an equilibrium only where they are rounding
 * of what they are made of: that part says nothing. */
static const double MOST_LEFT = 1e-9;

/* One configuration, ready to be written. */
typedef struct view {
    const mt_loaded_model *s;
    int c;
    mt_analysis *a;     /* by dense matrices; NULL: */
    mt_lowest *l;       /* of the lowest ones */
    const mt_modes *m;  /* of one of them */
    int shown;          /* positions of modes to write */
    mode_shapes shapes; /* n 0: not asked for */
    int count;          /* of vibration modes to write */
    bool asked;         /* by --count */
    bool with_damping;
    const mt_damped_modes *damped;
    mt_lowest_damped few; /* of a large mechanism: `damped` is of these */
    mt_warning_list warning_list;
    mt_arena *mem;
} view;

/* A mode. */
typedef struct mode_row {
    int index; /* of vibration modes; 0: none */
    const char *name;
    double hz;
    double error_hz;
    const char *kind;
    double omega_squared;
    double omega_squared_error;
    int repeated;
    double residual;
    double orthogonality;
    bool with_shape;
    double *shape; /* by channel */
} mode_row;

/* Among columns for people: where an error is large enough to be shown. */
enum { IN_ROUGH = MT_IN_OWN };

#define THIS mode_row
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
};
static const mt_record mode_record = MT_F_RECORD_OF(mode_fields, "mode", "A mode.");
static const mt_record_column mode_columns[] = {
    MT_R_COLUMN(index, "mode", 0, MT_IN_TABLES),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_TABLES),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(error_hz, "error [Hz]", RATIO_DIGITS, MT_IN_CSV | IN_ROUGH),
    MT_R_COLUMN(name, "name", 0, MT_IN_TABLES),
    MT_R_COLUMN(residual, "residual", RATIO_DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(orthogonality, "orthogonality", RATIO_DIGITS, MT_IN_TABLES),
    {.offset = offsetof(THIS, omega_squared),
     .heading = "omega^2 [rad^2/s^2]",
     .member = "omega_squared_rad2_per_s2",
     .digits = HZ_DIGITS,
     .in = MT_IN_CSV},
};
static const mt_record_table mode_rows = MT_R_TABLE_OF(mode_record, mode_columns);
#undef THIS

/* True where the error of this mode's frequency is large enough to be shown. */
static bool is_rough(const mt_modes *m, int i)
{
    return m->kind[i] == MT_MODE_FLEXIBLE &&
           mt_modal_error_hz(m, i) > TOLD_ERROR * mt_modal_hz(m, i);
}

static bool any_rough(const view *v)
{
    bool rough = false;
    for (int i = 0; i < v->shown; i++) {
        rough = rough || is_rough(v->m, i);
    }
    return rough;
}

/* for_people: its kind in words, and no error that is not large. */
static mode_row mode_row_of(const view *v, int i, bool for_people)
{
    const mt_modes *const m = v->m;
    const int index = index_of_mode(m, i);
    int size = 1;
    (void)mt_modal_cluster(m, i, &size);
    return (mode_row){
        .index = index,
        .name = mt_mode_name(v->s, v->c, index),
        .hz = mt_modal_hz(m, i),
        .error_hz = for_people && !is_rough(m, i) ? nan("") : mt_modal_error_hz(m, i),
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

/* Below this frequency no mode is missing. */
static double complete_below_hz(const mt_lowest *l)
{
    return sqrt(l->found.tau) / (2.0 * 3.14159265358979323846);
}

/* Equations of joints that follow from others. */
static int n_redundant(const mt_lowest *l)
{
    return l != NULL && l->way == MT_LOWEST_SPARSE
               ? l->equations - (l->sys->nq - l->found.modes.n)
               : 0;
}

/* The position of linearisation; NULL: the reference position. */
static const mt_state *position_of(const view *v)
{
    if (v->a != NULL) {
        return mt_linear_position(v->a->lin);
    }
    return v->l != NULL ? mt_lowest_settled(v->l) : NULL;
}

/* The equilibrium at which the equations are linearised. */
typedef struct equilibrium_row {
    bool solved;
    int iterations;
    double residual;
    double gap_m;
    double largest_motion_m;
    double largest_turn_rad;
} equilibrium_row;

#define THIS equilibrium_row
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

/* One configuration, answered. */
typedef struct configuration_row {
    const char *configuration;
    mt_warning *warnings;
    int n_warnings;
    mt_warning *notes;
    int n_notes;
    mt_lowest_method method;
    double complete_below_hz;
    int freedoms;
    int vibration_modes; /* -1: not known */
    int rigid_body_modes;
    int unstable_modes;
    int undecided_modes;
    int massless_directions; /* -1: not known */
    mode_row *modes;
    int n_modes;
    bool with_damping;
    damped_row *damped;
    int n_damped;
    mt_joints_row *redundant; /* NULL: not looked for */
    int n_redundant;
    equilibrium_row equilibrium;
} configuration_row;

#define THIS configuration_row
static const mt_field configuration_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_LIST("doubts", warnings, n_warnings, mt_warning, mt_warning_record,
              "What is suspicious in the model."),
    MT_F_LIST("facts", notes, n_notes, mt_warning, mt_warning_record,
              "What the model leaves open, or simplifies."),
    MT_F_ENUM("method", method, mt_lowest_method, mt_cli_methods,
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
    MT_F_LIST("modes", modes, n_modes, mode_row, mode_record,
              "The modes, lowest first: as many vibrations as --count says."),
    MT_F_LIST("damped_modes", damped, n_damped, damped_row, damped_record,
              "With --damped: the modes with damping.", MT_F_WHEN(with_damping)),
    MT_F_LIST_OR_NULL("redundant_constraints", redundant, n_redundant, mt_joints_row,
                      mt_joints_record,
                      "Sets of joints whose equations depend on each other; null: there are "
                      "some, which were not looked for."),
    MT_F_RECORD("equilibrium", equilibrium, equilibrium_row, equilibrium_record,
                "Where the modes are: at rest under the loads."),
};
static const mt_record configuration_record =
    MT_F_RECORD_OF(configuration_fields, "configuration", "A configuration, answered.");
#undef THIS

static equilibrium_row equilibrium_row_of(const view *v)
{
    /* what is answered without an analysis is at rest as drawn */
    const mt_state drawn = {.equilibrium.active = v->l != NULL && v->l->sys->loaded};
    const mt_state *const settled = position_of(v);
    const mt_state *const at = settled == NULL ? &drawn : settled;
    return (equilibrium_row){
        .solved = at->equilibrium.active,
        .iterations = at->iterations,
        .residual = at->equilibrium.residual,
        .gap_m = at->gap_m,
        .largest_motion_m = at->moved_m,
        .largest_turn_rad = at->turned_rad,
    };
}

static mt_status configuration_row_of(const view *v, configuration_row *out, mt_err *err)
{
    const mt_modes *const m = v->m;
    *out = (configuration_row){
        .configuration = mt_loaded_model_configuration(v->s, v->c),
        .method = v->l == NULL ? MT_LOWEST_NONE : v->l->way,
        .complete_below_hz = v->l == NULL ? nan("") : complete_below_hz(v->l),
        .freedoms = m->n,
        /* of the lowest ones these take the directions without mass, which are not sought */
        .vibration_modes = v->l == NULL ? mt_modal_vibrations(m) : -1,
        .rigid_body_modes = m->n_rigid,
        .unstable_modes = m->n_unstable,
        .undecided_modes = m->n_undecided,
        .massless_directions = v->l == NULL ? m->n_condensed : -1,
        .n_modes = v->shown,
        .with_damping = v->with_damping,
        .equilibrium = equilibrium_row_of(v),
    };
    const mt_warning_list *const list = &v->warning_list;
    out->warnings = mt_warning_pick(list, MT_LEVEL_WARNING, v->mem, &out->n_warnings);
    out->notes = mt_warning_pick(list, MT_LEVEL_NOTE, v->mem, &out->n_notes);
    out->modes = mt_arena_alloc(v->mem, (size_t)v->shown, sizeof *out->modes);
    for (int i = 0; i < v->shown && out->modes != NULL; i++) {
        out->modes[i] = mode_row_of(v, i, false);
    }
    if (v->with_damping) {
        out->damped = damped_rows_of(v->damped, v->few.error, v->count, v->mem, &out->n_damped);
    }
    if (v->a != NULL) {
        MT_TRY(mt_cli_redundant(v->a->lin, v->mem, &out->n_redundant, &out->redundant, err));
    } else if (n_redundant(v->l) == 0) { /* else there are some; which, is not looked for */
        out->redundant = mt_arena_alloc(v->mem, 1, sizeof *out->redundant);
    }
    return mt_arena_check(v->mem, err);
}

static mt_status write_modes_json(mt_json_writer *w, const view *v, mt_err *err)
{
    configuration_row row;
    MT_TRY(configuration_row_of(v, &row, err));
    mt_record_put_object(w, NULL, &configuration_record, &row, v->shapes.n, v->shapes.name);
    return MT_OK;
}

/* A table of CSV: each row behind its configuration, its shape behind it. */
static mt_table csv_table(const mode_shapes *shapes)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_record_columns(&t, &mode_rows, MT_IN_CSV);
    for (int k = 0; k < shapes->n; k++) {
        mt_table_column(&t, shapes->name[k], shapes->head[k], MT_ALIGN_POINT);
    }
    return t;
}

static void csv_rows(const view *v, mt_table *t)
{
    for (int i = 0; i < v->shown; i++) {
        const mode_row row = mode_row_of(v, i, false);
        mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
        mt_table_record_row(t, &mode_rows, MT_IN_CSV, &row);
        for (int k = 0; k < v->shapes.n; k++) {
            mt_table_number(t, shapes_shown(&v->shapes, k, i), HZ_DIGITS);
        }
    }
}

static void print_modes(const view *v, mt_text *out)
{
    const unsigned in = MT_IN_TEXT | (any_rough(v) ? (unsigned)IN_ROUGH : 0U);
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &mode_rows, in);
    for (int i = 0; i < v->shown; i++) {
        const mode_row row = mode_row_of(v, i, true);
        mt_table_record_row(&t, &mode_rows, in, &row);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Print shapes with rows of channels and columns of modes, as a mechanism has more sensors than
 * fit side by side. */
static void print_shapes(const view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, v->shapes.sensors ? "sensor" : "body", "channel", MT_ALIGN_LEFT);
    for (int i = 0; i < v->shown; i++) {
        char heading[40];
        const int index = index_of_mode(v->m, i);
        (void)mt_snprintf(heading, sizeof heading, index > 0 ? "mode %d" : "(%d)",
                          index > 0 ? index : i + 1);
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
    }
    for (int k = 0; k < v->shapes.n; k++) {
        mt_table_text(&t, v->shapes.name[k]);
        for (int i = 0; i < v->shown; i++) {
            mt_table_number(&t, shapes_shown(&v->shapes, k, i), 4);
        }
    }
    mt_text_add(out, "\n  Mass-normalised shapes (numbers in parentheses: modes without "
                     "an index, by position) [1/sqrt(kg) and rad/(m sqrt(kg))]\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Note where modes are left out that were not declined by an option. */
static void write_others(const view *v, mt_text *out)
{
    const int all = mt_modal_vibrations(v->m);
    if (!v->asked && all > v->count) {
        mt_text_addf(out, "  The lowest %d of %s%d vibration modes; --count N or all: more.\n",
                     v->count, v->l == NULL ? "" : "at most ", all);
    }
}

static void write_solution_notes(const view *v, mt_text *out)
{
    const mt_modes *const m = v->m;
    const mt_state *const at = position_of(v);
    if (v->l != NULL) {
        const bool tree = v->l->way == MT_LOWEST_TREE;
        mt_text_addf(out,
                     "  The lowest modes of %s of %d bodies (%s): %d below %.6g Hz, by count, "
                     "none missing.\n",
                     tree ? "a tree" : "a mechanism", v->l->sys->n_bodies,
                     tree ? "joint coordinates" : "sparse factor", v->l->found.below,
                     complete_below_hz(v->l));
        if (n_redundant(v->l) > 0) {
            mt_text_addf(out, "  Of the joints' %d equations %d follow from others.\n",
                         v->l->equations, n_redundant(v->l));
        }
    }
    if (at != NULL && at->equilibrium.active) {
        if (at->equilibrium.residual > MOST_LEFT) {
            mt_text_addf(out, "  Equilibrium found in %d iterations, to rounding.\n",
                         at->iterations);
        } else {
            mt_text_addf(out, "  Equilibrium found in %d iterations, residual %.1e.\n",
                         at->iterations, at->equilibrium.residual);
        }
    }
    if (m->n_condensed > 0) {
        mt_text_addf(out, "  %d direction%s without mass follow%s statically.\n",
                     m->n_condensed, m->n_condensed == 1 ? "" : "s",
                     m->n_condensed == 1 ? "s" : "");
    }
    for (int i = 0; i < v->shown; i++) {
        int size = 1;
        const int first = mt_modal_cluster(m, i, &size);
        if (size > 1 && first == i && m->kind[i] == MT_MODE_FLEXIBLE) {
            const int index = index_of_mode(m, i);
            mt_text_addf(out,
                         "  Modes %d to %d are repeated: only the space that their shapes span "
                         "is determined.\n",
                         index, index + size - 1);
        }
    }
}

/* What the damped modes of a large mechanism were found from. */
static void write_few_damped(const mt_lowest_damped *few, mt_text *out)
{
    const mt_damped_modes *const d = &few->modes;
    double most = 0.0;
    for (int i = 0; i < d->count; i++) {
        most = fmax(most, few->error[i]);
    }
    mt_text_addf(out,
                 "  The damped modes into which the lowest undamped ones turn, by these and %d "
                 "shape%s that damping adds; errors below %.0e of a root.%s\n",
                 few->shapes, few->shapes == 1 ? "" : "s",
                 pow(10.0, ceil(log10(fmax(most, DBL_EPSILON)))),
                 " Real roots above the last one are not sought (--count all: all roots).");
}

static void text_view(const view *v, mt_text *out)
{
    mt_text_addf(out, "%s\n", mt_loaded_model_configuration(v->s, v->c));
    mt_cli_print_warnings(&v->warning_list, out);
    print_modes(v, out);
    write_solution_notes(v, out);
    if (v->shapes.n > 0) {
        print_shapes(v, out);
    }
    if (v->with_damping) {
        damped_print(v->damped, v->count, out);
    }
    if (v->with_damping && v->l != NULL) {
        write_few_damped(&v->few, out);
    }
    write_others(v, out);
    mt_text_add(out, "\n");
}

typedef struct sink {
    const mt_args *args;
    mt_text *out;
    mt_json_writer *w;
    mt_table table; /* CSV */
    int channels;   /* in its columns */
    mt_run run;     /* of all configurations */
} sink;

static mt_status csv_view(sink *to, const view *v)
{
    if (v->with_damping) { /* a table of its own kind: the damped modes alone */
        if (to->table.n_columns == 0 && !to->table.failed) {
            to->table = mt_table_default();
            mt_table_column(&to->table, "configuration", "configuration", MT_ALIGN_LEFT);
            mt_table_record_columns(&to->table, &damped_rows, MT_IN_CSV);
        }
        damped_csv(v->damped, v->count, mt_loaded_model_configuration(v->s, v->c), &to->table);
        return MT_OK;
    }
    if (to->table.n_columns == 0 && !to->table.failed) {
        to->table = csv_table(&v->shapes);
        to->channels = v->shapes.n;
    }
    if (to->table.failed) {
        return MT_OK; /* the output that the table goes into tells */
    }
    if (to->channels != v->shapes.n) {
        return MT_E_USAGE;
    }
    csv_rows(v, &to->table);
    return MT_OK;
}

/* Undamped modes that are sought beyond those asked for, where the damped ones are to be found
 * from them, by attempt: damping reorders roots, and takes some from those that oscillate. */
static const int DAMPED_BESIDES[] = {8, 60};

/* The lowest damped modes; *is false: they need all modes, for the reason in why. */
static mt_status solve_few_damped(view *v, mt_arena *mem, bool *is, char *why, mt_err *err)
{
    const mt_loaded_model *const s = v->s;
    for (int i = 0; i < MT_COUNT(DAMPED_BESIDES) && !(*is && v->few.enough); i++) {
        const mt_lowest_want want = {.count = v->count + DAMPED_BESIDES[i], .shapes = true};
        mt_lowest_delete(v->l);
        v->l = NULL;
        *is = false;
        MT_TRY(
            mt_loaded_model_lowest(s, v->c, s->n_inputs, s->inputs, s->at, want, &v->l, err));
        if (v->l == NULL) {
            return MT_OK;
        }
        const mt_status rc = mt_lowest_damped_modes(v->l, v->count, mem, &v->few, is, why, err);
        if (rc != MT_OK) {
            return mt_err_in(err, rc, "%s: configuration \"%s\"", s->path,
                             mt_loaded_model_configuration(s, v->c));
        }
    }
    v->damped = &v->few.modes;
    return MT_OK;
}

/* Find the lowest modes only, where these are requested and there is a fast method. */
static mt_status solve_view_modes(const mt_args *args, view *v, mt_arena *mem, mt_err *err)
{
    const mt_loaded_model *const s = v->s;
    const mt_lowest_want want = {.count = v->count, .shapes = args->given[MT_OPT_SHAPES]};
    char why[MT_LOWEST_DAMPED_WHY] = "";
    bool is = true;
    MT_TRY(
        v->with_damping && v->count > 0
            ? solve_few_damped(v, mem, &is, why, err)
            : mt_loaded_model_lowest(s, v->c, s->n_inputs, s->inputs, s->at, want, &v->l, err));
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
    MT_TRY(mt_loaded_model_analyse(s, v->c, v->with_damping ? 0 : want.count, &v->a, err));
    v->m = &v->a->modes;
    return mt_warnings_of_analysis(v->a, s->n_inputs, s->inputs, s->at, &v->warning_list, err);
}

static mt_status show_configuration_modes(sink *to, const mt_loaded_model *s, int c,
                                          mt_err *err)
{
    const bool asked = to->args->given[MT_OPT_COUNT];
    view v = {.s = s,
              .c = c,
              .count = asked ? to->args->count : DEFAULT_MODES,
              .asked = asked,
              .with_damping = to->args->given[MT_OPT_DAMPED]};
    mt_arena mem = {.first = NULL};
    v.mem = &mem;
    mt_status rc = mt_arena_init(&mem, 0, err);
    v.warning_list = mt_warning_list_default(&mem);
    to->run.progress = mt_watch_begin(to->args, 0, "modes");
    rc = rc == MT_OK ? solve_view_modes(to->args, &v, &mem, err) : rc;
    to->run.progress = NULL;
    mt_watch_end(rc == MT_OK);
    if (rc != MT_OK || v.m == NULL) {
        goto done;
    }
    v.shown = modes_shown(v.m, v.count);
    if (to->args->given[MT_OPT_SHAPES]) {
        rc = v.l != NULL ? shapes_of_lowest(v.l, v.shown, &mem, &v.shapes, err)
                         : shapes_of(v.a, v.shown, &mem, &v.shapes, err);
    }
    if (rc == MT_OK && v.with_damping && v.l == NULL) {
        rc = mt_analysis_damped(v.a, &v.damped, err);
    }
    if (rc != MT_OK) {
        goto done;
    }
    switch (to->args->format) {
    case MT_FORMAT_JSON:
        rc = write_modes_json(to->w, &v, err);
        break;
    case MT_FORMAT_CSV:
        rc = csv_view(to, &v);
        if (rc != MT_OK) {
            (void)mt_fail(err, rc,
                          "configurations with different bodies do not fit into one CSV table: "
                          "choose one with -c");
        }
        break;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        text_view(&v, to->out);
        break;
    }
done:
    mt_lowest_delete(v.l);
    mt_analysis_delete(v.a);
    mt_arena_free(&mem);
    return rc;
}

/* Do each configuration; a failure of one does not hide the others. */
static int each(sink *to, const mt_loaded_model *s)
{
    int code = MT_EXIT_DONE;
    for (int i = 0; i < s->n_configurations; i++) {
        const int c = s->configurations[i];
        mt_err err = {.code = MT_OK};
        mt_loaded_model_warn_overridden(s, c);
        const mt_status rc = show_configuration_modes(to, s, c, &err);
        if (rc == MT_OK) {
            continue;
        }
        code = mt_exit_worse(code, mt_cli_failed(rc, &err));
        if (to->w != NULL) {
            mt_cli_json_failed(to->w, mt_loaded_model_configuration(s, c), &err);
        }
    }
    return code;
}

static int run_modes(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    mt_json_writer w = mt_json_writer_default(out);
    sink to = {.args = args, .out = out, .w = args->format == MT_FORMAT_JSON ? &w : NULL};
    mt_profile counts;
    mt_profile *const profile = mt_cli_profile(args, &counts);
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    to.run.profile = profile;
    s.run = &to.run;
    const bool list = to.w != NULL && !args->given[MT_OPT_CONFIGURATION];
    if (list) {
        mt_json_open(&w, NULL, '[');
    }
    code = each(&to, &s);
    if (list) {
        mt_json_close(&w);
    }
    if (to.w != NULL) {
        code = mt_exit_worse(code, mt_cli_json_done(&w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&to.table, out);
    }
    code = mt_exit_worse(code, mt_cli_profile_print(profile));
done:
    mt_table_free(&to.table);
    mt_loaded_model_free(&s);
    return code;
}

const mt_command mt_command_modes = {
    .name = "modes",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "natural frequencies and mode shapes",
    .details =
        "Prints the modes of each configuration: rigid-body, flexible, unstable and undecided "
        "ones (rounding hides whether such a mode is stable, and it has no index). Each has a "
        "bound of the error of its frequency (in JSON and CSV; in the table if it exceeds 1e-6 "
        "of the frequency) and its residual and orthogonality relative to rounding (about 1 is "
        "perfect). Redundant joints and the way to the equilibrium are listed. Shapes are "
        "mass-normalised. Names of modes are shown if --set changes nothing.",
    .answer = {&configuration_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_modes,
};
