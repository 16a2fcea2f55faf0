/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A rod between ball joints may turn about the line through them, and nothing notices. Bodies
 * that are joined to each other otherwise than by ball joints are one part. With phi the
 * motions without strain, a part is such a rod where it hangs on others by two ball joints or
 * more and phi c is 0 outside of it for one c, in which all of its bodies turn alike:
 *     |phi c|^2 outside = c^T B c,   B summed over the rows outside: the vector of its least
 *                                    eigenvalue
 * What of the motions is orthogonal to all these is another matter: a joint may be missing.
 */
#include "answer/warnings.h"

#include <math.h>
#include <string.h>

#include "base/format.h"
#include "linalg/dense.h"
#include "mechanics/info.h"
#include "mechanics/linear.h"
#include "model/lint.h"
#include "model/values.h"

/* Free motions that indicate no missing joint: rods that spin between their ball joints, and
 * one other free motion. Fails: MT_E_MEMORY, MT_E_NO_CONVERGENCE. */
typedef struct warnings_rods {
    int n;
    const char *names; /* one body of each, quoted, separated by commas */
    double *other;     /* shape y of a free motion other than a spin; NULL: none */
} warnings_rods;

/* Of the largest entry of a motion: what is less is at rest, and turns that differ by less are
 * alike. Its square is far above the rounding of sums over some thousand rows. */
static const double AT_REST = 1e-5;
/* Spins of different rods move different bodies: of combinations only rounding is dependent. */
static const double DEPENDENT = 1e-6;

enum { DOFS = 6, TURNS = 3 };

typedef struct free_spins {
    const mt_system *sys;
    int n;          /* motions */
    double *phi;    /* nq x n, largest entry 1 */
    double *most;   /* [n] what it was before */
    double *all;    /* n x n: sum of all rows' products */
    double *beside; /* n x n: without those of a part; then its eigenvectors */
    double *value;  /* [n] */
    double *motion; /* [nq] */
    double *spin;   /* n x rods: in terms of the motions as they were given */
    int *part;      /* [bodies] the lowest body of the same part; MT_GROUND: of the ground's */
} free_spins;

static double entry(const free_spins *s, const double *q, int body, int k)
{
    const ptrdiff_t dof = s->sys->bodies[body].dof[k];
    return dof < 0 ? 0.0 : q[dof];
}

static void join_spin_parts(free_spins *s, int a, int b)
{
    const int one = a < 0 ? MT_GROUND : s->part[a];
    const int other = b < 0 ? MT_GROUND : s->part[b];
    const int least = one < other ? one : other;
    for (int i = 0; i < s->sys->n_bodies && one != other; i++) {
        if (s->part[i] == one || s->part[i] == other) {
            s->part[i] = least;
        }
    }
}

static void find_parts(free_spins *s)
{
    for (int b = 0; b < s->sys->n_bodies; b++) {
        s->part[b] = b;
    }
    for (int i = 0; i < s->sys->n_joints; i++) {
        const mt_system_joint *const joint = &s->sys->joints[i];
        if (joint->type != MT_JOINT_SPHERICAL && joint->type != MT_JOINT_DISTANCE) {
            join_spin_parts(s, joint->body[0], joint->body[1]);
        }
    }
    for (int i = 0; i < s->sys->n_measures; i++) {
        const mt_measure_def *const m = &s->sys->measures[i];
        if (m->kind == MT_MEASURE_BEAM) {
            join_spin_parts(s, m->body[0], m->body[1]);
        }
    }
}

static bool is_between_balls(const free_spins *s, int part)
{
    int balls = 0;
    for (int i = 0; i < s->sys->n_joints; i++) {
        const mt_system_joint *const joint = &s->sys->joints[i];
        const int one = joint->body[0] < 0 ? MT_GROUND : s->part[joint->body[0]];
        const int other = joint->body[1] < 0 ? MT_GROUND : s->part[joint->body[1]];
        balls += joint->type == MT_JOINT_SPHERICAL && (one == part) != (other == part) ? 1 : 0;
    }
    return balls >= 2;
}

/* sum += sign * (products of the rows of one body) */
static void add_rows(const free_spins *s, int body, double sign, double *sum)
{
    for (int k = 0; k < DOFS; k++) {
        for (int j = 0; j < s->n; j++) {
            const double own = entry(s, s->phi + ((ptrdiff_t)j * s->sys->nq), body, k);
            for (int i = 0; i < s->n && own != 0.0; i++) {
                sum[i + ((ptrdiff_t)j * s->n)] +=
                    sign * own * entry(s, s->phi + ((ptrdiff_t)i * s->sys->nq), body, k);
            }
        }
    }
}

