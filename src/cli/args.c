/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Commands and their options: their tables, completion in shells, and what an argument list
 * says. */
#include "cli/args.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/format.h"
#include "base/possible.h"
#include "base/workers.h"
#include "cli/cli.h"
#include "cli/terminal.h"
#include "response/curve.h"
#include "study/study.h"

/* The tables that describe the command line. */

#define BIT(command) (1U << (unsigned)(command))
#define ON_MODELS                                                                         \
    (BIT(MT_CMD_MODES) | BIT(MT_CMD_SWEEP) | BIT(MT_CMD_SENSITIVITY) | BIT(MT_CMD_INFO) | \
     BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SHOW) | BIT(MT_CMD_SIMULATE))
#define ONE_FILE   (BIT(MT_CMD_SHOW) | BIT(MT_CMD_APPLY) | BIT(MT_CMD_SCHEMA))
#define SOLVES     (BIT(MT_CMD_RUN) | BIT(MT_CMD_MERGE))
#define ON_STUDIES (SOLVES | BIT(MT_CMD_COMPARE))

#define OPTION(id, letter_, name_, value_, commands_, help_) \
    [id] = {.letter = (letter_),                             \
            .name = (name_),                                 \
            .value = (value_),                               \
            .commands = (commands_),                         \
            .help = (help_)}
#define REPEATED(id, name_, value_, commands_, help_) \
    [id] = {.name = (name_),                          \
            .value = (value_),                        \
            .commands = (commands_),                  \
            .help = (help_),                          \
            .repeats = true}

