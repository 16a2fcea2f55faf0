/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RESULT_RESULT_H
#define RESULT_RESULT_H

#include "modetune/study.h"

#include <stdbool.h>

#include "base/arena.h"
#include "base/warning.h"
#include "result/curves.h"
#include "result/made_from.h"
#include "result/record.h"

/*
 * What a study answers: plain records, no computation. All texts live in the result's arena.
 * NaN: not applicable (null in JSON). A member that is added here gets its line in the tables
 * of result.c: writer, reader and copier follow from them, and the schema is held against them.
 */

typedef struct mt_result_parameter {
    const char *name;
    const char *unit; /* may be NULL */
    /* what people are shown its numbers in, and how much that is in the unit: value / factor;
     * NULL, NaN: in the unit itself */
    const char *display_unit;
    double display_factor;
    double original;
    double recommended;
    double change_percent; /* NaN where original is 0 */
    const char *at_bound;  /* NULL, "lower", "upper" */
    double lower;          /* its bounds; of a catalogue its ends */
    double upper;
    /* how a change counts: by ln(new/original), "logarithmic"; the same with a floor;
     * "linear" */
    const char *measure;
    double measure_floor; /* where the logarithm goes on as its tangent; NaN: nowhere */
    double measure_scale; /* of a linear measure: (new - original)/scale; NaN: it is none */
} mt_result_parameter;

typedef struct mt_result_frequency {
    const char *configuration;
    int mode;             /* vibration index at this design */
    const char *name;     /* named mode; NULL */
    const char *identity; /* of a named mode: "tracked", "ambiguous", "lost"; NULL */
    double share;   /* part of the named shape that this mode carries; NaN without a name */
    int rival_mode; /* the mode that carries most of the rest; 0: none */
    double rival_share;
    double original_hz;
    double recommended_hz;
    double target_hz; /* NaN: no target */
    double at_least_hz;
    double at_most_hz;
    double error_percent;  /* to the target, or beyond the limit; 0 inside limits */
    double mac;            /* NaN: no reference shape asked for */
    const char *reference; /* NULL */
    double lowest_hz;      /* over the tolerances of the variables; NaN: they have none */
    double highest_hz;
    double residual; /* LAPACK-style ratio of this mode */
    double orthogonality;
    /* [n_parameters] Hz per unit of each variable; NaN at a repeated mode; NULL: not
     * computed */
    double *sensitivity;
    bool repeated;
    /* of a vibration of 0 Hz (not written: reasons tell): the springs of zero stiffness that
     * would hold it, "" where none would; NULL: it is held */
    const char *slack;
} mt_result_frequency;

/* A goal judged at a design: of one mode in one configuration, of the bands of one, of the
 * motion of a drive between its named positions, or of an expression. */
typedef struct mt_result_goal {
    const char *text;          /* "installed mode 1 at 18 Hz" */
    const char *quantity;      /* of it what is limited: "installed mode 1" */
    const char *pointer;       /* "/goals/0" */
    const char *type;          /* as files call it: "frequency" */
    const char *configuration; /* NULL: of none, or of several */
    int mode;                  /* as asked by its index; 0: by name, or none */
    const char *name;          /* of the mode, where asked by it; NULL */
    const char *reference;     /* or measurement, that it is compared with; NULL */
    const char *expression;    /* of a limit; NULL */
    /* of value, target and limits; "": none; NULL: the expression's own */
    const char *unit;
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value;
    double target; /* NaN: limits only; of a shape 0: its distance */
    double at_least;
    double at_most;
    double tolerance_percent; /* a violation up to it is met */
    double violation_percent;
    bool met;
    bool weighted; /* part of the misfit, or of the vibration: does not decide status */
    bool doubtful; /* its named mode is ambiguous or lost: not met, whatever the number */
    /* the worst value over the tolerances of the variables, which the goal is judged by; NaN:
     * none */
    double worst;
    double *worst_at; /* [n_parameters] where that is; NULL: none */
    /* [n_parameters] of the value, per unit of each variable; NULL: it has none, as a mode that
     * repeats, or a distance */
    double *sensitivity;
    /* of a frequency response: the measured line where it is off most; NaN: none */
    double off_most_hz;
    double off_most_ratio; /* magnitude over the measured one */
    double off_most_phase_deg;
} mt_result_goal;

