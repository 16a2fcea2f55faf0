/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Questions about a model, answered as JSON: the bytes that the command of the same name prints
 * with --format json (and a line feed behind), whose members `modetune schema NAME` describes.
 *
 *     mt_modes_options opt = {.size = sizeof opt, .configuration = "installed", .shapes = 1};
 *     char *json;
 *     if (mt_model_modes(model, &opt, &json, &err) == MT_OK) {
 *         puts(json);
 *         mt_string_delete(json);
 *     }
 *
 * Of a configuration that is named the answer is an object, or the failure is the function's.
 * Of all of them it is a list, in which one that fails has its reason as "error"; the function
 * succeeds. Numbers are in SI units, which the members' names end in. Texts of options are
 * those of the command line, whose --NAME messages tell: "NAME=VALUE" of --set, where VALUE is
 * a number in the unit that the file gives the parameter's, or an expression of the file's
 * values ("1.1*k"), in SI. Everything may be NULL or 0, the default. A model may be asked by
 * several threads at once; BLAS must use one. Each call prepares its configurations anew: for
 * many values of parameters mt_mechanism_new is the shorter way.
 *
 * All fail: MT_E_USAGE (a name, a number, sets, a model too large for what is asked),
 * MT_E_INPUT (the sets make no mechanism), MT_E_DOMAIN, MT_E_MEMORY; and of a named
 * configuration MT_E_ASSEMBLY, MT_E_EQUILIBRIUM, MT_E_DEAD_CENTRE, MT_E_MASSLESS,
 * MT_E_NO_CONVERGENCE.
 */
#ifndef MODETUNE_ANSWERS_H
#define MODETUNE_ANSWERS_H

#include "modetune/export.h"
#include "modetune/model.h"
#include "modetune/profile.h"
#include "modetune/status.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mt_modes_options {
    size_t size;               /* sizeof(mt_modes_options) */
    const char *configuration; /* NULL: all */
    const char *const *sets;   /* [n_sets] "NAME=VALUE" */
    const double *about_m; /* [3] that rotations of the ground are about; NULL: the origin */
    const char
        *energy_about;       /* a point of the model that energies by direction are about; NULL:
                               * each body's centre */
    const char *energy_axes; /* "global", "principal", "torque_roll_x", ...; NULL: global */
    int n_sets;
    int count;          /* vibration modes, the lowest; 0: 20, INT_MAX: all */
    int shapes;         /* 1: with their shapes */
    int damped;         /* 1: and the modes with damping */
    int effective_mass; /* 1: and participation factors and effective masses */
    int energy;         /* 1: and who has the energy of each mode */
} mt_modes_options;

/**
 * Natural modes, as `modetune modes`.
 * @param[in]  options NULL: defaults
 * @param[out] json    to be given to mt_string_delete; NULL on failure
 * O(n^3) in the number of freedoms; the lowest modes of large mechanisms in O(n) or by a sparse
 * factor.
 */
MT_API mt_status mt_model_modes(const mt_model *model, const mt_modes_options *options,
                                char **json, mt_err *err);

typedef struct mt_mac_options {
    size_t size;                 /* sizeof(mt_mac_options) */
    const char *configuration_a; /* NULL: the model's only one */
    const char *configuration_b;
    const char *const *sets; /* [n_sets] "NAME=VALUE", of both */
    int n_sets;
    int count; /* vibration modes of each; 0: as many as channels are compared */
} mt_mac_options;

/**
 * Two sets of modes, paired and correlated at the sensors of both, as `modetune mac`: an
 * object. a and b may be the same. The parameters as of mt_model_modes. Fails also: MT_E_INPUT
 * (no sensor and direction in common).
 */
MT_API mt_status mt_model_mac(const mt_model *a, const mt_model *b,
                              const mt_mac_options *options, char **json, mt_err *err);

typedef struct mt_sensitivity_options {
    size_t size;               /* sizeof(mt_sensitivity_options) */
    const char *configuration; /* NULL: all */
    const char *const *sets;   /* [n_sets] "NAME=VALUE" */
    int n_sets;
    int count;              /* vibration modes, the lowest; 0: 6 */
    const char *parameters; /* "A,B"; NULL: all that do not follow others */
} mt_sensitivity_options;

/**
 * Exact derivatives of frequencies by parameters, as `modetune sensitivity`. The parameters as
 * of mt_model_modes. O(n^3), once more for each parameter that follows others. Fails also:
 * MT_E_INPUT (there are no parameters).
 */
MT_API mt_status mt_model_sensitivity(const mt_model *model,
                                      const mt_sensitivity_options *options, char **json,
                                      mt_err *err);

typedef struct mt_response_options {
    size_t size;               /* sizeof(mt_response_options) */
    const char *configuration; /* NULL: all */
    const char *const *sets;   /* [n_sets] "NAME=VALUE" */
    int n_sets;
    int n_inputs;
    const char *const *inputs;  /* [n_inputs] "grip.x", "base.x": what shakes */
    const char *const *outputs; /* [n_outputs] what is seen; none: all sensors */
    int n_outputs;
    int points;       /* of the grid, between which there are more where a curve bends; 0: 50 */
    const char *from; /* [Hz] a number or an expression; NULL: chosen by the modes */
    const char *to;
    int log;                /* 1: a logarithmic grid */
    int keep;               /* the lowest modes kept, others follow statically; 0: all */
    int direct;             /* 1: without modes, a factor at every frequency */
    int poles;              /* 1: with poles and residues */
    int state_space;        /* 1: with the matrices A, B, C, D between the ports */
    const char *parameters; /* "A,B" whose influence on the extremes is told; NULL */
    /* profile of the ground, without inputs along its axis; NULL */
    const mt_vibration *vibration;
} mt_response_options;

/**
 * Frequency responses, as `modetune response`. The parameters as of mt_model_modes. O(n^3 +
 * frequencies). Fails also: MT_E_USAGE (nothing shakes, a range that is none), MT_E_EQUILIBRIUM
 * (a mode is unstable, undecided or negatively damped).
 */
MT_API mt_status mt_model_response(const mt_model *model, const mt_response_options *options,
                                   char **json, mt_err *err);

typedef struct mt_sweep_options {
    size_t size;               /* sizeof(mt_sweep_options) */
    const char *configuration; /* NULL: all */
    const char *const *sets;   /* [n_sets] "NAME=VALUE" */
    const char *const *drives; /* [n_drives] "JOINT=FROM:TO:N", numbers in the model's unit or
                                * expressions */
    const char *const *holds;  /* [n_holds] springs that are trimmed to hold their joints, the
                                * others are locked: "SPRING", of one of several joints
                                * "JOINT=SPRING" */
    int n_sets;
    int n_drives; /* several joints go their ways together, in as many steps */
    int n_holds;
    int grid;        /* 1: each position of one joint with each of the others */
    int frequencies; /* 1: with natural frequencies */
    int count;       /* vibration modes, the lowest; 0: 6 */
} mt_sweep_options;

/**
 * Positions along the ranges of joints, as `modetune sweep`. The parameters as of
 * mt_model_modes. A position that is not reached has its reason as "error". O(N n^3).
 */
MT_API mt_status mt_model_sweep(const mt_model *model, const mt_sweep_options *options,
                                char **json, mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
