/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions, ratios and frequencies along the range of a driven joint as records. */
#include "inspect/sweep.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "linalg/dense.h"
#include "mechanics/position.h"
#include "model/model.h"
#include "result/write.h"

enum { MOST_POINTS = 100001 };

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

/* The range of one joint. */
typedef struct span {
    double range[2];
    int n;
} span;

static mt_status read_drive(mt_loaded_model *s, const char *text, mt_system_drive *drive,
                            span *out, mt_err *err)
{
    const char *const equals = strchr(text, '=');
    const char *const first = equals == NULL ? NULL : strchr(equals, ':');
    const char *const second = first == NULL ? NULL : strchr(first + 1, ':');
    if (second == NULL || equals == text || strchr(second + 1, ':') != NULL) {
        return mt_fail(err, MT_E_USAGE, "--drive: \"%s\" is not JOINT=FROM:TO:N", text);
    }
    *drive =
        (mt_system_drive){.joint = mt_arena_strndup(&s->mem, text, (size_t)(equals - text))};
    MT_TRY(mt_arena_check(&s->mem, err));
    const mt_unit *const unit = mt_loaded_model_joint_unit(s->model, drive->joint);
    MT_TRY(mt_loaded_model_number(s, "drive", unit, equals + 1, (size_t)(first - equals - 1),
                                  &out->range[0], err));
    MT_TRY(mt_loaded_model_number(s, "drive", unit, first + 1, (size_t)(second - first - 1),
                                  &out->range[1], err));
    return read_points(second + 1, out->range, &out->n, err);
}

/* "SPRING" of the only joint, or "JOINT=SPRING". */
static mt_status read_hold(mt_loaded_model *s, const char *text, mt_sweep_question *out,
                           mt_err *err)
{
    const char *const equals = strchr(text, '=');
    if (equals == NULL && out->n_drives > 1) {
        return mt_fail(err, MT_E_USAGE,
                       "--hold: \"%s\" does not say which joint it holds: JOINT=SPRING", text);
    }
    int found = equals == NULL ? 0 : -1;
    for (int i = 0; i < out->n_drives && equals != NULL; i++) {
        const char *const joint = out->drives[i].joint;
        const size_t length = (size_t)(equals - text);
        found = strlen(joint) == length && strncmp(joint, text, length) == 0 ? i : found;
    }
    if (found < 0) {
        return mt_fail(err, MT_E_USAGE, "--hold: the joint of \"%s\" is not driven", text);
    }
    const char *const spring = equals == NULL ? text : equals + 1;
    out->drives[found].spring = mt_arena_strdup(&s->mem, spring);
    return mt_arena_check(&s->mem, err);
}

/* Positions of all joints: together, or each with each, the last one fastest. */
static mt_status lay_positions(mt_loaded_model *s, const span *spans, bool grid,
                               mt_sweep_question *out, mt_err *err)
{
    const ptrdiff_t drives = out->n_drives;
    long n = 1;
    for (ptrdiff_t i = 0; i < drives; i++) {
        if (!grid && spans[i].n != spans[0].n) {
            return mt_fail(
                err, MT_E_USAGE,
                "--drive: joints that go their ways together have as many positions: "
                "%s has %d, %s %d (--grid: each with each)",
                out->drives[0].joint, spans[0].n, out->drives[i].joint, spans[i].n);
        }
        n = grid ? n * spans[i].n : spans[i].n;
        if (n > MOST_POINTS) {
            return mt_fail(err, MT_E_USAGE, "--drive: more than %d positions",
                           (int)MOST_POINTS);
        }
    }
    out->n = (int)n;
    out->line = grid && drives > 1 ? spans[drives - 1].n : 0;
    out->positions = mt_arena_f64(&s->mem, (size_t)drives, (size_t)n);
    MT_TRY(mt_arena_check(&s->mem, err));
    int repeat = 1; /* points in a row at which a joint stays */
    for (ptrdiff_t i = drives - 1; i >= 0; i--) {
        double *const own = mt_arena_f64(&s->mem, (size_t)spans[i].n, 1);
        MT_TRY(mt_arena_check(&s->mem, err));
        mt_sweep_range(spans[i].range[0], spans[i].range[1], spans[i].n, own);
        for (int k = 0; k < out->n; k++) {
            out->positions[i + (k * drives)] = own[k / repeat % spans[i].n];
        }
        repeat *= grid ? spans[i].n : 1;
    }
    return MT_OK;
}