/* A mode beside a band. */
typedef struct mt_result_clearance {
    const char *configuration;
    const char *band; /* its label: "4P of UH-60" */
    int band_id;      /* as in mt_result_mode_placement */
    int mode;         /* vibration index at this design */
    double hz;
    double percent; /* clearance from the band's nearest edge (bands.h); negative inside */
    double margin_percent; /* what was asked for at that edge, as a clearance */
    const char *side;      /* where the mode lies: "below", "inside", "above" */
    /* over the tolerances of the variables: nearest to the band, or deepest inside; NaN:
     * none */
    double worst_hz;
    double worst_percent;
} mt_result_clearance;

/* What a goal of forced vibration finds. */
typedef struct mt_result_response {
    const char *pointer; /* of the goal, "/goals/0" */
    const char *configuration;
    const char *input; /* ports, as in files */
    const char *output;
    const char *profile;  /* NULL: a response itself, not under a profile */
    const char *quantity; /* "response" | "rms" | "sine" | "peak" */
    const char *unit;     /* of value and error; "": not known */
    double value;         /* NaN: none, see end */
    double error; /* of it, at most; of one that is sampled an estimate; NaN: not known */
    double frequency_hz; /* where the response is largest; NaN: not known */
    bool at_edge;        /* that is an end of the range */
    double lower_hz;     /* the range that it was looked for in */
    double upper_hz;
    const char *end;   /* "finite" | "infinite" | "unstable" | "none": could not be computed */
    const char *grade; /* "proven": no frequency of the range has more; "sampled" */
    const char *text;  /* in words, without a full stop */
} mt_result_response;

/* What a goal that limits a number finds between the positions of one drive that it names. */
typedef struct mt_result_between {
    const char *pointer; /* of the goal, "/goals/0" */
    const char *drive;   /* the joint */
    const char *unit;    /* "rad" | "m": of from, to, at */
    double from;         /* first and last position that the goal names */
    double to;
    int positions; /* that were looked at, those included; 0: none */
    double at;     /* the worst of them; NaN: none has a value */
    bool named;    /* that is one that the goal names */
    double value;  /* there; NaN: none, or infinite, see end */
    const char *value_unit;
    double error; /* as mt_result_response */
    double frequency_hz;
    const char *end;
    double violation_percent; /* of the limit there; NaN: as value */
    bool holds;               /* the limit, at all positions that were looked at */
    const char *grade;        /* "sampled" | "sampled coarsely" | "incomplete" | "unstable" */
    const char *text;         /* in words, without a full stop */
} mt_result_between;

/* The value of one objective, whether the goals are met or not; NaN: there is none. */
typedef struct mt_design_objective {
    const char *text; /* text and unit as in mt_result_objective */
    const char *unit;
    double original;
    double recommended;
} mt_design_objective;

/* How many modes lie below a band: the kind of a design. */
typedef struct mt_result_mode_placement {
    /* of this band of this configuration, from 1: the same at all designs of a result */
    int id;
    const char *configuration;
    const char *band;
    double lower_hz; /* of the band without its margin */
    double upper_hz;
    double margin_lower_hz; /* with it */
    double margin_upper_hz;
    int modes_below;
} mt_result_mode_placement;

/* A design between the named positions of one drive. */
typedef struct mt_result_motion {
    const char *pointer;      /* of the first goal that keeps these positions clear of bands */
    const char *drive;        /* the joint */
    const char *unit;         /* "rad" | "m": of from, to, at */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double from; /* first and last named position */
    double to;
    int positions; /* that were looked at; 0: none */
    /* of an edge of a band without its margin, negative beyond it; NaN: not followed */
    double least_clearance_percent;
    double margin_percent; /* asked for there, as a clearance */
    double at;             /* where it is */
    double hz;
    int mode;         /* whose it is, or which crosses; 0: none */
    const char *band; /* NULL: none */
    /* as in mt_result_mode_placement, of the first position that has it; 0: none */
    int band_id;
    /* a mode is nearer to a band than its margin, or inside, between the positions */
    bool crosses;
    /* "sampled" | "sampled coarsely" | "incomplete" | "unstable" | "not followed" */
    const char *grade;
    const char *text; /* in words, without a full stop */
} mt_result_motion;

typedef struct mt_result_tolerance {
    const char *name; /* of the variable */
    double percent;   /* it alone may change so much either way; NaN: not known */
    const char *edge; /* what would be met there, in words; NULL */
} mt_result_tolerance;

/* Inside it the bands, without their margin, are kept. */
typedef struct mt_tolerance_box {
    double all_percent; /* all variables together; 0 for a design on an edge */
    /* what would be met there: "mode 2 of \"installed\" at the lower edge of 4P of UH-60";
     * NULL */
    const char *edge;
    bool proven; /* false: sampled */
    int n_variables;
    mt_result_tolerance *variables; /* in the study's order */
} mt_tolerance_box;

