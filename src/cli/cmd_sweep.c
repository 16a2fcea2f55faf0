/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sweep as text, JSON and CSV. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "mechanics/position.h"
#include "mechanics/sweep.h"
#include "model/model.h"
#include "model/values.h"
#include "report/table.h"
#include "result/write.h"

/* The drive and the positions of --drive and --hold. */
typedef struct sweep_request {
    mt_system_drive drive;
    int n;
    double *positions; /* [n] rad or m from the reference position */
} sweep_request;

/* The sweep of one configuration with all that its output needs. */
typedef struct sweep_view {
    const char *configuration;
    const sweep_request *request;
    const mt_system *sys;
    mt_sweep sweep;
    int modes;      /* frequencies per point; 0: not requested */
    double *hz;     /* modes x n points; NaN: no such mode */
    int *rigid;     /* [n] rigid-body modes */
    int *unstable;  /* [n] */
    int *undecided; /* [n] */
} sweep_view;

enum { DIGITS = 6, HOLD_DIGITS = 4, HEADING = 300 };

/* Positions, ratios and forces are rounding below this [rad, m, 1, N, N m]: for people that is
 * 0. */
static const double ROUNDING = 1e-12;

static double tidy(double x)
{
    return fabs(x) < ROUNDING ? 0.0 : x;
}

static const mt_system_joint *driven(const sweep_view *v)
{
    return &v->sys->joints[v->sys->drive_joint];
}

static const char *drive_si_unit(bool angle)
{
    return angle ? "rad" : "m";
}

/* The unit in which its coordinates are shown: the model's; NULL: SI. */
static const mt_unit *shown_drive_unit(const sweep_view *v, bool angle)
{
    return mt_model_shown(v->sys->model, angle ? MT_ANGLE : MT_LENGTH);
}

static const char *shown_name(const sweep_view *v, bool angle)
{
    return mt_unit_name(shown_drive_unit(v, angle), drive_si_unit(angle));
}

static double shown_drive_position(const sweep_view *v, bool angle, double x)
{
    return mt_unit_from_si(shown_drive_unit(v, angle), tidy(x));
}

/* A joint's motion per that of the driven one, in these units. */
static double shown_ratio(const sweep_view *v, bool angle, double ratio)
{
    return shown_drive_position(
        v, angle, mt_unit_to_si(shown_drive_unit(v, driven(v)->angle), tidy(ratio)));
}

/* True where the holding force acts along an angle. */
static bool hold_is_moment(const sweep_view *v)
{
    if (!v->sys->trim) {
        return driven(v)->angle;
    }
    const mt_spring_def *const s = &v->sys->springs[v->sys->trim_spring];
    const mt_measure_kind kind = v->sys->measures[s->measure[0]].kind;
    return kind == MT_MEASURE_ANGLE || kind == MT_MEASURE_ROTATION;
}

/* Joints with a coordinate, other than the driven one. */
static bool told(const sweep_view *v, int joint)
{
    return v->sys->joints[joint].coordinate >= 0 && joint != v->sys->drive_joint;
}

static void text_columns(const sweep_view *v, mt_table *t)
{
    char s[HEADING];
    const mt_system_joint *const d = driven(v);
    (void)mt_snprintf(s, sizeof s, "%s [%s]", d->name, shown_name(v, d->angle));
    mt_table_column(t, s, "position", MT_ALIGN_POINT);
    for (int i = 0; i < v->sys->n_joints; i++) {
        const mt_system_joint *const joint = &v->sys->joints[i];
        if (!told(v, i)) {
            continue;
        }
        (void)mt_snprintf(s, sizeof s, "%s [%s]", joint->name, shown_name(v, joint->angle));
        mt_table_column(t, s, joint->name, MT_ALIGN_POINT);
        if (joint->angle == d->angle) {
            (void)mt_snprintf(s, sizeof s, "per %s", d->name);
        } else {
            (void)mt_snprintf(s, sizeof s, "per %s [%s/%s]", d->name,
                              shown_name(v, joint->angle), shown_name(v, d->angle));
        }
        mt_table_column(t, s, "ratio", MT_ALIGN_POINT);
    }
    (void)mt_snprintf(s, sizeof s, "%s [%s]", v->sys->trim ? v->request->drive.spring : "lock",
                      hold_is_moment(v) ? "N m" : "N");
    mt_table_column(t, s, "hold", MT_ALIGN_POINT);
    for (int i = 0; i < v->modes; i++) {
        (void)mt_snprintf(s, sizeof s, "mode %d [Hz]", i + 1);
        mt_table_column(t, s, "mode", MT_ALIGN_POINT);
    }
}

