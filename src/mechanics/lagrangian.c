/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energy, constraints and their derivatives at a position. */
#include "mechanics/lagrangian.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/singular.h"

/*
 * Sum of the Hessians of consecutive measures between the same two bodies (a joint's equations,
 * a bushing's directions, a beam element's strains), by relative position; it is added to the
 * Hessian of all states when the bodies change, and finally by curvature_flush.
 */
typedef struct curvature_sum {
    mt_lagrangian *out;
    const mt_system *sys;
    int body[2];
    bool empty;
    mt_second second;
    mt_cx h[MT_RELATIVE_PAIRS];
} curvature_sum;

/* Sums of Hessians. */

static void curvature_begin(curvature_sum *s, const mt_system *sys, mt_lagrangian *out)
{
    s->out = out;
    s->sys = sys;
    s->empty = true;
    s->second = sys->dimension == 2 ? MT_SECOND_PLANE : MT_SECOND_ALL;
}

/* Entry of the Hessian of all states += value; of a sparse one, the lower triangle only. */
static void curvature_add_entry(mt_lagrangian *out, int nq, int r, int c, double value)
{
    if (out->layout == NULL) {
        out->h[r + ((ptrdiff_t)c * nq)] += value;
        return;
    }
    const int i = out->layout->state[r];
    const int j = out->layout->state[c];
    if (i >= j) {
        out->h[out->layout->envelope.row[i] + j] += value;
    }
}

static void curvature_flush(curvature_sum *s)
{
    mt_lagrangian *const out = s->out;
    const int nq = s->sys->nq;
    int dof[MT_LOCAL];
    if (s->empty) {
        return;
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        dof[k] = mt_local_dof(s->sys, s->body, k);
    }
    for (int c = 0; c < MT_LOCAL; c++) {
        for (int r = c; r < MT_LOCAL && dof[c] >= 0; r++) {
            const mt_cx h = s->h[mt_relative_pair(r, c)];
            const double part = out->slope ? cx_derivative(h) : creal(h);
            const double v = mt_relative_sign(r) * mt_relative_sign(c) * part;
            if (dof[r] < 0 || v == 0.0) {
                continue;
            }
            curvature_add_entry(out, nq, dof[r], dof[c], v);
            if (r != c) {
                curvature_add_entry(out, nq, dof[c], dof[r], v);
            }
        }
    }
    s->empty = true;
}

static void open_pair(curvature_sum *s, const int body[2])
{
    if (!s->empty && s->body[0] == body[0] && s->body[1] == body[1]) {
        return;
    }
    curvature_flush(s);
    s->body[0] = body[0];
    s->body[1] = body[1];
    s->empty = false;
    memset(s->h, 0, sizeof s->h);
}

/* h += scale a.h + outer (a.g b.g^T + b.g a.g^T)/2; a needs its h where scale is not 0. */
static void curvature_add(curvature_sum *s, const int body[2], const mt_relative_jet *a,
                          const mt_relative_jet *b, mt_cx scale, mt_cx outer)
{
    const bool slope = s->out->slope;
    const bool curved = creal(scale) != 0.0 || cimag(scale) != 0.0;
    const bool squares = creal(outer) != 0.0 || cimag(outer) != 0.0;
    const mt_relative_list *l = NULL;
    open_pair(s, body);
    if (curved) {
        l = mt_relative_filled(s->second, a->span);
    }
    for (int ii = 0; curved && ii < l->n; ii++) {
        const int row = mt_relative_row(l->at[ii]);
        for (int kk = 0; kk <= ii; kk++) {
            const int at = row + l->at[kk];
            s->h[at] += slope ? cx_mul(scale, a->h[at]) : creal(scale) * creal(a->h[at]);
        }
    }
    if (squares) {
        l = mt_relative_filled(s->second, a->span | b->span);
    }
    for (int ii = 0; squares && ii < l->n; ii++) {
        const int i = l->at[ii];
        const mt_cx x = cx_mul(0.5 * outer, a->g[i]);
        const mt_cx y = cx_mul(0.5 * outer, b->g[i]);
        mt_cx *const row = s->h + mt_relative_row(i);
        for (int kk = 0; kk <= ii; kk++) {
            const int k = l->at[kk];
            row[k] += slope ? cx_mul(x, b->g[k]) + cx_mul(y, a->g[k])
                            : (creal(x) * creal(b->g[k])) + (creal(y) * creal(a->g[k]));
        }
    }
}

/* Forces one by one. */

/* The slope of a beam element's chord: coordinates over its length. */
static bool is_chord(const mt_measure_def *def)
{
    return def->kind == MT_MEASURE_BEAM && def->component >= MT_BEAM_SWAY_2;
}

/* True for an angle or a cosine, false for a length. */
static bool piece_is_angle(const mt_measure_def *def)
{
    return def->kind == MT_MEASURE_ANGLE || def->kind == MT_MEASURE_ROTATION ||
           def->kind == MT_MEASURE_DOT ||
           (def->kind == MT_MEASURE_BEAM && def->component != MT_BEAM_STRETCH &&
            !is_chord(def));
}

/* Largest coordinate of the two bodies, the scale of the rounding of their positions. */
static double extent_of(const mt_pose *poses, const int body[2])
{
    double extent = 0.0;
    for (int side = 0; side < 2; side++) {
        const mt_pose *const pose = mt_pose_of(poses, body[side]);
        for (int k = 0; k < 3; k++) {
            extent = fmax(extent, fabs(creal(pose->x[k])));
        }
    }
    return extent;
}

double mt_jet_along(const mt_system *sys, const int body[2], const mt_jet *jet,
                    const double *motion)
{
    double sum = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        sum += dof >= 0 ? creal(jet->g[k]) * motion[dof] : 0.0;
    }
    return sum;
}

