/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What moves between the nodes of a beam element, in the frame of its chord (length l, as it is
 * now): e1 along the chord, e2 and e3 halfway between those of the two nodes. In one plane of
 * bending, with the nodes' deflections w_A, w_B and the rotations t_A, t_B of their sections,
 * and
 *     psi = (w_B - w_A)/l,   kappa = t_B - t_A,   s = t_A + t_B - 2 psi,   mu = 1/(1 + Phi)
 *         (1: Euler-Bernoulli),
 * the static solution is, in Legendre polynomials of y = 2 x/l - 1,
 *     w     = [(w_A + w_B)/2 - l kappa/12] P0 + l [psi/2 - mu s/20] P1 + l kappa/12 P2 + l mu
 *         s/20 P3
 *     theta = [psi + (1 - mu) s/2] P0 + kappa/2 P1 + mu s/2 P2,
 * and because the integral of P_i P_j over the element is l/(2 i + 1) for i = j, else 0, the
 * consistent masses m/l int w^2 and J/l int theta^2 are sums of squares of these brackets over
 * sqrt(2 i + 1). (mu = 1: Archer's 1/420 [156 22 54 -13; ...].) A bar's, linear, is one of two
 * squares.
 */
#include "mechanics/rows.h"

#include <math.h>
#include <string.h>

#include "mechanics/lagrangian.h"

static void row_add_point(mt_cx *row, int side, const mt_cx *s, const mt_cx *e, mt_cx scale);
static void row_add_turn(mt_cx *row, int side, const mt_cx *e, mt_cx scale);

static const mt_cx CENTRE[3] = {0.0, 0.0, 0.0};

void mt_beam_frame(const mt_data *d, const int body[2], const int dir[3], const mt_pose *poses,
                   mt_beam_geometry *out)
{
    const mt_pose *const a = mt_pose_of(poses, body[0]);
    const mt_pose *const b = mt_pose_of(poses, body[1]);
    mt_cx half[2][3];
    cx_rotate3(a->r, d->vec[dir[1]], half[0]);
    cx_rotate3(b->r, d->vec[dir[1]], half[1]);
    mt_cx *const e1 = out->e[0];
    mt_cx *const e2 = out->e[1];
    for (int i = 0; i < 3; i++) {
        e1[i] = b->x[i] - a->x[i];
        e2[i] = half[0][i] + half[1][i];
    }
    out->length = cx_norm3(e1);
    cx_unit3(e1);
    const mt_cx along = cx_dot3(e1, e2);
    for (int i = 0; i < 3; i++) {
        e2[i] -= cx_mul(along, e1[i]);
    }
    cx_unit3(e2);
    cx_cross3(e1, e2, out->e[2]);
    for (int k = 0; k < 2; k++) {
        out->shape[k] = 1.0;
    }
}

/* row += w_A by[0] + l t_A by[1] + w_B by[2] + l t_B by[3], in the plane of bending about e2 (k
 * = 0: deflection along e3, t = -theta2) or e3 (k = 1). */
static void add_plane(mt_cx *row, const mt_beam_geometry *g, int k, const mt_cx by[4])
{
    const mt_cx *const u = g->e[k == 0 ? 2 : 1];
    const mt_cx *const t = g->e[1 + k];
    const double sign = k == 0 ? -1.0 : 1.0;
    for (int side = 0; side < 2; side++) {
        const mt_cx *const own = side == 0 ? by : by + 2;
        row_add_point(row, side, CENTRE, u, own[0]);
        row_add_turn(row, side, t, sign * cx_mul(g->length, own[1]));
    }
}

/* by += scale (l kappa), by += scale (l s). */
static void add_kappa(mt_cx by[4], mt_cx scale)
{
    by[1] -= scale;
    by[3] += scale;
}

static void add_sway(mt_cx by[4], mt_cx scale)
{
    by[0] += 2.0 * scale;
    by[1] += scale;
    by[2] -= 2.0 * scale;
    by[3] += scale;
}

/* Consistent mass of bending about e2 (k = 0) or e3 (k = 1), of unit mass:
 * rows[MT_DEFLECTION_ROWS]. */
static void beam_deflection_rows(const mt_beam_geometry *g, int k, mt_cx *rows)
{
    const mt_cx mu = g->shape[k];
    mt_cx by[MT_DEFLECTION_ROWS][4] = {{0.5, 0.0, 0.5, 0.0}, {-0.5, 0.0, 0.5, 0.0}};
    add_kappa(by[0], -1.0 / 12.0);
    add_sway(by[1], -mu / 20.0);
    add_kappa(by[2], 1.0 / 12.0);
    add_sway(by[3], mu / 20.0);
    for (int i = 0; i < MT_DEFLECTION_ROWS; i++) {
        for (int j = 0; j < 4; j++) {
            by[i][j] /= sqrt((2.0 * i) + 1.0);
        }
        add_plane(rows + ((ptrdiff_t)i * MT_LOCAL), g, k, by[i]);
    }
}

/* The same for the rotation of the sections in bending, of unit moment of inertia:
 * rows[MT_ROTARY_ROWS]. */
static void beam_rotary_rows(const mt_beam_geometry *g, int k, mt_cx *rows)
{
    const mt_cx mu = g->shape[k];
    mt_cx by[MT_ROTARY_ROWS][4] = {{-1.0, 0.0, 1.0, 0.0}};
    add_sway(by[0], 0.5 * (1.0 - mu));
    add_kappa(by[1], 0.5);
    add_sway(by[2], 0.5 * mu);
    for (int i = 0; i < MT_ROTARY_ROWS; i++) {
        for (int j = 0; j < 4; j++) {
            by[i][j] = cx_div(by[i][j], g->length) / sqrt((2.0 * i) + 1.0);
        }
        add_plane(rows + ((ptrdiff_t)i * MT_LOCAL), g, k, by[i]);
    }
}

/* The same for displacement along, or rotation about, e1: rows[MT_BAR_ROWS]. */
static void beam_bar_rows(const mt_beam_geometry *g, bool turn, mt_cx *rows)
{
    for (int i = 0; i < MT_BAR_ROWS; i++) {
        mt_cx *const row = rows + ((ptrdiff_t)i * MT_LOCAL);
        for (int side = 0; side < 2; side++) {
            const double by = i == 0 ? 0.5 : (side == 0 ? -0.5 : 0.5) / sqrt(3.0);
            if (turn) {
                row_add_turn(row, side, g->e[0], by);
            } else {
                row_add_point(row, side, CENTRE, g->e[0], by);
            }
        }
    }
}

/* row += weight * deflection, or rotation of the section (theta3; for k = 0 -theta2), at the
 * fraction x of the element. */
static void beam_deflection_at(const mt_beam_geometry *g, int k, mt_cx x, mt_cx weight,
                               mt_cx *row)
{
    const mt_cx bow = cx_mul(x, x) - x;
    const mt_cx wave = -cx_mul(bow, 1.0 - (2.0 * x));
    mt_cx by[4] = {1.0 - x, 0.0, x, 0.0};
    add_kappa(by, 0.5 * bow);
    add_sway(by, 0.5 * cx_mul(g->shape[k], wave));
    for (int j = 0; j < 4; j++) {
        by[j] = cx_mul(weight, by[j]);
    }
    add_plane(row, g, k, by);
}

static void beam_slope_at(const mt_beam_geometry *g, int k, mt_cx x, mt_cx weight, mt_cx *row)
{
    const mt_cx mu = g->shape[k];
    const mt_cx p2 = 1.0 + (6.0 * (cx_mul(x, x) - x));
    mt_cx by[4] = {-1.0, 0.0, 1.0, 0.0};
    add_kappa(by, x - 0.5);
    add_sway(by, 0.5 * (cx_mul(mu, p2) + 1.0 - mu));
    for (int j = 0; j < 4; j++) {
        by[j] = cx_div(cx_mul(weight, by[j]), g->length);
    }
    add_plane(row, g, k, by);
}

/*
 * Consistent masses are factored once, M = C C^T, so that they too are sums of squares of rows
 * (C^T v): a bar's is [1/3 1/6; 1/6 1/3] per direction on (v_a, v_b), times its mass; a beam's
 * stands above. Displacement of a point s from the centre: dx + theta x s.
 */

static int inertia_rows(const mt_system *sys, const mt_inertia_def *def)
{
    switch (def->kind) {
    case MT_INERTIA_TRANSLATION:
        return sys->dimension;
    case MT_INERTIA_ROTATION:
        return def->dir[0] == def->dir[1] ? 1 : 2;
    case MT_INERTIA_BAR:
        return MT_BAR_ROWS * sys->dimension;
    case MT_INERTIA_BEAM:
        return MT_BAR_ROWS + ((sys->dimension - 1) * MT_DEFLECTION_ROWS);
    case MT_INERTIA_BEAM_TWIST:
        return MT_BAR_ROWS;
    case MT_INERTIA_BEAM_ROTARY:
        return MT_ROTARY_ROWS;
    }
    return 0;
}

static void append_term(mt_term_list *list, const mt_program *p, mt_term term)
{
    term.first = list->n_rows;
    term.varies =
        term.coefficient != MT_NO_NODE && !mt_program_is_constant(p, term.coefficient);
    for (int i = 0; i < term.count; i++) {
        list->row_term[list->n_rows++] = list->n_terms;
    }
    list->terms[list->n_terms++] = term;
}

/* Number of terms and rows of each kind. */
static void count_terms(const mt_system *sys, int terms[MT_TERM_KINDS], int rows[MT_TERM_KINDS])
{
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const int kind = s->damper ? MT_TERM_DAMPING : MT_TERM_STIFFNESS;
        terms[kind]++;
        rows[kind] += s->measure[0] != s->measure[1] ? 2 : 1;
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        terms[MT_TERM_MASS]++;
        rows[MT_TERM_MASS] += inertia_rows(sys, &sys->inertias[i]);
    }
    terms[MT_TERM_CHANNEL] = sys->n_channels;
    rows[MT_TERM_CHANNEL] = sys->n_channels;
}

