/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune modes: natural frequencies and shapes. */
#include <float.h>
#include <math.h>

#include "base/format.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "inspect/modes.h"
#include "report/table.h"

/* Natural frequencies and shapes of one configuration, or of all. */

/* A greater part of the forces at work is left in an equilibrium only where they are rounding
 * of what they are made of: that part says nothing. */
static const double MOST_LEFT = 1e-9;

enum { DIGITS = 6, HZ_DIGITS = 6, RATIO_DIGITS = 2 };

#define THIS mt_damped_row
static const mt_record_column damped_columns[] = {
    MT_R_COLUMN(index, "damped mode", 0, MT_IN_TABLES),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_TABLES),
    MT_R_COLUMN(natural_hz, "natural [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(damped_hz, "damped [Hz]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(ratio_percent, "damping ratio [%]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(decay_per_s, "decay [1/s]", DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(residual, "residual", RATIO_DIGITS, MT_IN_TABLES),
};
static const mt_record_table damped_rows = MT_R_TABLE_OF(mt_damped_record, damped_columns);
#undef THIS

/* Print the table with its notes. count: oscillating modes to show, 0: all. */
static void damped_print(const mt_damped_modes *d, int count, mt_text *out)
{
    mt_table t = mt_table_default();
    int overdamped = 0;
    mt_table_record_columns(&t, &damped_rows, MT_IN_TEXT);
    for (int i = 0; i < d->count; i++) {
        const mt_damped_row row = mt_damped_row_of(d, i, true);
        if (mt_modes_has_damped(d, i, count)) {
            mt_table_record_row(&t, &damped_rows, MT_IN_TEXT, &row);
        }
        overdamped += d->kind[i] == MT_DAMPED_OVERDAMPED ? 1 : 0;
    }
    mt_text_add(out, "\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    if (overdamped > 0) {
        mt_text_addf(out, "  %d real root%s: %s without oscillation.\n", overdamped,
                     overdamped == 1 ? "" : "s", overdamped == 1 ? "it decays" : "they decay");
    }
}

/* Rows of CSV, each behind its configuration. */
static void damped_csv(const mt_damped_modes *d, int count, const char *configuration,
                       mt_table *t)
{
    for (int i = 0; i < d->count; i++) {
        const mt_damped_row row = mt_damped_row_of(d, i, false);
        if (mt_modes_has_damped(d, i, count)) {
            mt_table_text(t, configuration);
            mt_table_record_row(t, &damped_rows, MT_IN_CSV, &row);
        }
    }
}

/* Among columns for people: where an error is large enough to be shown. */
enum { IN_ROUGH = MT_IN_OWN };

#define THIS mt_mode_row
static const mt_record_column mode_columns[] = {
    MT_R_COLUMN(index, "mode", 0, MT_IN_TABLES),
    MT_R_COLUMN(kind, "kind", 0, MT_IN_TABLES),
    MT_R_COLUMN(hz, "frequency [Hz]", HZ_DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(error_hz, "error [Hz]", RATIO_DIGITS, MT_IN_CSV | IN_ROUGH),
    MT_R_COLUMN(name, "name", 0, MT_IN_TABLES),
    MT_R_COLUMN(residual, "residual", RATIO_DIGITS, MT_IN_TABLES),
    MT_R_COLUMN(orthogonality, "orthogonality", RATIO_DIGITS, MT_IN_TABLES),
    {.offset = offsetof(THIS, omega_squared),
     .heading = "omega^2 [rad^2/s^2]",
     .member = "omega_squared_rad2_per_s2",
     .digits = HZ_DIGITS,
     .in = MT_IN_CSV},
};
static const mt_record_table mode_rows = MT_R_TABLE_OF(mt_mode_record, mode_columns);
#undef THIS

static bool any_rough(const mt_modes_view *v)
{
    bool rough = false;
    for (int i = 0; i < v->shown; i++) {
        rough = rough || mt_modes_is_rough(v->m, i);
    }
    return rough;
}

/* A table of CSV: each row behind its configuration, its shape behind it. */
static mt_table csv_table(const mt_modes_view *v)
{
    const mt_mode_shapes *const shapes = &v->shapes;
    mt_table t = mt_table_default();
    mt_table_column(&t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_record_columns(&t, &mode_rows, MT_IN_CSV);
    for (int k = 0; k < shapes->n; k++) {
        mt_table_column(&t, shapes->name[k], shapes->head[k], MT_ALIGN_POINT);
    }
    for (int k = 0; k < v->n_effective; k++) {
        const mt_effective_row *const e = &v->effective[k];
        const bool turns = e->direction[0] == 'r';
        char name[48];
        (void)mt_snprintf(name, sizeof name, "participation_%s_%s", e->direction,
                          turns ? "m_sqrt_kg" : "sqrt_kg");
        mt_table_column(&t, name, name, MT_ALIGN_POINT);
        (void)mt_snprintf(name, sizeof name, "effective_mass_%s_%s", e->direction,
                          turns ? "kg_m2" : "kg");
        mt_table_column(&t, name, name, MT_ALIGN_POINT);
    }
    return t;
}

static void csv_rows(const mt_modes_view *v, mt_table *t)
{
    for (int i = 0; i < v->shown; i++) {
        const mt_mode_row row = mt_mode_row_of(v, i, false);
        mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
        mt_table_record_row(t, &mode_rows, MT_IN_CSV, &row);
        for (int k = 0; k < v->shapes.n; k++) {
            mt_table_number(t, mt_modes_component(&v->shapes, k, i), HZ_DIGITS);
        }
        for (int k = 0; k < v->n_effective; k++) {
            mt_table_number(t, v->effective[k].participation[i], HZ_DIGITS);
            mt_table_number(t, v->effective[k].mass[i], HZ_DIGITS);
        }
    }
}

static void print_modes(const mt_modes_view *v, mt_text *out)
{
    const unsigned in = MT_IN_TEXT | (any_rough(v) ? (unsigned)IN_ROUGH : 0U);
    mt_table t = mt_table_default();
    mt_table_record_columns(&t, &mode_rows, in);
    for (int i = 0; i < v->shown; i++) {
        const mt_mode_row row = mt_mode_row_of(v, i, true);
        mt_table_record_row(&t, &mode_rows, in, &row);
    }
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Print shapes with rows of channels and columns of modes, as a mechanism has more sensors than
 * fit side by side. */
static void print_shapes(const mt_modes_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, v->shapes.sensors ? "sensor" : "body", "channel", MT_ALIGN_LEFT);
    for (int i = 0; i < v->shown; i++) {
        char heading[40];
        const int index = mt_modes_index(v->m, i);
        (void)mt_snprintf(heading, sizeof heading, index > 0 ? "mode %d" : "(%d)",
                          index > 0 ? index : i + 1);
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
    }
    for (int k = 0; k < v->shapes.n; k++) {
        mt_table_text(&t, v->shapes.name[k]);
        for (int i = 0; i < v->shown; i++) {
            mt_table_number(&t, mt_modes_component(&v->shapes, k, i), 4);
        }
    }
    mt_text_add(out, "\n  Mass-normalised shapes (numbers in parentheses: modes without "
                     "an index, by position) [1/sqrt(kg) and rad/(m sqrt(kg))]\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* Modes with a row each, the directions beside each other; below them their sum and what there
 * is in all. */
static void print_effective(const mt_modes_view *v, mt_text *out)
{
    static const char *const below[] = {"sum", "total", "sum [%]"};
    const double *const about = v->question.about_m;
    mt_table t = mt_table_default();
    mt_table_column(&t, "mode", "mode", MT_ALIGN_LEFT);
    for (int k = 0; k < v->n_effective; k++) {
        char heading[32];
        (void)mt_snprintf(heading, sizeof heading, "%s [%s]", v->effective[k].direction,
                          v->effective[k].unit);
        mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
    }
    for (int i = 0; i < v->shown; i++) {
        char name[24];
        const int index = mt_modes_index(v->m, i);
        (void)mt_snprintf(name, sizeof name, index > 0 ? "%d" : "(%d)",
                          index > 0 ? index : i + 1);
        mt_table_text(&t, name);
        for (int k = 0; k < v->n_effective; k++) {
            mt_table_number(&t, v->effective[k].mass[i], HZ_DIGITS);
        }
    }
    for (int row = 0; row < MT_COUNT(below); row++) {
        mt_table_text(&t, below[row]);
        for (int k = 0; k < v->n_effective; k++) {
            const mt_effective_row *const e = &v->effective[k];
            const double value = row == 0 ? e->sum : row == 1 ? e->total : e->sum_percent;
            mt_table_number(&t, value, row == 2 ? 4 : HZ_DIGITS);
        }
    }
    mt_text_addf(
        out,
        "\n  Effective modal masses for a ground that moves along the global axes, and "
        "about them through (%.6g, %.6g, %.6g) m; numbers in parentheses: modes "
        "without an index, by position\n",
        about[0], about[1], about[2]);
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    mt_text_add(out, "  The total is what no fixed joints hold to the ground. What is guided "
                     "rigidly along a direction has no mode in it.\n");
}

/* Energies. */

/* A share below this is left blank [%]. */
static const double TOLD_PERCENT = 0.5;
static const char LOADS[] = "(gravity, loads, preload)";

/* True where position i begins its frequency: modes of one frequency share a column. */
static bool begins_frequency(const mt_modes_view *v, int i)
{
    return v->energies.shares[i].first == i;
}

static mt_table energy_columns(const mt_modes_view *v, const char *what)
{
    mt_table t = mt_table_default();
    mt_table_column(&t, what, "name", MT_ALIGN_LEFT);
    for (int i = 0; i < v->shown; i++) {
        char heading[64];
        const int index = mt_modes_index(v->m, i);
        const int first = index > 0 ? index : i + 1;
        const int last = first + v->energies.shares[i].modes - 1;
        const char *const open = index > 0 ? "" : "(";
        const char *const close = index > 0 ? "" : ")";
        (void)(last > first
                   ? mt_snprintf(heading, sizeof heading, "%smodes %d-%d%s", open, first, last,
                                 close)
                   : mt_snprintf(heading, sizeof heading, "%smode %d%s", open, first, close));
        if (begins_frequency(v, i)) {
            mt_table_column(&t, heading, heading, MT_ALIGN_POINT);
        }
    }
    return t;
}

/* A row of the shares percent[i * step] of all columns, unless all of it is blank. */
static void energy_line(const mt_modes_view *v, const char *name, const double *percent,
                        mt_table *t)
{
    bool any = false;
    for (int i = 0; i < v->shown; i++) {
        any = any || fabs(percent[i]) >= TOLD_PERCENT;
    }
    if (!any) {
        return;
    }
    mt_table_text(t, name);
    for (int i = 0; i < v->shown; i++) {
        char text[32] = "";
        if (fabs(percent[i]) >= TOLD_PERCENT) {
            (void)mt_snprintf(text, sizeof text, "%.1f", percent[i]);
        }
        if (begins_frequency(v, i)) {
            mt_table_cell(t, text, text);
        }
    }
}

/* What a name and a direction are called: "engine.rx". */
static const char *line_name(const char *name, int direction, mt_arena *mem)
{
    const char *const joined =
        mt_arena_printf(mem, "%s.%s", name, mt_energy_directions[direction]);
    return joined == NULL ? name : joined;
}

static void print_kinetic(const mt_modes_view *v, const mt_energy_row *rows, mt_arena *mem,
                          double *percent, mt_text *out)
{
    mt_table t = energy_columns(v, "body");
    for (int b = 0; b < v->energies.owners.n_bodies; b++) {
        for (int k = 0; k < MT_ENERGY_DIRECTIONS; k++) {
            for (int i = 0; i < v->shown; i++) {
                percent[i] = rows[i].kinetic[b].percent[k];
            }
            energy_line(v, line_name(rows[0].kinetic[b].body, k, mem), percent, &t);
        }
    }
    mt_text_add(out, "\n  Kinetic energy [%]\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* The share of spring k of a mode, of one component or (-1) of all; NaN where it has none. */
static double strain_of(const mt_energy_row *row, int k, int component)
{
    if (row->strain == NULL) {
        return nan("");
    }
    return component < 0 ? row->strain[k].total : row->strain[k].percent[component];
}

static void print_strain(const mt_modes_view *v, const mt_energy_row *rows, mt_arena *mem,
                         double *percent, mt_text *out)
{
    mt_table t = energy_columns(v, "spring");
    for (int k = 0; k < v->energies.owners.n_springs; k++) {
        const mt_energy_owner *const o = &v->energies.owners.springs[k];
        for (int c = o->bushing ? 0 : -1; c < (o->bushing ? MT_ENERGY_DIRECTIONS : 0); c++) {
            for (int i = 0; i < v->shown; i++) {
                percent[i] = strain_of(&rows[i], k, c);
            }
            energy_line(v, c < 0 ? o->name : line_name(o->name, c, mem), percent, &t);
        }
    }
    for (int i = 0; i < v->shown; i++) {
        percent[i] = rows[i].loads;
    }
    energy_line(v, LOADS, percent, &t);
    mt_text_add(out, "\n  Strain energy [%]\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
}

/* The records of all modes shown, and room for a line, in mem; NULL: memory is out. */
static mt_energy_row *energy_rows(const mt_modes_view *v, mt_arena *mem, double **percent)
{
    mt_energy_row *const rows = mt_arena_alloc(mem, (size_t)v->shown, sizeof *rows);
    *percent = mt_arena_f64(mem, (size_t)v->shown, 1);
    for (int i = 0; i < v->shown && rows != NULL; i++) {
        rows[i] = mt_energy_row_of(v->a->sys, &v->energies, i, mem);
    }
    return mt_arena_failed(mem) ? NULL : rows;
}

/* Print matrices of energies, with what they mean. */
static void print_energies(const mt_modes_view *v, mt_text *out)
{
    mt_arena mem;
    double *percent = NULL;
    if (mt_arena_init(&mem, 0, NULL) != MT_OK) {
        out->failed = true;
        return;
    }
    const mt_energy_row *const rows = energy_rows(v, &mem, &percent);
    if (rows == NULL) {
        out->failed = true;
    } else {
        print_kinetic(v, rows, &mem, percent, out);
        print_strain(v, rows, &mem, percent, out);
        double off = 0.0;
        for (int i = 0; i < v->shown; i++) {
            off = fmax(off, fabs(rows[i].kinetic_sum - (100.0 * rows[i].modes)));
            off = fmax(off, isfinite(rows[i].strain_sum)
                                ? fabs(rows[i].strain_sum - (100.0 * rows[i].modes))
                                : 0.0);
        }
        mt_text_addf(
            out,
            "  Blank: below %.1f %%. Each column sums to 100 %% for each of its modes "
            "(within %.0e %%); a share is below 0 where axes couple, or loads soften.\n",
            TOLD_PERCENT, off > 0.0 ? pow(10.0, ceil(log10(off))) : DBL_EPSILON);
    }
    mt_arena_free(&mem);
}

/* CSV: a row for each share. */
static mt_table energy_table(void)
{
    static const char *const columns[] = {"configuration", "mode", "frequency_hz", "modes",
                                          "energy",        "name", "direction",    "percent"};
    mt_table t = mt_table_default();
    for (int i = 0; i < MT_COUNT(columns); i++) {
        const bool text = i == 0 || (i >= 4 && i < 7);
        mt_table_column(&t, columns[i], columns[i], text ? MT_ALIGN_LEFT : MT_ALIGN_POINT);
    }
    return t;
}

static void energy_cells(const mt_modes_view *v, int i, const char *energy, const char *name,
                         const char *direction, double percent, mt_table *t)
{
    const int index = mt_modes_index(v->m, i);
    mt_table_text(t, mt_loaded_model_configuration(v->s, v->c));
    if (index > 0) {
        mt_table_integer(t, index);
    } else {
        mt_table_text(t, NULL);
    }
    mt_table_number(t, mt_modal_hz(v->m, i), HZ_DIGITS);
    mt_table_integer(t, v->energies.shares[i].modes);
    mt_table_text(t, energy);
    mt_table_text(t, name);
    mt_table_text(t, direction);
    mt_table_number(t, percent, HZ_DIGITS);
}

static void energy_csv(const mt_modes_view *v, mt_table *t)
{
    mt_arena mem;
    double *percent = NULL;
    if (mt_arena_init(&mem, 0, NULL) != MT_OK) {
        t->failed = true;
        return;
    }
    const mt_energy_row *const rows = energy_rows(v, &mem, &percent);
    t->failed = t->failed || rows == NULL;
    for (int i = 0; i < v->shown && rows != NULL; i++) {
        for (int k = 0; k < rows[i].n_kinetic * MT_ENERGY_DIRECTIONS; k++) {
            const mt_energy_body_row *const b = &rows[i].kinetic[k / MT_ENERGY_DIRECTIONS];
            const int d = k % MT_ENERGY_DIRECTIONS;
            if (isfinite(b->percent[d])) {
                energy_cells(v, i, "kinetic", b->body, mt_energy_directions[d], b->percent[d],
                             t);
            }
        }
        for (int k = 0; k < rows[i].n_strain; k++) {
            const mt_energy_spring_row *const s = &rows[i].strain[k];
            for (int d = 0; d < MT_ENERGY_DIRECTIONS && s->components; d++) {
                energy_cells(v, i, "strain", s->spring, mt_energy_directions[d], s->percent[d],
                             t);
            }
            if (!s->components) {
                energy_cells(v, i, "strain", s->spring, NULL, s->total, t);
            }
        }
        energy_cells(v, i, "strain", LOADS, NULL, rows[i].loads, t);
    }
    mt_arena_free(&mem);
}

/* Note where modes are left out that were not declined by an option. */
static void write_others(const mt_modes_view *v, bool asked, mt_text *out)
{
    const int all = mt_modal_vibrations(v->m);
    if (!asked && all > v->question.count) {
        mt_text_addf(out, "  The lowest %d of %s%d vibration modes; --count N or all: more.\n",
                     v->question.count, v->l == NULL ? "" : "at most ", all);
    }
}

static void write_solution_notes(const mt_modes_view *v, mt_text *out)
{
    const mt_modes *const m = v->m;
    const mt_state *const at = mt_modes_position(v);
    if (v->l != NULL) {
        const bool tree = v->l->way == MT_LOWEST_TREE;
        mt_text_addf(out,
                     "  The lowest modes of %s of %d bodies (%s): %d below %.6g Hz, by count, "
                     "none missing.\n",
                     tree ? "a tree" : "a mechanism", v->l->sys->n_bodies,
                     tree ? "joint coordinates" : "sparse factor", v->l->found.below,
                     mt_modes_complete_below_hz(v->l));
        if (mt_modes_redundant(v->l) > 0) {
            mt_text_addf(out, "  Of the joints' %d equations %d follow from others.\n",
                         v->l->equations, mt_modes_redundant(v->l));
        }
    }
    if (at != NULL && at->equilibrium.active) {
        if (at->equilibrium.residual > MOST_LEFT) {
            mt_text_addf(out, "  Equilibrium found in %d iterations, to rounding.\n",
                         at->iterations);
        } else {
            mt_text_addf(out, "  Equilibrium found in %d iterations, residual %.1e.\n",
                         at->iterations, at->equilibrium.residual);
        }
    }
    if (m->n_condensed > 0) {
        mt_text_addf(out, "  %d direction%s without mass follow%s statically.\n",
                     m->n_condensed, m->n_condensed == 1 ? "" : "s",
                     m->n_condensed == 1 ? "s" : "");
    }
    for (int i = 0; i < v->shown; i++) {
        int size = 1;
        const int first = mt_modal_cluster(m, i, &size);
        if (size > 1 && first == i && m->kind[i] == MT_MODE_FLEXIBLE) {
            const int index = mt_modes_index(m, i);
            mt_text_addf(out,
                         "  Modes %d to %d are repeated: only the space that their shapes span "
                         "is determined.\n",
                         index, index + size - 1);
        }
    }
}

/* What the damped modes of a large mechanism were found from. */
static void write_few_damped(const mt_lowest_damped *few, mt_text *out)
{
    const mt_damped_modes *const d = &few->modes;
    double most = 0.0;
    for (int i = 0; i < d->count; i++) {
        most = fmax(most, few->error[i]);
    }
    mt_text_addf(out,
                 "  The damped modes into which the lowest undamped ones turn, by these and %d "
                 "shape%s that damping adds; errors below %.0e of a root.%s\n",
                 few->shapes, few->shapes == 1 ? "" : "s",
                 pow(10.0, ceil(log10(fmax(most, DBL_EPSILON)))),
                 " Real roots above the last one are not sought (--count all: all roots).");
}

/* asked: for so many modes. */
static void text_view(const mt_modes_view *v, bool asked, mt_text *out)
{
    mt_text_addf(out, "%s\n", mt_loaded_model_configuration(v->s, v->c));
    mt_cli_print_warnings(&v->warning_list, out);
    print_modes(v, out);
    write_solution_notes(v, out);
    if (v->shapes.n > 0) {
        print_shapes(v, out);
    }
    if (v->n_effective > 0) {
        print_effective(v, out);
    }
    if (v->energies.n > 0) {
        print_energies(v, out);
    }
    if (v->question.damped) {
        damped_print(v->damped, v->question.count, out);
    }
    if (v->question.damped && v->l != NULL) {
        write_few_damped(&v->few, out);
    }
    write_others(v, asked, out);
    mt_text_add(out, "\n");
}

typedef struct sink {
    const mt_args *args;
    mt_text *out;
    mt_json_writer w;
    mt_table table; /* CSV */
    int channels;   /* in its columns */
    mt_run run;     /* of all configurations */
} sink;

static mt_status csv_view(sink *to, const mt_modes_view *v)
{
    if (v->question.energy) { /* so are the shares of energy */
        if (to->table.n_columns == 0 && !to->table.failed) {
            to->table = energy_table();
        }
        energy_csv(v, &to->table);
        return MT_OK;
    }
    if (v->question.damped) { /* a table of its own kind: the damped modes alone */
        if (to->table.n_columns == 0 && !to->table.failed) {
            to->table = mt_table_default();
            mt_table_column(&to->table, "configuration", "configuration", MT_ALIGN_LEFT);
            mt_table_record_columns(&to->table, &damped_rows, MT_IN_CSV);
        }
        damped_csv(v->damped, v->question.count, mt_loaded_model_configuration(v->s, v->c),
                   &to->table);
        return MT_OK;
    }
    if (to->table.n_columns == 0 && !to->table.failed) {
        to->table = csv_table(v);
        to->channels = v->shapes.n;
    }
    if (to->table.failed) {
        return MT_OK; /* the output that the table goes into tells */
    }
    if (to->channels != v->shapes.n) {
        return MT_E_USAGE;
    }
    csv_rows(v, &to->table);
    return MT_OK;
}

static mt_status show_configuration_modes(void *context, mt_loaded_model *s, int c,
                                          mt_cli_shown *shown, mt_err *err)
{
    (void)shown;
    sink *const to = context;
    const mt_args *const args = to->args;
    const mt_modes_question question = {
        .count = args->given[MT_OPT_COUNT] ? args->count : MT_MODES_DEFAULT,
        .shapes = args->given[MT_OPT_SHAPES],
        .damped = args->given[MT_OPT_DAMPED],
        .effective_mass = args->given[MT_OPT_EFFECTIVE_MASS],
        .about_m = {args->about_m[0], args->about_m[1], args->about_m[2]},
        .energy = args->given[MT_OPT_ENERGY],
        .energies = {.about = args->value[MT_OPT_ENERGY_ABOUT],
                     .axes = args->value[MT_OPT_AXES]}};
    mt_modes_view v = {.s = NULL};
    to->run.progress = mt_watch_begin(args, 0, "modes");
    mt_status rc = mt_modes_view_take(s, c, &question, &v, err);
    to->run.progress = NULL;
    mt_watch_end(rc == MT_OK);
    if (rc != MT_OK) {
        goto done;
    }
    switch (args->format) {
    case MT_FORMAT_JSON:
        rc = mt_modes_put(&v, &to->w, err);
        break;
    case MT_FORMAT_CSV:
        rc = csv_view(to, &v);
        if (rc != MT_OK) {
            (void)mt_fail(err, rc,
                          "configurations with different bodies do not fit into one CSV table: "
                          "choose one with -c");
        }
        break;
    case MT_FORMAT_HTML:  /* of report alone */
    case MT_FORMAT_SARIF: /* of check alone */
    case MT_FORMAT_TEXT:
        text_view(&v, args->given[MT_OPT_COUNT], to->out);
        break;
    }
done:
    mt_modes_view_free(&v);
    return rc;
}

static int run_modes(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    sink to = {.args = args, .out = out, .w = mt_json_writer_default(out)};
    mt_profile counts;
    mt_profile *const profile = mt_cli_profile(args, &counts);
    if (args->given[MT_OPT_ABOUT] && !args->given[MT_OPT_EFFECTIVE_MASS]) {
        mt_terminal_error("--about goes with --effective-mass");
        return MT_EXIT_INPUT;
    }
    if ((args->given[MT_OPT_ENERGY_ABOUT] || args->given[MT_OPT_AXES]) &&
        !args->given[MT_OPT_ENERGY]) {
        mt_terminal_error("--energy-about and --axes go with --energy");
        return MT_EXIT_INPUT;
    }
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    to.run.profile = profile;
    s.run = &to.run;
    code = mt_cli_each(args, &s, &to.w, show_configuration_modes, &to);
    if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&to.table, out);
    }
    code = mt_exit_worse(code, mt_cli_profile_print(profile));
done:
    mt_table_free(&to.table);
    mt_loaded_model_free(&s);
    return code;
}

const mt_command mt_command_modes = {
    .name = "modes",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "natural frequencies and mode shapes",
    .details =
        "Prints the modes of each configuration: rigid-body, flexible, unstable and undecided "
        "ones (rounding hides whether such a mode is stable, and it has no index). Each has a "
        "bound of the error of its frequency (in JSON and CSV; in the table if it exceeds 1e-6 "
        "of the frequency) and its residual and orthogonality relative to rounding (about 1 is "
        "perfect). Redundant joints and the way to the equilibrium are listed. Shapes are "
        "mass-normalised. Names of modes are shown if --set changes nothing.\n"
        "--effective-mass: with r the rigid motion of the ground and of everything with it, "
        "a mass-normalised shape phi has the participation factor phi' M r and the effective "
        "mass of its square. Springs and joints to the ground move with it, and so does a "
        "locked "
        "drive, which holds its position relative to its first body; loads and gravity stay as "
        "they are. Over all modes the sum is the mass that moves (the moment of inertia about "
        "the point of --about), except what a direction holds rigidly.\n"
        "--energy: the energies of each mode, kinetic by body and direction, strain by spring "
        "and by a bushing's component, and what gravity, loads and preloads give; modes of one "
        "frequency together.",
    .answer = {&mt_modes_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_modes,
};