/* Rounding error of a measure: positions are known to eps of the coordinates that they are the
 * difference of, angles to eps, the slope of a beam element's chord to eps of the coordinates
 * over its length. */
static double piece_roundness(const mt_data *d, const mt_measure_def *def, const mt_pose *poses)
{
    double extent =
        piece_is_angle(def) ? 1.0 : fmax(d->sys->length_m, extent_of(poses, def->body));
    if (is_chord(def)) {
        extent /= creal(mt_data_scalar(d, def->beam[MT_BEAM_LENGTH], 1.0));
    }
    return DBL_EPSILON * extent;
}

double mt_piece_work(const mt_piece *p, const double *way)
{
    double local[MT_LOCAL];
    double sum = 0.0;
    mt_piece_motion(p, way, local);
    for (int k = 0; k < MT_LOCAL; k++) {
        sum += p->g[k] * local[k];
    }
    return sum;
}

double mt_piece_bend(const mt_piece *p, const double *phi, double *out)
{
    double way[MT_RELATIVE];
    double bent[MT_RELATIVE];
    double energy = 0.0;
    mt_piece_relative(p, phi, way);
    mt_piece_product(p->filled, p->h, way, bent);
    for (int k = 0; k < MT_RELATIVE; k++) {
        energy += way[k] * bent[k];
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        out[k] = mt_relative_sign(k) * bent[mt_relative_of(k)];
    }
    return energy;
}

void mt_piece_add(const mt_piece *p, double c, const double *local, double *to)
{
    for (int k = 0; k < MT_LOCAL && c != 0.0; k++) {
        if (p->dof[k] >= 0) {
            to[p->dof[k]] += c * local[k];
        }
    }
}

static void add_entry(ptrdiff_t nq, const mt_piece *p, int r, int c, double add, double *terms)
{
    const ptrdiff_t i = p->dof[r];
    const ptrdiff_t j = p->dof[c];
    if (i >= 0 && j >= 0) {
        terms[i + (j * nq)] += add;
        terms[j + (i * nq)] += r == c ? 0.0 : add;
    }
}

/* terms += size |h|, and `turns` between rotations. */
static void add_piece_terms(ptrdiff_t nq, double size, double turns, const mt_piece *p,
                            double *terms)
{
    for (int c = 0; c < MT_LOCAL && size > 0.0; c++) {
        for (int r = c; r < MT_LOCAL; r++) {
            const double h = p->h[mt_relative_pair(r, c)];
            if (h != 0.0) {
                add_entry(nq, p, r, c, size * fabs(h), terms);
            }
        }
    }
    for (int c = 3; c < MT_LOCAL && turns > 0.0; c += c == 5 ? 4 : 1) {
        for (int r = c; r < MT_LOCAL; r += r == 5 ? 4 : 1) {
            add_entry(nq, p, r, c, turns, terms);
        }
    }
}

/* Fill a piece with this jet; spring and equation are set later. terms (nq x nq) += size
 * |jet.h|, and force times the coordinates' size: lengths that cancel in an entry between
 * rotations are differences of coordinates. */
static void piece_fill(const mt_data *d, const mt_measure_def *def, const mt_pose *poses,
                       const mt_relative_jet *jet, const double size_force[2], double *terms,
                       mt_piece *out)
{
    double extent = piece_is_angle(def) ? 0.0 : extent_of(poses, def->body);
    *out = (mt_piece){.size = size_force[0],
                      .equation = -1,
                      .factor = 1.0,
                      .def = def,
                      .spring = -1,
                      .load = -1,
                      .roundness = piece_roundness(d, def, poses)};
    if (is_chord(def)) {
        extent /= creal(mt_data_scalar(d, def->beam[MT_BEAM_LENGTH], 1.0));
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        out->dof[k] = mt_local_dof(d->sys, def->body, k);
        out->g[k] = mt_relative_sign(k) * creal(jet->g[mt_relative_of(k)]);
    }
    out->filled = mt_relative_filled(jet->second, jet->span);
    for (int ii = 0; ii < out->filled->n; ii++) {
        const int row = mt_relative_row(out->filled->at[ii]);
        for (int kk = 0; kk <= ii; kk++) {
            const int at = row + out->filled->at[kk];
            out->h[at] = creal(jet->h[at]);
        }
    }
    add_piece_terms(d->sys->nq, size_force[0], size_force[1] * extent, out, terms);
}

static bool is_pose(const mt_pose *a, const mt_pose *b)
{
    bool same = true;
    for (int k = 0; k < 3; k++) {
        same = same && a->x[k] == b->x[k];
    }
    for (int k = 0; k < 9; k++) {
        same = same && a->r[k] == b->r[k];
    }
    return same;
}

/* True where the bodies of a measure have the same poses as in `rest`, to the bit. */
static bool piece_is_still(const mt_measure_def *def, const mt_pose *poses, const mt_pose *rest)
{
    bool still = true;
    for (int side = 0; side < 2; side++) {
        const int b = def->body[side];
        still = still && (b == MT_GROUND || is_pose(&poses[b], &rest[b]));
    }
    return still;
}

/* Forces on bodies. */

/* Of a correction that is known by its size alone. */
static const double TWICE = 2.0;
/* Roundings of a force. */
static const double ULPS = 8.0;

/* A measure with the force c; that of a spring from how far it is stretched. */
static bool visit_measure(const mt_data *d, const mt_pose *pose, const mt_measure_def *def,
                          const mt_spring_def *spring, double c, mt_force_visit visit,
                          void *context)
{
    const mt_measure_data measure = mt_data_measure(d, def);
    mt_jet jet;
    mt_measure_eval(&measure, mt_pose_of(pose, def->body[0]), mt_pose_of(pose, def->body[1]),
                    true, NULL, &jet);
    if (spring != NULL && spring->free != MT_NO_NODE) {
        c += d->value[spring->stiffness] * (creal(jet.value) - d->value[spring->free]);
    }
    return c == 0.0 || visit(context, def->body, c, 0.0, &jet);
}