const mt_option mt_options[MT_OPT_IDS] = {
    OPTION(MT_OPT_CONFIGURATION, 'c', "configuration", "CONFIGURATION", ON_MODELS,
           "only this configuration (default: all)"),
    REPEATED(MT_OPT_SET, "set", "NAME=VALUE", ON_MODELS | ON_STUDIES,
             "give a parameter another value: a number in the parameter's unit, or an "
             "expression in SI units, which may use the model's own values (\"k=1.1*k\"); may "
             "be repeated; with a study: a parameter that the study does not vary"),
    OPTION(
        MT_OPT_COUNT, '\0', "count", "N",
        BIT(MT_CMD_MODES) | BIT(MT_CMD_MAC) | BIT(MT_CMD_SWEEP) | BIT(MT_CMD_SENSITIVITY),
        "only the lowest N vibration modes, or \"all\" (default: 20 in `modes`, 6 in `sweep` "
        "and `sensitivity`); `modes` and `sensitivity` find them without the others in "
        "most mechanisms of 100 bodies or more"),
    OPTION(MT_OPT_SHAPES, '\0', "shapes", NULL, BIT(MT_CMD_MODES),
           "mode shapes at the sensors, or of the bodies if there are no sensors"),
    OPTION(MT_OPT_DAMPED, '\0', "damped", NULL, BIT(MT_CMD_MODES),
           "complex modes too, with all damping (dampers, damping ratios, loss factors): "
           "natural and damped frequencies, damping ratios; a real root is overdamped (CSV: "
           "these modes alone)"),
    OPTION(MT_OPT_EFFECTIVE_MASS, '\0', "effective-mass", NULL, BIT(MT_CMD_MODES),
           "participation factors and effective modal masses of each mode for a ground that "
           "moves along and about the global axes, their sums, and the mass in all"),
    OPTION(MT_OPT_ABOUT, '\0', "about", "X,Y,Z", BIT(MT_CMD_MODES),
           "with --effective-mass: the point that rotations of the ground are about, in m "
           "(default: 0,0,0, the origin)"),
    OPTION(MT_OPT_ENERGY, '\0', "energy", NULL, BIT(MT_CMD_MODES),
           "who has the energy of each mode: kinetic by body and direction, strain by spring "
           "and component, in percent (the table leaves out what is below 0.5 %; CSV: these "
           "shares alone)"),
    OPTION(MT_OPT_ENERGY_ABOUT, '\0', "energy-about", "POINT", BIT(MT_CMD_MODES),
           "with --energy: directions about this point of the model, which each body carries "
           "(default: each body's centre)"),
    OPTION(MT_OPT_AXES, '\0', "axes", "AXES", BIT(MT_CMD_MODES),
           "with --energy: along global axes, the principal ones of each body's inertia, or "
           "with its torque roll axis in the place of x, y or z: global, principal, "
           "torque_roll_x, torque_roll_y or torque_roll_z (default: global)"),
    REPEATED(
        MT_OPT_DRIVE, "drive", "JOINT=FROM:TO:N", BIT(MT_CMD_SWEEP),
        "the joint (or a link's hinge) that is driven, through N positions counted from "
        "the reference position, in rad or m or the model's units; FROM and TO may be "
        "expressions (\"pivot=-10*deg:10*deg:21\"); several joints go their ways together, "
        "in as many steps"),
    REPEATED(MT_OPT_HOLD, "hold", "SPRING", BIT(MT_CMD_SWEEP),
             "re-adjust this spring so that it holds the joint at each position (default: the "
             "joint is locked); of one of several joints: JOINT=SPRING"),
    OPTION(MT_OPT_GRID, '\0', "grid", NULL, BIT(MT_CMD_SWEEP),
           "with several --drive: every position of one joint with every position of the "
           "others, each line along the last one from the reference position"),
    OPTION(MT_OPT_FREQUENCIES, '\0', "frequencies", NULL, BIT(MT_CMD_SWEEP),
           "natural frequencies at each position"),
    OPTION(MT_OPT_SVG, '\0', "svg", NULL, BIT(MT_CMD_SHOW),
           "one still picture of one configuration (default: the first), as SVG"),
    OPTION(MT_OPT_MODE, '\0', "mode", "N", BIT(MT_CMD_SHOW),
           "with --svg: vibration mode N beside the shape at rest"),
    OPTION(MT_OPT_PARAMETERS, '\0', "parameters", "A,B", BIT(MT_CMD_SENSITIVITY),
           "parameters to vary (default: all that are plain numbers)"),
    REPEATED(MT_OPT_INPUT, "input", "PORT", BIT(MT_CMD_RESPONSE),
             "the excitation: grip.x, the force (grip.rx: moment) along a direction of a "
             "sensor, or base.x, the acceleration of the ground (base.x:displacement, "
             "base.x:velocity); may be repeated"),
    REPEATED(MT_OPT_MEASURE, "measure", "PORT", BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SIMULATE),
             "the quantity to print: grip.x, grip.x:velocity, grip.x:acceleration, the motion "
             "of a sensor; may be repeated (default: the displacements of all sensors). "
             "`response` measures motion in space (grip.x:relative_acceleration: against the "
             "ground) and also knows spring.NAME and damper.NAME, the force or torque in it "
             "(spring.NAME.x, spring.NAME.rx: a component in a bushing), and joint.NAME.x, the "
             "force of a joint's first body on its second. `simulate` measures displacements "
             "(from the rest position) and velocities against the ground, accelerations in "
             "space, and also knows the coordinates of joints (pivot, pivot:velocity), which "
             "are the default if there are no sensors"),
    OPTION(MT_OPT_FROM, '\0', "from", "HZ", BIT(MT_CMD_RESPONSE),
           "lowest frequency (default: a quarter of the first natural frequency)"),
    OPTION(MT_OPT_TO, '\0', "to", "HZ", BIT(MT_CMD_RESPONSE),
           "highest frequency (default: twice the sixth natural frequency, or the last one)"),
    OPTION(MT_OPT_POINTS, '\0', "points", "N", BIT(MT_CMD_RESPONSE),
           "frequencies of the grid (default: 50); JSON and CSV have further ones that show "
           "every peak, and the curve between, to 1 %"),
    OPTION(MT_OPT_LOG, '\0', "log", NULL, BIT(MT_CMD_RESPONSE),
           "a grid in equal ratios instead of equal steps"),
    OPTION(MT_OPT_KEEP, '\0', "modes", "N", BIT(MT_CMD_RESPONSE),
           "use the lowest N modes, rigid-body modes included, and the static response of the "
           "others (default: all modes; of 100 bodies or more as many as the range needs, with "
           "shapes of the others that make them as good)"),
    OPTION(MT_OPT_DIRECT, '\0', "direct", NULL, BIT(MT_CMD_RESPONSE),
           "factor the dynamic stiffness at every frequency instead of using modes"),
    OPTION(MT_OPT_POLES, '\0', "poles", NULL, BIT(MT_CMD_RESPONSE),
           "poles and residues, of which every response is the sum: H(s) = sum of residue/(s - "
           "pole) + d0 + d1 s + d2 s^2, s = 2 pi i f (text: the poles alone)"),
    OPTION(
        MT_OPT_STATE_SPACE, '\0', "state-space", "FILE", BIT(MT_CMD_RESPONSE),
        "also write the mechanism between the ports as x' = A x + B u, y = C x + D u: of the "
        "modes up to --to (or of --modes N), with what the others do at rest as residual "
        "shapes. FILE.json: a record; FILE.csv: a table of A, B above C, D; FILE.mtx: Matrix "
        "Market files FILE_A.mtx to FILE_D.mtx. Of one configuration"),
    OPTION(MT_OPT_SENSITIVITY, '\0', "sensitivity", "A,B", BIT(MT_CMD_RESPONSE),
           "change of every peak and antiresonance for 1 % more of these parameters"),
    OPTION(MT_OPT_VIBRATION, '\0', "vibration", "PROFILE",
           BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SIMULATE),
           "a vibration profile, a file or the name of a shipped one, as the acceleration of "
           "the ground. `response` prints RMS, largest tones and peak of every output "
           "(default: the accelerations of all sensors); by default --input is the ground "
           "along the profile's axis and --from and --to are its ends. `simulate` takes one "
           "realisation by --seed, with tones that pass through their ranges once; there "
           "\"base.y=PROFILE\" gives a profile an axis, or another one"),
    OPTION(MT_OPT_DURATION, '\0', "duration", "SECONDS", BIT(MT_CMD_SIMULATE),
           "how long the motion lasts; required"),
    OPTION(
        MT_OPT_DT_OUT, '\0', "dt-out", "SECONDS", BIT(MT_CMD_SIMULATE),
        "time between two lines of the result (default: a hundredth of the duration, or less: "
        "a 24th of the period of a --sine); it does not affect the steps of the integration"),
    REPEATED(
        MT_OPT_START, "start", "JOINT=VALUE", BIT(MT_CMD_SIMULATE),
        "start at rest with this joint (or link's hinge) at a position counted from the "
        "reference position, in rad or m or the model's units (\"pivot=170*deg\"). One joint "
        "is held there until the rest of the mechanism is in equilibrium; several are moved "
        "there together, and the rest follows with the least motion; closed loops begin in the "
        "assembly of the drawing, or are refused; may be repeated"),
    REPEATED(MT_OPT_RATE, "rate", "JOINT=VALUE", BIT(MT_CMD_SIMULATE),
             "start with this joint at a velocity, in rad/s or m/s or the model's units a "
             "second: its second body against its first. Of all motions with these velocities "
             "the one of least kinetic energy is taken, so the lighter of two free bodies "
             "moves more (backwards if it is the first); may be repeated"),
    OPTION(MT_OPT_START_MODE, '\0', "start-mode", "N:AMPLITUDE", BIT(MT_CMD_SIMULATE),
           "start at rest, displaced along vibration mode N by this amplitude at the sensor "
           "that moves most (m, rad if sensors show rotations alone, or the model's units)"),
    REPEATED(
        MT_OPT_PUSH, "input", "PORT=EXPRESSION", BIT(MT_CMD_SIMULATE),
        "an excitation as an expression of the time t: grip.x, the force (grip.r: moment) "
        "along a direction of a sensor, base.x, the acceleration of the ground "
        "(base.x:displacement, base.x:velocity), or a joint, whose coordinate then follows the "
        "expression from where it starts (\"grip.x=10*sin(40*t)*exp(-t)\"); may be repeated"),
    REPEATED(MT_OPT_SINE, "sine", "PORT=AMPLITUDE@HZ", BIT(MT_CMD_SIMULATE),
             "a sine there, in the model's units for a joint or a displacement of the ground; "
             "may be repeated. With a single frequency, the steady motion is read from the "
             "last periods"),
    REPEATED(MT_OPT_SINE_SWEEP, "sine-sweep", "PORT=LEVEL@FROM:TO", BIT(MT_CMD_SIMULATE),
             "a sine of this amplitude there whose frequency runs from FROM to TO Hz over the "
             "duration at a constant rate in octaves a second (\":linear\" behind it: in Hz a "
             "second)"),
    REPEATED(MT_OPT_RANDOM, "random", "PORT=HZ:PSD,...", BIT(MT_CMD_SIMULATE),
             "random vibration there: breakpoints of a power spectral density (base.x: "
             "(m/s^2)^2/Hz) with straight lines in log-log between them, as a sum of sines "
             "with phases by --seed"),
    OPTION(MT_OPT_TOLERANCE, '\0', "tolerance", "X", BIT(MT_CMD_SIMULATE),
           "largest error of a step, relative to the motion so far (default: 1e-11)"),
    OPTION(MT_OPT_INTEGRATE, '\0', "integrate", NULL, BIT(MT_CMD_SIMULATE),
           "integrate the equations of motion also where they are linear at any amplitude and "
           "are solved without"),
    OPTION(MT_OPT_OUTPUT, 'o', "output", "DIR",
           SOLVES | BIT(MT_CMD_REPORT) | BIT(MT_CMD_EXAMPLES),
           "the folder to write to (default: of run and merge `results`, of examples the "
           "current folder, of report none: nothing is written)"),
    OPTION(MT_OPT_FILE, 'o', "output", "FILE", ONE_FILE,
           "the file to write instead of standard output, completely or not at all"),
    OPTION(MT_OPT_VERIFY, '\0', "verify", NULL, SOLVES | BIT(MT_CMD_REPORT),
           "compare the study's published values too; in run and merge they alone decide the "
           "exit status"),
    OPTION(MT_OPT_THREADS, '\0', "threads", "N", ON_STUDIES,
           "number of workers of the search, at most 64 of which are used (default: one for "
           "each processor); the result does not depend on it"),
    OPTION(MT_OPT_TIME, '\0', "time", "SECONDS", SOLVES | BIT(MT_CMD_SIMULATE),
           "time limit for each study, or for the motion, once the files are read; at the "
           "limit the command ends as after an interrupt, with the best result so far"),
    OPTION(MT_OPT_SEED, '\0', "seed", "N", ON_STUDIES | BIT(MT_CMD_SIMULATE),
           "seed of the starting points instead of the study's; of simulate: seed of --random "
           "and --vibration (default: 1)"),
    OPTION(MT_OPT_STARTS, '\0', "starts", "N", ON_STUDIES,
           "number of local searches instead of the study's \"starts\""),
    OPTION(MT_OPT_MAX_EVALUATIONS, '\0', "max-evaluations", "N", ON_STUDIES,
           "limit of evaluated designs instead of the study's \"max_evaluations\""),
    OPTION(MT_OPT_MAX_MODAL_SOLUTIONS, '\0', "max-modal-solutions", "N", ON_STUDIES,
           "limit of modal solutions instead of the study's \"max_modal_solutions\""),
    OPTION(MT_OPT_PROOF, '\0', "proof", "SECONDS", ON_STUDIES,
           "limit of each proof in nominal seconds (1e9 multiplications on any machine) "
           "instead of the study's \"proof_s\" (default: 5); 0: no proof"),
    OPTION(MT_OPT_REPORT, '\0', "report", "html|none", SOLVES,
           "none: write no report.html, and remove an old one with the result that it belongs "
           "to; `modetune report --output` makes it later (default: html)"),
    OPTION(MT_OPT_RESUME, '\0', "resume", NULL, BIT(MT_CMD_RUN),
           "continue from the journal of a run that was killed or interrupted, if there is "
           "one; the result is that of a run without a break"),
    OPTION(MT_OPT_SHARD, '\0', "shard", "PART/PARTS", BIT(MT_CMD_RUN),
           "do only one part of the work and leave a journal for `merge`"),
    OPTION(MT_OPT_REDO, '\0', "redo", NULL, BIT(MT_CMD_MERGE),
           "repeat the tasks of journals from processors that round differently; without it "
           "they are refused"),
    OPTION(MT_OPT_TIMING, '\0', "timing", NULL, SOLVES | BIT(MT_CMD_MODES),
           "print on standard error how often each stage of the evaluations was done or "
           "skipped, and the seconds of all workers"),
    OPTION(MT_OPT_PROGRESS, '\0', "progress", "auto|line|json|none",
           ON_STUDIES | BIT(MT_CMD_MODES),
           "form of the progress on standard error: phase, share done, best objective so far, "
           "time left. line: a line every ten seconds; json: an object a line for programs "
           "(schemas/progress.schema.json); auto: one line that is rewritten on a terminal, "
           "elsewhere as line (default: auto, or with --quiet none)"),
    OPTION(MT_OPT_MAX_MEMORY, '\0', "max-memory", "SIZE", MT_ALL_COMMANDS,
           "limit of the memory that files may make the program use, in bytes, or with k, M, G "
           "or T (1024 each); what needs more ends with exit status 4 (default: half of the "
           "memory of the machine or its container)"),
    OPTION(
        MT_OPT_KIND, '\0', "kind", "stick|mounts|arm|updating|rotor", BIT(MT_CMD_INIT),
        "a model in space and its study to begin with: a stick with two axes, a pump on "
        "rubber mounts, an arm in two postures under gravity, a bracket to be updated from a "
        "test, a camera ball to be kept clear of a rotor (default: a lever in the plane)"),
    OPTION(MT_OPT_RANK, '\0', "rank", "N", BIT(MT_CMD_APPLY) | BIT(MT_CMD_EXPLAIN),
           "which recommendation (default: 1, the best)"),
    OPTION(MT_OPT_MODEL, '\0', "model", "MODEL", BIT(MT_CMD_APPLY) | BIT(MT_CMD_SHOW),
           "the model file, if it is not found from the result"),
    OPTION(MT_OPT_REL_TOL, '\0', "rel-tol", "X", BIT(MT_CMD_DIFF),
           "numbers that differ by no more than this part of them are equal (default: 0; 1e-6 "
           "ignores what another machine or compiler rounds differently)"),
    OPTION(MT_OPT_ABS_TOL, '\0', "abs-tol", "X", BIT(MT_CMD_DIFF),
           "numbers that differ by no more than X, in the units of the results, are equal "
           "(default: 0)"),
    OPTION(MT_OPT_SPECTRUM, '\0', "spectrum", "FROM:TO:N", BIT(MT_CMD_PROFILE),
           "response of one mass on a spring to the profile, for N natural frequencies [Hz] "
           "from FROM to TO in equal ratios"),
    OPTION(MT_OPT_DAMPING_RATIO, '\0', "damping-ratio", "X", BIT(MT_CMD_PROFILE),
           "with --spectrum: the damping ratio of the mass, between 0 and 1 (default: 0.05, Q "
           "= 10)"),
    OPTION(MT_OPT_ROOT, '\0', "root", "DIR", MT_ALL_COMMANDS,
           "files that other files name must lie below DIR (default: the parent of the folder "
           "of the naming file; of a result, of its study's)"),
    OPTION(MT_OPT_FORMAT, '\0', "format", "text|json|csv", MT_ALL_COMMANDS,
           "form of standard output (default: text, of show html); some commands have fewer, "
           "report html, too, check sarif"),
    OPTION(MT_OPT_QUIET, '\0', "quiet", NULL, MT_ALL_COMMANDS,
           "no messages on standard error; errors and warnings stay"),
    OPTION(MT_OPT_HELP, 'h', "help", NULL, MT_ALL_COMMANDS,
           "explain the program, or a command"),
    OPTION(MT_OPT_MANUAL, '\0', "manual", NULL, 0U,
           "print the manual page of the program, or of a command, as man reads it"),
    OPTION(MT_OPT_COMPLETION, '\0', "completion", "bash|zsh", 0U,
           "print a script that completes commands, options and files in that shell"),
    OPTION(MT_OPT_VERSION, '\0', "version", NULL, 0U, "print the version"),
};

