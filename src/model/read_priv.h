/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_READ_PRIV_H
#define MODEL_READ_PRIV_H

#include "io/members.h"
#include "model/model.h"

/* Shared by the files read*.c: the reader and the model that it fills. */
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
/* Two names, as mt_attach bodies[2] and as mt_name[2] */
#define MT_I_TWO(label, function, m, ...)                                                  \
    {                                                                                      \
        .name = (label), .type = MT_KEY_LIST, .read = (function), .at = offsetof(THIS, m), \
        .least = 2, .most = 2, .says = __VA_ARGS__                                         \
    }
/* mt_presence in */
#define MT_I_IN                                                                             \
    {                                                                                       \
        .name = "in", .type = MT_KEY_LIST, MT_M_TO(mt_item_presence, mt_presence, in),      \
        .says = "Names of the configurations that contain this item; absent: all of them. " \
                "Configurations that are `like` one of them contain it as well."            \
    }
/* Structs that begin with their name (mt_name, of the form MT_NAME_...), and their number
 * (int): members of an object, each read by the table; read by mt_item_by_name, at last */
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
void mt_item_vector(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_position(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_at(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_bodies(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_names(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_presence(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_item_by_name(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_springs(mt_reader *r, const mt_key *key, mt_addr value, void *item);
void mt_read_parameters(mt_reader *r, const mt_key *key, mt_addr value, void *item);

extern const mt_key_table mt_model_keys;
extern const mt_key_table mt_parameter_keys;
extern const mt_key_table mt_body_keys;
extern const mt_key_table mt_link_keys;
extern const mt_key_table mt_section_keys;
extern const mt_key_table mt_shear_keys;
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

#endif
