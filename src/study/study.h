/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_STUDY_H
#define STUDY_STUDY_H

#include "modetune/study.h"

#include "base/diagnostics.h"
#include "environment/aircraft.h"
#include "io/json.h"
#include "measurement/measurement.h"
#include "model/count_box.h"
#include "model/model.h"
#include "study/catalogues.h"
#include "study/goals.h"
#include "study/objectives.h"
#include "study/published.h"
#include "study/references.h"
#include "study/trade.h"
#include "study/variables.h"

/*
 * A study of a model: variables, goals, objective, references, published values. Read and
 * checked by mt_study_load ("by finish": by the checks), then immutable. Numbers of a study are
 * expressions of the model's parameters evaluated once at the original design (plain doubles
 * here), except those that must follow the design: limit.expression, objective.expression,
 * published.quantity (mt_expr). NaN (nan("")) stands for "not given" in doubles.
 */

enum { MT_STARTS_MOST = 100000 };
typedef struct mt_search {
    unsigned long seed;
    int starts; /* 0: chosen from the number of variables */
    /* where starts is 0: starts end where those so far leave little hope of another design. Set
     * by a trade study, which also starts from neighbouring points */
    bool settles;
    /* starts end, too, where so many, among them a caller's, meet at one design (at equally
     * good ones where any of these will do); 0: they do not. Set by the caller that answers, at
     * a point of a trade study beside one that is answered, and for combinations */
    int agree;
    /* no design meets all goals: proven for a question that asks for less. Set as `agree` */
    bool impossible;
    long max_evaluations; /* evaluations of the whole answer at most; 0: no limit */
    /* modal solutions of the whole answer at most; 0: no limit. The caller that answers
     * converts it to evaluations and puts them into max_evaluations */
    long max_modal_solutions;
    /* modal solutions per evaluation where max_modal_solutions is given; 0: not given. Set by
     * the caller that answers */
    long solutions_each;
    long judged_as; /* evaluations that are charged for judging a design over its tolerances */
    bool by_solutions; /* the limit on modal solutions is reached before that on evaluations */
    /* positions, each an evaluation, at which a design may be followed along a drive; 0: as
     * many as the path needs. Set by the caller that answers */
    int max_positions;
    /* nominal seconds of each proof (prove/certify.h); 0: no proofs; NaN: not given */
    double proof_s;
} mt_search;

/* The name of the member of "search" whose limit is the budget. */
const char *mt_search_budget(const mt_search *s);

/* Sensitivity of the best design of a misfit to its weights: how far it moves when single
 * weights change. */
typedef struct mt_weight_sensitivity {
    /* factor by which each goal's weight is multiplied and divided in turn */
    double factor;
    mt_addr addr; /* MT_NO_ADDR: not requested */
} mt_weight_sensitivity;

typedef struct mt_input_file {
    const char *name;   /* relative to the study's folder */
    const char *sha256; /* hex */
} mt_input_file;

/* A number that overrides a number of the files. */
typedef struct mt_requested_number {
    const char *kind; /* "parameter" of the model; "search": member of the study's search */
    const char *name;
    const char *unit; /* of a parameter; NULL */
    const mt_unit *shown;
    double value;
    double original; /* the number in the files; NaN: none */
} mt_requested_number;

typedef struct mt_study {
    mt_arena mem;      /* owns everything but the models' own memory */
    mt_json *document; /* of its addresses, owned; NULL: made in memory */
    const char *path;
    const char *name;
    const char *description;
    const char *author; /* author, revision and date as written; NULL: not given */
    const char *revision;
    const char *date;
    mt_name model_path;
    const mt_model *model; /* the first of models */
    /* [n_models] owned: the study's own and those of references, each file once */
    mt_model **models;
    int n_models;
    int cap_models;
    /* units of numbers for parameters, by dimension; NULL: each parameter's own. The reader
     * converts the study's numbers to SI */
    const mt_unit *units[MT_DIMENSION_COUNT];
    /* [number of the model's parameters] values at the original design (model/values.h); made
     * by finish where NULL */
    double *original;
    MT_LIST_OF(mt_catalogue, catalogues); /* of parts */
    MT_LIST_OF(mt_variable, variables);
    MT_LIST_OF(mt_goal, goals);
    MT_LIST_OF(mt_reference, references);
    /* finish sets the responses of each that are used */
    MT_LIST_OF(mt_measurement, measurements);
    MT_LIST_OF(mt_objective, objectives);
    MT_LIST_OF(mt_published, published);
    MT_LIST_OF(mt_study_response, responses);
    mt_trade trade;
    /* the box of designs over which modes are counted (analysis.h): variables within their
     * bounds or catalogues, with their tolerances and the original values, and the quantities
     * of a trade study; by finish. Studies made from this one (points of a trade study, one
     * combination of a catalogue) keep it */
    mt_count_box counted;
    MT_LIST_OF(mt_study_profile, profiles); /* profiles that goals name, each once; owned */
    mt_name aircraft_path; /* path of the catalogue, read or unreadable (noted); s NULL: none */
    mt_aircraft_list aircraft;
    /* sentences for the result: values that are not confirmed, bands that were merged; by
     * finish */
    MT_LIST_OF(const char *, warnings);
    /* warnings about the study's own numbers, by the reader and by finish */
    mt_warning_list warning_list;
    mt_accepted accepted; /* accepted warnings, those of its model too */
    bool examined;        /* true for a point of a trade study: warnings were given already */
    int recommendations;  /* number of designs to report; default 5 */
    /* true where `recommendations` is given: others are wanted even where the original is the
     * best */
    bool alternatives;
    mt_search search;
    mt_weight_sensitivity weight_sensitivity;
    /* overrides, by the reader; already applied to model and search */
    MT_LIST_OF(mt_requested_number, asked);
    int n_inputs; /* files read: the study and the models */
    mt_input_file *inputs;
} mt_study;

/* The unit of numbers for this parameter of the study's model, in its file and for people: the
 * study's unit, else the parameter's own; NULL: SI. */
const mt_unit *mt_study_unit(const mt_study *study, int parameter);
/* The unit in which positions of this dimension are shown: the study's, else the model's; NULL:
 * SI. */
const mt_unit *mt_study_shown(const mt_study *study, mt_dimension dimension);
/* The unit in which a limit on an expression of a length, an angle or a speed is read and
 * shown: that of a parameter in it, else the study's. NULL: SI, or another dimension. The
 * expression itself is in SI. */
const mt_unit *mt_study_requirement_unit(const mt_study *study, const mt_expr *e);
/* Index by name; MT_ABSENT where there is none. */
int mt_study_find_reference(const mt_study *study, const char *name);
/* True where a goal names this configuration. */
bool mt_study_asks(const mt_study *study, int configuration);
/* The address of a member of an object of the study's file; the object's own without one. */
mt_addr mt_study_member(const mt_study *study, mt_addr object, const char *member);
/* Fill in the place of a warning's address, if known; its pointer lies in mem. */
void mt_study_place_warning(const mt_study *study, mt_arena *mem, mt_warning *warning);
/* The line and column of the value that the text's leading JSON pointer ("/goals/2: ...")
 * names; false where the text begins with none, or the study comes from no file. */
bool mt_study_locate(const mt_study *study, const char *text, int *line, int *column);

#endif
