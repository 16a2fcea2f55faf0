/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_MADE_FROM_H
#define RESULT_MADE_FROM_H

#include <stdbool.h>

/*
 * The origin of a result: study and model with their names and authors, the files, the program
 * and its libraries, and the work done. Texts live in the result's arena; members as in
 * result.h.
 */

typedef struct mt_result_source {
    const char *name; /* NULL: the file gives none */
    const char *file;
} mt_result_source;

/* Name, file and author of the study; NULL: not given. */
typedef struct mt_result_study {
    const char *name;
    const char *file; /* file name without folder */
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
    double value;       /* value in the model */
    const char *source; /* NULL: the model gives none */
    bool variable;      /* true: a variable of the study */
} mt_result_assumption;

/* A file that the result names with the SHA-256 of its bytes. */
typedef struct mt_result_digest {
    const char *file;
    const char *sha256; /* hexadecimal */
} mt_result_digest;

/* The sources and the compiler of the program. */
typedef struct mt_result_build {
    const char *commit; /* "unknown" where the sources were not in a repository */
    const char *compiler;
} mt_result_build;

/* A number that overrides a number of the files. */
typedef struct mt_result_override {
    const char *kind; /* "parameter" of the model, "search": member of the study's search */
    const char *name;
    const char *unit;         /* NULL: none given */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value;
    double original; /* number in the files; NaN: none */
} mt_result_override;

/* The work of an answer by purpose: evaluations of a design in all configurations, or at one
 * more position of a drive; run.evaluations is their sum (without multiplications). */
typedef struct mt_result_work_counters {
    long search;
    long positions;    /* positions of drives at which a design was followed */
    long descriptions; /* repeated analyses of the original design and of those recommended */
    long weight_sensitivity;
    long relaxations;
    long trade;           /* all points of a trade study, with all of the work of each */
    long multiplications; /* of proofs, approximate */
} mt_result_work_counters;

/* A design of a search that was better than all before it. */
typedef struct mt_result_step {
    int objective;    /* index of the minimised objective, from 1 */
    int round;        /* from 1; later rounds use tighter accuracy or more conditions */
    long evaluations; /* evaluations so far, counted as if one worker had done all of them */
    double value;     /* value of that objective, as in mt_design_objective; NaN: none */
    double violation; /* largest violation of a goal or bound, relative to its tolerance */
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
    /* solutions of one configuration at a design, a position or a tolerance corner, for the
     * evaluations and the check over tolerances */
    long modal_solutions;
    mt_result_work_counters spent;
    int starts;
    /* of a search from several starts; -1, NaN: not applicable */
    int distinct_designs;
    int singletons; /* designs that only one start reached */
    /* estimated lower bound of the isolated designs that no start reached */
    double estimated_unseen;
    int n_history; /* 0: nothing was searched, or an interrupt cut it */
    mt_result_step *history;
    int n_overrides;
    mt_result_override *overrides;
    int n_inputs;
    mt_result_digest *inputs;
    int n_outputs; /* files written next to the result; 0: none */
    mt_result_digest *outputs;
    /* phases that an interrupt cut, by the names of their members in the result ("search",
     * ...) */
    int n_incomplete;
    const char **incomplete;
    const char *cut_by; /* "interrupt" | "time limit"; NULL: nothing was cut */
} mt_result_run;

#endif