const mt_exit mt_exits[MT_EXITS] = {
    {MT_EXIT_DONE, "done, all goals met (with --verify: all published values hold)"},
    {MT_EXIT_GOALS, "done, or out of time, goals not met (diff: the answers differ)"},
    {MT_EXIT_INPUT, "wrong input or usage"},
    {MT_EXIT_NUMERICAL, "numerical failure"},
    {MT_EXIT_SYSTEM, "system failure: file, disk, memory"},
    {MT_EXIT_INTERRUPTED,
     "interrupted by a signal; the best design, or the motion, so far is written"},
};

/* Reading the arguments. */

enum { SUGGESTION_TEXT = 64, MAX_THREADS = 1024 };

/* "; did you mean "x"?" or nothing */
static const char *did_you_mean(const char *name, const char *const *names, int n,
                                const char *dashes, char text[SUGGESTION_TEXT])
{
    const char *const nearest = mt_text_nearest(name, names, n);
    text[0] = '\0';
    if (nearest != NULL) {
        (void)mt_snprintf(text, SUGGESTION_TEXT, "; did you mean \"%s%s\"?", dashes, nearest);
    }
    return text;
}

bool mt_option_is_of(int option, int command)
{
    const unsigned commands = mt_options[option].commands;
    return command == MT_CMD_NONE ? commands == 0U || option == MT_OPT_HELP
                                  : (commands & (1U << (unsigned)command)) != 0U;
}

