/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene as JSON: the tables of its members, by which it is written and its schema is. */
#include "scene/write.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "io/write_json.h"

/* Significant digits: of a place a picture of ten thousand pixels has fewer; motions;
 * frequencies as tables have them, and some. */
enum { PLACE_DIGITS = 6, MOTION = 5, HZ = 9, VALUE = 9 };
typedef double triple[3];
typedef int pair[2];
static const double SHARE_STEP = 1e-6;

static const char *const KINDS[] = {
    [MT_SCENE_GROUND] = "ground", [MT_SCENE_BODY] = "body", [MT_SCENE_LINK] = "link"};
static const char *const SPRING_TYPES[] = {"torsion", "axial", "bar", "bushing", "link"};
static const char *const DAMPER_TYPES[] = {"torsion", "axial", "bar", "bushing"};
static const char *const NOTES[] = {"rigid-body", "unstable", "undecided"};

static void put_numbers(mt_json_writer *w, const char *name, int n, const double *x, int digits)
{
    mt_json_open_flat(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_put_rounded(w, NULL, x[i], digits);
    }
    mt_json_close(w);
}

/* Rounded down, so that what adds up to 1 never adds up to more. */
static void put_shares(mt_json_writer *w, const char *name, int n, const double *x)
{
    mt_json_open_flat(w, name, '[');
    for (int i = 0; i < n; i++) {
        mt_json_put_rounded(w, NULL, floor(x[i] / SHARE_STEP) * SHARE_STEP, PLACE_DIGITS);
    }
    mt_json_close(w);
}

/* The place of the row's value. */
static const void *place(const mt_scene_row *row, const void *item)
{
    return (const char *)item + row->at;
}

static const void *pointer_at(const mt_scene_row *row, const void *item)
{
    const void *p = NULL;
    memcpy(&p, place(row, item), sizeof p);
    return p;
}

static void put_table(mt_json_writer *w, const char *name, const mt_scene_table *table,
                      const void *item, const mt_scene_view *v)
{
    (table->flat ? mt_json_open_flat : mt_json_open)(w, name, '{');
    for (int i = 0; i < table->n; i++) {
        table->rows[i].put(w, &table->rows[i], item, v);
    }
    mt_json_close(w);
}

static void put_text(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    (void)v;
    mt_json_put_string(w, row->name, pointer_at(row, item));
}

static void put_choice(mt_json_writer *w, const mt_scene_row *row, const void *item,
                       const mt_scene_view *v)
{
    (void)v;
    mt_json_put_string(w, row->name, row->choices[*(const unsigned *)place(row, item)]);
}

static void put_count(mt_json_writer *w, const mt_scene_row *row, const void *item,
                      const mt_scene_view *v)
{
    (void)v;
    mt_json_put_integer(w, row->name, *(const int *)place(row, item));
}

static void put_number(mt_json_writer *w, const mt_scene_row *row, const void *item,
                       const mt_scene_view *v)
{
    const double number = *(const double *)place(row, item);
    (void)v;
    if (row->digits > 0) {
        mt_json_put_rounded(w, row->name, number, row->digits);
    } else {
        mt_json_put_number(w, row->name, number);
    }
}

static void put_place(mt_json_writer *w, const mt_scene_row *row, const void *item,
                      const mt_scene_view *v)
{
    (void)v;
    put_numbers(w, row->name, 3, place(row, item), PLACE_DIGITS);
}

static void put_place_if(mt_json_writer *w, const mt_scene_row *row, const void *item,
                         const mt_scene_view *v)
{
    if (*(const bool *)((const char *)item + row->other)) {
        put_place(w, row, item, v);
    } else {
        mt_json_put_null(w, row->name);
    }
}

static void put_pair(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    const int *const body = place(row, item);
    (void)v;
    mt_json_open_flat(w, row->name, '[');
    mt_json_put_integer(w, NULL, body[0]);
    mt_json_put_integer(w, NULL, body[1]);
    mt_json_close(w);
}

