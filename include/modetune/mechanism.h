/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * One configuration of a model, prepared once and evaluated at any number of values of its
 * parameters: frequencies with bounds of their errors, shapes at the sensors, correlation of
 * shapes, exact derivatives.
 *
 *     const char *const names[] = {"k_servo"};
 *     const double values[] = {450.0};
 *     if (mt_mechanism_new(model, "installed", 1, names, &mechanism, &err) == MT_OK &&
 *         mt_mechanism_evaluate(mechanism, values, &err) == MT_OK) {
 *         hz = mt_mechanism_hz(mechanism, 1);
 *     }
 *
 * All answers are those of the last evaluation and independent of earlier ones: the same values
 * give the same bits. After a failed evaluation there are no modes. A mechanism is used by one
 * thread at a time; any number of mechanisms may share a model. BLAS must use one thread.
 */
#ifndef MODETUNE_MECHANISM_H
#define MODETUNE_MECHANISM_H

#include "modetune/export.h"
#include "modetune/model.h"
#include "modetune/profile.h"
#include "modetune/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct mt_mechanism mt_mechanism;

/**
 * Prepare a configuration and evaluate it at the model's own values.
 * @param[in]  model          must outlive the mechanism
 * @param[in]  configuration name; NULL: the model's only one
 * @param[in]  inputs [n_inputs] names of the parameters whose values evaluations set. Other
 *   parameters keep the model's values; expressions follow, unless they are inputs themselves.
 *   A value fixed by the configuration takes precedence. NULL with n_inputs 0
 * @param[out] out owned by the caller; NULL on failure
 * Fails: MT_E_USAGE (no such configuration, none named of several, no such parameter, one given
 * twice, a name missing), and as mt_mechanism_evaluate.
 */
MT_API mt_status mt_mechanism_new(const mt_model *model, const char *configuration,
                                  int n_inputs, const char *const *inputs, mt_mechanism **out,
                                  mt_err *err);
/* Accepts NULL. */
MT_API void mt_mechanism_delete(mt_mechanism *mechanism);
/**
 * Undamped natural modes, linearised at the equilibrium.
 * @param[in]  values  [n_inputs] in the units of the parameters, finite; NULL without inputs
 * O(n^3) in the number of freedoms; no heap after the first evaluations of one size. Fails:
 * MT_E_USAGE (a value is not finite, or makes a number of the model invalid, as a mass below
 * 0), MT_E_ASSEMBLY, MT_E_EQUILIBRIUM, MT_E_DEAD_CENTRE, MT_E_MASSLESS, MT_E_DOMAIN,
 * MT_E_NO_CONVERGENCE, MT_E_MEMORY; err names the joint, number or body.
 */
MT_API mt_status mt_mechanism_evaluate(mt_mechanism *mechanism, const double *values,
                                       mt_err *err);

/* Value of a parameter at the last evaluation, in its unit; NaN where none has this name. */
MT_API double mt_mechanism_value(const mt_mechanism *mechanism, const char *parameter);

/*
 * Numbers of modes by kind. Vibration modes have an index, from 1, by ascending frequency.
 * Where one mode is unstable or undecided, no mode has an index, and functions that take one
 * answer as for no such mode. Undecided: springs deform in the mode, but the sign of its
 * stiffness is within rounding, as at a buckling load.
 */
MT_API int mt_mechanism_vibration_modes(const mt_mechanism *mechanism);
MT_API int mt_mechanism_rigid_body_modes(const mt_mechanism *mechanism);
MT_API int mt_mechanism_unstable_modes(const mt_mechanism *mechanism);
MT_API int mt_mechanism_undecided_modes(const mt_mechanism *mechanism);
/* Frequency of vibration mode `mode`, and a bound of its rounding error [Hz]; NaN where there
 * is no such mode. */
MT_API double mt_mechanism_hz(const mt_mechanism *mechanism, int mode);
MT_API double mt_mechanism_error_hz(const mt_mechanism *mechanism, int mode);
/* Number of modes of the same frequency, 1 for a simple one; 0 where there is no such mode. */
MT_API int mt_mechanism_multiplicity(const mt_mechanism *mechanism, int mode);

/* Channels, the directions of all sensors of the configuration: their number, and the name of
 * each from 0, "sensor.direction" (NULL beyond the last; lives as long as the mechanism). */
MT_API int mt_mechanism_channels(const mt_mechanism *mechanism);
MT_API const char *mt_mechanism_channel(const mt_mechanism *mechanism, int channel);
/**
 * Shape of a vibration mode at the channels.
 * @param[out] shape [channels] mass-normalised: a length [m/sqrt(kg)] or an angle
 *   [rad/sqrt(kg)]; its sign is arbitrary, but the same for the same values. NULL without
 *   channels
 * Fails: MT_E_USAGE (no such mode), MT_E_MEMORY.
 */
MT_API mt_status mt_mechanism_shape(mt_mechanism *mechanism, int mode, double *shape,
                                    mt_err *err);
/**
 * Modal assurance criterion of the shapes of two mechanisms, which may be of different models,
 * at the channels whose names both have:
 *     mac_ij = (a_i . b_j)^2 / ((a_i . a_i)(b_j . b_j)), in [0, 1].
 * Where channels mix displacements and rotations, a rotation counts as its arc at the length of
 * a's model.
 * @param[in]  modes_a, modes_b numbers of vibration modes, from the first
 * @param[out] mac modes_a x modes_b, column-major; NaN where a shape is 0 at all channels
 * a and b may be the same. Source: Ewins, Modal Testing, 2000, section 5. Fails: MT_E_USAGE
 * (fewer modes, no channel in common), MT_E_MEMORY.
 */
