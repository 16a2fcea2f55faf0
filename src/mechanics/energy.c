/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/energy.h"

#include "mechanics/linear_priv.h"

#include <float.h>
#include <math.h>

/* p of the header: what the elimination, the eigensolution and Z y may do to an entry of a
 * shape, in eps of what is typical. */
static const double SHAPE_ULPS = 16.0;
/* An energy is nothing below 16 nq eps of its own terms, as in any matrix of these rooms. */
static const double ENERGY_ULPS = 16.0;
/* Forces of an equilibrium are known to a few times its residual, and so is its place, which
 * the springs' rows depend on: what an unbalanced force r moves, r/K, changes them by as much
 * as r changes Kg, with a moderate factor. */
static const double RESIDUALS = 32.0;

/* A step that is left is known to a few parts of itself: the residual that it comes from is
 * mostly rounding, the rounding of what was evaluated there. */
static const double STEPS = 4.0;

typedef struct entry {
    int row;
    int col;
    double value; /* of Kg; twice that off the diagonal */
    double terms;
} entry;

typedef struct worker {
    const mt_linear *lin;
    double *phi; /* nq x cols */
    double *w;   /* [nq] */
    entry *load; /* lower triangle of Kg where it is not empty */
    int n_load;
    double unbalanced; /* relative error of the forces */
    double shape;      /* p eps of the header */
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

/* f . phi and |f| . w of a row. */
static double row_part(const mt_rows *rows, int row, const double *phi, const double *w,
                       double *terms)
{
    double s = 0.0;
    *terms = 0.0;
    for (int k = rows->start[row]; k < rows->start[row + 1]; k++) {
        s += rows->value[k] * phi[rows->index[k]];
        *terms += fabs(rows->value[k]) * w[rows->index[k]];
    }
    return s;
}

/* Springs of one item of the model stand together. */
static int item_of(const mt_linear *lin, int kind, const mt_term *t)
{
    return kind == MT_TERM_STIFFNESS ? lin->sys->springs[t->source].item : t->source;
}

/* Sums over terms: energies, noise without eps, sizes of the energies that may have
 * cancelled. */
typedef struct sums {
    double energy;
    double noise;
    double size;
} sums;

/* Returns whether the energy of the term is more than rounding of what its row, without the
 * signs, would have. */
static bool add_term(const worker *k, int kind, const mt_term *t, const double *phi, sums *out)
{
    const mt_linear *const lin = k->lin;
    const double c = lin->value[t->coefficient];
    const double tiny = ENERGY_ULPS * (double)lin->sys->nq * DBL_EPSILON;
    double part[2] = {0.0, 0.0};
    double terms[2] = {0.0, 0.0};
    bool moves = false;
    for (int r = 0; r < t->count && c != 0.0; r++) {
        const int side = t->pair ? r : 0;
        if (mt_rows_empty(&lin->entries[kind], t->first + r) && !t->pair) {
            continue; /* nothing but rounding */
        }
        part[side] = row_part(&lin->full[kind], t->first + r, phi, k->w, &terms[side]);
        const bool moved = part[side] * part[side] > tiny * terms[side] * terms[side];
        moves = moves || moved;
        if (!t->pair) {
            out->energy += c * part[0] * part[0];
            out->noise += 2.0 * fabs(c * part[0]) * terms[0];
            out->size += moved ? fabs(c * part[0] * part[0]) : 0.0;
        }
    }
    if (t->pair) {
        out->energy += c * part[0] * part[1];
        out->noise += fabs(c) * (fabs(part[0]) * terms[1] + fabs(part[1]) * terms[0]);
        out->size += moves ? fabs(c * part[0] * part[1]) : 0.0;
    }
    return moves;
}

/* Energy and noise of all terms of a kind, and whether any spring is strained. A bushing that
 * couples directions is one spring, of which the terms may cancel. */
static void sum_terms(const worker *k, int kind, const double *phi, double *energy,
                      double *noise, bool *strained)
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
            moves = add_term(k, kind, &list->terms[i], phi, &s) || moves;
        }
        *energy += s.energy;
        *noise += s.noise;
        *strained = *strained || (moves && (!couples || fabs(s.energy) > tiny * s.size));
    }
}

/* What is open of phi^T Kg phi by the forces: an error of a force scales its whole energy. */
static double force_energies(const worker *k, const double *phi)
{
    const mt_linear *const lin = k->lin;
    double sum = 0.0;
    for (int i = 0; i < lin->n_pieces && lin->kg != NULL; i++) {
        const mt_piece *const p = &lin->pieces[i];
        double energy = 0.0;
        for (int c = 0; c < MT_LOCAL; c++) {
            double part = 0.0;
            for (int r = 0; r < MT_LOCAL && p->dof[c] >= 0; r++) {
                part += p->dof[r] >= 0 ? p->h[r + (MT_LOCAL * c)] * phi[p->dof[r]] : 0.0;
            }
            energy += p->dof[c] >= 0 ? part * phi[p->dof[c]] : 0.0;
        }
        sum += ((k->unbalanced * p->size) + (STEPS * p->open)) * fabs(energy);
    }
    return sum;
}

static void one(const worker *k, int col, const double *y, const mt_energies *out)
{
    const mt_linear *const lin = k->lin;
    const int nq = lin->sys->nq;
    const double *const phi = k->phi + ((ptrdiff_t)col * nq);
    const double typical = mt_norm2(lin->n, y) / sqrt((double)nq);
    double energy[2] = {0.0, 0.0};
    double noise[2] = {0.0, 0.0};
    bool strained = false;
    bool moves = false; /* masses do */
    double load = 0.0;
    for (int j = 0; j < nq; j++) {
        k->w[j] = fabs(phi[j]) + lin->e.dc[j] * typical;
    }
    sum_terms(k, MT_TERM_STIFFNESS, phi, &energy[0], &noise[0], &strained);
    sum_terms(k, MT_TERM_MASS, phi, &energy[1], &noise[1], &moves);
    for (int i = 0; i < k->n_load; i++) {
        const entry *const e = &k->load[i];
        energy[0] += e->value * phi[e->row] * phi[e->col];
        load += e->terms *
                ((fabs(phi[e->row]) * k->w[e->col]) + (fabs(phi[e->col]) * k->w[e->row]));
    }
    out->stiffness[col] = energy[0];
    out->mass[col] = energy[1];
    out->load_noise[col] = (k->shape * load) + force_energies(k, phi);
    out->stiffness_noise[col] = (k->shape * noise[0]) + out->load_noise[col];
    out->mass_noise[col] = k->shape * noise[1];
    out->strained[col] = strained;
}

mt_status mt_linear_energies(mt_linear *lin, int cols, const double *y, const mt_energies *out,
                             mt_err *err)
{
    const size_t nq = (size_t)lin->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&lin->scratch);
    worker k = {.lin = lin};
    k.unbalanced = RESIDUALS * lin->position.equilibrium.residual;
    k.shape = SHAPE_ULPS * DBL_EPSILON / lin->e.qr.kept;
    k.phi = mt_arena_f64(&lin->scratch, nq, (size_t)cols);
    k.w = mt_arena_f64(&lin->scratch, nq, 1);
    mt_status rc = mt_arena_check(&lin->scratch, err);
    rc = rc == MT_OK ? list_entries(&k, &lin->scratch, err) : rc;
    if (rc == MT_OK) {
        mt_linear_expand(lin, cols, y, k.phi);
        for (int c = 0; c < cols; c++) {
            one(&k, c, y + ((ptrdiff_t)c * lin->n), out);
        }
    }
    mt_arena_rewind(&lin->scratch, mark);
    return rc;
}
