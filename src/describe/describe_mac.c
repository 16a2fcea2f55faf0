/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * How much the modes of a configuration are those of a reference that goals compare one of them
 * with: MAC_ij = (a_i . b_j)^2 / (|a_i|^2 |b_j|^2) at the sensors that both have. One mode that
 * has become another, or two that have changed places, are seen beside the diagonal.
 */
#include <math.h>

#include "describe/describe.h"

/* Modes of a reference that are compared at most: a table of more says nothing to anybody. */
enum { REFERENCE_MODES = 24 };

/* True where it is the first goal that compares shapes of this configuration with that
 * reference. */
static bool is_first(const mt_problem *p, int i)
{
    const mt_requirement *const d = &p->requirements[i];
    for (int k = 0; k < i; k++) {
        const mt_requirement *const e = &p->requirements[k];
        if (e->shape.ns > 0 && e->view == d->view && e->goal->reference == d->goal->reference) {
            return false;
        }
    }
    return d->shape.ns > 0;
}

/* The modes of the reference that move at common sensors, as many as the configuration has
 * listed, or was measured; shapes in mem. */
static mt_status compared_with(const mt_problem *p, const mt_requirement *d, int listed,
                               mt_arena *mem, mt_reference_shape *shapes, int *n, mt_err *err)
{
    const mt_reference *const r = &p->study->references[d->goal->reference];
    const int most = r->model == NULL ? r->n_modes : listed;
    *n = 0;
    for (int k = 1; k <= most && k <= REFERENCE_MODES; k++) {
        mt_err why = {.code = MT_OK};
        const mt_status rc = mt_reference_shape_init(p->references, d->goal->reference, k,
                                                     p->views[d->view].original->sys,
                                                     d->goal->length, mem, &shapes[*n], &why);
        MT_TRY(mt_pass_final(rc, &why, err));
        *n += rc == MT_OK ? 1 : 0;
    }
    return MT_OK;
}

static mt_status describe_rows(mt_analysis *a, int listed, const mt_reference_shape *shapes,
                               mt_arena *mem, mt_result_mac *m, mt_err *err)
{
    const int n = m->n_reference_modes;
    m->rows = mt_arena_alloc(mem, (size_t)listed, sizeof *m->rows);
    MT_TRY(mt_arena_check(mem, err));
    for (int mode = 1; mode <= listed; mode++) {
        const int pos = mt_modal_flexible(&a->modes, mode);
        mt_result_mac_row row = {.mode = mode, .n_values = n};
        row.values = mt_arena_f64(mem, (size_t)n, 1);
        MT_TRY(mt_arena_check(mem, err));
        bool moves = pos >= 0;
        for (int j = 0; j < n && moves; j++) {
            MT_TRY(mt_reference_mac(a, pos, &shapes[j], &row.values[j], err));
            moves = isfinite(row.values[j]);
        }
        if (moves) {
            m->rows[m->n_rows++] = row;
        }
    }
    return MT_OK;
}

static mt_status describe_one(const mt_problem *p, const mt_requirement *d, mt_analysis *a,
                              int listed, mt_arena *scratch, mt_result *result,
                              mt_result_mac *m, mt_err *err)
{
    mt_arena *const mem = &result->mem;
    mt_reference_shape *const shapes = mt_arena_alloc(scratch, REFERENCE_MODES, sizeof *shapes);
    MT_TRY(mt_arena_check(scratch, err));
    m->configuration = mt_analysis_configuration(a);
    m->reference = p->study->references[d->goal->reference].name.s;
    MT_TRY(compared_with(p, d, listed, scratch, shapes, &m->n_reference_modes, err));
    m->reference_modes = mt_arena_f64(mem, (size_t)m->n_reference_modes, 1);
    MT_TRY(mt_arena_check(mem, err));
    for (int j = 0; j < m->n_reference_modes; j++) {
        m->reference_modes[j] = (double)shapes[j].mode;
    }
    return describe_rows(a, listed, shapes, mem, m, err);
}

mt_status mt_describe_mac(const mt_problem *p, int view, mt_analysis *a, int listed,
                          mt_result *result, mt_recommendation *rec, mt_err *err)
{
    mt_arena scratch;
    if (rec->macs == NULL) {
        rec->macs = mt_arena_alloc(&result->mem, (size_t)p->n_requirements, sizeof *rec->macs);
    }
    MT_TRY(mt_arena_check(&result->mem, err));
    MT_TRY(mt_arena_init(&scratch, 0, err));
    mt_status rc = MT_OK;
    for (int i = 0; i < p->n_requirements && rc == MT_OK; i++) {
        if (p->requirements[i].view == view && is_first(p, i)) {
            mt_result_mac *const m = &rec->macs[rec->n_macs++];
            *m = (mt_result_mac){.configuration = NULL};
            rc = describe_one(p, &p->requirements[i], a, listed, &scratch, result, m, err);
        }
    }
    mt_arena_free(&scratch);
    return rc;
}
