/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Idle spins. A thin rod between two ball joints may turn about its own axis, and where it has
 * no inertia about it nothing resists: no mass, no stiffness, no joint. Such a direction y has
 * K y = M y = 0: it belongs to every frequency and to none, and moves no point that anything
 * holds on to. It is taken out of the freedoms; what is left is regular, and all its modes are
 * those of the mechanism. Directions without mass and stiffness that move a centre of mass are
 * not idle: a spring or a joint was forgotten there (MT_E_MASSLESS).
 *
 * Candidates W: rotations of single bodies about axes without inertia (in scaled coordinates,
 * length 1). Idle are the combinations W s with C W s = 0, C being the rows of joints, springs
 * and dampers, of masses that two bodies share, and Z^T Kg, each relative to its length. They
 * are sought as null vectors of (C W)^T (C W), and C W s itself decides.
 */
#include "mechanics/free_spin.h"

#include "mechanics/linear_priv.h"

#include <math.h>
#include <string.h>

/* A principal moment below this part of the terms that make it is rounding of theirs. */
static const double NO_INERTIA = 1e-13;
/* This many times that is no rounding, without a closer look. */
static const double SURELY = 100.0;
/* Entries of C W s below this are none: as the rank of the constraints is decided
 * (eliminate.c). */
static const double NOT_HELD = 1e-9;
/* Eigenvalues of (C W)^T (C W) worth a closer look: squares, of which rounding leaves some
 * 1e-15. */
static const double WORTH_A_LOOK = 1e-12;
/* Spins are independent, as the columns of Z are: only zero is no rank. */
static const double NO_RANK = 1e-12;
/* A body that turns less than this part of the most is no part of a spin. */
static const double NO_PART = 1e-6;

typedef struct candidate {
    int body;
    double axis[3];
} candidate;

typedef struct search {
    mt_linear *lin;
    int n;           /* candidates */
    candidate *list; /* in the order of the bodies */
    int *first;      /* [bodies + 1] of each body */
    double *gram;    /* n x n (C W)^T (C W), then its eigenvectors */
    double *value;   /* [n] */
    double *worst;   /* [n] largest entry of C W s for each eigenvector s */
    double *row;     /* [n] of C W */
    int *at;         /* [n] its entries that are not 0 */
    bool look;       /* the second pass: fill worst */
} search;

/* What a body's own rotation costs. */
typedef struct tensor {
    double j[9];
    double terms; /* sizes of the terms of j, summed */
    bool varies;
} tensor;

static void add_inertia(const mt_linear *lin, int row_at, tensor *list)
{
    const mt_term_list *const terms = &lin->list[MT_TERM_MASS];
    const mt_term *const t = &terms->terms[terms->row_term[row_at]];
    const int other = t->pair ? (2 * t->first) + 1 - row_at : row_at;
    const double *const row = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)row_at * MT_LOCAL);
    const double *const pair = lin->rows[MT_TERM_MASS] + ((ptrdiff_t)other * MT_LOCAL);
    const double c = lin->value[t->coefficient] * (t->pair ? 0.5 : 1.0);
    for (int side = 0; side < 2; side++) {
        const int at = (6 * side) + 3;
        bool any = false;
        if (t->body[side] < 0) {
            continue;
        }
        tensor *const own = &list[t->body[side]];
        for (int k = 0; k < 9; k++) {
            const double term = c * row[at + (k % 3)] * pair[at + (k / 3)];
            own->j[k] += term;
            own->terms += fabs(term);
            any = any || row[at + (k % 3)] != 0.0;
        }
        own->varies = own->varies || (any && t->varies);
    }
}

/* True where the least principal moment is certainly more than rounding. Of positive ones, by
 * Sylvester, the least is at least det J / (trace/2)^2. */
