/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energies of modes, term by term, and what rounding leaves open of them. */
#include "mechanics/energy.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mechanics/position.h"
#include "mechanics/products.h"

/*
 * Error of the eigenvalue of a shape phi from rounding of the balancing forces; phi has mass 1,
 * and its joint forces mu satisfy A^T mu = (K - lambda M) phi. The eigenvalue depends on the
 * position through the rows of springs and joints, and on the forces: with the gradient g_t and
 * the Hessian H_t of a measure,
 *     d lambda = sum_t [2 k_t (g_t . phi) - 2 mu_t] phi^T H_t dq + sum_t e_t df_t,
 *         e_t = phi^T H_t phi.
 * Position and forces are those of an equilibrium: where rounding n_t of a measure makes f_t =
 * k_t (d_t + n_t), they change by dq, df_t = k_t (n_t + g_t . dq) and the joints' dlambda, such
 * that the forces balance again. By the adjoint (x, y) of those equations (position.h)
 * for
 *     pull = sum_t [2 k_t (g_t . phi) - 2 mu_t] H_t phi + sum of springs e_t k_t g_t,
 *     across = e of the joints,
 * this is
 *     |d lambda| <= sum of springs |e_t - g_t . x| (k_t n_t + eps |f_t|)
 *                   + sum of joints |y_i| n_i + sum of bodies eps |forces| |x|,
 * the last for the sum of forces on each body. Stiff springs count as far as they can move
 * something: a spring of stiffness k with a lever r short against the size l of its bodies
 * holds them to eps l / r, and so its lever, on which r^2 k depends.
 */
typedef struct equilibrium_rounding equilibrium_rounding;

/* Rounding of an equilibrium. */

/* Roundings in a measure, and in the sum of the forces on a body. */
static const double ULPS = 4.0;

struct equilibrium_rounding {
    mt_linear *lin;
    int m;             /* equations of the equilibrium; of the linearised system lin->m */
    double *pull;      /* [nq] */
    double *across;    /* [m] */
    double *mu;        /* [m] */
    double *x;         /* [nq] */
    double *y;         /* [m] */
    double *energy;    /* [n_pieces] e = phi^T H phi */
    double *bent;      /* [n_pieces][MT_LOCAL] H phi */
    double *roundness; /* [m] n of the joints */
};

/* *out is NULL without loads. In the scratch of lin. */
static mt_status equilibrium_rounding_new(mt_linear *lin, equilibrium_rounding **out,
                                          mt_err *err)
{
    mt_arena *const mem = &lin->scratch;
    *out = NULL;
    if (lin->pieces == NULL) {
        return MT_OK;
    }
    const size_t nq = (size_t)lin->sys->nq;
    const size_t m = (size_t)lin->sys->n_constraints;
    equilibrium_rounding *const r = mt_arena_alloc(mem, 1, sizeof *r);
    MT_TRY(mt_arena_check(mem, err));
    r->lin = lin;
    r->m = lin->sys->n_constraints;
    r->pull = mt_arena_f64(mem, nq, 1);
    r->across = mt_arena_f64(mem, m, 1);
    r->mu = mt_arena_f64(mem, m, 1);
    r->x = mt_arena_f64(mem, nq, 1);
    r->y = mt_arena_f64(mem, m, 1);
    r->energy = mt_arena_f64(mem, (size_t)lin->n_pieces, 1);
    r->bent = mt_arena_f64(mem, (size_t)lin->n_pieces, MT_LOCAL);
    r->roundness = mt_arena_f64(mem, m, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        if (p->equation >= 0) {
            r->roundness[p->equation] += fabs(p->factor) * p->roundness;
        }
    }
    *out = r;
    return MT_OK;
}

/* bent, energies and mu, A^T mu = (K - lambda M) phi; the sparse equations of the equilibrium,
 * where they are factored, have it with x = 0. */
static mt_status joint_forces(equilibrium_rounding *r, double lambda, const double *phi,
                              mt_err *err)
{
    mt_linear *const lin = r->lin;
    const mt_newton_solver *const solver = &lin->position.equilibrium.solver;
    memset(r->pull, 0, (size_t)lin->sys->nq * sizeof *r->pull);
    mt_linear_rows_product(lin, lambda, phi, r->pull);
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        double *const bent = r->bent + ((ptrdiff_t)i * MT_LOCAL);
        r->energy[i] = mt_piece_bend(p, phi, bent);
        mt_piece_add(p, lin->kg != NULL ? p->force : 0.0, bent, r->pull);
    }
    return solver->sparse
               ? mt_saddle_solve(&solver->saddle, r->pull, NULL, NULL, r->mu, &lin->scratch,
                                 err)
               : mt_eliminate_multipliers(&lin->e, r->pull, r->mu, &lin->scratch, err);
}

