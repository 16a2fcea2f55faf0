/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_RESULT_H
#define RESULT_RESULT_H

#include "modetune/study.h"

#include <stdbool.h>

#include "base/arena.h"
#include "base/diagnostics.h"
#include "result/curves.h"
#include "result/made_from.h"
#include "result/record.h"

/*
 * The answer of a study: plain records, no computation. All texts live in the result's arena.
 * NaN: not applicable (null in JSON). Each member has its line in the tables of
 * result_tables.c, which drive writer, reader and copier and from which
 * schemas/result.schema.json is written.
 */

typedef struct mt_result_parameter {
    const char *name;
    const char *unit; /* may be NULL */
    /* unit in which its numbers are shown, and its size in `unit`: shown value = value /
     * factor; NULL, NaN: `unit` itself */
    const char *display_unit;
    double display_factor;
    double original;
    double recommended;
    double change_percent; /* NaN where original is 0 */
    const char *at_bound;  /* NULL, "lower", "upper" */
    double lower;          /* its bounds; of a catalogue its least and greatest value */
    double upper;
    /* measure of its change: ln(new/original), "logarithmic"; the same with a floor;
     * "linear" */
    const char *measure;
    /* below this value the logarithm continues as its tangent; NaN: no floor */
    double measure_floor;
    double measure_scale; /* of a linear measure: (new - original)/scale; NaN: not linear */
    /* where it comes from a row of a catalogue of parts: the catalogue, and the row by its name
     * or as "row 3"; NULL: it does not */
    const char *catalogue;
    const char *part; /* NULL, too, at the original design where that is no row */
} mt_result_parameter;

typedef struct mt_result_frequency {
    const char *configuration;
    int mode;             /* vibration index at this design */
    const char *name;     /* named mode; NULL */
    const char *identity; /* of a named mode: "tracked", "ambiguous", "lost"; NULL */
    double share;         /* share of the named shape in this mode; NaN without a name */
    int rival_mode;       /* the mode with the largest share of the rest; 0: none */
    double rival_share;
    double original_hz;
    double recommended_hz;
    double target_hz; /* NaN: no target */
    double at_least_hz;
    double at_most_hz;
    double error_percent;  /* from the target, or beyond the limit; 0 inside limits */
    double mac;            /* NaN: no reference shape requested */
    const char *reference; /* NULL */
    double lowest_hz;      /* over the tolerances of the variables; NaN: no tolerances */
    double highest_hz;
    double residual; /* LAPACK-style ratio of this mode */
    double orthogonality;
    /* [n_parameters] Hz per unit of each variable; NaN at a repeated mode; NULL: not
     * computed */
    double *sensitivity;
    bool repeated;
    /* of a vibration of 0 Hz (not written; reasons use it): the springs of zero stiffness that
     * could hold it, "" where none could; NULL: the mode is held */
    const char *slack;
} mt_result_frequency;

/* A goal judged at a design: about one mode in one configuration, the bands of one
 * configuration, the motion of a drive between its named positions, or an expression. */
typedef struct mt_result_goal {
    const char *text;          /* "installed mode 1 at 18 Hz" */
    const char *quantity;      /* its limited quantity: "installed mode 1" */
    const char *pointer;       /* "/goals/0" */
    const char *type;          /* name in files: "frequency" */
    const char *configuration; /* NULL: none, or several */
    int mode;                  /* index of the mode that the goal names; 0: by name, or none */
    const char *name;          /* name of the mode that the goal names; NULL */
    const char *of_configuration; /* of the other mode of two; NULL: there is none */
    long of_mode;                 /* its index; 0: by name, or none */
    const char *of_name;          /* its name; NULL */
    const char *reference;        /* reference or measurement to compare with; NULL */
    const char *expression;       /* of a limit; NULL */
    /* unit of value, target and limits; "": none; NULL: the expression's own */
    const char *unit;
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value;
    double target; /* NaN: limits only; of a shape: distance 0 */
    double at_least;
    double at_most;
    double tolerance_percent; /* largest violation that counts as met */
    double violation_percent;
    bool met;
    bool weighted; /* part of the objective (misfit or vibration): does not decide the status */
    bool doubtful; /* its named mode is ambiguous or lost: not met, for any value */
    /* the worst value over the tolerances of the variables, by which the goal is judged; NaN:
     * none */
    double worst;
    double *worst_at; /* [n_parameters] variables at the worst value; NULL: none */
    /* [n_parameters] derivative of the value per unit of each variable; NULL: not available (a
     * repeated mode, or a distance) */
    double *sensitivity;
    /* of a frequency response: the measured line of the largest deviation; NaN: none */
    double off_most_hz;
    double off_most_ratio; /* computed over measured magnitude */
    double off_most_phase_deg;
} mt_result_goal;