static bool turns_as_one(const free_spins *s, int part)
{
    double turn = 0.0;
    double apart = 0.0;
    for (int b = 0; b < s->sys->n_bodies; b++) {
        for (int k = DOFS - TURNS; k < DOFS && s->part[b] == part; k++) {
            const double own = entry(s, s->motion, b, k);
            turn = fmax(turn, fabs(own));
            apart = fmax(apart, fabs(own - entry(s, s->motion, part, k)));
        }
    }
    return turn > 0.0 && apart <= AT_REST * turn;
}

/* *spin: there is one motion of this part alone, as of a rod; it is the next of s->spin. */
static mt_status look_at_part(free_spins *s, int part, int rods, bool *spin, mt_arena *mem,
                              mt_err *err)
{
    const int n = s->n;
    memcpy(s->beside, s->all, (size_t)n * (size_t)n * sizeof *s->beside);
    for (int b = 0; b < s->sys->n_bodies; b++) {
        if (s->part[b] == part) {
            add_rows(s, b, -1.0, s->beside);
        }
    }
    MT_TRY(mt_eig_sym(n, s->beside, s->value, true, mem, err));
    double moved = 0.0;
    for (int i = 0; i < s->sys->nq; i++) {
        s->motion[i] = 0.0;
        for (int j = 0; j < n; j++) {
            s->motion[i] += s->phi[i + ((ptrdiff_t)j * s->sys->nq)] * s->beside[j];
        }
        moved += s->motion[i] * s->motion[i];
    }
    const double rest = AT_REST * AT_REST;
    *spin = s->value[0] <= rest * moved && (n == 1 || s->value[1] > rest * moved) &&
            turns_as_one(s, part);
    for (int j = 0; j < n && *spin; j++) {
        s->spin[j + ((ptrdiff_t)rods * n)] = s->beside[j] / s->most[j];
    }
    return MT_OK;
}

static mt_status set_up(free_spins *s, const mt_analysis *a, mt_arena *mem, mt_err *err)
{
    const mt_modes *const modes = &a->modes;
    const size_t most = (size_t)modes->n_rigid;
    const ptrdiff_t nq = s->sys->nq;
    s->phi = mt_arena_f64(mem, (size_t)nq, most);
    s->most = mt_arena_f64(mem, most, 1);
    s->all = mt_arena_f64(mem, most, most);
    s->beside = mt_arena_f64(mem, most, most);
    s->spin = mt_arena_f64(mem, most, most);
    s->value = mt_arena_f64(mem, most, 1);
    s->motion = mt_arena_f64(mem, (size_t)nq, 1);
    s->part = mt_arena_int(mem, (size_t)s->sys->n_bodies);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < modes->shaped; i++) {
        if (modes->kind[i] == MT_MODE_RIGID_BODY) {
            double *const phi = s->phi + (s->n * nq);
            mt_linear_expand(a->lin, 1, mt_modal_shape(modes, i), phi);
            for (int j = 0; j < nq; j++) {
                s->most[s->n] = fmax(s->most[s->n], fabs(phi[j]));
            }
            for (int j = 0; j < nq; j++) {
                phi[j] /= s->most[s->n];
            }
            s->n++;
        }
    }
    for (int b = 0; b < s->sys->n_bodies; b++) {
        add_rows(s, b, 1.0, s->all);
    }
    find_parts(s);
    return MT_OK;
}

/* y of the first motion orthogonal to all spins, the columns of s->spin. Modes are orthonormal
 * in the mass metric, so orthogonality holds for their coefficients. */
static mt_status find_other(const free_spins *s, const mt_analysis *a, int rods, double *y,
                            mt_arena *mem, mt_err *err)
{
    const int n = s->n;
    mt_qr f;
    double *const q = mt_arena_f64(mem, (size_t)n, (size_t)n);
    MT_TRY(mt_arena_check(mem, err));
    MT_TRY(mt_qr_factor(n, rods, s->spin, n, DEPENDENT, mem, &f, err));
    MT_TRY(mt_qr_q(&f, rods, q, mem, err));
    memset(y, 0, (size_t)a->modes.n * sizeof *y);
    for (int i = 0, k = 0; i < a->modes.shaped; i++) {
        if (a->modes.kind[i] == MT_MODE_RIGID_BODY) {
            for (int j = 0; j < a->modes.n; j++) {
                y[j] += q[k] * mt_modal_shape(&a->modes, i)[j];
            }
            k++;
        }
    }
    return MT_OK;
}