/* A force on a point. */
static bool visit_point(const mt_data *d, const mt_pose *pose, const mt_load_def *load,
                        mt_force_visit visit, void *context)
{
    const int body[2] = {load->body, MT_GROUND};
    mt_cx f[3];
    mt_jet jet;
    for (int k = 0; k < 3; k++) {
        f[k] = mt_data_scalar(d, load->force[k], 0.0);
    }
    mt_measure_point(load->point < 0 ? NULL : d->vec[load->point], f,
                     mt_pose_of(pose, load->body), true, &jet);
    return visit(context, body, -1.0, 0.0, &jet);
}

bool mt_forces_each(const mt_data *d, const mt_pose *pose, mt_force_visit visit, void *context)
{
    const mt_system *const sys = d->sys;
    bool more = true;
    for (int i = 0; i < sys->n_loads && more; i++) {
        const mt_load_def *const load = &sys->loads[i];
        more = load->measure < 0 ? visit_point(d, pose, load, visit, context)
                                 : visit_measure(d, pose, &sys->measures[load->measure], NULL,
                                                 -d->value[load->size], visit, context);
    }
    for (int i = 0; i < sys->n_springs && more; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        if (!s->damper && (s->free != MT_NO_NODE || s->preload != MT_NO_NODE)) {
            const double preload = s->preload == MT_NO_NODE ? 0.0 : d->value[s->preload];
            more = visit_measure(d, pose, &sys->measures[s->measure[0]], s, preload, visit,
                                 context);
        }
    }
    return more;
}

/* V = 1/2 k d_a d_b + p d_a, of two measures that are the same or not. */
static bool visit_spring(const mt_data *d, const mt_placement *at, const double *left,
                         const double *open, int i, mt_force_visit visit, void *context)
{
    const mt_system *const sys = d->sys;
    const mt_spring_def *const s = &sys->springs[i];
    const bool coupling = s->measure[0] != s->measure[1];
    const double k = coupling ? 0.5 * d->value[s->stiffness] : d->value[s->stiffness];
    const double preload = s->preload == MT_NO_NODE ? 0.0 : d->value[s->preload];
    mt_jet jet[2];
    double stretch[2] = {0.0, 0.0};
    double noise[2] = {0.0, 0.0};
    bool more = true;
    for (int side = 0; side < (coupling ? 2 : 1); side++) {
        const mt_measure_def *const def = &sys->measures[s->measure[side]];
        mt_data_eval(d, def, at, true, NULL, &jet[side]);
        stretch[side] = creal(jet[side].value) - creal(d->rest[i][side]);
        stretch[side] += mt_jet_along(sys, def->body, &jet[side], left);
        noise[side] = TWICE * fabs(mt_jet_along(sys, def->body, &jet[side], open));
    }
    for (int side = 0; side < (coupling ? 2 : 1) && more; side++) {
        const int other = coupling ? 1 - side : 0;
        const double c = (k * stretch[other]) + (coupling ? 0.0 : preload);
        more = visit(context, sys->measures[s->measure[side]].body, c,
                     (fabs(k) * noise[other]) + (ULPS * DBL_EPSILON * fabs(c)), &jet[side]);
    }
    return more;
}

bool mt_forces_at(const mt_data *d, const mt_placement *at, const double *left,
                  const double *open, mt_force_visit visit, void *context)
{
    const mt_system *const sys = d->sys;
    bool more = true;
    for (int i = 0; i < sys->n_loads && more; i++) {
        const mt_load_def *const load = &sys->loads[i];
        mt_jet jet;
        if (load->measure < 0) {
            more = visit_point(d, at->pose, load, visit, context);
        } else {
            const mt_measure_def *const def = &sys->measures[load->measure];
            mt_data_eval(d, def, at, true, NULL, &jet);
            more = visit(context, def->body, -d->value[load->size], 0.0, &jet);
        }
    }
    for (int i = 0; i < sys->n_springs && more; i++) {
        more = sys->springs[i].damper || visit_spring(d, at, left, open, i, visit, context);
    }
    return more;
}

/* The sums. */

mt_status mt_lagrangian_init(mt_lagrangian *l, const mt_system *sys, bool hessian,
                             mt_arena *mem, mt_err *err)
{
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    *l = (mt_lagrangian){0};
    l->g = mt_arena_f64(mem, nq, 1);
    l->trim = mt_arena_f64(mem, nq, (size_t)sys->n_trims);
    l->c = mt_arena_f64(mem, m, 1);
    l->a = mt_arena_f64(mem, m, nq);
    l->h = hessian ? mt_arena_f64(mem, nq, nq) : NULL;
    return mt_arena_check(mem, err);
}

mt_status mt_lagrangian_init_rows(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                  mt_err *err)
{
    const size_t nq = (size_t)sys->nq;
    const size_t m = (size_t)sys->n_constraints;
    *l = (mt_lagrangian){.g = mt_arena_f64(mem, nq, 1),
                         .trim = mt_arena_f64(mem, nq, (size_t)sys->n_trims)};
    l->c = mt_arena_f64(mem, m, 1);
    l->row = mt_arena_alloc(mem, m, sizeof *l->row);
    return mt_arena_check(mem, err);
}

static double beam_number(const mt_data *d, int measure, int k)
{
    const mt_measure_def *const def = &d->sys->measures[measure];
    return def->kind == MT_MEASURE_BEAM ? creal(mt_data_scalar(d, def->beam[k], 0.0)) : 0.0;
}

