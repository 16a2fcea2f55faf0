/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Shares of the energies of a mode phi, term by term over the rows f of stiffness and mass:
 *     spring s   sum_t c_t (f_t . phi)^2 over its terms,
 *     body b     sum_t m_t (f_t . phi) sum_(i of b) f_ti phi_i,
 * the second being what the body's own momentum does, which adds up to phi^T M phi = 1. What is
 * left of lambda besides the springs is done by loads (geometric stiffness) and counts by its
 * magnitude: so shares never add up to more than 1, and stay what they are where a load takes
 * stiffness away.
 */
#include "scene/scene_priv.h"

#include <math.h>
#include <stddef.h>

#include "mechanics/data.h"
#include "mechanics/lagrangian.h"
#include "mechanics/rows.h"

struct mt_scene_energy {
    const mt_scene_frame *f;
    mt_term_list list[MT_TERM_KINDS];
    double *rows[MT_TERM_KINDS]; /* 12 x n_rows, of stiffness and mass */
};

mt_status mt_scene_energy_new(const mt_scene_frame *f, mt_scene_energy **out, mt_err *err)
{
    static const mt_term_kind kinds[] = {MT_TERM_STIFFNESS, MT_TERM_MASS};
    mt_scene_energy *const e = mt_arena_alloc(f->work, 1, sizeof *e);
    mt_data data;
    MT_TRY(mt_arena_check(f->work, err));
    e->f = f;
    MT_TRY(mt_terms_new(f->sys, f->work, e->list, err));
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        const size_t size = (size_t)e->list[kinds[i]].n_rows * MT_LOCAL;
        e->rows[kinds[i]] = mt_arena_f64(f->work, size, 1);
    }
    const mt_arena_mark mark = mt_arena_get_mark(f->work);
    MT_TRY(mt_data_init(&data, f->sys, f->work, err));
    data.value = f->value;
    mt_data_vecs(&data);
    for (int i = 0; i < MT_COUNT(kinds); i++) {
        const size_t size = (size_t)e->list[kinds[i]].n_rows * MT_LOCAL;
        mt_cx *const rows = mt_arena_alloc(f->work, size, sizeof *rows);
        MT_TRY(mt_arena_check(f->work, err));
        mt_rows_eval(&data, kinds[i], &e->list[kinds[i]], f->pose, rows);
        for (size_t k = 0; k < size; k++) {
            e->rows[kinds[i]][k] = creal(rows[k]);
        }
    }
    mt_arena_rewind(f->work, mark);
    *out = e;
    return MT_OK;
}

/* f . phi by the freedoms of either body of a term: part[2]; returns their sum. */
static double row_mode_product(const mt_system *sys, const mt_term *t, const double *row,
                               const double *phi, double part[2])
{
    part[0] = 0.0;
    part[1] = 0.0;
    for (int k = 0; k < MT_LOCAL; k++) {
        const int dof = mt_local_dof(sys, t->body, k);
        part[k / 6] += dof >= 0 ? row[k] * phi[dof] : 0.0;
    }
    return part[0] + part[1];
}

/* What a term adds to the energy, by the bodies that it acts on. */
static double term_energy(const mt_scene_energy *e, mt_term_kind kind, const mt_term *t,
                          const double *phi, double of[2])
{
    const mt_system *const sys = e->f->sys;
    const double *const rows = e->rows[kind] + ((ptrdiff_t)t->first * MT_LOCAL);
    const double c = e->f->value[t->coefficient];
    double a[2];
    double b[2];
    of[0] = 0.0;
    of[1] = 0.0;
    if (t->pair) {
        const double sa = row_mode_product(sys, t, rows, phi, a);
        const double sb = row_mode_product(sys, t, rows + MT_LOCAL, phi, b);
        for (int side = 0; side < 2; side++) {
            of[side] = 0.5 * c * ((sa * b[side]) + (sb * a[side]));
        }
        return c * sa * sb;
    }
    double sum = 0.0;
    for (int r = 0; r < t->count; r++) {
        const double s = row_mode_product(sys, t, rows + ((ptrdiff_t)r * MT_LOCAL), phi, a);
        sum += c * s * s;
        of[0] += c * s * a[0];
        of[1] += c * s * a[1];
    }
    return sum;
}

/* Normalise energies by their sum and |rest|; negative ones, which are rounding, become 0. */
static void share_out(int n, double *energy, double rest)
{
    double sum = fabs(rest);
    for (int i = 0; i < n; i++) {
        energy[i] = fmax(energy[i], 0.0);
        sum += energy[i];
    }
    for (int i = 0; i < n; i++) {
        energy[i] = sum > 0.0 && isfinite(sum) ? energy[i] / sum : 0.0;
    }
}

void mt_scene_energy_of(const mt_scene_energy *e, double lambda, const double *phi,
                        double *spring, double *body)
{
    const mt_scene_view *const v = e->f->view;
    const mt_term_list *const stiffness = &e->list[MT_TERM_STIFFNESS];
    const mt_term_list *const mass = &e->list[MT_TERM_MASS];
    double elastic = 0.0;
    double of[2];
    for (int i = 0; i < stiffness->n_terms; i++) {
        const mt_term *const t = &stiffness->terms[i];
        const double energy = term_energy(e, MT_TERM_STIFFNESS, t, phi, of);
        const int at = e->f->spring_of[t->source];
        if (at >= 0) {
            spring[at] += energy;
        }
        elastic += energy;
    }
    for (int i = 0; i < mass->n_terms; i++) {
        const mt_term *const t = &mass->terms[i];
        (void)term_energy(e, MT_TERM_MASS, t, phi, of);
        body[t->body[0] + 1] += of[0];
        body[t->body[1] + 1] += of[1];
    }
    share_out(v->n_springs, spring,
              e->f->sys->loaded || e->f->sys->driven ? lambda - elastic : 0.0);
    share_out(v->n_bodies, body, 0.0);
}