/* What is in a configuration is written with it at hand. */
static void put_list(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    const char *const items = pointer_at(row, item);
    const int n = *(const int *)(const void *)((const char *)item + row->other);
    mt_json_open(w, row->name, '[');
    for (int i = 0; i < n; i++) {
        const void *const at = items + ((size_t)i * row->of->size);
        put_table(w, NULL, row->of, at, row->views ? at : v);
    }
    mt_json_close(w);
}

/* A model has none. */
static void put_none(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    (void)item;
    (void)v;
    mt_json_open(w, row->name, '[');
    mt_json_close(w);
}

static void put_option(mt_json_writer *w, const mt_scene_row *row, const void *item,
                       const mt_scene_view *v)
{
    const void *const part = pointer_at(row, item);
    if (part == NULL) {
        mt_json_put_null(w, row->name);
    } else {
        put_table(w, row->name, row->of, part, v);
    }
}

/* Members of the struct itself, as an object. */
static void put_part(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    put_table(w, row->name, row->of, item, v);
}

static void put_format(mt_json_writer *w, const mt_scene_row *row, const void *item,
                       const mt_scene_view *v)
{
    (void)item;
    (void)v;
    mt_json_put_string(w, row->name, "modetune-scene/1");
}

static void put_dimension(mt_json_writer *w, const mt_scene_row *row, const void *item,
                          const mt_scene_view *v)
{
    const mt_scene *const scene = item;
    (void)v;
    mt_json_put_integer(w, row->name, scene->dimension);
}

static void put_axes(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    const mt_scene_ellipsoid *const e = item;
    (void)v;
    mt_json_open(w, row->name, '[');
    for (int i = 0; i < 3; i++) {
        put_numbers(w, NULL, 3, e->axes[i], PLACE_DIGITS);
    }
    mt_json_close(w);
}

static void put_far(mt_json_writer *w, const mt_scene_row *row, const void *item,
                    const mt_scene_view *v)
{
    const mt_scene_joint *const j = item;
    mt_json_put_string(w, row->name, j->far == MT_ABSENT ? NULL : v->bodies[j->far].name);
}

static void put_spring_shares(mt_json_writer *w, const mt_scene_row *row, const void *item,
                              const mt_scene_view *v)
{
    const mt_scene_mode *const m = item;
    put_shares(w, row->name, v->n_springs, m->spring_share);
}

static void put_body_shares(mt_json_writer *w, const mt_scene_row *row, const void *item,
                            const mt_scene_view *v)
{
    const mt_scene_mode *const m = item;
    put_shares(w, row->name, v->n_bodies, m->body_share);
}

/* So many numbers of each body. */
static void put_of_bodies(mt_json_writer *w, const char *name, const mt_scene_view *v, int n,
                          const double *x, int digits)
{
    mt_json_open_flat(w, name, '[');
    for (int b = 0; b < v->n_bodies; b++) {
        put_numbers(w, NULL, n, x + ((ptrdiff_t)n * b), digits);
    }
    mt_json_close(w);
}

static void put_motion(mt_json_writer *w, const mt_scene_row *row, const void *item,
                       const mt_scene_view *v)
{
    const mt_scene_mode *const m = item;
    put_of_bodies(w, row->name, v, 6, m->motion, MOTION);
}

static void put_poses(mt_json_writer *w, const mt_scene_row *row, const void *item,
                      const mt_scene_view *v)
{
    const mt_scene_position *const p = item;
    if (p->pose == NULL) {
        mt_json_put_null(w, row->name);
    } else {
        put_of_bodies(w, row->name, v, 12, p->pose, PLACE_DIGITS);
    }
}

static void put_frequencies(mt_json_writer *w, const mt_scene_row *row, const void *item,
                            const mt_scene_view *v)
{
    const mt_scene_position *const p = item;
    (void)v;
    put_numbers(w, row->name, p->n_hz, p->hz, HZ);
}

