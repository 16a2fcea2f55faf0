/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sweep as text, JSON and CSV. */
#include <math.h>
#include <string.h>

#include "base/format.h"
#include "cli/sweep.h"

enum { DIGITS = 6, HOLD_DIGITS = 4, HEADING = 300 };

/* Positions, ratios and forces are rounding below this [rad, m, 1, N, N m]: for people that is
 * 0. */
static const double ROUNDING = 1e-12;

static double tidy(double x)
{
    return fabs(x) < ROUNDING ? 0.0 : x;
}

static const mt_system_joint *driven(const mt_sweep_view *v)
{
    return &v->sys->joints[v->sys->drive_joint];
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

/* A joint's motion per that of the driven one, in these units. */
static double shown_ratio(const mt_sweep_view *v, bool angle, double ratio)
{
    return shown_drive_position(
        v, angle, mt_unit_to_si(shown_drive_unit(v, driven(v)->angle), tidy(ratio)));
}

/* True where the holding force acts along an angle. */
static bool hold_is_moment(const mt_sweep_view *v)
{
    if (!v->sys->trim) {
        return driven(v)->angle;
    }
    const mt_spring_def *const s = &v->sys->springs[v->sys->trim_spring];
    const mt_measure_kind kind = v->sys->measures[s->measure[0]].kind;
    return kind == MT_MEASURE_ANGLE || kind == MT_MEASURE_ROTATION;
}

/* Joints with a coordinate, other than the driven one. */
static bool told(const mt_sweep_view *v, int joint)
{
    return v->sys->joints[joint].coordinate >= 0 && joint != v->sys->drive_joint;
}

static void text_columns(const mt_sweep_view *v, mt_table *t)
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

static void text_row(const mt_sweep_view *v, int point, mt_table *t)
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
        mt_text_addf(out,
                     "  Near a dead centre at %.6g %s: about %.2g rad (or model lengths) on, "
                     "joints %s depend on each other.\n",
                     mt_unit_from_si(shown_drive_unit(v, driven(v)->angle), nearest->drive),
                     shown_name(v, driven(v)->angle), nearest->near->distance,
                     nearest->near->joints.text);
    }
}

void mt_sweep_print(const mt_sweep_view *v, mt_text *out)
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

static void json_point(const mt_sweep_view *v, int point, mt_json_writer *w)
{
    const mt_sweep_point *const p = &v->sweep.points[point];
    mt_json_open(w, NULL, '{');
    mt_json_put_number(w, driven(v)->angle ? "position_rad" : "position_m", p->drive);
    if (p->status != MT_OK) {
        mt_json_put_string(w, "error", p->why);
        mt_json_close(w);
        return;
    }
    mt_json_open(w, "joints", '[');
    for (int i = 0; i < v->sys->n_joints; i++) {
        const mt_system_joint *const joint = &v->sys->joints[i];
        if (joint->coordinate < 0) {
            continue;
        }
        mt_json_open_flat(w, NULL, '{');
        mt_json_put_string(w, "name", joint->name);
        mt_json_put_number(w, joint->angle ? "coordinate_rad" : "coordinate_m",
                           p->coordinate[i]);
        mt_json_put_number(w, "ratio", p->ratio[i]);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_put_number(w, hold_is_moment(v) ? "hold_n_m" : "hold_n", p->hold);
    mt_json_put_number(w, "equilibrium_residual", p->residual);
    mt_json_put_number(w, "gap_m", p->gap_m);
    mt_cli_json_dead_centre(w, p->near);
    if (v->rigid != NULL) {
        mt_json_open_flat(w, "frequencies_hz", '[');
        for (int i = 0; i < v->modes; i++) {
            mt_json_put_number(w, NULL, v->hz[i + ((ptrdiff_t)point * v->modes)]);
        }
        mt_json_close(w);
        mt_json_put_integer(w, "rigid_body_modes", v->rigid[point]);
        mt_json_put_integer(w, "unstable_modes", v->unstable[point]);
        mt_json_put_integer(w, "undecided_modes", v->undecided[point]);
    }
    mt_json_close(w);
}

void mt_sweep_json(const mt_sweep_view *v, mt_json_writer *w)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "configuration", v->configuration);
    mt_json_put_string(w, "joint", driven(v)->name);
    mt_json_put_string(w, "hold", v->sys->trim ? "trim" : "lock");
    mt_json_put_string(w, "spring", v->sys->trim ? v->request->drive.spring : NULL);
    mt_json_open(w, "points", '[');
    for (int i = 0; i < v->sweep.n_points; i++) {
        json_point(v, i, w);
    }
    mt_json_close(w);
    mt_json_close(w);
}

void mt_sweep_csv_columns(const mt_sweep_view *v, mt_table *t)
{
    char s[HEADING];
    mt_table_column(t, "configuration", "configuration", MT_ALIGN_LEFT);
    (void)mt_snprintf(s, sizeof s, "position_%s", drive_si_unit(driven(v)->angle));
    mt_table_column(t, s, s, MT_ALIGN_POINT);
    for (int i = 0; i < v->sys->n_joints; i++) {
        if (told(v, i)) {
            const mt_system_joint *const joint = &v->sys->joints[i];
            (void)mt_snprintf(s, sizeof s, "%s_%s", joint->name, drive_si_unit(joint->angle));
            mt_table_column(t, s, s, MT_ALIGN_POINT);
            (void)mt_snprintf(s, sizeof s, "%s_ratio", joint->name);
            mt_table_column(t, s, s, MT_ALIGN_POINT);
        }
    }
    (void)mt_snprintf(s, sizeof s, "%s", hold_is_moment(v) ? "hold_n_m" : "hold_n");
    mt_table_column(t, s, s, MT_ALIGN_POINT);
    mt_table_column(t, "residual", "equilibrium_residual", MT_ALIGN_POINT);
    mt_table_column(t, "gap", "gap_m", MT_ALIGN_POINT);
    for (int i = 0; i < v->modes; i++) {
        (void)mt_snprintf(s, sizeof s, "mode_%d_hz", i + 1);
        mt_table_column(t, s, s, MT_ALIGN_POINT);
    }
}

void mt_sweep_csv_rows(const mt_sweep_view *v, mt_table *t)
{
    for (int k = 0; k < v->sweep.n_points; k++) {
        const mt_sweep_point *const p = &v->sweep.points[k];
        mt_table_text(t, v->configuration);
        mt_table_number(t, p->drive, DIGITS);
        for (int i = 0; i < v->sys->n_joints; i++) {
            if (told(v, i)) {
                mt_table_number(t, p->coordinate[i], DIGITS);
                mt_table_number(t, p->ratio[i], DIGITS);
            }
        }
        mt_table_number(t, p->hold, DIGITS);
        mt_table_number(t, p->residual, DIGITS);
        mt_table_number(t, p->gap_m, DIGITS);
        for (int i = 0; i < v->modes; i++) {
            mt_table_number(t, v->hz[i + ((ptrdiff_t)k * v->modes)], DIGITS);
        }
    }
}
