/* SPDX-License-Identifier: GPL-3.0-or-later */
/* modetune show: a mechanism as a page that moves, as JSON, or as a still picture. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "cli/cli.h"
#include "io/file.h"
#include "library/scene_designs.h"
#include "report/page.h"
#include "report/table.h"
#include "scene/scene.h"
#include "scene/write.h"

/*
 * Isometric: the eye looks along (-1, -1, -1), every axis is as long as the others. With e3 up
 * and e1, e2 across, to the right r = (e2 - e1)/sqrt 2, up u = (2 e3 - e1 - e2)/sqrt 6. The
 * outline of an ellipsoid with semi-axes a_i is the ellipse of the 2 x 2 matrix
 * S = sum_i (P a_i)(P a_i)^T, P the projection: its semi-axes are the roots of S.
 */

/* Layout in pixels. */
enum {
    WIDTH = 900,
    HEIGHT = 640,
    MARGIN = 70,
    TITLE = 24,
    SYMBOL = 5,
    TEETH = 8,
    LINE = 12, /* of text */
    NAMES_MOST = 200
};
/* Of a letter, on average; a little generous. */
static const double LETTER = 6.5;
/* Of the picture's size: how far a mode moves what moves most. */
static const double AMPLITUDE = 0.08;
static const double TURN = 6.283185307179586;
static const char *const REST = "#1a1a1a";
static const char *const SOFT = "#9a9a9a";
static const char *const SPRING = "#00735a";
static const char *const MOVED = "#d55e00";

typedef struct svg {
    const mt_scene *scene;
    const mt_scene_view *view;
    const double *motion; /* 6 x bodies; NULL: at rest */
    double reach;         /* m: displacement of what moves most */
    double right[3];
    double up[3];
    double low[2]; /* of what is drawn, before it is scaled [m] */
    double high[2];
    double scale; /* px/m */
    int n_names;  /* that are placed */
    double name_at[NAMES_MOST][2];
    double name_width[NAMES_MOST];
    mt_text *out;
} svg;

/* Choose the view: up is opposite to the greatest component of gravity, else z (in a plane
 * y). */
static void look_from(svg *p)
{
    const mt_scene *const s = p->scene;
    int axis = s->dimension == 2 ? 1 : 2;
    double sign = 1.0;
    if (s->dimension == 2) {
        p->right[0] = 1.0;
        p->up[1] = 1.0;
        return;
    }
    for (int k = 0; k < 3 && s->has_gravity; k++) {
        axis = fabs(s->gravity[k]) > fabs(s->gravity[axis]) ? k : axis;
    }
    if (s->has_gravity && s->gravity[axis] > 0.0) {
        sign = -1.0;
    }
    const int first = (axis + (sign > 0.0 ? 1 : 2)) % 3;
    const int second = (axis + (sign > 0.0 ? 2 : 1)) % 3;
    p->right[first] = -sqrt(0.5);
    p->right[second] = sqrt(0.5);
    p->up[axis] = sign * 2.0 / sqrt(6.0);
    p->up[first] = -1.0 / sqrt(6.0);
    p->up[second] = -1.0 / sqrt(6.0);
}

static double dot(const double a[3], const double b[3])
{
    return (a[0] * b[0]) + (a[1] * b[1]) + (a[2] * b[2]);
}

/* Where a point of a body is, moved by the mode. */
static void move_body_point(const svg *p, int body, const double x[3], double out[3])
{
    memcpy(out, x, 3 * sizeof *out);
    if (p->motion == NULL) {
        return;
    }
    const double *const m = p->motion + ((ptrdiff_t)6 * body);
    const double *const c = p->view->bodies[body].at;
    const double d[3] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
    out[0] += p->reach * (m[0] + (m[4] * d[2]) - (m[5] * d[1]));
    out[1] += p->reach * (m[1] + (m[5] * d[0]) - (m[3] * d[2]));
    out[2] += p->reach * (m[2] + (m[3] * d[1]) - (m[4] * d[0]));
}

