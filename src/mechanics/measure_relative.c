/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Arithmetic of jets in the nine relative freedoms. Where no number carries a derivative the
 * sums over a Hessian are real: the same operations on the real parts, to the same bits.
 */
#include "mechanics/measure_priv.h"

#include <string.h>

/* [in the plane][span] */
static const mt_relative_list LISTS[2][MT_SPAN_ALL + 1] = {
    {{0, {0}},
     {3, {0, 1, 2}},
     {3, {3, 4, 5}},
     {6, {0, 1, 2, 3, 4, 5}},
     {3, {6, 7, 8}},
     {6, {0, 1, 2, 6, 7, 8}},
     {6, {3, 4, 5, 6, 7, 8}},
     {9, {0, 1, 2, 3, 4, 5, 6, 7, 8}}},
    {{0, {0}},
     {2, {0, 1}},
     {1, {5}},
     {3, {0, 1, 5}},
     {1, {8}},
     {3, {0, 1, 8}},
     {2, {5, 8}},
     {4, {0, 1, 5, 8}}},
};

const mt_relative_list *mt_relative_filled(mt_second second, unsigned span)
{
    return second == MT_SECOND_NONE ? &LISTS[0][0] : &LISTS[second == MT_SECOND_PLANE][span];
}

void mt_relative_clear(mt_relative_jet *j, mt_second second, unsigned span, bool real)
{
    j->value = 0.0;
    memset(j->g, 0, sizeof j->g);
    if (second) {
        memset(j->h, 0, sizeof j->h);
    }
    j->second = second;
    j->span = span;
    j->real = real;
}

void mt_relative_add_vec(mt_cx *g, double scale, const mt_cx *v)
{
    for (int i = 0; i < 3; i++) {
        g[i] += scale * v[i];
    }
}

void mt_relative_add_rotation(mt_relative_jet *j, int at, double scale, const mt_cx *n,
                              const mt_cx *w)
{
    const mt_cx dot = scale * cx_dot3(n, w);
    const double half = 0.5 * scale;
    const int first = j->second == MT_SECOND_PLANE ? 2 : 0; /* about z alone */
    for (int r = first; r < 3; r++) {
        mt_cx *const row = j->h + mt_relative_row(at + r) + at;
        for (int c = first; c <= r; c++) {
            if (j->real) {
                const double one = half * (creal(n[r]) * creal(w[c]));
                const double other = half * (creal(w[r]) * creal(n[c]));
                row[c] = row[c] + (one - (r == c ? creal(dot) : 0.0)) + other;
            } else {
                row[c] += (half * cx_mul(n[r], w[c])) - (r == c ? dot : 0.0);
                row[c] += half * cx_mul(w[r], n[c]);
            }
        }
    }
}

void mt_relative_add_cross(mt_relative_jet *j, int at, const mt_cx *u)
{
    const mt_cx m[9] = {0.0, u[2], -u[1], -u[2], 0.0, u[0], u[1], -u[0], 0.0};
    const bool plane = j->second == MT_SECOND_PLANE; /* theta about z, dd in x and y */
    for (int r = plane ? 2 : 0; r < 3; r++) {
        mt_cx *const row = j->h + mt_relative_row(at + r) + MT_AT_CHORD;
        for (int c = 0; c < (plane ? 2 : 3); c++) {
            row[c] += m[r + (3 * c)];
        }
    }
}

void mt_relative_add(mt_relative_jet *out, double scale, const mt_relative_jet *p)
{
    out->span |= p->span;
    out->real = out->real && p->real;
    out->value += scale * p->value;
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] += scale * p->g[i];
    }
    const mt_relative_list *const l = mt_relative_filled(out->second, p->span);
    for (int ii = 0; ii < l->n; ii++) {
        const int row = mt_relative_row(l->at[ii]);
        for (int kk = 0; kk <= ii; kk++) {
            out->h[row + l->at[kk]] += scale * p->h[row + l->at[kk]];
        }
    }
}

/*
 * A row of a Hessian of f(p, q), entries k of the list up to row i:
 *     h_ik (+)= fp p_ik + fq q_ik + x_k p_i + z_k q_i.
 */
typedef struct second_form {
    const mt_relative_jet *p;
    const mt_relative_jet *q;
    mt_cx fp;
    mt_cx fq;
    mt_cx x[MT_RELATIVE];
    mt_cx z[MT_RELATIVE];
} second_form;

