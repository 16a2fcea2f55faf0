/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_ITEM_H
#define MODEL_ITEM_H

#include "io/members.h"
#include "model/model.h"

/*
 * What the items of a model are made of and have in common: the rows of their tables and how
 * they are read, and what resolves their names. Each kind of item stands in its item_*.c: its
 * table, what reads it, and its checks.
 */
/* The reader, and the model that it fills. */
typedef struct mt_model_reader {
    mt_reader r;
    mt_model *m;
} mt_model_reader;

/* The reader of a model that this is the first part of. */
mt_model_reader *mt_model_reader_of(mt_reader *r);

/*
 * Rows of the tables of items (io/members.h), with THIS for the struct. Their tables have
 * `.absent`: a number that is not given is MT_ABSENT without anybody saying so.
 */
/* NOLINTBEGIN(bugprone-macro-parentheses): types are not put into parentheses */
/* What the table of a struct says */
#define MT_I_TABLE(label, rows, item) \
    .what = (label), .keys = (rows), .n = MT_COUNT(rows), .size = sizeof(item), .absent = true

/* The JSON Schema of an object of items by name */
#define MT_I_NAMES_ITEM  "\"propertyNames\": {\"pattern\": \"^[A-Za-z_][A-Za-z0-9_+-]*$\"}, "
#define MT_I_NAMES_WORD  "\"propertyNames\": {\"pattern\": \"^[A-Za-z_][A-Za-z0-9_]*$\"}, "
#define MT_I_NAMES_TITLE "\"propertyNames\": {\"minLength\": 1}, "
#define MT_I_BY_NAME(names, item) \
    "\"type\": \"object\", " names "\"additionalProperties\": {" item "}"
#define MT_I_OF(definition) "\"$ref\": \"#/definitions/" definition "\""

/* mt_name name */
#define MT_I_NAME(what)                                                                   \
    {                                                                                     \
        .name = "name", .type = MT_KEY_TEXT, .required = true,                            \
        MT_M_TO(mt_item_name, mt_name, name),                                             \
        .says = "Name of the " what ": a letter or _, then letters, digits, _, + and -.", \
        .pattern = "^[A-Za-z_][A-Za-z0-9_+-]*$"                                           \
    }
/* mt_num */
#define MT_I_NUM(label, must, m, row, ...)                                         \
    {                                                                              \
        .name = (label), .type = MT_KEY_NUMBER, .required = (must), MT_M_ROW(row), \
        MT_M_TO(mt_item_num, mt_num, m), .says = __VA_ARGS__                       \
    }
/* mt_num * and its length (int), of from .. to entries: a list, or (NUMBER_OR_LIST) a number
 * that stands for a list of one */
#define MT_I_NUMS(label, kind, m, count, row, from, to, ...)                                  \
    {                                                                                         \
        .name = (label), .type = MT_KEY_##kind, MT_M_ROW(row),                                \
        MT_M_TO(mt_item_nums, mt_num *, m), .other = MT_M_PLACE(int, count), .least = (from), \
        .most = (to), .says = __VA_ARGS__                                                     \
    }
/* mt_vector, and whether it is given (bool) */
#define MT_I_VECTOR(label, m, given, row, ...)                                   \
    {                                                                            \
        .name = (label), .type = MT_KEY_LIST, MT_M_ROW(row),                     \
        MT_M_TO(mt_item_vector, mt_vector, m), .other = MT_M_PLACE(bool, given), \
        .says = __VA_ARGS__, .schema = "\"allOf\": [{" MT_I_OF("vector") "}]"    \
    }
#define MT_I_POSITION(label, must, m, ...)                                                 \
    {                                                                                      \
        .name = (label), .type = MT_KEY_TEXT_OR_LIST, .required = (must), MT_M_ROW(POINT), \
        MT_M_TO(mt_item_position, mt_position, m), .says = __VA_ARGS__                     \
    }