/* Compute pull and across; returns the coefficients of the trimmed springs' forces. */
static mt_trim_forces sum_piece_forces(equilibrium_rounding *r, const double *phi)
{
    const mt_linear *const lin = r->lin;
    mt_trim_forces trim = {{0.0}};
    memset(r->pull, 0, (size_t)lin->sys->nq * sizeof *r->pull);
    memset(r->across, 0, (size_t)r->m * sizeof *r->across);
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        const mt_piece *const other = p + p->partner;
        const double *const bent = r->bent + ((ptrdiff_t)i * MT_LOCAL);
        if (p->equation >= 0) {
            r->across[p->equation] += p->factor * r->energy[i];
            mt_piece_add(p, p->equation < lin->m ? -2.0 * p->factor * r->mu[p->equation] : 0.0,
                         bent, r->pull);
            continue;
        }
        mt_piece_add(p, 2.0 * p->stiffness * mt_piece_work(other, phi), bent, r->pull);
        if (p->trim >= 0) {
            trim.of[p->trim] += r->energy[i];
        } else {
            mt_piece_add(other, p->stiffness * r->energy[i], other->g, r->pull);
        }
    }
    return trim;
}

/* The bound above [rad^2/s^2 kg m^2, as phi is normalised]; phi [nq]. O(nq) where the
 * equilibrium was found sparse, otherwise O(nq^2). */
static mt_status equilibrium_rounding_of(equilibrium_rounding *r, double lambda,
                                         const double *phi, double *noise, mt_err *err)
{
    mt_linear *const lin = r->lin;
    const mt_system *const sys = lin->sys;
    double sum = 0.0;
    MT_TRY(joint_forces(r, lambda, phi, err));
    const mt_trim_forces trim = sum_piece_forces(r, phi);
    MT_TRY(mt_newton_adjoint(&lin->position.equilibrium, r->pull, r->across, trim.of, r->x,
                             r->y, &lin->scratch, err));
    for (int i = 0; i < lin->n_pieces; i++) {
        const mt_piece *const p = &lin->pieces[i];
        const double way = fabs(r->energy[i] - mt_piece_work(p, r->x));
        if (p->equation < 0 && p->trim < 0) {
            sum += way *
                   ((fabs(p->stiffness) * p[p->partner].roundness) + (DBL_EPSILON * p->size));
        }
    }
    for (int i = 0; i < r->m; i++) {
        sum += fabs(r->y[i]) * r->roundness[i];
    }
    for (int b = 0; b < sys->n_bodies; b++) {
        for (int k = 0; k < 6; k++) {
            const int dof = sys->bodies[b].dof[k];
            const double arm = k < 3 ? 1.0 : sys->length_m;
            sum += dof >= 0 ? DBL_EPSILON * lin->push[b] * arm * fabs(r->x[dof]) : 0.0;
        }
    }
    *noise = ULPS * sum;
    return MT_OK;
}

/* Energies. */

/* p of the header: what the elimination, the eigensolution and Z y may do to an entry of a
 * shape, in eps of what is typical. */
static const double SHAPE_ULPS = 16.0;
/* An energy is nothing below 16 nq eps of its own terms, as in any matrix of these rooms. */
static const double ENERGY_ULPS = 16.0;
typedef struct entry {
    int row;
    int col;
    double value; /* of Kg; twice that off the diagonal */
    double terms;
} entry;

typedef struct worker {
    const mt_linear *lin;
    double *phi;     /* nq x cols */
    double *w;       /* [nq] */
    double *dz;      /* [nq] error of phi by that of the basis */
    mt_rows z_error; /* of the basis, column by column */
    entry *load;     /* lower triangle of Kg where it is not empty */
    int n_load;
    double shape; /* p eps of the header */
    equilibrium_rounding *rest;
} worker;