/* True where all that measures are made of is what it was. */
static bool are_numbers(const mt_data *d, const mt_jets *jets)
{
    bool same = true;
    for (int i = 0; i < d->sys->n_vecs && same; i++) {
        for (int k = 0; k < 3; k++) {
            same = same && jets->vec[i][k] == d->vec[i][k];
        }
    }
    for (int i = 0; i < d->sys->n_measures && same; i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            same = same && jets->beam[(i * MT_BEAM_NUMBERS) + k] == beam_number(d, i, k);
        }
    }
    return same;
}

static void take_numbers(const mt_data *d, mt_jets *jets)
{
    memcpy(jets->vec, d->vec, (size_t)d->sys->n_vecs * sizeof *jets->vec);
    for (int i = 0; i < d->sys->n_measures; i++) {
        for (int k = 0; k < MT_BEAM_NUMBERS; k++) {
            jets->beam[(i * MT_BEAM_NUMBERS) + k] = beam_number(d, i, k);
        }
    }
}

static bool keeps_jets(const mt_lagrangian *l)
{
    return l->jets != NULL && l->jets->pose != NULL && !l->slope;
}

/* True where the jets are those of these numbers and this position. */
static bool are_jets_of(const mt_data *d, const mt_placement *a, const mt_jets *b)
{
    const mt_system *const sys = d->sys;
    bool same = are_numbers(d, b);
    for (int i = 0; i < sys->n_bodies && same; i++) {
        same = is_pose(&a->pose[i], &b->pose[i]);
    }
    for (int i = 0; i < sys->n_measures && same; i++) {
        same = a->turn[i] == b->turn[i];
    }
    return same;
}

/* The jets that are kept stand for this position from here on: those of another one are
 * gone. */
static void keep_jets_at(const mt_data *d, const mt_placement *at, const mt_lagrangian *l)
{
    const mt_system *const sys = d->sys;
    mt_jets *const jets = l->jets;
    if (!keeps_jets(l) || are_jets_of(d, at, jets)) {
        return;
    }
    memcpy(jets->pose, at->pose, (size_t)sys->n_bodies * sizeof *at->pose);
    memcpy(jets->turn, at->turn, (size_t)sys->n_measures * sizeof *at->turn);
    take_numbers(d, jets);
    memset(jets->known, 0, (size_t)jets->n * sizeof *jets->known);
}

/* The jet of a measure, kept under its number or else in `own`. */
static mt_relative_jet *jet_at(const mt_data *d, const mt_measure_def *def,
                               const mt_placement *at, bool second, int number,
                               mt_beam_parts *parts, const mt_lagrangian *l,
                               mt_relative_jet *own)
{
    const bool keeps = keeps_jets(l);
    mt_relative_jet *const jet = keeps ? &l->jets->jet[number] : own;
    if (keeps && l->jets->known[number] && (!second || jet->second != MT_SECOND_NONE)) {
        return jet;
    }
    mt_data_relative(d, def, at, second, parts, jet);
    if (keeps) {
        l->jets->known[number] = true;
    }
    return jet;
}

void mt_lagrangian_pull(const mt_lagrangian *l, int m, const double *lambda, double *out)
{
    for (int i = 0; i < m; i++) {
        const mt_sparse_row *const row = &l->row[i];
        for (int k = 0; k < row->n; k++) {
            out[row->dof[k]] += row->a[k] * lambda[i];
        }
    }
}

mt_status mt_lagrangian_want_terms(mt_lagrangian *l, const mt_system *sys, mt_arena *mem,
                                   mt_err *err)
{
    l->terms = mt_arena_f64(mem, (size_t)sys->nq, (size_t)sys->nq);
    l->push = mt_arena_f64(mem, (size_t)sys->n_bodies, 1);
    size_t most = (size_t)sys->n_loads;
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        most += s->damper ? 0 : (s->measure[0] == s->measure[1] ? 1 : 2);
    }
    for (int i = 0; i < sys->n_constraints; i++) {
        most += (size_t)sys->constraints[i].terms;
    }
    l->pieces = mt_arena_alloc(mem, most, sizeof *l->pieces);
    return mt_arena_check(mem, err);
}

/* The wanted part of a number: its value or its derivative. */
static double value_or_derivative(const mt_lagrangian *l, mt_cx z)
{
    return l->slope ? cx_derivative(z) : creal(z);
}

/* to[nq] += scale times the gradient. */
static void add_gradient(const mt_system *sys, const int body[2], const mt_relative_jet *jet,
                         mt_cx scale, const mt_lagrangian *l, double *to)
{
    double part[MT_RELATIVE];
    for (int k = 0; k < MT_RELATIVE; k++) {
        part[k] = value_or_derivative(l, cx_mul(scale, jet->g[k]));
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        if (dof >= 0) {
            to[dof] += mt_relative_sign(k) * part[mt_relative_of(k)];
        }
    }
}

/* Returns the piece, or NULL where terms are not wanted. */
static mt_piece *note_terms(const mt_data *d, const mt_measure_def *def, const mt_pose *poses,
                            const mt_relative_jet *jet, double size, double force,
                            mt_lagrangian *out)
{
    const double size_force[2] = {size, force};
    if (out->terms == NULL) {
        return NULL;
    }
    mt_piece *const piece = &out->pieces[out->n_pieces++];
    piece_fill(d, def, poses, jet, size_force, out->terms, piece);
    return piece;
}

/* Torques count as forces at the model length. */
static double largest_push(const mt_system *sys, const mt_relative_jet *jet)
{
    double push = 0.0;
    for (int k = 0; k < MT_RELATIVE; k++) {
        const double arm = k < 3 ? 1.0 : sys->length_m;
        push = fmax(push, fabs(creal(jet->g[k])) / arm);
    }
    return push;
}

