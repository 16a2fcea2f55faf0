/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Length of steps. The pair's error e of a step is compared with
 *     tolerance * (how far bodies have come, how fast they have been so far),
 * each the largest over all bodies, rotations as arcs at the model's length: relative to the
 * motion, however small it is. With the largest ratio r, and r0 of the step before, the next
 * step is 0.9 h r^(-0.7/8) r0^(0.4/8): where the fastest vibration, not the error, limits the
 * step, a length that follows r alone swings about the limit (Gustafsson, ACM Trans. Math.
 * Softw. 17 (1991) 533-554). Collocation has 0.95 for 0.9 and its own order for 8; smooth
 * motions then keep r at a fifth of what is allowed. What
 * rounding of positions, eps of the model's length l, and of what it makes of forces may leave
 * is no error of the step: eps l, and eps l/h in velocities (stiffness at most about 1/h^2 of
 * the mass, or the method would not be stable).
 */
#include <math.h>
#include <string.h>

#include "base/run.h"
#include "simulate/propagate.h"
#include "simulate/step.h"

static const double SAFETY = 0.9;
static const double SAFETY_STIFF = 0.95;
/* The ratio of a step in which the collocation does not converge. */
static const double STALLED = 1e3;
static const double BY_ERROR = 0.7; /* over the order */
static const double BY_LAST_ERROR = 0.4;
/* A ratio below this is as good as this: the step grows as much as it may. */
static const double LEAST_RATIO = 1e-6;
/* and one of a step that was cut short, for a sample, says little about the next one. */
static const double LEAST_LAST = 0.05;
static const double LEAST_CHANGE = 0.2;
static const double MOST_CHANGE = 5.0;
/* A step that fails (nothing finite where it leads) is tried again as this part of it, so many
 * times in all. */
static const double AFTER_FAILURE = 0.25;
enum { FAILURES_MOST = 1000 };
/* No body turns further in one step [rad]: increments stay well within half a turn, and whole
 * turns are counted. */
static const double MOST_TURN = 1.0;
/* A step below this part of the duration leads nowhere. */
static const double LEAST_STEP = 1e-13;
/* Samples nearer to the end than this part of their distance are at the end. */
static const double SAME_TIME = 1e-6;
/* A number of steps is a whole one within this. */
static const double ROUNDED = 1e-9;
/* The first step, as a part of the time to the first sample. */
static const double FIRST_STEP = 1e-3;
static const double TOLERANCE = 1e-11;
/* Where a velocity is 0 is known to this part of the step. */
static const double TURN_FOUND = 1e-11;
enum { TURN_STEPS = 6 };

const char *const mt_sim_method_names[MT_SIM_METHODS] = {
    [MT_SIM_INTEGRATED] = "integrated", [MT_SIM_EXACT] = "exact", [MT_SIM_FITTED] = "fitted"};

mt_sim_options mt_sim_options_default(void)
{
    return (mt_sim_options){.tolerance = TOLERANCE};
}

/* Error of the step over what is allowed, the largest of all coordinates. */
static double error_ratio(const mt_sim *s, double h)
{
    double may[2];
    double most = s->stalls ? STALLED : 0.0;
    mt_sim_allowed(s, h, may);
    for (int i = 0; i < s->nq; i++) {
        most = fmax(most, s->weight[i] * fabs(s->error[i]) / may[0]);
        most = fmax(most, s->weight[i] * fabs(s->error[s->nq + i]) / may[1]);
    }
    return most;
}

/* The longest step in which no body turns by more than MOST_TURN or moves by more than the free
 * distance, unless joints change too little for that to matter. */
static double longest_step(const mt_sim *s)
{
    const double *const v = s->begin + s->nq;
    double fastest = 0.0;
    for (int b = 0; b < s->sys->n_bodies; b++) {
        double square = 0.0;
        for (int k = 3; k < 6; k++) {
            const int dof = s->sys->bodies[b].dof[k];
            square += dof >= 0 ? v[dof] * v[dof] : 0.0;
        }
        fastest = fmax(fastest, sqrt(square));
    }
    double rate = 0.0; /* at which the free way is used up */
    for (int i = 0; i < s->nq; i++) {
        rate = fmax(rate, s->weight[i] * fabs(v[i]) / s->sys->length_m);
    }
    const double limit = rate > 0.0 ? fmax(s->free_way / rate, s->free_time) : HUGE_VAL;
    return fmin(limit, fastest > 0.0 ? MOST_TURN / fastest : HUGE_VAL);
}

