/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CLI_ARGS_H
#define CLI_ARGS_H

#include <stdbool.h>
#include <stdint.h>

#include "base/text.h"
#include "io/options.h"
#include "result/record.h"

typedef enum mt_shell { MT_SHELL_BASH, MT_SHELL_ZSH, MT_SHELL_COUNT } mt_shell;

/*
 * The command line in tables of commands, options and exit statuses, which drive
 * the parser, --help, the manual page and "did you mean".
 */
typedef enum mt_option_id {
    MT_OPT_CONFIGURATION,
    MT_OPT_SET,
    MT_OPT_COUNT,
    MT_OPT_SHAPES,
    MT_OPT_DAMPED,
    MT_OPT_EFFECTIVE_MASS,
    MT_OPT_ABOUT,
    MT_OPT_ENERGY,
    MT_OPT_ENERGY_ABOUT,
    MT_OPT_AXES,
    MT_OPT_DRIVE,
    MT_OPT_HOLD,
    MT_OPT_GRID,
    MT_OPT_FREQUENCIES,
    MT_OPT_SVG,
    MT_OPT_MODE,
    MT_OPT_PARAMETERS,
    MT_OPT_INPUT,
    MT_OPT_MEASURE,
    MT_OPT_FROM,
    MT_OPT_TO,
    MT_OPT_POINTS,
    MT_OPT_LOG,
    MT_OPT_KEEP,
    MT_OPT_DIRECT,
    MT_OPT_POLES,
    MT_OPT_STATE_SPACE,
    MT_OPT_SENSITIVITY,
    MT_OPT_VIBRATION,
    MT_OPT_DURATION,
    MT_OPT_DT_OUT,
    MT_OPT_START,
    MT_OPT_RATE,
    MT_OPT_START_MODE,
    MT_OPT_PUSH,
    MT_OPT_SINE,
    MT_OPT_SINE_SWEEP,
    MT_OPT_RANDOM,
    MT_OPT_TOLERANCE,
    MT_OPT_INTEGRATE,
    MT_OPT_OUTPUT,
    MT_OPT_FILE,
    MT_OPT_VERIFY,
    MT_OPT_THREADS,
    MT_OPT_TIME,
    MT_OPT_SEED,
    MT_OPT_STARTS,
    MT_OPT_MAX_EVALUATIONS,
    MT_OPT_MAX_MODAL_SOLUTIONS,
    MT_OPT_PROOF,
    MT_OPT_REPORT,
    MT_OPT_RESUME,
    MT_OPT_SHARD,
    MT_OPT_TIMING,
    MT_OPT_PROGRESS,
    MT_OPT_MAX_MEMORY,
    MT_OPT_RANK,
    MT_OPT_KIND,
    MT_OPT_MODEL,
    MT_OPT_REDO,
    MT_OPT_REL_TOL,
    MT_OPT_ABS_TOL,
    MT_OPT_SPECTRUM,
    MT_OPT_DAMPING_RATIO,
    MT_OPT_ROOT,
    MT_OPT_FORMAT,
    MT_OPT_QUIET,
    MT_OPT_HELP,
    MT_OPT_MANUAL,
    MT_OPT_COMPLETION,
    MT_OPT_VERSION,
    MT_OPT_IDS
} mt_option_id;

/*
 * The commands: MT_CMD_<ID> and the record mt_command_<name>, which stands below its function
 * in the command's own file. One list makes the identifiers, the declarations and the table.
 */
#define MT_COMMAND_LIST(X)      \
    X(RUN, run)                 \
    X(MERGE, merge)             \
    X(COMPARE, compare)         \
    X(MODES, modes)             \
    X(MAC, mac)                 \
    X(SWEEP, sweep)             \
    X(SIMULATE, simulate)       \
    X(SENSITIVITY, sensitivity) \
    X(RESPONSE, response)       \
    X(INFO, info)               \
    X(SHOW, show)               \
    X(REPORT, report)           \
    X(EXPLAIN, explain)         \
    X(APPLY, apply)             \
    X(DIFF, diff)               \
    X(CHECK, check)             \
    X(INIT, init)               \
    X(EXAMPLES, examples)       \
    X(SCHEMA, schema)           \
    X(PROFILE, profile)         \
    X(HELP, help)

#define MT_COMMAND_ENUM(id, name) MT_CMD_##id,
typedef enum mt_command_id { MT_COMMAND_LIST(MT_COMMAND_ENUM) MT_CMD_IDS } mt_command_id;
#undef MT_COMMAND_ENUM

enum { MT_CMD_NONE = -1, MT_OPT_NONE = -1 };
#define MT_ALL_COMMANDS ((1U << (unsigned)MT_CMD_IDS) - 1U)

typedef struct mt_option {
    const char *name;  /* without the dashes */
    const char *value; /* name of its value in --help; NULL: a switch */
    const char *help;
    unsigned commands; /* bit 1 << mt_command_id */
    char letter;       /* '\0': long form only */
    bool repeats;      /* may be given more than once */
} mt_option;

typedef struct mt_args mt_args;

