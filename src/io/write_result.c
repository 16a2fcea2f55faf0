/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result.json: everything that a study answered, and nothing about where, when or with how many
 * workers. */
#include <math.h>

#include "io/io.h"

/* A list of objects, one per item. */
#define WRITE_LIST(w, name, n, items, write) \
    do {                                     \
        mt_json_open((w), (name), '[');      \
        for (int i = 0; i < (n); i++) {      \
            write((w), &(items)[i]);         \
        }                                    \
        mt_json_close(w);                    \
    } while (0)

static void write_strings(mt_json_writer *w, const char *name, int n, const char *const *items)
{
    mt_json_open(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_put_string(w, NULL, items[i]);
    }
    mt_json_close(w);
}

/* How a change of the parameter counts. */
static void write_measure(mt_json_writer *w, const mt_result_parameter *p)
{
    const bool linear = p->measure_scale > 0.0;
    const bool floor = p->measure_floor > 0.0;
    mt_json_put_string(w, "measure",
                       linear  ? "linear"
                       : floor ? "logarithmic with floor"
                               : "logarithmic");
    mt_json_put_number(w, "measure_floor", floor ? p->measure_floor : nan(""));
    mt_json_put_number(w, "measure_scale", linear ? p->measure_scale : nan(""));
}

static void write_parameter(mt_json_writer *w, const mt_result_parameter *p)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "name", p->name);
    mt_json_put_string(w, "unit", p->unit);
    mt_json_put_number(w, "original", p->original);
    mt_json_put_number(w, "recommended", p->recommended);
    mt_json_put_number(w, "change_percent", p->change_percent);
    mt_json_put_string(w, "at_bound", p->at_bound);
    write_measure(w, p);
    mt_json_close(w);
}

/* One number for each variable, by its name. */
static void write_values(mt_json_writer *w, const char *name, const double *values,
                         const mt_recommendation *r)
{
    if (values == NULL) {
        mt_json_put_null(w, name);
        return;
    }
    mt_json_open(w, name, '{');
    for (int i = 0; i < r->n_parameters; i++) {
        mt_json_put_number(w, r->parameters[i].name, values[i]);
    }
    mt_json_close(w);
}

static void write_frequency(mt_json_writer *w, const mt_result_frequency *f,
                            const mt_recommendation *r)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", f->configuration);
    mt_json_put_integer(w, "mode", f->mode);
    mt_json_put_string(w, "name", f->name);
    mt_json_put_string(w, "identity", f->identity);
    mt_json_put_number(w, "share", f->share);
    if (f->rival_mode > 0) {
        mt_json_put_integer(w, "rival_mode", f->rival_mode);
    } else {
        mt_json_put_null(w, "rival_mode");
    }
    mt_json_put_number(w, "rival_share", f->rival_share);
    mt_json_put_number(w, "original_hz", f->original_hz);
    mt_json_put_number(w, "recommended_hz", f->recommended_hz);
    mt_json_put_number(w, "target_hz", f->target_hz);
    mt_json_put_number(w, "at_least_hz", f->at_least_hz);
    mt_json_put_number(w, "at_most_hz", f->at_most_hz);
    mt_json_put_number(w, "error_percent", f->error_percent);
    mt_json_put_number(w, "lowest_hz", f->lowest_hz);
    mt_json_put_number(w, "highest_hz", f->highest_hz);
    mt_json_put_string(w, "reference", f->reference);
    mt_json_put_number(w, "mac", f->mac);
    mt_json_put_bool(w, "repeated", f->repeated);
    write_values(w, "sensitivity", f->sensitivity, r);
    mt_json_put_number(w, "residual", f->residual);
    mt_json_put_number(w, "orthogonality", f->orthogonality);
    mt_json_close(w);
}