static void note_push(const int body[2], double size, mt_lagrangian *out)
{
    for (int side = 0; side < 2 && out->push != NULL; side++) {
        if (body[side] != MT_GROUND) {
            out->push[body[side]] += size;
        }
    }
}

static void note_force(const mt_system *sys, mt_lagrangian *out, const int body[2],
                       const mt_relative_jet *jet, mt_cx force)
{
    const double size = fabs(creal(force)) * largest_push(sys, jet);
    out->force_scale = fmax(out->force_scale, size);
    note_push(body, size, out);
}

static void note_noise(const mt_data *d, const mt_measure_def *def, const mt_pose *poses,
                       const mt_relative_jet *jet, double stiffness, mt_lagrangian *out)
{
    const double noise =
        piece_roundness(d, def, poses) * fabs(stiffness) * largest_push(d->sys, jet);
    out->force_noise = fmax(out->force_noise, noise);
}

/* V = 1/2 k d_a d_b. */
static void add_coupling(const mt_system *sys, const int body[2], mt_cx k,
                         const mt_cx stretch[2], const mt_relative_jet jet[2],
                         mt_curvature curvature, curvature_sum *sum, mt_lagrangian *out)
{
    for (int side = 0; side < 2; side++) {
        const mt_cx force = 0.5 * cx_mul(k, stretch[1 - side]);
        add_gradient(sys, body, &jet[side], force, out, out->g);
        note_force(sys, out, body, &jet[side], force);
        if (curvature != MT_CURVATURE_NONE) {
            curvature_add(sum, body, &jet[side], &jet[1 - side],
                          curvature == MT_CURVATURE_ELASTIC ? 0.0 : force,
                          curvature == MT_CURVATURE_GEOMETRIC ? 0.0 : 0.5 * k);
        }
    }
}

/* Returns the spring's force. The elongation `way` of the remaining step is added separately,
 * because it would be lost to rounding in a large stretch that the preload almost cancels. */
static mt_cx add_spring_force(const mt_data *d, int i, mt_cx stretch, double way,
                              const mt_relative_jet *jet, mt_curvature curvature,
                              curvature_sum *sum, mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    const mt_spring_def *const s = &sys->springs[i];
    const int *const body = sys->measures[s->measure[0]].body;
    const int trim = mt_system_trim_of(sys, i);
    const bool trimmed = trim >= 0;
    const mt_cx k = mt_data_scalar(d, s->stiffness, 0.0);
    mt_cx force = cx_mul(k, stretch) + mt_data_scalar(d, s->preload, 0.0) + (way * k);
    if (trimmed) {
        force = cx_make(out->trim_force.of[trim], out->trim_force_derivative.of[trim]);
        add_gradient(sys, body, jet, 1.0, out, out->trim + ((ptrdiff_t)trim * sys->nq));
    }
    add_gradient(sys, body, jet, force, out, out->g);
    note_force(sys, out, body, jet, force);
    if (curvature != MT_CURVATURE_NONE) {
        /* while the force of the trimmed spring is an unknown its stiffness does not act; in
         * the linearised system it does, there as a row (rows.h) */
        const bool geometric = curvature == MT_CURVATURE_GEOMETRIC || trimmed;
        curvature_add(sum, body, jet, jet, curvature == MT_CURVATURE_ELASTIC ? 0.0 : force,
                      geometric ? 0.0 : k);
    }
    return force;
}

/* state: stretch and force. */
static void note_spring(const mt_data *d, int i, int side, const mt_pose *poses,
                        const mt_relative_jet *jet, const double state[2], mt_lagrangian *out)
{
    const double force = state[1];
    const mt_spring_def *const s = &d->sys->springs[i];
    const mt_measure_def *const def = &d->sys->measures[s->measure[side]];
    const bool coupling = s->measure[0] != s->measure[1];
    const int other = coupling ? 1 - side : side;
    const double k = creal(mt_data_scalar(d, s->stiffness, 0.0));
    mt_piece *const piece = note_terms(d, def, poses, jet, fabs(force), fabs(force), out);
    if (piece != NULL) {
        piece->spring = i;
        piece->side = side;
        piece->stretch = state[0];
        piece->force = force;
        piece->stiffness = coupling ? 0.5 * k : k;
        piece->partner = other - side;
        piece->trim = mt_system_trim_of(d->sys, i);
        piece->roundness *=
            s->free == MT_NO_NODE && piece_is_still(def, poses, out->rest) ? 0.0 : 1.0;
    }
}

/* True of a spring without stiffness and preload, now and as its input changes: a direction in
 * which a bushing is free. */
static bool is_forceless(const mt_data *d, int i)
{
    const mt_spring_def *const s = &d->sys->springs[i];
    const mt_cx k = mt_data_scalar(d, s->stiffness, 0.0);
    const mt_cx force = mt_data_scalar(d, s->preload, 0.0);
    return mt_system_trim_of(d->sys, i) < 0 && creal(k) == 0.0 && cimag(k) == 0.0 &&
           creal(force) == 0.0 && cimag(force) == 0.0;
}

/* True where that may differ at another design: it counts where forces are told one by one. */
static bool may_push(const mt_system *sys, int i)
{
    const mt_node nodes[] = {sys->springs[i].stiffness, sys->springs[i].preload};
    bool varies = false;
    for (int k = 0; k < 2; k++) {
        varies = varies || (nodes[k] != MT_NO_NODE && sys->program.active[nodes[k]]);
    }
    return varies;
}

static bool is_left_out(const mt_data *d, int i, const mt_lagrangian *out)
{
    const bool told = out->terms != NULL && may_push(d->sys, i);
    return d->sys->springs[i].damper || (is_forceless(d, i) && !told);
}