mt_status mt_sweep_question_read(mt_loaded_model *s, const mt_sweep_texts *texts,
                                 mt_sweep_question *out, mt_err *err)
{
    span spans[MT_DRIVES_MOST];
    if (texts->n_drives == 0) {
        return mt_fail(err, MT_E_USAGE, "\"sweep\" needs --drive JOINT=FROM:TO:N");
    }
    if (texts->n_drives > MT_DRIVES_MOST) {
        return mt_fail(err, MT_E_USAGE, "--drive: at most %d joints", (int)MT_DRIVES_MOST);
    }
    out->n_drives = texts->n_drives;
    for (int i = 0; i < texts->n_drives; i++) {
        MT_TRY(read_drive(s, texts->drives[i], &out->drives[i], &spans[i], err));
    }
    for (int i = 0; i < texts->n_holds; i++) {
        MT_TRY(read_hold(s, texts->holds[i], out, err));
    }
    return lay_positions(s, spans, texts->grid, out, err);
}

/* Modes at one point. */
static mt_status store_point_modes(void *context, int point, const double *inputs, mt_err *err)
{
    mt_sweep_view *const v = context;
    mt_analysis_options opt = mt_analysis_options_default();
    opt.gradient = true; /* of the position */
    opt.check = false;
    opt.bounds = false;
    MT_TRY(mt_analysis_solve(v->a, inputs, &opt, err));
    const mt_modes *const m = &v->a->modes;
    for (int i = 0; i < v->modes; i++) {
        const int at = mt_modal_flexible(m, i + 1);
        v->hz[i + ((ptrdiff_t)point * v->modes)] = at < 0 ? nan("") : mt_modal_hz(m, at);
    }
    v->rigid[point] = m->n_rigid;
    v->unstable[point] = m->n_unstable;
    v->undecided[point] = m->n_undecided;
    return MT_OK;
}

static mt_status prepare_modes(mt_sweep_view *v, int wanted, mt_err *err)
{
    const size_t n = (size_t)v->question->n;
    const mt_modes *const m = &v->a->modes;
    const int flexible = mt_modal_vibrations(m);
    v->modes = flexible < wanted ? flexible : wanted;
    v->hz = mt_arena_f64(&v->mem, (size_t)v->modes, n);
    v->rigid = mt_arena_int(&v->mem, n);
    v->unstable = mt_arena_int(&v->mem, n);
    v->undecided = mt_arena_int(&v->mem, n);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (size_t i = 0; i < n * (size_t)v->modes; i++) {
        v->hz[i] = nan("");
    }
    return MT_OK;
}

/* The ranges of the command line lie within reach of the joints. */
static mt_status check_reach(const mt_system *sys, const mt_sweep_question *r, mt_err *err)
{
    for (int k = 0; k < r->n * r->n_drives; k++) {
        const int d = k % r->n_drives;
        const int joint = mt_system_find_joint(sys, r->drives[d].joint);
        const double reach = mt_drive_reach(sys, joint);
        const mt_dimension of = sys->joints[joint].angle ? MT_ANGLE : MT_LENGTH;
        const mt_unit *const shown = mt_model_shown(sys->model, of);
        const char *const unit = mt_unit_name(shown, mt_dimension_si(of));
        if (!(fabs(r->positions[k]) <= reach)) {
            return mt_fail(err, MT_E_USAGE,
                           "--drive: %s goes to %g %s, and at most to %g %s from the reference "
                           "position",
                           r->drives[d].joint, mt_unit_from_si(shown, r->positions[k]), unit,
                           mt_unit_from_si(shown, reach), unit);
        }
    }
    return MT_OK;
}