static void text_row(const sweep_view *v, int point, mt_table *t)
{
    const mt_sweep_point *const p = &v->sweep.points[point];
    mt_table_number(t, mt_unit_from_si(shown_drive_unit(v, driven(v)->angle), p->drive),
                    DIGITS);
    for (int i = 0; i < v->sys->n_joints; i++) {
        if (told(v, i)) {
            const bool angle = v->sys->joints[i].angle;
            mt_table_number(t, shown_drive_position(v, angle, p->coordinate[i]), DIGITS);
            mt_table_number(t, shown_ratio(v, angle, p->ratio[i]), DIGITS);
        }
    }
    mt_table_number(t, tidy(p->hold), HOLD_DIGITS);
    for (int i = 0; i < v->modes; i++) {
        mt_table_number(t, v->hz[i + ((ptrdiff_t)point * v->modes)], DIGITS);
    }
}

static void write_undecided(const sweep_view *v, mt_text *out)
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

static void write_modes(const sweep_view *v, mt_text *out)
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
static void write_dead_centre(const sweep_view *v, mt_text *out)
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
        mt_text_addf(out,
                     "  Near a dead centre at %.6g %s: about %.2g rad (or model lengths) on, "
                     "joints %s depend on each other.\n",
                     mt_unit_from_si(shown_drive_unit(v, driven(v)->angle), nearest->drive),
                     shown_name(v, driven(v)->angle), nearest->near->distance,
                     nearest->near->joints.text);
    }
}

static void sweep_print(const sweep_view *v, mt_text *out)
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

/* JSON: a joint with a coordinate at a position. */
typedef struct joint_row {
    const char *name;
    bool turns;
    bool slides;
    double coordinate;
    double ratio;
} joint_row;

#define THIS joint_row
static const mt_field joint_fields[] = {
    MT_F_TEXT("name", name, "The joint."),
    MT_F_NUMBER("coordinate_rad", coordinate,
                "Its coordinate from the reference position, whole turns counted.",
                MT_F_WHEN(turns)),
    MT_F_NUMBER("coordinate_m", coordinate, "Its coordinate from the reference position.",
                MT_F_WHEN(slides)),
    MT_F_NUMBER(
        "ratio", ratio,
        "Its motion per motion of the driven joint, in rad or m per rad or m: the exact "
        "slope."),
};
static const mt_record joint_record =
    MT_F_RECORD_OF(joint_fields, "joint", "A joint with a coordinate at a position.");
#undef THIS

/* A position of the driven joint. */
typedef struct point_row {
    bool turns;          /* the driven joint: its position is an angle */
    bool slides;         /* else */
    double position_rad; /* of a joint that turns */
    double position_m;   /* of one that slides */
    const char *error;
    bool failed;
    bool reached;
    int n_joints;
    joint_row *joints;
    bool holds_moment;
    bool holds_force;
    double hold_n_m; /* of a moment */
    double hold_n;   /* of a force */
    double residual;
    double gap_m;
    mt_dead_centre_row *dead_centre;
    bool with_modes;
    int n_hz;
    double *hz;
    int rigid;
    int unstable;
    int undecided;
} point_row;