static bool is_regular(const tensor *own)
{
    const double *const j = own->j;
    const double minor = (j[0] * j[4]) - (j[1] * j[1]);
    const double det = (j[8] * minor) - (j[5] * ((j[0] * j[5]) - (j[1] * j[2]))) +
                       (j[2] * ((j[1] * j[5]) - (j[4] * j[2])));
    const double half = 0.5 * (j[0] + j[4] + j[8]);
    const double sure = SURELY * NO_INERTIA * own->terms;
    return j[0] > sure && minor > sure * half && det > sure * half * half;
}

static mt_status add_candidates(search *s, int body, tensor *own, mt_err *err)
{
    mt_linear *const lin = s->lin;
    double w[3];
    if (is_regular(own)) {
        return MT_OK;
    }
    MT_TRY(mt_eig_sym(3, own->j, w, true, &lin->scratch, err));
    for (int k = 0; k < 3; k++) {
        if (fabs(w[k]) <= NO_INERTIA * own->terms) {
            candidate *const c = &s->list[s->n++];
            c->body = body;
            memcpy(c->axis, own->j + (ptrdiff_t)(3 * k), sizeof c->axis);
            lin->free_spin_varies = lin->free_spin_varies || own->varies;
        }
    }
    return MT_OK;
}

static mt_status find_candidates(search *s, mt_err *err)
{
    const mt_system *const sys = s->lin->sys;
    const size_t bodies = (size_t)sys->n_bodies;
    tensor *const inertia = mt_arena_alloc(&s->lin->scratch, bodies, sizeof *inertia);
    s->list = mt_arena_alloc(&s->lin->scratch, 3 * bodies, sizeof *s->list);
    s->first = mt_arena_int(&s->lin->scratch, bodies + 1);
    MT_TRY(mt_arena_check(&s->lin->scratch, err));
    for (int i = 0; i < s->lin->list[MT_TERM_MASS].n_rows; i++) {
        add_inertia(s->lin, i, inertia);
    }
    for (int b = 0; b < sys->n_bodies; b++) {
        s->first[b] = s->n;
        if (sys->bodies[b].dof[5] >= 0) {
            MT_TRY(add_candidates(s, b, &inertia[b], err));
        }
    }
    s->first[sys->n_bodies] = s->n;
    return MT_OK;
}

/* The row s->row [n] of C W: into the Gram matrix, or (second pass) against every
 * eigenvector. */
static void take_row(search *s)
{
    int n = 0;
    for (int c = 0; c < s->n; c++) {
        if (s->row[c] != 0.0) {
            s->at[n++] = c;
        }
    }
    for (int v = 0; v < s->n && s->look && n > 0; v++) {
        double sum = 0.0;
        for (int k = 0; k < n; k++) {
            sum += s->row[s->at[k]] * s->gram[s->at[k] + ((ptrdiff_t)v * s->n)];
        }
        s->worst[v] = fmax(s->worst[v], fabs(sum));
    }
    for (int k = 0; k < n && !s->look; k++) {
        for (int i = 0; i < n; i++) {
            s->gram[s->at[i] + ((ptrdiff_t)s->at[k] * s->n)] +=
                s->row[s->at[i]] * s->row[s->at[k]];
        }
    }
}

/* axis . x over the rotations x (stride apart) of a candidate's body. */
static double rotation_about_axis(const search *s, int c, const double *x, ptrdiff_t stride)
{
    const int *const dof = s->lin->sys->bodies[s->list[c].body].dof;
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        sum += s->list[c].axis[k] * x[dof[3 + k] * stride];
    }
    return sum;
}

static void take_joints(search *s)
{
    const mt_linear *const lin = s->lin;
    const double arc = 1.0 / lin->sys->length_m;
    for (int i = 0; i < lin->m; i++) {
        for (int c = 0; c < s->n; c++) {
            s->row[c] = arc * lin->e.dr[i] * rotation_about_axis(s, c, lin->a + i, lin->m);
        }
        take_row(s);
    }
}

/* Add the rows of a kind. Rows of one body's own mass are zero by the choice of the candidates.
 * A coefficient of 0 that an input may change counts as well. */