static mt_status warnings_spins(const mt_analysis *a, mt_arena *mem, warnings_rods *out,
                                mt_err *err)
{
    free_spins s = {.sys = a->sys};
    *out = (warnings_rods){.names = ""};
    if (s.sys->dimension == 2 || a->modes.y == NULL || a->modes.n_rigid == 0) {
        return MT_OK;
    }
    MT_TRY(set_up(&s, a, mem, err));
    if (s.n < a->modes.n_rigid) {
        return MT_OK;
    }
    for (int b = 0; b < s.sys->n_bodies && out->n < s.n; b++) {
        bool spin = false;
        if (s.part[b] == b && is_between_balls(&s, b)) {
            MT_TRY(look_at_part(&s, b, out->n, &spin, mem, err));
        }
        if (spin) {
            out->names = mt_arena_printf(mem, "%s%s\"%s\"", out->names, out->n == 0 ? "" : ", ",
                                         s.sys->bodies[b].name);
            MT_TRY(mt_arena_check(mem, err));
            out->n++;
        }
    }
    if (out->n > 0 && out->n < s.n) {
        out->other = mt_arena_f64(mem, (size_t)a->modes.n, 1);
        MT_TRY(mt_arena_check(mem, err));
        MT_TRY(find_other(&s, a, out->n, out->other, mem, err));
    }
    return MT_OK;
}

/* What is odd about a model or a study, before it is solved. */

enum { NAME_SIZE = 400, NUMBER_SIZE = 32, NAMED = 3, STATES_2D = 3, STATES_3D = 6 };

/* kg: the largest ships have 7e8, a resonator some 1e-12; steel in t/mm^3 with metres makes
 * 1e-9 of a mass, millimetres with kg/m^3 1e9 of it. */
static const double MOST_MASS_KG = 1e10;
static const double LEAST_MASS_KG = 1e-18;
/* Hz of the lowest mode: a quartz crystal has 3e4, a resonator of 1e-12 kg 1e7; a period of a
 * week is no vibration of a mechanism. */
static const double MOST_LOWEST_HZ = 1e10;
static const double LEAST_LOWEST_HZ = 1e-6;

double mt_warnings_work(const mt_model *model, int configuration)
{
    /* measured, in units of a multiplication in a matrix product: eigenvalues, all that fills
     * matrices, building */
    static const double PER_CUBE = 0.5;
    static const double PER_SQUARE = 700.0;
    static const double PER_NUMBER = 3000.0;
    const double states = model->dimension == 2 ? STATES_2D : STATES_3D;
    const double bodies = mt_lowest_bodies(model, configuration);
    double joints = 0.0;
    for (int i = 0; i < model->n_joints; i++) {
        joints += mt_model_present(&model->joints[i].in, configuration) ? 1.0 : 0.0;
    }
    const double size = states * (bodies + joints);
    const double parts = (double)model->n_nums + model->n_springs + model->n_sensors;
    return (((PER_CUBE * size) + PER_SQUARE) * size * size) + (PER_NUMBER * parts);
}

void mt_warnings_left_out(int left, mt_warning_list *out)
{
    (void)mt_warning_add(
        out, MT_LEVEL_NOTE, "left_out",
        "%d configuration%s not checked for free motions and redundant joints: "
        "too large, or too many of them",
        left, left == 1 ? " is" : "s are");
}

static bool is_grounded(const mt_model *m, int c)
{
    for (int i = 0; i < m->n_joints; i++) {
        for (int side = 0; side < 2 && mt_model_present(&m->joints[i].in, c); side++) {
            const mt_attach *const a = &m->joints[i].bodies[side];
            if (a->name.s != NULL && a->kind == MT_ATTACH_GROUND) {
                return true;
            }
        }
    }
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        const bool there = mt_model_present(&s->in, c) && !s->damper;
        for (int side = 0; side < 2 && there; side++) {
            if (s->bodies[side].name.s != NULL && s->bodies[side].kind == MT_ATTACH_GROUND) {
                return true;
            }
        }
    }
    return false;
}

