/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_TRADE_H
#define STUDY_TRADE_H

#include "study/goals.h"
#include "study/objectives.h"

/* A trade study: one or two quantities take each of their values (two: all pairs), and the
 * study is solved for its best design at each. */
typedef enum mt_vary_kind {
    MT_VARY_BOUND,    /* a bound of a variable */
    MT_VARY_GOAL,     /* a number of a goal */
    MT_VARY_PARAMETER /* a parameter that is no variable */
} mt_vary_kind;

typedef struct mt_vary {
    mt_vary_kind kind;
    mt_name name;  /* of the variable or parameter */
    int variable;  /* bound: index in the study's variables */
    bool upper;    /* bound: true for the upper one */
    int parameter; /* parameter: of the model */
    int goal;      /* goal: index in the study's goals */
    /* goal: name of its number; NULL: invalid, which the reader has noted */
    const char *member;
    mt_goal_slot slot; /* that number; MT_SLOT_NONE: the goal has none; by finish */
    int n_values;
    double *values;   /* [n_values] in the order given; in the unit of what varies */
    const char *text; /* "upper bound of M_SAU", "target_hz of goal 1": by finish */
    mt_addr addr;
} mt_vary;

enum { MT_MAX_VARY = 2, MT_MAX_TRADE_POINTS = 10000 };

typedef struct mt_trade {
    int n_vary; /* 0: there is no trade study */
    mt_vary vary[MT_MAX_VARY];
    int n_objectives; /* 0 or 2: of the Pareto front */
    mt_objective_type objectives[2];
    mt_addr addr;
} mt_trade;

/* Every optional member is MT_ABSENT. */
mt_vary mt_vary_default(mt_vary_kind kind, mt_addr addr);

extern const mt_key_table mt_study_trade_keys;
extern const mt_key_table mt_study_vary_keys;
extern const mt_key_table mt_study_span_keys;

struct mt_study_reader;
struct mt_study_check;
/* Call it after variables and goals; goals: the list of goals, whose indices it uses. */
void mt_read_study_trade(struct mt_study_reader *s, mt_addr value, mt_addr goals);
/* The last of the checks. */
void mt_study_check_trade(struct mt_study_check *c);

#endif