/* mt_position at[2], and int n_at: one position, or the pair of positions on two bodies */
#define MT_I_AT                                                                           \
    {                                                                                     \
        .name = "at", .type = MT_KEY_TEXT_OR_LIST, MT_M_ROW(POINT), .read = mt_item_at,   \
        .at = offsetof(THIS, at), .other = MT_M_PLACE(int, n_at), .schema = MT_I_OF("at") \
    }
/* mt_loss loss */
#define MT_I_LOSS(...)                                                                   \
    {                                                                                    \
        .name = "loss_factor", .type = MT_KEY_NUMBER_OR_LIST, MT_M_ROW(LOSS),            \
        MT_M_TO(mt_item_loss, mt_loss, loss), .least = 3, .most = 6, .says = __VA_ARGS__ \
    }
/* mt_axes axes */
#define MT_I_AXES MT_M_PART("axes", false, axes, mt_axes, mt_axes_keys, NULL)
/* Two names: mt_name[2], or structs that begin with it (mt_attach[2]) */
#define MT_I_TWO(label, m, ...)                                                               \
    {                                                                                         \
        .name = (label), .type = MT_KEY_LIST, .read = mt_item_names, .at = offsetof(THIS, m), \
        .other = sizeof(((THIS *)NULL)->m[0]), .least = 2, .most = 2, .says = __VA_ARGS__     \
    }
/* mt_presence in */
#define MT_I_IN                                                                             \
    {                                                                                       \
        .name = "in", .type = MT_KEY_LIST, MT_M_TO(mt_item_presence, mt_presence, in),      \
        .says = "Names of the configurations that contain this item; absent: all of them. " \
                "Configurations that are `like` one of them contain it as well."            \
    }
/* Structs that begin with their name (mt_name, of the form MT_NAME_...), and their number
 * (int): members of an object, each read by the table */