static void put_unit(mt_json_writer *w, const mt_scene_row *row, const void *item,
                     const mt_scene_view *v)
{
    const mt_scene_drive *const d = item;
    (void)v;
    mt_json_put_string(w, row->name, d->angle ? "rad" : "m");
}

static void put_off_name(mt_json_writer *w, const mt_scene_row *row, const void *item,
                         const mt_scene_view *v)
{
    const mt_scene_off *const o = item;
    (void)v;
    mt_json_put_string(w, row->name, o->joint->name);
}

static void put_off_type(mt_json_writer *w, const mt_scene_row *row, const void *item,
                         const mt_scene_view *v)
{
    const mt_scene_off *const o = item;
    (void)v;
    mt_json_put_string(w, row->name, o->joint->type);
}

static void put_off_distance(mt_json_writer *w, const mt_scene_row *row, const void *item,
                             const mt_scene_view *v)
{
    const mt_scene_off *const o = item;
    (void)v;
    mt_json_put_rounded(w, row->name, o->joint->distance, PLACE_DIGITS);
}

/* Rows, with THIS for the struct; the compiler checks the type of its member. The sentence
 * comes last; behind it `.limits` may be given. */
/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
#define AT(of, m) (offsetof(THIS, m) * _Generic(&((THIS *)NULL)->m, of * : 1U))
#define ROW(label, function, of, m, type, ...)                                 \
    {                                                                          \
        .name = (label), .put = (function), .at = AT(of, m), .schema = (type), \
        .says = __VA_ARGS__                                                    \
    }
#define STRING         "\"type\": \"string\""
#define STRING_OR_NULL "\"type\": [\"string\", \"null\"]"
#define THREE                                                \
    ", \"items\": {\"type\": \"number\"}, \"minItems\": 3, " \
    "\"maxItems\": 3"
#define TEXT(label, m, ...) ROW(label, put_text, const char *, m, STRING, __VA_ARGS__)
#define TEXT_OR_NULL(label, m, ...) \
    ROW(label, put_text, const char *, m, STRING_OR_NULL, __VA_ARGS__)
#define CHOICE(label, m, of, list, ...)                                   \
    ROW(label, put_choice, of, m, STRING, __VA_ARGS__, .choices = (list), \
        .n_choices = MT_COUNT(list))
#define ONE_OF(label, m, list, ...)                                               \
    ROW(label, put_text, const char *, m, STRING, __VA_ARGS__, .choices = (list), \
        .n_choices = MT_COUNT(list))
#define ONE_OF_OR_NULL(label, m, list, ...)                                               \
    ROW(label, put_text, const char *, m, STRING_OR_NULL, __VA_ARGS__, .choices = (list), \
        .n_choices = MT_COUNT(list), .or_null = true)
/* int, 0 or more */
#define COUNT(label, m, ...) \
    ROW(label, put_count, int, m, "\"type\": \"integer\", \"minimum\": 0", __VA_ARGS__)
/* double; digits 0: all of them */
#define NUMBER(label, m, count, ...) \
    ROW(label, put_number, double, m, "\"type\": \"number\"", __VA_ARGS__, .digits = (count))
#define NUMBER_OR_NULL(label, m, count, ...)                                           \
    ROW(label, put_number, double, m, "\"type\": [\"number\", \"null\"]", __VA_ARGS__, \
        .digits = (count))
/* double[3]; null without the flag */
#define PLACE(label, m, ...) \
    ROW(label, put_place, triple, m, "\"type\": \"array\"" THREE, __VA_ARGS__)
#define PLACE_IF(label, m, flag, ...)                                                         \
    ROW(label, put_place_if, triple, m, "\"type\": [\"array\", \"null\"]" THREE, __VA_ARGS__, \
        .other = AT(bool, flag))
/* int[2] */
#define PAIR(label, m, ...)                                                         \
    ROW(label, put_pair, pair, m,                                                   \
        "\"type\": \"array\", \"items\": {\"type\": \"integer\", \"minimum\": 0}, " \
        "\"minItems\": 2, \"maxItems\": 2",                                         \
        __VA_ARGS__)
