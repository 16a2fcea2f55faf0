/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A mode's eigenvalue is lambda = F(q, nu, tau, p) to first order in everything but its own
 * shape, with
 *     F = phi^T (K + Kg - lambda M) phi - 2 mu . A phi,
 * where K and Kg sum measures s of gradient g and Hessian H, E = phi^T H phi: c (g . phi)^2 of
 * springs and f E of all forces f (of springs, of joints nu times a factor, of loads). The
 * equilibrium q with the joints' forces nu and the force tau of a trimmed spring is where all
 * f g balance. With x and y of
 *     H x + A^T y = F_q,   A x = F_nu,   t . x = F_tau
 * (position.h) an input p that moves nothing but forces changes lambda by
 *     F_p - x . (sum of f_p g + f g_p).
 *
 * F_q has third derivatives of the measures. With X_a f the derivative of f along the motion a
 * of the left chart, [X_a, X_b] = X_(b x a) (in rotations, body by body), and H symmetric,
 * X_j (X_phi X_phi s) follows from the derivative D of H phi along phi, which complex
 * arithmetic has exactly:
 *     (X_j X_phi X_phi s) = D_j - 3/2 (phi x H phi)_j + 1/4 (phi x (phi x g))_j,
 *     (X_j X_phi s)       = (H phi)_j - 1/2 (phi x g)_j.
 */
#include "mechanics/equilibrium_slopes.h"

#include <string.h>

#include "mechanics/position.h"
#include "mechanics/rows.h"

/* What a piece changes by as an input changes the section of its beam; bodies stay. */
typedef struct section_slope {
    int piece;
    int input;
    double stretch;
    double g[MT_RELATIVE]; /* of relative motions */
    double h[MT_RELATIVE_PAIRS];
    const mt_relative_list *filled;
} section_slope;

struct mt_section_slopes {
    int n;
    section_slope *all;
};

typedef struct work {
    mt_linear *lin;
    const double *phi;
    double *pull;        /* [nq] F_q */
    double *across;      /* [all equations] F_nu */
    mt_trim_forces trim; /* F_tau */
    double *x;
    double *y;
    double *energy; /* [n_pieces] E */
    double *along;  /* [n_pieces] g . phi */
    int *row;       /* [n_pieces] of a spring, of the terms of K; -1: blocked, or none */
    mt_pose *pose;  /* [bodies] moving along phi */
} work;

static mt_status open_work(work *w, mt_err *err)
{
    const mt_linear *const lin = w->lin;
    mt_arena *const mem = &w->lin->scratch;
    const size_t nq = (size_t)lin->sys->nq;
    const size_t m = (size_t)lin->sys->n_constraints;
    const size_t pieces = (size_t)lin->n_pieces;
    w->pull = mt_arena_f64(mem, nq, 1);
    w->across = mt_arena_f64(mem, m, 1);
    w->x = mt_arena_f64(mem, nq, 1);
    w->y = mt_arena_f64(mem, m, 1);
    w->energy = mt_arena_f64(mem, pieces, 1);
    w->along = mt_arena_f64(mem, pieces, 1);
    w->row = mt_arena_int(mem, pieces);
    w->pose = mt_arena_alloc(mem, (size_t)lin->sys->n_bodies, sizeof *w->pose);
    return mt_arena_check(mem, err);
}

/* Rows of the springs' pieces; both are in the order of the springs. */
static void find_rows(work *w)
{
    const mt_linear *const lin = w->lin;
    const mt_term_list *const list = &lin->list[MT_TERM_STIFFNESS];
    int at = 0;
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        w->row[i] = -1;
        while (p->spring >= 0 && list->terms[at].source < p->spring) {
            at++;
        }
        if (p->spring >= 0) {
            const mt_term *const t = &list->terms[at];
            const int row = t->first + p->side;
            const bool blocked =
                !t->pair && mt_rows_empty(&lin->entries[MT_TERM_STIFFNESS], row);
            w->row[i] = blocked ? -1 : row;
        }
    }
}