/* The clearance of a mode from a band. */
typedef struct mt_result_clearance {
    const char *configuration;
    const char *band; /* its label: "4P of UH-60" */
    int band_id;      /* as in mt_result_mode_placement */
    int mode;         /* vibration index at this design */
    double hz;
    double percent; /* clearance from the band's nearest edge (bands.h); negative inside */
    double margin_percent; /* margin required at that edge, as a clearance */
    const char *side;      /* position of the mode: "below", "inside", "above" */
    /* over the tolerances of the variables: nearest to the band, or deepest inside; NaN: no
     * tolerances */
    double worst_hz;
    double worst_percent;
} mt_result_clearance;

/* The result of a goal of forced vibration. */
typedef struct mt_result_response {
    const char *pointer; /* of the goal, "/goals/0" */
    const char *configuration;
    const char *input; /* ports, as in files */
    const char *output;
    const char *profile;  /* NULL: the response itself, without a profile */
    const char *quantity; /* "response" | "rms" | "sine" | "peak" */
    const char *unit;     /* unit of value and error; "": not known */
    double value;         /* NaN: not available, see `end` */
    double error;         /* bound of its error; an estimate where sampled; NaN: not known */
    double frequency_hz;  /* frequency of the largest response; NaN: not known */
    bool at_edge;         /* frequency_hz is an end of the range */
    double lower_hz;      /* the range that was searched */
    double upper_hz;
    const char *end;   /* "finite" | "infinite" | "unstable" | "none": could not be computed */
    const char *grade; /* "proven": value is the maximum over the range; "sampled" */
    const char *text;  /* in words, without a full stop */
} mt_result_response;

/* The result of a goal that limits a number, between the positions of one drive that it
 * names. */
typedef struct mt_result_between {
    const char *pointer; /* of the goal, "/goals/0" */
    const char *drive;   /* the joint */
    const char *unit;    /* "rad" | "m": of from, to, at */
    double from;         /* first and last position that the goal names */
    double to;
    int positions; /* number of positions looked at, those included; 0: none */
    double at;     /* the worst position; NaN: none has a value */
    bool named;    /* the worst position is one that the goal names */
    double value;  /* value at the worst position; NaN: none, or infinite, see `end` */
    const char *value_unit;
    double error; /* as in mt_result_response */
    double frequency_hz;
    const char *end;
    double violation_percent; /* violation of the limit there; NaN: as value */
    bool holds;               /* the limit holds at all positions looked at */
    const char *grade;        /* "sampled" | "sampled coarsely" | "incomplete" | "unstable" */
    const char *text;         /* in words, without a full stop */
} mt_result_between;

/* The value of one objective, for feasible and infeasible designs; NaN: not available. */
typedef struct mt_design_objective {
    const char *text; /* text and unit as in mt_result_objective */
    const char *unit;
    double original;
    double recommended;
} mt_design_objective;

/* The mode placement of one band: the number of modes below it. */
typedef struct mt_result_mode_placement {
    /* number of this band of this configuration, from 1: the same in all designs of a result */
    int id;
    const char *configuration;
    const char *band;
    double lower_hz; /* the band without its margin */
    double upper_hz;
    double margin_lower_hz; /* the band with its margin */
    double margin_upper_hz;
    int modes_below;
} mt_result_mode_placement;

/* The clearance of a design from bands between the named positions of one drive. */
typedef struct mt_result_motion {
    const char *pointer;      /* of the first goal that avoids bands at these positions */
    const char *drive;        /* the joint */
    const char *unit;         /* "rad" | "m": of from, to, at */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double from; /* first and last named position */
    double to;
    int positions; /* number of positions looked at; 0: none */
    /* least clearance from an edge of a band without its margin, negative beyond it; NaN: not
     * followed */
    double least_clearance_percent;
    double margin_percent; /* margin required there, as a clearance */
    double at;             /* position of the least clearance */
    double hz;
    int mode;         /* mode of the least clearance, or the mode that crosses; 0: none */
    const char *band; /* NULL: none */
    /* as in mt_result_mode_placement, of the first position with this band; 0: none */
    int band_id;
    /* between the positions a mode is within a band or its margin */
    bool crosses;
    /* "sampled" | "sampled coarsely" | "incomplete" | "unstable" | "not followed" */
    const char *grade;
    const char *text; /* in words, without a full stop */
} mt_result_motion;

