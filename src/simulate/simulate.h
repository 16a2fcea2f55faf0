/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_SIMULATE_H
#define SIMULATE_SIMULATE_H

#include "mechanics/motion.h"
#include "simulate/reading.h"
#include "simulate/signal.h"

/*
 * Motion of a mechanism in time, however large: the equations of mechanics/motion.h, solved for
 * the accelerations (accelerate.h) and integrated (ode.h).
 *
 * Positions are poses, charts are local: a step begins at a pose g of each body with increments
 * u = 0 and goes with R = exp(u^) R_g, u' = dexp_u^-1 omega (Munthe-Kaas), so no angle has a
 * place that it must not come to, and whole turns are counted. After each step positions are
 * brought back onto the joints and velocities along them, by the least change; what they had
 * drifted is told. Nothing is added to the equations for that (no Baumgarte constants, which
 * would be stiffness and damping of their own).
 */
typedef enum mt_sim_push {
    MT_SIM_FORCE, /* at a sensor's channel, along its global axis [N, N m] */
    MT_SIM_BASE,  /* acceleration of the ground along an axis [m/s^2] */
    MT_SIM_MOVE   /* the driven joint's coordinate, from where the drive holds it [rad, m] */
} mt_sim_push;

typedef struct mt_sim_input {
    mt_sim_push push;
    int at;    /* FORCE: channel; BASE: axis 0..2 */
    int slope; /* BASE: 0: the signal is the acceleration, 1: the velocity, 2: the place */
    const mt_signal *signal;
} mt_sim_input;

/* Where it begins, or has come to. */
typedef struct mt_sim_start {
    mt_placement at;
    double *v; /* [nq] */
} mt_sim_start;

typedef struct mt_sim_options {
    double duration_s;
    double sample_s; /* results at 0, sample_s, 2 sample_s, ... */
    /* largest error of a step, as a part of the motion so far: of how far bodies have come, and
     * of how fast they have been */
    double tolerance;
    double step_s;       /* above 0: steps of this length at most, whatever their error */
    bool integrates;     /* equations that are linear, too */
    bool explicit_steps; /* also where the springs make the motion stiff */
    int n_inputs;
    const mt_sim_input *inputs;
    int n_gauges;
    const mt_gauge *gauges;
    bool turning;      /* note where each gauge turns */
    mt_sim_start *end; /* out: where it comes to; may be the start. NULL: nobody asks */
} mt_sim_options;
mt_sim_options mt_sim_options_default(void);
/* More samples than this times gauges are refused. */
enum { MT_SIM_SAMPLES_MOST = 20000000 };

typedef enum mt_sim_stop { MT_SIM_DONE, MT_SIM_INTERRUPTED } mt_sim_stop;

/* How a motion was found. */
typedef enum mt_sim_method {
    MT_SIM_INTEGRATED,
    MT_SIM_EXACT,  /* linear equations, inputs that are polynomials and sines, by pieces */
    MT_SIM_FITTED, /* linear equations, inputs as polynomials in each step */
    MT_SIM_METHODS
} mt_sim_method;
const char *mt_sim_method_name(mt_sim_method method); /* "integrated", "exact", "fitted" */

/* Of a motion that was not integrated: how it fits the whole equations, at some samples. */
typedef struct mt_sim_fit {
    int checks;
    double residual;    /* largest residual, over the largest of its terms */
    double input_error; /* of an input that was fitted, over its largest value */
} mt_sim_fit;

typedef struct mt_sim_result {
    mt_sim_stop stop;
    mt_sim_method method;
    mt_sim_fit fit;
    int n; /* samples there are */
    int n_gauges;
    double *t;     /* [n] */
    double *value; /* n_gauges x n [m, rad]: of a point or a joint from the rest position, else
                      the integral of its velocity; relative to the ground */
    double *speed; /* likewise, relative to the ground */
    double *acceleration;  /* absolute: with that of the ground */
    double *kinetic;       /* [n] [J] */
    double *potential;     /* [n] from the rest position */
    double *work;          /* [n] done by inputs, less what dampers took */
    mt_turnings *turnings; /* [n_gauges], where asked for */
    long steps;
    long stiff_steps; /* of them: with the springs' fast vibrations solved exactly */
    long rejected;
    long evaluations;
    double gap_m;          /* largest drift off a joint in one step, before it was taken back */
    double left_m;         /* largest gap that was left after that */
    double energy_error_j; /* largest |kinetic + potential - work - that of the start| */
    double energy_scale_j; /* largest kinetic energy, or change of the potential one */
} mt_sim_result;

/**
 * @param lin    after an update; its position is the rest position
 * @param start  at a position where the joints are closed, with velocities that they allow
 * @param mem    holds the result; scratch, too
 * Where equations are linear at any amplitude (propagate.h) nothing is integrated, unless a
 * length of steps or the option says so. An interrupt of the model (or the end of its time)
 * ends it with what there is so far. Fails: MT_E_USAGE (times, too many samples), MT_E_SINGULAR
 * (a direction without mass is pushed), MT_E_DEAD_CENTRE (joints begin to depend on each
 * other), MT_E_NO_CONVERGENCE (steps become too small), MT_E_DOMAIN, MT_E_MEMORY; the text says
 * when.
 */
mt_status mt_simulate(mt_linear *lin, const mt_sim_start *start, const mt_sim_options *opt,
                      mt_arena *mem, mt_sim_result *out, mt_err *err);

#endif