#define THIS point_row
static const mt_field point_fields[] = {
    MT_F_NUMBER("position_rad", position_rad, "Position of the driven joint, an angle.",
                MT_F_WHEN(turns)),
    MT_F_NUMBER("position_m", position_m, "Position of the driven joint, a displacement.",
                MT_F_WHEN(slides)),
    MT_F_TEXT("error", error, "Why it is not reached; then nothing else is known.",
              MT_F_WHEN(failed)),
    MT_F_LIST("joints", joints, n_joints, joint_row, joint_record,
              "Every joint with a coordinate.", .flat = true, MT_F_WHEN(reached)),
    MT_F_NUMBER("hold_n_m", hold_n_m, "What holds the position: a moment.",
                MT_F_WHEN(holds_moment)),
    MT_F_NUMBER("hold_n", hold_n, "What holds the position: a force.", MT_F_WHEN(holds_force)),
    MT_F_NUMBER("equilibrium_residual", residual, "Part of the forces at work that is left.",
                MT_F_WHEN(reached)),
    MT_F_NUMBER("gap_m", gap_m, "Largest violation of a joint.", MT_F_WHEN(reached)),
    MT_F_OPTION("dead_centre", dead_centre, mt_dead_centre_row, mt_dead_centre_record,
                "A dead centre within about three degrees; null: none.", MT_F_WHEN(reached)),
    MT_F_NUMBERS(
        "frequencies_hz", hz, n_hz,
        "With --frequencies: natural frequencies by index; null: there is no such mode.",
        MT_F_WHEN(with_modes)),
    MT_F_COUNT("rigid_body_modes", rigid, 0,
               "With --frequencies: number of modes of frequency 0.", MT_F_WHEN(with_modes)),
    MT_F_COUNT("unstable_modes", unstable, 0, "With --frequencies: number of modes that grow.",
               MT_F_WHEN(with_modes)),
    MT_F_COUNT(
        "undecided_modes", undecided, 0,
        "With --frequencies: number of modes of which rounding hides whether they are stable.",
        MT_F_WHEN(with_modes)),
};
static const mt_record point_record =
    MT_F_RECORD_OF(point_fields, "point", "A position of the driven joint.");
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
static const mt_record_table point_rows = MT_R_TABLE_OF(point_record, point_columns);
#undef THIS

/* The sweep of one configuration. */
typedef struct swept_row {
    const char *configuration;
    const char *joint;
    const char *hold;
    const char *spring;
    int n;
    point_row *points;
} swept_row;

#define THIS swept_row
static const char *const holds[] = {"lock", "trim"};
static const mt_field swept_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_TEXT("joint", joint, "The driven joint."),
    MT_F_CHOICE("hold", hold, holds,
                "What holds each position: a lock of the joint, or a spring that is trimmed."),
    MT_F_TEXT_OR_NULL("spring", spring, "The spring that is trimmed; null: a lock holds."),
    MT_F_LIST("points", points, n, point_row, point_record,
              "All positions, from first to last."),
};
static const mt_record swept_record =
    MT_F_RECORD_OF(swept_fields, "configuration", "A configuration, swept.");
#undef THIS

static joint_row *joint_rows_of(const sweep_view *v, const mt_sweep_point *p, mt_arena *mem,
                                int *n)
{
    joint_row *const out = mt_arena_alloc(mem, (size_t)v->sys->n_joints, sizeof *out);
    for (int i = 0; out != NULL && i < v->sys->n_joints; i++) {
        const mt_system_joint *const joint = &v->sys->joints[i];
        if (joint->coordinate >= 0) {
            out[(*n)++] = (joint_row){.name = joint->name,
                                      .turns = joint->angle,
                                      .slides = !joint->angle,
                                      .coordinate = p->coordinate[i],
                                      .ratio = p->ratio[i]};
        }
    }
    return out;
}