static void add3(double c, const double *v, double *to)
{
    for (int k = 0; k < 3; k++) {
        to[k] += c * v[k];
    }
}

static double dot3(const double *a, const double *b)
{
    return (a[0] * b[0]) + (a[1] * b[1]) + (a[2] * b[2]);
}

/* A vector of a body's drawing as the body stands now; -1: none. */
static void turned(const mt_linear *lin, int body, int vec, double out[3])
{
    const mt_pose *const pose = mt_pose_of(lin->position.at.pose, body);
    for (int i = 0; i < 3; i++) {
        out[i] = 0.0;
        for (int k = 0; k < 3 && vec >= 0; k++) {
            out[i] += creal(pose->r[i + (3 * k)]) * creal(lin->data.vec[vec][k]);
        }
    }
}

static void cross_add(double c, const double *a, const double *b, double *to)
{
    double v[3];
    mt_cross3(a, b, v);
    for (int k = 0; k < 3; k++) {
        to[k] += c * v[k];
    }
}

/* h: packed derivatives of the jet's Hessian; returns what of it is filled. */
static const mt_relative_list *hessian_slope(const mt_relative_jet *jet, double *h)
{
    const mt_relative_list *const l = mt_relative_filled(jet->second, jet->span);
    for (int ii = 0; ii < l->n; ii++) {
        const int row = mt_relative_row(l->at[ii]);
        for (int kk = 0; kk <= ii; kk++) {
            h[row + l->at[kk]] = cx_derivative(jet->h[row + l->at[kk]]);
        }
    }
    return l;
}

/*
 * Of measures that are products of vectors, D in closed form: with n on a, w and t that move
 * with b (w = x_b - x_a + t and t of a PLANE, both v of a DOT), alpha and beta the rotations
 * of a and b,
 *     (H phi)_a = P(n, w) alpha + (n . t) beta - t (n . beta) [+ n x d' and alpha x n on d],
 *     (H phi)_b = P(n, t) beta + (n . t) alpha - n (t . alpha),
 *     P(n, w) theta = (n (w . theta) + w (n . theta))/2 - (n . w) theta
 * (measure.c) are linear in n and in (w, t): their derivative is the sum of those of each.
 */

/* to += P(n, w) theta. */
static void add_turned(const double *n, const double *w, const double *theta, double *to)
{
    add3(0.5 * dot3(w, theta), n, to);
    add3(0.5 * dot3(n, theta), w, to);
    add3(-dot3(n, w), theta, to);
}

/* on[MT_LOCAL] += what is bilinear in n and (w, t). */
static void add_bilinear(const double *n, const double *w, const double *t, const double *way,
                         double *on)
{
    const double *const alpha = way + 3;
    const double *const beta = way + 9;
    add_turned(n, w, alpha, on + 3);
    add3(dot3(n, t), beta, on + 3);
    add3(-dot3(n, beta), t, on + 3);
    add_turned(n, t, beta, on + 9);
    add3(dot3(n, t), alpha, on + 9);
    add3(-dot3(t, alpha), n, on + 9);
}

