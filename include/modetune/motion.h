/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Motions of a mechanism in time, at any amplitude: its equations of motion integrated from a
 * start at rest or with given rates, under forces, motions of the ground or a profile.
 */
#ifndef MODETUNE_MOTION_H
#define MODETUNE_MOTION_H

#include "modetune/export.h"
#include "modetune/mechanism.h"
#include "modetune/profile.h"
#include "modetune/status.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A joint (or a link's hinge) with its coordinate relative to the reference position [m, rad],
 * or its rate [m/s, rad/s]. */
typedef struct mt_motion_joint {
    const char *joint;
    double value;
} mt_motion_joint;

/* A sine amplitude sin(2 pi hz t + phase) at a port: a force (moment) along a direction of a
 * sensor, "grip.x" [N, N m], or the acceleration of the ground, "base.x" [m/s^2]
 * ("base.x:velocity", "base.x:displacement"). */
typedef struct mt_motion_sine {
    const char *port;
    double amplitude;
    double hz;
    double phase_rad;
} mt_motion_sine;

typedef struct mt_motion_options {
    size_t size;       /* sizeof(mt_motion_options) */
    double duration_s; /* above 0 */
    double sample_s;   /* above 0: values at 0, sample_s, ... and at the end */
    double tolerance;  /* largest error of a step relative to the motion so far; 0: 1e-11 */
    int n_starts;      /* joints moved before the start, the others follow with */
    int n_rates;       /* the least motion; joints with a rate, the others take */
    int n_sines;       /* the least kinetic energy; sines that excite */
    int seed;          /* seed of the profile's random parts, at least 0 */
    const mt_motion_joint *starts; /* [n_starts] */
    const mt_motion_joint *rates;  /* [n_rates] */
    const mt_motion_sine *sines;   /* [n_sines] */
    /* NULL, or the profile of the ground: one realisation of the random parts, tones sweeping
     * their ranges once */
    const mt_vibration *vibration;
    const char *along; /* "base.x"; NULL: the profile's axis */
} mt_motion_options;

/* Summary of a motion. */
typedef struct mt_motion_told {
    int samples;           /* number of values per output */
    double energy_scale_j; /* largest kinetic energy or change of potential energy */
    double energy_error_j; /* largest |kinetic + potential - work - initial energy| */
    double drift_m;        /* largest drift off a joint in one step, before projection */
    long steps;
} mt_motion_told;

/**
 * The motion from rest at the equilibrium, or from `starts` and `rates`.
 * @param[in]  outputs  [n_outputs] "grip.x", a sensor's displacement from the rest position,
 *   "grip.x:velocity" (both against the ground), "grip.x:acceleration" (in space), or a joint's
 *   coordinate ("pivot", "pivot:velocity", "pivot:acceleration")
 * @param[in]  room capacity of values; duration_s / sample_s + 2 per output are enough
 * @param[out] values  outputs x samples, column-major
 * @param[out] told    may be NULL
 * The mechanism is unchanged. The computing time grows with its highest frequency. Allocates.
 * Fails: MT_E_USAGE (a number or a name, too little room, too many samples, a profile without
 * an axis and no `along`), MT_E_INPUT (damping without a force in time, rates that the joints
 * cannot have at once), MT_E_ASSEMBLY (starts that are not reached), MT_E_SINGULAR (a force
 * along a direction without mass), MT_E_DEAD_CENTRE, MT_E_NO_CONVERGENCE, MT_E_DOMAIN,
 * MT_E_MEMORY (within GSL only in a program that has called gsl_set_error_handler_off: else GSL
 * ends the process).
 */
MT_API mt_status mt_mechanism_motion(mt_mechanism *mechanism, const mt_motion_options *options,
                                     int n_outputs, const char *const *outputs, int room,
                                     double *values, mt_motion_told *told, mt_err *err);

#ifdef __cplusplus
}
#endif

#endif