mt_term mt_term_of_inertia(const mt_system *sys, int i)
{
    const mt_inertia_def *const def = &sys->inertias[i];
    return (mt_term){.coefficient = def->coefficient,
                     .loss = MT_NO_NODE,
                     .count = inertia_rows(sys, def),
                     .pair = def->kind == MT_INERTIA_ROTATION && def->dir[0] != def->dir[1],
                     .body = {def->body[0], def->body[1]},
                     .source = i};
}

mt_status mt_terms_new(const mt_system *sys, mt_arena *mem, mt_term_list *lists, mt_err *err)
{
    const mt_program *const p = &sys->program;
    int terms[MT_TERM_KINDS] = {0};
    int rows[MT_TERM_KINDS] = {0};
    count_terms(sys, terms, rows);
    for (int k = 0; k < MT_TERM_KINDS; k++) {
        lists[k] = (mt_term_list){0};
        lists[k].terms = mt_arena_alloc(mem, (size_t)terms[k], sizeof(mt_term));
        lists[k].row_term = mt_arena_int(mem, (size_t)rows[k]);
    }
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < sys->n_springs; i++) {
        const mt_spring_def *const s = &sys->springs[i];
        const mt_measure_def *const m = &sys->measures[s->measure[0]];
        const bool pair = s->measure[0] != s->measure[1];
        append_term(&lists[s->damper ? MT_TERM_DAMPING : MT_TERM_STIFFNESS], p,
                    (mt_term){.coefficient = s->stiffness,
                              .loss = s->damper ? MT_NO_NODE : s->loss,
                              .count = pair ? 2 : 1,
                              .pair = pair,
                              .body = {m->body[0], m->body[1]},
                              .source = i});
    }
    for (int i = 0; i < sys->n_inertias; i++) {
        append_term(&lists[MT_TERM_MASS], p, mt_term_of_inertia(sys, i));
    }
    for (int i = 0; i < sys->n_channels; i++) {
        append_term(&lists[MT_TERM_CHANNEL], p,
                    (mt_term){.coefficient = MT_NO_NODE,
                              .loss = MT_NO_NODE,
                              .count = 1,
                              .body = {sys->channels[i].body[0], sys->channels[i].body[1]},
                              .source = i});
    }
    return MT_OK;
}