static bool takes(int command, int option)
{
    return mt_option_is_of(option, command) || option == MT_OPT_VERSION ||
           option == MT_OPT_MANUAL;
}

/* The option of the command that is called so; MT_OPT_NONE: none. */
static int find_option(int command, const char *name, size_t length)
{
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (strlen(mt_options[i].name) == length &&
            strncmp(name, mt_options[i].name, length) == 0 && takes(command, i)) {
            return i;
        }
    }
    return MT_OPT_NONE;
}

/* Names of options before version 1.0, each of which meant something else elsewhere. */
static const struct {
    const char *name;
    unsigned commands;
    mt_option_id now;
} former[] = {
    {"output", BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SIMULATE), MT_OPT_MEASURE},
    {"modes", BIT(MT_CMD_SWEEP), MT_OPT_FREQUENCIES},
    {"mode", BIT(MT_CMD_SIMULATE), MT_OPT_START_MODE},
    {"sweep", BIT(MT_CMD_SIMULATE), MT_OPT_SINE_SWEEP},
    {"profile", SOLVES | BIT(MT_CMD_MODES), MT_OPT_TIMING},
};

/* The option that the command called so before; MT_OPT_NONE: none. */
static int find_former(int command, const char *name, size_t length)
{
    for (int i = 0; i < MT_COUNT(former) && command != MT_CMD_NONE; i++) {
        if (strlen(former[i].name) == length && strncmp(name, former[i].name, length) == 0 &&
            (former[i].commands & BIT(command)) != 0U) {
            return (int)former[i].now;
        }
    }
    return MT_OPT_NONE;
}