typedef struct mt_result_tolerance {
    const char *name; /* of the variable */
    double percent;   /* tolerance of this variable alone, either way; NaN: not known */
    const char *edge; /* the limit reached there, in words; NULL */
} mt_result_tolerance;

/* The tolerance box of a design: within it all modes avoid the bands without their margin. */
typedef struct mt_tolerance_box {
    double all_percent; /* tolerance of all variables together; 0 for a design on an edge */
    /* the limit reached there: "mode 2 of \"installed\" at the lower edge of 4P of UH-60";
     * NULL */
    const char *edge;
    bool proven; /* false: sampled */
    int n_variables;
    mt_result_tolerance *variables; /* in the study's order */
} mt_tolerance_box;

/* The MAC of a mode with each mode of a reference. */
typedef struct mt_result_mac_row {
    int mode; /* vibration index at this design */
    int n_values;
    double *values; /* [n_values] one per compared mode of the reference */
} mt_result_mac_row;

/* MAC of the modes of a configuration with those of a reference. */
typedef struct mt_result_mac {
    const char *configuration;
    const char *reference;
    int n_reference_modes;
    /* [n_reference_modes] 1-based, those that move at the common sensors */
    double *reference_modes;
    int n_rows;
    mt_result_mac_row *rows; /* of the listed modes, those that move at the common sensors */
} mt_result_mac;

/* One sentence of the explanation of a design. */
typedef struct mt_reason {
    const char *kind;  /* "change" | "hold" | "cost" | "rank" */
    const char *about; /* the parameter's name, or the goal's pointer; NULL: neither */
    const char *text;
} mt_reason;

typedef struct mt_recommendation {
    int rank;
    bool feasible;
    /* "feasible and proven" | "feasible" | "compromise" | "infeasible" | "not verified"; of a
     * fit also "fitted" | "local minimum" | "not converged" */
    const char *grade;
    /* the disagreement of a repeated analysis with the search, in words (not written; warnings
     * and reasons use it); NULL: none */
    const char *disagreement;
    double score;  /* rank criterion: the first objective; NaN where infeasible */
    double change; /* total change */
    double misfit; /* NaN: no weighted goals */
    double violation_percent;
    double clearance_percent; /* least of all clearances; NaN: no bands */
    double kkt_residual;      /* relative; NaN where not an optimum */
    /* grade of the worst values over the tolerances of the variables: "proven", "sampled";
     * NULL: no tolerances */
    const char *worst_case;
    bool singular; /* a double solution: the Jacobian of the goals is singular at the design */
    int n_parameters;
    mt_result_parameter *parameters;
    mt_design_objective *objectives; /* all objectives of the study */
    int n_objectives;
    int n_frequencies;
    mt_result_frequency *frequencies;
    mt_result_mac *macs; /* one per reference whose shapes goals compare */
    int n_macs;
    int n_clearances;
    mt_result_clearance *clearances;
    int n_placements; /* 0: no bands */
    mt_result_mode_placement *placements;
    int n_motions; /* one per drive with several positions at which goals avoid bands */
    mt_result_motion *motions;
    mt_tolerance_box *tolerance_box; /* NULL: not computed */
    int n_goals;
    mt_result_goal *goals;
    int n_responses; /* one per goal of forced vibration and configuration */
    mt_result_response *responses;
    int n_between; /* one per such goal and drive of which it names several positions */
    mt_result_between *between;
    /* in the order of the result's curves; none at points of a trade study */
    mt_design_curve *curves;
    int n_curves;
    int n_reasons;
    mt_reason *reasons;
} mt_recommendation;

/* A design of an interrupted search that was not analysed again: its results are not known. */
typedef struct mt_unchecked {
    double *values;   /* [n_variables] */
    const char *text; /* "k = 1200 N/m, m = 2 kg" */
} mt_unchecked;

/* A direction in the space of the variables along which the goals do not change. */
typedef struct mt_unidentifiable_direction {
    /* [n_variables] unit vector in ln(parameter) (positive ones) or parameter/scale */
    double *direction;
    const char *text; /* "K_T2" or "0.71 ln a - 0.71 ln b" */
    /* largest change of any goal from bound to bound along the direction */
    double effect_percent;
} mt_unidentifiable_direction;

/* The range of a variable of the best design when the weight of one goal at a time is
 * changed. */
