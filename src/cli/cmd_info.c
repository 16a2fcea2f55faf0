/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune info: what each configuration weighs and how it can move. */
#include <math.h>
#include <string.h>

#include "answer/warnings.h"
#include "base/format.h"
#include "cli/cli.h"
#include "cli/conventions.h"
#include "mechanics/info.h"
#include "mechanics/redundant.h"
#include "model/values.h"
#include "report/number.h"
#include "report/table.h"

enum { DIGITS = 6, SPATIAL = 6, MOST_RATIOS = 6 };

static const char *const inertia_member[SPATIAL] = {"xx", "yy", "zz", "xy", "xz", "yz"};

typedef struct view {
    const mt_loaded_model *s;
    int c;
    mt_analysis *a;
    mt_info info;
    mt_nearness nearness;
    mt_arena mem;
    mt_warning_list warning_list;
    mt_convention_list conventions;
} view;

static void json_units(mt_json_writer *w, const mt_loaded_model *s)
{
    const mt_model *const m = s->model;
    mt_json_open_flat(w, "units", '{');
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        mt_json_put_string(w, mt_dimension_name((mt_dimension)d),
                           m->units[d] == NULL ? mt_dimension_si((mt_dimension)d)
                                               : m->units[d]->name);
    }
    mt_json_close(w);
    mt_json_open(w, "converted", '[');
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_parameter *const p = &m->parameters[i];
        if (p->written != NULL) {
            mt_json_open_flat(w, NULL, '{');
            mt_json_put_string(w, "parameter", p->name.s);
            mt_json_put_number(w, "number", mt_unit_written(p->written, s->original[i]));
            mt_json_put_string(w, "number_unit", p->written->name);
            mt_json_put_number(w, "value", s->original[i]);
            mt_json_put_string(w, "unit", p->unit);
            mt_json_close(w);
        }
    }
    mt_json_close(w);
}

static double info_value(const view *v, mt_node node)
{
    return node == MT_NO_NODE ? nan("") : mt_linear_value(v->a->lin, node);
}

static const char *named_mode(const view *v, int i)
{
    return v->s->model->modes[v->a->sys->damping.named[i]].name.s;
}

static void json_damping(mt_json_writer *w, const view *v)
{
    const mt_damping_def *const d = &v->a->sys->damping;
    mt_json_open(w, "damping", '{');
    mt_json_put_integer(w, "dampers", v->info.dampers);
    mt_json_put_number(w, "least_loss_factor", v->info.least_loss);
    mt_json_put_number(w, "most_loss_factor", v->info.most_loss);
    mt_json_put_number(w, "ratio", info_value(v, d->ratio));
    mt_json_open_flat(w, "ratios", '[');
    for (int k = 0; k < d->n_ratios; k++) {
        mt_json_put_number(w, NULL, info_value(v, d->ratios[k]));
    }
    mt_json_close(w);
    mt_json_open(w, "modes", '{');
    for (int k = 0; k < d->n_named; k++) {
        mt_json_put_number(w, named_mode(v, k), info_value(v, d->named_ratios[k]));
    }
    mt_json_close(w);
    mt_json_put_number(w, "mass_per_s", info_value(v, d->mass));
    mt_json_put_number(w, "stiffness_s", info_value(v, d->stiffness));
    mt_json_close(w);
}

/* One part of the line "damping": "ratio 0.02 of mode 1". */
static void put_part(mt_text *out, int *n, const char *before, double x, const char *after)
{
    if (!isnan(x)) {
        char a[MT_NUMBER_TEXT];
        mt_text_addf(out, "%s%s%s%s", *n > 0 ? ", " : "  damping     ", before,
                     mt_report_number(x, DIGITS, a), after);
        ++*n;
    }
}