#define MT_I_NAMED(label, function, m, item_type, form, table, ...)                \
    {                                                                              \
        .name = (label), .type = MT_KEY_OBJECT, MT_M_TO(function, item_type *, m), \
        .other = MT_M_PLACE(int, n_##m), .of = &(table), .least = MT_NAME_##form,  \
        .says = __VA_ARGS__                                                        \
    }
/* mt_origin origin */
#define MT_I_ORIGIN                                                                  \
    MT_M_CHOICE("origin", false, origin, mt_origin, "origin", mt_origin_names, NULL, \
                .least = MT_ORIGIN_NONE + 1, .schema = MT_I_OF("origin"))
/* NOLINTEND(bugprone-macro-parentheses) */
extern const char *const mt_origin_names[MT_ORIGIN_ASSUMED];
void mt_item_name(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_num(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_nums(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_loss(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_vector(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_position(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_at(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_names(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_presence(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_curves(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_parameters(mt_reader *r, const mt_key *key, mt_addr value, void *item);

extern const mt_key_table mt_model_keys;
extern const mt_key_table mt_parameter_keys;
extern const mt_key_table mt_curve_keys;
extern const mt_key_table mt_body_keys;
extern const mt_key_table mt_link_keys;
extern const mt_key_table mt_axes_keys;
extern const mt_key_table mt_section_keys;
extern const mt_key_table mt_shear_keys;
extern const mt_key_table mt_compliance_keys;
extern const mt_key_table mt_joint_keys;
extern const mt_key_table mt_spring_keys;
extern const mt_key_table mt_damper_keys;
extern const mt_key_table mt_load_keys;
extern const mt_key_table mt_sensor_keys;
extern const mt_key_table mt_mode_keys;
extern const mt_key_table mt_configuration_keys;
extern const mt_key_table mt_drive_keys;
extern const mt_key_table mt_hold_keys;
extern const mt_key_table mt_damping_keys;
extern const mt_key_table mt_include_keys;
extern const mt_key_table mt_rotate_keys;
extern const mt_key_table mt_repeat_keys;
extern const mt_key_table mt_polar_keys;
extern const mt_key_table mt_linear_keys;
extern const mt_key_table mt_mirror_keys;

/* A number or expression of the model's parameters, of this row of what is possible, a bare
 * number in this unit (NULL: SI); MT_ABSENT where absent or wrong. */
mt_num mt_read_num(mt_model_reader *mr, mt_addr value, mt_possible_id possible,
                   const mt_unit *unit);
/* The numbers of a member of MT_I_NUMS or an item of it; *n is their number (0 and NULL where
 * absent or wrong). */
mt_num *mt_read_nums(mt_model_reader *mr, const mt_key *key, mt_addr value, int *n);
/* As many numbers as the model has dimensions, in the file's unit of length; all MT_ABSENT
 * where absent or wrong. */
void mt_read_coordinates(mt_model_reader *mr, mt_addr value, mt_vector x);

/* Called when all but the configurations is read: decide the meaning of "g" for each parameter
 * by its uses, and note units of parameters that do not fit the members that use them. */
void mt_read_settle_units(mt_model_reader *mr);
/* Called when all is read: warn of numbers whose units are not those of their members
 * (unit_warning). */
void mt_read_warning_units(mt_model_reader *mr);

/* While a model is resolved and checked. Problems go to diags,
 * and a shortage of memory to the model's arena; the functions return no status. */
typedef struct mt_resolve {
    mt_model *m;
    mt_diags *d;
    int *order; /* [n_configurations], each after the one that it is like */
} mt_resolve;

/* Index of a name in a table; MT_ABSENT where it is unknown, with the error: unknown `what`
 * "x"; did you mean "y"? An absent name gives MT_ABSENT without an error. */
int mt_resolve_find(mt_resolve *f, mt_name name, const mt_names *table, const char *what);
void mt_resolve_position(mt_resolve *f, mt_position *p);
/* Check which members the axes of an item, `what` "spring", have. */
void mt_resolve_axes(mt_resolve *f, mt_name name, const char *what, const mt_axes *a);
/* Resolve an attachment. */
void mt_resolve_attach(mt_resolve *f, mt_attach *a);
/* True where both attach to the same part. */
bool mt_resolve_same_attach(const mt_attach *a, const mt_attach *b);
/* True where the body is a point mass. */
bool mt_resolve_is_point_mass(const mt_resolve *f, const mt_attach *a);
/* True where two positions are written the same way and so are equal for all parameters. */
bool mt_resolve_same_position(const mt_model *m, const mt_position *a, const mt_position *b);
/* Check that a part of an item is present in every configuration of the item; `what`
 * "joint". */
void mt_resolve_needs(mt_resolve *f, mt_name item, const char *what, const mt_presence *in,
                      const mt_presence *part, const char *part_what, const char *part_name);
void mt_resolve_needs_attach(mt_resolve *f, mt_name item, const char *what,
                             const mt_presence *in, const mt_attach *part);
/* Text "a -> b -> c -> a" of a cycle, of limited length: a long cycle is cut to its first and
 * last names. Initialise .first, then add the other names in order. */
enum { MT_RING_NAME = 48, MT_RING_FIRST = 8, MT_RING_LAST = 4, MT_RING_TEXT = 1024 };
typedef struct mt_resolve_ring {
    const char *first;
    int count;                        /* names added */
    const char *start[MT_RING_FIRST]; /* the first names added */
    const char *last[MT_RING_LAST];   /* the last names added: number i at i % MT_RING_LAST */
    char text[MT_RING_TEXT];
} mt_resolve_ring;
void mt_resolve_ring_add(mt_resolve_ring *ring, const char *name);
/* Write ring->text. */
void mt_resolve_ring_end(mt_resolve_ring *ring);
/* The address of a number; MT_NO_ADDR where it is absent. */
mt_addr mt_resolve_addr(const mt_model *m, mt_num num);

/* The stages, in order. */
void mt_resolve_configurations(mt_resolve *f);
void mt_resolve_links(mt_resolve *f);
void mt_resolve_joints(mt_resolve *f);
void mt_resolve_forces(mt_resolve *f);
void mt_resolve_sensors(mt_resolve *f);
void mt_resolve_drives(mt_resolve *f);
void mt_resolve_cycles(mt_resolve *f);

#endif