static void add_real_row(const second_form *f, int i, const mt_relative_list *l, int entries,
                         mt_cx *row)
{
    const mt_cx *const p = f->p->h + mt_relative_row(i);
    const mt_cx *const q = f->q->h + mt_relative_row(i);
    const double fp = creal(f->fp);
    const double fq = creal(f->fq);
    const double pi = creal(f->p->g[i]);
    const double qi = creal(f->q->g[i]);
    for (int n = 0; n < entries; n++) {
        const int k = l->at[n];
        row[k] += (fp * creal(p[k])) + (fq * creal(q[k])) + (creal(f->x[k]) * pi) +
                  (creal(f->z[k]) * qi);
    }
}

static void add_second_form_row(const second_form *f, int i, const mt_relative_list *l,
                                int entries, mt_cx *row)
{
    const mt_cx *const p = f->p->h + mt_relative_row(i);
    const mt_cx *const q = f->q->h + mt_relative_row(i);
    for (int n = 0; n < entries; n++) {
        const int k = l->at[n];
        row[k] += cx_mul(f->fp, p[k]) + cx_mul(f->fq, q[k]) + cx_mul(f->x[k], f->p->g[i]) +
                  cx_mul(f->z[k], f->q->g[i]);
    }
}

static void add_second(const second_form *f, mt_relative_jet *out)
{
    const mt_relative_list *const l = mt_relative_filled(out->second, f->p->span | f->q->span);
    for (int n = 0; n < l->n; n++) {
        mt_cx *const row = out->h + mt_relative_row(l->at[n]);
        if (out->real) {
            add_real_row(f, l->at[n], l, n + 1, row);
        } else {
            add_second_form_row(f, l->at[n], l, n + 1, row);
        }
    }
}

/* x g, to the same bits without derivatives. */
static mt_cx times(bool real, mt_cx x, mt_cx g)
{
    return real ? cx_pair(creal(x) * creal(g), 0.0) : cx_mul(x, g);
}

void mt_relative_add_product(mt_relative_jet *out, mt_cx scale, const mt_relative_jet *p,
                             const mt_relative_jet *q)
{
    second_form f = {.p = q, .q = p};
    out->span |= p->span | q->span;
    out->real = out->real && p->real && q->real && cimag(scale) == 0.0;
    f.fp = cx_mul(scale, p->value);
    f.fq = cx_mul(scale, q->value);
    out->value += cx_mul(f.fp, q->value);
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] += times(out->real, f.fq, p->g[i]) + times(out->real, f.fp, q->g[i]);
    }
    if (out->second) {
        for (int i = 0; i < MT_RELATIVE; i++) {
            f.x[i] = times(out->real, scale, p->g[i]);
            f.z[i] = times(out->real, scale, q->g[i]);
        }
        add_second(&f, out);
    }
}

void mt_relative_chain(const mt_chain2 *c, const mt_relative_jet *p, const mt_relative_jet *q,
                       mt_relative_jet *out)
{
    const bool real = p->real && q->real;
    second_form f = {.p = p, .q = q};
    mt_relative_clear(out, p->second, p->span | q->span, real);
    out->value = c->f;
    f.fp = c->fp;
    f.fq = c->fq;
    for (int i = 0; i < MT_RELATIVE; i++) {
        out->g[i] = times(real, c->fp, p->g[i]) + times(real, c->fq, q->g[i]);
    }
    if (out->second) {
        for (int i = 0; i < MT_RELATIVE; i++) {
            f.x[i] = times(real, c->fpp, p->g[i]) + times(real, c->fpq, q->g[i]);
            f.z[i] = times(real, c->fpq, p->g[i]) + times(real, c->fqq, q->g[i]);
        }
        add_second(&f, out);
    }
}

void mt_relative_expand(const mt_relative_jet *j, mt_jet *out)
{
    out->value = j->value;
    out->second = j->second;
    for (int k = 0; k < MT_LOCAL; k++) {
        out->g[k] = mt_relative_sign(k) * j->g[mt_relative_of(k)];
    }
    for (int c = 0; c < MT_LOCAL && j->second; c++) {
        for (int r = c; r < MT_LOCAL; r++) {
            const double sign = mt_relative_sign(r) * mt_relative_sign(c);
            const mt_cx v = sign * j->h[mt_relative_pair(r, c)];
            out->h[r + (MT_LOCAL * c)] = v;
            out->h[c + (MT_LOCAL * r)] = v;
        }
    }
}
