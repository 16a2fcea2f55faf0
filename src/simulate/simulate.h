/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SIMULATE_SIMULATE_H
#define SIMULATE_SIMULATE_H

#include "mechanics/motion.h"
#include "simulate/reading.h"
#include "simulate/signal.h"

/*
 * Motion of a mechanism in time, at any amplitude: the equations of mechanics/motion.h, solved
 * for the accelerations (accelerate.h) and integrated (step.h).
 *
 * Positions are poses with local charts: a step begins at a pose g of each body with increments
 * u = 0 and follows R = exp(u^) R_g, u' = dexp_u^-1 omega (Munthe-Kaas). No angle is singular,
 * and whole turns are counted. After each step positions and velocities are projected onto the
 * joints by the least change; the drift is reported. The equations have no stabilising terms
 * (Baumgarte constants would add stiffness and damping).
 */
/* State at the beginning or at the end of a motion. */
typedef struct mt_sim_start {
    mt_placement at;
    double *v; /* [nq] */
} mt_sim_start;

typedef struct mt_sim_options {
    double duration_s;
    double sample_s; /* results at 0, sample_s, 2 sample_s, ... */
    /* largest error of a step relative to the motion so far: to the largest displacement and
     * the largest speed of bodies */
    double tolerance;
    double step_s;       /* above 0: steps of at most this length, without error control */
    bool integrates;     /* integrate linear equations, too */
    bool explicit_steps; /* explicit steps also where the springs make the motion stiff */
    int n_inputs;
    const mt_sim_input *inputs;
    int n_gauges;
    const mt_gauge *gauges;
    bool turning;      /* record the turning points of each gauge */
    mt_sim_start *end; /* [out] the end state; may be the start; NULL: not requested */
} mt_sim_options;
mt_sim_options mt_sim_options_default(void);
/* The largest number of samples times gauges; more are refused. */
enum { MT_SIM_SAMPLES_MOST = 20000000 };

typedef enum mt_sim_stop { MT_SIM_DONE, MT_SIM_INTERRUPTED } mt_sim_stop;

/* The method by which a motion was computed. */
typedef enum mt_sim_method {
    MT_SIM_INTEGRATED,
    MT_SIM_EXACT,  /* linear equations, inputs that are polynomials and sines, by pieces */
    MT_SIM_FITTED, /* linear equations, inputs as polynomials in each step */
    MT_SIM_METHODS
} mt_sim_method;
extern const char *const mt_sim_method_names[MT_SIM_METHODS];

/* The check of a motion that was not integrated against the full equations at some samples. */
typedef struct mt_sim_fit {
    int checks;
    double residual;    /* largest residual relative to its largest term */
    double input_error; /* largest error of a fitted input relative to its largest value */
} mt_sim_fit;

typedef struct mt_sim_result {
    mt_sim_stop stop;
    mt_sim_method method;
    mt_sim_fit fit;
    int n; /* number of samples */
    int n_gauges;
    double *t;     /* [n] */
    double *value; /* n_gauges x n [m, rad]: of a point or a joint from the rest position, else
                      the integral of its velocity; relative to the ground */
    double *speed; /* velocity, n_gauges x n, relative to the ground */
    double *acceleration;  /* n_gauges x n, absolute: includes that of the ground */
    double *kinetic;       /* [n] [J] */
    double *potential;     /* [n] from the rest position */
    double *work;          /* [n] [J] of inputs, less that absorbed by dampers */
    mt_turnings *turnings; /* [n_gauges], where requested */
    long steps;
    long stiff_steps; /* of these, with the fast vibrations of springs solved exactly */
    long rejected;
    long evaluations;
    double gap_m;          /* largest drift off a joint in one step, before projection */
    double left_m;         /* largest gap after projection */
    double energy_error_j; /* largest |kinetic + potential - work - initial energy| */
    double energy_scale_j; /* largest kinetic energy or change of potential energy */
} mt_sim_result;

/**
 * @param lin    after an update; its position is the rest position
 * @param start  at a position where the joints are closed, with velocities that they allow
 * @param mem holds the result; scratch, too
 * Where equations are linear at any amplitude (propagate.h), the motion is propagated without
 * integration, unless step_s or an option requires it. An interrupt of the model (or the end of
 * its time) ends the motion early with MT_SIM_INTERRUPTED. Fails: MT_E_USAGE (times, too many
 * samples), MT_E_SINGULAR (a force along a direction without mass), MT_E_DEAD_CENTRE (joints
 * begin to depend on each other), MT_E_NO_CONVERGENCE (steps become too small), MT_E_DOMAIN,
 * MT_E_MEMORY; the text gives the time.
 */
mt_status mt_simulate(mt_linear *lin, const mt_sim_start *start, const mt_sim_options *opt,
                      mt_arena *mem, mt_sim_result *out, mt_err *err);

#endif
