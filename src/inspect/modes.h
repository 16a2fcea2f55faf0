/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_MODES_H
#define INSPECT_MODES_H

#include "analysis/lowest_damped.h"
#include "base/diagnostics.h"
#include "inspect/energies.h"
#include "inspect/loaded_model.h"
#include "io/write_json.h"
#include "mechanics/base_motion.h"
#include "mechanics/linear.h"

/* Natural frequencies and shapes of one configuration, with or without damping: what `modes`
 * tells, as records. */

/* Without a number: more modes than this are rarely read, and of large mechanisms the lowest
 * are found in a small part of the time. */
enum { MT_MODES_DEFAULT = 20 };

typedef struct mt_modes_question {
    int count;   /* of vibration modes to tell; 0 or INT_MAX: all */
    bool shapes; /* at the sensors, or without sensors motions of the bodies */
    bool damped; /* the modes with damping, too */
    bool effective_mass;
    double about_m[3];             /* that rotations of the ground are about */
    bool energy;                   /* who has their energy, too */
    mt_energies_question energies; /* about what */
} mt_modes_question;

/* Shapes of modes at the sensors, or, without sensors, as motions of the bodies. */
typedef struct mt_mode_shapes {
    bool sensors;
    int n;             /* channels; 0: none */
    const char **name; /* [n] "c1.y", "crank.rz" */
    const char **head; /* [n] the name in CSV, with its unit */
    bool *turns;       /* [n] it is an angle */
    double *value;     /* n x modes, mass-normalised */
    double length_m;   /* length at which an angle is compared with a displacement */
    double *largest;   /* [modes] largest displacement of a body or at a sensor */
} mt_mode_shapes;

/* What modes have of a ground that moves along or about one axis. */
typedef struct mt_effective_row {
    const char *direction; /* "x", "rz" */
    const char *unit;      /* of masses: "kg", "kg m^2" */
    double total;
    double sum; /* of the modes that are told */
    double sum_percent;
    int n_modes;
    double *participation; /* [n_modes] */
    double *mass;          /* [n_modes] */
} mt_effective_row;

/* One configuration, solved. */
typedef struct mt_modes_view {
    const mt_loaded_model *s;
    int c;
    mt_modes_question question;
    mt_analysis *a;        /* by dense matrices; NULL: */
    mt_lowest *l;          /* of the lowest ones */
    const mt_modes *m;     /* of one of them */
    int shown;             /* positions of modes to write */
    mt_mode_shapes shapes; /* n 0: not asked for */
    int n_effective;       /* directions; 0: not asked for */
    mt_effective_row *effective;
    mt_energies energies; /* n 0: not asked for */
    const mt_damped_modes *damped;
    mt_lowest_damped few; /* of a large mechanism: `damped` is of these */
    mt_warning_list warning_list;
    mt_arena mem;
} mt_modes_view;

/* Solve configuration c. v zeroed before; mt_modes_view_free in any case. s must outlive v.
 * Fails as an analysis of the configuration; MT_E_USAGE where it is too large. */
mt_status mt_modes_view_take(const mt_loaded_model *s, int c, const mt_modes_question *question,
                             mt_modes_view *v, mt_err *err);
void mt_modes_view_free(mt_modes_view *v);

/* A mode. */
typedef struct mt_mode_row {
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
    bool with_energy;
    mt_energy_row energy;
} mt_mode_row;

extern const mt_record mt_mode_record;
/* for_people: its kind in words, and no error that is not large. */
mt_mode_row mt_mode_row_of(const mt_modes_view *v, int i, bool for_people);

/* A damped mode. */
typedef struct mt_damped_row {
    int index; /* 0: none */
    const char *kind;
    double natural_hz;
    double natural_error_hz; /* NaN: not bounded */
    double damped_hz;
    double ratio_percent;
    double decay_per_s;
    double residual;
} mt_damped_row;

extern const mt_record mt_damped_record;
/* for_people: its kind in words. */
mt_damped_row mt_damped_row_of(const mt_damped_modes *d, int i, bool for_people);
/* True where it is one of the first `count` (0: of all). */
bool mt_modes_has_damped(const mt_damped_modes *d, int i, int count);

/* The equilibrium at which the equations are linearised. */
typedef struct mt_equilibrium_row {
    bool solved;
    int iterations;
    double residual;
    double gap_m;
    double largest_motion_m;
    double largest_turn_rad;
} mt_equilibrium_row;

/* One configuration, answered. */
typedef struct mt_modes_row {
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
    mt_mode_row *modes;
    int n_modes;
    bool with_damping;
    mt_damped_row *damped;
    int n_damped;
    bool with_effective;
    mt_effective_row *effective;
    int n_effective;
    int n_about;
    double *about_m;
    mt_joints_row *redundant; /* NULL: not looked for */
    int n_redundant;
    mt_equilibrium_row equilibrium;
} mt_modes_row;

extern const mt_record mt_modes_record;
/* Write all of it as JSON. Fails: as mt_linear_redundant_set, MT_E_MEMORY. */
mt_status mt_modes_put(mt_modes_view *v, mt_json_writer *w, mt_err *err);

/* 1-based index of the vibration mode at position pos; 0 for rigid-body, unstable and undecided
 * modes, and for all modes where one is undecided. */
int mt_modes_index(const mt_modes *modes, int pos);
/* True where the error of this mode's frequency is large enough to be shown. */
bool mt_modes_is_rough(const mt_modes *m, int i);
/* A component of column i as shown in a table of a few digits: 0 where it is negligible
 * relative to the largest of its mode. */
double mt_modes_component(const mt_mode_shapes *shapes, int k, int i);
/* Below this frequency no mode of the lowest ones is missing. */
double mt_modes_complete_below_hz(const mt_lowest *l);
/* Equations of joints that follow from others; l may be NULL. */
int mt_modes_redundant(const mt_lowest *l);
/* The position of linearisation; NULL: the reference position. */
const mt_state *mt_modes_position(const mt_modes_view *v);

#endif