static void write_goal(mt_json_writer *w, const mt_result_goal *g, const mt_recommendation *r)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "goal", g->text);
    mt_json_put_string(w, "pointer", g->pointer);
    mt_json_put_number(w, "value", g->value);
    mt_json_put_number(w, "demand", g->demand);
    mt_json_put_number(w, "worst", g->worst);
    write_values(w, "worst_at", g->worst_at, r);
    mt_json_put_number(w, "violation_percent", g->violation_percent);
    mt_json_put_bool(w, "met", g->met);
    mt_json_put_bool(w, "weighted", g->weighted);
    mt_json_put_bool(w, "doubtful", g->doubtful);
    mt_json_close(w);
}

static void write_clearance(mt_json_writer *w, const mt_result_clearance *c)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", c->configuration);
    mt_json_put_string(w, "band", c->band);
    mt_json_put_integer(w, "mode", c->mode);
    mt_json_put_number(w, "hz", c->hz);
    mt_json_put_number(w, "percent", c->percent);
    mt_json_put_number(w, "margin_percent", c->margin_percent);
    mt_json_put_number(w, "worst_hz", c->worst_hz);
    mt_json_put_number(w, "worst_percent", c->worst_percent);
    mt_json_put_string(w, "side", c->side);
    mt_json_close(w);
}

static void write_gap(mt_json_writer *w, const mt_result_gap *g)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", g->configuration);
    mt_json_put_string(w, "band", g->band);
    mt_json_put_number(w, "lower_hz", g->lower_hz);
    mt_json_put_number(w, "upper_hz", g->upper_hz);
    mt_json_put_number(w, "margin_lower_hz", g->margin_lower_hz);
    mt_json_put_number(w, "margin_upper_hz", g->margin_upper_hz);
    mt_json_put_integer(w, "modes_below", g->modes_below);
    mt_json_close(w);
}

static void write_tolerance(mt_json_writer *w, const mt_result_tolerance *t)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "name", t->name);
    mt_json_put_number(w, "percent", t->percent);
    mt_json_put_string(w, "edge", t->edge);
    mt_json_close(w);
}

static void write_motion(mt_json_writer *w, const mt_result_motion *m)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "goal", m->pointer);
    mt_json_put_string(w, "drive", m->drive);
    mt_json_put_string(w, "unit", m->unit);
    mt_json_put_number(w, "from", m->from);
    mt_json_put_number(w, "to", m->to);
    mt_json_put_integer(w, "positions", m->positions);
    mt_json_put_number(w, "least_clearance_percent", m->least_clearance_percent);
    mt_json_put_number(w, "margin_percent", m->margin_percent);
    mt_json_put_number(w, "at", m->at);
    mt_json_put_number(w, "hz", m->hz);
    if (m->mode > 0) {
        mt_json_put_integer(w, "mode", m->mode);
    } else {
        mt_json_put_null(w, "mode");
    }
    mt_json_put_string(w, "band", m->band);
    mt_json_put_bool(w, "crosses", m->crosses);
    mt_json_put_string(w, "grade", m->grade);
    mt_json_put_string(w, "text", m->text);
    mt_json_close(w);
}

/* What a design keeps clear of, how, and how surely. */
static void write_bands(mt_json_writer *w, const mt_recommendation *r)
{
    const mt_tolerance_box *const box = r->tolerance_box;
    WRITE_LIST(w, "clearances", r->n_clearances, r->clearances, write_clearance);
    if (r->n_gaps > 0) {
        WRITE_LIST(w, "gap_assignment", r->n_gaps, r->gaps, write_gap);
    } else {
        mt_json_put_null(w, "gap_assignment");
    }
    WRITE_LIST(w, "motion", r->n_motions, r->motions, write_motion);
    if (box == NULL) {
        mt_json_put_null(w, "tolerance_box");
        return;
    }
    mt_json_open(w, "tolerance_box", '{');
    mt_json_put_number(w, "all_percent", box->all_percent);
    mt_json_put_string(w, "edge", box->edge);
    mt_json_put_bool(w, "proven", box->proven);
    WRITE_LIST(w, "per_variable", box->n_variables, box->variables, write_tolerance);
    mt_json_close(w);
}