static mt_status list_entries(worker *k, mt_arena *mem, mt_err *err)
{
    const mt_linear *const lin = k->lin;
    const ptrdiff_t nq = lin->sys->nq;
    ptrdiff_t count = 0;
    for (ptrdiff_t i = 0; lin->kg != NULL && i < nq * nq; i++) {
        count += lin->kg_terms[i] != 0.0 || lin->kg[i] != 0.0 ? 1 : 0;
    }
    k->load = mt_arena_alloc(mem, (size_t)count, sizeof *k->load);
    MT_TRY(mt_arena_check(mem, err));
    for (ptrdiff_t j = 0; count > 0 && j < nq; j++) {
        for (ptrdiff_t i = j; i < nq; i++) {
            const double value = lin->kg[i + (j * nq)];
            const double terms = lin->kg_terms[i + (j * nq)];
            const double both = i == j ? 1.0 : 2.0;
            if (value != 0.0 || terms != 0.0) {
                k->load[k->n_load++] = (entry){(int)i, (int)j, both * value, both * terms};
            }
        }
    }
    return MT_OK;
}

/* Of a row f over the states. */
typedef struct elongation {
    double s;     /* f . phi */
    double terms; /* |f| . w */
    double open;  /* D */
} elongation;

static inline elongation row_part(const worker *w, int kind, int row, const double *phi)
{
    const mt_rows *const rows = &w->lin->full[kind];
    const double *const df = w->lin->full_error[kind];
    elongation out = {0.0, 0.0, 0.0};
    for (int k = rows->start[row]; k < rows->start[row + 1]; k++) {
        const int dof = rows->index[k];
        const double size = fabs(rows->value[k]);
        out.s += rows->value[k] * phi[dof];
        out.terms += size * w->w[dof];
        out.open += (size * w->dz[dof]) + (df[k] * fabs(phi[dof]));
    }
    return out;
}

/* Item of a term; springs of one item of the model are consecutive. */
static int item_of(const mt_linear *lin, int kind, const mt_term *t)
{
    return kind == MT_TERM_STIFFNESS ? lin->sys->springs[t->source].item : t->source;
}

/* Sums over terms: energies, noise without eps, sizes of the energies that may have
 * cancelled. */
typedef struct sums {
    double energy;
    double noise;
    double open; /* what is open of K_r or M_r as given */
    double size;
} sums;

/* c a b. */
static void add_energy_product(double c, const elongation *a, const elongation *b, bool moves,
                               sums *out)
{
    out->energy += c * a->s * b->s;
    out->noise += fabs(c) * ((fabs(a->s) * b->terms) + (fabs(b->s) * a->terms));
    out->open +=
        fabs(c) * ((fabs(a->s) * b->open) + (fabs(b->s) * a->open) + (a->open * b->open));
    out->size += moves ? fabs(c * a->s * b->s) : 0.0;
}

/* c a^2, to the same bits. */
static inline void add_square(double c, const elongation *a, bool moves, sums *out)
{
    const double size = fabs(a->s);
    const double energy = c * a->s * a->s;
    out->energy += energy;
    out->noise += fabs(c) * (2.0 * (size * a->terms));
    out->open += fabs(c) * ((2.0 * (size * a->open)) + (a->open * a->open));
    out->size += moves ? fabs(energy) : 0.0;
}

/* Add a term; true where its energy exceeds the rounding of its row's terms taken without
 * signs. */
static bool add_term_energy(const worker *k, int kind, const mt_term *t, const double *phi,
                            sums *out)
{
    const mt_linear *const lin = k->lin;
    const double c = lin->value[t->coefficient];
    const double tiny = ENERGY_ULPS * (double)lin->sys->nq * DBL_EPSILON;
    elongation p[2] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    bool moves = false;
    for (int r = 0; r < t->count && c != 0.0; r++) {
        const int side = t->pair ? r : 0;
        if (mt_rows_empty(&lin->entries[kind], t->first + r) && !t->pair) {
            continue; /* nothing but rounding */
        }
        p[side] = row_part(k, kind, t->first + r, phi);
        const bool moved = p[side].s * p[side].s > tiny * p[side].terms * p[side].terms;
        moves = moves || moved;
        if (!t->pair) {
            add_square(c, &p[0], moved, out);
        }
    }
    if (t->pair) {
        add_energy_product(c, &p[0], &p[1], moves, out);
    }
    return moves;
}

/* Energy and noise of all terms of a kind; *strained: any spring is strained. A bushing that
 * couples directions is one spring, whose terms may cancel. */