/* Change of a measure along the remaining step. */
static double along_left(const mt_system *sys, const int body[2], const mt_relative_jet *jet,
                         const double *left)
{
    double sum = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, body, k);
        const double g = mt_relative_sign(k) * creal(jet->g[mt_relative_of(k)]);
        sum += dof >= 0 ? g * left[dof] : 0.0;
    }
    return sum;
}

/* True of a spring without force as its bodies stand where they were drawn: it has no
 * geometric stiffness. */
static bool is_unstrained(const mt_data *d, int i, const mt_placement *at,
                          const mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    const mt_spring_def *const s = &sys->springs[i];
    bool still = out->rest != NULL && out->terms == NULL && !out->slope &&
                 mt_system_trim_of(sys, i) < 0 && s->free == MT_NO_NODE &&
                 creal(mt_data_scalar(d, s->preload, 0.0)) == 0.0;
    for (int side = 0; side < 2 && still; side++) {
        still = at->turn[s->measure[side]] == 0.0 &&
                piece_is_still(&sys->measures[s->measure[side]], at->pose, out->rest);
    }
    return still;
}

/* The jets of one or two measures, consecutive. */
static const mt_relative_jet *spring_jets(const mt_data *d, int i, const mt_placement *at,
                                          bool second, mt_beam_parts *parts,
                                          const mt_lagrangian *l, mt_relative_jet own[2])
{
    const mt_spring_def *const s = &d->sys->springs[i];
    const mt_measure_def *const def = d->sys->measures;
    const mt_relative_jet *const first =
        jet_at(d, &def[s->measure[0]], at, second, 2 * i, parts, l, &own[0]);
    if (s->measure[1] != s->measure[0]) {
        (void)jet_at(d, &def[s->measure[1]], at, second, (2 * i) + 1, parts, l, &own[1]);
    }
    return first;
}

static void add_springs(const mt_data *d, const mt_placement *at, mt_curvature curvature,
                        mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    const bool bends = curvature == MT_CURVATURE_FULL || curvature == MT_CURVATURE_GEOMETRIC;
    mt_relative_jet own[2];
    mt_beam_parts parts;
    curvature_sum sum;
    parts.dir = NULL;
    curvature_begin(&sum, sys, out);
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const mt_measure_def *const first = &sys->measures[s->measure[0]];
        const bool coupling = s->measure[0] != s->measure[1];
        mt_cx stretch[2] = {0.0, 0.0};
        double way[2] = {0.0, 0.0};
        if (is_left_out(d, i, out)) {
            continue;
        }
        const bool second = bends && !is_unstrained(d, i, at, out);
        const mt_relative_jet *const jet = spring_jets(d, i, at, second, &parts, out, own);
        for (int side = 0; side < (coupling ? 2 : 1); side++) {
            const mt_measure_def *const def = &sys->measures[s->measure[side]];
            if (out->left != NULL) {
                way[side] = along_left(sys, def->body, &jet[side], out->left);
            }
            stretch[side] = jet[side].value - d->rest[i][side];
        }
        const mt_cx k = mt_data_scalar(d, s->stiffness, 0.0);
        note_noise(d, first, at->pose, &jet[0], creal(k), out);
        mt_cx force[2] = {0.0, 0.0};
        if (coupling) {
            stretch[0] += way[0];
            stretch[1] += way[1];
            force[0] = 0.5 * cx_mul(k, stretch[1]);
            force[1] = 0.5 * cx_mul(k, stretch[0]);
            add_coupling(sys, first->body, k, stretch, jet, curvature, &sum, out);
        } else {
            force[0] = add_spring_force(d, i, stretch[0], way[0], jet, curvature, &sum, out);
        }
        for (int side = 0; side < (coupling ? 2 : 1); side++) {
            const double state[2] = {creal(stretch[side]) + (coupling ? 0.0 : way[side]),
                                     creal(force[side])};
            note_spring(d, i, side, at->pose, &jet[side], state, out);
        }
    }
    curvature_flush(&sum);
}

/* Jet of the measure of a load, F . x or its own measure; *size: its factor. */
static void load_jet(const mt_data *d, const mt_load_def *load, const mt_placement *at,
                     bool hessian, int body[2], mt_cx *size, mt_relative_jet *jet)
{
    const mt_system *const sys = d->sys;
    if (load->measure >= 0) {
        const mt_measure_def *const def = &sys->measures[load->measure];
        body[0] = def->body[0];
        body[1] = def->body[1];
        *size = mt_data_scalar(d, load->size, 0.0);
        mt_data_relative(d, def, at, hessian, NULL, jet);
        return;
    }
    mt_cx f[3];
    for (int k = 0; k < 3; k++) {
        f[k] = mt_data_scalar(d, load->force[k], 0.0);
    }
    body[0] = load->body;
    body[1] = MT_GROUND;
    *size = 1.0;
    mt_measure_relative_point(load->point < 0 ? NULL : d->vec[load->point], f,
                              &at->pose[load->body], hessian, jet);
}

/* A force at the centre of a body has no arm, and its energy no curvature. */
static void note_load(const mt_data *d, const mt_load_def *load, const mt_pose *poses,
                      const mt_relative_jet *jet, mt_cx size, mt_lagrangian *out)
{
    const mt_measure_def point = {.kind = MT_MEASURE_PLANE, .body = {load->body, MT_GROUND}};
    mt_piece *piece = NULL;
    if (load->measure >= 0) {
        const double force = fabs(creal(size));
        piece = note_terms(d, &d->sys->measures[load->measure], poses, jet, force, force, out);
    } else if (load->point >= 0) { /* the jet has the force in it */
        piece = note_terms(d, &point, poses, jet, 1.0, largest_push(d->sys, jet), out);
    }
    if (piece != NULL) {
        piece->force = -creal(size);
        piece->load = (int)(load - d->sys->loads);
        piece->def = load->measure >= 0 ? piece->def : NULL;
    }
}

