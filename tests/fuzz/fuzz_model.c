/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Any bytes as a model, the whole way: file, positions, modes, slopes, damped modes, doubts, a
 * sweep. Whatever happens is a status with a text; numbers that come out are finite, ordered
 * and accounted for.
 */
#include <math.h>

#include "analysis/analysis.h"
#include "analysis/damping.h"
#include "answer/warnings.h"
#include "common/fuzz.h"
#include "io/json.h"
#include "linalg/dense.h"
#include "mechanics/info.h"
#include "mechanics/sweep.h"
#include "model/read.h"
#include "model/values.h"

/* Stiffness over mass [rad^2/s^2] beyond which slopes, products of two such numbers, may be no
 * doubles. */
static const double SLOPED_SCALE = 1e150;

/* Small enough for hundreds of models in a second. */
enum { MOST_PARTS = 24, MOST_ELEMENTS = 16, MOST_CONFIGURATIONS = 2, MOST_INPUTS = 3 };

static bool is_small(const mt_model *m)
{
    int elements = 0;
    for (int i = 0; i < m->n_links; i++) {
        elements += m->links[i].elements < MOST_ELEMENTS ? m->links[i].elements : MOST_ELEMENTS;
    }
    return m->n_bodies + m->n_springs + m->n_joints <= 3 * MOST_PARTS &&
           m->n_bodies <= MOST_PARTS && elements < MOST_ELEMENTS;
}

static void requirement_failed(mt_status rc, const mt_err *err)
{
    DEMAND(fuzz_is_refusal(rc));
    DEMAND(err->code == rc && err->text[0] != '\0');
}

static void requirement_modes(const mt_modes *m)
{
    DEMAND(m->count == m->n - m->n_condensed && m->count >= 0);
    for (int i = 0; i < m->count; i++) {
        DEMAND(isfinite(m->lambda[i]));
        DEMAND(i == 0 || m->lambda[i] >= m->lambda[i - 1]);
        DEMAND(m->error[i] >= 0.0);
        if (m->kind[i] == MT_MODE_FLEXIBLE) {
            DEMAND(m->lambda[i] >= 0.0);
        }
        for (int k = 0; k < m->n; k++) {
            DEMAND(isfinite(m->y[k + ((ptrdiff_t)i * m->n)]));
        }
    }
}

static void use_slopes(mt_analysis *a, int n, const double *at)
{
    mt_analysis_options opt = mt_analysis_options_default();
    mt_err err = {.code = MT_OK};
    opt.gradient = true;
    mt_status rc = mt_analysis_solve(a, at, &opt, &err);
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
        return;
    }
    requirement_modes(&a->modes);
    for (int i = 0; i < a->modes.count; i++) {
        double slope[MOST_INPUTS] = {0.0};
        bool repeated = false;
        rc = mt_analysis_dlambda(a, i, slope, &repeated, &err);
        if (rc != MT_OK) {
            requirement_failed(rc, &err);
            continue;
        }
        for (int k = 0; k < n; k++) {
            DEMAND(repeated || isfinite(slope[k]) || a->modes.scale > SLOPED_SCALE);
        }
    }
}

static void use_doubts(mt_analysis *a, mt_arena *mem, const uint8_t *data, size_t size)
{
    mt_warning_list warning_list = mt_warning_list_default(mem);
    mt_err err = {.code = MT_OK};
    mt_info info;
    const mt_status rc = mt_warnings_of_analysis(a, 0, NULL, NULL, &warning_list, &err);
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
        return;
    }
    mt_text said = {0};
    for (int i = 0; i < warning_list.n; i++) {
        DEMAND(warning_list.items[i].text != NULL);
        mt_text_addf(&said, "%s\n", warning_list.items[i].text);
    }
    fuzz_requirement_finite_words(&said, data, size);
    mt_text_free(&said);
    DEMAND(mt_info_fill(a->lin, &info, &err) == MT_OK);
    DEMAND(info.freedoms >= 0 && info.redundant >= 0 && info.mass_kg >= 0.0);
}