/* Pixels of a point of a body. */
static void project_body_point(const svg *p, int body, const double x[3], double out[2])
{
    double at[3];
    move_body_point(p, body, x, at);
    out[0] =
        (0.5 * WIDTH) + (p->scale * (dot(at, p->right) - (0.5 * (p->low[0] + p->high[0]))));
    out[1] = (0.5 * (HEIGHT + TITLE)) -
             (p->scale * (dot(at, p->up) - (0.5 * (p->low[1] + p->high[1]))));
}

static void include_in_picture_box(svg *p, int body, const double x[3])
{
    double at[3];
    move_body_point(p, body, x, at);
    const double place[2] = {dot(at, p->right), dot(at, p->up)};
    for (int k = 0; k < 2; k++) {
        p->low[k] = fmin(p->low[k], place[k]);
        p->high[k] = fmax(p->high[k], place[k]);
    }
}

static void include_springs(svg *p, int n, const mt_scene_spring *springs)
{
    for (int i = 0; i < n; i++) {
        include_in_picture_box(p, springs[i].body[0], springs[i].end[0]);
        include_in_picture_box(p, springs[i].body[1], springs[i].end[1]);
    }
}

static void include_all(svg *p)
{
    const mt_scene_view *const v = p->view;
    for (int i = 1; i < v->n_bodies; i++) {
        const mt_scene_body *const b = &v->bodies[i];
        include_in_picture_box(p, i, b->at);
        for (int k = 0; k < 6 && b->ellipsoid != NULL; k++) {
            const double r = b->ellipsoid->radii[k / 2] * (k % 2 == 0 ? 1.0 : -1.0);
            const double *const a = b->ellipsoid->axes[k / 2];
            const double end[3] = {b->at[0] + (r * a[0]), b->at[1] + (r * a[1]),
                                   b->at[2] + (r * a[2])};
            include_in_picture_box(p, i, end);
        }
    }
    for (int i = 0; i < v->n_lines; i++) {
        include_in_picture_box(p, v->lines[i].body, v->lines[i].from);
        include_in_picture_box(p, v->lines[i].body, v->lines[i].to);
    }
    for (int i = 0; i < v->n_joints; i++) {
        include_in_picture_box(p, v->joints[i].body[1], v->joints[i].at);
        if (v->joints[i].rod) {
            include_in_picture_box(p, v->joints[i].body[0], v->joints[i].end[0]);
        }
    }
    include_springs(p, v->n_springs, v->springs);
    include_springs(p, v->n_dampers, v->dampers);
}

static void fit(svg *p)
{
    for (int k = 0; k < 2; k++) {
        if (!(p->low[k] <= p->high[k])) {
            p->low[k] = 0.0;
            p->high[k] = 0.0;
        }
    }
    const double wide = p->high[0] - p->low[0];
    const double tall = p->high[1] - p->low[1];
    const double x = wide > 0.0 ? (WIDTH - (2 * MARGIN)) / wide : HUGE_VAL;
    const double y = tall > 0.0 ? (HEIGHT - TITLE - (2 * MARGIN)) / tall : HUGE_VAL;
    const double scale = fmin(x, y);
    p->scale = isfinite(scale) ? scale : 1.0;
}

static void put_line(const svg *p, const double a[2], const double b[2], const char *colour,
                     double width)
{
    mt_text_addf(p->out,
                 "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"%s\" "
                 "stroke-width=\"%.1f\" stroke-linecap=\"round\"/>\n",
                 a[0], a[1], b[0], b[1], colour, width);
}

/* True where a name there would overlap another one. */
static bool is_taken(const svg *p, double x, double y, double width)
{
    bool taken = false;
    for (int i = 0; i < p->n_names && !taken; i++) {
        taken = fabs(y - p->name_at[i][1]) < LINE && x < p->name_at[i][0] + p->name_width[i] &&
                p->name_at[i][0] < x + width;
    }
    return taken;
}

/* A name at a place, or below it where others stand already. */
static void put_name(svg *p, const double at[2], const char *name, const char *colour)
{
    if (name == NULL || p->n_names == NAMES_MOST) {
        return;
    }
    const double width = LETTER * mt_text_width(name);
    double y = at[1];
    while (is_taken(p, at[0], y, width)) { /* ends: below all of them is room */
        y += LINE;
    }
    p->name_at[p->n_names][0] = at[0];
    p->name_at[p->n_names][1] = y;
    p->name_width[p->n_names++] = width;
    mt_text_addf(p->out, "<text x=\"%.1f\" y=\"%.1f\" fill=\"%s\">", at[0], y, colour);
    mt_html_escape(name, p->out);
    mt_text_add(p->out, "</text>\n");
}

