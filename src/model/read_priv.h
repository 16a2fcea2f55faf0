/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MODEL_READ_PRIV_H
#define MODEL_READ_PRIV_H

#include "io/reader.h"
#include "model/model.h"

/* Shared by the files read_model*.c: the reader and the model that it fills. */
typedef struct mt_model_reader {
    mt_reader r;
    mt_model *m;
} mt_model_reader;

/* One list of keys makes the enum of their places and the table:
 *     #define POINT_KEYS(X) X(POINT_X, "x", NUMBER, true, ANY, "Its x.") ...
 *     enum { POINT_KEYS(MT_READ_ENUM) POINT_COUNT }; */
#define MT_READ_ENUM(id, ...) id,
#define MT_READ_KEY(id, label, kind, must, row, ...) \
    {.name = (label),                                \
     .type = MT_KEY_##kind,                          \
     .required = (must),                             \
     .possible = MT_POSSIBLE_##row,                  \
     .says = __VA_ARGS__},
#define MT_READ_TABLE(table, object, KEYS, ...)               \
    static const mt_key table##_keys[] = {KEYS(MT_READ_KEY)}; \
    const mt_key_table table = {                              \
        .what = (object), .keys = table##_keys, .n = MT_COUNT(table##_keys), __VA_ARGS__}

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

/* A number or expression of the model's parameters; MT_ABSENT where absent or wrong. */
mt_num mt_read_num(mt_model_reader *mr, mt_addr value);
/* As mt_read_num, a bare number in this unit; NULL: SI. */
mt_num mt_read_num_in(mt_model_reader *mr, mt_addr value, const mt_unit *unit);
/* A list of least..most entries, each a number; *n is their number (0 where absent or wrong).
 * With `single` a single number gives a list of one. */
mt_num *mt_read_nums(mt_model_reader *mr, mt_addr value, bool single, int least, int most,
                     int *n);
/* As many numbers as the model has dimensions; false (all x absent) where absent or wrong. */
bool mt_read_vector(mt_model_reader *mr, mt_addr value, mt_num x[3]);
/* As mt_read_vector, in the file's unit of length. */
bool mt_read_coordinates(mt_model_reader *mr, mt_addr value, mt_num x[3]);
/* The name of a point, or coordinates. An absent one has point MT_ABSENT and given false. */
mt_position mt_read_position(mt_model_reader *mr, mt_addr value);
/* One position, or the pair of positions on two bodies; returns their number. */
int mt_read_at(mt_model_reader *mr, mt_addr value, mt_position at[2]);
/* Two names of bodies or links; names NULL where absent or wrong. */
void mt_read_bodies(mt_model_reader *mr, mt_addr value, mt_attach bodies[2]);
mt_presence mt_read_presence(mt_model_reader *mr, mt_addr value);

/* Set the unit of a parameter's number, and that of its value, which is in SI. */
void mt_read_parameter_unit(mt_model_reader *mr, mt_addr value, mt_parameter *p);
/* Called when all but the configurations is read: decide the meaning of "g" for each parameter
 * by its uses, and note units of parameters that do not fit the members that use them. */
void mt_read_settle_units(mt_model_reader *mr);
/* Called when all is read: warn of numbers whose units are not those of their members
 * (unit_warning). */
void mt_read_warning_units(mt_model_reader *mr);

void mt_read_links(mt_model_reader *mr, mt_addr list);
void mt_read_joints(mt_model_reader *mr, mt_addr list);
void mt_read_springs(mt_model_reader *mr, mt_addr springs, mt_addr dampers);
void mt_read_loads(mt_model_reader *mr, mt_addr list);
void mt_read_sensors(mt_model_reader *mr, mt_addr list);
void mt_read_modes(mt_model_reader *mr, mt_addr object);
void mt_read_configurations(mt_model_reader *mr, mt_addr object);
/* The damping of the model or of a configuration; an absent one is marked as not given. */
mt_damping mt_read_damping(mt_model_reader *mr, mt_addr object);

#endif