/* Without its lists. */
static point_row point_row_of(const sweep_view *v, int point)
{
    const mt_sweep_point *const p = &v->sweep.points[point];
    const bool reached = p->status == MT_OK;
    const bool turns = driven(v)->angle;
    const bool moment = hold_is_moment(v);
    point_row row = {.turns = turns,
                     .slides = !turns,
                     .position_rad = p->drive,
                     .position_m = p->drive,
                     .error = p->why,
                     .failed = !reached,
                     .reached = reached,
                     .holds_moment = reached && moment,
                     .holds_force = reached && !moment,
                     .hold_n_m = p->hold,
                     .hold_n = p->hold,
                     .residual = p->residual,
                     .gap_m = p->gap_m,
                     .with_modes = reached && v->rigid != NULL};
    if (row.with_modes) {
        row.n_hz = v->modes;
        row.hz = v->hz + ((ptrdiff_t)point * v->modes);
        row.rigid = v->rigid[point];
        row.unstable = v->unstable[point];
        row.undecided = v->undecided[point];
    }
    return row;
}

/* Lists in mem. */
static mt_status sweep_json(const sweep_view *v, mt_arena *mem, mt_json_writer *w, mt_err *err)
{
    swept_row row = {.configuration = v->configuration,
                     .joint = driven(v)->name,
                     .hold = holds[v->sys->trim ? 1 : 0],
                     .spring = v->sys->trim ? v->request->drive.spring : NULL,
                     .n = v->sweep.n_points};
    row.points = mt_arena_alloc(mem, (size_t)row.n, sizeof *row.points);
    MT_TRY(mt_arena_check(mem, err));
    for (int i = 0; i < row.n; i++) {
        const mt_sweep_point *const p = &v->sweep.points[i];
        row.points[i] = point_row_of(v, i);
        if (p->status == MT_OK) {
            row.points[i].joints = joint_rows_of(v, p, mem, &row.points[i].n_joints);
            row.points[i].dead_centre = mt_cli_dead_centre(p->near, mem);
        }
    }
    MT_TRY(mt_arena_check(mem, err));
    mt_record_put_object(w, NULL, &swept_record, &row, 0, NULL);
    return MT_OK;
}

/* Columns, then rows of all points; two configurations with the same joints have the same
 * columns. */
static void sweep_csv_columns(const sweep_view *v, mt_table *t)
{
    char s[HEADING];
    mt_table_column(t, "configuration", "configuration", MT_ALIGN_LEFT);
    mt_table_record_columns(t, &point_rows, driven(v)->angle ? IN_TURNS : IN_SLIDES);
    for (int i = 0; i < v->sys->n_joints; i++) {
        if (told(v, i)) {
            const mt_system_joint *const joint = &v->sys->joints[i];
            (void)mt_snprintf(s, sizeof s, "%s_%s", joint->name, drive_si_unit(joint->angle));
            mt_table_column(t, s, s, MT_ALIGN_POINT);
            (void)mt_snprintf(s, sizeof s, "%s_ratio%s", joint->name,
                              joint->angle == driven(v)->angle ? ""
                              : joint->angle                   ? "_rad_per_m"
                                                               : "_m_per_rad");
            mt_table_column(t, s, s, MT_ALIGN_POINT);
        }
    }
    mt_table_record_columns(t, &point_rows,
                            MT_IN_CSV | (unsigned)(hold_is_moment(v) ? IN_MOMENT : IN_FORCE));
    for (int i = 0; i < v->modes; i++) {
        (void)mt_snprintf(s, sizeof s, "mode_%d_hz", i + 1);
        mt_table_column(t, s, s, MT_ALIGN_POINT);
    }
}

static void sweep_csv_rows(const sweep_view *v, mt_table *t)
{
    const unsigned hold = hold_is_moment(v) ? IN_MOMENT : IN_FORCE;
    for (int k = 0; k < v->sweep.n_points; k++) {
        const mt_sweep_point *const p = &v->sweep.points[k];
        const point_row row = point_row_of(v, k);
        mt_table_text(t, v->configuration);
        mt_table_record_row(t, &point_rows, row.turns ? IN_TURNS : IN_SLIDES, &row);
        for (int i = 0; i < v->sys->n_joints; i++) {
            if (told(v, i)) {
                mt_table_number(t, p->coordinate[i], DIGITS);
                mt_table_number(t, p->ratio[i], DIGITS);
            }
        }
        mt_table_record_row(t, &point_rows, MT_IN_CSV | hold, &row);
        for (int i = 0; i < v->modes; i++) {
            mt_table_number(t, v->hz[i + ((ptrdiff_t)k * v->modes)], DIGITS);
        }
    }
}

