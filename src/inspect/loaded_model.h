/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef INSPECT_LOADED_MODEL_H
#define INSPECT_LOADED_MODEL_H

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "mechanics/linear.h"
#include "mechanics/singular.h"
#include "model/model.h"
#include "result/record.h"

/* A model with values of its parameters, and the configurations to analyse. */
typedef struct mt_loaded_model {
    const mt_model *model;
    mt_model *own;     /* the same as read where it is owned, else NULL */
    const mt_run *run; /* the run of analyses of the model (base/run.h); NULL: none */
    mt_arena mem;
    const char *path;
    int n_set;
    int *set; /* parameters that --set gives values; those that decide cases are no inputs: the
               * model has their values */
    int n_inputs;
    int *inputs;      /* parameters */
    double *at;       /* their values */
    double *original; /* [n_parameters] values in the file */
    /* [n_parameters] with --set and dependent parameters updated; before overrides of
     * configurations */
    double *values;
    int n_configurations;
    int *configurations;
} mt_loaded_model;

/* Set the values "NAME=VALUE" and choose configurations: the named one, or all where the name
 * is NULL. Before: s->model, s->path, an initialised s->mem, the rest zeroed. Fails: MT_E_USAGE
 * (no such configuration or parameter), MT_E_INPUT (what the values make is no mechanism),
 * MT_E_DOMAIN, MT_E_MEMORY. mt_loaded_model_free in any case. */
mt_status mt_loaded_model_choose(mt_loaded_model *s, const char *configuration, int n_sets,
                                 const char *const *sets, mt_err *err);
void mt_loaded_model_free(mt_loaded_model *s);
/* A number of an option: a plain number in this unit (NULL: SI), or an expression of the
 * model's values, in SI. Fails: MT_E_USAGE, naming the option, MT_E_MEMORY. */
mt_status mt_loaded_model_number(mt_loaded_model *s, const char *option, const mt_unit *unit,
                                 const char *text, size_t length, double *out, mt_err *err);
/* The unit of numbers for the joint (or link's hinge) of this name: the model's unit of angles
 * or displacements, whichever the joint has. */
const mt_unit *mt_loaded_model_joint_unit(const mt_model *model, const char *name);
/* The parameters "A,B" of an option, or where list is NULL all that are not expressions of
 * others and that no condition of an if() depends on: *n of them in mem. Fails: MT_E_USAGE,
 * MT_E_INPUT (there are none), MT_E_MEMORY. */
mt_status mt_loaded_model_parameters(const mt_loaded_model *s, const char *option,
                                     const char *list, mt_arena *mem, int *n, int **out,
                                     mt_err *err);
/* Analyse configuration c for its `first` lowest vibration modes (0: all). Failures are
 * reported in err only. */
mt_status mt_loaded_model_analyse(const mt_loaded_model *s, int c, int first, mt_analysis **out,
                                  mt_err *err);
/* The lowest modes of configuration c at the given inputs, where only these are requested
 * (want.count > 0, at most half of all modes) and there is a fast method for a model of its
 * size. *out NULL: there is none, and all modes are needed; where these are too many,
 * MT_E_USAGE gives the reason. */
mt_status mt_loaded_model_lowest(const mt_loaded_model *s, int c, int n_inputs,
                                 const int *inputs, const double *at, mt_lowest_want want,
                                 mt_lowest **out, mt_err *err);
/* Names of the methods in JSON: "dense", "tree", "sparse". */
enum { MT_LOWEST_METHOD_NAMES = MT_LOWEST_SPARSE + 1 };
extern const char *const mt_lowest_method_names[MT_LOWEST_METHOD_NAMES];
/* The definition of configuration c with these inputs, in the run of the model. */
mt_system_def mt_loaded_model_system(const mt_loaded_model *s, int c, int n_inputs,
                                     const int *inputs, const double *at);
/* Fails with MT_E_USAGE where configuration c is too large for dense matrices; the text begins
 * with `why`, the reason for no other method. */
mt_status mt_loaded_model_admit_dense(const mt_loaded_model *s, int c, const char *why,
                                      mt_err *err);
const char *mt_loaded_model_configuration(const mt_loaded_model *s, int c);

/* The model's name of vibration mode `index` of configuration c; NULL: none. Valid at the
 * original design only. */
const char *mt_mode_name(const mt_loaded_model *s, int c, int index);

/* A configuration without an answer in a list of answers, with the reason. */
typedef struct mt_failed_row {
    const char *configuration;
    const char *error;
} mt_failed_row;
extern const mt_record mt_failed_record;

/* Names of joints as a list, for lists of such lists. */
typedef struct mt_joints_row {
    const char **name;
    int n;
} mt_joints_row;
extern const mt_record mt_joints_record;
/* In mem, which remembers a shortage. */
static inline mt_joints_row mt_joints_row_of(const mt_joint_names *joints, mt_arena *mem)
{
    mt_joints_row row = {.name = mt_arena_alloc(mem, (size_t)joints->n, sizeof *row.name)};
    for (; row.name != NULL && row.n < joints->n; row.n++) {
        row.name[row.n] = joints->name[row.n];
    }
    return row;
}

/* Sets of joints whose equations depend on each other: *n of them, *out not NULL, in mem. */
mt_status mt_redundant_rows(mt_linear *lin, mt_arena *mem, int *n, mt_joints_row **out,
                            mt_err *err);
/* A dead centre near a position. */
typedef struct mt_dead_centre_row {
    double distance;
    double independence;
    int n_joints;
    const char **joints;
} mt_dead_centre_row;
extern const mt_record mt_dead_centre_record;
/* NULL: none is near. In mem, which remembers a shortage. */
mt_dead_centre_row *mt_dead_centre_row_of(const mt_nearness *nearness, mt_arena *mem);

#endif