#define LIST(label, m, count, item, table, ...)                                 \
    ROW(label, put_list, item *, m, NULL, __VA_ARGS__, .other = AT(int, count), \
        .of = &(table), .list = true)
/* Configurations, which are at hand for what is in them */
#define VIEWS(label, m, count, item, table, ...) \
    LIST(label, m, count, item, table, __VA_ARGS__, .views = true)
#define OPTION(label, m, part, table, ...) \
    ROW(label, put_option, part *, m, NULL, __VA_ARGS__, .of = &(table), .or_null = true)
#define NONE(label, table, ...)                                                             \
    {                                                                                       \
        .name = (label), .put = put_none, .of = &(table), .list = true, .says = __VA_ARGS__ \
    }
#define PART(label, table, ...)                                               \
    {                                                                         \
        .name = (label), .put = put_part, .of = &(table), .says = __VA_ARGS__ \
    }
#define OWN(label, function, ...)                               \
    {                                                           \
        .name = (label), .put = (function), .says = __VA_ARGS__ \
    }
/* NOLINTEND(bugprone-macro-parentheses) */

#define THIS mt_scene_ellipsoid
static const mt_scene_row ELLIPSOID_ROWS[] = {
    PLACE("radii", radii, "Semi-axes, descending [m]."),
    OWN("axes", put_axes, "Their directions, unit vectors.",
        .schema =
            "\"type\": \"array\", \"items\": {\"type\": \"array\", \"items\": {\"type\": "
            "\"number\"}, \"minItems\": 3, \"maxItems\": 3}, \"minItems\": 3, \"maxItems\": 3"),
};
#undef THIS
static const mt_scene_table ELLIPSOID = {.rows = ELLIPSOID_ROWS,
                                         .n = MT_COUNT(ELLIPSOID_ROWS),
                                         .size = sizeof(mt_scene_ellipsoid),
                                         .flat = false};

#define THIS mt_scene_body
static const mt_scene_row BODY_ROWS[] = {
    TEXT("name", name,
         "As in the model; of a link's element or node \"link.1\", \"link.node0\"."),
    CHOICE("kind", kind, mt_scene_kind, KINDS, "What it is."),
    NUMBER("mass", mass, VALUE,
           "Its mass, half of each bar and beam element that ends on it included [kg].",
           .limits = "\"minimum\": 0"),
    PLACE("at", at, "Its mass centre [m]."),
    OPTION("ellipsoid", ellipsoid, mt_scene_ellipsoid, ELLIPSOID,
           "Uniform, of the same mass and inertia, at the mass centre; in two dimensions "
           "a disc. null: it has none."),
};
#undef THIS
static const mt_scene_table BODY = {.rows = BODY_ROWS,
                                    .n = MT_COUNT(BODY_ROWS),
                                    .size = sizeof(mt_scene_body),
                                    .flat = true,
                                    .says = "A body."};

#define THIS mt_scene_point
static const mt_scene_row POINT_ROWS[] = {
    TEXT("name", name, "As in the model."),
    COUNT("body", body, "That holds it."),
    PLACE("at", at, "[m]"),
};
#undef THIS
static const mt_scene_table POINT = {.rows = POINT_ROWS,
                                     .n = MT_COUNT(POINT_ROWS),
                                     .size = sizeof(mt_scene_point),
                                     .flat = true,
                                     .says = "A point."};

#define THIS mt_scene_line
static const mt_scene_row LINE_ROWS[] = {
    COUNT("body", body, "That it belongs to."),
    PLACE("from", from, "[m]"),
    PLACE("to", to, "[m]"),
};
#undef THIS
static const mt_scene_table LINE = {.rows = LINE_ROWS,
                                    .n = MT_COUNT(LINE_ROWS),
                                    .size = sizeof(mt_scene_line),
                                    .flat = true,
                                    .says = "A line."};