static const char MORE[] = ", ...";

/* The list "a", "b", "c", "d" is cut after the third name: a whole beam may turn. */
static void cut(char *text)
{
    int names = 0;
    for (char *s = strchr(text, ','); s != NULL; s = strchr(s + 1, ',')) {
        if (++names == NAMED) {
            memcpy(s, MORE, sizeof MORE); /* fits: one more quoted name stood there */
            return;
        }
    }
}

/* The first mode of a kind, in words: "rod" (rotation). */
static void name_motion(const mt_analysis *a, mt_mode_kind kind, char *text)
{
    text[0] = '\0';
    for (int i = 0; i < a->modes.count && text[0] == '\0'; i++) {
        if (a->modes.kind[i] == kind && a->modes.y != NULL) {
            mt_linear_name_direction(a->lin, mt_modal_shape(&a->modes, i), text, NAME_SIZE);
        }
    }
    cut(text);
}

/* "a", "b" spin freely between their ball joints */
static const char *spin_in_words(const warnings_rods *rods, mt_arena *mem)
{
    char *const names = mt_arena_strdup(mem, rods->names);
    if (names == NULL) {
        return NULL;
    }
    cut(names);
    return mt_arena_printf(mem,
                           rods->n == 1 ? "%s spins freely between its ball joints"
                                        : "%s spin freely between their ball joints",
                           names);
}

static mt_status say_free(const mt_analysis *a, mt_warning_list *out, mt_err *err)
{
    const mt_model *const m = a->sys->model;
    const int n = a->modes.n_rigid;
    const int floating = m->dimension == 2 ? STATES_2D : STATES_3D;
    char other[NAME_SIZE] = "";
    warnings_rods rods;
    if (n == 0) {
        return MT_OK;
    }
    MT_TRY(warnings_spins(a, out->mem, &rods, err));
    const char *spin = rods.n == 0 ? "" : spin_in_words(&rods, out->mem);
    const char *why = "";
    if (!is_grounded(m, a->sys->configuration)) {
        why = n - rods.n == floating ? "nothing holds it to the ground"
                                     : "nothing holds it to the ground, and its parts are not "
                                       "all held to each other";
    } else if (rods.n == 0 || rods.other != NULL) {
        if (rods.n == 0) {
            name_motion(a, MT_MODE_RIGID_BODY, other);
        } else {
            mt_linear_name_direction(a->lin, rods.other, other, sizeof other);
            cut(other);
        }
        why = mt_arena_printf(out->mem, "is a joint missing? Free to move: %s", other);
    }
    MT_TRY(mt_arena_check(out->mem, err));
    (void)mt_warning_add(out, MT_LEVEL_NOTE, "free_motion", "%d free motion%s: %s%s%s", n,
                         n == 1 ? "" : "s", why, *why != '\0' && *spin != '\0' ? "; " : "",
                         spin);
    return MT_OK;
}

/* Joints that redundant equations tie together. */
typedef struct tied {
    int equations; /* 0: it went into another */
    int n;
    const char **name;
} tied;

static bool is_tied(const tied *t, const char *name)
{
    for (int i = 0; i < t->n; i++) {
        if (t->name[i] == name) {
            return true;
        }
    }
    return false;
}

/* Appends the members of one set that t lacks; t has enough memory. */
static void tie(tied *t, int equations, int n, const char *const *name)
{
    t->equations += equations;
    for (int i = 0; i < n; i++) {
        if (!is_tied(t, name[i])) {
            t->name[t->n++] = name[i];
        }
    }
}

/* Adds a set and joins it with all sets that share a joint with it. */
static void add_set(tied *list, int n, const mt_joint_names *set)
{
    tied *const own = &list[n];
    tie(own, 1, set->n, set->name);
    for (int i = 0; i < n; i++) {
        bool shares = false;
        for (int k = 0; k < own->n && !shares; k++) {
            shares = is_tied(&list[i], own->name[k]);
        }
        if (shares && list[i].equations > 0) {
            tie(own, list[i].equations, list[i].n, list[i].name);
            list[i].equations = 0;
        }
    }
}

/* Which of the equations between the same joints are redundant is arbitrary: sets with a common
 * joint are reported together. */