/* MAC of a mode with the modes of a reference. */
typedef struct mt_result_mac_row {
    int mode; /* vibration index at this design */
    int n_values;
    double *values; /* [n_values] one for each mode of the reference that is compared */
} mt_result_mac_row;

/* The modes of a configuration and those of a reference: whose shape is whose. */
typedef struct mt_result_mac {
    const char *configuration;
    const char *reference;
    int n_reference_modes;
    double *reference_modes; /* [n_reference_modes] 1-based, those that move at the sensors */
    int n_rows;
    mt_result_mac_row *rows; /* of the modes listed, those that move there */
} mt_result_mac;

/* One sentence of why a design is what it is. */
typedef struct mt_reason {
    const char *kind;  /* "change" | "hold" | "cost" | "rank" */
    const char *about; /* the parameter's name, or the goal's pointer; NULL: neither */
    const char *text;
} mt_reason;

typedef struct mt_recommendation {
    int rank;
    bool feasible;
    /* "feasible and proven" | "feasible" | "compromise" | "infeasible" | "not verified" */
    const char *grade;
    /* of a fresh analysis with what the search read, in words (not written: warnings and
     * reasons tell); NULL: none */
    const char *disagreement;
    double score;  /* what it is ranked by: the first objective; NaN where infeasible */
    double change; /* size of the redesign */
    double misfit; /* NaN: no weighted goals */
    double violation_percent;
    double clearance_percent; /* least of all clearances; NaN: no bands */
    double kkt_residual;      /* relative; NaN where not an optimum */
    /* how the worst over the tolerances of the variables is known: "proven", "sampled"; NULL:
     * they have none */
    const char *worst_case;
    bool singular; /* a double solution: the Jacobian of the goals is singular here */
    int n_parameters;
    mt_result_parameter *parameters;
    mt_design_objective *objectives; /* all of the study */
    int n_objectives;
    int n_frequencies;
    mt_result_frequency *frequencies;
    mt_result_mac *macs; /* one for each reference whose shapes goals compare */
    int n_macs;
    int n_clearances;
    mt_result_clearance *clearances;
    int n_placements; /* 0: no bands */
    mt_result_mode_placement *placements;
    int n_motions; /* one for each drive with several positions that keep clear of bands */
    mt_result_motion *motions;
    mt_tolerance_box *tolerance_box; /* NULL: not computed */
    int n_goals;
    mt_result_goal *goals;
    int n_responses; /* one for each goal of forced vibration and configuration */
    mt_result_response *responses;
    int n_between; /* one for each such goal and drive with several positions that it names */
    mt_result_between *between;
    mt_design_curve *curves; /* in the order of the result's; none at points of a trade */
    int n_curves;
    int n_reasons;
    mt_reason *reasons;
} mt_recommendation;

/* A design of a search that was cut, which nobody has analysed anew: nothing is known of it. */
typedef struct mt_unchecked {
    double *values;   /* [n_variables] */
    const char *text; /* "k = 1200 N/m, m = 2 kg" */
} mt_unchecked;

/* A direction in the space of the variables along which the goals do not change. */
typedef struct mt_unidentifiable_direction {
    /* [n_variables] unit vector in ln(parameter) (positive ones) or parameter/scale */
    double *direction;
    const char *text; /* "K_T2" or "0.71 ln a - 0.71 ln b" */
    /* greatest change of any goal when the bounds are crossed along it */
    double effect_percent;
} mt_unidentifiable_direction;

/* Where a variable of the best design moves when the weight of one goal at a time is
 * changed. */
typedef struct mt_result_weight_sensitivity {
    const char *parameter;
    const char *unit;         /* may be NULL */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double value; /* with the weights as given */
    double low;   /* smallest and greatest of all solutions, the given weights' among them */
    double high;
    double low_percent; /* of |value|; NaN where that is 0 */
    double high_percent;
    const char *low_goal; /* "/goals/3": whose weight; NULL: no change of a weight goes there */
    const char *high_goal;
    double low_factor; /* what its weight was multiplied with; NaN without a goal */
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
    const char *pointer; /* of the goal that it speaks of, "/goals/0"; NULL: of all */
    /* range that the goal's mode can reach within the bounds; NaN: not applicable */
    double reachable_lower_hz;
    double reachable_upper_hz;
} mt_certificate;

/* One number of the question that, moved so far with everything else as it is, lets a design
 * meet all goals. */