/* Boyer and Moore's vote. */
double mt_terms_common_loss(const mt_data *d, const mt_term_list *list)
{
    double most = 0.0;
    int votes = 0;
    for (int i = 0; i < list->n_terms; i++) {
        const double own = creal(mt_data_scalar(d, list->terms[i].loss, 0.0));
        most = votes == 0 ? own : most;
        votes += own == most ? 1 : -1;
    }
    return most;
}

/* row += scale * displacement along unit vector e of the point s from the centre, in the local
 * freedoms of side 0 or 1; the same for the rotation about e. */
static void row_add_point(mt_cx *row, int side, const mt_cx *s, const mt_cx *e, mt_cx scale)
{
    mt_cx n[3];
    cx_cross3(s, e, n);
    for (int k = 0; k < 3; k++) {
        row[(6 * side) + k] += cx_mul(scale, e[k]);
        row[(6 * side) + 3 + k] += cx_mul(scale, n[k]);
    }
}

static void row_add_turn(mt_cx *row, int side, const mt_cx *e, mt_cx scale)
{
    for (int k = 0; k < 3; k++) {
        row[(6 * side) + 3 + k] += cx_mul(scale, e[k]);
    }
}

static void spring_rows(const mt_data *d, const mt_spring_def *s, const mt_pose *poses,
                        mt_cx *rows)
{
    const int count = s->measure[0] == s->measure[1] ? 1 : 2;
    mt_jet jet;
    for (int i = 0; i < count; i++) {
        const mt_measure_def *const def = &d->sys->measures[s->measure[i]];
        const mt_measure_data m = mt_data_measure(d, def);
        mt_measure_eval(&m, mt_pose_of(poses, def->body[0]), mt_pose_of(poses, def->body[1]),
                        false, NULL, &jet);
        memcpy(rows + ((ptrdiff_t)i * MT_LOCAL), jet.g, sizeof jet.g);
    }
}