/* A word of a command line, quoted where a shell would read it otherwise. */
static void add_shell_word(const char *word, size_t length, mt_text *out)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                "0123456789_./:=,@%+-";
    const bool quoted = length == 0 || strspn(word, plain) < length;
    mt_text_add(out, quoted ? "'" : "");
    for (size_t i = 0; i < length; i++) {
        if (word[i] == '\'') {
            mt_text_add(out, "'\\''");
        } else {
            mt_text_add_n(out, word + i, 1);
        }
    }
    mt_text_add(out, quoted ? "'" : "");
}

/* The command line, as a shell reads it, with the present names of options that had others
 * before. */
static void renew_line(int argc, char *const argv[], int command, mt_text *out)
{
    bool operands_only = false;
    mt_text_add(out, "modetune");
    for (int i = 1; i < argc; i++) {
        const char *const word = argv[i];
        const bool is_long = !operands_only && strncmp(word, "--", 2) == 0 && word[2] != '\0';
        const char *const name = is_long ? word + 2 : word;
        const size_t length = is_long ? strcspn(name, "=") : 0;
        const int renamed = is_long ? find_former(command, name, length) : MT_OPT_NONE;
        const int known =
            renamed == MT_OPT_NONE && is_long ? find_option(command, name, length) : renamed;
        operands_only = operands_only || strcmp(word, "--") == 0;
        mt_text_add(out, " ");
        if (renamed == MT_OPT_NONE) {
            add_shell_word(word, strlen(word), out);
        } else {
            mt_text_addf(out, "--%s", mt_options[renamed].name);
            if (name[length] != '\0') {
                add_shell_word(name + length, strlen(name + length), out);
            }
        }
        if (known != MT_OPT_NONE && mt_options[known].value != NULL && name[length] == '\0' &&
            i + 1 < argc) {
            mt_text_add(out, " ");
            i++;
            add_shell_word(argv[i], strlen(argv[i]), out);
        }
    }
}

static mt_status unknown_option(const mt_args *args, const char *name, size_t length,
                                mt_err *err)
{
    const int command = args->command;
    const int now = find_former(command, name, length);
    const char *names[MT_OPT_IDS];
    char given[SUGGESTION_TEXT];
    char suggestion[SUGGESTION_TEXT];
    int n = 0;
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (takes(command, i)) {
            names[n++] = mt_options[i].name;
        }
    }
    length = length < sizeof given ? length : sizeof given - 1;
    memcpy(given, name, length);
    given[length] = '\0';
    if (now != MT_OPT_NONE) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" has no option \"--%s\": it is called \"--%s\"",
                       args->commands[command]->name, given, mt_options[now].name);
    }
    for (int i = 0; i < MT_OPT_IDS; i++) {
        if (strcmp(given, mt_options[i].name) == 0 && command != MT_CMD_NONE) {
            return mt_fail(err, MT_E_USAGE, "\"%s\" has no option \"--%s\"",
                           args->commands[command]->name, given);
        }
    }
    return mt_fail(err, MT_E_USAGE, "unknown option \"--%s\"%s", given,
                   did_you_mean(given, names, n, "--", suggestion));
}

/* Read a whole number of at least 1. */
static mt_status read_count(const char *s, const char *option, int most, int *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const long value = strtol(s, &end, 10);
    if (s[0] < '0' || s[0] > '9' || *end != '\0' || errno != 0 || value < 1 || value > most) {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not a whole number from 1 to %d",
                       option, s, most);
    }
    *out = (int)value;
    return MT_OK;
}

/* A number from 0 up to, and without, `most`. */
static bool read_below(const char *s, double most, double *out)
{
    char *end = NULL;
    *out = strtod(s, &end);
    return s[0] != '\0' && strspn(s, "0123456789.eE+-") == strlen(s) && *end == '\0' &&
           *out >= 0.0 && *out < most;
}

/* "0.1,0,-2e-3": three coordinates. */
static mt_status read_point(const char *s, const char *option, double out[3], mt_err *err)
{
    const char *at = s;
    bool good = strspn(s, "0123456789.eE+-,") == strlen(s);
    for (int i = 0; i < 3 && good; i++) {
        char *end = NULL;
        out[i] = strtod(at, &end);
        good = end != at && *end == (i < 2 ? ',' : '\0') && isfinite(out[i]);
        at = end + 1;
    }
    return good ? MT_OK
                : mt_fail(err, MT_E_USAGE,
                          "--%s: \"%s\" is not a point X,Y,Z, three numbers of metres", option,
                          s);
}

static mt_status read_absolute(const char *s, double *out, mt_err *err)
{
    return read_below(s, HUGE_VAL, out)
               ? MT_OK
               : mt_fail(err, MT_E_USAGE, "--abs-tol: \"%s\" is not a number from 0", s);
}