static void use_damping(mt_analysis *a, const double *at)
{
    const mt_analysis_options opt = mt_analysis_options_default();
    const mt_damped_modes *d = NULL;
    mt_err err = {.code = MT_OK};
    mt_status rc = mt_analysis_solve(a, at, &opt, &err);
    rc = rc == MT_OK ? mt_analysis_damped(a, &d, &err) : rc;
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
        return;
    }
    for (int i = 0; i < d->count; i++) {
        DEMAND(isfinite(d->re[i]) && isfinite(d->im[i]) && d->im[i] >= 0.0);
        DEMAND(d->kind[i] != MT_DAMPED_OSCILLATING || d->im[i] > 0.0);
    }
}

/* The first joint is taken a little to either side. */
static void use_sweep(const mt_model *m, int c, mt_arena *mem)
{
    const double positions[] = {-0.1, 0.05, 0.2};
    mt_system *sys = NULL;
    mt_linear *lin = NULL;
    mt_sweep sweep = {0};
    mt_err err = {.code = MT_OK};
    if (m->n_joints == 0) {
        return;
    }
    const mt_system_drive drive = {.joint = m->joints[0].name.s};
    mt_status rc = mt_system_new_of(
        &(mt_system_def){.model = m, .configuration = c, .drive = &drive, .at = &positions[1]},
        &sys, &err);
    rc = rc == MT_OK ? mt_linear_new(sys, &lin, &err) : rc;
    rc = rc == MT_OK
             ? mt_sweep_run(lin, &positions[1],
                            &(mt_sweep_plan){.n = MT_COUNT(positions), .positions = positions},
                            NULL, mem, &sweep, &err)
             : rc;
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
    }
    for (int i = 0; rc == MT_OK && i < sweep.n_points; i++) {
        const mt_sweep_point *const p = &sweep.points[i];
        DEMAND(p->status == MT_OK || (p->why != NULL && p->why[0] != '\0'));
        DEMAND(p->status != MT_OK || (isfinite(p->hold[0]) && isfinite(p->gap_m)));
    }
    mt_linear_delete(lin);
    mt_system_delete(sys);
}

static void use_configuration(const mt_model *m, int c, const double *original,
                              const uint8_t *data, size_t size)
{
    int inputs[MOST_INPUTS];
    double at[MOST_INPUTS];
    int n = 0;
    mt_err err = {.code = MT_OK};
    mt_analysis *a = NULL;
    mt_arena mem = {0};
    for (int i = 0; i < m->n_parameters && n < MOST_INPUTS; i++) {
        inputs[n] = i;
        at[n++] = original[i];
    }
    const mt_status rc = mt_analysis_new(m, c, n, inputs, at, &a, &err);
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
        DEMAND(a == NULL);
        return;
    }
    requirement_modes(&a->modes);
    use_doubts(a, &mem, data, size);
    use_slopes(a, n, at);
    use_damping(a, at);
    use_sweep(m, c, &mem);
    mt_analysis_delete(a);
    mt_arena_free(&mem);
}

static void use(const mt_model *m, const uint8_t *data, size_t size)
{
    mt_arena mem = {0};
    mt_err err = {.code = MT_OK};
    double *const original = mt_arena_f64(&mem, (size_t)m->n_parameters, 1);
    const mt_status rc = mt_model_original_values(m, &mem, original, NULL, &err);
    if (rc != MT_OK) {
        requirement_failed(rc, &err);
    }
    for (int c = 0; rc == MT_OK && c < m->n_configurations && c < MOST_CONFIGURATIONS; c++) {
        use_configuration(m, c, original, data, size);
    }
    mt_arena_free(&mem);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mt_json *doc = NULL;
    mt_model *model = NULL;
    mt_diagnostics said = {.count = 0};
    mt_status rc = mt_json_parse((const char *)data, size, &doc, NULL);
    mt_blas_set_threads(1);
    if (rc == MT_OK) {
        rc = mt_model_from_json(doc, "f", &model, NULL);
    }
    DEMAND(rc == MT_OK || rc == MT_E_INPUT);
    mt_json_report(doc, "f", &said);
    if (rc != MT_OK) {
        DEMAND(mt_hostile_diagnosed(said.lines.s, said.lines.length));
    } else if (is_small(model)) {
        use(model, data, size);
    }
    mt_diagnostics_free(&said);
    mt_model_delete(model);
    mt_json_delete(doc);
    return 0;
}