static void write_design(mt_json_writer *w, const char *name, const mt_recommendation *r)
{
    mt_json_open(w, name, '{');
    mt_json_put_integer(w, "rank", r->rank);
    mt_json_put_bool(w, "feasible", r->feasible);
    mt_json_put_string(w, "grade", r->grade);
    mt_json_put_number(w, "score", r->score);
    mt_json_put_string(w, "score_unit", r->score_unit);
    mt_json_put_number(w, "change", r->change);
    mt_json_put_number(w, "misfit", r->misfit);
    mt_json_put_number(w, "violation_percent", r->violation_percent);
    mt_json_put_number(w, "clearance_percent", r->clearance_percent);
    mt_json_put_number(w, "kkt_residual", r->kkt_residual);
    mt_json_put_string(w, "worst_case", r->worst_case);
    mt_json_put_bool(w, "singular", r->singular);
    WRITE_LIST(w, "parameters", r->n_parameters, r->parameters, write_parameter);
    mt_json_open(w, "frequencies", '[');
    for (int i = 0; i < r->n_frequencies; i++) {
        write_frequency(w, &r->frequencies[i], r);
    }
    mt_json_close(w);
    write_bands(w, r);
    mt_json_open(w, "goals", '[');
    for (int i = 0; i < r->n_goals; i++) {
        write_goal(w, &r->goals[i], r);
    }
    mt_json_close(w);
    write_strings(w, "reasons", r->n_reasons, r->reasons);
    mt_json_close(w);
}

static void write_recommendation(mt_json_writer *w, const mt_recommendation *r)
{
    write_design(w, NULL, r);
}

static void write_undetermined(mt_json_writer *w, const mt_result *result,
                               const mt_undetermined *u)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "direction", u->text);
    mt_json_put_number(w, "effect_percent", u->effect_percent);
    mt_json_open(w, "components", '{');
    for (int i = 0; i < u->n && i < result->n_variables; i++) {
        mt_json_put_number(w, result->variables[i], u->direction[i]);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static void write_spread(mt_json_writer *w, const mt_result_spread *s)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "parameter", s->parameter);
    mt_json_put_string(w, "unit", s->unit);
    mt_json_put_number(w, "value", s->value);
    mt_json_put_number(w, "low", s->low);
    mt_json_put_number(w, "low_percent", s->low_percent);
    mt_json_put_string(w, "low_goal", s->low_goal);
    mt_json_put_number(w, "low_weight_factor", s->low_factor);
    mt_json_put_number(w, "high", s->high);
    mt_json_put_number(w, "high_percent", s->high_percent);
    mt_json_put_string(w, "high_goal", s->high_goal);
    mt_json_put_number(w, "high_weight_factor", s->high_factor);
    mt_json_close(w);
}

static void write_certificate(mt_json_writer *w, const mt_certificate *c)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "kind", c->kind);
    mt_json_put_string(w, "text", c->text);
    mt_json_put_bool(w, "proven", c->proven);
    mt_json_put_string(w, "pointer", c->pointer);
    mt_json_put_number(w, "reachable_lower_hz", c->reachable_lower_hz);
    mt_json_put_number(w, "reachable_upper_hz", c->reachable_upper_hz);
    mt_json_close(w);
}

static void write_relaxation(mt_json_writer *w, const mt_result *result, const mt_relaxation *r)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "kind", r->kind);
    mt_json_put_string(w, "pointer", r->pointer);
    mt_json_put_string(w, "what", r->what);
    mt_json_put_string(w, "unit", r->unit);
    mt_json_put_number(w, "from", r->from);
    mt_json_put_number(w, "to", r->to);
    mt_json_put_number(w, "change_percent", r->change_percent);
    mt_json_open(w, "design", '{');
    for (int i = 0; i < result->n_variables; i++) {
        mt_json_put_number(w, result->variables[i], r->design[i]);
    }
    mt_json_close(w);
    mt_json_put_string(w, "text", r->text);
    mt_json_close(w);
}

static void write_relaxations(mt_json_writer *w, const mt_result *result)
{
    mt_json_open(w, "relaxations", '[');
    for (int i = 0; i < result->n_relaxations; i++) {
        write_relaxation(w, result, &result->relaxations[i]);
    }
    mt_json_close(w);
}