/* out[MT_LOCAL] = D of a PLANE or a DOT along way[MT_LOCAL]. */
static void third_of_product(const mt_linear *lin, const mt_measure_def *def, const double *way,
                             double *out)
{
    const bool plane = def->kind == MT_MEASURE_PLANE;
    double n[3];
    double t[3];
    double w[3];
    double dn[3];
    double dt[3];
    double dw[3];
    double d[3];
    turned(lin, def->body[0], def->dir[0], n);
    turned(lin, def->body[1], plane ? def->point[1] : def->dir[1], t);
    mt_cross3(way + 3, n, dn);
    mt_cross3(way + 9, t, dt);
    for (int k = 0; k < 3; k++) {
        const mt_pose *const poses = lin->position.at.pose;
        const double apart = creal(mt_pose_of(poses, def->body[1])->x[k]) -
                             creal(mt_pose_of(poses, def->body[0])->x[k]);
        d[k] = plane ? way[6 + k] - way[k] : 0.0;
        w[k] = t[k] + (plane ? apart : 0.0);
        dw[k] = dt[k] + d[k];
    }
    memset(out, 0, MT_LOCAL * sizeof *out);
    add_bilinear(dn, w, t, way, out);
    add_bilinear(n, dw, dt, way, out);
    if (plane) {
        cross_add(1.0, dn, d, out + 3);
        cross_add(-1.0, way + 3, dn, out);
        cross_add(1.0, way + 3, dn, out + 6);
    }
}

/* The same of the load of a point: its arm w turns, the force f does not. */
static void third_of_point(const mt_linear *lin, const mt_load_def *load, const double *way,
                           double *out)
{
    double f[3];
    double w[3];
    double dw[3];
    turned(lin, load->body, load->point, w);
    mt_cross3(way + 3, w, dw);
    for (int k = 0; k < 3; k++) {
        f[k] = creal(mt_data_scalar(&lin->data, load->force[k], 0.0));
    }
    memset(out, 0, MT_LOCAL * sizeof *out);
    add_turned(f, dw, way + 3, out + 3);
}

/* out[MT_LOCAL] = D: the derivative along phi of H phi; way: phi of its two bodies. */
static void third_along(const work *w, const mt_piece *p, const mt_placement *moving,
                        mt_beam_parts *parts, const double *way, double *out)
{
    const mt_linear *const lin = w->lin;
    if (p->def == NULL) {
        third_of_point(lin, &lin->sys->loads[p->load], way, out);
        return;
    }
    if (p->def->kind == MT_MEASURE_PLANE || p->def->kind == MT_MEASURE_DOT) {
        third_of_product(lin, p->def, way, out);
        return;
    }
    mt_relative_jet jet;
    double h[MT_RELATIVE_PAIRS];
    double relative[MT_RELATIVE];
    double bent[MT_RELATIVE];
    mt_data_relative(&lin->data, p->def, moving, true, parts, &jet);
    const mt_relative_list *const filled = hessian_slope(&jet, h);
    mt_piece_relative(p, w->phi, relative);
    mt_piece_product(filled, h, relative, bent);
    for (int k = 0; k < MT_LOCAL; k++) {
        out[k] = mt_relative_sign(k) * bent[mt_relative_of(k)];
    }
}

/* to[MT_LOCAL] += c X_j X_phi X_phi s. */
static void add_third(const mt_piece *p, double c, const double *way, const double *bent,
                      const double *third, double *to)
{
    for (int k = 0; k < MT_LOCAL; k++) {
        to[k] += c * third[k];
    }
    for (int turn = 3; turn < MT_LOCAL; turn += 6) {
        double inner[3];
        mt_cross3(way + turn, p->g + turn, inner);
        cross_add(-1.5 * c, way + turn, bent + turn, to + turn);
        cross_add(0.25 * c, way + turn, inner, to + turn);
    }
}

/* to[MT_LOCAL] += c X_j X_phi s. */
static void add_second(const mt_piece *p, double c, const double *way, const double *bent,
                       double *to)
{
    for (int k = 0; k < MT_LOCAL; k++) {
        to[k] += c * bent[k];
    }
    for (int turn = 3; turn < MT_LOCAL; turn += 6) {
        cross_add(-0.5 * c, way + turn, p->g + turn, to + turn);
    }
}