#define THIS mt_scene_joint
static const mt_scene_row JOINT_ROWS[] = {
    TEXT("name", name, "As in the model."),
    TEXT("type", type, "As in the model."),
    PAIR("bodies", body, "That it joins."),
    PLACE_IF("from", end[0], rod,
             "Of a distance joint, which is drawn as a rod: its point on the first body "
             "[m]; null: of any other."),
    PLACE("at", at, "Its point on the second body [m]."),
    PLACE_IF("axis", axis, has_axis, "Its axis, a unit vector; null: none."),
    NUMBER("distance", distance, PLACE_DIGITS,
           "Of its point to what is drawn of the body that is farther: 0 where it lies on "
           "a link, or no farther outside the ellipsoid of a body than half of the "
           "greatest radius [m].",
           .limits = "\"minimum\": 0"),
    OWN("far", put_far, "That body; null where the distance is 0.",
        .schema = "\"type\": [\"string\", \"null\"]"),
};
#undef THIS
static const mt_scene_table JOINT = {.rows = JOINT_ROWS,
                                     .n = MT_COUNT(JOINT_ROWS),
                                     .size = sizeof(mt_scene_joint),
                                     .flat = true,
                                     .says = "A joint."};

#define THIS mt_scene_spring
static const mt_scene_row SPRING_ROWS[] = {
    TEXT("name", name, "As in the model."),
    ONE_OF("type", type, SPRING_TYPES, "As in the model; \"link\": what is elastic of a link."),
    PAIR("bodies", body, "The bodies that it joins."),
    PLACE("from", end[0], "Where it holds the first [m]."),
    PLACE("to", end[1], "Where it holds the second [m]."),
    PLACE_IF("axis", axis, has_axis, "That it turns about, a unit vector; null: none."),
    NUMBER_OR_NULL("stiffness", stiffness, VALUE,
                   "[N/m or N m/rad]; null where it is not one number."),
};
#undef THIS
static const mt_scene_table SPRING = {.rows = SPRING_ROWS,
                                      .n = MT_COUNT(SPRING_ROWS),
                                      .size = sizeof(mt_scene_spring),
                                      .flat = true,
                                      .says = "A spring."};

#define THIS mt_scene_spring
static const mt_scene_row DAMPER_ROWS[] = {
    TEXT("name", name, "As in the model."),
    ONE_OF("type", type, DAMPER_TYPES, "As in the model."),
    PAIR("bodies", body, "The bodies that it joins."),
    PLACE("from", end[0], "Where it holds the first [m]."),
    PLACE("to", end[1], "Where it holds the second [m]."),
    PLACE_IF("axis", axis, has_axis, "That it turns about, a unit vector; null: none."),
    NUMBER_OR_NULL("damping", stiffness, VALUE,
                   "[N s/m or N m s/rad]; null where it is not one number."),
};
#undef THIS
static const mt_scene_table DAMPER = {.rows = DAMPER_ROWS,
                                      .n = MT_COUNT(DAMPER_ROWS),
                                      .size = sizeof(mt_scene_spring),
                                      .flat = true,
                                      .says = "A damper."};

#define THIS mt_scene_arrow
static const mt_scene_row SENSOR_ROWS[] = {
    TEXT("name", name, "Its name; of a sensor with the direction."),
    COUNT("body", body, "That it is on."),
    PLACE("at", at, "Where [m]."),
    PLACE("axis", axis, "The direction, a unit vector."),
};
#undef THIS
static const mt_scene_table SENSOR = {.rows = SENSOR_ROWS,
                                      .n = MT_COUNT(SENSOR_ROWS),
                                      .size = sizeof(mt_scene_arrow),
                                      .flat = true,
                                      .says = "A sensor."};

#define THIS mt_scene_arrow
static const mt_scene_row LOAD_ROWS[] = {
    TEXT("name", name, "Its name; of a sensor with the direction."),
    COUNT("body", body, "That it is on."),
    PLACE("at", at, "Where [m]."),
    PLACE("axis", axis, "The force [N]."),
};
#undef THIS
static const mt_scene_table LOAD = {.rows = LOAD_ROWS,
                                    .n = MT_COUNT(LOAD_ROWS),
                                    .size = sizeof(mt_scene_arrow),
                                    .flat = true,
                                    .says = "A load."};