/* modetune sweep: positions, ratios and frequencies along the range of one driven joint. */

enum { DEFAULT_MODES = 6, MOST_POINTS = 100001 };

/* N, a whole number: 1 only where the range is a point. */
static mt_status read_points(const char *text, const double range[2], int *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const long n = strtol(text, &end, 10);
    const int least = range[0] == range[1] ? 1 : 2;
    if (text[0] < '0' || text[0] > '9' || *end != '\0' || errno != 0 || n < least ||
        n > MOST_POINTS) {
        return mt_fail(
            err, MT_E_USAGE,
            "--drive: the number of positions, \"%s\", is not a whole number from %d "
            "to %d",
            text, least, (int)MOST_POINTS);
    }
    *out = (int)n;
    return MT_OK;
}

/* "JOINT=FROM:TO:N" with expressions of the subject's values, into mem. Fails: MT_E_USAGE,
 * MT_E_MEMORY. */
static mt_status read_request(const mt_args *args, mt_loaded_model *s, sweep_request *out,
                              mt_err *err)
{
    const char *const text = args->value[MT_OPT_DRIVE];
    double range[2] = {0.0, 0.0};
    if (text == NULL) {
        return mt_fail(err, MT_E_USAGE, "\"sweep\" needs --drive JOINT=FROM:TO:N");
    }
    const char *const equals = strchr(text, '=');
    const char *const first = equals == NULL ? NULL : strchr(equals, ':');
    const char *const second = first == NULL ? NULL : strchr(first + 1, ':');
    if (second == NULL || equals == text || strchr(second + 1, ':') != NULL) {
        return mt_fail(err, MT_E_USAGE, "--drive: \"%s\" is not JOINT=FROM:TO:N", text);
    }
    out->drive.joint = mt_arena_strndup(&s->mem, text, (size_t)(equals - text));
    out->drive.spring = args->value[MT_OPT_HOLD];
    MT_TRY(mt_arena_check(&s->mem, err));
    const mt_unit *const unit = mt_loaded_model_joint_unit(s->model, out->drive.joint);
    MT_TRY(mt_loaded_model_number(s, "drive", unit, equals + 1, (size_t)(first - equals - 1),
                                  &range[0], err));
    MT_TRY(mt_loaded_model_number(s, "drive", unit, first + 1, (size_t)(second - first - 1),
                                  &range[1], err));
    MT_TRY(read_points(second + 1, range, &out->n, err));
    out->positions = mt_arena_f64(&s->mem, (size_t)out->n, 1);
    MT_TRY(mt_arena_check(&s->mem, err));
    mt_sweep_range(range[0], range[1], out->n, out->positions);
    return MT_OK;
}

/* One configuration at work. */
typedef struct job {
    sweep_view v;
    mt_arena mem;
    mt_analysis *a; /* with --frequencies */
    mt_system *sys; /* without */
    mt_linear *lin;
} job;

/* Modes at one point. */
static mt_status store_point_modes(void *context, int point, const double *inputs, mt_err *err)
{
    job *const j = context;
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true; /* of the position */
    opt.check = false;
    opt.bounds = false;
    MT_TRY(mt_analysis_solve(j->a, inputs, &opt, err));
    const mt_modes *const m = &j->a->modes;
    for (int i = 0; i < j->v.modes; i++) {
        const int at = mt_modal_flexible(m, i + 1);
        j->v.hz[i + ((ptrdiff_t)point * j->v.modes)] = at < 0 ? nan("") : mt_modal_hz(m, at);
    }
    j->v.rigid[point] = m->n_rigid;
    j->v.unstable[point] = m->n_unstable;
    j->v.undecided[point] = m->n_undecided;
    return MT_OK;
}