typedef struct mt_relaxation {
    const char *kind;    /* "bound" | "band" | "goal" */
    const char *pointer; /* what it belongs to: "/variables/0", "/goals/2" */
    const char *what;    /* "upper bound of k1", "lower edge of 4P of UH-60 in "installed"" */
    const char *unit;    /* may be NULL */
    const char *display_unit; /* as in mt_result_parameter */
    double display_factor;
    double from;
    double to;
    double change_percent; /* of |from|; NaN where that is 0 */
    /* [n_variables] values of the variables of a design that then meets all goals */
    double *design;
    const char *text; /* as a sentence */
} mt_relaxation;

/* One study of a trade study, with its best design. */
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
    double up_to_hz;      /* nothing beyond counts; NaN: all does */
    int n_configurations; /* that are kept clear of it */
    const char **configurations;
    int n_orders;
    mt_result_order *orders;
} mt_result_excitation;

/* A KKT residual (relative to the objective's gradient) above this is told. Along the way that
 * is left, of at most a few in ln x, it costs less than a thousandth of the objective; Newton's
 * iteration reaches 1e-9 wherever the modes are simple. */
#define MT_KKT_TOLD 1e-4

typedef struct mt_result_objective {
    const char *type; /* as files call it: "mass" */
    const char *text; /* the type, "mass of bar*", or the expression */
    const char *unit; /* "": none; NULL: the expression's own */
} mt_result_objective;

typedef struct mt_result {
    mt_arena mem;
    mt_result_study study;
    mt_result_source model;  /* as the study writes it, relative to its folder: for `apply` */
    const char *status_text; /* one sentence */
    mt_result_status status;
    int n_variables;
    const char **variables;
    mt_result_objective *objectives; /* none: nothing is asked for */
    int n_objectives;
    int n_doubts; /* about the question, said before anything else */
    mt_warning *doubts;
    mt_warning *facts; /* of the model, said next */
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
    /* from here on lists that are NULL were not computed: an interrupt cut them */
    int n_unidentifiable;
    mt_unidentifiable_direction *unidentifiable;
    mt_result_weight_sensitivity *weight_sensitivity; /* none, or one per variable */
    int n_weight_sensitivity;
    int n_certificates;
    mt_certificate *certificates;
    mt_relaxation *relaxations; /* least first; only where no design meets all goals */
    int n_relaxations;
    int n_published;
    mt_result_published *published;
    mt_trade_result *trade; /* NULL: the study has none, or that */
    const char **warnings;
    int n_warnings;
    mt_result_run run;
} mt_result;

/* An empty result (status interrupted: nothing is known yet). Fails: MT_E_MEMORY. */
mt_status mt_result_new(mt_result **out, mt_err *err);
/* How far the lists are filled that phases add to; and back to there. */
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
/* Doubts and facts of a list, copied. Fails: MT_E_MEMORY. */
mt_status mt_result_take_warnings(mt_result *result, const mt_warning_list *list, mt_err *err);
/* A copy of all that a recommendation of one result holds, which may outlive it; what `like`
 * (NULL: nothing) says already is taken from there, and lives as long. Fails: MT_E_MEMORY. */
mt_status mt_recommendation_copy(const mt_recommendation *from, const mt_recommendation *like,
                                 mt_arena *mem, mt_recommendation *out, mt_err *err);
/* All that it has borrowed becomes its own. Fails: MT_E_MEMORY. */
mt_status mt_result_own(mt_result *result, mt_err *err);

/* Points of a trade study that people are shown with all that is known of them: all of a small
 * grid; of one that has more than MT_TRADE_WHOLE so many, evenly spread over the front, where
 * there is none over the points with a design, where there are none over all. */
enum { MT_TRADE_WHOLE = 400 };
typedef struct mt_trade_selection {
    const mt_trade_result *trade;
    bool front; /* only what is on it counts */
    bool found; /* only what has a design */
    int each;   /* of so many that count the first */
    int met;    /* that count, so far */
} mt_trade_selection;
mt_trade_selection mt_trade_select(const mt_trade_result *trade);
/* Of point k; to be asked of one point after the other, from 0 on. */
bool mt_trade_is_selected(mt_trade_selection *s, int k);

/* A value in the unit that people are shown (display_factor): of at most 15 digits where such a
 * number is the same within rounding, 29.1 mm of 0.0291 m. */
double mt_result_shown(double value, double factor);

/* What these structs hold, member by member as in JSON. */
extern const mt_record mt_result_record;
extern const mt_record mt_design_record;   /* mt_recommendation */
extern const mt_record mt_response_record; /* mt_result_response, part of that */
extern const mt_record mt_between_record;  /* mt_result_between, likewise */
extern const mt_record mt_warning_record;

/* mt_recommendation_default() and the like: all numbers are "not applicable". X(struct, its
 * table in result.c) */
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