static void put_ellipsoid(const svg *p, int body, const char *colour)
{
    const mt_scene_body *const b = &p->view->bodies[body];
    double at[2];
    double s[3] = {0.0, 0.0, 0.0}; /* xx, xy, yy, y downwards */
    project_body_point(p, body, b->at, at);
    for (int i = 0; i < 3; i++) {
        const double r = p->scale * b->ellipsoid->radii[i];
        const double x = r * dot(b->ellipsoid->axes[i], p->right);
        const double y = -r * dot(b->ellipsoid->axes[i], p->up);
        s[0] += x * x;
        s[1] += x * y;
        s[2] += y * y;
    }
    const double mean = 0.5 * (s[0] + s[2]);
    const double half = hypot(0.5 * (s[0] - s[2]), s[1]);
    const double angle = 0.5 * atan2(s[1], 0.5 * (s[0] - s[2])) * 360.0 / TURN;
    mt_text_addf(p->out,
                 "<ellipse rx=\"%.1f\" ry=\"%.1f\" transform=\"translate(%.1f %.1f) "
                 "rotate(%.1f)\" fill=\"%s\" fill-opacity=\"0.08\" stroke=\"%s\" "
                 "stroke-opacity=\"0.6\"/>\n",
                 sqrt(mean + half), sqrt(fmax(mean - half, 0.0)), at[0], at[1], angle, colour,
                 colour);
}

/* Bodies and links, at rest or moved. */
static void put_bodies(const svg *p, const char *colour, double width)
{
    const mt_scene_view *const v = p->view;
    for (int i = 1; i < v->n_bodies; i++) {
        if (v->bodies[i].ellipsoid != NULL) {
            put_ellipsoid(p, i, colour);
        }
    }
    for (int i = 0; i < v->n_lines; i++) {
        double a[2];
        double b[2];
        project_body_point(p, v->lines[i].body, v->lines[i].from, a);
        project_body_point(p, v->lines[i].body, v->lines[i].to, b);
        put_line(p, a, b, colour, width);
    }
}

static void put_path(const svg *p, int n, const double (*at)[2], const char *colour)
{
    mt_text_add(p->out, "<polyline points=\"");
    for (int i = 0; i < n; i++) {
        mt_text_addf(p->out, "%s%.1f,%.1f", i == 0 ? "" : " ", at[i][0], at[i][1]);
    }
    mt_text_addf(p->out, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.6\"/>\n", colour);
}

static void put_zigzag(const svg *p, const double a[2], const double b[2], const char *colour)
{
    double at[TEETH + 2][2];
    const double length = hypot(b[0] - a[0], b[1] - a[1]);
    const double x = length > 0.0 ? (b[0] - a[0]) / length : 1.0;
    const double y = length > 0.0 ? (b[1] - a[1]) / length : 0.0;
    memcpy(at[0], a, sizeof at[0]);
    for (int i = 0; i < TEETH; i++) {
        const double along = length * (0.2 + (0.6 * (i + 0.5) / TEETH));
        const double beside = SYMBOL * (i % 2 == 0 ? 1.0 : -1.0);
        at[i + 1][0] = a[0] + (along * x) - (beside * y);
        at[i + 1][1] = a[1] + (along * y) + (beside * x);
    }
    memcpy(at[TEETH + 1], b, sizeof at[0]);
    put_path(p, TEETH + 2, (const double(*)[2])at, colour);
}

static void put_spiral(const svg *p, const double at[2], const char *colour)
{
    enum { POINTS = 40 };
    double path[POINTS][2];
    for (int i = 0; i < POINTS; i++) {
        const double part = (double)i / (POINTS - 1);
        const double r = SYMBOL * (1.3 + (1.3 * part));
        path[i][0] = at[0] + (r * cos(2.25 * TURN * part));
        path[i][1] = at[1] + (r * sin(2.25 * TURN * part));
    }
    put_path(p, POINTS, (const double(*)[2])path, colour);
}

