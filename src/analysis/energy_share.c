/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * With phi_i = Z y_i over the states and q(phi) = phi^T Q phi, the share of the modes i of a
 * cluster C is
 *     s = sum_i q(phi_i)             of motion, as phi_i^T M phi_i = 1,
 *     s = tr(Y^T Q Y (Y^T K Y)^-1)   of strain, sum_i q(phi_i) / lambda with one lambda.
 * A dash is the derivative by an input, a_i = 2 Q phi_i the gradient of q. As phi_i' = Z y_i' +
 * Z' y_i and Z' y = -A^+ A' phi (mechanics/products.c),
 *     (sum_i q)' = sum_i [phi_i^T Q' phi_i - mu_i . A' phi_i + (Z^T a_i) . y_i'],
 *         A^T mu_i = a_i by least squares,
 * the last by the adjoint of the eigenproblem (modal/derivative.h). One adjoint for each mode
 * serves all inputs. Of strain, (Y^T K Y)' = Y^T (dK - lambda dM) Y takes
 *     1/lambda sum_ik (phi_i^T Q phi_k) y_k^T (dK - lambda dM) y_i,
 * which is the slope of the sum also where an input parts the modes.
 */
#include "analysis/energy_share.h"

#include <math.h>
#include <string.h>

#include "base/number.h"
#include "mechanics/forcing.h"
#include "modal/derivative.h"

/* One mode of a cluster over the states. */
typedef struct shape {
    const double *y; /* [n] */
    double *phi;     /* [nq] */
    double *w;       /* [nq] M phi */
} shape;

static mt_status expand(mt_analysis *a, int pos, mt_arena *mem, shape *out, mt_err *err)
{
    const size_t nq = (size_t)a->sys->nq;
    out->y = mt_modal_shape(&a->modes, pos);
    if (out->y == NULL) {
        return mt_fail(err, MT_E_INTERNAL, "the shape of mode %d was not computed", pos + 1);
    }
    out->phi = mt_arena_f64(mem, nq, 1);
    out->w = mt_arena_f64(mem, nq, 1);
    MT_TRY(mt_arena_check(mem, err));
    mt_linear_expand(a->lin, 1, out->y, out->phi);
    mt_linear_states_product(a->lin, MT_MATRIX_MASS, 1.0, out->phi, out->w);
    return MT_OK;
}

static double mean_lambda(const mt_modes *modes, int first, int size)
{
    double sum = 0.0;
    for (int i = first; i < first + size; i++) {
        sum += modes->lambda[i] / size;
    }
    return sum;
}

/* True where the modes strain anything: the energy that the shares divide by is not 0. */
static bool strains(const mt_modes *modes, int first)
{
    return modes->kind[first] != MT_MODE_RIGID_BODY && fabs(modes->lambda[first]) > 0.0;
}

/* The modes of a cluster: dky and dmy belong to the one at hand. */
typedef struct cluster {
    int first;
    int size;
    double lambda;
} cluster;

/* dsum[n_inputs] += the derivatives of q of the mode at pos, whose gradient is a_i. */
static mt_status add_slopes(mt_analysis *a, const cluster *c, int pos, const shape *s,
                            const mt_energy_part *part, const double *gradient, double *dsum,
                            mt_err *err)
{
    const int n = mt_linear_freedoms(a->lin);
    const size_t m = (size_t)mt_linear_equations(a->lin);
    const mt_reduced r = mt_linear_reduced(a->lin);
    const mt_pencil pencil = {.n = r.n, .k = r.k, .m = r.m};
    double *const b = mt_arena_f64(&a->mem, (size_t)n, 1);
    double *const x = mt_arena_f64(&a->mem, (size_t)n, 1);
    double *const mu = mt_arena_f64(&a->mem, m, 1);
    double *const blocked = mt_arena_f64(&a->mem, m, 1);
    MT_TRY(mt_arena_check(&a->mem, err));
    MT_TRY(mt_analysis_products(a, pos, err));
    MT_TRY(mt_linear_complete(a->lin, err));
    mt_linear_project(a->lin, gradient, b);
    MT_TRY(mt_linear_multipliers(a->lin, gradient, mu, err));
    MT_TRY(mt_modal_adjoint(&pencil, &a->modes, c->first, c->size, b, x, &a->mem, err));
    for (int p = 0; p < a->sys->n_inputs; p++) {
        const double *const dky = a->dky + ((ptrdiff_t)p * n);
        const double *const dmy = a->dmy + ((ptrdiff_t)p * n);
        double own = 0.0;
        MT_TRY(mt_energy_part_slope(a->lin, part, p, s->phi, s->w, &own, err));
        mt_linear_jacobian_slope(a->lin, p, s->phi, blocked);
        dsum[p] += own - mt_dot((int)m, mu, blocked) - mt_dot(n, x, dky) +
                   (a->modes.lambda[pos] * mt_dot(n, x, dmy));
        for (int k = c->first; k < c->first + c->size; k++) {
            const double *const yk = mt_modal_shape(&a->modes, k);
            const double mass = mt_dot(n, yk, dmy);
            const double dlambda = mt_dot(n, yk, dky) - (c->lambda * mass);
            const double scaled = part->kind == MT_ENERGY_MOTION ? 0.0 : dlambda / c->lambda;
            dsum[p] -= 0.5 * mt_dot(n, yk, b) * (mass + scaled);
        }
    }
    return MT_OK;
}

