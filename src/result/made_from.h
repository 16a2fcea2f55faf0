/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_MADE_FROM_H
#define RESULT_MADE_FROM_H

#include <stdbool.h>

/*
 * What a result was made from: the question and the model with what they say of themselves,
 * the files, the program and its libraries, and what the answer cost. Texts live in the
 * result's arena; members as in result.h.
 */

typedef struct mt_result_source {
    const char *name; /* NULL: the file gives none */
    const char *file;
} mt_result_source;

/* Who asked, as the study says it; NULL: it does not. */
typedef struct mt_result_study {
    const char *name;
    const char *file; /* its file name, without folder */
    const char *author;
    const char *revision;
    const char *date;
} mt_result_study;

/* A parameter of the model whose value is assumed: neither published nor identified. */
typedef struct mt_result_assumption {
    const char *parameter;
    const char *unit;         /* may be NULL */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value;       /* as the model has it */
    const char *source; /* NULL: the model gives none */
    bool variable;      /* the study may change it */
} mt_result_assumption;

/* A file that the result names with the SHA-256 of its bytes. */
typedef struct mt_result_digest {
    const char *file;
    const char *sha256; /* hexadecimal */
} mt_result_digest;

/* What the program was made from. */
typedef struct mt_result_build {
    const char *commit; /* "unknown" where the sources were no repository */
    const char *compiler;
} mt_result_build;

/* A number that was asked for instead of what the files say. */
typedef struct mt_result_override {
    const char *kind; /* "parameter" of the model, "search": member of the study's search */
    const char *name;
    const char *unit;         /* NULL: none given */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value;
    double original; /* what the files say; NaN: nothing */
} mt_result_override;

/* What an answer cost: evaluations of a design in all configurations, or of one more position
 * of a drive, by what they were for; run.evaluations is their sum. */
typedef struct mt_result_work_counters {
    long search;
    long positions;    /* of drives, wherever a design was followed */
    long descriptions; /* analyses anew of the original design and of those recommended */
    long weight_sensitivity;
    long relaxations;
    long trade;           /* all points, with all of this */
    long multiplications; /* of proofs, about */
} mt_result_work_counters;

/* A design that a search met that was better than all before it. */
typedef struct mt_result_step {
    int objective;    /* that was made least, from 1 */
    int round;        /* from 1: what follows counts more closely, or under more conditions */
    long evaluations; /* up to there, as if one worker had done all of it */
    double value;     /* of that objective, as mt_design_objective has it; NaN: none */
    double violation; /* the most that a goal or bound is missed by, of its tolerance */
    bool feasible;
} mt_result_step;

typedef struct mt_result_run {
    const char *modetune_version;
    mt_result_build build;
    const char *blas;
    const char *nlopt_version;
    const char *gsl_version;
    long seed;
    long evaluations;
    /* of one configuration at a design, a position or a corner of tolerances each: what the
     * evaluations and the judgement over tolerances took */
    long modal_solutions;
    mt_result_work_counters spent;
    int starts;
    /* of a search from starts; -1, NaN: not applicable */
    int distinct_designs;
    int singletons;          /* of them, by one start only */
    double estimated_unseen; /* isolated designs that no start met, at least */
    int n_history;           /* 0: nothing was searched, or an interrupt cut it */
    mt_result_step *history;
    int n_overrides;
    mt_result_override *overrides;
    int n_inputs;
    mt_result_digest *inputs;
    int n_outputs; /* files written beside the result; 0: it is written alone */
    mt_result_digest *outputs;
    /* phases that an interrupt cut, by the names of what they write ("search", ...) */
    int n_incomplete;
    const char **incomplete;
    const char *cut_by; /* "interrupt" | "time limit"; NULL: nothing was cut */
} mt_result_run;

#endif