static mt_status read_tolerance(const char *s, const char *option, double *out, mt_err *err)
{
    double value = 0.0;
    if (!read_below(s, 1.0, &value)) {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not a number from 0 up to 1", option,
                       s);
    }
    *out = value;
    return MT_OK;
}

/* Read seconds: above 0, or 0 where allowed. */
static mt_status read_seconds(const char *s, const char *option, bool zero, double most,
                              double *out, mt_err *err)
{
    char *end = NULL;
    const double value = strtod(s, &end);
    const bool is_number = strspn(s, "0123456789.eE+-") == strlen(s) && *end == '\0';
    const bool is_enough = zero ? value >= 0.0 : value > 0.0;
    if (!is_number || !is_enough || !(value <= most)) {
        return mt_fail(err, MT_E_USAGE,
                       "--%s: \"%s\" is not a number of seconds %s, at most %g", option, s,
                       zero ? "from 0" : "above 0", most);
    }
    *out = value;
    return MT_OK;
}

/* Read a seed, with the range of a study's seed. */
static mt_status read_seed(const char *s, const char *option, unsigned long *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const unsigned long value = strtoul(s, &end, 10);
    if (s[0] < '0' || s[0] > '9' || *end != '\0' || errno != 0 || value > INT_MAX) {
        return mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not a whole number from 0 to %d",
                       option, s, INT_MAX);
    }
    *out = value;
    return MT_OK;
}

/* A size on the command line: a whole number of bytes, or with k, M, G, T (1024 each). */
static mt_status read_size(const char *text, uint64_t *bytes, mt_err *err)
{
    static const char units[] = "kMGT";
    const uint64_t kib = 1024;
    const uint64_t least = kib * kib;
    const uint64_t most = (uint64_t)1 << 50U;
    uint64_t size = 0;
    const char *s = text;
    for (; *s >= '0' && *s <= '9' && size <= most; s++) {
        size = 10 * size + (uint64_t)(*s - '0');
    }
    const char *const unit = s == text || *s == '\0' ? NULL : strchr(units, *s);
    for (const char *u = units; unit != NULL && u <= unit && size <= most; u++) {
        size *= kib;
    }
    s += unit == NULL ? 0 : 1;
    if (*s != '\0' || size < least || size > most) {
        return mt_fail(err, MT_E_USAGE,
                       "--max-memory: \"%s\" is not a size from 1M to 1024T (\"500M\", \"8G\")",
                       text);
    }
    *bytes = size;
    return MT_OK;
}

/* "2/8": part 2 of 8. */
static mt_status read_part(const char *s, const char *option, mt_args *out, mt_err *err)
{
    char *end = NULL;
    errno = 0;
    const long part = strtol(s, &end, 10);
    const char *const second = *end == '/' ? end + 1 : s;
    const long parts = strtol(second, &end, 10);
    if (s[0] < '0' || s[0] > '9' || second == s || second[0] < '0' || second[0] > '9' ||
        *end != '\0' || errno != 0 || part < 1 || part > parts || parts > INT_MAX) {
        return mt_fail(
            err, MT_E_USAGE,
            "--%s: \"%s\" is not PART/PARTS, two whole numbers from 1/1 on with PART "
            "not above PARTS",
            option, s);
    }
    out->part = (int)part;
    out->parts = (int)parts;
    return MT_OK;
}

const char *mt_format_of(int format, int command)
{
    enum {
        SHOW = 1 << MT_CMD_SHOW,
        PAGES = SHOW | 1 << MT_CMD_REPORT,
        MODEL = 1 << MT_CMD_APPLY,
        PROSE = 1 << MT_CMD_HELP
    };
    static const struct {
        const char *name;
        unsigned commands;
    } formats[MT_FORMATS] = {
        [MT_FORMAT_TEXT] = {"text", MT_ALL_COMMANDS & ~(unsigned)SHOW},
        [MT_FORMAT_JSON] = {"json", MT_ALL_COMMANDS & ~(unsigned)PROSE},
        [MT_FORMAT_CSV] = {"csv", MT_ALL_COMMANDS & ~(unsigned)(SHOW | MODEL | PROSE)},
        [MT_FORMAT_HTML] = {"html", PAGES},
        [MT_FORMAT_SARIF] = {"sarif", 1U << (unsigned)MT_CMD_CHECK}};
    const bool of = command == MT_CMD_NONE ? format <= MT_FORMAT_CSV
                                           : (formats[format].commands >> command & 1U) != 0U;
    return of ? formats[format].name : NULL;
}

/* One of a few words: *out its place among them. */
static mt_status read_word(const char *s, const char *option, const char *const *names, int n,
                           int *out, mt_err *err)
{
    char suggestion[SUGGESTION_TEXT];
    mt_text list = {.s = NULL};
    for (int i = 0; i < n; i++) {
        if (strcmp(s, names[i]) == 0) {
            *out = i;
            mt_text_free(&list);
            return MT_OK;
        }
        mt_text_addf(&list, "%s%s", i == 0 ? "" : ", ", names[i]);
    }
    const mt_status rc =
        list.failed ? mt_fail_memory(err)
                    : mt_fail(err, MT_E_USAGE, "--%s: \"%s\" is not one of %s%s", option, s,
                              list.s, did_you_mean(s, names, n, "", suggestion));
    mt_text_free(&list);
    return rc;
}

static mt_status read_format(const char *s, int command, mt_format *out, mt_err *err)
{
    const char *names[MT_FORMATS];
    mt_format of[MT_FORMATS];
    int at = 0;
    int n = 0;
    for (int i = 0; i < MT_FORMATS; i++) {
        const char *const known = mt_format_of(i, command);
        if (known != NULL) {
            of[n] = (mt_format)i;
            names[n++] = known;
        }
    }
    MT_TRY(read_word(s, "format", names, n, &at, err));
    *out = of[at];
    return MT_OK;
}