/* A run: what is kept of it. */
typedef struct run {
    mt_sim s;
    mt_sim_result *out;
    int room;       /* samples */
    double energy0; /* at the start */
    double potential0;
    double rest_energy;
    int failures;      /* steps that led to nothing finite */
    double last_ratio; /* of the last step that was taken */
} run;

static mt_status reserve(run *r, const mt_sim_options *opt, mt_arena *mem, mt_err *err)
{
    mt_sim_result *const out = r->out;
    const bool given = opt->duration_s > 0.0 && opt->sample_s > 0.0;
    const double samples = given ? floor(opt->duration_s / opt->sample_s) + 2.0 : HUGE_VAL;
    if (!isfinite(samples)) {
        return mt_fail(err, MT_E_USAGE, "a duration and a sample time above 0 are needed");
    }
    if (!(samples * (opt->n_gauges + 1) <= MT_SIM_SAMPLES_MOST)) {
        return mt_fail(err, MT_E_USAGE, "%.3g samples of %d channels are too many", samples,
                       opt->n_gauges);
    }
    r->room = (int)samples;
    const size_t room = (size_t)r->room;
    const size_t gauges = (size_t)opt->n_gauges;
    out->n_gauges = opt->n_gauges;
    out->t = mt_arena_f64(mem, room, 1);
    out->kinetic = mt_arena_f64(mem, room, 1);
    out->potential = mt_arena_f64(mem, room, 1);
    out->work = mt_arena_f64(mem, room, 1);
    out->value = mt_arena_f64(mem, gauges, room);
    out->speed = mt_arena_f64(mem, gauges, room);
    out->acceleration = mt_arena_f64(mem, gauges, room);
    out->turnings = mt_arena_alloc(mem, gauges, sizeof *out->turnings);
    return mt_arena_check(mem, err);
}

/* Set the reference values: potential energy and, for integrals of velocities, the displacement
 * from the rest position to the start (a rotation: the shortest one). */
static mt_status measure_rest(run *r, mt_err *err)
{
    mt_sim *const s = &r->s;
    const mt_placement *const rest = &mt_linear_position(s->lin)->at;
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    double *const still = mt_arena_f64(s->mem, (size_t)s->nq, 1);
    double *const way = mt_arena_f64(s->mem, (size_t)s->nq, 1);
    MT_TRY(mt_arena_check(s->mem, err));
    mt_poses_increment(s->sys, rest->pose, s->start.pose, way);
    mt_motion_eval(&s->motion, rest, still);
    r->rest_energy = s->motion.potential;
    for (int g = 0; g < s->opt->n_gauges; g++) {
        if (!mt_motion_has_value(s->sys, s->opt->gauges[g])) {
            mt_motion_gauge(&s->motion, rest, still, s->opt->gauges[g], &s->gauge);
            s->begin[((ptrdiff_t)2 * s->nq) + 1 + g] = mt_dot(s->nq, s->gauge.row, way);
        }
    }
    mt_arena_rewind(s->mem, mark);
    return MT_OK;
}

static void note_energy(run *r)
{
    const mt_motion *const o = &r->s.motion;
    const double work = r->s.begin[(ptrdiff_t)2 * r->s.nq];
    const double left = (o->kinetic + o->potential) - (r->energy0 + work);
    r->out->energy_error_j = fmax(r->out->energy_error_j, fabs(left));
    r->out->energy_scale_j = fmax(r->out->energy_scale_j, o->kinetic);
    r->out->energy_scale_j = fmax(r->out->energy_scale_j, fabs(o->potential - r->potential0));
}