static mt_status prepare_modes(job *j, int wanted, mt_err *err)
{
    const size_t n = (size_t)j->v.request->n;
    const mt_modes *const m = &j->a->modes;
    const int flexible = mt_modal_vibrations(m);
    j->v.modes = flexible < wanted ? flexible : wanted;
    j->v.hz = mt_arena_f64(&j->mem, (size_t)j->v.modes, n);
    j->v.rigid = mt_arena_int(&j->mem, n);
    j->v.unstable = mt_arena_int(&j->mem, n);
    j->v.undecided = mt_arena_int(&j->mem, n);
    MT_TRY(mt_arena_check(&j->mem, err));
    for (size_t i = 0; i < n * (size_t)j->v.modes; i++) {
        j->v.hz[i] = nan("");
    }
    return MT_OK;
}

/* The range of the command line lies within reach of the joint. */
static mt_status check_reach(const mt_system *sys, const sweep_request *r, mt_err *err)
{
    const double reach = mt_drive_reach(sys, sys->drive_joint);
    const mt_dimension of = sys->joints[sys->drive_joint].angle ? MT_ANGLE : MT_LENGTH;
    const mt_unit *const shown = mt_model_shown(sys->model, of);
    const char *const unit = mt_unit_name(shown, mt_dimension_si(of));
    for (int i = 0; i < r->n; i++) {
        if (!(fabs(r->positions[i]) <= reach)) {
            return mt_fail(err, MT_E_USAGE,
                           "--drive: %s goes to %g %s, and at most to %g %s from the reference "
                           "position",
                           r->drive.joint, mt_unit_from_si(shown, r->positions[i]), unit,
                           mt_unit_from_si(shown, reach), unit);
        }
    }
    return MT_OK;
}

static mt_status sweep_configuration(const mt_args *args, const mt_loaded_model *s, int c,
                                     job *j, mt_err *err)
{
    const sweep_request *const r = j->v.request;
    const mt_sweep_visitor visitor = {.visit = store_point_modes, .context = j};
    const size_t n = (size_t)s->n_inputs;
    MT_TRY(mt_arena_init(&j->mem, 0, err));
    double *const at = mt_arena_f64(&j->mem, n + 1, 1);
    MT_TRY(mt_arena_check(&j->mem, err));
    for (size_t i = 0; i < n; i++) {
        at[i] = s->at[i];
    }
    at[n] = r->positions[0]; /* the one nearest to the reference: every system is made there */
    for (int i = 1; i < r->n; i++) {
        at[n] = fabs(r->positions[i]) < fabs(at[n]) ? r->positions[i] : at[n];
    }
    mt_system_def def = mt_loaded_model_system(s, c, s->n_inputs, s->inputs, at);
    def.drive = &r->drive;
    MT_TRY(mt_system_new_of(&def, &j->sys, err));
    MT_TRY(check_reach(j->sys, r, err));
    if (args->given[MT_OPT_FREQUENCIES]) {
        mt_system_delete(j->sys);
        j->sys = NULL;
        MT_TRY(mt_analysis_new_of(&def, 0, &j->a, err));
        j->a->recount = true; /* a spring may get hold of a direction on the way */
        MT_TRY(prepare_modes(j, args->count > 0 ? args->count : DEFAULT_MODES, err));
        j->sys = j->a->own_sys;
        j->lin = j->a->lin;
    } else {
        MT_TRY(mt_linear_new(j->sys, &j->lin, err));
    }
    j->v.sys = j->sys;
    const mt_status rc = mt_sweep_run(j->lin, at, r->n, r->positions,
                                      args->given[MT_OPT_FREQUENCIES] ? &visitor : NULL,
                                      &j->mem, &j->v.sweep, err);
    return mt_err_in(err, rc, "configuration \"%s\"", j->v.configuration);
}

