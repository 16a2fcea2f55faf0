/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "response/response.h"

#include "linalg/dense.h"
#include "modal/damped.h"
#include "response/large.h"
#include "response/slopes_weighted.h"

void mt_response_free(mt_response *r)
{
    mt_arena_free(&r->mem);
    *r = (mt_response){.a = NULL};
}

static mt_status read_ports(mt_response *r, const mt_response_request *q, mt_err *err)
{
    const mt_system *const sys = r->sys;
    r->ports.n_in = q->n_in;
    r->ports.n_out = q->n_out > 0 ? q->n_out : sys->n_channels;
    r->ports.in = mt_arena_alloc(&r->mem, (size_t)r->ports.n_in, sizeof *r->ports.in);
    r->ports.out = mt_arena_alloc(&r->mem, (size_t)r->ports.n_out, sizeof *r->ports.out);
    MT_TRY(mt_arena_check(&r->mem, err));
    if (r->ports.n_in < 1 || r->ports.n_out < 1) {
        return mt_fail(err, MT_E_USAGE,
                       r->ports.n_in < 1 ? "a response needs an input"
                                         : "the configuration has no sensors: name outputs");
    }
    for (int i = 0; i < r->ports.n_in; i++) {
        MT_TRY(mt_port_input(sys, q->inputs[i], &r->mem, &r->ports.in[i], err));
    }
    for (int o = 0; o < r->ports.n_out; o++) {
        const char *const name = q->n_out > 0 ? q->outputs[o] : sys->channels[o].name;
        MT_TRY(mt_port_output(sys, name, &r->mem, &r->ports.out[o], err));
    }
    return MT_OK;
}

/* The position is an equilibrium: mt_response_problem refuses others. */
static mt_status find_growing(mt_response *r, mt_err *err)
{
    bool passive = true;
    r->growing = mt_modal_growing_pole(r->n_poles, r->poles, 0.0);
    if (r->growing >= 0) {
        MT_TRY(mt_modal_is_passive(r->f.n, r->f.c, r->f.h, &r->mem, &passive, err));
    }
    r->growing = passive ? -1 : r->growing;
    return MT_OK;
}

/* Everything derived from the matrices. */
static mt_status finish_response(mt_response *out, const mt_basis_problem *problem, bool direct,
                                 mt_err *err)
{
    MT_TRY(mt_basis_make(problem, &out->mem, &out->basis, err));
    MT_TRY(mt_response_pole_list(&out->basis, &out->mem, &out->n_poles, &out->poles, err));
    MT_TRY(find_growing(out, err));
    MT_TRY(mt_transfer_direct(&out->f, &out->mem, &out->direct, err));
    out->chosen = direct ? &out->direct : &out->basis.t;
    return MT_OK;
}

mt_status mt_response_open(mt_analysis *a, const mt_response_request *request, mt_response *out,
                           mt_err *err)
{
    *out = (mt_response){.a = a, .sys = a->sys, .modes = &a->modes};
    MT_TRY(mt_arena_init(&out->mem, 0, err));
    MT_TRY(read_ports(out, request, err));
    MT_TRY(mt_response_problem(a, &out->ports, &out->mem, &out->f, &out->ways, err));
    const mt_basis_problem problem = {
        .f = &out->f, .mass = &a->mass, .modes = &a->modes, .keep = request->modes};
    return finish_response(out, &problem, request->direct, err);
}

/* Makes the transfer of a basis of large->f (with all modes) bound the error of what is left
 * out. */
static mt_status bound_left_out(const mt_large *large, mt_basis *basis, mt_arena *mem,
                                mt_err *err)
{
    const int n = large->f.n;
    mt_left_out *const left = mt_arena_alloc(mem, 1, sizeof *left);
    double *const row = mt_arena_f64(mem, (size_t)n, (size_t)large->left->n_side);
    MT_TRY(mt_arena_check(mem, err));
    *left = *large->left;
    mt_gemm(true, false, n, left->n_side, n, 1.0, basis->x, n, large->left->row, n, 0.0, row,
            n);
    left->row = row;
    basis->t.left = left;
    return MT_OK;
}

mt_status mt_response_open_large(mt_lowest *l, const mt_response_request *request, double to,
                                 mt_response *out, bool *is, char why[MT_LARGE_WHY],
                                 mt_err *err)
{
    mt_large large;
    *out = (mt_response){.sys = l->sys, .modes = &l->found.modes};
    MT_TRY(mt_arena_init(&out->mem, 0, err));
    MT_TRY(read_ports(out, request, err));
    MT_TRY(mt_large_make(l, &out->ports, to, &out->mem, &large, is, why, err));
    if (!*is) {
        return MT_OK;
    }
    out->f = large.f;
    out->shapes = large.shapes;
    const mt_mass_factor mass = {.n = large.f.n, .rank = large.f.n};
    const mt_basis_problem problem = {.f = &out->f, .mass = &mass, .modes = &large.modes};
    MT_TRY(finish_response(out, &problem, false, err));
    return bound_left_out(&large, &out->basis, &out->mem, err);
}

