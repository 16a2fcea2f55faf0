/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sweep as text, JSON and CSV. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "inspect/sweep.h"
#include "report/table.h"

enum { DIGITS = 6, HOLD_DIGITS = 4, HEADING = 300 };

/* Positions, ratios and forces are rounding below this [rad, m, 1, N, N m]: for people that is
 * 0. */
static const double ROUNDING = 1e-12;

static double tidy(double x)
{
    return fabs(x) < ROUNDING ? 0.0 : x;
}

static const char *drive_si_unit(bool angle)
{
    return angle ? "rad" : "m";
}

/* The unit in which its coordinates are shown: the model's; NULL: SI. */
static const mt_unit *shown_drive_unit(const mt_sweep_view *v, bool angle)
{
    return mt_model_shown(v->sys->model, angle ? MT_ANGLE : MT_LENGTH);
}

static const char *shown_name(const mt_sweep_view *v, bool angle)
{
    return mt_unit_name(shown_drive_unit(v, angle), drive_si_unit(angle));
}

static double shown_drive_position(const mt_sweep_view *v, bool angle, double x)
{
    return mt_unit_from_si(shown_drive_unit(v, angle), tidy(x));
}

static bool several(const mt_sweep_view *v)
{
    return v->question->n_drives > 1;
}

/* A joint's motion per that of the driven one, in these units. */
static double shown_ratio(const mt_sweep_view *v, bool angle, double ratio)
{
    const mt_unit *const unit = shown_drive_unit(v, mt_sweep_driven(v, 0)->angle);
    return shown_drive_position(v, angle, mt_unit_to_si(unit, tidy(ratio)));
}

/* Joints with a coordinate, other than driven ones. */
static bool told(const mt_sweep_view *v, int joint)
{
    bool is = v->sys->joints[joint].coordinate >= 0;
    for (int i = 0; i < v->question->n_drives; i++) {
        is = is && &v->sys->joints[joint] != mt_sweep_driven(v, i);
    }
    return is;
}

static void text_ratio_column(const mt_sweep_view *v, const mt_system_joint *joint, mt_table *t)
{
    char s[HEADING];
    const mt_system_joint *const d = mt_sweep_driven(v, 0);
    if (joint->angle == d->angle) {
        (void)mt_snprintf(s, sizeof s, "per %s", d->name);
    } else {
        (void)mt_snprintf(s, sizeof s, "per %s [%s/%s]", d->name, shown_name(v, joint->angle),
                          shown_name(v, d->angle));
    }
    mt_table_column(t, s, "ratio", MT_ALIGN_POINT);
}

static const char *holder(const mt_sweep_view *v, int drive)
{
    const char *const spring = v->question->drives[drive].spring;
    return spring != NULL ? spring : "lock";
}

/* With several driven joints no ratios: they are in JSON and CSV, one for each of them. */
static void text_columns(const mt_sweep_view *v, mt_table *t)
{
    char s[HEADING];
    for (int i = 0; i < v->question->n_drives; i++) {
        const mt_system_joint *const d = mt_sweep_driven(v, i);
        (void)mt_snprintf(s, sizeof s, "%s [%s]", d->name, shown_name(v, d->angle));
        mt_table_column(t, s, "position", MT_ALIGN_POINT);
    }
    for (int i = 0; i < v->sys->n_joints; i++) {
        const mt_system_joint *const joint = &v->sys->joints[i];
        if (!told(v, i)) {
            continue;
        }
        (void)mt_snprintf(s, sizeof s, "%s [%s]", joint->name, shown_name(v, joint->angle));
        mt_table_column(t, s, joint->name, MT_ALIGN_POINT);
        if (!several(v)) {
            text_ratio_column(v, joint, t);
        }
    }
    for (int i = 0; i < v->question->n_drives; i++) {
        (void)mt_snprintf(s, sizeof s, "%s%s%s [%s]", holder(v, i), several(v) ? " of " : "",
                          several(v) ? mt_sweep_driven(v, i)->name : "",
                          mt_sweep_holds_moment(v, i) ? "N m" : "N");
        mt_table_column(t, s, "hold", MT_ALIGN_POINT);
    }
    for (int i = 0; i < v->modes; i++) {
        (void)mt_snprintf(s, sizeof s, "mode %d [Hz]", i + 1);
        mt_table_column(t, s, "mode", MT_ALIGN_POINT);
    }
}