mt_status mt_sweep_view_take(const mt_loaded_model *s, int c, const mt_sweep_question *question,
                             mt_sweep_view *v, mt_err *err)
{
    const mt_sweep_visitor visitor = {.visit = store_point_modes, .context = v};
    const mt_sweep_question *const q = question;
    const size_t n = (size_t)s->n_inputs;
    v->configuration = mt_loaded_model_configuration(s, c);
    v->question = q;
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    double *const at = mt_arena_f64(&v->mem, n + (size_t)q->n_drives, 1);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (size_t i = 0; i < n; i++) {
        at[i] = s->at[i];
    }
    int nearest = 0; /* to the reference: every system is made there */
    for (int i = 1; i < q->n; i++) {
        const double far = mt_max_abs(q->n_drives, q->positions + ((ptrdiff_t)i * q->n_drives));
        const double *const least = q->positions + ((ptrdiff_t)nearest * q->n_drives);
        nearest = far < mt_max_abs(q->n_drives, least) ? i : nearest;
    }
    memcpy(at + n, q->positions + ((ptrdiff_t)nearest * q->n_drives),
           (size_t)q->n_drives * sizeof *at);
    mt_system_def def = mt_loaded_model_system(s, c, s->n_inputs, s->inputs, at);
    def.drive = q->drives;
    def.n_drives = q->n_drives;
    MT_TRY(mt_system_new_of(&def, &v->own_sys, err));
    v->sys = v->own_sys;
    MT_TRY(check_reach(v->sys, q, err));
    if (q->modes > 0) {
        mt_system_delete(v->own_sys);
        v->own_sys = NULL;
        MT_TRY(mt_analysis_new_of(&def, 0, &v->a, err));
        v->a->recount = true; /* a spring may get hold of a direction on the way */
        MT_TRY(prepare_modes(v, q->modes, err));
        v->sys = v->a->own_sys;
        v->lin = v->a->lin;
    } else {
        MT_TRY(mt_linear_new(v->own_sys, &v->lin, err));
    }
    const mt_sweep_plan plan = {
        .n = q->n, .n_drives = q->n_drives, .line = q->line, .positions = q->positions};
    const mt_status rc = mt_sweep_run(v->lin, at, &plan, q->modes > 0 ? &visitor : NULL,
                                      &v->mem, &v->sweep, err);
    return mt_err_in(err, rc, "configuration \"%s\"", v->configuration);
}

void mt_sweep_view_free(mt_sweep_view *v)
{
    if (v->a == NULL) {
        mt_linear_delete(v->lin);
        mt_system_delete(v->own_sys);
    }
    mt_analysis_delete(v->a);
    mt_arena_free(&v->mem);
    memset(v, 0, sizeof *v);
}

/* Records. */

static const mt_drive_def *drive_def(const mt_sweep_view *v, int drive)
{
    const int joint = mt_system_find_joint(v->sys, v->question->drives[drive].joint);
    return &v->sys->drives[mt_system_drive_of(v->sys, joint)];
}

const mt_system_joint *mt_sweep_driven(const mt_sweep_view *v, int drive)
{
    return &v->sys->joints[drive_def(v, drive)->joint];
}

bool mt_sweep_holds_moment(const mt_sweep_view *v, int drive)
{
    const int spring = drive_def(v, drive)->spring;
    if (spring < 0) {
        return mt_sweep_driven(v, drive)->angle;
    }
    const mt_spring_def *const s = &v->sys->springs[spring];
    const mt_measure_kind kind = v->sys->measures[s->measure[0]].kind;
    return kind == MT_MEASURE_ANGLE || kind == MT_MEASURE_ROTATION;
}

#define THIS mt_swept_joint_row
static const mt_field joint_fields[] = {
    MT_F_TEXT("name", name, "The joint."),
    MT_F_NUMBER("coordinate_rad", coordinate,
                "Its coordinate from the reference position, whole turns counted.",
                MT_F_WHEN(turns)),
    MT_F_NUMBER("coordinate_m", coordinate, "Its coordinate from the reference position.",
                MT_F_WHEN(slides)),
    MT_F_NUMBER(
        "ratio", ratio,
        "Its motion per motion of the driven joint, the first of several, in rad or m per rad "
        "or m: the exact slope."),
    MT_F_NUMBERS(
        "ratios", ratios, n_ratios,
        "With several --drive: the same per motion of each, the others held, in rad or "
        "m per rad or m.",
        MT_F_WHEN(several)),
};
static const mt_record joint_record =
    MT_F_RECORD_OF(joint_fields, "joint", "A joint with a coordinate at a position.");