/* One spring; a link is drawn as what it joins. */
static void put_spring(const svg *p, const mt_scene_spring *s, const char *colour)
{
    double a[2];
    double b[2];
    project_body_point(p, s->body[0], s->end[0], a);
    project_body_point(p, s->body[1], s->end[1], b);
    if (strcmp(s->type, "link") == 0) {
        return;
    }
    if (strcmp(s->type, "bar") == 0) {
        put_line(p, a, b, colour, 3.0);
    } else if (hypot(b[0] - a[0], b[1] - a[1]) > 4 * SYMBOL) {
        put_zigzag(p, a, b, colour);
    } else {
        put_spiral(p, a, colour);
    }
}

static void put_circle(const svg *p, const double at[2], double r, const char *fill)
{
    mt_text_addf(p->out,
                 "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\" stroke=\"%s\" "
                 "stroke-width=\"1.4\"/>\n",
                 at[0], at[1], r, fill, REST);
}

static void put_polygon(const svg *p, int n, const double at[2], double phase)
{
    mt_text_add(p->out, "<polygon points=\"");
    for (int i = 0; i < n; i++) {
        const double angle = TURN * ((i / (double)n) + phase);
        mt_text_addf(p->out, "%s%.1f,%.1f", i == 0 ? "" : " ",
                     at[0] + (1.3 * SYMBOL * cos(angle)), at[1] + (1.3 * SYMBOL * sin(angle)));
    }
    mt_text_addf(p->out, "\" fill=\"#ffffff\" stroke=\"%s\" stroke-width=\"1.4\"/>\n", REST);
}

/* Draw a joint: a circle for a revolute, a square for a sliding one, a diamond for a ball, a
 * cross for a fixed one, a triangle for any other. */
static void put_joint(svg *p, const mt_scene_joint *j)
{
    double at[2];
    project_body_point(p, j->body[1], j->at, at);
    if (strcmp(j->type, "revolute") == 0) {
        put_circle(p, at, SYMBOL, "#ffffff");
    } else if (strcmp(j->type, "prismatic") == 0 || strcmp(j->type, "cylindrical") == 0) {
        put_polygon(p, 4, at, 0.125);
    } else if (strcmp(j->type, "spherical") == 0 || strcmp(j->type, "universal") == 0) {
        put_polygon(p, 4, at, 0.0);
    } else if (strcmp(j->type, "fixed") == 0) {
        for (int side = -1; side <= 1; side += 2) {
            const double a[2] = {at[0] - SYMBOL, at[1] - (side * SYMBOL)};
            const double b[2] = {at[0] + SYMBOL, at[1] + (side * SYMBOL)};
            put_line(p, a, b, REST, 1.4);
        }
    } else {
        put_polygon(p, 3, at, 0.75);
    }
    const double beside[2] = {at[0] + (2 * SYMBOL), at[1] - SYMBOL};
    put_name(p, beside, j->name, REST);
}

/* Names of bodies, and of links once, in their middle. */
static void put_names(svg *p)
{
    const mt_scene_view *const v = p->view;
    for (int i = 1; i < v->n_bodies; i++) {
        const mt_scene_body *const b = &v->bodies[i];
        double at[2];
        project_body_point(p, i, b->at, at);
        if (b->kind == MT_SCENE_BODY) {
            put_circle(p, at, 2.5, REST);
            at[0] += 2 * SYMBOL;
            at[1] += 3 * SYMBOL;
            put_name(p, at, b->name, REST);
        }
    }
    for (int i = 0; i < v->n_springs; i++) {
        const mt_scene_spring *const s = &v->springs[i];
        double a[2];
        double b[2];
        project_body_point(p, s->body[0], s->end[0], a);
        project_body_point(p, s->body[1], s->end[1], b);
        const double at[2] = {(0.5 * (a[0] + b[0])) + (2 * SYMBOL),
                              (0.5 * (a[1] + b[1])) + (2 * SYMBOL)};
        put_name(p, at, s->name, strcmp(s->type, "link") == 0 ? REST : SPRING);
    }
}