static void add_loads(const mt_data *d, const mt_placement *at, bool hessian,
                      mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    mt_relative_jet jet;
    curvature_sum sum;
    curvature_begin(&sum, sys, out);
    for (int i = 0; i < sys->n_loads; i++) {
        int body[2];
        mt_cx size = 0.0;
        const bool bends = hessian && (sys->loads[i].measure >= 0 || sys->loads[i].point >= 0);
        load_jet(d, &sys->loads[i], at, bends, body, &size, &jet);
        add_gradient(sys, body, &jet, -size, out, out->g);
        note_force(sys, out, body, &jet, size);
        if (bends) { /* a force at a centre does not */
            curvature_add(&sum, body, &jet, &jet, -size, 0.0);
            note_load(d, &sys->loads[i], at->pose, &jet, size, out);
        }
    }
    curvature_flush(&sum);
}

/*
 * l^2, which weighs a rotation against a displacement in the anchor: the mean square of the
 * arms by which joints hold their bodies, so that a rotation counts as what it moves them by.
 * It scales with the drawing, and is a function of the present design alone, with a derivative:
 * with the size of the original design (length_m), where a loop closes would depend on which
 * design was called original, and a model with the recommended values put in would not be the
 * design that was recommended. Where no joint has an arm rotations close nothing, and any
 * length will do.
 */
static mt_cx anchor_square(const mt_data *d)
{
    const mt_system *const sys = d->sys;
    const int count = sys->n_constraints - sys->n_drives; /* a drive is no joint */
    mt_cx sum = 0.0;
    int arms = 0;
    for (int i = 0; i < count; i++) {
        for (int t = 0; t < sys->constraints[i].terms; t++) {
            const mt_measure_def *const m = &sys->measures[sys->constraints[i].measure[t]];
            for (int side = 0; side < 2; side++) {
                if (m->body[side] != MT_GROUND && m->point[side] >= 0) {
                    const mt_cx *const arm = d->vec[m->point[side]];
                    sum += cx_dot3(arm, arm);
                    arms++;
                }
            }
        }
    }
    return creal(sum) > 0.0 ? sum / (double)arms : sys->length_m * sys->length_m;
}

static void add_anchor(const mt_data *d, const mt_pose *drawn, const mt_pose *poses,
                       bool hessian, mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    const mt_cx l2 = anchor_square(d);
    mt_relative_jet jet;
    curvature_sum sum;
    curvature_begin(&sum, sys, out);
    for (int i = 0; i < sys->n_bodies; i++) {
        const int body[2] = {MT_GROUND, i};
        const mt_pose *const anchor = &drawn[i];
        const int *const dof = sys->bodies[i].dof;
        for (int k = 0; k < 3; k++) {
            if (dof[k] >= 0) {
                out->g[dof[k]] += value_or_derivative(out, poses[i].x[k] - drawn[i].x[k]);
                if (hessian) {
                    curvature_add_entry(out, sys->nq, dof[k], dof[k],
                                        value_or_derivative(out, 1.0));
                }
            }
            /* -l^2/2 tr(R0^T R) */
            mt_cx e[3] = {0.0, 0.0, 0.0};
            e[k] = 1.0;
            const mt_measure_data m = {
                .kind = MT_MEASURE_DOT, .dir = {e, e, NULL}, .plane = sys->dimension == 2};
            mt_measure_relative(&m, anchor, &poses[i], hessian, NULL, &jet);
            add_gradient(sys, body, &jet, -0.5 * l2, out, out->g);
            if (hessian) {
                curvature_add(&sum, body, &jet, &jet, -0.5 * l2, 0.0);
            }
        }
    }
    curvature_flush(&sum);
}

/* All multipliers, before the first of them is used. */
static void push_joints(const mt_data *d, int m, const mt_cx *lambda, mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    for (int i = 0; i < m && out->push != NULL; i++) {
        for (int t = 0; t < sys->constraints[i].terms; t++) {
            const mt_measure_def *const def = &sys->measures[sys->constraints[i].measure[t]];
            const mt_cx factor = mt_data_scalar(d, sys->constraints[i].coefficient[t], 1.0);
            const double arm = piece_is_angle(def) ? sys->length_m : 1.0;
            note_push(def->body, fabs(creal(factor) * creal(lambda[i])) / arm, out);
        }
    }
}

/* Forces that meet in a body are known to eps of the largest of them: so is a joint's force,
 * however small it is itself. */
static mt_piece *note_joint(const mt_data *d, const mt_measure_def *def, const mt_pose *poses,
                            const mt_relative_jet *jet, mt_cx force, mt_lagrangian *out)
{
    const double arm = piece_is_angle(def) ? d->sys->length_m : 1.0;
    double push = 0.0;
    for (int side = 0; side < 2 && out->terms != NULL; side++) {
        const int body = def->body[side];
        push = body == MT_GROUND ? push : fmax(push, out->push[body]);
    }
    const double size = fabs(creal(force)) + (arm * push);
    return note_terms(d, def, poses, jet, size, size, out);
}

static void add_to_row(mt_sparse_row *row, int dof, double a)
{
    int at = 0;
    while (at < row->n && row->dof[at] != dof) {
        at++;
    }
    row->n = at < row->n ? row->n : at + 1;
    row->dof[at] = dof;
    row->a[at] += a;
}