static void write_vary(mt_json_writer *w, const mt_trade_vary *v)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "quantity", v->text);
    mt_json_put_string(w, "pointer", v->pointer);
    mt_json_put_string(w, "unit", v->unit);
    mt_json_close(w);
}

static void write_trade(mt_json_writer *w, const mt_trade_result *trade)
{
    if (trade == NULL) {
        mt_json_put_null(w, "trade");
        return;
    }
    mt_json_open(w, "trade", '{');
    WRITE_LIST(w, "vary", trade->n_vary, trade->vary, write_vary);
    write_strings(w, "objectives", trade->n_objectives, trade->objectives);
    mt_json_open(w, "points", '[');
    for (int i = 0; i < trade->n_points; i++) {
        const mt_trade_point *const p = &trade->points[i];
        mt_json_open(w, NULL, '{');
        mt_json_open_flat(w, "values", '[');
        for (int k = 0; k < trade->n_vary; k++) {
            mt_json_put_number(w, NULL, p->values[k]);
        }
        mt_json_close(w);
        mt_json_put_string(w, "status", mt_result_status_name(p->status));
        mt_json_put_string(w, "status_text", p->status_text);
        mt_json_put_bool(w, "pareto", p->pareto);
        write_design(w, "best", &p->best);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
}

static void write_order(mt_json_writer *w, const mt_result_order *o)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "label", o->label);
    mt_json_put_number(w, "order", o->order);
    mt_json_close(w);
}

static void write_excitation(mt_json_writer *w, const mt_result_excitation *e)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "name", e->name);
    mt_json_put_string(w, "pointer", e->pointer);
    mt_json_put_number(w, "speed_lower_hz", e->speed_lower_hz);
    mt_json_put_number(w, "speed_upper_hz", e->speed_upper_hz);
    mt_json_put_number(w, "margin_percent", e->margin_percent);
    write_strings(w, "configurations", e->n_configurations, e->configurations);
    WRITE_LIST(w, "orders", e->n_orders, e->orders, write_order);
    mt_json_close(w);
}

static void write_published(mt_json_writer *w, const mt_result_published *p)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "label", p->label);
    mt_json_put_string(w, "kind", p->kind);
    mt_json_put_string(w, "pointer", p->pointer);
    mt_json_put_string(w, "role", p->role);
    if (p->published_text != NULL) {
        mt_json_put_string(w, "published", p->published_text);
        mt_json_put_string(w, "computed", p->computed_text);
    } else {
        mt_json_put_number(w, "published", p->published);
        mt_json_put_number(w, "computed", p->computed);
    }
    mt_json_put_number(w, "difference", p->difference);
    mt_json_put_number(w, "difference_percent", p->difference_percent);
    mt_json_put_string(w, "demand", p->demand);
    mt_json_put_bool(w, "holds", p->holds);
    mt_json_put_string(w, "source", p->source);
    mt_json_close(w);
}

void mt_json_put_doubts(mt_json_writer *w, const char *name, const mt_doubt_list *list,
                        mt_doubt_level level)
{
    mt_json_open(w, name, '[');
    for (int i = 0; i < list->n; i++) {
        const mt_doubt *const d = &list->items[i];
        if (d->level != level) {
            continue;
        }
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "kind", d->kind);
        mt_json_put_string(w, "text", d->text);
        mt_json_put_string(w, "configuration", d->configuration);
        mt_json_put_string(w, "file", d->file);
        if (d->line > 0) {
            mt_json_put_integer(w, "line", d->line);
            mt_json_put_integer(w, "column", d->column);
        } else {
            mt_json_put_null(w, "line");
            mt_json_put_null(w, "column");
        }
        mt_json_put_string(w, "pointer", d->pointer);
        mt_json_close(w);
    }
    mt_json_close(w);
}

/* A count, null where it does not apply (negative). */
static void put_count(mt_json_writer *w, const char *name, int count)
{
    mt_json_put_number(w, name, count < 0 ? nan("") : (double)count);
}