static void put_heading(const svg *p, const mt_scene_mode *mode)
{
    mt_text_add(p->out, "<text x=\"16\" y=\"24\" font-size=\"15\" font-weight=\"bold\" "
                        "fill=\"#1a1a1a\">");
    mt_html_escape(p->scene->name, p->out);
    mt_text_add(p->out, p->scene->name[0] == '\0' ? "" : ", ");
    mt_html_escape(p->view->name, p->out);
    if (mode != NULL) {
        mt_text_addf(p->out, ", mode %d at %.4g Hz", mode->index, mode->hz);
        mt_text_add(p->out, mode->name == NULL ? "" : ": ");
        mt_html_escape(mode->name == NULL ? "" : mode->name, p->out);
    }
    mt_text_add(p->out, "</text>\n");
    if (p->view->error != NULL) {
        mt_text_addf(p->out, "<text x=\"16\" y=\"42\" fill=\"%s\">", MOVED);
        mt_html_escape(p->view->error, p->out);
        mt_text_add(p->out, "</text>\n");
    }
}

static void put_still(const svg *p, const char *colour, const char *springs, double width)
{
    const mt_scene_view *const v = p->view;
    put_bodies(p, colour, width);
    for (int i = 0; i < v->n_joints; i++) {
        const mt_scene_joint *const j = &v->joints[i];
        if (j->rod) {
            double a[2];
            double b[2];
            project_body_point(p, j->body[0], j->end[0], a);
            project_body_point(p, j->body[1], j->end[1], b);
            put_line(p, a, b, colour, width);
        }
    }
    for (int i = 0; i < v->n_springs; i++) {
        put_spring(p, &v->springs[i], springs);
    }
    for (int i = 0; i < v->n_dampers; i++) {
        put_spring(p, &v->dampers[i], springs);
    }
}

/* A drawing of one configuration as SVG: in space an isometric view with up opposite to
 * gravity; mode (NULL: none): its shape in a second colour over the position at rest. */
static void draw_svg(const mt_scene *scene, const mt_scene_view *view,
                     const mt_scene_mode *mode, mt_text *out)
{
    svg p = {.scene = scene,
             .view = view,
             .reach = AMPLITUDE * scene->size,
             .low = {HUGE_VAL, HUGE_VAL},
             .high = {-HUGE_VAL, -HUGE_VAL},
             .out = out};
    look_from(&p);
    include_all(&p);
    if (mode != NULL) {
        p.motion = mode->motion;
        include_all(&p);
        p.motion = NULL;
    }
    fit(&p);
    mt_text_addf(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
                 "height=\"%d\" role=\"img\" font-family=\"sans-serif\" font-size=\"11\">\n"
                 "<rect width=\"%d\" height=\"%d\" fill=\"#ffffff\"/>\n",
                 WIDTH, HEIGHT, WIDTH, HEIGHT, WIDTH, HEIGHT);
    put_still(&p, mode == NULL ? REST : SOFT, mode == NULL ? SPRING : SOFT,
              mode == NULL ? 2.4 : 1.6);
    if (mode != NULL) {
        p.motion = mode->motion;
        put_still(&p, MOVED, MOVED, 2.4);
        p.motion = NULL;
    }
    for (int i = 0; i < view->n_joints; i++) {
        put_joint(&p, &view->joints[i]);
    }
    put_names(&p);
    put_heading(&p, mode);
    mt_text_add(out, "</svg>\n");
}

/* The command. */

/* What is looked at: a model, at the design of its file and --set, or at those of a result. */
typedef struct subject {
    mt_loaded_model s; /* its designs are those below where there is a result */
    mt_result *result; /* NULL: a model was given */
    char *path;        /* heap: of the model of the result */
    int n;
    mt_scene_query *asks;
} subject;

/* *is: true where the file's format is that of a result. Errors in its text are reported by the
 * full reader. Fails: MT_E_SYSTEM, MT_E_MEMORY. */
static mt_status is_result(const char *path, bool *is, mt_err *err)
{
    static const char format[] = "modetune-result/";
    mt_file file = {.bytes = NULL};
    mt_json *doc = NULL;
    *is = false;
    mt_status rc = mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &file, err);
    rc = rc == MT_OK ? mt_json_parse(file.bytes, file.length, &doc, err) : rc;
    if (rc == MT_OK) {
        const mt_addr member = mt_json_member(doc, MT_JSON_ROOT, "format");
        *is = member != MT_NO_ADDR && mt_json_type_of(doc, member) == MT_JSON_STRING &&
              strncmp(mt_json_string(doc, member), format, sizeof format - 1) == 0;
    }
    mt_json_delete(doc);
    mt_file_free(&file);
    return rc == MT_E_MEMORY || rc == MT_E_SYSTEM ? rc : MT_OK;
}