/* F_q, F_nu and F_tau of one piece. */
static void pull_piece(work *w, int i, const double *mu, const mt_placement *moving,
                       mt_beam_parts *parts)
{
    const mt_linear *const lin = w->lin;
    const mt_piece *const p = &lin->pieces[i];
    const mt_piece *const other = p + p->partner;
    double way[MT_LOCAL];
    double bent[MT_LOCAL];
    double on[MT_LOCAL] = {0.0};
    double second = 0.0;
    mt_piece_motion(p, w->phi, way);
    w->energy[i] = mt_piece_bend(p, w->phi, bent);
    if (p->equation >= 0) {
        w->across[p->equation] += p->factor * w->energy[i];
        second = p->equation < lin->m ? -2.0 * p->factor * mu[p->equation] : 0.0;
    } else if (p->spring >= 0) {
        const double along = mt_piece_work(other, w->phi);
        second = w->row[i] >= 0 ? 2.0 * p->stiffness * along : 0.0;
        if (p->trim >= 0) {
            w->trim.of[p->trim] += w->energy[i];
        }
        mt_piece_add(other, p->trim >= 0 ? 0.0 : p->stiffness * w->energy[i], other->g,
                     w->pull);
    }
    if (second != 0.0) {
        add_second(p, second, way, bent, on);
    }
    if (p->force != 0.0) {
        double third[MT_LOCAL];
        third_along(w, p, moving, parts, way, third);
        add_third(p, p->force, way, bent, third, on);
    }
    mt_piece_add(p, 1.0, on, w->pull);
}

/* Sections: which strains of a beam they are in. */
static bool strain_has(const mt_measure_def *def, int number)
{
    const bool shape = number == MT_BEAM_SHAPE_2 || number == MT_BEAM_SHAPE_3;
    switch ((mt_beam_strain)def->component) {
    case MT_BEAM_STRETCH:
        return true;
    case MT_BEAM_TWIST:
    case MT_BEAM_BEND_2:
    case MT_BEAM_BEND_3:
        return shape;
    case MT_BEAM_SWAY_2:
    case MT_BEAM_SWAY_3:
    case MT_BEAM_STRAINS:
        break;
    }
    return false;
}

/* True where the input changes the measure with its bodies where they are. */
static bool shapes(const mt_linear *lin, const mt_measure_def *def, int input)
{
    bool any = false;
    for (int k = 0; def != NULL && def->kind == MT_MEASURE_BEAM && k < MT_BEAM_NUMBERS; k++) {
        any = any || (def->beam[k] != MT_NO_NODE && strain_has(def, k) &&
                      mt_linear_slope(lin, def->beam[k], input) != 0.0);
    }
    return any;
}

static void fill_section(const mt_linear *lin, int piece, mt_beam_parts *parts,
                         section_slope *out)
{
    const mt_piece *const p = &lin->pieces[piece];
    const mt_spring_def *const spring = &lin->sys->springs[p->spring];
    mt_relative_jet jet;
    *out = (section_slope){.piece = piece, .input = lin->dual.input};
    mt_data_relative(&lin->dual, p->def, &lin->position.at, true, parts, &jet);
    out->stretch = cx_derivative(jet.value);
    if (spring->free == MT_NO_NODE) {
        const mt_measure_data m = mt_data_measure(&lin->dual, p->def);
        const mt_pose *const rest = lin->position.reference.pose;
        out->stretch -= cx_derivative(mt_measure_value(
            &m, mt_pose_of(rest, p->def->body[0]), mt_pose_of(rest, p->def->body[1]), NULL));
    }
    for (int k = 0; k < MT_RELATIVE; k++) {
        out->g[k] = cx_derivative(jet.g[k]);
    }
    out->filled = hessian_slope(&jet, out->h);
}

/* Fill `all` by the inputs that are forced, or count where it is NULL. */
static int list_sections(mt_linear *lin, section_slope *all)
{
    int count = 0;
    for (int p = 0; p < lin->sys->n_inputs; p++) {
        mt_beam_parts parts;
        parts.dir = NULL;
        for (int i = 0; i < lin->n_pieces && mt_stages_has(lin->forced, p); i++) {
            const mt_piece *const piece = &lin->pieces[i];
            if (piece->spring < 0 || !shapes(lin, piece->def, p)) {
                continue;
            }
            if (all != NULL) {
                lin->dual.input = p;
                fill_section(lin, i, &parts, &all[count]);
            }
            count++;
        }
    }
    return count;
}