typedef struct mt_result_weight_sensitivity {
    const char *parameter;
    const char *unit;         /* may be NULL */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value; /* with the weights as given */
    /* smallest and greatest of all solutions, including that of the given weights */
    double low;
    double high;
    double low_percent; /* difference from value in percent of |value|; NaN where value is 0 */
    double high_percent;
    /* goal whose weight gives `low`, "/goals/3"; NULL: no changed weight does */
    const char *low_goal;
    const char *high_goal;
    double low_factor; /* factor of its weight; NaN without a goal */
    double high_factor;
} mt_result_weight_sensitivity;

typedef struct mt_result_published {
    const char *label;
    const char *pointer;
    const char *role;   /* "calibrates" | "verifies" | "not_comparable" */
    const char *source; /* may be NULL */
    const char *kind;   /* "parameter" | "quantity" | "frequency" | "mac" | "status" */
    double published;   /* value or limit; NaN for status */
    double computed;
    double difference; /* computed - published */
    double difference_percent;
    const char *published_text; /* status */
    const char *computed_text;
    const char *requirement;  /* "within 0.1 %", "at least" */
    const char *display_unit; /* of a parameter, as in mt_result_parameter */
    double display_factor;
    bool holds;
} mt_result_published;

typedef struct mt_certificate {
    const char *kind; /* "infeasible", "range", ... */
    const char *text;
    bool proven;         /* false: sampled */
    const char *pointer; /* of the goal concerned, "/goals/0"; NULL: all goals */
    /* frequencies that the goal's mode can reach within the bounds; NaN: not applicable */
    double reachable_lower_hz;
    double reachable_upper_hz;
} mt_certificate;

/* A change of one number of the study, all others fixed, that makes the study feasible. */
typedef struct mt_relaxation {
    const char *kind;    /* "bound" | "band" | "goal" */
    const char *pointer; /* the member that it belongs to: "/variables/0", "/goals/2" */
    const char *what;    /* "upper bound of k1", "lower edge of 4P of UH-60 in "installed"" */
    const char *unit;    /* may be NULL */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double from;
    double to;
    double change_percent; /* of |from|; NaN where that is 0 */
    /* [n_variables] values of the variables of a design that is then feasible */
    double *design;
    const char *text; /* as a sentence */
} mt_relaxation;

/* One point of a trade study, with its best design. */
typedef struct mt_trade_point {
    int n_values; /* n_vary */
    double *values;
    mt_result_status status;
    const char *status_text;
    mt_recommendation best;
    bool pareto; /* no other point is better in one objective and not worse in the other */
} mt_trade_point;

typedef struct mt_trade_vary {
    const char *text;         /* "upper bound of M_SAU" */
    const char *pointer;      /* "/trade/vary/0" */
    const char *unit;         /* may be NULL */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
} mt_trade_vary;

typedef struct mt_trade_result {
    int n_vary;
    mt_trade_vary *vary;
    int n_objectives; /* 0 or 2: of the Pareto front */
    const char **objectives;
    int n_points;
    mt_trade_point *points; /* in the order of the values; the last quantity varies fastest */
} mt_trade_result;

/* A line of a Campbell diagram: frequency = order * speed. */
typedef struct mt_result_order {
    const char *label; /* "1.5E", "1G of pinion", "4P" */
    double order;
} mt_result_order;

/* A rotor or a machine of an avoid goal. */
typedef struct mt_result_excitation {
    const char *pointer; /* of the goal */
    const char *name;
    double speed_lower_hz; /* range of its speed [1/s] */
    double speed_upper_hz;
    double margin_percent;
    double up_to_hz;      /* orders above this frequency are ignored; NaN: no limit */
    int n_configurations; /* number of configurations that avoid it */
    const char **configurations;
    int n_orders;
    mt_result_order *orders;
} mt_result_excitation;

/* A KKT residual (relative to the objective's gradient) above this is reported. At it, over the
 * remaining path of at most a few in ln x, the objective loses less than a thousandth; Newton's
 * iteration reaches 1e-9 wherever the modes are simple. */
#define MT_KKT_TOLD 1e-4

typedef struct mt_result_objective {
    const char *type; /* name in files: "mass" */
    const char *text; /* the type, "mass of bar*", or the expression */
    const char *unit; /* "": none; NULL: the expression's own */
} mt_result_objective;