static mt_status read_report(const char *s, const char *option, bool *none, mt_err *err)
{
    static const char *const names[] = {"html", "none"};
    int at = 0;
    MT_TRY(read_word(s, option, names, MT_COUNT(names), &at, err));
    *none = at == 1;
    return MT_OK;
}

static mt_status read_progress(const char *s, const char *option, mt_progress_form *out,
                               mt_err *err)
{
    static const char *const names[] = {"auto", "line", "json", "none"};
    int at = 0;
    MT_TRY(read_word(s, option, names, MT_COUNT(names), &at, err));
    *out = (mt_progress_form)at;
    return MT_OK;
}

static mt_status read_shell(const char *s, const char *option, mt_shell *out, mt_err *err)
{
    static const char *const names[MT_SHELL_COUNT] = {"bash", "zsh"};
    int at = 0;
    MT_TRY(read_word(s, option, names, MT_COUNT(names), &at, err));
    *out = (mt_shell)at;
    return MT_OK;
}

static mt_status store_option_value(mt_args *args, int option, const char *value, mt_err *err)
{
    const mt_option *const o = &mt_options[option];
    if (args->given[option] && o->value != NULL && !o->repeats) {
        return mt_fail(err, MT_E_USAGE, "--%s is given twice", o->name);
    }
    args->given[option] = true;
    args->value[option] = value;
    if (value == NULL) {
        return MT_OK;
    }
    if (value[0] == '\0') {
        return mt_fail(err, MT_E_USAGE, "--%s: the value is empty", o->name);
    }
    if (o->repeats) {
        args->repeats[args->n_repeats++] =
            (mt_repeat){.option = (mt_option_id)option, .value = value};
        return MT_OK;
    }
    switch (option) {
    case MT_OPT_ABOUT:
        return read_point(value, o->name, args->about_m, err);
    case MT_OPT_POINTS:
        return read_count(value, o->name, MT_CURVE_MOST, &args->points, err);
    case MT_OPT_KEEP:
        return read_count(value, o->name, INT_MAX, &args->keep, err);
    case MT_OPT_COUNT:
        args->count = INT_MAX;
        return strcmp(value, "all") == 0 ||
                       read_count(value, o->name, INT_MAX, &args->count, NULL) == MT_OK
                   ? MT_OK
                   : mt_fail(err, MT_E_USAGE,
                             "--%s: \"%s\" is neither \"all\" nor a whole number from 1 to %d",
                             o->name, value, INT_MAX);
    case MT_OPT_RANK:
        return read_count(value, o->name, INT_MAX, &args->rank, err);
    case MT_OPT_MODE:
        return read_count(value, o->name, INT_MAX, &args->mode, err);
    case MT_OPT_STARTS:
        return read_count(value, o->name, MT_STARTS_MOST, &args->starts, err);
    case MT_OPT_MAX_EVALUATIONS:
        return read_count(value, o->name, INT_MAX, &args->max_evaluations, err);
    case MT_OPT_MAX_MODAL_SOLUTIONS:
        return read_count(value, o->name, INT_MAX, &args->max_modal_solutions, err);
    case MT_OPT_THREADS:
        MT_TRY(read_count(value, o->name, MAX_THREADS, &args->threads, err));
        args->threads = args->threads < MT_WORKERS_MOST ? args->threads : MT_WORKERS_MOST;
        return MT_OK;
    case MT_OPT_TIME:
        return read_seconds(value, o->name, false, MT_SECONDS_MOST, &args->time_s, err);
    case MT_OPT_DURATION:
        return read_seconds(value, o->name, false, MT_SECONDS_MOST, &args->duration_s, err);
    case MT_OPT_DT_OUT:
        return read_seconds(value, o->name, false, MT_SECONDS_MOST, &args->dt_out_s, err);
    case MT_OPT_TOLERANCE:
        return read_tolerance(value, o->name, &args->tolerance, err);
    case MT_OPT_PROOF:
        return read_seconds(value, o->name, true, mt_possible_of[MT_POSSIBLE_PROOF].most,
                            &args->proof_s, err);
    case MT_OPT_SEED:
        return read_seed(value, o->name, &args->seed, err);
    case MT_OPT_REL_TOL:
        return read_tolerance(value, o->name, &args->rel_tol, err);
    case MT_OPT_ABS_TOL:
        return read_absolute(value, &args->abs_tol, err);
    case MT_OPT_SHARD:
        return read_part(value, o->name, args, err);
    case MT_OPT_MAX_MEMORY:
        return read_size(value, &args->max_memory, err);
    case MT_OPT_REPORT:
        return read_report(value, o->name, &args->no_report, err);
    case MT_OPT_PROGRESS:
        return read_progress(value, o->name, &args->progress, err);
    case MT_OPT_COMPLETION:
        return read_shell(value, o->name, &args->shell, err);
    case MT_OPT_FORMAT:
        return read_format(value, args->command, &args->format, err);
    default:
        return MT_OK;
    }
}

/* The argument at *at is an option: read it, with its value from the same or the next
 * argument. */