/* Store a sample at the beginning of a step, at t. */
static mt_status store_gauge_sample(run *r, double t, mt_err *err)
{
    mt_sim_result *const out = r->out;
    const ptrdiff_t i = out->n;
    for (int g = 0; g < out->n_gauges; g++) {
        const ptrdiff_t at = g + (i * out->n_gauges);
        double read[3];
        MT_TRY(mt_sim_gauge(&r->s, t, g, read, err));
        out->value[at] = read[0];
        out->speed[at] = read[1];
        out->acceleration[at] = read[2];
    }
    out->t[i] = t;
    out->kinetic[i] = r->s.motion.kinetic;
    out->potential[i] = r->s.motion.potential - r->rest_energy;
    out->work[i] = r->s.begin[(ptrdiff_t)2 * r->s.nq];
    out->n++;
    return MT_OK;
}

/* True where a gauge that ends a step with this velocity turns within it. Changes within
 * rounding of the motion of the bodies do not count. */
static bool turns(const mt_sim *s, int g, double end)
{
    const double least = s->opt->tolerance * s->fast;
    return s->speed[g] * end < 0.0 && fmax(fabs(s->speed[g]), fabs(end)) > least;
}

/* Where the gauge's velocity changes its sign in the step from t to t + h: by Newton on the
 * velocity at the ends of shorter steps, from the root of the chord. work[3 n_gauges]. */
static mt_status find_turning(run *r, double t, double h, int g, const double end[3],
                              double *work, mt_err *err)
{
    mt_sim *const s = &r->s;
    const double v0 = s->speed[g];
    double next = h * v0 / (v0 - end[1]);
    double x = h;
    double *const read = work + ((ptrdiff_t)3 * g);
    memcpy(read, end, 3 * sizeof *read);
    for (int i = 0; i < TURN_STEPS && fabs(next - x) > TURN_FOUND * h; i++) {
        x = next;
        MT_TRY(mt_sim_advance(s, t, x, err));
        MT_TRY(mt_sim_ahead(s, t + x, work, err));
        next = fmin(fmax(x - (read[1] / read[2]), TURN_FOUND * h), h);
    }
    mt_turnings *const list = &r->out->turnings[g];
    list->at = mt_arena_grow(s->mem, list->at, list->n, &list->room, sizeof *list->at);
    MT_TRY(mt_arena_check(s->mem, err));
    list->at[list->n++] = (mt_turning){.t = t + x, .value = read[0], .highest = v0 > 0.0};
    return MT_OK;
}

/* Turnings of all gauges in the step from t to t + h, after which s->y is that of the whole
 * step again. */
static mt_status note_turnings(run *r, double t, double h, mt_err *err)
{
    mt_sim *const s = &r->s;
    const mt_arena_mark mark = mt_arena_get_mark(s->mem);
    double *const whole = mt_arena_f64(s->mem, (size_t)s->n, 1);
    double *const ends = mt_arena_f64(s->mem, 3, (size_t)s->opt->n_gauges);
    double *const work = mt_arena_f64(s->mem, 3, (size_t)s->opt->n_gauges);
    MT_TRY(mt_arena_check(s->mem, err));
    memcpy(whole, s->y, (size_t)s->n * sizeof *whole);
    MT_TRY(mt_sim_ahead(s, t + h, ends, err));
    bool any = false;
    for (int g = 0; g < s->opt->n_gauges; g++) {
        any = any || turns(s, g, ends[(3 * g) + 1]);
    }
    for (int g = 0; g < s->opt->n_gauges && any; g++) {
        const double *const end = ends + ((ptrdiff_t)3 * g);
        if (turns(s, g, end[1])) {
            MT_TRY(find_turning(r, t, h, g, end, work, err));
        }
    }
    memcpy(s->y, whole, (size_t)s->n * sizeof *whole);
    if (!any) {
        mt_arena_rewind(s->mem, mark); /* nothing was kept behind it */
    }
    return MT_OK;
}

static void note_speeds(mt_sim *s)
{
    const double *const v = s->begin + s->nq;
    for (int g = 0; g < s->opt->n_gauges && s->opt->turning; g++) {
        mt_motion_gauge(&s->motion, &s->at, v, s->opt->gauges[g], &s->gauge);
        s->speed[g] = mt_dot(s->nq, s->gauge.row, v);
    }
}