static mt_status say_redundant(const mt_analysis *a, mt_warning_list *out, mt_err *err)
{
    const int n = mt_linear_redundant(a->lin);
    tied *const list = mt_arena_alloc(out->mem, (size_t)n, sizeof *list);
    MT_TRY(mt_arena_check(out->mem, err));
    for (int k = 0; k < n; k++) {
        mt_joint_names set = {.text = ""};
        MT_TRY(mt_linear_redundant_set(a->lin, k, out->mem, &set, err));
        list[k].name = mt_arena_alloc(out->mem, (size_t)a->sys->n_joints, sizeof *list[k].name);
        MT_TRY(mt_arena_check(out->mem, err));
        add_set(list, k, &set);
    }
    for (int k = 0; k < n; k++) {
        const char *names = "";
        for (int i = 0; i < list[k].n && list[k].equations > 0 && names != NULL; i++) {
            names = mt_arena_printf(out->mem, "%s%s\"%s\"", names, i == 0 ? "" : ", ",
                                    list[k].name[i]);
        }
        MT_TRY(mt_arena_check(out->mem, err));
        if (list[k].equations > 0) {
            (void)mt_warning_add(out, MT_LEVEL_NOTE, "redundant",
                                 list[k].equations == 1
                                     ? "redundant: %d equation of %s changes nothing"
                                     : "redundant: %d equations of %s change nothing",
                                 list[k].equations, names);
        }
    }
    return MT_OK;
}

/* One degree, one per cent: more than what a drawing leaves open. */
static const double MUCH_RAD = 0.017453292519943295;
static const double MUCH_OF_LENGTH = 0.01;
/* Ten degrees, a tenth of the model: another posture than the one that was drawn. */
static const double FAR_RAD = 0.17453292519943295;
static const double FAR_OF_LENGTH = 0.1;

static void say_motion(const mt_state *p, mt_warning_list *out)
{
    const mt_system *const sys = p->sys;
    const char *const from = sys->driven ? "where it is driven to" : "the drawing";
    const bool turns = p->turned_body >= 0 && p->turned_rad > MUCH_RAD;
    const bool moves = p->moved_body >= 0 && p->moved_m > MUCH_OF_LENGTH * sys->length_m;
    if (!p->equilibrium.active) {
        return;
    }
    const bool far = (p->turned_body >= 0 && p->turned_rad > FAR_RAD) ||
                     (p->moved_body >= 0 && p->moved_m > FAR_OF_LENGTH * sys->length_m);
    const char *const how = far ? "far " : "";
    mt_warning *d = NULL;
    if (turns) {
        d = mt_warning_add(
            out, MT_LEVEL_NOTE, "settles",
            "it settles %saway from %s: \"%s\" turns by %.3g degrees, \"%s\" moves by "
            "%.3g m",
            how, from, sys->bodies[p->turned_body].name, p->turned_rad / MUCH_RAD,
            sys->bodies[p->moved_body < 0 ? p->turned_body : p->moved_body].name, p->moved_m);
    } else if (moves) {
        d = mt_warning_add(out, MT_LEVEL_NOTE, "settles",
                           "it settles %saway from %s: \"%s\" moves by %.3g m", how, from,
                           sys->bodies[p->moved_body].name, p->moved_m);
    }
    if (d != NULL && far) {
        d->size = 1.0;
    }
}

/* The linearisation holds within a part of the distance only. */
static mt_status say_dead_centre(mt_linear *lin, mt_warning_list *out, mt_err *err)
{
    mt_nearness near;
    MT_TRY(mt_linear_nearness(lin, out->mem, &near, err));
    if (near.near) {
        (void)mt_warning_add(out, MT_LEVEL_NOTE, "dead_centre",
                             "near a dead centre: about %.2g rad (or model lengths) from here, "
                             "joints %s become dependent; keep motions far below that",
                             near.distance, near.joints.text);
    }
    return MT_OK;
}

/* Rods that may turn about themselves. */
static void say_free_spin(const mt_linear *lin, mt_warning_list *out)
{
    char name[NAME_SIZE] = "";
    const bool *idle = NULL;
    const int spins = mt_linear_free_spins(lin, &idle);
    int n = 0;
    for (int b = 0; b < mt_linear_system(lin)->n_bodies && spins > 0; b++) {
        if (idle[b] && n++ < NAMED) {
            const size_t used = strlen(name);
            (void)mt_snprintf(name + used, sizeof name - used, "%s\"%s\"", n == 1 ? "" : ", ",
                              mt_linear_system(lin)->bodies[b].name);
        }
    }
    if (spins > 0) {
        (void)mt_warning_add(out, MT_LEVEL_NOTE, "idle_spin",
                             "%d idle spin%s, without inertia and stiffness, left out: %s%s",
                             spins, spins == 1 ? "" : "s", name, n > NAMED ? ", ..." : "");
    }
}