/* *sum: of q over the cluster, with dsum[n_inputs] unless NULL. */
static mt_status sum_over(mt_analysis *a, const cluster *c, const mt_energy_part *part,
                          double *sum, double *dsum, mt_err *err)
{
    const size_t nq = (size_t)a->sys->nq;
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    mt_status rc = MT_OK;
    *sum = 0.0;
    for (int i = c->first; i < c->first + c->size && rc == MT_OK; i++) {
        shape s = {.y = NULL};
        double q = 0.0;
        double *const gradient = dsum == NULL ? NULL : mt_arena_f64(&a->mem, nq, 1);
        rc = mt_arena_check(&a->mem, err);
        rc = rc == MT_OK ? expand(a, i, &a->mem, &s, err) : rc;
        rc = rc == MT_OK ? mt_energy_part_value(a->lin, part, s.phi, s.w, &q, gradient, err)
                         : rc;
        *sum += q;
        rc = rc == MT_OK && dsum != NULL ? add_slopes(a, c, i, &s, part, gradient, dsum, err)
                                         : rc;
        mt_arena_rewind(&a->mem, mark);
    }
    return rc;
}

mt_status mt_analysis_energy_share(mt_analysis *a, int pos, const mt_energy_part *part,
                                   double *share, double *dshare, mt_err *err)
{
    const int np = a->sys->n_inputs;
    cluster c = {.size = 1};
    c.first = mt_modal_cluster(&a->modes, pos, &c.size);
    c.lambda = mean_lambda(&a->modes, c.first, c.size);
    if (dshare != NULL) {
        memset(dshare, 0, (size_t)np * sizeof *dshare);
    }
    if (part->kind == MT_ENERGY_MOTION) {
        return sum_over(a, &c, part, share, dshare, err);
    }
    if (!strains(&a->modes, c.first)) {
        return mt_fail(err, MT_E_DOMAIN, "configuration \"%s\": a mode at 0 Hz strains nothing",
                       mt_analysis_configuration(a));
    }
    MT_TRY(sum_over(a, &c, part, share, dshare, err));
    *share /= c.lambda;
    for (int p = 0; p < np && dshare != NULL; p++) {
        dshare[p] /= c.lambda;
    }
    return MT_OK;
}

mt_status mt_analysis_most_energy(mt_analysis *a, const mt_energy_part *part, int *pos,
                                  mt_err *err)
{
    double most = -HUGE_VAL;
    *pos = -1;
    for (int i = 0; i < a->modes.count;) {
        int size = 1;
        double share = 0.0;
        const int first = mt_modal_cluster(&a->modes, i, &size);
        const bool vibrates = a->modes.kind[first] == MT_MODE_FLEXIBLE &&
                              (part->kind == MT_ENERGY_MOTION || strains(&a->modes, first));
        if (vibrates) {
            MT_TRY(mt_analysis_energy_share(a, first, part, &share, NULL, err));
        }
        if (vibrates && mt_exceeds(share, most)) {
            most = share;
            *pos = first;
        }
        i = first + size;
    }
    return MT_OK;
}

/* All shares */

/* Adds the shares of the mode at hand of one owner to out[6]. */
static mt_status add_owner(mt_analysis *a, const shape *s, mt_energy_part *part, int n_parts,
                           double divisor, double *out, mt_err *err)
{
    for (int k = 0; k < n_parts; k++) {
        double q = 0.0;
        part->direction = n_parts == 1 ? MT_ABSENT : k;
        MT_TRY(mt_energy_part_value(a->lin, part, s->phi, s->w, &q, NULL, err));
        out[k] += q / divisor;
    }
    return MT_OK;
}