#define THIS mt_scene_arrow
static const mt_scene_row ROTOR_ROWS[] = {
    TEXT("name", name, "Its name; of a sensor with the direction."),
    COUNT("body", body, "That it is on."),
    PLACE("at", at, "Where [m]."),
    PLACE("axis", axis, "Its direction."),
};
#undef THIS
static const mt_scene_table ROTOR = {.rows = ROTOR_ROWS,
                                     .n = MT_COUNT(ROTOR_ROWS),
                                     .size = sizeof(mt_scene_arrow),
                                     .flat = true,
                                     .says = "A rotor."};

#define THIS mt_scene_mode
static const mt_scene_row ENERGY_ROWS[] = {
    OWN("springs", put_spring_shares,
        "Of the potential energy, one of each spring; what loads do counts by its "
        "magnitude, and is the rest.",
        .schema = "\"type\": \"array\", \"items\": {\"description\": \"A share.\", \"type\": "
                  "\"number\", \"minimum\": 0, \"maximum\": 1}"),
    OWN("bodies", put_body_shares, "Of the kinetic energy, one of each body.",
        .schema = "\"type\": \"array\", \"items\": {\"description\": \"A share.\", \"type\": "
                  "\"number\", \"minimum\": 0, \"maximum\": 1}"),
};
#undef THIS
static const mt_scene_table ENERGY = {.rows = ENERGY_ROWS,
                                      .n = MT_COUNT(ENERGY_ROWS),
                                      .size = sizeof(mt_scene_mode),
                                      .flat = false};

#define THIS mt_scene_mode
static const mt_scene_row MODE_ROWS[] = {
    COUNT("mode", index, "Index of the vibration, from 1; 0: it has none."),
    NUMBER_OR_NULL("hz", hz, HZ,
                   "Its frequency [Hz], 0 of a rigid-body mode; null: unstable or undecided.",
                   .limits = "\"minimum\": 0"),
    TEXT_OR_NULL("name", name, "That the model gives it; null: none."),
    ONE_OF_OR_NULL("note", note, NOTES, "What it is where it is not a vibration."),
    OWN("motion", put_motion,
        "One of each body: translation of its mass centre (x, y, z), then its rotation "
        "vector, scaled so that the largest displacement of all that is drawn is 1.",
        .schema = "\"type\": \"array\", \"items\": {\"type\": \"array\", \"items\": {\"type\": "
                  "\"number\"}, \"minItems\": 6, \"maxItems\": 6}"),
    PART("energy", ENERGY,
         "Shares of its energy, rounded down: they never add up to more than 1."),
};
#undef THIS
static const mt_scene_table MODE = {.rows = MODE_ROWS,
                                    .n = MT_COUNT(MODE_ROWS),
                                    .size = sizeof(mt_scene_mode),
                                    .flat = false,
                                    .says = "A mode as a small motion."};

#define THIS mt_scene_position
static const mt_scene_row POSITION_ROWS[] = {
    NUMBER("at", at, VALUE, "From the reference position [unit of the drive]."),
    OWN("poses", put_poses,
        "One of each body: mass centre (x, y, z), then the rotation from the pose of "
        "the configuration, row by row; null: there is none.",
        .schema = "\"type\": [\"array\", \"null\"], \"items\": {\"type\": \"array\", "
                  "\"items\": {\"type\": \"number\"}, \"minItems\": 12, \"maxItems\": 12}"),
    OWN("hz", put_frequencies,
        "Its lowest vibration modes, at most twelve [Hz]; empty in a report whose "
        "study does not ask for modes along the range.",
        .schema = "\"type\": \"array\", \"items\": {\"type\": [\"number\", \"null\"]}, "
                  "\"maxItems\": 12"),
    TEXT_OR_NULL("error", why, "Why there is nothing at this position; null: there is."),
};
#undef THIS
static const mt_scene_table POSITION = {.rows = POSITION_ROWS,
                                        .n = MT_COUNT(POSITION_ROWS),
                                        .size = sizeof(mt_scene_position),
                                        .flat = false,
                                        .says = "One position of the driven joint."};