static double shown_position(const mt_sweep_view *v, const mt_sweep_point *p, int drive)
{
    const bool angle = mt_sweep_driven(v, drive)->angle;
    return mt_unit_from_si(shown_drive_unit(v, angle), p->drive[drive]);
}

static void text_row(const mt_sweep_view *v, int point, mt_table *t)
{
    const mt_sweep_point *const p = &v->sweep.points[point];
    for (int i = 0; i < v->question->n_drives; i++) {
        mt_table_number(t, shown_position(v, p, i), DIGITS);
    }
    for (int i = 0; i < v->sys->n_joints; i++) {
        if (told(v, i)) {
            const bool angle = v->sys->joints[i].angle;
            mt_table_number(t, shown_drive_position(v, angle, p->coordinate[i]), DIGITS);
            if (!several(v)) {
                mt_table_number(t, shown_ratio(v, angle, p->ratio[i]), DIGITS);
            }
        }
    }
    for (int i = 0; i < v->question->n_drives; i++) {
        mt_table_number(t, tidy(p->hold[i]), HOLD_DIGITS);
    }
    for (int i = 0; i < v->modes; i++) {
        mt_table_number(t, v->hz[i + ((ptrdiff_t)point * v->modes)], DIGITS);
    }
}

static void write_undecided(const mt_sweep_view *v, mt_text *out)
{
    int n = 0;
    for (int i = 0; i < v->sweep.n_points && v->rigid != NULL; i++) {
        n += v->sweep.points[i].status == MT_OK && v->undecided[i] > 0 ? 1 : 0;
    }
    if (n > 0) {
        mt_text_addf(
            out,
            "  UNDECIDED at %d position%s: springs and loads cancel, and rounding hides "
            "whether it is stable.\n",
            n, n == 1 ? "" : "s");
    }
}

static void write_modes(const mt_sweep_view *v, mt_text *out)
{
    int unstable = 0;
    int rigid = 0;
    if (v->rigid != NULL && v->modes == 0) {
        mt_text_add(out,
                    "  No vibration modes: with the joint held nothing is left to vibrate.\n");
    }
    for (int i = 0; i < v->sweep.n_points && v->rigid != NULL; i++) {
        if (v->sweep.points[i].status == MT_OK) {
            unstable += v->unstable[i] > 0 ? 1 : 0;
            rigid = v->rigid[i] > rigid ? v->rigid[i] : rigid;
        }
    }
    if (rigid > 0) {
        mt_text_addf(out, "  %d rigid-body mode%s: it can move freely.\n", rigid,
                     rigid == 1 ? "" : "s");
    }
    if (unstable > 0) {
        mt_text_addf(out, "  UNSTABLE at %d position%s: %s not hold.\n", unstable,
                     unstable == 1 ? "" : "s", unstable == 1 ? "it does" : "they do");
    }
    write_undecided(v, out);
}

/* Write the position of the range nearest to a dead centre. */
static void write_dead_centre(const mt_sweep_view *v, mt_text *out)
{
    const mt_sweep_point *nearest = NULL;
    for (int i = 0; i < v->sweep.n_points; i++) {
        const mt_sweep_point *const p = &v->sweep.points[i];
        if (p->status == MT_OK && p->near->near &&
            (nearest == NULL || p->near->distance < nearest->near->distance)) {
            nearest = p;
        }
    }
    if (nearest != NULL) {
        mt_text_add(out, "  Near a dead centre at ");
        for (int i = 0; i < v->question->n_drives; i++) {
            mt_text_addf(out, "%s%.6g %s", i > 0 ? ", " : "", shown_position(v, nearest, i),
                         shown_name(v, mt_sweep_driven(v, i)->angle));
        }
        mt_text_addf(
            out, ": about %.2g rad (or model lengths) on, joints %s depend on each other.\n",
            nearest->near->distance, nearest->near->joints.text);
    }
}

