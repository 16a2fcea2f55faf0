/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_LOADED_MODEL_H
#define CLI_LOADED_MODEL_H

#include "analysis/analysis.h"
#include "analysis/lowest.h"
#include "base/text.h"
#include "cli/args.h"
#include "model/model.h"

/* A model with the parameters that --set changes, and the configurations to look at. */
typedef struct mt_loaded_model {
    mt_model *model;   /* owned */
    const mt_run *run; /* of what is made of it; NULL: none */
    mt_arena mem;
    const char *path;
    int n_inputs;
    int *inputs;      /* parameters */
    double *at;       /* their values */
    double *original; /* [n_parameters] values in the file */
    double *values;   /* [n_parameters] with --set, dependent ones followed; before overrides */
    int n_configurations;
    int *configurations;
} mt_loaded_model;

/**
 * Load the model, apply --set, choose configurations: the named one, or all where the name is
 * NULL. Returns MT_EXIT_DONE or the exit status, everything said. mt_loaded_model_free in any
 * case (subject zeroed before).
 */
int mt_loaded_model_load(const mt_args *args, const char *path, const char *configuration,
                         mt_loaded_model *out);
void mt_loaded_model_free(mt_loaded_model *s);
/* A number of an option, alone in this unit (NULL: SI), or an expression of the model's values,
 * in SI. Fails: MT_E_USAGE, which names
 * the option, MT_E_MEMORY. */
mt_status mt_loaded_model_number(mt_loaded_model *s, const char *option, const mt_unit *unit,
                                 const char *text, size_t length, double *out, mt_err *err);
/* What the model gives angles or displacements in, whichever the joint of this name has (a
 * hinge of a link turns): the unit of numbers for it. */
const mt_unit *mt_loaded_model_joint_unit(const mt_model *model, const char *name);
/* The parameters "A,B" of an option, or where list is NULL all that are not made of others:
 * *n of them in mem. Fails: MT_E_USAGE, MT_E_INPUT (there are none), MT_E_MEMORY. */
mt_status mt_loaded_model_parameters(const mt_loaded_model *s, const char *option,
                                     const char *list, mt_arena *mem, int *n, int **out,
                                     mt_err *err);
/* Analyse configuration c for its `first` lowest vibration modes (0: all). A failure is left in
 * err. */
mt_status mt_loaded_model_analyse(const mt_loaded_model *s, int c, int first, mt_analysis **out,
                                  mt_err *err);
/* The lowest modes of configuration c where they are what is asked for (want.count; 0: they are
 * not, and no more than half of all) and there is a short way for a model of its size, at
 * inputs of its own. *out NULL: there is none, all modes are to be found; where these are too
 * many, MT_E_USAGE says why. */
mt_status mt_loaded_model_lowest(const mt_loaded_model *s, int c, int n_inputs,
                                 const int *inputs, const double *at, mt_lowest_want want,
                                 mt_lowest **out, mt_err *err);
/* "dense", "tree", "sparse": what JSON calls the way of an answer. */
const char *mt_cli_method(mt_lowest_method way);
/* Configuration c with these inputs, in the run of the model. */
mt_system_def mt_loaded_model_system(const mt_loaded_model *s, int c, int n_inputs,
                                     const int *inputs, const double *at);
/* MT_E_USAGE where configuration c is too large for dense matrices, led by why there is no
 * other way. */
mt_status mt_loaded_model_admit_dense(const mt_loaded_model *s, int c, const char *why,
                                      mt_err *err);
/* Warn where the configuration's own overrides win over --set. */
void mt_loaded_model_warn_overridden(const mt_loaded_model *s, int c);
/* What links of configuration c leave out, a note each, after an answer in text. */
void mt_loaded_model_note_links(const mt_loaded_model *s, int c, mt_text *out);
/* Warn where `option` moves another joint than the configuration's own drive, which is dropped
 * then: one joint is driven. */
void mt_loaded_model_warn_dropped(const mt_loaded_model *s, int c, const char *option,
                                  const char *joint);
const char *mt_loaded_model_configuration(const mt_loaded_model *s, int c);

/* Facts about the modes that several commands tell. */
/* 1-based index of the vibration mode at position pos; 0 for rigid-body, unstable and undecided
 * modes, and beside an undecided one. */
int mt_modes_index(const mt_modes *modes, int pos);
const char *mt_mode_kind_name(mt_mode_kind kind);
/* How many positions to show where `count` vibration modes are wanted (0: all): rigid-body and
 * unstable ones come on top. */
int mt_modes_shown(const mt_modes *modes, int count);
/* The name that the model gives to vibration mode `index` of configuration c; NULL. Only at the
 * original design. */
const char *mt_mode_name(const mt_loaded_model *s, int c, int index);

#endif