static const double ONE_THIRD_ROOT = 0.57735026918962576451; /* sqrt(1/3) */

/* (v_a + v_b/2)/sqrt 3 and v_b/2: their squares sum to (v_a^2 + v_a v_b + v_b^2)/3. */
static void bar_rows(const mt_data *d, const mt_inertia_def *def, const mt_pose *poses,
                     mt_cx *rows)
{
    mt_cx s[2][3];
    static const mt_cx zero[3] = {0.0, 0.0, 0.0};
    for (int side = 0; side < 2; side++) {
        cx_rotate3(mt_pose_of(poses, def->body[side])->r,
                   def->point[side] < 0 ? zero : d->vec[def->point[side]], s[side]);
    }
    for (int k = 0; k < d->sys->dimension; k++) {
        mt_cx e[3] = {0.0, 0.0, 0.0};
        mt_cx *const first = rows + ((ptrdiff_t)(2 * k) * MT_LOCAL);
        e[k] = 1.0;
        row_add_point(first, 0, s[0], e, ONE_THIRD_ROOT);
        row_add_point(first, 1, s[1], e, 0.5 * ONE_THIRD_ROOT);
        row_add_point(first + MT_LOCAL, 1, s[1], e, 0.5);
    }
}

static void shape_of(const mt_data *d, const mt_node shape[2], mt_beam_geometry *g)
{
    for (int k = 0; k < 2; k++) {
        g->shape[k] = mt_data_scalar(d, shape[k], 1.0);
    }
}

static void beam_rows(const mt_data *d, const mt_inertia_def *def, const mt_pose *poses,
                      mt_cx *rows)
{
    mt_beam_geometry g = {.shape = {1.0, 1.0}};
    mt_beam_frame(d, def->body, def->dir, poses, &g);
    shape_of(d, def->shape, &g);
    if (def->kind == MT_INERTIA_BEAM_TWIST) {
        beam_bar_rows(&g, true, rows);
        return;
    }
    if (def->kind == MT_INERTIA_BEAM_ROTARY) {
        beam_rotary_rows(&g, def->bending, rows);
        return;
    }
    beam_bar_rows(&g, false, rows);
    mt_cx *at = rows + ((ptrdiff_t)MT_BAR_ROWS * MT_LOCAL);
    for (int k = d->sys->dimension == 3 ? 0 : 1; k < 2; k++) {
        beam_deflection_rows(&g, k, at);
        at += (ptrdiff_t)MT_DEFLECTION_ROWS * MT_LOCAL;
    }
}

static void inertia_eval(const mt_data *d, const mt_inertia_def *def, const mt_pose *poses,
                         mt_cx *rows)
{
    static const mt_cx zero[3] = {0.0, 0.0, 0.0};
    mt_cx e[3] = {0.0, 0.0, 0.0};
    switch (def->kind) {
    case MT_INERTIA_TRANSLATION:
        for (int k = 0; k < d->sys->dimension; k++) {
            memset(e, 0, sizeof e);
            e[k] = 1.0;
            row_add_point(rows + ((ptrdiff_t)k * MT_LOCAL), 0, zero, e, 1.0);
        }
        break;
    case MT_INERTIA_ROTATION:
        for (int k = 0; k < (def->dir[0] == def->dir[1] ? 1 : 2); k++) {
            cx_rotate3(poses[def->body[0]].r, d->vec[def->dir[k]], e);
            row_add_turn(rows + ((ptrdiff_t)k * MT_LOCAL), 0, e, 1.0);
        }
        break;
    case MT_INERTIA_BAR:
        bar_rows(d, def, poses, rows);
        break;
    case MT_INERTIA_BEAM:
    case MT_INERTIA_BEAM_TWIST:
    case MT_INERTIA_BEAM_ROTARY:
        beam_rows(d, def, poses, rows);
        break;
    }
}