static mt_status of_model(const mt_args *args, subject *o, mt_err *err)
{
    o->asks = mt_arena_alloc(&o->s.mem, 1, sizeof *o->asks);
    MT_TRY(mt_arena_check(&o->s.mem, err));
    o->asks[0] = (mt_scene_query){.label = args->all[MT_OPT_SET].n == 0 ? "original" : "as set",
                                  .n_inputs = o->s.n_inputs,
                                  .inputs = o->s.inputs,
                                  .at = o->s.at,
                                  .n_shown = -1};
    o->n = 1;
    return args->all[MT_OPT_SET].n == 0
               ? mt_scene_name_modes(o->s.model, &o->s.mem, &o->asks[0], err)
               : MT_OK;
}

/* Load the operand. Returns the exit status, with all messages given. */
static int load_shown_file(const mt_args *args, subject *o)
{
    const mt_io_options opt = mt_cli_io(args);
    const char *const operand = args->operands[0];
    const char *const configuration = args->value[MT_OPT_CONFIGURATION];
    mt_diagnostics messages = {.count = 0};
    mt_err err = {.code = MT_OK};
    mt_file file = {.bytes = NULL};
    bool result = false;
    mt_status rc = is_result(operand, &result, &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    if (!result && args->given[MT_OPT_MODEL]) {
        return mt_cli_failed(
            mt_fail(&err, MT_E_USAGE, "--model needs a result, and %s is not one", operand),
            &err);
    }
    if (result && args->all[MT_OPT_SET].n > 0) {
        return mt_cli_failed(
            mt_fail(&err, MT_E_USAGE, "--set needs a model: a result has its own values"),
            &err);
    }
    if (!result) {
        const int code = mt_loaded_model_load(args, operand, configuration, &o->s);
        rc = code == MT_EXIT_DONE ? of_model(args, o, &err) : MT_OK;
        return code != MT_EXIT_DONE ? code
               : rc == MT_OK        ? MT_EXIT_DONE
                                    : mt_cli_failed(rc, &err);
    }
    rc = mt_result_load(operand, &opt, &o->result, &messages, &err);
    int code = mt_cli_loaded(rc, &messages, &err);
    if (rc != MT_OK) {
        return code;
    }
    rc = mt_find_model(args, o->result, &file, &o->path, &err);
    mt_file_free(&file);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    code = mt_loaded_model_load(args, o->path, configuration, &o->s);
    if (code == MT_EXIT_DONE && configuration == NULL) {
        (void)mt_scene_order(o->s.model, o->result, o->s.configurations); /* all of them */
    }
    rc = code == MT_EXIT_DONE
             ? mt_scene_designs(o->s.model, o->result, o->s.n_configurations,
                                o->s.configurations, &o->s.mem, &o->asks, &o->n, &err)
             : MT_OK;
    (void)mt_err_in(&err, rc, "%s", operand);
    return rc == MT_OK ? code : mt_cli_failed(rc, &err);
}

/* Warn with each reason once, with the first configuration that has it. */
static void warn(const mt_scene *scene, const char *path)
{
    const mt_scene_view *last = NULL;
    int more = 0;
    for (int d = 0; d < scene->n_designs; d++) {
        for (int i = 0; i < scene->designs[d].n_views; i++) {
            const mt_scene_view *const v = &scene->designs[d].views[i];
            if (v->error == NULL) {
                continue;
            }
            if (last != NULL && strcmp(last->error, v->error) == 0) {
                more++;
                continue;
            }
            mt_terminal_warning("%s: configuration \"%s\": %s", path, v->name, v->error);
            last = v;
        }
    }
    if (more > 0) {
        mt_terminal_warning("%s: %d more like these: choose what to show with -c", path, more);
    }
}

static mt_status page(const mt_scene *scene, const char *title, mt_text *out, mt_err *err)
{
    mt_text json = {.s = NULL};
    const mt_status rc = mt_scene_write_page(scene, &json, err);
    if (rc == MT_OK) {
        const mt_page_data data[] = {{"scene", json.s}};
        mt_page_begin(MT_PAGE_SHOW, title, out);
        mt_page_end(MT_COUNT(data), data, out);
    }
    mt_text_free(&json);
    return rc;
}

/* Draw the best recommended design of a result, else the original one, in its first
 * configuration shown, with the mode of --mode. */
static mt_status still(const mt_args *args, const mt_scene *scene, mt_text *out, mt_err *err)
{
    const mt_scene_design *const d = &scene->designs[scene->n_designs > 1 ? 1 : 0];
    const mt_scene_view *const v = &d->views[0];
    const mt_scene_mode *mode = NULL;
    for (int i = 0; i < v->n_modes; i++) {
        mode = args->mode > 0 && v->modes[i].index == args->mode ? &v->modes[i] : mode;
    }
    if (args->mode > 0 && mode == NULL) {
        return mt_fail(err, MT_E_USAGE,
                       "--mode: configuration \"%s\" shows no vibration mode %d", v->name,
                       args->mode);
    }
    draw_svg(scene, v, mode, out);
    return MT_OK;
}

static mt_status check_use(const mt_args *args, mt_err *err)
{
    if (args->given[MT_OPT_MODE] && !args->given[MT_OPT_SVG]) {
        return mt_fail(err, MT_E_USAGE, "--mode needs --svg: the page shows all modes");
    }
    if (args->given[MT_OPT_FORMAT] && args->given[MT_OPT_SVG]) {
        return mt_fail(err, MT_E_USAGE, "--svg and --format exclude each other");
    }
    return MT_OK;
}

static mt_status write(const mt_args *args, const subject *o, const mt_scene *scene,
                       mt_text *out, mt_err *err)
{
    const char *const title =
        scene->name[0] != '\0' ? scene->name : mt_text_base_name(o->s.path);
    const mt_status rc = args->given[MT_OPT_SVG]          ? still(args, scene, out, err)
                         : args->format == MT_FORMAT_JSON ? mt_scene_write(scene, out, err)
                                                          : page(scene, title, out, err);
    return rc == MT_OK && out->failed ? mt_fail_memory(err) : rc;
}

static int run_show(const mt_args *args, mt_text *out)
{
    subject o = {.result = NULL};
    mt_scene *scene = NULL;
    mt_err err = {.code = MT_OK};
    mt_status rc = check_use(args, &err);
    int code = rc == MT_OK ? load_shown_file(args, &o) : mt_cli_failed(rc, &err);
    if (code != MT_EXIT_DONE) {
        goto done;
    }
    /* a picture is of one configuration and one design */
    const int n = args->given[MT_OPT_SVG] ? 1 : o.s.n_configurations;
    const mt_scene_extent extent = {
        .n_configurations = n, .configurations = o.s.configurations, .work = MT_SCENE_WORK};
    rc = mt_scene_new(o.s.model, o.n, o.asks, &extent, &scene, &err);
    if (rc == MT_OK) {
        warn(scene, o.s.path);
        rc = write(args, &o, scene, out, &err);
    }
    code = rc == MT_OK ? MT_EXIT_DONE : mt_cli_failed(rc, &err);
done:
    mt_scene_delete(scene);
    mt_result_delete(o.result);
    mt_loaded_model_free(&o.s);
    free(o.path);
    return code;
}

const mt_command mt_command_show = {
    .name = "show",
    .operands = "MODEL|RESULT.json",
    .least = 1,
    .most = 1,
    .summary = "the mechanism in three dimensions",
    .details =
        "Prints a page that opens in any browser and needs no other file. It shows bodies "
        "with their ellipsoids of inertia, links, joints with their axes and their "
        "distance from their bodies, springs, dampers and sensors; the lowest 12 vibration "
        "modes in motion, with the share of energy of every spring and body; and the range "
        "of a driven joint. For a result, or its folder, it shows the original design and "
        "the recommended ones, with the model that apply finds.\n"
        "--format json prints what the page draws, --svg a still picture. A configuration "
        "that cannot be analysed is drawn as far as possible, and a message says why.",
    .run = run_show,
};