static void take_terms(search *s, int kind)
{
    const mt_linear *const lin = s->lin;
    const mt_term_list *const list = &lin->list[kind];
    const double arc = 1.0 / lin->sys->length_m;
    for (int i = 0; i < list->n_rows; i++) {
        const mt_term *const t = &list->terms[list->row_term[i]];
        const double *const row = lin->rows[kind] + ((ptrdiff_t)i * MT_LOCAL);
        const bool own = kind == MT_TERM_MASS && t->body[0] == t->body[1];
        double length = 0.0;
        if (own || (lin->value[t->coefficient] == 0.0 && !t->varies)) {
            continue;
        }
        for (int k = 0; k < MT_LOCAL; k++) {
            length = hypot(length, row[k] * (k % 6 < 3 ? 1.0 : arc));
        }
        memset(s->row, 0, (size_t)s->n * sizeof *s->row);
        for (int side = 0; side < 2 && length > 0.0; side++) {
            const int b = t->body[side];
            const double *const turn = row + (ptrdiff_t)(6 * side) + 3;
            for (int c = b < 0 ? 0 : s->first[b]; b >= 0 && c < s->first[b + 1]; c++) {
                const double *const axis = s->list[c].axis;
                s->row[c] += arc / length *
                             ((turn[0] * axis[0]) + (turn[1] * axis[1]) + (turn[2] * axis[2]));
            }
        }
        take_row(s);
    }
}

/* Rows of Z^T Kg W, relative to the largest entry of Kg. */
static mt_status take_load(search *s, mt_err *err)
{
    mt_linear *const lin = s->lin;
    const mt_elimination *const e = &lin->e;
    const ptrdiff_t nq = e->nq;
    double most = 0.0;
    if (lin->kg == NULL) {
        return MT_OK;
    }
    double *const kz = mt_arena_f64(&lin->scratch, (size_t)nq, 1);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (ptrdiff_t i = 0; i < nq * nq; i++) {
        most = fmax(most, fabs(e->dc[i % nq] * lin->kg[i] * e->dc[i / nq]));
    }
    for (int z = 0; z < e->n && most > 0.0; z++) {
        memset(kz, 0, (size_t)nq * sizeof *kz);
        mt_linear_add_load(lin, 1.0, e->z + (z * nq), kz);
        for (int c = 0; c < s->n; c++) {
            s->row[c] = rotation_about_axis(s, c, kz, 1) / (lin->sys->length_m * most);
        }
        take_row(s);
    }
    return MT_OK;
}

static mt_status take_all(search *s, mt_err *err)
{
    take_joints(s);
    take_terms(s, MT_TERM_STIFFNESS);
    take_terms(s, MT_TERM_DAMPING);
    take_terms(s, MT_TERM_MASS);
    return take_load(s, err);
}

/* phi [nq] := the spin v in scaled coordinates; records its bodies. */
static void spin_of(search *s, int v, double *phi)
{
    mt_linear *const lin = s->lin;
    const double *const part = s->gram + ((ptrdiff_t)v * s->n);
    for (int c = 0; c < s->n; c++) {
        const candidate *const own = &s->list[c];
        for (int k = 0; k < 3; k++) {
            phi[lin->sys->bodies[own->body].dof[3 + k]] += part[c] * own->axis[k];
        }
        lin->free_spins[own->body] = lin->free_spins[own->body] || fabs(part[c]) > NO_PART;
    }
}

static void keep_column(double *z, ptrdiff_t nq, ptrdiff_t from, ptrdiff_t to)
{
    if (from != to) {
        memcpy(z + (to * nq), z + (from * nq), (size_t)nq * sizeof *z);
    }
}

/*
 * Spins Z y [nq x spins]: K and M do not see them, so that shapes count up to a spin, and a
 * column of Z that has part in one is as good without it. The columns with the largest parts
 * go; the others stay as they are, and with them the entries of K_r and M_r.
 */