/* The six shares of a body; along the global axes, and *global, where it has no others. */
static mt_status add_body(mt_analysis *a, const shape *s, mt_energy_part *part, double *out,
                          bool *global, mt_err *err)
{
    double own[MT_ENERGY_DIRECTIONS] = {0.0};
    mt_err why = {.code = MT_OK};
    mt_status rc = add_owner(a, s, part, MT_ENERGY_DIRECTIONS, 1.0, own, &why);
    *global = part->axes == MT_ENERGY_AXES_GLOBAL;
    if (rc == MT_E_DOMAIN && !*global) {
        memset(own, 0, sizeof own);
        part->axes = MT_ENERGY_AXES_GLOBAL;
        *global = true;
        rc = add_owner(a, s, part, MT_ENERGY_DIRECTIONS, 1.0, own, &why);
    }
    for (int k = 0; k < MT_ENERGY_DIRECTIONS; k++) {
        out[k] += own[k];
    }
    return rc == MT_OK ? MT_OK : mt_fail(err, rc, "%s", why.text);
}

static mt_status add_mode(mt_analysis *a, const shape *s, double lambda,
                          const mt_energy_owners *owners, const mt_energy_about *about,
                          mt_energy_shares *out, mt_err *err)
{
    mt_energy_part part;
    double loads = 0.0;
    for (int b = 0; b < owners->n_bodies; b++) {
        MT_TRY(mt_energy_part_init(a->sys, MT_ENERGY_MOTION, &owners->bodies[b], MT_ABSENT,
                                   about, &a->mem, &part, err));
        MT_TRY(add_body(a, s, &part, out->motion + ((ptrdiff_t)b * MT_ENERGY_DIRECTIONS),
                        &out->global[b], err));
    }
    for (int k = 0; k < owners->n_springs; k++) {
        const mt_energy_owner *const o = &owners->springs[k];
        MT_TRY(mt_energy_part_init(a->sys, MT_ENERGY_STRAIN, o, MT_ABSENT, NULL, &a->mem, &part,
                                   err));
        MT_TRY(add_owner(a, s, &part, o->bushing ? MT_ENERGY_DIRECTIONS : 1, lambda,
                         out->strain + ((ptrdiff_t)k * MT_ENERGY_DIRECTIONS), err));
    }
    MT_TRY(mt_energy_part_init(a->sys, MT_ENERGY_LOADS, NULL, MT_ABSENT, NULL, &a->mem, &part,
                               err));
    MT_TRY(add_owner(a, s, &part, 1, lambda, &loads, err));
    out->loads += loads;
    return MT_OK;
}

mt_status mt_analysis_energy_shares(mt_analysis *a, int pos, const mt_energy_owners *owners,
                                    const mt_energy_about *about, mt_arena *mem,
                                    mt_energy_shares *out, mt_err *err)
{
    *out = (mt_energy_shares){.modes = 1};
    out->first = mt_modal_cluster(&a->modes, pos, &out->modes);
    const bool strained = strains(&a->modes, out->first);
    const double lambda = strained ? mean_lambda(&a->modes, out->first, out->modes) : nan("");
    const int motions = owners->n_bodies * MT_ENERGY_DIRECTIONS;
    const int strain = owners->n_springs * MT_ENERGY_DIRECTIONS;
    out->motion = mt_arena_f64(mem, (size_t)motions, 1);
    out->strain = mt_arena_f64(mem, (size_t)strain, 1);
    out->global = mt_arena_alloc(mem, (size_t)owners->n_bodies, sizeof *out->global);
    MT_TRY(mt_arena_check(mem, err));
    const mt_arena_mark mark = mt_arena_get_mark(&a->mem);
    for (int i = out->first; i < out->first + out->modes; i++) {
        shape s = {.y = NULL};
        MT_TRY(expand(a, i, &a->mem, &s, err));
        MT_TRY(add_mode(a, &s, lambda, owners, about, out, err));
        mt_arena_rewind(&a->mem, mark);
    }
    for (int i = 0; i < motions; i++) {
        out->motion_sum += out->motion[i];
    }
    for (int i = 0; i < strain; i++) {
        out->strain_sum += out->strain[i];
    }
    out->strain_sum += out->loads;
    return MT_OK;
}
