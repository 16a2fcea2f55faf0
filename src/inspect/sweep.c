/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Positions, ratios and frequencies along the range of a driven joint as records. */
#include "inspect/sweep.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
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

mt_status mt_sweep_question_read(mt_loaded_model *s, const char *text, const char *hold,
                                 mt_sweep_question *out, mt_err *err)
{
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
    out->drive.spring = hold;
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

/* The range of the command line lies within reach of the joint. */
static mt_status check_reach(const mt_system *sys, const mt_sweep_question *r, mt_err *err)
{
    const int joint = mt_system_find_joint(sys, r->drive.joint);
    const double reach = mt_drive_reach(sys, joint);
    const mt_dimension of = sys->joints[joint].angle ? MT_ANGLE : MT_LENGTH;
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

mt_status mt_sweep_view_take(const mt_loaded_model *s, int c, const mt_sweep_question *question,
                             mt_sweep_view *v, mt_err *err)
{
    const mt_sweep_visitor visitor = {.visit = store_point_modes, .context = v};
    const mt_sweep_question *const q = question;
    const size_t n = (size_t)s->n_inputs;
    v->configuration = mt_loaded_model_configuration(s, c);
    v->question = q;
    MT_TRY(mt_arena_init(&v->mem, 0, err));
    double *const at = mt_arena_f64(&v->mem, n + 1, 1);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (size_t i = 0; i < n; i++) {
        at[i] = s->at[i];
    }
    at[n] = q->positions[0]; /* the one nearest to the reference: every system is made there */
    for (int i = 1; i < q->n; i++) {
        at[n] = fabs(q->positions[i]) < fabs(at[n]) ? q->positions[i] : at[n];
    }
    mt_system_def def = mt_loaded_model_system(s, c, s->n_inputs, s->inputs, at);
    def.drive = &q->drive;
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
    const mt_sweep_plan plan = {.n = q->n, .positions = q->positions};
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

static const mt_drive_def *drive_def(const mt_sweep_view *v)
{
    const int joint = mt_system_find_joint(v->sys, v->question->drive.joint);
    return &v->sys->drives[mt_system_drive_of(v->sys, joint)];
}

const mt_system_joint *mt_sweep_driven(const mt_sweep_view *v)
{
    return &v->sys->joints[drive_def(v)->joint];
}

bool mt_sweep_holds_moment(const mt_sweep_view *v)
{
    const int spring = drive_def(v)->spring;
    if (spring < 0) {
        return mt_sweep_driven(v)->angle;
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
        "Its motion per motion of the driven joint, in rad or m per rad or m: the exact "
        "slope."),
};
static const mt_record joint_record =
    MT_F_RECORD_OF(joint_fields, "joint", "A joint with a coordinate at a position.");
#undef THIS

#define THIS mt_sweep_point_row
static const mt_field point_fields[] = {
    MT_F_NUMBER("position_rad", position_rad, "Position of the driven joint, an angle.",
                MT_F_WHEN(turns)),
    MT_F_NUMBER("position_m", position_m, "Position of the driven joint, a displacement.",
                MT_F_WHEN(slides)),
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

#define THIS mt_swept_row
static const char *const holds[] = {"lock", "trim"};
static const mt_field swept_fields[] = {
    MT_F_TEXT("configuration", configuration, "Its name."),
    MT_F_TEXT("joint", joint, "The driven joint."),
    MT_F_CHOICE("hold", hold, holds,
                "What holds each position: a lock of the joint, or a spring that is trimmed."),
    MT_F_TEXT_OR_NULL("spring", spring, "The spring that is trimmed; null: a lock holds."),
    MT_F_LIST("points", points, n, mt_sweep_point_row, mt_sweep_point_record,
              "All positions, from first to last."),
};
const mt_record mt_swept_record =
    MT_F_RECORD_OF(swept_fields, "configuration", "A configuration, swept.");
#undef THIS

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
        }
    }
    return out;
}

mt_sweep_point_row mt_sweep_point_row_of(const mt_sweep_view *v, int point)
{
    const mt_sweep_point *const p = &v->sweep.points[point];
    const bool reached = p->status == MT_OK;
    const bool turns = mt_sweep_driven(v)->angle;
    const bool moment = mt_sweep_holds_moment(v);
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
    mt_swept_row row = {.configuration = v->configuration,
                        .joint = mt_sweep_driven(v)->name,
                        .hold = holds[drive_def(v)->spring >= 0 ? 1 : 0],
                        .spring = v->question->drive.spring,
                        .n = v->sweep.n_points};
    row.points = mt_arena_alloc(&v->mem, (size_t)row.n, sizeof *row.points);
    MT_TRY(mt_arena_check(&v->mem, err));
    for (int i = 0; i < row.n; i++) {
        const mt_sweep_point *const p = &v->sweep.points[i];
        row.points[i] = mt_sweep_point_row_of(v, i);
        if (p->status == MT_OK) {
            row.points[i].joints = joint_rows_of(v, p, &v->mem, &row.points[i].n_joints);
            row.points[i].dead_centre = mt_dead_centre_row_of(p->near, &v->mem);
        }
    }
    MT_TRY(mt_arena_check(&v->mem, err));
    mt_record_put_object(w, NULL, &mt_swept_record, &row, 0, NULL);
    return MT_OK;
}