static mt_status leave_out_spin_columns(mt_linear *lin, int spins, const double *phi,
                                        mt_err *err)
{
    mt_elimination *const e = &lin->e;
    mt_qr qr;
    double *const zs = mt_arena_f64(&lin->scratch, (size_t)e->nq, (size_t)e->n);
    double *const y = mt_arena_f64(&lin->scratch, (size_t)e->n, (size_t)spins);
    double *const yt = mt_arena_f64(&lin->scratch, (size_t)spins, (size_t)e->n);
    bool *const gone = mt_arena_alloc(&lin->scratch, (size_t)e->n, sizeof *gone);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    for (ptrdiff_t i = 0; i < (ptrdiff_t)e->nq * e->n; i++) {
        zs[i] = e->z[i] / e->dc[i % e->nq];
    }
    MT_TRY(mt_qr_factor(e->nq, e->n, zs, e->nq, NO_RANK, &lin->scratch, &qr, err));
    MT_TRY(mt_qr_solve(&qr, spins, phi, y, &lin->scratch, err));
    for (int c = 0; c < e->n; c++) {
        for (int v = 0; v < spins; v++) {
            yt[v + ((ptrdiff_t)c * spins)] = y[c + ((ptrdiff_t)v * e->n)];
        }
    }
    MT_TRY(mt_qr_factor(spins, e->n, yt, spins, NO_RANK, &lin->scratch, &qr, err));
    for (int k = 0; k < qr.rank; k++) {
        gone[qr.perm[k]] = true;
    }
    int left = 0;
    for (int c = 0; c < e->n; c++) {
        if (!gone[c]) {
            keep_column(e->z, e->nq, c, left);
            keep_column(lin->z_error, e->nq, c, left);
            left++;
        }
    }
    lin->n_free_spins = qr.rank;
    e->n = left;
    lin->n = left;
    return MT_OK;
}

static mt_status decide(search *s, mt_err *err)
{
    mt_linear *const lin = s->lin;
    const size_t n = (size_t)s->n;
    int spins = 0;
    s->gram = mt_arena_f64(&lin->scratch, n, n);
    s->value = mt_arena_f64(&lin->scratch, n, 1);
    s->worst = mt_arena_f64(&lin->scratch, n, 1);
    s->row = mt_arena_f64(&lin->scratch, n, 1);
    s->at = mt_arena_int(&lin->scratch, n);
    double *const phi = mt_arena_f64(&lin->scratch, (size_t)lin->sys->nq, n);
    MT_TRY(mt_arena_check(&lin->scratch, err));
    MT_TRY(take_all(s, err));
    MT_TRY(mt_eig_sym(s->n, s->gram, s->value, true, &lin->scratch, err));
    if (s->value[0] > WORTH_A_LOOK) {
        return MT_OK;
    }
    s->look = true;
    MT_TRY(take_all(s, err));
    for (int v = 0; v < s->n && s->value[v] <= WORTH_A_LOOK; v++) {
        if (s->worst[v] <= NOT_HELD) {
            spin_of(s, v, phi + ((ptrdiff_t)spins * lin->sys->nq));
            spins++;
        }
    }
    return spins == 0 ? MT_OK : leave_out_spin_columns(lin, spins, phi, err);
}

mt_status mt_free_spin_remove(mt_linear *lin, mt_err *err)
{
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    search s = {.lin = lin};
    lin->n_free_spins = 0;
    lin->free_spin_varies = false;
    lin->free_spins =
        mt_arena_alloc(&lin->reduced_mem, (size_t)lin->sys->n_bodies, sizeof *lin->free_spins);
    MT_TRY(mt_arena_check(&lin->reduced_mem, err));
    if (lin->sys->dimension == 3) {
        MT_TRY(find_candidates(&s, err));
    }
    if (s.n > 0 && lin->n > 0) {
        MT_TRY(decide(&s, err));
    }
    mt_arena_rewind(&lin->scratch, mark);
    return MT_OK;
}