/* Warns of a damping ratio, given by the number `at`, of a mode that does not exist. */
static void fault_ratio(const mt_model *m, mt_num at, const char *text, mt_warning_list *out)
{
    int line = 0;
    int column = 0;
    const bool known = mt_model_locate(m, m->nums[at].addr, &line, &column);
    (void)mt_warning_add(out, MT_LEVEL_FAULT, "damping",
                         known ? "%s (line %d, column %d)" : "%s", text == NULL ? "" : text,
                         line, column);
}

/* Damping ratios of more modes than there are. */
static void fault_damping(const mt_analysis *a, mt_warning_list *out)
{
    const mt_model *const m = a->sys->model;
    const int c = a->sys->configuration;
    const mt_damping *const d = &m->configurations[c].damping;
    const char *const name = m->configurations[c].name.s;
    const int most = a->n_most - a->n_null;
    if (d->n_ratios > most) {
        fault_ratio(
            m, d->ratios[most],
            mt_arena_printf(
                out->mem,
                "damping lists ratios for %d vibration modes, but configuration \"%s\" has %d",
                d->n_ratios, name, most),
            out);
    }
    for (int i = 0; i < d->n_named; i++) {
        const mt_named_mode *const mode = &m->modes[d->named[i].mode];
        if (mode->configuration == c && mode->index > most) {
            fault_ratio(m, d->named[i].ratio,
                        mt_arena_printf(out->mem,
                                        "damping names mode \"%s\", vibration mode %d of "
                                        "configuration \"%s\", which has only %d",
                                        mode->name.s, mode->index, name, most),
                        out);
        }
    }
}

/* Of the terms of a spring, from term t on: *given, one has a coefficient; *acts, one acts on a
 * motion that the joints leave. Returns the first term of another spring. */
static int look_at_spring(const mt_linear *lin, mt_term_kind kind, int t, bool *given,
                          bool *acts)
{
    const mt_system *const sys = mt_linear_system(lin);
    const mt_term_list *const list = mt_linear_terms(lin, kind);
    const int n = mt_linear_freedoms(lin);
    const char *const name = sys->springs[list->terms[t].source].name;
    *given = false;
    *acts = false;
    for (; t < list->n_terms; t++) {
        const mt_term *const term = &list->terms[t];
        const mt_spring_def *const s = &sys->springs[term->source];
        if (strcmp(s->name, name) != 0) {
            break;
        }
        /* what is strained where it stands resists across its line, too */
        *acts = *acts || s->preload != MT_NO_NODE || s->free != MT_NO_NODE ||
                mt_system_trim_of(sys, term->source) >= 0 ||
                (sys->loaded && sys->measures[s->measure[0]].kind == MT_MEASURE_DISTANCE);
        if (mt_linear_value(lin, term->coefficient) == 0.0) {
            continue;
        }
        *given = true;
        for (int row = term->first; row < term->first + term->count; row++) {
            for (int i = 0; i < n && !*acts; i++) {
                *acts = *acts || mt_linear_row(lin, kind, row)[i] != 0.0;
            }
        }
    }
    return t;
}

static void warn_spring(const mt_model *m, int i, mt_warning_list *out)
{
    const mt_spring *const s = &m->springs[i];
    int before = 0; /* dampers stand behind the springs */
    for (; s->damper && before < i && !m->springs[before].damper; before++) {
    }
    mt_warning *const d = mt_warning_add(
        out, MT_LEVEL_WARNING, "spring",
        "%s \"%s\" has no effect here: joints forbid every motion that it acts against",
        s->damper ? "damper" : "spring", s->name.s);
    if (d == NULL) {
        return;
    }
    d->addr = s->name.addr;
    d->pointer = mt_arena_printf(out->mem, "/%s/%d", s->damper ? "dampers" : "springs",
                                 s->damper ? i - before : i);
    if (!mt_model_locate(m, d->addr, &d->line, &d->column)) {
        d->line = 0;
        d->column = 0;
    }
}

/* Springs and dampers whose directions are all blocked by joints. A driven joint that is locked
 * blocks its own by design. */