static void beam_channel(const mt_data *d, const mt_channel_def *c, const mt_pose *poses,
                         mt_cx *row)
{
    static const mt_cx zero[3] = {0.0, 0.0, 0.0};
    const mt_cx x = mt_data_scalar(d, c->fraction, 0.0);
    mt_beam_geometry g = {.shape = {1.0, 1.0}};
    mt_beam_frame(d, c->body, c->dir, poses, &g);
    shape_of(d, c->shape, &g);
    for (int side = 0; side < 2; side++) {
        const mt_cx share = cx_mul(side == 0 ? 1.0 - x : x, g.e[0][c->axis]);
        if (c->kind == MT_CHANNEL_BEAM_POINT) {
            row_add_point(row, side, zero, g.e[0], share);
        } else {
            row_add_turn(row, side, g.e[0], share);
        }
    }
    if (c->kind == MT_CHANNEL_BEAM_POINT) {
        beam_deflection_at(&g, 1, x, g.e[1][c->axis], row);
        beam_deflection_at(&g, 0, x, g.e[2][c->axis], row);
    } else {
        beam_slope_at(&g, 1, x, g.e[2][c->axis], row);
        beam_slope_at(&g, 0, x, -g.e[1][c->axis], row);
    }
}

static void channel_eval(const mt_data *d, const mt_channel_def *c, const mt_pose *poses,
                         mt_cx *row)
{
    static const mt_cx zero[3] = {0.0, 0.0, 0.0};
    mt_cx e[3] = {0.0, 0.0, 0.0};
    mt_cx s[3];
    e[c->axis] = 1.0;
    switch (c->kind) {
    case MT_CHANNEL_POINT:
        cx_rotate3(mt_pose_of(poses, c->body[0])->r, c->point < 0 ? zero : d->vec[c->point], s);
        row_add_point(row, 0, s, e, 1.0);
        break;
    case MT_CHANNEL_ROTATION:
        row_add_turn(row, 0, e, 1.0);
        break;
    case MT_CHANNEL_BEAM_POINT:
    case MT_CHANNEL_BEAM_ROTATION:
        beam_channel(d, c, poses, row);
        break;
    }
}

void mt_term_rows(const mt_data *d, mt_term_kind kind, const mt_term *t, const mt_pose *poses,
                  mt_cx *rows)
{
    memset(rows, 0, (size_t)t->count * MT_LOCAL * sizeof *rows);
    switch (kind) {
    case MT_TERM_STIFFNESS:
    case MT_TERM_DAMPING:
        spring_rows(d, &d->sys->springs[t->source], poses, rows);
        break;
    case MT_TERM_MASS:
        inertia_eval(d, &d->sys->inertias[t->source], poses, rows);
        break;
    case MT_TERM_CHANNEL:
        channel_eval(d, &d->sys->channels[t->source], poses, rows);
        break;
    case MT_TERM_KINDS:
        break;
    }
}

void mt_rows_eval(const mt_data *d, mt_term_kind kind, const mt_term_list *list,
                  const mt_pose *poses, mt_cx *rows)
{
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        mt_term_rows(d, kind, t, poses, rows + ((ptrdiff_t)t->first * MT_LOCAL));
    }
}

void mt_rows_over_states(const mt_system *sys, const mt_term_list *list, const double *rows,
                         mt_arena *mem, mt_rows *out)
{
    size_t most = 0;
    for (ptrdiff_t i = 0; i < (ptrdiff_t)list->n_rows * MT_LOCAL; i++) {
        most += rows[i] != 0.0 ? 1 : 0;
    }
    mt_rows_begin(out, list->n_rows, most, mem);
    if (mt_arena_failed(mem)) {
        return;
    }
    for (int i = 0; i < list->n_rows; i++) {
        const int *const body = list->terms[list->row_term[i]].body;
        const double *const row = rows + ((ptrdiff_t)i * MT_LOCAL);
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = row[k] == 0.0 ? -1 : mt_local_dof(sys, body, k);
            if (dof >= 0) {
                mt_rows_push(out, i, dof, row[k]);
            }
        }
        mt_rows_end(out, i);
    }
}