mt_status mt_response_admit(const mt_response *r, mt_err *err)
{
    static const double TWO_PI = 6.283185307179586477;
    if (r->growing < 0) {
        return MT_OK;
    }
    const double complex s = r->poles[r->growing];
    return mt_fail(
        err, MT_E_EQUILIBRIUM,
        "unstable: a motion at %.6g Hz grows by exp(%.6g t/s), so there is no steady response",
        cimag(s) / TWO_PI, creal(s));
}

mt_status mt_response_curve(mt_response *r, const mt_curve_options *opt, mt_curve *out,
                            mt_err *err)
{
    mt_curve_options own = *opt;
    own.n_poles = r->n_poles;
    own.poles = r->poles;
    own.interrupt = r->sys->run->interrupt;
    return mt_curve_trace(r->chosen, &own, &r->mem, out, err);
}

static int nearest_pole(const mt_pole_sum *sum, double complex s)
{
    int best = -1;
    for (int k = 0; k < sum->n; k++) {
        best = best < 0 || cabs(sum->s[k] - s) < cabs(sum->s[best] - s) ? k : best;
    }
    return best;
}

mt_status mt_response_sums(mt_response *r, mt_pole_sum *out, mt_err *err)
{
    MT_TRY(mt_response_poles(&r->basis, &r->mem, out, err));
    for (int p = 0; p < r->ports.n_in * r->ports.n_out; p++) {
        out[p].judged = true;
        out[p].growing = r->growing < 0 ? -1 : nearest_pole(&out[p], r->poles[r->growing]);
    }
    return MT_OK;
}

/* The basis of all modes. */
static mt_status whole_basis(mt_response *r, mt_basis *out, mt_err *err)
{
    *out = r->basis;
    if (r->basis.n_left == 0) {
        return MT_OK;
    }
    const mt_basis_problem problem = {.f = &r->f, .mass = &r->a->mass, .modes = &r->a->modes};
    return mt_basis_make(&problem, &r->mem, out, err);
}

mt_status mt_response_slopes_at(mt_response *r, double w, double complex *dh, mt_err *err)
{
    mt_basis basis;
    const mt_slope_problem p = {
        .a = r->a, .basis = &basis, .ports = &r->ports, .ways = &r->ways};
    const mt_arena_mark mark = mt_arena_get_mark(&r->mem);
    MT_TRY(whole_basis(r, &basis, err));
    const mt_status rc = mt_response_slopes(&p, w, dh, &r->mem, err);
    mt_arena_rewind(&r->mem, mark);
    return rc;
}

mt_status mt_response_weighted_slopes(mt_response *r, int out, int in, int n, const double *w,
                                      const double complex *weight, double *slope, mt_err *err)
{
    mt_basis basis;
    const mt_slope_problem p = {
        .a = r->a, .basis = &basis, .ports = &r->ports, .ways = &r->ways};
    const mt_slope_weights q = {.out = out, .in = in, .n = n, .w = w, .weight = weight};
    const mt_arena_mark mark = mt_arena_get_mark(&r->mem);
    MT_TRY(whole_basis(r, &basis, err));
    const mt_status rc = mt_response_slopes_weighted(&p, &q, slope, &r->mem, err);
    mt_arena_rewind(&r->mem, mark);
    return rc;
}

mt_status mt_response_state_space(mt_response *r, int modes, double to, mt_state_space *out,
                                  mt_err *err)
{
    mt_basis basis;
    MT_TRY(whole_basis(r, &basis, err));
    int keep = modes;
    for (int i = 0; modes == 0 && i < basis.n_modes; i++) {
        keep += basis.lambda[i] <= to * to ? 1 : 0;
    }
    const mt_status rc = mt_state_space_make(&basis, keep, &r->mem, out, err);
    const char *const output =
        out->refused_output < 0 ? NULL : r->ports.out[out->refused_output].name;
    const char *const input =
        out->refused_input < 0 ? NULL : r->ports.in[out->refused_input].name;
    if (rc == MT_OK || (output == NULL && input == NULL)) {
        return rc;
    }
    return mt_err_in(err, rc, "%s%s%s", output == NULL ? "" : output,
                     output == NULL || input == NULL ? "" : " by ", input == NULL ? "" : input);
}