static void text_ratios(mt_text *out, int *n, const view *v)
{
    const mt_damping_def *const d = &v->a->sys->damping;
    const bool listed = d->n_ratios + d->n_named > 0;
    for (int k = 0; k < d->n_named && k < MOST_RATIOS; k++) {
        const char *const of =
            mt_arena_printf(v->warning_list.mem, " of \"%s\"", named_mode(v, k));
        put_part(out, n, "ratio ", info_value(v, d->named_ratios[k]), of == NULL ? "" : of);
    }
    for (int k = 0; k < d->n_ratios && k < MOST_RATIOS; k++) {
        char of[32];
        (void)mt_snprintf(of, sizeof of, " of mode %d", k + 1);
        put_part(out, n, "ratio ", info_value(v, d->ratios[k]), of);
    }
    if (d->n_named > MOST_RATIOS || d->n_ratios > MOST_RATIOS) {
        mt_text_add(out, ", ...");
    }
    put_part(out, n, "ratio ", info_value(v, d->ratio), listed ? " of other modes" : "");
}

/* Write the line "damping"; nothing without damping. */
static void text_damping(mt_text *out, const view *v)
{
    const mt_damping_def *const d = &v->a->sys->damping;
    const int dampers = v->info.dampers;
    char most[MT_NUMBER_TEXT + 8] = "";
    int n = 0;
    if (dampers > 0) {
        mt_text_addf(out, "  damping     %d damper%s", dampers, dampers == 1 ? "" : "s");
        n++;
    }
    if (v->info.most_loss > v->info.least_loss) {
        char a[MT_NUMBER_TEXT];
        (void)mt_snprintf(most, sizeof most, " to %s",
                          mt_report_number(v->info.most_loss, DIGITS, a));
    }
    put_part(out, &n, "loss factors ", v->info.least_loss, most);
    text_ratios(out, &n, v);
    put_part(out, &n, "", info_value(v, d->mass), " 1/s of the mass");
    put_part(out, &n, "", info_value(v, d->stiffness), " s of the stiffness");
    mt_text_add(out, n > 0 ? "\n" : "");
}

static mt_status write_info_json(mt_json_writer *w, view *v, mt_err *err)
{
    const mt_info *const i = &v->info;
    const bool planar = v->s->model->dimension == 2;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", mt_loaded_model_configuration(v->s, v->c));
    json_units(w, v->s);
    mt_json_put_warnings(w, "doubts", &v->warning_list, MT_LEVEL_WARNING);
    mt_json_put_warnings(w, "facts", &v->warning_list, MT_LEVEL_NOTE);
    mt_json_put_number(w, "mass_kg", i->mass_kg);
    mt_json_open_flat(w, "centre_m", '[');
    for (int k = 0; k < v->s->model->dimension; k++) {
        mt_json_put_number(w, NULL, i->centre_m[k]);
    }
    mt_json_close(w);
    mt_json_open_flat(w, "inertia_kg_m2", '{');
    for (int k = planar ? 2 : 0; k < (planar ? 3 : SPATIAL); k++) {
        mt_json_put_number(w, inertia_member[k], i->inertia_kg_m2[k]);
    }
    mt_json_close(w);
    mt_json_put_integer(w, "states", i->states);
    mt_json_put_integer(w, "equations", i->equations);
    mt_json_put_integer(w, "freedoms", i->freedoms);
    mt_json_put_integer(w, "idle_spins", i->free_spins);
    mt_json_put_integer(w, "redundant_equations", i->redundant);
    MT_TRY(mt_cli_json_redundant(w, v->a->lin, &v->mem, err));
    mt_json_put_number(w, "equilibrium_residual", i->residual);
    mt_json_put_number(w, "gap_m", i->gap_m);
    json_damping(w, v);
    mt_cli_json_conventions(w, &v->conventions);
    mt_cli_json_dead_centre(w, &v->nearness);
    mt_json_close(w);
    return MT_OK;
}

static const char *point_text(const double *x, int n, char *text, size_t size)
{
    char s[3][MT_NUMBER_TEXT];
    for (int k = 0; k < 3; k++) {
        (void)mt_report_number(k < n ? x[k] : nan(""), DIGITS, s[k]);
    }
    (void)mt_snprintf(text, size, n == 3 ? "%s, %s, %s" : "%s, %s", s[0], s[1], s[2]);
    return text;
}

/* Write the conventions of a configuration; nothing where they equal those of the one before
 * (*last, which is taken over). */