static mt_status read_long(mt_args *args, int argc, char *const argv[], int *at, mt_err *err)
{
    const char *const name = argv[*at] + 2;
    const size_t length = strcspn(name, "=");
    const int option = find_option(args->command, name, length);
    if (option == MT_OPT_NONE) {
        if (find_former(args->command, name, length) != MT_OPT_NONE) {
            renew_line(argc, argv, args->command, &args->renewed);
        }
        return unknown_option(args, name, length, err);
    }
    const bool attached = name[length] == '=';
    if (mt_options[option].value == NULL) {
        return attached
                   ? mt_fail(err, MT_E_USAGE, "--%s takes no value", mt_options[option].name)
                   : store_option_value(args, option, NULL, err);
    }
    if (!attached && *at + 1 >= argc) {
        return mt_fail(err, MT_E_USAGE, "--%s needs a value: %s", mt_options[option].name,
                       mt_options[option].value);
    }
    return store_option_value(args, option, attached ? name + length + 1 : argv[++*at], err);
}

static mt_status read_short(mt_args *args, int argc, char *const argv[], int *at, mt_err *err)
{
    const char *const text = argv[*at] + 1;
    for (int i = 0; i < MT_OPT_IDS; i++) {
        const mt_option *const o = &mt_options[i];
        if (o->letter != text[0] || !takes(args->command, i)) {
            continue;
        }
        if (o->value == NULL) {
            return text[1] == '\0' ? store_option_value(args, i, NULL, err)
                                   : mt_fail(err, MT_E_USAGE, "-%c takes no value", o->letter);
        }
        if (text[1] == '\0' && *at + 1 >= argc) {
            return mt_fail(err, MT_E_USAGE, "-%c needs a value: %s", o->letter, o->value);
        }
        return store_option_value(args, i, text[1] != '\0' ? text + 1 : argv[++*at], err);
    }
    return mt_fail(err, MT_E_USAGE, "unknown option \"-%s\"", text);
}

/* The command of that name among these [MT_CMD_IDS]; MT_CMD_NONE: none. */
static int find_command(const mt_command *const *commands, const char *name)
{
    for (int i = 0; i < MT_CMD_IDS; i++) {
        if (strcmp(commands[i]->name, name) == 0) {
            return i;
        }
    }
    return MT_CMD_NONE;
}

static mt_status read_command(mt_args *args, const char *name, mt_err *err)
{
    const char *names[MT_CMD_IDS];
    char suggestion[SUGGESTION_TEXT];
    args->command = find_command(args->commands, name);
    if (args->command != MT_CMD_NONE) {
        return MT_OK;
    }
    for (int i = 0; i < MT_CMD_IDS; i++) {
        names[i] = args->commands[i]->name;
    }
    return mt_fail(err, MT_E_USAGE, "unknown command \"%s\"%s", name,
                   did_you_mean(name, names, MT_CMD_IDS, "", suggestion));
}

static mt_status check_operands(const mt_args *args, mt_err *err)
{
    if (args->given[MT_OPT_HELP] || args->given[MT_OPT_MANUAL] ||
        args->given[MT_OPT_COMPLETION] || args->given[MT_OPT_VERSION]) {
        return MT_OK;
    }
    if (args->command == MT_CMD_NONE) {
        return mt_fail(err, MT_E_USAGE, "a command is missing");
    }
    const mt_command *const c = args->commands[args->command];
    if (args->n_operands < c->least) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" needs %s", c->name, c->operands);
    }
    if (c->most >= 0 && args->n_operands > c->most) {
        return mt_fail(err, MT_E_USAGE, "\"%s\" takes %s, and \"%s\" is too many", c->name,
                       c->operands, args->operands[c->most]);
    }
    return MT_OK;
}

/* The values of each option that may be repeated, one behind the other. */
static void group_repeated_values(mt_args *args)
{
    const char **at = args->pool;
    for (int option = 0; option < MT_OPT_IDS; option++) {
        mt_values *const to = &args->all[option];
        *to = (mt_values){.value = at};
        for (int i = 0; i < args->n_repeats; i++) {
            if (args->repeats[i].option == (mt_option_id)option) {
                to->value[to->n++] = args->repeats[i].value;
            }
        }
        at += to->n;
    }
}

mt_status mt_args_parse(int argc, char *const argv[], const mt_command *const *commands,
                        mt_args *out, mt_err *err)
{
    const size_t room = argc > 0 ? (size_t)argc : 1;
    bool operands_only = false;
    *out = (mt_args){.commands = commands, .command = MT_CMD_NONE, .rank = 1, .threads = 1};
    out->operands = calloc(room, sizeof *out->operands);
    out->pool = calloc(room, sizeof *out->pool);
    out->repeats = calloc(room, sizeof *out->repeats);
    if (out->operands == NULL || out->pool == NULL || out->repeats == NULL) {
        return mt_fail(err, MT_E_MEMORY, "out of memory");
    }
    for (int i = 1; i < argc; i++) {
        const char *const s = argv[i];
        mt_status rc = MT_OK;
        if (!operands_only && strcmp(s, "--") == 0) {
            operands_only = true;
        } else if (!operands_only && strncmp(s, "--", 2) == 0) {
            rc = read_long(out, argc, argv, &i, err);
        } else if (!operands_only && s[0] == '-' && s[1] != '\0') {
            rc = read_short(out, argc, argv, &i, err);
        } else if (out->command == MT_CMD_NONE) {
            rc = read_command(out, s, err);
        } else {
            out->operands[out->n_operands++] = s;
        }
        MT_TRY(rc);
    }
    group_repeated_values(out);
    return check_operands(out, err);
}

void mt_args_free(mt_args *args)
{
    free((void *)args->operands);
    free((void *)args->pool);
    free(args->result_path);
    free(args->repeats);
    mt_text_free(&args->renewed);
    *args = (mt_args){.command = MT_CMD_NONE};
}

mt_io_options mt_cli_io(const mt_args *args)
{
    const mt_io_options opt = {.root = args->value[MT_OPT_ROOT]};
    return opt;
}