/* second: what bends is asked for next. */
static void add_constraints(const mt_data *d, const mt_placement *at, int m, bool second,
                            mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    mt_relative_jet own;
    int number = 2 * sys->n_springs;
    for (int i = 0; i < m; i++) {
        const mt_constraint_def *const c = &sys->constraints[i];
        mt_cx value = -mt_data_target(d, i, at);
        for (int t = 0; t < c->terms; t++) {
            const mt_measure_def *const def = &sys->measures[c->measure[t]];
            const mt_cx factor = mt_data_scalar(d, c->coefficient[t], 1.0);
            const mt_relative_jet *const jet =
                jet_at(d, def, at, second, number++, NULL, out, &own);
            value += cx_mul(factor, jet->value);
            for (int k = 0; k < MT_LOCAL; k++) {
                const int dof = mt_local_dof(sys, def->body, k);
                if (dof < 0) {
                    continue;
                }
                const double a =
                    mt_relative_sign(k) *
                    value_or_derivative(out, cx_mul(factor, jet->g[mt_relative_of(k)]));
                if (out->a != NULL) {
                    out->a[i + ((ptrdiff_t)dof * m)] += a;
                }
                if (out->row != NULL) {
                    add_to_row(&out->row[i], dof, a);
                }
            }
        }
        out->c[i] = value_or_derivative(out, value - mt_constraint_turns(d, i, creal(value)));
    }
}

void mt_lagrangian_curve(const mt_data *d, const mt_placement *at, int m, const mt_cx *lambda,
                         mt_lagrangian *out)
{
    const mt_system *const sys = d->sys;
    mt_relative_jet own;
    curvature_sum sum;
    int number = 2 * sys->n_springs;
    curvature_begin(&sum, sys, out);
    push_joints(d, m, lambda, out);
    for (int i = 0; i < m; i++) {
        const mt_constraint_def *const c = &sys->constraints[i];
        for (int t = 0; t < c->terms; t++) {
            const mt_measure_def *const def = &sys->measures[c->measure[t]];
            const mt_cx factor = mt_data_scalar(d, c->coefficient[t], 1.0);
            const mt_cx force = cx_mul(factor, lambda[i]);
            const mt_relative_jet *const jet =
                jet_at(d, def, at, true, number++, NULL, out, &own);
            curvature_add(&sum, def->body, jet, jet, force, 0.0);
            mt_piece *const piece = note_joint(d, def, at->pose, jet, force, out);
            if (piece != NULL) {
                piece->force = creal(force);
                piece->equation = i;
                piece->roundness *=
                    sys->drawn_closed && piece_is_still(def, at->pose, out->rest) ? 0.0 : 1.0;
                piece->factor = creal(factor);
            }
        }
    }
    curvature_flush(&sum);
}

void mt_lagrangian_eval(const mt_data *d, mt_energy energy, const mt_pose *drawn,
                        const mt_placement *at, int m, const mt_cx *lambda,
                        mt_curvature curvature, mt_lagrangian *out)
{
    const bool hessian = curvature != MT_CURVATURE_NONE;
    const bool bends = hessian && curvature != MT_CURVATURE_ELASTIC;
    const size_t nq = (size_t)d->sys->nq;
    memset(out->g, 0, nq * sizeof *out->g);
    memset(out->trim, 0, (size_t)d->sys->n_trims * nq * sizeof *out->trim);
    if (out->a != NULL) {
        memset(out->a, 0, (size_t)m * nq * sizeof *out->a);
    }
    if (out->row != NULL) {
        memset(out->row, 0, (size_t)m * sizeof *out->row);
    }
    if (hessian) {
        const size_t entries = out->layout == NULL ? nq * nq : out->layout->envelope.count;
        memset(out->h, 0, entries * sizeof *out->h);
    }
    if (out->push != NULL) {
        memset(out->push, 0, (size_t)d->sys->n_bodies * sizeof *out->push);
    }
    keep_jets_at(d, at, out);
    out->force_scale = 0.0;
    out->n_pieces = 0;
    out->force_noise = 0.0;
    if (energy == MT_ENERGY_PHYSICAL) {
        add_springs(d, at, curvature, out);
        add_loads(d, at, bends, out);
    } else if (energy == MT_ENERGY_ANCHOR) {
        add_anchor(d, drawn, at->pose, hessian, out);
    }
    add_constraints(d, at, m, bends && keeps_jets(out), out);
    if (hessian && lambda != NULL) {
        mt_lagrangian_curve(d, at, m, lambda, out);
    }
}

double mt_energy_value(const mt_data *d, const mt_placement *at, const mt_trim_forces *forces,
                       const mt_jets *jets)
{
    const bool kept = jets != NULL && jets->pose != NULL && are_jets_of(d, at, jets);
    const mt_system *const sys = d->sys;
    double v = 0.0;
    mt_beam_parts parts;
    parts.dir = NULL;
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        double stretch[2] = {0.0, 0.0};
        if (s->damper || is_forceless(d, i)) {
            continue;
        }
        for (int side = 0; side < 2; side++) {
            const mt_measure_def *const def = &sys->measures[s->measure[side]];
            const int number = (2 * i) + side;
            if (side == 1 && s->measure[0] == s->measure[1]) {
                stretch[1] = stretch[0];
            } else {
                const mt_cx value = kept && jets->known[number]
                                        ? jets->jet[number].value
                                        : mt_data_value(d, def, at, &parts);
                stretch[side] = creal(value) - creal(d->rest[i][side]);
            }
        }
        const int trim = mt_system_trim_of(sys, i);
        if (trim >= 0) {
            v += (forces != NULL ? forces->of[trim] : 0.0) * stretch[0];
            continue;
        }
        v += 0.5 * creal(mt_data_scalar(d, s->stiffness, 0.0)) * stretch[0] * stretch[1];
        v += creal(mt_data_scalar(d, s->preload, 0.0)) * stretch[0];
    }
    for (int i = 0; i < sys->n_loads; i++) {
        mt_relative_jet jet;
        int body[2];
        mt_cx size = 0.0;
        load_jet(d, &sys->loads[i], at, false, body, &size, &jet);
        v -= creal(size) * creal(jet.value);
    }
    return v;
}