static void write_conventions(mt_text *out, const view *v, mt_text *last)
{
    mt_text text = {.s = NULL};
    mt_cli_print_conventions(&v->conventions, &text);
    if (text.s != NULL && (last->s == NULL || strcmp(last->s, text.s) != 0)) {
        mt_text_add(out, text.s);
    }
    out->failed = out->failed || text.failed;
    mt_text_free(last);
    *last = text;
}

static void write_info_text(mt_text *out, const view *v, mt_text *last)
{
    const mt_info *const i = &v->info;
    const int n = v->s->model->dimension;
    char a[3 * MT_NUMBER_TEXT + 8];
    mt_text_addf(out, "%s\n", mt_loaded_model_configuration(v->s, v->c));
    mt_cli_print_warnings(&v->warning_list, out);
    mt_text_addf(out, "  mass        %s kg\n", mt_report_number(i->mass_kg, DIGITS, a));
    mt_text_addf(out, "  centre      (%s) m\n", point_text(i->centre_m, n, a, sizeof a));
    if (n == 2) {
        mt_text_addf(out, "  inertia     %s kg m^2 about the centre\n",
                     mt_report_number(i->inertia_kg_m2[2], DIGITS, a));
    } else {
        char b[3 * MT_NUMBER_TEXT + 8];
        mt_text_addf(out,
                     "  inertia     xx, yy, zz %s; xy, xz, yz %s kg m^2 about the centre\n",
                     point_text(i->inertia_kg_m2, 3, a, sizeof a),
                     point_text(i->inertia_kg_m2 + 3, 3, b, sizeof b));
    }
    mt_text_addf(out, "  mobility    %d freedom%s = %d states - %d independent of %d equations",
                 i->freedoms, i->freedoms == 1 ? "" : "s", i->states,
                 i->equations - i->redundant, i->equations);
    if (i->free_spins > 0) {
        mt_text_addf(out, " - %d idle spin%s", i->free_spins, i->free_spins == 1 ? "" : "s");
    }
    mt_text_add(out, "\n");
    text_damping(out, v);
    if (mt_linear_position(v->a->lin)->equilibrium.active) {
        mt_text_addf(out, "  equilibrium residual %.1e, largest gap of a joint %.1e m\n",
                     i->residual, i->gap_m);
    }
    write_conventions(out, v, last);
    mt_text_add(out, "\n");
}

/* "170 mm = 0.17 m": of every parameter that the file gives in a unit other than SI. */
static void write_units(mt_text *out, const mt_loaded_model *s)
{
    const mt_model *const m = s->model;
    int told = 0;
    for (int d = 0; d < MT_DIMENSION_COUNT; d++) {
        if (m->units[d] != NULL) {
            mt_text_addf(out, "%s%s in %s", told++ == 0 ? "Units: " : ", ",
                         mt_dimension_name((mt_dimension)d), m->units[d]->name);
        }
    }
    mt_text_add(out, told > 0 ? "; expressions in SI units\n" : "");
    for (int i = 0; i < m->n_parameters; i++) {
        const mt_parameter *const p = &m->parameters[i];
        if (p->written != NULL) {
            mt_text_add(out, told++ == 0 ? "Parameters in other units than SI\n" : "");
            mt_text_addf(out, "  %s: %.10g %s = %.10g %s\n", p->name.s,
                         mt_unit_from_si(p->written, s->original[i]), p->written->name,
                         s->original[i], p->unit);
        }
    }
    mt_text_add(out, told > 0 ? "\n" : "");
}

static mt_table table_new(void)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_column(&t, "mass [kg]", "mass_kg", MT_ALIGN_POINT);
    mt_table_column(&t, "x [m]", "centre_x_m", MT_ALIGN_POINT);
    mt_table_column(&t, "y [m]", "centre_y_m", MT_ALIGN_POINT);
    mt_table_column(&t, "z [m]", "centre_z_m", MT_ALIGN_POINT);
    for (int k = 0; k < SPATIAL; k++) {
        char member[32];
        (void)mt_snprintf(member, sizeof member, "inertia_%s_kg_m2", inertia_member[k]);
        mt_table_column(&t, member, member, MT_ALIGN_POINT);
    }
    mt_table_column(&t, "states", "states", MT_ALIGN_RIGHT);
    mt_table_column(&t, "equations", "equations", MT_ALIGN_RIGHT);
    mt_table_column(&t, "freedoms", "freedoms", MT_ALIGN_RIGHT);
    mt_table_column(&t, "redundant", "redundant_equations", MT_ALIGN_RIGHT);
    return t;
}