/* What --format json prints, from which its schema is written (schemas/command_NAME): */
typedef enum mt_answer_form {
    MT_ANSWER_ONE, /* the record */
    /* the record of each configuration in a list, of one that failed mt_failed_record; where -c
     * names it that one, without the list */
    MT_ANSWER_CONFIGURATIONS,
    MT_ANSWER_LIST, /* the record of each in a list */
    /* mt_listed_record of each file in a list; with an operand the record, if there is one */
    MT_ANSWER_FILES,
    /* the record; of a model configurations as above, whose members no record says */
    MT_ANSWER_HELD
} mt_answer_form;

typedef struct mt_answer {
    const mt_record *record; /* NULL, and a form of a record: no schema */
    mt_answer_form form;
} mt_answer;

typedef struct mt_command {
    const char *name;
    const char *operands; /* "STUDY..." */
    int least;            /* number of operands */
    int most;             /* -1: any number */
    const char *summary;  /* one line */
    const char *details;  /* paragraphs, one a line */
    mt_answer answer;
    /* Append the standard output to `out`, write messages and problems to standard error;
     * returns the exit status. */
    int (*run)(const mt_args *args, mt_text *out);
} mt_command;

typedef struct mt_exit {
    int code;
    const char *meaning;
} mt_exit;
enum { MT_EXITS = 6 };

extern const mt_option mt_options[MT_OPT_IDS];
extern const mt_exit mt_exits[MT_EXITS];

/* True where the command takes the option; MT_CMD_NONE: the program. */
bool mt_option_is_of(int option, int command);

/* The formats of --format. */
typedef enum mt_format {
    MT_FORMAT_TEXT,
    MT_FORMAT_JSON,
    MT_FORMAT_CSV,
    MT_FORMAT_HTML,
    MT_FORMAT_SARIF
} mt_format;
enum { MT_FORMATS = MT_FORMAT_SARIF + 1 };

/* The word of --format for this format; NULL where the command does not take it. */
const char *mt_format_of(int format, int command);

/* The forms of --progress. AUTO: a line that is rewritten on a terminal, else a plain line now
 * and then. */
typedef enum mt_progress_form {
    MT_PROGRESS_AUTO,
    MT_PROGRESS_LINE,
    MT_PROGRESS_JSON,
    MT_PROGRESS_NONE
} mt_progress_form;

/* One occurrence of an option that may be repeated. */
typedef struct mt_repeat {
    mt_option_id option;
    const char *value;
} mt_repeat;

/* All values of one option. */
typedef struct mt_values {
    int n;
    const char **value; /* [n] in order */
} mt_values;

struct mt_args {
    const mt_command *const *commands; /* [MT_CMD_IDS] those that there are */
    int command;                       /* mt_command_id, MT_CMD_NONE */
    mt_format format;
    mt_progress_form progress;
    bool no_report; /* --report none */
    mt_shell shell; /* --completion; valid where given */
    bool given[MT_OPT_IDS];
    const char *value[MT_OPT_IDS]; /* value of the last occurrence */
    int count;                     /* --count, 0: not given; INT_MAX: all */
    int rank;                      /* --rank, default 1 */
    int mode;                      /* --mode, 0: not given */
    int starts;                    /* --starts, 0: not given */
    int max_evaluations;           /* --max-evaluations, 0: not given */
    int max_modal_solutions;       /* --max-modal-solutions, 0: not given */
    int threads;       /* --threads, at most MT_WORKERS_MOST; without it set by mt_limits_set */
    double rel_tol;    /* --rel-tol, default 0 */
    double abs_tol;    /* --abs-tol, default 0 */
    double time_s;     /* --time, 0: not given */
    double duration_s; /* --duration, 0: not given */
    double dt_out_s;   /* --dt-out, 0: not given */
    double tolerance;  /* --tolerance, 0: not given */
    double proof_s;    /* --proof; valid where given */
    double about_m[3]; /* --about, default the origin */
    unsigned long seed;  /* --seed; valid where given */
    uint64_t max_memory; /* --max-memory in bytes, 0: not given */
    int points;          /* --points, 0: not given */
    int keep;            /* --modes N, 0: not given */
    int n_repeats;
    mt_repeat *repeats; /* occurrences of all options that may be repeated, in order; [argc] */
    mt_values all[MT_OPT_IDS];
    const char **pool; /* storage of `all`; [argc] */
    int part;          /* --shard PART/PARTS; 0: the whole */
    int parts;
    int n_journals; /* number of journals of merge */
    const char *const *journals;
    int n_operands;
    const char **operands; /* [argc] */
    /* heap: file of the first operand, where that is the folder of a result */
    char *result_path;
    /* the command line with the present names of options that had others before; s NULL: there
     * are none */
    mt_text renewed;
};

/**
 * Read argv[1..argc-1], with these commands [MT_CMD_IDS]. Options may stand anywhere after the
 * command; "--" ends them; "--name=value", "-oDIR" are fine. Fails: MT_E_USAGE (err: the first
 * fault, with "did you mean"), MT_E_MEMORY. mt_args_free in any case. --help, --manual and
 * --version take precedence over missing operands.
 */
mt_status mt_args_parse(int argc, char *const argv[], const mt_command *const *commands,
                        mt_args *out, mt_err *err);
void mt_args_free(mt_args *args);

/* How files are read, as the options ask. */
mt_io_options mt_cli_io(const mt_args *args);

#endif