static void write_digests(mt_json_writer *w, const char *member, int n,
                          const char *const *names, const char *const *sha256)
{
    mt_json_open(w, member, '[');
    for (int i = 0; i < n; i++) {
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "file", names[i]);
        mt_json_put_string(w, "sha256", sha256[i]);
        mt_json_close(w);
    }
    mt_json_close(w);
}

static void write_run(mt_json_writer *w, const mt_result_run *run)
{
    mt_json_open(w, "run", '{');
    mt_json_put_string(w, "modetune", run->modetune_version);
    mt_json_put_string(w, "blas", run->blas);
    mt_json_put_string(w, "nlopt", run->nlopt_version);
    mt_json_put_string(w, "gsl", run->gsl_version);
    mt_json_put_integer(w, "seed", (long long)run->seed);
    mt_json_put_integer(w, "starts", run->starts);
    put_count(w, "distinct_designs", run->distinct_designs);
    put_count(w, "found_once", run->found_once);
    mt_json_put_number(w, "estimated_missing", run->estimated_missing);
    mt_json_put_integer(w, "evaluations", run->evaluations);
    mt_json_open(w, "incomplete", '[');
    for (int i = 0; i < run->n_incomplete; i++) {
        mt_json_put_string(w, NULL, run->incomplete[i]);
    }
    mt_json_close(w);
    write_digests(w, "inputs", run->n_inputs, run->input_names, run->input_sha256);
    write_digests(w, "outputs", run->n_outputs, run->output_names, run->output_sha256);
    mt_json_close(w);
}

static void write_named_file(mt_json_writer *w, const char *member, const char *name,
                             const char *file)
{
    mt_json_open(w, member, '{');
    mt_json_put_string(w, "name", name);
    mt_json_put_string(w, "file", file);
    mt_json_close(w);
}

void mt_result_put_uncertainty(mt_json_writer *w, const mt_result *result)
{
    mt_json_open(w, "undetermined", '[');
    for (int i = 0; i < result->n_undetermined; i++) {
        write_undetermined(w, result, &result->undetermined[i]);
    }
    mt_json_close(w);
    WRITE_LIST(w, "spread", result->n_spread, result->spread, write_spread);
}

void mt_result_put(mt_json_writer *w, const char *name, const mt_result *result)
{
    mt_json_open(w, name, '{');
    mt_json_put_string(w, "format", "modetune-result/1");
    write_named_file(w, "study", result->study_name, result->study_file);
    write_named_file(w, "model", result->model_name, result->model_file);
    mt_json_put_string(w, "status", mt_result_status_name(result->status));
    mt_json_put_string(w, "status_text", result->status_text);
    mt_json_put_doubts(w, "doubts", &result->doubts, MT_LEVEL_DOUBT);
    mt_json_put_doubts(w, "facts", &result->doubts, MT_LEVEL_FACT);
    write_strings(w, "variables", result->n_variables, result->variables);
    write_design(w, "baseline", &result->baseline);
    WRITE_LIST(w, "recommendations", result->n_recommendations, result->recommendations,
               write_recommendation);
    mt_result_put_uncertainty(w, result);
    WRITE_LIST(w, "certificates", result->n_certificates, result->certificates,
               write_certificate);
    write_relaxations(w, result);
    WRITE_LIST(w, "excitations", result->n_excitations, result->excitations, write_excitation);
    write_trade(w, result->trade);
    WRITE_LIST(w, "published", result->n_published, result->published, write_published);
    write_strings(w, "warnings", result->n_warnings, result->warnings);
    write_run(w, &result->run);
    mt_json_close(w);
}

mt_status mt_result_write(const mt_result *result, mt_text *out, mt_err *err)
{
    mt_json_writer writer = mt_json_writer_default(out);
    mt_result_put(&writer, NULL, result);
    if (mt_json_done(&writer)) {
        return MT_OK;
    }
    return writer.misused ? mt_fail(err, MT_E_INTERNAL, "the result cannot be written as JSON")
                          : mt_fail_memory(err);
}