/* Each reason why points are missing, once. */
static int write_missing(const mt_loaded_model *s, const sweep_view *v)
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

static mt_status add_csv(sink *to, const sweep_view *v, mt_err *err)
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
static void warn_range(const job *j)
{
    static const double ONE_TURN = 6.283185307179586;
    const sweep_request *const r = j->v.request;
    double most = 0.0;
    for (int i = 0; i < r->n; i++) {
        most = fabs(r->positions[i]) > fabs(most) ? r->positions[i] : most;
    }
    if (j->sys->drive_joint >= 0 && j->sys->joints[j->sys->drive_joint].angle &&
        fabs(most) > ONE_TURN) {
        mt_terminal_warning("--drive: %s goes to %g rad, more than a turn: degrees are written "
                            "\"%g*deg\"",
                            r->drive.joint, most, most);
    }
}

static int show_configuration_sweep(sink *to, const mt_loaded_model *s, int c,
                                    const sweep_request *request)
{
    job j = {.a = NULL};
    mt_err err = {.code = MT_OK};
    int code = MT_EXIT_DONE;
    j.v.configuration = mt_loaded_model_configuration(s, c);
    mt_loaded_model_warn_dropped(s, c, "--drive", request->drive.joint);
    j.v.request = request;
    mt_loaded_model_warn_overridden(s, c);
    mt_status rc = sweep_configuration(to->args, s, c, &j, &err);
    if (rc != MT_E_USAGE) {
        (void)mt_err_in(&err, rc, "%s", s->path);
    }
    if (rc == MT_OK) {
        warn_range(&j);
        code = write_missing(s, &j.v);
        switch (to->args->format) {
        case MT_FORMAT_JSON:
            rc = sweep_json(&j.v, &j.mem, &to->w, &err);
            break;
        case MT_FORMAT_CSV:
            rc = add_csv(to, &j.v, &err);
            break;
        case MT_FORMAT_HTML:  /* of report alone */
        case MT_FORMAT_SARIF: /* of check alone */
        case MT_FORMAT_TEXT:
            sweep_print(&j.v, to->out);
            mt_loaded_model_note_links(s, c, to->out);
            break;
        }
    } else if (to->args->format == MT_FORMAT_JSON) {
        mt_cli_json_failed(&to->w, j.v.configuration, &err);
    }
    if (j.a == NULL) {
        mt_linear_delete(j.lin);
        mt_system_delete(j.sys);
    }
    mt_analysis_delete(j.a);
    mt_arena_free(&j.mem);
    return rc == MT_OK ? code : mt_exit_worse(code, mt_cli_failed(rc, &err));
}

static int run_sweep(const mt_args *args, mt_text *out)
{
    mt_loaded_model s = {.model = NULL};
    sink to = {.args = args, .out = out, .w = mt_json_writer_default(out)};
    sweep_request request = {.n = 0};
    mt_err err = {.code = MT_OK};
    const bool json = args->format == MT_FORMAT_JSON;
    const bool list = json && !args->given[MT_OPT_CONFIGURATION];
    int code =
        mt_loaded_model_load(args, args->operands[0], args->value[MT_OPT_CONFIGURATION], &s);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    const mt_status rc = read_request(args, &s, &request, &err);
    if (rc != MT_OK) {
        code = mt_cli_failed(rc, &err);
        goto done;
    }
    if (list) {
        mt_json_open(&to.w, NULL, '[');
    }
    for (int i = 0; i < s.n_configurations; i++) {
        code = mt_exit_worse(code,
                             show_configuration_sweep(&to, &s, s.configurations[i], &request));
    }
    if (list) {
        mt_json_close(&to.w);
    }
    if (json) {
        code = mt_exit_worse(code, mt_cli_json_done(&to.w));
    }
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
    .answer = {&swept_record, MT_ANSWER_CONFIGURATIONS},
    .run = run_sweep,
};