static void warn_springs(const mt_linear *lin, mt_warning_list *out)
{
    static const mt_term_kind kinds[] = {MT_TERM_STIFFNESS, MT_TERM_DAMPING};
    const mt_system *const sys = mt_linear_system(lin);
    const mt_model *const m = sys->model;
    if (sys->n_drives > sys->n_trims) {
        return;
    }
    for (int k = 0; k < MT_COUNT(kinds); k++) {
        const mt_term_list *const list = mt_linear_terms(lin, kinds[k]);
        for (int t = 0; t < list->n_terms;) {
            bool given = false;
            bool acts = false;
            const int i = mt_model_find_spring(m, sys->springs[list->terms[t].source].name);
            t = look_at_spring(lin, kinds[k], t, &given, &acts);
            if (i < 0 || !given || acts) {
                continue;
            }
            warn_spring(m, i, out);
        }
    }
}

static void warn_mass(double mass_kg, mt_warning_list *out)
{
    if (mass_kg > MOST_MASS_KG || (mass_kg > 0.0 && mass_kg < LEAST_MASS_KG)) {
        char mass[NUMBER_SIZE] = "beyond 1.8e308"; /* masses that no double adds up */
        if (isfinite(mass_kg)) {
            (void)mt_snprintf(mass, sizeof mass, "%.3g", mass_kg);
        }
        (void)mt_warning_add(out, MT_LEVEL_WARNING, "mass",
                             "its mass is %s kg, which no mechanism has: is a length in "
                             "millimetres, a mass in grams, or a density in t/mm^3?",
                             mass);
    }
}

static void warn_frequency(const mt_modes *modes, mt_warning_list *out)
{
    for (int i = 0; i < modes->count; i++) {
        const double hz = mt_modal_hz(modes, i);
        if (modes->kind[i] != MT_MODE_FLEXIBLE) {
            continue;
        }
        if (hz > MOST_LOWEST_HZ || hz < LEAST_LOWEST_HZ) {
            (void)mt_warning_add(
                out, MT_LEVEL_WARNING, "frequency",
                "its lowest frequency is %.3g Hz, which no mechanism has: is a "
                "length in millimetres, a mass in grams, or a modulus in MPa?",
                hz);
        }
        return;
    }
}

/* What only an analysis of all modes can tell. */
static mt_status say_analysis(mt_analysis *a, mt_warning_list *out, mt_err *err)
{
    mt_info info;
    MT_TRY(mt_info_fill(a->lin, &info, err));
    warn_mass(info.mass_kg, out);
    warn_frequency(&a->modes, out);
    const int unstable = a->modes.n_unstable;
    warn_springs(a->lin, out);
    say_motion(mt_linear_position(a->lin), out);
    MT_TRY(say_free(a, out, err));
    fault_damping(a, out);
    say_free_spin(a->lin, out);
    if (unstable > 0) {
        char name[NAME_SIZE];
        name_motion(a, MT_MODE_UNSTABLE, name);
        (void)mt_warning_add(
            out, MT_LEVEL_NOTE, "unstable", "the equilibrium is unstable in %d direction%s%s%s",
            unstable, unstable == 1 ? "" : "s", name[0] == '\0' ? "" : ", moving ", name);
    }
    if (a->modes.n_undecided > 0) {
        char name[NAME_SIZE];
        const int n = a->modes.n_undecided;
        name_motion(a, MT_MODE_UNDECIDED, name);
        (void)mt_warning_add(
            out, MT_LEVEL_NOTE, "undecided",
            "stability undecided in %d direction%s: springs and loads cancel to "
            "the last digit, so rounding hides whether it is stable%s%s",
            n, n == 1 ? "" : "s", name[0] == '\0' ? "" : ", moving ", name);
    }
    MT_TRY(say_dead_centre(a->lin, out, err));
    return say_redundant(a, out, err);
}

static void say_lowest(const mt_lowest *l, mt_warning_list *out)
{
    const mt_modes *const modes = &l->found.modes;
    warn_mass(l->mass_kg, out);
    warn_frequency(modes, out);
    if (mt_lowest_settled(l) != NULL) {
        say_motion(mt_lowest_settled(l), out);
    }
    if (modes->n_rigid > 0) {
        (void)mt_warning_add(out, MT_LEVEL_NOTE, "free_motion",
                             "%d free motion%s: is a joint or a spring missing?",
                             modes->n_rigid, modes->n_rigid == 1 ? "" : "s");
    }
}