/* lin->sections, once for all modes of a design. */
static mt_status find_sections(mt_linear *lin, mt_err *err)
{
    mt_arena *const mem = &lin->geometry->mem;
    mt_section_slopes *const s = mt_arena_alloc(mem, 1, sizeof *s);
    MT_TRY(mt_arena_check(mem, err));
    s->all = mt_arena_alloc(mem, (size_t)list_sections(lin, NULL), sizeof *s->all);
    MT_TRY(mt_arena_check(mem, err));
    s->n = list_sections(lin, s->all);
    lin->sections = s;
    return MT_OK;
}

/* What sections change, of K. */
static void add_sections(const work *w, double *slope)
{
    const mt_linear *const lin = w->lin;
    for (int i = 0; i < lin->sections->n; i++) {
        const section_slope *const s = &lin->sections->all[i];
        const mt_piece *const p = &lin->pieces[s->piece];
        const int at = s->piece + p->partner;
        const mt_piece *const other = &lin->pieces[at];
        double way[MT_RELATIVE];
        double x[MT_RELATIVE];
        double bent[MT_RELATIVE];
        double along = 0.0;
        double work_of_x = 0.0;
        double energy = 0.0;
        mt_piece_relative(p, w->phi, way);
        mt_piece_relative(p, w->x, x);
        mt_piece_product(s->filled, s->h, way, bent);
        for (int k = 0; k < MT_RELATIVE; k++) {
            along += s->g[k] * way[k];
            work_of_x += s->g[k] * x[k];
            energy += way[k] * bent[k];
        }
        slope[s->input] += p->force * (energy - work_of_x);
        if (w->row[s->piece] >= 0) {
            slope[s->input] += 2.0 * p->stiffness * mt_piece_work(other, w->phi) * along;
        }
        if (p->trim < 0) {
            slope[s->input] +=
                p->stiffness * s->stretch * (w->energy[at] - mt_piece_work(other, w->x));
        }
    }
}

/* phi^T M' phi of a term whose section lin->dual.input changes. rows: work, 12 for each row. */
static double mass_section(const work *w, const mt_term *t, mt_cx *rows)
{
    const mt_linear *const lin = w->lin;
    double sum = 0.0;
    mt_term_rows(&lin->dual, MT_TERM_MASS, t, lin->position.at.pose, rows);
    for (int r = 0; r < t->count; r++) {
        double change = 0.0;
        for (int k = 0; k < MT_LOCAL; k++) {
            const int dof = mt_local_dof(lin->sys, t->body, k);
            const double part = cx_derivative(rows[k + ((ptrdiff_t)MT_LOCAL * r)]);
            change += dof >= 0 ? part * w->phi[dof] : 0.0;
        }
        if (!mt_rows_empty(&lin->entries[MT_TERM_MASS], t->first + r)) {
            sum += change * mt_rows_dot(&lin->full[MT_TERM_MASS], t->first + r, w->phi);
        }
    }
    return 2.0 * lin->value[t->coefficient] * sum;
}

static bool shapes_mass(const mt_linear *lin, const mt_term *t, int input)
{
    const mt_inertia_def *const def = &lin->sys->inertias[t->source];
    bool any = false;
    for (int k = 0; k < 2; k++) {
        any = any || (def->shape[k] != MT_NO_NODE &&
                      mt_linear_slope(lin, def->shape[k], input) != 0.0);
    }
    return any;
}

