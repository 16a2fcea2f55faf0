/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mechanics/curvature.h"

#include <string.h>

void mt_curvature_begin(mt_curvature_sum *s, const mt_system *sys, mt_lagrangian *out)
{
    s->out = out;
    s->sys = sys;
    s->empty = true;
    s->second = sys->dimension == 2 ? MT_SECOND_PLANE : MT_SECOND_ALL;
}

void mt_curvature_add_entry(mt_lagrangian *out, int nq, int r, int c, double value)
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

void mt_curvature_flush(mt_curvature_sum *s)
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
            mt_curvature_add_entry(out, nq, dof[r], dof[c], v);
            if (r != c) {
                mt_curvature_add_entry(out, nq, dof[c], dof[r], v);
            }
        }
    }
    s->empty = true;
}

static void open_pair(mt_curvature_sum *s, const int body[2])
{
    if (!s->empty && s->body[0] == body[0] && s->body[1] == body[1]) {
        return;
    }
    mt_curvature_flush(s);
    s->body[0] = body[0];
    s->body[1] = body[1];
    s->empty = false;
    memset(s->h, 0, sizeof s->h);
}

void mt_curvature_add(mt_curvature_sum *s, const int body[2], const mt_relative_jet *a,
                      const mt_relative_jet *b, mt_cx scale, mt_cx outer)
{
    const bool slope = s->out->slope;
    const bool curved = creal(scale) != 0.0 || cimag(scale) != 0.0;
    const bool squares = b != NULL && (creal(outer) != 0.0 || cimag(outer) != 0.0);
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