/* Factor from this step to the next one. */
static double change_of(const run *r, double ratio, bool taken)
{
    const bool stiff = r->s.collocation != NULL;
    const double order = stiff ? MT_FILON_DEGREE + 1.0 : MT_ODE_ORDER;
    const double by_last = taken ? pow(r->last_ratio, BY_LAST_ERROR / order) : 1.0;
    const double by_this = pow(ratio, -(taken ? BY_ERROR : 1.0) / order);
    const double change = (stiff ? SAFETY_STIFF : SAFETY) * by_this * by_last;
    return fmin(fmax(change, LEAST_CHANGE), MOST_CHANGE);
}

/* Accept the step from *t in s->y; h becomes the first length of the next step. */
static mt_status accept_step(run *r, double *t, double until, double length, double ratio,
                             double *h, mt_err *err)
{
    mt_sim *const s = &r->s;
    const double next = length * change_of(r, ratio, true);
    const bool last = length >= until - *t;
    /* a step that was cut short says nothing against the longer one before */
    *h = last && length < *h ? fmax(next, *h) : next;
    r->last_ratio = fmax(ratio, LEAST_LAST);
    if (s->opt->turning) {
        MT_TRY(note_turnings(r, *t, length, err));
    }
    *t = last ? until : *t + length;
    r->out->steps++;
    return mt_sim_accept(s, *t, err);
}

/* Handle a failed step: shorten it, unless that cannot help. */
static mt_status after_failure(run *r, mt_status rc, const mt_err *failed, mt_err *err)
{
    r->out->rejected++;
    return rc != MT_E_DOMAIN || ++r->failures > FAILURES_MOST
               ? mt_fail(err, rc, "%s", failed->text)
               : MT_OK;
}

/* Make one step towards `until` of about *h; *h becomes the length of the next one. */
static mt_status step_towards(run *r, double *t, double until, double *h, mt_err *err)
{
    mt_sim *const s = &r->s;
    const bool fixed = s->opt->step_s > 0.0;
    mt_err failed = {.code = MT_OK};
    for (;;) {
        const double left = until - *t;
        const double most = fmin(fixed ? s->opt->step_s : *h, longest_step(s));
        const double length = left / fmax(1.0, ceil((left / most) - ROUNDED));
        if (!(length > LEAST_STEP * s->opt->duration_s)) {
            return failed.code != MT_OK
                       ? mt_fail(err, failed.code, "%s", failed.text)
                       : mt_fail(err, MT_E_NO_CONVERGENCE, "steps become too small");
        }
        failed.code = MT_OK;
        const mt_status rc = mt_sim_advance(s, *t, length, &failed);
        if (rc != MT_OK) {
            MT_TRY(after_failure(r, rc, &failed, err));
            *h = AFTER_FAILURE * length;
            continue;
        }
        const double ratio = fmax(error_ratio(s, length), LEAST_RATIO);
        if (ratio <= 1.0 || fixed) {
            return accept_step(r, t, until, length, ratio, h, err);
        }
        *h = length * change_of(r, ratio, false);
        r->out->rejected++;
    }
}

static mt_status simulate_to_end(run *r, double *t, mt_err *err)
{
    const mt_sim_options *const opt = r->s.opt;
    double h = FIRST_STEP * fmin(opt->sample_s, opt->duration_s);
    MT_TRY(store_gauge_sample(r, 0.0, err));
    while (r->out->n < r->room && *t < opt->duration_s) {
        const double next = r->out->n * opt->sample_s;
        const double until =
            next < opt->duration_s - (SAME_TIME * opt->sample_s) ? next : opt->duration_s;
        while (*t < until) {
            if (mt_interrupted(r->s.sys->run->interrupt)) {
                r->out->stop = MT_SIM_INTERRUPTED;
                return MT_OK;
            }
            MT_TRY(step_towards(r, t, until, &h, err));
            note_energy(r);
            note_speeds(&r->s);
        }
        MT_TRY(store_gauge_sample(r, *t, err));
    }
    return MT_OK;
}

/* Refuse damping that has no force in time: that defined only for small motions about a rest
 * position, or for steady vibrations. */