static void sum_terms(const worker *k, int kind, const double *phi, sums *all, bool *strained)
{
    const mt_linear *const lin = k->lin;
    const mt_term_list *const list = &lin->list[kind];
    const double tiny = ENERGY_ULPS * (double)lin->sys->nq * DBL_EPSILON;
    for (int i = 0; i < list->n_terms;) {
        const int item = item_of(lin, kind, &list->terms[i]);
        sums s = {0};
        bool moves = false;
        bool couples = false;
        for (; i < list->n_terms && item_of(lin, kind, &list->terms[i]) == item; i++) {
            couples = couples || list->terms[i].pair;
            moves = add_term_energy(k, kind, &list->terms[i], phi, &s) || moves;
        }
        all->energy += s.energy;
        all->noise += s.noise;
        all->open += s.open;
        *strained = *strained || (moves && (!couples || fabs(s.energy) > tiny * s.size));
    }
}

static mt_status energies_of_mode(const worker *k, int col, const double *y,
                                  const mt_energies *out, mt_err *err)
{
    const mt_linear *const lin = k->lin;
    const int nq = lin->sys->nq;
    const double *const phi = k->phi + ((ptrdiff_t)col * nq);
    const double typical = mt_norm2(lin->n, y) / sqrt((double)nq);
    sums stiffness = {0};
    sums mass = {0};
    bool strained = false;
    bool moves = false; /* masses do */
    double load = 0.0;
    for (ptrdiff_t j = 0; j < nq; j++) {
        k->w[j] = fabs(phi[j]) + lin->e.dc[j] * typical;
        k->dz[j] = 0.0;
    }
    for (int c = 0; c < lin->n; c++) {
        mt_rows_axpy(&k->z_error, c, fabs(y[c]), k->dz);
    }
    sum_terms(k, MT_TERM_STIFFNESS, phi, &stiffness, &strained);
    sum_terms(k, MT_TERM_MASS, phi, &mass, &moves);
    for (int i = 0; i < k->n_load; i++) {
        const entry *const e = &k->load[i];
        stiffness.energy += e->value * phi[e->row] * phi[e->col];
        load += e->terms *
                ((fabs(phi[e->row]) * k->w[e->col]) + (fabs(phi[e->col]) * k->w[e->row]));
        stiffness.open += e->terms * ((fabs(phi[e->row]) * k->dz[e->col]) +
                                      (fabs(phi[e->col]) * k->dz[e->row]));
    }
    const double lambda = mass.energy > 0.0 ? stiffness.energy / mass.energy : 0.0;
    double rest = 0.0;
    if (k->rest != NULL) {
        MT_TRY(equilibrium_rounding_of(k->rest, lambda, phi, &rest, err));
    }
    const double loads = (k->shape * load) + rest;
    out->stiffness[col] = stiffness.energy;
    out->mass[col] = mass.energy;
    out->given_noise[col] = loads + stiffness.open + (fabs(lambda) * mass.open);
    out->stiffness_noise[col] = (k->shape * stiffness.noise) + loads + stiffness.open;
    out->mass_noise[col] = (k->shape * mass.noise) + mass.open;
    out->strained[col] = strained;
    return MT_OK;
}

mt_status mt_linear_energies(mt_linear *lin, int cols, const double *y, const mt_energies *out,
                             mt_err *err)
{
    const size_t nq = (size_t)lin->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    worker k = {.lin = lin};
    k.shape = SHAPE_ULPS * DBL_EPSILON / lin->e.qr.kept;
    k.phi = mt_arena_f64(&lin->scratch, nq, (size_t)cols);
    k.w = mt_arena_f64(&lin->scratch, nq, 1);
    k.dz = mt_arena_f64(&lin->scratch, nq, 1);
    mt_status rc = mt_arena_check(&lin->scratch, err);
    rc = rc == MT_OK ? list_entries(&k, &lin->scratch, err) : rc;
    rc = rc == MT_OK ? equilibrium_rounding_new(lin, &k.rest, err) : rc;
    mt_rows_of_columns((int)nq, lin->n, lin->z_error, &lin->scratch, &k.z_error);
    rc = rc == MT_OK ? mt_arena_check(&lin->scratch, err) : rc;
    if (rc == MT_OK) {
        mt_linear_expand(lin, cols, y, k.phi);
        for (int c = 0; c < cols && rc == MT_OK; c++) {
            rc = energies_of_mode(&k, c, y + ((ptrdiff_t)c * lin->n), out, err);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return rc;
}