#undef THIS

#define THIS mt_swept_drive_row
static const mt_field drive_fields[] = {
    MT_F_NUMBER("position_rad", position, "Its position, an angle.", MT_F_WHEN(turns)),
    MT_F_NUMBER("position_m", position, "Its position, a displacement.", MT_F_WHEN(slides)),
    MT_F_NUMBER("hold_n_m", hold, "What holds it: a moment.", MT_F_WHEN(holds_moment)),
    MT_F_NUMBER("hold_n", hold, "What holds it: a force.", MT_F_WHEN(holds_force)),
};
static const mt_record drive_record =
    MT_F_RECORD_OF(drive_fields, "driven", "One of several driven joints.");
#undef THIS

#define THIS mt_sweep_point_row
static const mt_field point_fields[] = {
    MT_F_NUMBER("position_rad", position_rad,
                "Position of the driven joint, the first of several, an angle.",
                MT_F_WHEN(turns)),
    MT_F_NUMBER("position_m", position_m,
                "Position of the driven joint, the first of several, a displacement.",
                MT_F_WHEN(slides)),
    MT_F_LIST("drives", drives, n_drives, mt_swept_drive_row, drive_record,
              "With several --drive: the driven joints, one each.", .flat = true,
              MT_F_WHEN(several)),
    MT_F_TEXT("error", error, "Why it is not reached; then nothing else is known.",
              MT_F_WHEN(failed)),
    MT_F_LIST("joints", joints, n_joints, mt_swept_joint_row, joint_record,
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
const mt_record mt_sweep_point_record =
    MT_F_RECORD_OF(point_fields, "point", "A position of the driven joint.");
#undef THIS

static const char *const holds[] = {"lock", "trim"};
#define THIS mt_swept_hold_row
static const mt_field hold_fields[] = {
    MT_F_TEXT("joint", joint, "The driven joint."),
    MT_F_CHOICE("hold", hold, holds,
                "What holds each position: a lock of the joint, or a spring that is trimmed."),
    MT_F_TEXT_OR_NULL("spring", spring, "The spring that is trimmed; null: a lock holds."),
};
static const mt_record hold_record =
    MT_F_RECORD_OF(hold_fields, "drive", "One of several driven joints and what holds it.");
#undef THIS

#define THIS mt_swept_row
static const mt_field swept_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_TEXT("joint", joint, "The driven joint, the first of several."),
    MT_F_CHOICE("hold", hold, holds,
                "What holds each position: a lock of the joint, or a spring that is trimmed."),
    MT_F_TEXT_OR_NULL("spring", spring, "The spring that is trimmed; null: a lock holds."),
    MT_F_LIST("drives", drives, n_drives, mt_swept_hold_row, hold_record,
              "With several --drive: all driven joints, one each.", .flat = true,
              MT_F_WHEN(several)),
    MT_F_LIST("points", points, n, mt_sweep_point_row, mt_sweep_point_record,
              "All positions, from first to last."),
};
const mt_record mt_swept_record =
    MT_F_RECORD_OF(swept_fields, "configuration", "A configuration, swept.");
#undef THIS

static void take_ratios(const mt_sweep_view *v, const mt_sweep_point *p, int joint,
                        mt_arena *mem, mt_swept_joint_row *row)
{
    const int drives = v->sweep.n_drives;
    row->several = drives > 1;
    row->ratios = mt_arena_f64(mem, (size_t)drives, 1);
    for (; row->ratios != NULL && row->n_ratios < drives; row->n_ratios++) {
        const ptrdiff_t at = joint + ((ptrdiff_t)row->n_ratios * v->sys->n_joints);
        row->ratios[row->n_ratios] = p->ratio[at];
    }
}

static mt_swept_drive_row *drive_rows_of(const mt_sweep_view *v, const mt_sweep_point *p,
                                         mt_arena *mem, int *n)
{
    mt_swept_drive_row *const out = mt_arena_alloc(mem, (size_t)v->sweep.n_drives, sizeof *out);
    const bool reached = p->status == MT_OK;
    for (int i = 0; out != NULL && i < v->sweep.n_drives; i++) {
        const bool turns = mt_sweep_driven(v, i)->angle;
        const bool moment = mt_sweep_holds_moment(v, i);
        out[(*n)++] = (mt_swept_drive_row){.turns = turns,
                                           .slides = !turns,
                                           .position = p->drive[i],
                                           .holds_moment = reached && moment,
                                           .holds_force = reached && !moment,
                                           .hold = p->hold[i]};
    }
    return out;
}

static mt_swept_joint_row *joint_rows_of(const mt_sweep_view *v, const mt_sweep_point *p,
                                         mt_arena *mem, int *n)
{
    mt_swept_joint_row *const out = mt_arena_alloc(mem, (size_t)v->sys->n_joints, sizeof *out);
    for (int i = 0; out != NULL && i < v->sys->n_joints; i++) {
        const mt_system_joint *const joint = &v->sys->joints[i];
        if (joint->coordinate >= 0) {
            out[(*n)++] = (mt_swept_joint_row){.name = joint->name,
                                               .turns = joint->angle,
                                               .slides = !joint->angle,
                                               .coordinate = p->coordinate[i],
                                               .ratio = p->ratio[i]};
            take_ratios(v, p, i, mem, &out[*n - 1]);
        }
    }
    return out;
}

mt_sweep_point_row mt_sweep_point_row_of(const mt_sweep_view *v, int point)
{
    const mt_sweep_point *const p = &v->sweep.points[point];
    const bool reached = p->status == MT_OK;
    const bool turns = mt_sweep_driven(v, 0)->angle;
    const bool moment = mt_sweep_holds_moment(v, 0);
    mt_sweep_point_row row = {.turns = turns,
                              .slides = !turns,
                              .position_rad = p->drive[0],
                              .position_m = p->drive[0],
                              .error = p->why,
                              .failed = !reached,
                              .reached = reached,
                              .holds_moment = reached && moment,
                              .holds_force = reached && !moment,
                              .hold_n_m = p->hold[0],
                              .hold_n = p->hold[0],
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

mt_status mt_sweep_put(mt_sweep_view *v, mt_json_writer *w, mt_err *err)
{
    const mt_sweep_question *const q = v->question;
    mt_swept_row row = {.configuration = v->configuration,
                        .joint = mt_sweep_driven(v, 0)->name,
                        .hold = holds[q->drives[0].spring != NULL ? 1 : 0],
                        .spring = q->drives[0].spring,
                        .several = q->n_drives > 1,
                        .n_drives = q->n_drives,
                        .n = v->sweep.n_points};
    row.points = mt_arena_alloc(&v->mem, (size_t)row.n, sizeof *row.points);
    row.drives = mt_arena_alloc(&v->mem, (size_t)row.n_drives, sizeof *row.drives);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < q->n_drives; i++) {
        row.drives[i] = (mt_swept_hold_row){.joint = q->drives[i].joint,
                                            .hold = holds[q->drives[i].spring != NULL ? 1 : 0],
                                            .spring = q->drives[i].spring};
    }
    for (int i = 0; i < row.n; i++) {
        const mt_sweep_point *const p = &v->sweep.points[i];
        mt_sweep_point_row *const out = &row.points[i];
        *out = mt_sweep_point_row_of(v, i);
        out->several = row.several;
        if (row.several) {
            out->drives = drive_rows_of(v, p, &v->mem, &out->n_drives);
        }
        if (p->status == MT_OK) {
            out->joints = joint_rows_of(v, p, &v->mem, &out->n_joints);
            out->dead_centre = mt_dead_centre_row_of(p->near, &v->mem);
        }
    }
    MT_TRY(mt_arena_check(&v->mem, err));
    mt_record_put_object(w, NULL, &mt_swept_record, &row, 0, NULL);
    return MT_OK;
}