static void sweep_print(const mt_sweep_view *v, mt_text *out)
{
    mt_table t = mt_table_default();
    double gap = 0.0;
    text_columns(v, &t);
    for (int i = 0; i < v->sweep.n_points; i++) {
        if (v->sweep.points[i].status == MT_OK) {
            text_row(v, i, &t);
            gap = fmax(gap, v->sweep.points[i].gap_m);
        }
    }
    mt_text_addf(out, "%s\n", v->configuration);
    if (v->sweep.n_reached > 0) {
        mt_table_print(&t, 2, mt_terminal_width(), out);
        mt_text_addf(out, "  Largest gap of a joint %.1e m.\n", gap);
        write_dead_centre(v, out);
    }
    if (v->sweep.n_reached < v->sweep.n_points) {
        mt_text_addf(out, "  %d of %d positions reached.\n", v->sweep.n_reached,
                     v->sweep.n_points);
    }
    write_modes(v, out);
    mt_text_add(out, "\n");
    mt_table_free(&t);
}

#define THIS mt_sweep_point_row
/* Columns of CSV: where the joint turns, or slides, and a moment holds it, or a force. */
enum { IN_TURNS = MT_IN_OWN, IN_SLIDES = 2 * MT_IN_OWN, IN_MOMENT = 4 * MT_IN_OWN };
enum { IN_FORCE = 8 * MT_IN_OWN };
static const mt_record_column point_columns[] = {
    MT_R_COLUMN(position_rad, "position [rad]", DIGITS, IN_TURNS),
    MT_R_COLUMN(position_m, "position [m]", DIGITS, IN_SLIDES),
    MT_R_COLUMN(hold_n_m, "hold [N m]", DIGITS, IN_MOMENT),
    MT_R_COLUMN(hold_n, "hold [N]", DIGITS, IN_FORCE),
    MT_R_COLUMN(residual, "residual", DIGITS, MT_IN_CSV),
    MT_R_COLUMN(gap_m, "gap [m]", DIGITS, MT_IN_CSV),
};
static const mt_record_table point_rows = MT_R_TABLE_OF(mt_sweep_point_record, point_columns);
#undef THIS

/* Ratios of a joint to each driven joint. */
static void csv_ratio_columns(const mt_sweep_view *v, const mt_system_joint *joint, mt_table *t)
{
    for (int d = 0; d < v->question->n_drives; d++) {
        char s[HEADING];
        const mt_system_joint *const drive = mt_sweep_driven(v, d);
        const char *const unit = joint->angle == drive->angle ? ""
                                 : joint->angle               ? "_rad_per_m"
                                                              : "_m_per_rad";
        (void)mt_snprintf(s, sizeof s, "%s_ratio%s%s%s", joint->name, several(v) ? "_to_" : "",
                          several(v) ? drive->name : "", unit);
        mt_table_column(t, s, s, MT_ALIGN_POINT);
    }
}

/* What several joints are driven to, and what holds each. */
static void csv_drive_columns(const mt_sweep_view *v, bool hold, mt_table *t)
{
    for (int d = 0; d < v->question->n_drives; d++) {
        char s[HEADING];
        const mt_system_joint *const drive = mt_sweep_driven(v, d);
        (void)mt_snprintf(s, sizeof s, "%s_%s", drive->name,
                          !hold                         ? drive_si_unit(drive->angle)
                          : mt_sweep_holds_moment(v, d) ? "hold_n_m"
                                                        : "hold_n");
        mt_table_column(t, s, s, MT_ALIGN_POINT);
    }
}

/* Columns, then rows of all points; two configurations with the same joints have the same
 * columns. */