#define THIS mt_scene_drive
static const mt_scene_row DRIVE_ROWS[] = {
    TEXT("joint", joint, "Its name."),
    OWN("unit", put_unit, "Of its positions.",
        .schema = "\"type\": \"string\", \"enum\": [\"rad\", \"m\"]"),
    NUMBER_OR_NULL("at", at, VALUE, "Where this configuration holds it; null: it does not."),
    TEXT_OR_NULL("error", why, "Why there are no positions; null: there are."),
    LIST("positions", positions, n_positions, mt_scene_position, POSITION, "Ascending."),
};
#undef THIS
static const mt_scene_table DRIVE = {.rows = DRIVE_ROWS,
                                     .n = MT_COUNT(DRIVE_ROWS),
                                     .size = sizeof(mt_scene_drive),
                                     .flat = false};

#define THIS mt_scene_view
static const mt_scene_row VIEW_ROWS[] = {
    TEXT("name", name, "Of the configuration."),
    TEXT_OR_NULL("error", error, "Why it has no modes, and perhaps no drawing; null: it has."),
    LIST("bodies", bodies, n_bodies, mt_scene_body, BODY,
         "The ground first, then bodies, then links as their elements or nodes; empty "
         "where there is no drawing."),
    LIST("points", points, n_points, mt_scene_point, POINT,
         "Points with names, where a body holds them."),
    LIST("lines", lines, n_lines, mt_scene_line, LINE,
         "What bodies are drawn as: from the mass centre, or along a link, to what they "
         "hold."),
    LIST("joints", joints, n_joints, mt_scene_joint, JOINT,
         "All joints but the hinges of links."),
    LIST("springs", springs, n_springs, mt_scene_spring, SPRING, "Links, then springs."),
    LIST("dampers", dampers, n_dampers, mt_scene_spring, DAMPER, "Dampers."),
    LIST("sensors", sensors, n_sensors, mt_scene_arrow, SENSOR,
         "One of each direction that a sensor reads."),
    LIST("loads", loads, n_loads, mt_scene_arrow, LOAD, "Loads that are forces on bodies."),
    NONE("rotors", ROTOR, "Directions of rotors; a model has none."),
    LIST("modes", modes, n_modes, mt_scene_mode, MODE,
         "At most twelve rigid-body, unstable and undecided ones, and the lowest twelve "
         "vibrations.",
         .limits = "\"maxItems\": 24"),
    OPTION("drive", drive, mt_scene_drive, DRIVE,
           "The range of a driven joint: from the lowest to the highest position that a "
           "configuration of the model drives it to."),
};
#undef THIS
static const mt_scene_table VIEW = {
    .rows = VIEW_ROWS,
    .n = MT_COUNT(VIEW_ROWS),
    .size = sizeof(mt_scene_view),
    .flat = false,
    .says = "One configuration at one design, where it comes to rest."};

#define THIS mt_scene_parameter
static const mt_scene_row PARAMETER_ROWS[] = {
    TEXT("name", name, "As in the model."),
    NUMBER("value", value, VALUE, "At this design."),
    TEXT_OR_NULL("unit", unit, "SI unit; null: none."),
    TEXT_OR_NULL("display_unit", display_unit,
                 "What people are shown the value in; null: in the unit itself."),
    NUMBER_OR_NULL("display_factor", display_factor, 0,
                   "How much of the unit that is: value / display_factor is shown; null: the "
                   "value."),
};
#undef THIS
static const mt_scene_table PARAMETER = {.rows = PARAMETER_ROWS,
                                         .n = MT_COUNT(PARAMETER_ROWS),
                                         .size = sizeof(mt_scene_parameter),
                                         .flat = true,
                                         .says = "A parameter."};