typedef struct mt_result {
    mt_arena mem;
    mt_result_study study;
    /* as written in the study, relative to the study's folder: for `apply` */
    mt_result_source model;
    const char *status_text; /* one sentence */
    mt_result_status status;
    int n_variables;
    const char **variables;
    mt_result_objective *objectives; /* none: nothing is minimised */
    int n_objectives;
    int n_doubts; /* warnings about the study, shown first */
    mt_warning *doubts;
    mt_warning *facts; /* notes about the model, shown next */
    int n_facts;
    int n_assumptions;
    mt_result_assumption *assumptions;
    int n_recommendations;
    mt_recommendation baseline; /* the original design, rank 0 */
    mt_recommendation *recommendations;
    mt_unchecked *unchecked;
    int n_unchecked;
    mt_result_excitation *excitations;
    int n_excitations;
    mt_result_curve *curves;
    int n_curves;
    /* lists from here on are NULL where an interrupt prevented their computation */
    int n_unidentifiable;
    mt_unidentifiable_direction *unidentifiable;
    mt_result_weight_sensitivity *weight_sensitivity; /* empty, or one per variable */
    int n_weight_sensitivity;
    int n_certificates;
    mt_certificate *certificates;
    mt_relaxation *relaxations; /* least change first; only where no design meets all goals */
    int n_relaxations;
    int n_published;
    mt_result_published *published;
    mt_trade_result *trade; /* NULL: no trade study, or not computed */
    const char **warnings;
    int n_warnings;
    mt_result_run run;
} mt_result;

/* An empty result of status "interrupted". Fails: MT_E_MEMORY. */
mt_status mt_result_new(mt_result **out, mt_err *err);
/* The lengths of the lists that phases append to; mt_result_take_back cuts the lists to
 * them. */
typedef struct mt_result_mark {
    int n_unidentifiable;
    int n_weight_sensitivity;
    int n_certificates;
    int n_relaxations;
    int n_published;
    int n_warnings;
} mt_result_mark;
mt_result_mark mt_result_get_mark(const mt_result *result);
void mt_result_take_back(mt_result *result, const mt_result_mark *mark);
/* Copy the warnings and notes of a list into the result. Fails: MT_E_MEMORY. */
mt_status mt_result_take_warnings(mt_result *result, const mt_warning_list *list, mt_err *err);
/* The text of warning i about the study, from 0; NULL beyond the last. */
const char *mt_result_warning(const mt_result *result, int i);
/* A deep copy of a recommendation, which may outlive its result. Content that equals that of
 * `like` (NULL: none) is shared with it and lives as long. Fails: MT_E_MEMORY. */
mt_status mt_recommendation_copy(const mt_recommendation *from, const mt_recommendation *like,
                                 mt_arena *mem, mt_recommendation *out, mt_err *err);
/* Replace everything borrowed by copies in result->mem. Fails: MT_E_MEMORY. */
mt_status mt_result_own(mt_result *result, mt_err *err);

/* The points of a trade study that are shown in full: all of a grid of at most MT_TRADE_WHOLE
 * points; of a larger one at most MT_TRADE_WHOLE, evenly spread over the Pareto front, or where
 * there is none over the points with a design, or else over all points. */
enum { MT_TRADE_WHOLE = 400 };
typedef struct mt_trade_selection {
    const mt_trade_result *trade;
    bool front; /* only points of the front count */
    bool found; /* only points with a design count */
    int each;   /* the first of every `each` points that count is selected */
    int met;    /* number of counting points so far */
} mt_trade_selection;
mt_trade_selection mt_trade_select(const mt_trade_result *trade);
/* True where point k is selected; call it for k = 0, 1, 2, ... in order. */
bool mt_trade_is_selected(mt_trade_selection *s, int k);

/* A value in the unit in which it is shown (display_factor), rounded to 15 digits where that is
 * the same number within rounding: 29.1 mm for 0.0291 m. */
double mt_result_shown(double value, double factor);

/* The members of these structs as in JSON. */
extern const mt_record mt_result_record;
extern const mt_record mt_design_record; /* mt_recommendation */
extern const mt_record mt_warning_record;

/* Functions mt_recommendation_default() etc.: records with all numbers "not applicable".
 * X(struct, its table in result_tables.c) */
#define MT_RESULT_DEFAULT_LIST(X)          \
    X(mt_recommendation, mt_design_record) \
    X(mt_result_goal, GOAL)                \
    X(mt_result_frequency, FREQUENCY)      \
    X(mt_result_published, PUBLISHED)      \
    X(mt_certificate, CERTIFICATE)         \
    X(mt_tolerance_box, TOLERANCE_BOX)     \
    X(mt_result_motion, MOTION)
#define MT_RESULT_DEFAULT(of, record) of of##_default(void);
MT_RESULT_DEFAULT_LIST(MT_RESULT_DEFAULT)
#undef MT_RESULT_DEFAULT

#endif