static void sweep_csv_columns(const mt_sweep_view *v, mt_table *t)
{
    const bool angle = mt_sweep_driven(v, 0)->angle;
    const unsigned hold = mt_sweep_holds_moment(v, 0) ? IN_MOMENT : IN_FORCE;
    char s[HEADING];
    mt_table_column(t, "configuration", "configuration", MT_ALIGN_LEFT);
    if (several(v)) {
        csv_drive_columns(v, false, t);
    } else {
        mt_table_record_columns(t, &point_rows, angle ? IN_TURNS : IN_SLIDES);
    }
    for (int i = 0; i < v->sys->n_joints; i++) {
        if (told(v, i)) {
            const mt_system_joint *const joint = &v->sys->joints[i];
            (void)mt_snprintf(s, sizeof s, "%s_%s", joint->name, drive_si_unit(joint->angle));
            mt_table_column(t, s, s, MT_ALIGN_POINT);
            csv_ratio_columns(v, joint, t);
        }
    }
    if (several(v)) {
        csv_drive_columns(v, true, t);
    }
    mt_table_record_columns(t, &point_rows, MT_IN_CSV | (several(v) ? 0U : hold));
    for (int i = 0; i < v->modes; i++) {
        (void)mt_snprintf(s, sizeof s, "mode_%d_hz", i + 1);
        mt_table_column(t, s, s, MT_ALIGN_POINT);
    }
}

static void csv_joints(const mt_sweep_view *v, const mt_sweep_point *p, mt_table *t)
{
    for (int i = 0; i < v->sys->n_joints; i++) {
        if (told(v, i)) {
            mt_table_number(t, p->coordinate[i], DIGITS);
            for (ptrdiff_t d = 0; d < v->question->n_drives; d++) {
                mt_table_number(t, p->ratio[i + (d * v->sys->n_joints)], DIGITS);
            }
        }
    }
}

static void sweep_csv_rows(const mt_sweep_view *v, mt_table *t)
{
    const unsigned hold = mt_sweep_holds_moment(v, 0) ? IN_MOMENT : IN_FORCE;
    for (int k = 0; k < v->sweep.n_points; k++) {
        const mt_sweep_point *const p = &v->sweep.points[k];
        const mt_sweep_point_row row = mt_sweep_point_row_of(v, k);
        mt_table_text(t, v->configuration);
        if (!several(v)) {
            mt_table_record_row(t, &point_rows, row.turns ? IN_TURNS : IN_SLIDES, &row);
        }
        for (int d = 0; d < v->question->n_drives && several(v); d++) {
            mt_table_number(t, p->drive[d], DIGITS);
        }
        csv_joints(v, p, t);
        for (int d = 0; d < v->question->n_drives && several(v); d++) {
            mt_table_number(t, p->hold[d], DIGITS);
        }
        mt_table_record_row(t, &point_rows, MT_IN_CSV | (several(v) ? 0U : hold), &row);
        for (int i = 0; i < v->modes; i++) {
            mt_table_number(t, v->hz[i + ((ptrdiff_t)k * v->modes)], DIGITS);
        }
    }
}

/* Each reason why points are missing, once. */
static int write_missing(const mt_loaded_model *s, const mt_sweep_view *v)
{
    const char *last = NULL;
    int code = MT_EXIT_DONE;
    for (int i = 0; i < v->sweep.n_points; i++) {
        const mt_sweep_point *const p = &v->sweep.points[i];
        if (p->status == MT_OK) {
            continue;
        }
        if (last == NULL || strcmp(last, p->why) != 0) {
            mt_terminal_error("%s: configuration \"%s\": %s", s->path, v->configuration,
                              p->why);
        }
        last = p->why;
        code = mt_exit_worse(code, mt_exit_of(p->status));
    }
    return code;
}

typedef struct sink {
    const mt_args *args;
    mt_sweep_question question;
    mt_text *out;
    mt_json_writer w;
    mt_table table; /* CSV */
} sink;

static bool same_columns(const mt_table *a, const mt_table *b)
{
    bool same = a->n_columns == b->n_columns;
    for (int i = 0; i < a->n_columns && same; i++) {
        same = strcmp(a->columns[i].member, b->columns[i].member) == 0;
    }
    return same;
}

static mt_status add_csv(sink *to, const mt_sweep_view *v, mt_err *err)
{
    mt_table columns = mt_table_default();
    sweep_csv_columns(v, &columns);
    if (columns.failed || to->table.failed) {
        to->table.failed = true; /* the output that the table goes into tells */
        mt_table_free(&columns);
        return MT_OK;
    }
    if (to->table.n_columns == 0) {
        to->table = columns;
        sweep_csv_rows(v, &to->table);
        return MT_OK;
    }
    const bool same = same_columns(&to->table, &columns);
    mt_table_free(&columns);
    if (!same) {
        return mt_fail(err, MT_E_USAGE,
                       "configurations with different joints do not fit into one CSV table: "
                       "choose one with -c");
    }
    sweep_csv_rows(v, &to->table);
    return MT_OK;
}