#define THIS mt_scene_design
static const mt_scene_row DESIGN_ROWS[] = {
    TEXT("label", label, "What it is; of several recommended designs with their rank.",
         .limits = "\"pattern\": \"^(original|as set|recommended(, rank [1-9][0-9]*)?)$\""),
    COUNT("rank", rank, "Of a recommended one; 0: none."),
    LIST("parameters", parameters, n_parameters, mt_scene_parameter, PARAMETER,
         "Of a model those that are plain numbers, of a result the variables."),
    VIEWS("configurations", views, n_views, mt_scene_view, VIEW,
          "Those that were asked for, in the model's order."),
};
#undef THIS
static const mt_scene_table DESIGN = {.rows = DESIGN_ROWS,
                                      .n = MT_COUNT(DESIGN_ROWS),
                                      .size = sizeof(mt_scene_design),
                                      .flat = false,
                                      .says = "A design."};

#define THIS mt_scene_off
static const mt_scene_row OFF_ROWS[] = {
    TEXT("configuration", configuration, "Where it is."),
    OWN("joint", put_off_name, "Its name.", .schema = "\"type\": \"string\""),
    OWN("type", put_off_type, "Its type.", .schema = "\"type\": \"string\""),
    TEXT_OR_NULL("body", body, "The body that is farther; null where the distance is 0."),
    OWN("distance", put_off_distance, "As in the configuration [m].",
        .schema = "\"type\": \"number\", \"minimum\": 0"),
};
#undef THIS
static const mt_scene_table OFF = {.rows = OFF_ROWS,
                                   .n = MT_COUNT(OFF_ROWS),
                                   .size = sizeof(mt_scene_off),
                                   .flat = true,
                                   .says = "A joint."};

#define THIS mt_scene
static const mt_scene_row SCENE_ROWS[] = {
    OWN("format", put_format, "Kind and version of this document.",
        .schema = "\"type\": \"string\", \"enum\": [\"modetune-scene/1\"]"),
    TEXT("model", name, "Name of the model; empty: none."),
    OWN("dimension", put_dimension, "Of the model.",
        .schema = "\"type\": \"integer\", \"enum\": [2, 3]"),
    NUMBER("size", size, PLACE_DIGITS, "Diagonal of the box around all that is drawn [m].",
           .limits = "\"minimum\": 0"),
    PLACE_IF("gravity", gravity, has_gravity,
             "Of the first configuration that has any [m/s^2]; null: none has."),
    LIST("designs", designs, n_designs, mt_scene_design, DESIGN,
         "The model as its file, or --set, has it; of a result the original design, "
         "then the recommended ones."),
    LIST("joints", joints, n_joints, mt_scene_off, OFF,
         "The joints of the first design, the farthest off what they join first."),
};
#undef THIS
const mt_scene_table mt_scene_members = {
    .rows = SCENE_ROWS,
    .n = MT_COUNT(SCENE_ROWS),
    .size = sizeof(mt_scene),
    .flat = false,
    .says =
        "What there is to see of a mechanism, as `modetune show --format json` prints it and "
        "its page draws it: for pictures, so that places have six significant digits and "
        "frequencies nine. SI units, ground coordinates, z = 0 in two dimensions. Bodies are "
        "numbered from the ground, 0."};

static mt_status write_scene(const mt_scene *scene, bool tight, mt_text *out, mt_err *err)
{
    mt_json_writer w = mt_json_writer_default(out);
    w.tight = tight;
    put_table(&w, NULL, &mt_scene_members, scene, NULL);
    if (mt_json_done(&w)) {
        return MT_OK;
    }
    return out->failed ? mt_fail_memory(err)
                       : mt_fail(err, MT_E_INTERNAL, "the scene is not a JSON document");
}

mt_status mt_scene_write(const mt_scene *scene, mt_text *out, mt_err *err)
{
    return write_scene(scene, false, out, err);
}

mt_status mt_scene_write_page(const mt_scene *scene, mt_text *out, mt_err *err)
{
    return write_scene(scene, true, out, err);
}