static mt_status only_dampers(const mt_system *sys, mt_err *err)
{
    const mt_damping_def *const d = &sys->damping;
    const char *what = NULL;
    for (int i = 0; i < sys->n_springs && what == NULL; i++) {
        what = sys->springs[i].loss != MT_NO_NODE ? "loss factors" : NULL;
    }
    if (d->mass != MT_NO_NODE || d->stiffness != MT_NO_NODE) {
        what = "proportional damping";
    } else if (d->modal) {
        what = "damping ratios of modes";
    }
    return what == NULL
               ? MT_OK
               : mt_fail(err, MT_E_INPUT,
                         "%s: defined for small vibrations, not as a force in a motion in "
                         "time; simulate a configuration without it (\"damping\": {})",
                         what);
}

static mt_status begin_run(run *r, mt_linear *lin, const mt_sim_start *start,
                           const mt_sim_options *opt, mt_arena *mem, mt_err *err)
{
    MT_TRY(mt_sim_init(&r->s, lin, start, opt, mem, err));
    MT_TRY(measure_rest(r, err));
    MT_TRY(mt_sim_slope(&r->s, 0.0, r->s.begin, r->s.slope, err));
    r->potential0 = r->s.motion.potential;
    r->energy0 = r->s.motion.kinetic + r->s.motion.potential;
    note_speeds(&r->s);
    note_energy(r);
    return opt->step_s > 0.0 || opt->explicit_steps ? MT_OK : mt_collocation_new(&r->s, err);
}

static mt_status integrate(run *r, mt_linear *lin, const mt_sim_start *start,
                           const mt_sim_options *opt, mt_arena *mem, mt_err *err)
{
    mt_sim_result *const out = r->out;
    double t = 0.0;
    mt_status rc = begin_run(r, lin, start, opt, mem, err);
    if (rc == MT_OK) {
        rc = simulate_to_end(r, &t, err);
    }
    if (rc == MT_OK && opt->end != NULL) {
        mt_placement_copy(r->s.sys, &r->s.base, &opt->end->at);
        memcpy(opt->end->v, r->s.begin + r->s.nq, (size_t)r->s.nq * sizeof *opt->end->v);
    }
    out->evaluations = r->s.evaluations;
    out->stiff_steps = r->s.stiff_steps;
    out->gap_m = r->s.gap_m;
    out->left_m = r->s.left_m;
    mt_sim_free(&r->s);
    return rc == MT_OK || mt_is_final(rc) ? rc : mt_err_in(err, rc, "after %.6g s", t);
}

/* Propagate without integration where equations and inputs allow it. Failures other than memory
 * are ignored: the integration meets them, too, with their time. */
static mt_status propagate(run *r, mt_linear *lin, const mt_sim_start *start,
                           const mt_sim_options *opt, mt_arena *mem, bool *done, mt_err *err)
{
    const mt_sim_result empty = *r->out;
    const mt_arena_mark mark = mt_arena_get_mark(mem);
    const mt_status rc = mt_propagate(lin, start, opt, r->room, mem, r->out, done, NULL);
    if (rc == MT_E_MEMORY) {
        return mt_fail_memory(err);
    }
    if (!*done) {
        *r->out = empty;
        memset(r->out->turnings, 0, (size_t)opt->n_gauges * sizeof *r->out->turnings);
        mt_arena_rewind(mem, mark);
    }
    return MT_OK;
}

mt_status mt_simulate(mt_linear *lin, const mt_sim_start *start, const mt_sim_options *opt,
                      mt_arena *mem, mt_sim_result *out, mt_err *err)
{
    run r = {.out = out, .last_ratio = 1.0};
    bool done = false;
    *out = (mt_sim_result){.stop = MT_SIM_DONE};
    MT_TRY(only_dampers(mt_linear_system(lin), err));
    MT_TRY(reserve(&r, opt, mem, err));
    if (!opt->integrates && !(opt->step_s > 0.0)) {
        MT_TRY(propagate(&r, lin, start, opt, mem, &done, err));
    }
    return done ? MT_OK : integrate(&r, lin, start, opt, mem, err);
}