/* The same of M. */
static mt_status add_mass_sections(const work *w, double lambda, double *slope, mt_err *err)
{
    mt_linear *const lin = w->lin;
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    int most = 0;
    for (int i = 0; i < list->n_terms; i++) {
        most = list->terms[i].count > most ? list->terms[i].count : most;
    }
    mt_cx *const rows = mt_arena_alloc(&lin->scratch, (size_t)most * MT_LOCAL, sizeof *rows);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (int p = 0; p < lin->sys->n_inputs; p++) {
        lin->dual.input = p;
        for (int i = 0; i < list->n_terms && mt_stages_has(lin->forced, p); i++) {
            if (shapes_mass(lin, &list->terms[i], p)) {
                slope[p] -= lambda * mass_section(w, &list->terms[i], rows);
            }
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}

/* slope[p] += by dn/dp, of all forced inputs. */
static void add_node(const mt_linear *lin, mt_node node, double by, double *slope)
{
    if (node == MT_NO_NODE || by == 0.0) {
        return;
    }
    const mt_program_span span = lin->sys->program.span[node];
    for (int p = span.first; p < span.end; p++) {
        if (mt_stages_has(lin->forced, p)) {
            slope[p] += by * mt_linear_slope(lin, node, p);
        }
    }
}

/* What the numbers of springs change, beyond the coefficients of K. */
static void add_springs(const work *w, double *slope)
{
    const mt_linear *const lin = w->lin;
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        if (p->spring < 0 || p->trim >= 0) {
            continue;
        }
        const mt_spring_def *const s = &lin->sys->springs[p->spring];
        const double by = w->energy[i] - mt_piece_work(p, w->x);
        const double half = p->partner == 0 ? 1.0 : 0.5;
        add_node(lin, s->stiffness, half * by * p[p->partner].stretch, slope);
        add_node(lin, p->partner == 0 ? s->preload : MT_NO_NODE, by, slope);
        add_node(lin, s->free, -by * p->stiffness, slope);
    }
}

/* What a force on a point changes: its work along x, less its own curvature along phi. */
static void add_point_force(const work *w, const mt_load_def *load, double *slope)
{
    const mt_linear *const lin = w->lin;
    const mt_pose *const pose = &lin->position.at.pose[load->body];
    double arm[3] = {0.0, 0.0, 0.0};
    double x[6];
    double way[6];
    double swept[3];
    double turned[3];
    double bent[3];
    for (int j = 0; j < 9 && load->point >= 0; j++) {
        arm[j % 3] += creal(pose->r[j]) * creal(lin->data.vec[load->point][j / 3]);
    }
    mt_pose_motion(lin->sys, load->body, w->x, x);
    mt_pose_motion(lin->sys, load->body, w->phi, way);
    mt_cross3(x + 3, arm, swept);
    mt_cross3(way + 3, arm, turned);
    mt_cross3(way + 3, turned, bent);
    for (int k = 0; k < 3; k++) {
        add_node(lin, load->force[k], x[k] + swept[k] - bent[k], slope);
    }
}

static void add_loads(const work *w, double *slope)
{
    const mt_system *const sys = w->lin->sys;
    for (int i = 0; i < w->lin->n_pieces; i++) {
        const mt_piece *const p = &w->lin->pieces[i];
        if (p->load >= 0 && p->def != NULL) {
            const double by = w->energy[i] - mt_piece_work(p, w->x);
            add_node(w->lin, sys->loads[p->load].size, -by, slope);
        }
    }
    for (int i = 0; i < sys->n_loads; i++) {
        if (sys->loads[i].measure < 0) {
            add_point_force(w, &sys->loads[i], slope);
        }
    }
}

/*
 * A row r of M is made of vectors that turn with something: of a body its axes, of a bar the
 * arms of its ends, of a beam element its frame e and its length L (rows.c). As that turns
 * by omega, a block b of r (displacement or rotation of one body) changes by omega x b, and
 *     (r . phi)' = omega . sum b x phi_b;
 * an arm s of a block s x e by omega x s, and (r . phi)' = omega . (s x (e x phi_theta)). In
 * rows of deflection the blocks of rotations are in proportion to L, in those of rotary inertia
 * the blocks of displacements to 1/L. With d = x_B - x_A = L e1, h = h_A + h_B the halves of
 * the frame's second axis, n = h - (h . e1) e1 = |n| e2,
 *     e1' = (d' - e1 e1 . d')/L,   omega = e1 x e1' + e1 (e3 . h' - (h . e1) e3 . e1')/|n|,
 *     h' = theta_A x h_A + theta_B x h_B,   L' = e1 . d'.
 */

/* What pulls at a beam element's frame: moment, and force that lengthens. */
typedef struct frame_pull {
    double moment[3];
    double length;
} frame_pull;

/* on[MT_LOCAL] += c times the derivative of r . phi, of a row that turns with its body or with
 * the arms of a bar's ends. */
static void pull_row(const mt_linear *lin, const mt_inertia_def *def, double c,
                     const double *row, const double *phi, double *on)
{
    for (int side = 0; side < 2; side++) {
        const double *const block = row + ((ptrdiff_t)6 * side);
        const double *const turn = phi + ((ptrdiff_t)6 * side) + 3;
        double v[3];
        if (def->kind == MT_INERTIA_ROTATION) {
            mt_cross3(block + 3, turn, v);
            add3(c, v, on + ((ptrdiff_t)6 * side) + 3);
        } else {
            double s[3];
            double w[3];
            turned(lin, def->body[side], def->point[side], s);
            mt_cross3(block, turn, v);
            mt_cross3(s, v, w);
            add3(c, w, on + ((ptrdiff_t)6 * side) + 3);
        }
    }
}

/* The same of a beam element's row. per_length: the power of L that it has, +1 in rotations, -1
 * in displacements, 0: none. */
static void pull_frame(double c, int per_length, const double *row, const double *phi,
                       frame_pull *on)
{
    double sized = 0.0;
    for (int b = 0; b < 4; b++) {
        double v[3];
        mt_cross3(row + ((ptrdiff_t)3 * b), phi + ((ptrdiff_t)3 * b), v);
        add3(c, v, on->moment);
        if (per_length == (b % 2 == 1 ? 1 : -1)) {
            sized += dot3(row + ((ptrdiff_t)3 * b), phi + ((ptrdiff_t)3 * b));
        }
    }
    on->length += c * per_length * sized;
}

static int power_of_length(const mt_inertia_def *def, int row)
{
    if (def->kind == MT_INERTIA_BEAM_ROTARY) {
        return -1;
    }
    return def->kind == MT_INERTIA_BEAM && row >= MT_BAR_ROWS ? 1 : 0;
}

/* on[MT_LOCAL] += what pulls at the frame, as forces on the two nodes. */
static void spread_frame(const mt_linear *lin, const mt_inertia_def *def,
                         const frame_pull *frame, double *on)
{
    mt_beam_geometry g = {.shape = {1.0, 1.0}};
    double e[3][3];
    double h[2][3];
    double chord[3];
    double v[3];
    mt_beam_frame(&lin->data, def->body, def->dir, lin->position.at.pose, &g);
    for (int i = 0; i < 9; i++) {
        e[i / 3][i % 3] = creal(g.e[i / 3][i % 3]);
    }
    const double length = creal(g.length);
    for (int side = 0; side < 2; side++) {
        turned(lin, def->body[side], def->dir[1], h[side]);
    }
    const double along = dot3(h[0], e[0]) + dot3(h[1], e[0]);
    const double across = dot3(h[0], e[1]) + dot3(h[1], e[1]); /* |n| */
    const double twist = dot3(frame->moment, e[0]) / across;
    mt_cross3(frame->moment, e[0], chord);
    for (int k = 0; k < 3; k++) {
        chord[k] = ((chord[k] - (twist * along * e[2][k])) / length) +
                   (frame->length / length * e[0][k]);
    }
    add3(-1.0, chord, on);
    add3(1.0, chord, on + 6);
    for (int side = 0; side < 2; side++) {
        mt_cross3(h[side], e[2], v);
        add3(twist, v, on + ((ptrdiff_t)6 * side) + 3);
    }
}

static bool has_frame(const mt_inertia_def *def)
{
    return def->kind == MT_INERTIA_BEAM || def->kind == MT_INERTIA_BEAM_TWIST ||
           def->kind == MT_INERTIA_BEAM_ROTARY;
}

/* The motion that row r of a term is multiplied with; 0 where joints block it. */
static double partner_motion(const mt_linear *lin, const mt_term *t, int r, const double *phi)
{
    const int row = t->pair ? (2 * t->first) + 1 - r : r;
    const bool blocked = !t->pair && mt_rows_empty(&lin->entries[MT_TERM_MASS], row);
    return blocked ? 0.0 : mt_rows_dot(&lin->full[MT_TERM_MASS], row, phi);
}

static void pull_term(const mt_linear *lin, const mt_term *t, double scale, const double *phi,
                      double *to)
{
    const mt_inertia_def *const def = &lin->sys->inertias[t->source];
    const bool framed = has_frame(def);
    const double c = scale * lin->value[t->coefficient] * (t->pair ? 1.0 : 2.0);
    double way[MT_LOCAL];
    double on[MT_LOCAL] = {0.0};
    frame_pull frame = {.length = 0.0};
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(lin->sys, t->body, k);
        way[k] = dof >= 0 ? phi[dof] : 0.0;
    }
    for (int r = t->first; r < t->first + t->count; r++) {
        const double *const row = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)r * MT_LOCAL);
        const double by = c * partner_motion(lin, t, r, phi);
        if (framed) {
            pull_frame(by, power_of_length(def, r - t->first), row, way, &frame);
        } else {
            pull_row(lin, def, by, row, way, on);
        }
    }
    if (framed) {
        spread_frame(lin, def, &frame, on);
    }
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(lin->sys, t->body, k);
        if (dof >= 0) {
            to[dof] += on[k];
        }
    }
}