/* Warn before the table of a range beyond a turn: it may be in degrees, or of a motor's
 * shaft. */
static void warn_range(const mt_sweep_view *v)
{
    static const double ONE_TURN = 6.283185307179586;
    const mt_sweep_question *const r = v->question;
    for (int d = 0; d < r->n_drives; d++) {
        double most = 0.0;
        for (int i = 0; i < r->n; i++) {
            const double at = r->positions[d + ((ptrdiff_t)i * r->n_drives)];
            most = fabs(at) > fabs(most) ? at : most;
        }
        if (mt_sweep_driven(v, d)->angle && fabs(most) > ONE_TURN) {
            mt_terminal_warning("--drive: %s goes to %g rad, more than a turn: degrees are "
                                "written \"%g*deg\"",
                                r->drives[d].joint, most, most);
        }
    }
}

static mt_status show_configuration_sweep(void *context, mt_loaded_model *s, int c,
                                          mt_cli_shown *shown, mt_err *err)
{
    sink *const to = context;
    mt_sweep_view v = {.question = NULL};
    mt_loaded_model_warn_dropped(s, c, "--drive", to->question.n_drives, to->question.drives);
    mt_status rc = mt_sweep_view_take(s, c, &to->question, &v, err);
    if (rc != MT_E_USAGE) {
        (void)mt_err_in(err, rc, "%s", s->path);
    }
    if (rc == MT_OK) {
        warn_range(&v);
        shown->code = mt_exit_worse(shown->code, write_missing(s, &v));
        switch (to->args->format) {
        case MT_FORMAT_JSON:
            rc = mt_sweep_put(&v, &to->w, err);
            break;
        case MT_FORMAT_CSV:
            rc = add_csv(to, &v, err);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            sweep_print(&v, to->out);
            mt_loaded_model_note_links(s, c, to->out);
            break;
        }
    }
    mt_sweep_view_free(&v);
    return rc;
}

static int run_sweep(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    sink to = {.args = args, .out = out, .w = mt_json_writer_default(out)};
    mt_err err = {.code = MT_OK};
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    const mt_sweep_texts texts = {.n_drives = args->all[MT_OPT_DRIVE].n,
                                  .drives = args->all[MT_OPT_DRIVE].value,
                                  .n_holds = args->all[MT_OPT_HOLD].n,
                                  .holds = args->all[MT_OPT_HOLD].value,
                                  .grid = args->given[MT_OPT_GRID]};
    const mt_status rc = mt_sweep_question_read(&s, &texts, &to.question, &err);
    if (args->given[MT_OPT_FREQUENCIES]) {
        to.question.modes = args->count > 0 ? args->count : MT_SWEEP_MODES;
    }
    if (rc != MT_OK) {
        code = mt_cli_failed(rc, &err);
        goto done;
    }
    code = mt_cli_each(args, &s, &to.w, show_configuration_sweep, &to);
    if (args->format == MT_FORMAT_CSV && (to.table.n_columns > 0 || to.table.failed)) {
        mt_table_csv(&to.table, out);
    }
done:
    mt_table_free(&to.table);
    mt_loaded_model_free(&s);
    return code;
}

const mt_command mt_command_sweep = {
    .name = "sweep",
    .operands = "MODEL",
    .least = 1,
    .most = 1,
    .summary = "positions and frequencies over a range of motion",
    .details = "Drives a joint through a range (--drive) and prints at each position the "
               "coordinate of every joint, its ratio to the driven one (an exact derivative), "
               "what holds the joint, and with --frequencies the natural frequencies by index "
               "(default: "
               "6). If a limit position ends the range, the positions before it are printed, a "
               "message names the limit, and the exit status is 3.",
    .answer = {&mt_swept_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_sweep,
};