MT_API mt_status mt_mechanism_mac(mt_mechanism *a, int modes_a, mt_mechanism *b, int modes_b,
                                  double *mac, mt_err *err);
/**
 * Exact derivatives of the first vibration modes with respect to all inputs.
 * @param[in]  modes number of modes
 * @param[out] hz_per_unit modes x n_inputs, column-major [Hz per unit of the input]. Repeated
 *   modes get the derivatives along the directions into which an input splits them, ascending.
 *   NaN where none exists: at 0 Hz, and where joints that are redundant at this value only
 *   block the motion, or separate, at any other. NULL without inputs
 * O(n^3 + n^2 modes n_inputs); the first call evaluates once more, later evaluations prepare
 * it. Fails: MT_E_USAGE (fewer modes), and as mt_mechanism_evaluate.
 */
MT_API mt_status mt_mechanism_sensitivities(mt_mechanism *mechanism, int modes,
                                            double *hz_per_unit, mt_err *err);

/*
 * Ports: names of inputs and outputs of a vibration, as of `modetune response`:
 *   inputs   "grip.x", force (moment) along a direction of a sensor [N, N m]; "base.x",
 *            acceleration of the ground along an axis [m/s^2], "base.x:velocity",
 *            "base.x:displacement"
 *   outputs  "grip.x", displacement of a sensor in space [m, rad], "grip.x:velocity",
 *            "grip.x:acceleration", "grip.x:relative_displacement" (..._velocity, ...) against
 *            the ground; "spring.NAME", "damper.NAME", force or torque in it [N, N m], above 0
 *            where it pulls, of a bushing a component ("spring.NAME.x", "spring.NAME.rx": what
 *            stiffness times motion is); "joint.NAME.x", force of the joint's first body on its
 *            second [N]
 */
typedef struct mt_ports {
    int n_inputs;
    const char *const *inputs; /* [n_inputs] */
    int n_outputs;             /* 0: the displacements at all channels */
    const char *const *outputs;
} mt_ports;

/**
 * Frequency responses of the evaluated mechanism about its equilibrium, with its damping: to an
 * input Re(u e^{i w t}) the output is Re(H u e^{i w t}).
 * @param[in]  n      frequencies, hz[n] > 0
 * @param[out] re, im outputs x inputs x n, column-major, H [unit of the output per unit of the
 *   input]; NaN at the resonance of an undamped mode
 * @param[out] error the same shape: bound of |error of H| by rounding, to first order; may be
 *   NULL
 * By modal superposition of all modes, hence exact. O(n^3 + frequencies), allocates. Fails:
 * MT_E_USAGE (an unknown name, a frequency not above 0, no successful evaluation, the force of
 * a joint that is redundant with others), MT_E_EQUILIBRIUM (a mode is unstable, undecided or
 * negatively damped), MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
MT_API mt_status mt_mechanism_response(mt_mechanism *mechanism, const mt_ports *ports, int n,
                                       const double *hz, double *re, double *im, double *error,
                                       mt_err *err);
/**
 * Exact derivatives of the responses at one frequency with respect to all inputs of the
 * mechanism (parameters).
 * @param[out] re, im outputs x inputs x parameters, column-major [unit of H per unit of the
 *   parameter]; NaN where none exists, as of mt_mechanism_sensitivities and
 *   mt_mechanism_response; NULL without parameters
 * Fails also: MT_E_USAGE (the force of a joint that loads stress).
 */
MT_API mt_status mt_mechanism_response_slopes(mt_mechanism *mechanism, const mt_ports *ports,
                                              double hz, double *re, double *im, mt_err *err);

/* The vibration of one output under a profile. */
typedef enum mt_vibration_end {
    MT_VIBRATION_FINITE,
    MT_VIBRATION_INFINITE, /* an undamped mode lies within the profile */
    MT_VIBRATION_UNSTABLE  /* a mode grows without excitation */
} mt_vibration_end;
typedef struct mt_vibration_answer {
    mt_vibration_end end; /* numbers without a finite value are NaN */
    double rms;           /* under the random parts together [unit of the output] */
    /* bound of |error of rms|, with the rounding of the poles to first order; an estimate where
     * not proven */
    double rms_error;
    double tones; /* the largest amplitudes under the tones, combined by the profile's rule */
    double peak;  /* the profile's sigma times rms, plus tones */
    int proven;   /* 1: bounds are proven; 0: by quadrature (see below) */
} mt_vibration_answer;

/**
 * The vibration of each output of the evaluated mechanism whose ground accelerates as a profile
 * says, about the equilibrium and with all damping.
 * @param[in]  ports  inputs: accelerations of the ground, each on its own; none: that along the
 *   profile's axis. Outputs as of mt_mechanism_response; none: the accelerations at all
 *   channels. NULL: none of either
 * @param[in]  room capacity of answers
 * @param[out] answers  outputs x inputs, column-major
 * By the sum over the poles of a response, in closed form or over panels as narrow as the
 * resonances; where there is no such sum (critical damping, a displacement without a restoring
 * spring) by quadrature, with estimated errors. Allocates. Fails: MT_E_USAGE (too little room,
 * a profile without an axis and no input, an input that is not an acceleration of the ground,
 * and as mt_mechanism_response), MT_E_EQUILIBRIUM, MT_E_NO_CONVERGENCE, MT_E_MEMORY.
 */
MT_API mt_status mt_mechanism_vibration(mt_mechanism *mechanism, const mt_ports *ports,
                                        const mt_vibration *vibration, int room,
                                        mt_vibration_answer *answers, mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
