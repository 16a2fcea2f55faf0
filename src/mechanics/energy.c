/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/energy.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>

#include "mechanics/equilibrium_rounding.h"

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
    mt_equilibrium_rounding *rest;
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
        MT_TRY(mt_equilibrium_rounding_of(k->rest, lambda, phi, &rest, err));
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
    rc = rc == MT_OK ? mt_equilibrium_rounding_new(lin, &k.rest, err) : rc;
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