static void fill_table(mt_table *t, const view *v)
{
    const mt_info *const i = &v->info;
    mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
    mt_table_number(t, i->mass_kg, DIGITS);
    for (int k = 0; k < 3; k++) {
        mt_table_number(t, i->centre_m[k], DIGITS);
    }
    for (int k = 0; k < SPATIAL; k++) {
        mt_table_number(t, i->inertia_kg_m2[k], DIGITS);
    }
    mt_table_integer(t, i->states);
    mt_table_integer(t, i->equations);
    mt_table_integer(t, i->freedoms);
    mt_table_integer(t, i->redundant);
}

/* What is written in turn. */
typedef struct sinks {
    mt_json_writer *w;
    mt_table *t;
    mt_text *out;
    mt_text *last; /* conventions, as they were said last */
} sinks;

static mt_status find_conventions(view *v, mt_err *err)
{
    const mt_model *const m = v->s->model;
    double *const value = mt_arena_f64(&v->mem, (size_t)m->n_nums, 1);
    MT_TRY(mt_arena_check(&v->mem, err));
    MT_TRY(
        mt_model_numbers(m, v->c, v->s->n_inputs, v->s->inputs, v->s->at, &v->mem, value, err));
    v->conventions = (mt_convention_list){.mem = &v->mem};
    mt_cli_find_conventions(m, v->c, value, &v->conventions);
    return mt_arena_check(&v->mem, err);
}

static mt_status show_configuration_info(const mt_args *args, view *v, const sinks *to,
                                         mt_err *err)
{
    MT_TRY(mt_loaded_model_analyse(v->s, v->c, 1, &v->a, err));
    MT_TRY(mt_info_fill(v->a->lin, &v->info, err));
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    MT_TRY(mt_linear_nearness(v->a->lin, &v->mem, &v->nearness, err));
    v->warning_list = mt_warning_list_default(&v->mem);
    MT_TRY(mt_warnings_of_analysis(v->a, v->s->n_inputs, v->s->inputs, v->s->at,
                                   &v->warning_list, err));
    MT_TRY(find_conventions(v, err));
    switch (args->format) {
    case MT_FORMAT_JSON:
        return write_info_json(to->w, v, err);
    case MT_FORMAT_CSV:
        fill_table(to->t, v);
        return MT_OK;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        write_info_text(to->out, v, to->last);
        return MT_OK;
    }
    return MT_OK;
}

int mt_cmd_info(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    mt_json_writer w = mt_json_writer_default(out);
    mt_table t = table_new();
    mt_text last = {.s = NULL};
    const sinks to = {.w = &w, .t = &t, .out = out, .last = &last};
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    if (list) {
        mt_json_open(&w, NULL, '[');
    }
    if (args->format == MT_FORMAT_TEXT) {
        write_units(out, &s);
    }
    for (int i = 0; i < s.n_configurations; i++) {
        view v = {.s = &s, .c = s.configurations[i]};
        mt_err err = {.code = MT_OK};
        mt_loaded_model_warn_overridden(&s, v.c);
        const mt_status rc = show_configuration_info(args, &v, &to, &err);
        if (rc != MT_OK) {
            code = mt_exit_worse(code, mt_cli_failed(rc, &err));
        }
        if (rc != MT_OK && json) {
            mt_json_open(&w, NULL, '{');
            mt_json_put_string(&w, "configuration", mt_loaded_model_configuration(&s, v.c));
            mt_json_put_string(&w, "error", err.text);
            mt_json_close(&w);
        }
        mt_analysis_delete(v.a);
        mt_arena_free(&v.mem);
    }
    if (list) {
        mt_json_close(&w);
    }
    if (json) {
        code = mt_exit_worse(code, mt_cli_json_done(&w));
    }
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&t, out);
    }
done:
    mt_table_free(&t);
    mt_text_free(&last);
    mt_loaded_model_free(&s);
    return code;
}