/* to[nq] += scale times the derivative of phi^T M phi by the position, at constant components
 * phi. */
static void pull_masses(const mt_linear *lin, double scale, const double *phi, double *to)
{
    const mt_term_list *const list = &lin->list[MT_TERM_MASS];
    for (int i = 0; i < list->n_terms; i++) {
        const mt_term *const t = &list->terms[i];
        if (lin->sys->inertias[t->source].kind != MT_INERTIA_TRANSLATION) {
            pull_term(lin, t, scale, phi, to);
        }
    }
}

mt_status mt_equilibrium_slopes(mt_linear *lin, double lambda, const double *phi,
                                const double *mu, double *slope, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    work w = {.lin = lin, .phi = phi};
    mt_beam_parts parts;
    parts.dir = NULL;
    lin->dual.input = -1; /* no input that is forced moves a vector */
    mt_data_vecs(&lin->dual);
    MT_TRY(open_work(&w, err));
    if (lin->sections == NULL) {
        MT_TRY(find_sections(lin, err));
    }
    find_rows(&w);
    mt_placement moving = lin->position.at;
    moving.pose = w.pose;
    mt_poses_tangent(lin->sys, lin->position.at.pose, phi, w.pose);
    for (int i = 0; i < lin->n_pieces; i++) {
        pull_piece(&w, i, mu, &moving, &parts);
    }
    pull_masses(lin, -lambda, phi, w.pull);
    MT_TRY(mt_newton_adjoint(&lin->position.equilibrium, w.pull, w.across, w.trim.of, w.x, w.y,
                             &lin->scratch, err));
    add_springs(&w, slope);
    add_loads(&w, slope);
    add_sections(&w, slope);
    MT_TRY(add_mass_sections(&w, lambda, slope, err));
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
