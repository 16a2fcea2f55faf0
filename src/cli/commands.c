/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tables that describe the command line. */
#include "cli/args.h"
#include "cli/terminal.h"

#define BIT(command) (1U << (unsigned)(command))
#define ON_MODELS                                                                         \
    (BIT(MT_CMD_MODES) | BIT(MT_CMD_SWEEP) | BIT(MT_CMD_SENSITIVITY) | BIT(MT_CMD_INFO) | \
     BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SHOW) | BIT(MT_CMD_SIMULATE))
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
    OPTION(MT_OPT_DRIVE, '\0', "drive", "JOINT=FROM:TO:N", BIT(MT_CMD_SWEEP),
           "the joint (or a link's hinge) that is driven, through N positions counted from the "
           "reference position, in rad or m or the model's units; FROM and TO may be "
           "expressions (\"pivot=-10*deg:10*deg:21\")"),
    OPTION(MT_OPT_HOLD, '\0', "hold", "SPRING", BIT(MT_CMD_SWEEP),
           "re-adjust this spring so that it holds the joint at each position (default: the "
           "joint is locked)"),
    OPTION(MT_OPT_MODES, '\0', "modes", NULL, BIT(MT_CMD_SWEEP),
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
    REPEATED(MT_OPT_SEEN, "output", "PORT", BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SIMULATE),
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
    OPTION(MT_OPT_ALONG, '\0', "mode", "N:AMPLITUDE", BIT(MT_CMD_SIMULATE),
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
    REPEATED(MT_OPT_CHIRP, "sweep", "PORT=LEVEL@FROM:TO", BIT(MT_CMD_SIMULATE),
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
           SOLVES | BIT(MT_CMD_REPORT) | BIT(MT_CMD_EXAMPLES) | BIT(MT_CMD_SHOW),
           "folder for the results (default: of run and merge `results`, of examples the "
           "current folder, of report none: nothing is written); of show: the file to write "
           "instead of standard output"),
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
    OPTION(MT_OPT_PROFILE, '\0', "profile", NULL, SOLVES | BIT(MT_CMD_MODES),
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
           "form of standard output (default: text); report also has html, check sarif; show "
           "has html (its default) and json, apply text and json, help text"),
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

#define COMMAND(id, name_, operands_, least_, most_, summary_, details_) \
    [id] = {.name = (name_),                                             \
            .operands = (operands_),                                     \
            .least = (least_),                                           \
            .most = (most_),                                             \
            .summary = (summary_),                                       \
            .details = (details_)}

const mt_command mt_commands[MT_CMD_IDS] = {
    COMMAND(
        MT_CMD_RUN, "run", "STUDY...", 1, -1, "solve studies and write the results",
        "Solves each study, prints a summary and writes the result into DIR/<study file name "
        "without .json>/: result.json, recommendations.csv, report.html, timing.json, "
        "trade.csv (of a trade study) and curves.csv (if the study lists responses). A run "
        "that fails or is killed leaves the old result, or one that the next run repairs.\n"
        "Several studies are answered one after the other, whatever happens to each. A table "
        "at the end, and index.json and index.html in DIR, list what became of them.\n"
        "After an interrupt (Ctrl-C) the best designs so far are written, and run.incomplete "
        "of the result lists what is missing. --resume continues from the journal that every "
        "run keeps while it works."),
    COMMAND(MT_CMD_MERGE, "merge", "STUDY JOURNAL...", 2, -1,
            "join the parts of a study's work",
            "Reads the journals that `run --shard PART/PARTS` left in DIR/<study file name "
            "without .json>.PART-of-PARTS.journal, does the remaining work, and prints and "
            "writes what `run` would have printed and written. A journal of another study, "
            "model, program or library is refused; the work of a damaged line is repeated."),
    COMMAND(MT_CMD_COMPARE, "compare", "STUDY...", 1, -1, "published against computed values",
            "Solves each study and prints its published values beside the computed ones, with "
            "differences, roles and sources. Writes no files. The exit status is 0 if all "
            "values hold, and 1 otherwise."),
    COMMAND(
        MT_CMD_MODES, "modes", "MODEL", 1, 1, "natural frequencies and mode shapes",
        "Prints the modes of each configuration: rigid-body, flexible, unstable and undecided "
        "ones (rounding hides whether such a mode is stable, and it has no index). Each has a "
        "bound of the error of its frequency (in JSON and CSV; in the table if it exceeds 1e-6 "
        "of the frequency) and its residual and orthogonality relative to rounding (about 1 is "
        "perfect). Redundant joints and the way to the equilibrium are listed. Shapes are "
        "mass-normalised. Names of modes are shown if --set changes nothing."),
    COMMAND(
        MT_CMD_MAC, "mac", "MODEL:CONFIGURATION MODEL:CONFIGURATION", 2, 2,
        "pair and correlate two sets of modes",
        "Compares shapes at the sensors that both models have, pairs the modes one to one, and "
        "compares repeated modes as subspaces. Beside displacements, a rotation counts as its "
        "arc at the length of the first model. The configuration may be omitted if a model has "
        "only one. The default number of modes is that of the common sensor channels."),
    COMMAND(MT_CMD_SWEEP, "sweep", "MODEL", 1, 1,
            "positions and frequencies over a range of motion",
            "Drives a joint through a range (--drive) and prints at each position the "
            "coordinate of every joint, its ratio to the driven one (an exact derivative), "
            "what holds the joint, and with --modes the natural frequencies by index (default: "
            "6). If a limit position ends the range, the positions before it are printed, a "
            "message names the limit, and the exit status is 3."),
    COMMAND(
        MT_CMD_SIMULATE, "simulate", "MODEL", 1, 1, "motion in time, of any amplitude",
        "Integrates the nonlinear equations of motion of one configuration, and so checks "
        "what the other commands compute for small motions. Where bodies only slide along "
        "fixed lines and turn about fixed axes, and all forces grow in proportion, the "
        "equations are linear: then the motion is exact, by the matrix exponential, and the "
        "last lines say so. The motion begins at rest in "
        "equilibrium unless --start, --rate or --mode say otherwise; --input, --sine, "
        "--sweep, --random and --vibration excite it. Prints the outputs over time and "
        "what they show: for a free motion its turns and its tones (frequency, damping, "
        "amplitude), under a sine the steady amplitudes and phases, the balance of energy, "
        "and the largest drift of a joint in a step before it was corrected.\n"
        "Springs, viscous dampers, loads and masses are those of the model; bars and beams "
        "of consistent mass move their mass with their frame. Where springs are so stiff that "
        "their vibrations are far faster than the motion, steps solve these beforehand.\n"
        "After an interrupt (Ctrl-C), or at the end of --time, the motion so far is "
        "printed, and the exit status is 130 or 1. The exit status is 3 if the motion "
        "reaches a dead centre, or if an input acts in a direction without mass."),
    COMMAND(MT_CMD_SENSITIVITY, "sensitivity", "MODEL", 1, 1,
            "change of each frequency per per cent of each parameter",
            "Prints exact derivatives of the first natural frequencies (default: 6): the "
            "change in Hz for 1 % more of a parameter. Repeated modes have directional "
            "derivatives, given as a set."),
    COMMAND(
        MT_CMD_RESPONSE, "response", "MODEL", 1, 1,
        "frequency response to forces and a moving ground",
        "Prints the frequency response of each output to each input, about the equilibrium, "
        "with the model's damping: peaks and antiresonances first, then magnitude and phase "
        "over frequency. The phase is that of the output against the input, negative if the "
        "output lags. A resonance without damping has no height, which a note says.\n"
        "With --vibration it prints for each output the RMS of the response to the random "
        "parts of a profile, the largest amplitude under each tone, and the peak of both.\n"
        "A configuration that is unstable, has motions that grow, or whose stability rounding "
        "hides, is refused; so is the force of a joint that is redundant with others."),
    COMMAND(MT_CMD_INFO, "info", "MODEL", 1, 1,
            "masses, mobility and redundancies of each configuration",
            "Prints for each configuration, in the position about which it is linearised, the "
            "total mass, its centre and inertia, the degrees of freedom, and the sets of "
            "redundant joints. Where a number of the model depends on a sign, an axis or an "
            "order of bodies (preloads, free angles, moments, gear ratios, products of "
            "inertia, sections, bushings), it states how the number is understood."),
    COMMAND(MT_CMD_SHOW, "show", "MODEL|RESULT.json", 1, 1, "the mechanism in three dimensions",
            "Prints a page that opens in any browser and needs no other file. It shows bodies "
            "with their ellipsoids of inertia, links, joints with their axes and their "
            "distance from their bodies, springs, dampers and sensors; the lowest 12 vibration "
            "modes in motion, with the share of energy of every spring and body; and the range "
            "of a driven joint. For a result, or its folder, it shows the original design and "
            "the recommended ones, with the model that apply finds.\n"
            "--format json prints what the page draws, --svg a still picture. A configuration "
            "that cannot be analysed is drawn as far as possible, and a message says why."),
    COMMAND(MT_CMD_REPORT, "report", "RESULT.json", 1, 1, "a result as text, CSV or HTML",
            "Prints the summary that run printed (--format csv: recommendations.csv, html: "
            "report.html, json: the result) from the result, or its folder, alone. It needs no "
            "study and solves nothing; only the page's view of the mechanism needs the model, "
            "and is omitted if apply would not find it. --output writes all files again into "
            "DIR/<study file name without .json>/, as run does, except timing.json, which is "
            "copied if it lies beside the result. A result.json whose neighbours were changed "
            "or belong to another run is refused; a copy by itself is read."),
    COMMAND(MT_CMD_EXPLAIN, "explain", "RESULT.json", 1, 1,
            "what moves each goal, what limits the design, at what price",
            "Prints for each goal of a recommendation the parameters that move it, the "
            "strongest first: the effect of 1 % more of each, and how far it may still go "
            "within its bounds. The bounds, bands and limits that hold the design follow, with "
            "their prices. It needs the result, or its folder, alone and solves nothing. "
            "--format csv has one row for each goal and parameter."),
    COMMAND(
        MT_CMD_APPLY, "apply", "RESULT.json", 1, 1, "the model with the recommended values",
        "Prints the model file with the recommended values; the rest of its text stays as it "
        "is. The model is found from the result, or its folder, and must be the one that was "
        "solved (same SHA-256) unless --model names it. A result.json whose neighbours were "
        "changed or belong to another run is refused; a copy by itself is read."),
    COMMAND(
        MT_CMD_DIFF, "diff", "RESULT RESULT", 2, 2, "differences between two results",
        "Compares two results (each a result.json or its folder), also of different studies or "
        "versions of the program: status, designs with their parameters, objectives, "
        "frequencies, MAC and goals, certificates and all else. It lists what only one of them "
        "has. How the answers were made (versions, seed, evaluations, digests of the files) is "
        "listed but does not count as a difference; sentences and measures of rounding are not "
        "compared.\n"
        "The text omits what follows from what it shows (errors, derivatives, changes); JSON "
        "and CSV have everything, with JSON pointers into both files. The exit status is 0 if "
        "the answers are equal, 1 if they differ, and 2 or more if they cannot be compared."),
    COMMAND(MT_CMD_CHECK, "check", "FILE...", 1, -1,
            "validate model, study, result, aircraft and profile files",
            "Reads each file by its \"format\" and prints every problem as file:line:column: "
            "error: /json/pointer: message.\n"
            "Warnings concern suspicious values: numbers that look like other units, joints "
            "off their links, bands that no mode comes near. Notes state what to know of every "
            "configuration, or of those that a study names: free motions, unstable directions, "
            "redundant joints.\n"
            "--format json has the same by members (file, line, column, pointer, severity, "
            "message), --format sarif as SARIF 2.1.0 for code hosts and editors. Paths are "
            "relative to the current folder, which should be that of the repository."),
    COMMAND(MT_CMD_INIT, "init", "[DIR]", 0, 1, "a model and a study to begin with",
            "Writes model.json, study.json and their schemas, which let an editor complete "
            "them, into the folder (default: the current one), creates it if necessary, and "
            "prints the paths. Each part of the model has a description; the study asks a "
            "question that it answers within seconds. --kind chooses among models. If one of "
            "the files exists with other "
            "contents, nothing is written."),
    COMMAND(MT_CMD_EXAMPLES, "examples", "[NAME...]", 0, -1,
            "the studies that are part of the program",
            "Lists the studies. With names: writes these studies into DIR/studies, and the "
            "models, references and schemas that they name beside it, and prints the paths. If "
            "one of the files exists with other contents, nothing is written."),
    COMMAND(MT_CMD_SCHEMA, "schema", "[NAME]", 0, 1, "the JSON Schemas of all files",
            "Lists the schemas. With a name (model, study, result, ...): prints that schema."),
    COMMAND(MT_CMD_PROFILE, "profile", "[PROFILE]", 0, 1, "what a vibration profile requires",
            "Prints the breakpoints of the random parts of a profile with their slopes and "
            "overall RMS, and its tones, with the harmonics of rotors in Hz, each with origin "
            "and source. A message lists what is assumed, or unconfirmed by a public document. "
            "PROFILE is a file, or the name of a profile that is part of the program; without "
            "it, these are listed.\n"
            "--spectrum prints the response of one mass on a spring whose base follows the "
            "profile: the RMS of its absolute acceleration, with a bound of the error; the "
            "largest peaks of the tones over their ranges, proven; and both combined by the "
            "profile's rule (default: 3 times the RMS plus the sum of all tones). --format csv "
            "has one row for each segment and tone, or for each natural frequency."),
    COMMAND(MT_CMD_HELP, "help", "[TOPIC]", 0, 1,
            "what the documents say of a command or a word",
            "Prints the sections of the documents about a topic: a command, or a member of a "
            "model, a study or a result (avoid, bushing, margin_percent). Explanations come "
            "first, then the reference of the file formats. Without a topic: lists all "
            "commands and topics."),
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