bool mt_warnings_settles_far(const mt_warning *d)
{
    return strcmp(d->kind, "settles") == 0 && d->size > 0.0;
}

/* Adds to `out`; an entry that another configuration already has becomes one without a
 * configuration. */
static void merge_configuration_warning(mt_warning_list *out, const mt_warning *d)
{
    for (int i = 0; i < out->n; i++) {
        mt_warning *const other = &out->items[i];
        const bool same_pointer = d->pointer != NULL && other->pointer != NULL
                                      ? strcmp(other->pointer, d->pointer) == 0
                                      : d->pointer == other->pointer && d->addr != MT_NO_ADDR;
        if (other->addr == d->addr && same_pointer && strcmp(other->text, d->text) == 0) {
            other->configuration = NULL;
            return;
        }
    }
    mt_warning_copy(out, d);
}

/* What is known of a configuration: the analysis, or its lowest modes. */
typedef struct known {
    const mt_system *sys;
    mt_analysis *a;
    const mt_lowest *l;
} known;

static mt_status list_configuration_warnings(const known *k, int n_inputs, const int *inputs,
                                             const double *at, mt_warning_list *list,
                                             mt_err *err)
{
    const mt_model *const m = k->sys->model;
    const int c = k->sys->configuration;
    double *const value = mt_arena_f64(list->mem, (size_t)m->n_nums, 1);
    MT_TRY(mt_arena_check(list->mem, err));
    MT_TRY(mt_model_numbers(m, c, n_inputs, inputs, at, list->mem, value, err));
    if (k->a != NULL) {
        MT_TRY(say_analysis(k->a, list, err));
    } else {
        say_lowest(k->l, list);
    }
    for (int i = 0; i < list->n; i++) {
        list->items[i].configuration = m->configurations[c].name.s;
        list->items[i].file = mt_model_file(m, list->items[i].addr);
    }
    mt_model_lint(m, c, value, false, list);
    mt_warning_accept(list, 0, &m->accepted);
    for (int i = 0; i < list->n; i++) {
        mt_warning *const d = &list->items[i];
        if (k->a != NULL && strcmp(d->kind, "gap") == 0) {
            /* the distance after closing, beside that before */
            d->text = mt_arena_printf(list->mem, "%s (to %.1e m)", d->text,
                                      mt_linear_position(k->a->lin)->gap_m);
        }
        if (d->level == MT_LEVEL_FAULT) {
            return mt_fail(err, MT_E_INPUT, "%s", d->text);
        }
    }
    return mt_arena_check(list->mem, err);
}

static mt_status add_known(const known *k, int n_inputs, const int *inputs, const double *at,
                           mt_warning_list *out, mt_err *err)
{
    mt_arena mem;
    MT_TRY(mt_arena_init(&mem, 0, err));
    mt_warning_list list = mt_warning_list_default(&mem);
    const mt_status rc = list_configuration_warnings(k, n_inputs, inputs, at, &list, err);
    /* another posture than the drawn one before all else */
    for (int i = 0; i < list.n && rc == MT_OK; i++) {
        if (mt_warnings_settles_far(&list.items[i])) {
            merge_configuration_warning(out, &list.items[i]);
        }
    }
    for (int level = MT_LEVEL_WARNING; rc == MT_OK && level >= MT_LEVEL_NOTE; level--) {
        for (int i = 0; i < list.n; i++) {
            if ((int)list.items[i].level == level && !mt_warnings_settles_far(&list.items[i])) {
                merge_configuration_warning(out, &list.items[i]);
            }
        }
    }
    mt_arena_free(&mem);
    return rc == MT_OK ? mt_arena_check(out->mem, err) : rc;
}

mt_status mt_warnings_of_analysis(mt_analysis *a, int n_inputs, const int *inputs,
                                  const double *at, mt_warning_list *out, mt_err *err)
{
    const known k = {.sys = a->sys, .a = a};
    return add_known(&k, n_inputs, inputs, at, out, err);
}

mt_status mt_warnings_of_lowest(const mt_lowest *l, int n_inputs, const int *inputs,
                                const double *at, mt_warning_list *out, mt_err *err)
{
    const known k = {.sys = l->sys, .l = l};
    return add_known(&k, n_inputs, inputs, at, out, err);
}
