/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef IO_READ_STUDY_PRIV_H
#define IO_READ_STUDY_PRIV_H

#include "io/options.h"
#include "io/read_aircraft.h"
#include "io/read_model.h"
#include "io/reader.h"
#include "study/study.h"

/* A model file that has been asked for. */
typedef struct mt_study_file {
    mt_name path;          /* as written */
    const mt_model *model; /* NULL: it could not be read, which has been noted */
} mt_study_file;

/* A study being read: what its parts (read_study_*.c) share. */
typedef struct mt_study_reader {
    mt_reader r;
    mt_study *study;
    mt_io_options files;            /* for the models; root is set */
    mt_diagnostics *model_messages; /* diagnostics of the model files */
    /* MT_OK, or why a model could not be read; only MT_E_INPUT lets reading go on */
    mt_status failed;
    mt_err why; /* the first such failure */
    MT_LIST_OF(mt_study_file, read);
} mt_study_reader;

/* One list of keys makes their places in `found` and the table. */
#define MT_STUDY_KEY_ENUM(id, ...) id,
#define MT_STUDY_KEY(id, label, kind, ...) \
    {.name = (label), .type = (kind), MT_KEY_REST(__VA_ARGS__)},

/* An object matched with its table: the address of every member (MT_NO_ADDR: absent or of a
 * wrong type). */
typedef struct mt_study_object {
    mt_addr addr;
    const mt_key_table *table;
    mt_addr found[MT_MAX_KEYS];
} mt_study_object;
bool mt_read_study_object(mt_study_reader *s, mt_addr value, const mt_key_table *table,
                          mt_study_object *out);
/* Whether the member is there, be it of a wrong type; then its address, else the object's. */
bool mt_read_study_has(const mt_study_reader *s, const mt_study_object *o, int key);
mt_addr mt_read_study_place(const mt_study_reader *s, const mt_study_object *o, int key);
/* The one of n members (neighbours in the table, from `first`) that is there; MT_ABSENT where
 * none or several are (noted). */
int mt_read_study_one_of(mt_study_reader *s, const mt_study_object *o, int first, int n);

/* A number; expressions are evaluated at the original design. NaN where absent or wrong
 * (noted). What it cannot be, or hardly is, by the row of its member, is noted. */
double mt_read_study_number(mt_study_reader *s, mt_addr value);
/* A member that is a number, and its place. */
double mt_read_study_member(mt_study_reader *s, const mt_study_object *o, int key,
                            mt_addr *place);
/* What is a value of a parameter of the model (of any name): a bare number in the study's unit
 * of its kind or in its own. In SI, NaN as above. */
double mt_read_study_value(mt_study_reader *s, mt_addr value, const char *parameter);
/* Such a member, and its place. */
double mt_read_study_value_member(mt_study_reader *s, const mt_study_object *o, int key,
                                  const char *parameter, mt_addr *place);
/* The unit that bare numbers for the parameter are in; NULL: SI, or it is not known. */
const mt_unit *mt_read_study_unit(const mt_study_reader *s, const char *parameter);
/* A number that an expression is held against is in SI: noted where it is bare and looks like
 * one of another unit. */
void mt_read_study_check_requirement(mt_study_reader *s, const mt_expr *of, mt_addr value);
/* An expression that follows the design, and its text. */
void mt_read_study_expr(mt_study_reader *s, mt_addr value, mt_expr *out, const char **text);
/* "mode": a name or an index from 1. */
mt_mode_ref mt_read_study_mode(mt_study_reader *s, const mt_study_object *o, int key);
/* An index from 1; 0 where absent or wrong. */
int mt_read_study_index(mt_study_reader *s, mt_addr value);
/* Load a model that the study names, once; NULL where it cannot be read (noted). */
const mt_model *mt_read_study_model(mt_study_reader *s, mt_name path);
/* A list of two numbers, lower and upper, a member or an item of it; false (noted) where it is
 * anything else. Numbers that are wrong are NaN. */
bool mt_read_study_pair(mt_study_reader *s, mt_addr member, mt_addr value, double out[2]);
/* Remember a file that was read, with the digest of its bytes. */
void mt_read_study_note_input(mt_study_reader *s, const char *name, const char *sha256);
/* A file was refused: its own diagnostics tell (`told`), or, where there are none, the address
 * of `path` in the study does: also where `file`, the path joined, leads to nothing. What is
 * there and cannot be read is no fault of the study's. */
void mt_read_study_note_failure(mt_study_reader *s, mt_name path, const char *file,
                                mt_status rc, const mt_err *why, bool told);

void mt_read_study_variables(mt_study_reader *s, mt_addr list);
void mt_read_study_references(mt_study_reader *s, mt_addr object);
void mt_read_study_measurements(mt_study_reader *s, mt_addr object);
/* What a goal on ports has that is compared with one. */
void mt_read_study_measured(mt_study_reader *s, const mt_study_object *o, mt_goal *goal);
void mt_read_study_goals(mt_study_reader *s, mt_addr list);
/* A profile of vibration that the study names, each read once; NULL: there is no name, or it
 * could not be read (noted). */
const mt_vibration *mt_read_study_profile(mt_study_reader *s, mt_name name);
/* What a goal that is about ports has besides. */
void mt_read_study_response_limit(mt_study_reader *s, const mt_study_object *o, mt_goal *goal);
void mt_read_study_rotor(mt_study_reader *s, mt_addr value, mt_rotor *rotor);
void mt_read_study_machine(mt_study_reader *s, mt_addr value, mt_machine *machine);
/* The catalogue of aircraft: the one named, else, where a goal needs one, the one beside the
 * model, else the one that is part of the program. After the goals. */
void mt_read_study_aircraft(mt_study_reader *s, mt_addr value);
/* After variables and goals; goals: the list of goals, whose indices it uses. */
void mt_read_study_trade(mt_study_reader *s, mt_addr value, mt_addr goals);
void mt_read_study_objectives(mt_study_reader *s, mt_addr value);
void mt_read_study_responses(mt_study_reader *s, mt_addr list);
void mt_read_study_published(mt_study_reader *s, mt_addr list);

extern const mt_key_table mt_study_keys;
extern const mt_key_table mt_study_search_keys;
extern const mt_key_table mt_study_weight_sensitivity_keys;
extern const mt_key_table mt_study_variable_keys;
extern const mt_key_table mt_study_catalogue_keys;
extern const mt_key_table mt_study_trade_keys;
extern const mt_key_table mt_study_vary_keys;
extern const mt_key_table mt_study_span_keys;
extern const mt_key_table mt_study_reference_keys;
extern const mt_key_table mt_study_measured_keys;
extern const mt_key_table mt_study_measurement_keys;
extern const mt_key_table mt_study_goal_keys[MT_GOAL_TYPE_COUNT]; /* by kind */
extern const mt_key_table mt_study_rotor_keys;
extern const mt_key_table mt_study_tail_keys;
extern const mt_key_table mt_study_machine_keys;
extern const mt_key_table mt_study_gear_keys;
extern const mt_key_table mt_study_objective_keys;
extern const mt_key_table mt_study_response_keys;
extern const mt_key_table mt_study_published_keys;
extern const mt_key_table mt_study_published_frequency_keys;
extern const mt_key_table mt_study_published_mac_keys;

#endif
