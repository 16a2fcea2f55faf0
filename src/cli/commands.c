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
    REPEATED(
        MT_OPT_SET, "set", "NAME=VALUE", ON_MODELS | ON_STUDIES,
        "give a parameter another value, a number in its unit, or an expression in SI units, "
        "which may use the model's own values (\"k=1.1*k\"); may be repeated; of a study: one "
        "that it does not vary"),
    OPTION(
        MT_OPT_COUNT, '\0', "count", "N",
        BIT(MT_CMD_MODES) | BIT(MT_CMD_MAC) | BIT(MT_CMD_SWEEP) | BIT(MT_CMD_SENSITIVITY),
        "only the first N vibration modes; of large mechanisms that are trees, or that nothing "
        "loads, `modes` and `sensitivity` find them without the others"),
    OPTION(MT_OPT_SHAPES, '\0', "shapes", NULL, BIT(MT_CMD_MODES),
           "mode shapes at the sensors, or of the bodies where there are none"),
    OPTION(MT_OPT_DAMPED, '\0', "damped", NULL, BIT(MT_CMD_MODES),
           "complex modes, too, with all that damps (dampers, damping ratios, loss factors): "
           "natural and damped frequencies, damping ratios; real roots are overdamped (as CSV "
           "these modes alone)"),
    OPTION(
        MT_OPT_DRIVE, '\0', "drive", "JOINT=FROM:TO:N", BIT(MT_CMD_SWEEP),
        "the joint (or a link's hinge) and N positions of it from the reference position, "
        "numbers in rad or m, or in the model's units where it names some; FROM and TO may be "
        "expressions (\"pivot=-10*deg:10*deg:21\")"),
    OPTION(MT_OPT_HOLD, '\0', "hold", "SPRING", BIT(MT_CMD_SWEEP),
           "trim this spring so that it holds the joint (default: the joint is locked)"),
    OPTION(MT_OPT_MODES, '\0', "modes", NULL, BIT(MT_CMD_SWEEP),
           "natural frequencies at each position"),
    OPTION(MT_OPT_SVG, '\0', "svg", NULL, BIT(MT_CMD_SHOW),
           "one still picture of one configuration (default: the first), as SVG"),
    OPTION(MT_OPT_MODE, '\0', "mode", "N", BIT(MT_CMD_SHOW),
           "with --svg: vibration mode N beside the shape at rest"),
    OPTION(MT_OPT_PARAMETERS, '\0', "parameters", "A,B", BIT(MT_CMD_SENSITIVITY),
           "parameters to vary (default: all that are not made of others)"),
    REPEATED(
        MT_OPT_INPUT, "input", "PORT", BIT(MT_CMD_RESPONSE),
        "what shakes: grip.x, the force (grip.rx: moment) along a direction of a sensor, or "
        "base.x, the acceleration of the ground (base.x:displacement, base.x:velocity); may "
        "be repeated"),
    REPEATED(
        MT_OPT_SEEN, "output", "PORT", BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SIMULATE),
        "what is looked at: grip.x, grip.x:velocity, grip.x:acceleration, a sensor's motion; "
        "may be repeated (default: the displacements of all sensors). Of response it is that "
        "in space (grip.x:relative_acceleration: against the ground), and there are "
        "spring.NAME and damper.NAME, the force or torque in it (of a bushing spring.NAME.x, "
        "spring.NAME.rx, a component of it), and joint.NAME.x, the force of a joint's first "
        "body on its second. Of simulate displacements, from the rest "
        "position, and velocities are against the ground, accelerations in space, and there "
        "are joints' coordinates (pivot, pivot:velocity), by default those of all joints "
        "where there are no sensors"),
    OPTION(MT_OPT_FROM, '\0', "from", "HZ", BIT(MT_CMD_RESPONSE),
           "lowest frequency (default: a quarter of the first vibration mode's)"),
    OPTION(MT_OPT_TO, '\0', "to", "HZ", BIT(MT_CMD_RESPONSE),
           "highest frequency (default: twice that of the sixth vibration mode, or of the "
           "last)"),
    OPTION(MT_OPT_POINTS, '\0', "points", "N", BIT(MT_CMD_RESPONSE),
           "frequencies of the grid (default: 50); JSON and CSV have those besides that show "
           "every peak, and what lies between, to 1 %"),
    OPTION(MT_OPT_LOG, '\0', "log", NULL, BIT(MT_CMD_RESPONSE),
           "the grid in equal ratios, not in equal steps"),
    OPTION(MT_OPT_KEEP, '\0', "modes", "N", BIT(MT_CMD_RESPONSE),
           "by the lowest N modes, rigid-body ones among them; the others follow statically "
           "(default: by all of them)"),
    OPTION(MT_OPT_DIRECT, '\0', "direct", NULL, BIT(MT_CMD_RESPONSE),
           "by a factor of the dynamic stiffness at every frequency, without modes"),
    OPTION(MT_OPT_POLES, '\0', "poles", NULL, BIT(MT_CMD_RESPONSE),
           "poles and residues, of which every response is the sum: H(s) = sum of residue/(s - "
           "pole) + d0 + d1 s + d2 s^2, s = 2 pi i f (in the text the poles alone)"),
    OPTION(MT_OPT_SENSITIVITY, '\0', "sensitivity", "A,B", BIT(MT_CMD_RESPONSE),
           "change of every peak and antiresonance for one per cent more of these parameters"),
    OPTION(MT_OPT_VIBRATION, '\0', "vibration", "PROFILE",
           BIT(MT_CMD_RESPONSE) | BIT(MT_CMD_SIMULATE),
           "a profile of vibration, a file or the name of one that is shipped, as the "
           "acceleration of the ground. Of response: RMS, largest tones and peak of every "
           "output, by default the accelerations of all sensors; --input is by default the "
           "ground along the profile's axis, --from and --to are its ends. Of simulate: one "
           "realisation of it, by --seed, tones going through their ranges once; of a profile "
           "without an axis, or along another one, \"base.y=PROFILE\""),
    OPTION(MT_OPT_DURATION, '\0', "duration", "SECONDS", BIT(MT_CMD_SIMULATE),
           "how long the motion lasts; needed"),
    OPTION(
        MT_OPT_DT_OUT, '\0', "dt-out", "SECONDS", BIT(MT_CMD_SIMULATE),
        "time between two lines of the result (default: a hundredth of the duration, or less, "
        "a 24th of the period of a --sine); steps are as short as the motion needs, whatever "
        "this is"),
    REPEATED(MT_OPT_START, "start", "JOINT=VALUE", BIT(MT_CMD_SIMULATE),
             "let go where this joint (or link's hinge) is at a position from the reference "
             "position, "
             "rad or m, or in the model's units where it names some: one joint is held there "
             "until the rest of the mechanism is in "
             "equilibrium; several are moved there together, the rest following with the least "
             "motion; may be repeated (\"pivot=170*deg\")"),
    REPEATED(
        MT_OPT_RATE, "rate", "JOINT=VALUE", BIT(MT_CMD_SIMULATE),
        "start with this joint at a velocity, rad/s or m/s, or the model's units a second: its "
        "second body against its first, all with the least kinetic energy, so where both are "
        "free the lighter one moves more, backwards where that is the first; may be repeated"),
    OPTION(MT_OPT_ALONG, '\0', "mode", "N:AMPLITUDE", BIT(MT_CMD_SIMULATE),
           "let go displaced along vibration mode N, so far at the sensor that moves most (m, "
           "or rad where sensors show rotations alone, or in the model's units)"),
    REPEATED(
        MT_OPT_PUSH, "input", "PORT=EXPRESSION", BIT(MT_CMD_SIMULATE),
        "what pushes or shakes it, an expression of the time t: grip.x, the force (grip.r: "
        "moment) along a direction of a sensor, or base.x, the acceleration of the ground "
        "(base.x:displacement, base.x:velocity), or a joint, whose coordinate then follows "
        "it, from where it starts; may be repeated (\"grip.x=10*sin(40*t)*exp(-t)\")"),
    REPEATED(MT_OPT_SINE, "sine", "PORT=AMPLITUDE@HZ", BIT(MT_CMD_SIMULATE),
             "a sine there, of a joint or a place of the ground in the model's units; may be "
             "repeated. With one frequency alone the steady motion is read "
             "from the last periods"),
    REPEATED(MT_OPT_CHIRP, "sweep", "PORT=LEVEL@FROM:TO", BIT(MT_CMD_SIMULATE),
             "a sine of this amplitude there whose frequency runs from FROM to TO Hz in the "
             "duration, so many octaves a second (with \":linear\" behind it so many Hz)"),
    REPEATED(MT_OPT_RANDOM, "random", "PORT=HZ:PSD,...", BIT(MT_CMD_SIMULATE),
             "random vibration there: breakpoints of a power spectral density (of base.x in "
             "(m/s^2)^2/Hz), straight in log over log between them, made of sines whose phases "
             "come from --seed"),
    OPTION(MT_OPT_TOLERANCE, '\0', "tolerance", "X", BIT(MT_CMD_SIMULATE),
           "largest error of a step, as a part of the motion so far (default: 1e-11)"),
    OPTION(MT_OPT_OUTPUT, 'o', "output", "DIR",
           SOLVES | BIT(MT_CMD_REPORT) | BIT(MT_CMD_EXAMPLES) | BIT(MT_CMD_SHOW),
           "folder for the results (default of run: results, in the current one; of report: "
           "nothing is written; of examples: the current one); of show: the file that is "
           "written instead of standard output"),
    OPTION(MT_OPT_VERIFY, '\0', "verify", NULL, SOLVES | BIT(MT_CMD_REPORT),
           "show the study's published values, too; of run, they alone decide the exit status"),
    OPTION(MT_OPT_THREADS, '\0', "threads", "N", ON_STUDIES,
           "number of workers of the search, of which at most 64 are used (default: as many as "
           "there "
           "are processors); the result does not depend on it"),
    OPTION(
        MT_OPT_TIME, '\0', "time", "SECONDS", SOLVES | BIT(MT_CMD_SIMULATE),
        "most time for the answer to each study, or for the motion, once the files are read; "
        "then it ends with the best so far, as after an interrupt"),
    OPTION(MT_OPT_SEED, '\0', "seed", "N", ON_STUDIES | BIT(MT_CMD_SIMULATE),
           "seed of the starting points instead of the study's; of simulate: of --random "
           "and --vibration (default: 1)"),
    OPTION(MT_OPT_STARTS, '\0', "starts", "N", ON_STUDIES,
           "number of local searches instead of the study's \"starts\""),
    OPTION(MT_OPT_MAX_EVALUATIONS, '\0', "max-evaluations", "N", ON_STUDIES,
           "most evaluations of the answer instead of the study's \"max_evaluations\""),
    OPTION(
        MT_OPT_PROOF, '\0', "proof", "SECONDS", ON_STUDIES,
        "most nominal seconds of each proof instead of the study's \"proof_s\" (default: 5): "
        "1e9 multiplications are one, on any machine; 0: no proof"),
    OPTION(
        MT_OPT_RESUME, '\0', "resume", NULL, BIT(MT_CMD_RUN),
        "go on from the journal of a run that was killed or interrupted, if there is one; the "
        "result is that of a run without a break"),
    OPTION(MT_OPT_SHARD, '\0', "shard", "PART/PARTS", BIT(MT_CMD_RUN),
           "do one part of the work only, and leave a journal for `merge`"),
    OPTION(MT_OPT_REDO, '\0', "redo", NULL, BIT(MT_CMD_MERGE),
           "do the tasks again of journals from processors that compute otherwise, which are "
           "refused else"),
    OPTION(MT_OPT_PROFILE, '\0', "profile", NULL, SOLVES | BIT(MT_CMD_MODES),
           "how often each stage of the evaluations was done or could be skipped, and the "
           "seconds that all workers took, on standard error"),
    OPTION(MT_OPT_PROGRESS, '\0', "progress", "auto|line|json|none",
           ON_STUDIES | BIT(MT_CMD_MODES),
           "how far it is, on standard error: phase, share done, best objective so far, time "
           "left; "
           "line: a line every ten seconds, json: an object a line for programs "
           "(schemas/progress.schema.json), auto: one line that is rewritten on a terminal, "
           "elsewhere as line (default: auto, or with --quiet none)"),
    OPTION(MT_OPT_MAX_MEMORY, '\0', "max-memory", "SIZE", MT_ALL_COMMANDS,
           "most memory that files may make the program use: bytes, or with k, M, G or T (1024 "
           "each); what asks for more ends with exit status 4 (default: half of the memory of "
           "the machine or its container)"),
    OPTION(MT_OPT_RANK, '\0', "rank", "N", BIT(MT_CMD_APPLY) | BIT(MT_CMD_EXPLAIN),
           "which recommendation (default: 1, the best)"),
    OPTION(MT_OPT_MODEL, '\0', "model", "MODEL", BIT(MT_CMD_APPLY) | BIT(MT_CMD_SHOW),
           "the model file, where it is not found from the result"),
    OPTION(MT_OPT_REL_TOL, '\0', "rel-tol", "X", BIT(MT_CMD_DIFF),
           "numbers that differ by no more than this part of them are the same (default: 0; "
           "1e-6 passes over what another machine or compiler rounds differently)"),
    OPTION(
        MT_OPT_ABS_TOL, '\0', "abs-tol", "X", BIT(MT_CMD_DIFF),
        "so are numbers that differ by no more than X, in the units of the results (default: "
        "0)"),
    OPTION(MT_OPT_SPECTRUM, '\0', "spectrum", "FROM:TO:N", BIT(MT_CMD_PROFILE),
           "what the profile does to one mass on a spring, for N natural frequencies [Hz] from "
           "FROM to TO in equal quotients"),
    OPTION(MT_OPT_DAMPING_RATIO, '\0', "damping-ratio", "X", BIT(MT_CMD_PROFILE),
           "of --spectrum: the mass's damping ratio, between 0 and 1 (default: 0.05, Q = 10)"),
    OPTION(MT_OPT_ROOT, '\0', "root", "DIR", MT_ALL_COMMANDS,
           "files named by other files must lie beneath DIR (default: the parent of the "
           "folder of the file that names them; of a result, of its study's)"),
    OPTION(MT_OPT_FORMAT, '\0', "format", "text|json|csv", MT_ALL_COMMANDS,
           "form of what goes to standard output (default: text; of report also html, of check "
           "sarif; of show html or json, default html)"),
    OPTION(MT_OPT_QUIET, '\0', "quiet", NULL, MT_ALL_COMMANDS,
           "no talk on standard error; errors and warnings stay"),
    OPTION(MT_OPT_HELP, 'h', "help", NULL, MT_ALL_COMMANDS,
           "explain the program, or a command"),
    OPTION(MT_OPT_MANUAL, '\0', "manual", NULL, 0U, "print the manual page, as man reads it"),
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
        MT_CMD_RUN, "run", "STUDY...", 1, -1, "solve studies and write what was found",
        "Solves each study, writes result.json, recommendations.csv, report.html, trade.csv "
        "(of a trade study), curves.csv (where the study lists responses) and timing.json "
        "into DIR/<study file name without .json>/, and prints "
        "a "
        "summary. The files are replaced as one: result.json names the others with their "
        "SHA-256, and a run that fails or is killed leaves the old result, or one that the "
        "next "
        "run mends.\n"
        "Of several studies each is answered, whatever becomes of the others; a table at the "
        "end, and index.json and index.html in DIR, say of each what became of it (answered, "
        "not answered, not run), its status, grade and size of the redesign. Two studies "
        "whose results would go into one folder, be it by a link or where capital letters are "
        "not told apart, are refused before anything is run. The worst exit status counts.\n"
        "An interrupt (Ctrl-C) ends the search; the best design so far is written, and which "
        "parts of the answer are missing. A second one ends the program. Before a proof that "
        "may "
        "take long the best design so far is written likewise.\n"
        "While it works, a run appends what it knows to DIR/<study file name without "
        ".json>.journal, which goes when the answer is complete; after an interrupt or a kill "
        "--resume goes on from it. Without --resume a journal that is there is kept with .old "
        "behind its name, and merge goes on from it."),
    COMMAND(
        MT_CMD_MERGE, "merge", "STUDY JOURNAL...", 2, -1, "join the parts of a study's work",
        "Reads the journals that `run --shard PART/PARTS` left in DIR/<study file name without "
        ".json>.PART-of-PARTS.journal, does what no journal knows, and writes and prints what "
        "`run` does: the same bytes. A journal of another study, model, program or machine's "
        "libraries is refused; a damaged line is done again."),
    COMMAND(MT_CMD_COMPARE, "compare", "STUDY...", 1, -1, "published against computed values",
            "Solves each study and prints its published values beside the computed ones, with "
            "differences, roles and sources. Writes no files. Exit status 0 when all hold, "
            "else 1."),
    COMMAND(
        MT_CMD_MODES, "modes", "MODEL", 1, 1, "natural frequencies and mode shapes",
        "Prints the modes of each configuration: rigid-body, flexible, unstable and undecided "
        "ones (rounding hides whether they are stable: no mode has an index there), what a "
        "frequency may be wrong by (in JSON and CSV; in the table where that exceeds 1e-6 of "
        "it), the residual and orthogonality ratios of each (about 1 is perfect), redundant "
        "joints, and how the equilibrium was found. Shapes are mass-normalised. Names that the "
        "model gives to modes are shown where nothing is changed by --set."),
    COMMAND(
        MT_CMD_MAC, "mac", "MODEL:CONFIGURATION MODEL:CONFIGURATION", 2, 2,
        "pair and correlate two sets of modes",
        "Compares shapes at the sensors that both models have, pairs the modes one to one, "
        "and compares repeated modes as subspaces. Where they are displacements and rotations "
        "together, a rotation counts as its arc at the length of A's model. The configuration "
        "may be left out where "
        "a model has only one. Default number of modes: as many as there are common sensor "
        "channels."),
    COMMAND(
        MT_CMD_SWEEP, "sweep", "MODEL", 1, 1,
        "positions and frequencies over a range of motion",
        "Drives a joint through a range (--drive) and prints the coordinate of every joint, "
        "its ratio to the driven one (exact derivative), what holds the joint, and, with "
        "--modes, the natural frequencies (default: 6) by index. Where a limit position ends "
        "the range, the positions before it are printed, the limit is named, and the exit "
        "status is 3."),
    COMMAND(
        MT_CMD_SIMULATE, "simulate", "MODEL", 1, 1, "its motion in time, however large",
        "Integrates the equations of motion of one configuration, with everything that depends "
        "on where it stands and how fast it moves: a second opinion on whatever the other "
        "commands say of small motions. It starts at rest in its equilibrium, unless --start, "
        "--rate or --mode say otherwise, and is pushed by --input, --sine and --sweep. Prints "
        "the outputs over time, then what is to be read from them: of a free motion how often "
        "it turns and its tones (frequency, damping, amplitude), of one under a sine the "
        "steady amplitudes and phases; how well energy is balanced, and how far joints drifted "
        "in a step before they were taken back.\n"
        "Springs, viscous dampers, loads and masses are those of the model; bars and beams of "
        "consistent mass move their mass with their frame. Steps follow the fastest vibration "
        "that the mechanism has: very stiff parts make them short.\n"
        "An interrupt (Ctrl-C) or the end of --time ends the motion; what there is of it is "
        "printed, with exit status 130 or 1. Where a dead centre ends it, or a direction "
        "without "
        "mass is pushed, the exit status is 3."),
    COMMAND(MT_CMD_SENSITIVITY, "sensitivity", "MODEL", 1, 1,
            "change of each frequency per per cent of each parameter",
            "Prints exact derivatives: Hz for one per cent more of a parameter, for the first "
            "modes (default: 6). Repeated modes have directional values, given as a set."),
    COMMAND(
        MT_CMD_RESPONSE, "response", "MODEL", 1, 1, "how forces and a moving ground shake it",
        "Prints the frequency response of each output to each input, about the equilibrium, "
        "with the model's damping: peaks and antiresonances, to all digits, then magnitude and "
        "phase over frequency. Phases are those of the output against the input, below 0 where "
        "it lags. At the resonance of a mode that nothing damps the response has no value, "
        "which is said. A value's error, in JSON and CSV, bounds what rounding has made of "
        "it.\n"
        "Under --vibration each output has the RMS of its response to the random parts of the "
        "profile, with a bound of its error, the largest amplitude under each tone, wherever "
        "in its range that lies, which is proven, and the peak that both make by the profile's "
        "rule; all of the profile counts, whatever --from and --to are. The density of the "
        "response over frequency is in JSON and CSV (psd). The bound of an RMS counts the "
        "rounding "
        "of the poles, too; proofs are of the sum over the poles as it was found, whose own "
        "rounding the errors of the values tell. "
        "Where no sum over poles is to be had, numbers are by quadrature, and their errors "
        "estimates, which is said.\n"
        "A configuration that is unstable, whose motions grow by themselves, or whose "
        "stability "
        "rounding hides, is refused, and so is the force of a joint that is redundant with "
        "others."),
    COMMAND(
        MT_CMD_INFO, "info", "MODEL", 1, 1,
        "masses, mobility and redundancies of each configuration",
        "Prints the total mass, its centre and inertia, the freedoms, and the sets of "
        "redundant joints of each configuration, in the position where it is linearised; and "
        "what signs, axes and orders of bodies were understood to mean, where the model has "
        "numbers that depend on them: preloads, free angles, moments, gear ratios, products "
        "of inertia, sections, bushings."),
    COMMAND(
        MT_CMD_SHOW, "show", "MODEL|RESULT.json", 1, 1, "the mechanism, in three dimensions",
        "Prints a page that shows the mechanism: bodies with their ellipsoids of inertia, "
        "links, "
        "joints with their axes and how far off their bodies they lie, springs, dampers and "
        "sensors; its lowest 12 vibration modes as they move, with what share of the energy "
        "every spring and body has; and where a joint is driven, the range of its positions. "
        "Of "
        "a result, or the folder that holds one: the original design and the recommended ones, "
        "with the model found as apply "
        "finds it. The page needs nothing else and opens in any browser.\n"
        "--format json prints what the page draws, --svg a still picture. A configuration that "
        "cannot be analysed is drawn as far as it can be and says why, on standard error, "
        "too."),
    COMMAND(
        MT_CMD_REPORT, "report", "RESULT.json", 1, 1,
        "what a result says, as text, CSV or HTML",
        "Prints the summary that run printed (--format csv: recommendations.csv, html: "
        "report.html, json: the result), from the result, or the folder that holds it, alone: "
        "no study is looked for, and nothing is solved; only the page's view of the mechanism "
        "needs the model, and is left out where apply would not find it. With --output the "
        "files are written anew into "
        "DIR/<study file name without .json>/, as run does; how long the solution took is "
        "not known to a result, so timing.json is only taken over where it stands beside it. "
        "A result.json is refused where the files beside it are of another run or were "
        "changed; a copy that stands alone is read."),
    COMMAND(
        MT_CMD_EXPLAIN, "explain", "RESULT.json", 1, 1,
        "what moves each goal, what holds it, what it costs",
        "Prints for each goal of a recommendation the parameters that move it, the most first, "
        "with what 1 % more of each does and how far it may still go within its bounds; then "
        "the "
        "bounds, bands and limits that hold the design, and what they cost. From the result, "
        "or the folder that holds it, alone: nothing is solved. --format csv: one row per goal "
        "and parameter."),
    COMMAND(
        MT_CMD_APPLY, "apply", "RESULT.json", 1, 1, "the model with the recommended values",
        "Prints the model file with the recommended values put in; everything else of its text "
        "stays as it is. The result may be named by the folder that holds it. The model is "
        "found from there, and must be the one that "
        "was solved (same SHA-256) unless --model names it. A result.json is refused where the "
        "files beside it are of another run or were changed; a copy that stands alone is "
        "read."),
    COMMAND(
        MT_CMD_DIFF, "diff", "RESULT RESULT", 2, 2, "what two results say differently",
        "Compares two results (each a result.json, or the folder that holds it), also of "
        "different studies or written by different versions of the program: status, designs "
        "with their parameters, objectives, frequencies, MAC and goals, certificates and all "
        "else. Parameters are matched by their names, frequencies by configuration and mode, "
        "goals by their places in the study; what only one of the results has is told. How "
        "the answers were made (versions, seed, evaluations, digests of the files read) is "
        "told too, but is no difference of the answers; sentences and measures of rounding "
        "are not compared.\n"
        "The text leaves out what follows from what it shows (errors, slopes, changes); JSON "
        "and CSV have all, with JSON pointers into both files. Exit status 0 when the answers "
        "are the same, 1 when they differ, 2 or more when they cannot be compared."),
    COMMAND(
        MT_CMD_CHECK, "check", "FILE...", 1, -1,
        "validate model, study, result, aircraft and profile files",
        "Reads each file as its \"format\" says, and prints every problem found as "
        "file:line:column: error: /json/pointer: message.\n"
        "JSON has all of this by members (file, line, column, pointer, severity, message), "
        "SARIF 2.1.0 as code hosts and editors show it; paths are relative to the current "
        "folder, which should be that of the repository.\n"
        "Then says what is hardly meant (warning: values that look like other units, joints "
        "off their links, bands that no mode comes near) and what to know of every "
        "configuration, or of those that a study names (note: free motions, unstable "
        "directions, redundant joints)."),
    COMMAND(
        MT_CMD_INIT, "init", "[DIR]", 0, 1, "a model and a study to begin with",
        "Writes model.json, study.json and the schemas that editors complete them by into "
        "the folder (default: the current one), which is made. The model is a lever on a "
        "servo, each part described; the study keeps it clear of a rotor. Prints the paths. "
        "A file that is there with other contents is left alone, and then none is "
        "written."),
    COMMAND(MT_CMD_EXAMPLES, "examples", "[NAME...]", 0, -1,
            "the studies that are part of the program",
            "Without a name: lists them. With names: writes these studies, into DIR/studies, "
            "and all that they name, models, references, schemas, beside it, and prints the "
            "paths. A file that is there with other contents is left alone, and then none is "
            "written."),
    COMMAND(MT_CMD_SCHEMA, "schema", "[NAME]", 0, 1, "the JSON Schemas of all files",
            "Without a name: lists them. With one (model, study, result, ...): prints it."),
    COMMAND(
        MT_CMD_PROFILE, "profile", "[PROFILE]", 0, 1, "what a profile of vibration asks for",
        "Prints the breakpoints of its random parts with their slopes and overall RMS, and its "
        "tones with the harmonics of rotors resolved to Hz, each with origin and source. What "
        "is "
        "assumed, or unconfirmed by a public document, is said on standard error, too. "
        "PROFILE is a file, or the name of one that is part of the program; without it: lists "
        "these.\n"
        "--spectrum prints what the profile does to one mass on a spring that stands on the "
        "base: RMS of its absolute acceleration, exact to the bound that is told, the tones' "
        "largest peaks over their ranges, proven, and both combined as the profile says "
        "(default: 3 times the RMS and the sum of all tones). --format csv has one row for "
        "each "
        "segment and tone, or for each natural frequency."),
};

const mt_exit mt_exits[MT_EXITS] = {
    {MT_EXIT_DONE, "done, all goals met (with --verify: all published values hold)"},
    {MT_EXIT_GOALS, "done, or out of time, goals not met (of diff: the answers differ)"},
    {MT_EXIT_INPUT, "bad input or usage"},
    {MT_EXIT_NUMERICAL, "numerical failure"},
    {MT_EXIT_SYSTEM, "system failure: file, disk, memory"},
    {MT_EXIT_INTERRUPTED,
     "interrupted by a signal; the best design, or the motion, so far was written"},
};
