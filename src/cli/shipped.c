/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that are part of the program, and the commands that give them out: examples, init,
 * schema. */
#include "cli/shipped.h"

#include <string.h>

#include "base/format.h"
#include "cli/cli.h"
#include "io/file.h"
#include "io/folder.h"
#include "report/table.h"
#include "result/write.h"

enum { SHIPPED_NAME = 64, SHIPPED_MOST = 100 };

/* A file of the distribution, and under which name it is written. */
typedef struct shipped_copy {
    const mt_shipped *file;
    const char *name; /* "schemas/model.schema.json" */
} shipped_copy;

/* The files. */

const mt_shipped_kind mt_shipped_examples = {.command = "examples",
                                             .what = "example",
                                             .folder = "studies/",
                                             .ending = ".json",
                                             .says = "name",
                                             .heading = "what it is"};
const mt_shipped_kind mt_shipped_schemas = {.command = "schema",
                                            .what = "schema",
                                            .folder = "schemas/",
                                            .ending = ".schema.json",
                                            .says = "description",
                                            .heading = "of"};
const mt_shipped_kind mt_shipped_profiles = {.command = "profile",
                                             .what = "profile",
                                             .folder = "problems/profiles/",
                                             .ending = ".json",
                                             .says = "name",
                                             .heading = "what it is"};

/* The file's name, in name[size]; false: it is none of them. */
static bool shipped_file_name(const mt_shipped_kind *kind, const mt_shipped *file, char *name,
                              size_t size)
{
    const size_t before = strlen(kind->folder);
    const size_t behind = strlen(kind->ending);
    const size_t length = strlen(file->path);
    if (strncmp(file->path, kind->folder, before) != 0 || length <= before + behind ||
        strcmp(file->path + length - behind, kind->ending) != 0) {
        return false;
    }
    (void)mt_snprintf(name, size, "%.*s", (int)(length - before - behind), file->path + before);
    return true;
}

/* The first sentence of a member of the root; nothing where it has none. */
static void add_first_sentence(const mt_shipped *file, const char *member, mt_text *out)
{
    mt_json *doc = NULL;
    if (mt_json_parse(file->bytes, file->size, &doc, NULL) != MT_OK) {
        out->failed = true; /* it is ours: memory is out */
        return;
    }
    const mt_addr at = mt_json_member(doc, MT_JSON_ROOT, member);
    if (at != MT_NO_ADDR && mt_json_type_of(doc, at) == MT_JSON_STRING) {
        const char *const text = mt_json_string(doc, at);
        const char *const end = strstr(text, ". ");
        mt_text_add_n(out, text, end == NULL ? strlen(text) : (size_t)(end + 1 - text));
    }
    mt_json_delete(doc);
}

/* A file of a list. */
typedef struct listed_row {
    const char *name;
    const char *text;
} listed_row;

#define THIS listed_row
static const mt_field listed_fields[] = {
    MT_F_TEXT("name", name, "What commands call it."),
    MT_F_TEXT("text", text, "What it is."),
};
const mt_record mt_listed_record =
    MT_F_RECORD_OF(listed_fields, "listed", "A file that is part of the program.");
#undef THIS

void mt_shipped_names(const mt_shipped_kind *kind, mt_text *out)
{
    int n = 0;
    const mt_shipped *const files = mt_shipped_all(&n);
    const char *between = "";
    for (int i = 0; i < n; i++) {
        char name[SHIPPED_NAME];
        if (shipped_file_name(kind, &files[i], name, sizeof name)) {
            mt_text_addf(out, "%s%s", between, name);
            between = " ";
        }
    }
}

#define THIS listed_row
int mt_shipped_list(const mt_args *args, const mt_shipped_kind *kind, mt_text *out)
{
    const mt_record_column columns[] = {
        MT_R_COLUMN(name, kind->what, 0, MT_IN_TABLES),
        MT_R_COLUMN(text, kind->heading, 0, MT_IN_TABLES),
    };
    const mt_record_table rows = MT_R_TABLE_OF(mt_listed_record, columns);
    mt_json_writer w = mt_json_writer_default(out);
    mt_table t = mt_table_default();
    int n = 0;
    int code = MT_EXIT_DONE;
    const mt_shipped *const files = mt_shipped_all(&n);
    const bool json = args->format == MT_FORMAT_JSON;
    mt_table_record_columns(&t, &rows, MT_IN_TABLES);
    if (json) {
        mt_json_open(&w, NULL, '[');
    }
    for (int i = 0; i < n; i++) {
        char name[SHIPPED_NAME];
        mt_text said = {.s = NULL};
        if (!shipped_file_name(kind, &files[i], name, sizeof name)) {
            continue;
        }
        add_first_sentence(&files[i], kind->says, &said);
        const listed_row row = {.name = name, .text = said.s == NULL ? "" : said.s};
        if (json) {
            mt_json_open(&w, NULL, '{');
            mt_record_put(&w, &mt_listed_record, &row);
            mt_json_close(&w);
        } else {
            mt_table_record_row(&t, &rows, MT_IN_TABLES, &row);
        }
        out->failed = out->failed || said.failed;
        mt_text_free(&said);
    }
    if (json) {
        mt_json_close(&w);
        code = mt_cli_json_done(&w);
    } else if (args->format == MT_FORMAT_CSV) {
        mt_table_csv(&t, out);
    } else {
        mt_table_print(&t, 0, mt_terminal_width(), out);
    }
    mt_table_free(&t);
    return code;
}
#undef THIS

/* The file of that name, NULL: there is none. known, text: names that there are, *n of them. */
static const mt_shipped *find_shipped(const mt_shipped_kind *kind, const char *name,
                                      const char *known[SHIPPED_MOST],
                                      char text[SHIPPED_MOST][SHIPPED_NAME], int *n)
{
    int count = 0;
    const mt_shipped *const files = mt_shipped_all(&count);
    *n = 0;
    for (int i = 0; i < count && *n < SHIPPED_MOST; i++) {
        if (!shipped_file_name(kind, &files[i], text[*n], SHIPPED_NAME)) {
            continue;
        }
        if (strcmp(text[*n], name) == 0) {
            return &files[i];
        }
        known[*n] = text[*n];
        (*n)++;
    }
    return NULL;
}

/* The file of that name. Fails: MT_E_USAGE, with the nearest name or the command that lists
 * all. */
static mt_status shipped_named(const mt_shipped_kind *kind, const char *name,
                               const mt_shipped **out, mt_err *err)
{
    const char *known[SHIPPED_MOST];
    char text[SHIPPED_MOST][SHIPPED_NAME];
    int n = 0;
    *out = find_shipped(kind, name, known, text, &n);
    if (*out == NULL && kind == &mt_shipped_schemas) {
        char of_command[SHIPPED_NAME];
        (void)mt_snprintf(of_command, sizeof of_command, "command_%s", name);
        *out = find_shipped(kind, of_command, known, text, &n);
    }
    if (*out != NULL) {
        return MT_OK;
    }
    const char *const near = mt_text_nearest(name, known, n);
    return near == NULL
               ? mt_fail(err, MT_E_USAGE, "no %s is called \"%s\": \"modetune %s\" lists them",
                         kind->what, name, kind->command)
               : mt_fail(err, MT_E_USAGE, "no %s is called \"%s\"; did you mean \"%s\"?",
                         kind->what, name, near);
}

mt_status mt_shipped_load_profile(const mt_args *args, const char *name, mt_vibration **out,
                                  mt_diagnostics *messages, mt_err *err)
{
    mt_io_options opt = mt_cli_io(args);
    const mt_shipped *own = NULL;
    if (strpbrk(name, "/.") != NULL || !mt_file_absent(name)) {
        return mt_vibration_load(name, &opt, out, messages, err);
    }
    MT_TRY(shipped_named(&mt_shipped_profiles, name, &own, err));
    const mt_shipped *const aircraft = mt_shipped_find("problems/aircraft.json");
    const mt_file_text texts[] = {{.path = own->path, .text = own->bytes},
                                  {.path = aircraft->path, .text = aircraft->bytes}};
    opt.files = (mt_files){.given = texts, .n = MT_COUNT(texts), .only = true};
    return mt_vibration_load(own->path, &opt, out, messages, err);
}

/* Fails where another file is at the path; *same: true where it has the same bytes. */
static mt_status compare_existing_file(const char *path, const mt_shipped *file, bool *same,
                                       mt_err *err)
{
    mt_file there = {.bytes = NULL};
    *same = false;
    if (mt_file_absent(path)) {
        return MT_OK;
    }
    const mt_status rc = mt_file_read(path, NULL, MT_JSON_MAX_BYTES, &there, err);
    if (rc != MT_OK) {
        return rc;
    }
    *same = there.length == file->size && memcmp(there.bytes, file->bytes, file->size) == 0;
    mt_file_free(&there);
    return *same ? MT_OK
                 : mt_fail(err, MT_E_INPUT, "%s: is there already, and is left alone", path);
}

static mt_status write_one(const char *folder, const shipped_copy *copy, mt_err *err)
{
    const char *const slash = strrchr(copy->name, '/');
    mt_text into = {.s = NULL};
    mt_text_add(&into, folder);
    if (slash != NULL) {
        mt_text_add(&into, "/");
        mt_text_add_n(&into, copy->name, (size_t)(slash - copy->name));
    }
    const mt_folder_file file = {.name = slash == NULL ? copy->name : slash + 1,
                                 .bytes = copy->file->bytes,
                                 .length = copy->file->size};
    const mt_status rc =
        into.failed ? mt_fail_memory(err) : mt_folder_replace(into.s, &file, 1, err);
    mt_text_free(&into);
    return rc;
}

/**
 * Write n files of the distribution into a folder, which is made, under the given names. Where
 * an existing file holds other bytes, none is written. Fails: MT_E_INPUT (naming the first such
 * file), MT_E_SYSTEM, MT_E_MEMORY.
 */
static mt_status shipped_write(const char *folder, const shipped_copy *copies, int n,
                               mt_err *err)
{
    bool same[SHIPPED_MOST] = {false};
    mt_status rc = MT_OK;
    for (int i = 0; i < n && rc == MT_OK; i++) {
        mt_text path = {.s = NULL};
        mt_text_addf(&path, "%s/%s", folder, copies[i].name);
        rc = path.failed ? mt_fail_memory(err)
                         : compare_existing_file(path.s, copies[i].file, &same[i], err);
        mt_text_free(&path);
    }
    for (int i = 0; i < n && rc == MT_OK; i++) {
        rc = same[i] ? MT_OK : write_one(folder, &copies[i], err);
    }
    return rc;
}

/* modetune examples: the studies that are part of the program, with all that they name. */

/* True where the text of a file names the other one, be it by its path from its own folder, or,
 * a catalogue of aircraft, by one of these. */
static bool names(const mt_shipped *file, const mt_shipped *other)
{
    const char *const base = strrchr(other->path, '/') + 1;
    char quoted[SHIPPED_NAME + 4];
    const bool catalogue = strcmp(base, "aircraft.json") == 0;
    (void)mt_snprintf(quoted, sizeof quoted, "%s%s\"", catalogue ? "" : "/", base);
    return strstr(file->bytes, quoted) != NULL ||
           (catalogue && strstr(file->bytes, "\"aircraft\"") != NULL);
}

/* The files that those of copies[0 .. n) name, and what these name. */
static int add_named(shipped_copy *copies, int n)
{
    int count = 0;
    const mt_shipped *const files = mt_shipped_all(&count);
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < count && n < SHIPPED_MOST; k++) {
            bool has = strncmp(files[k].path, mt_shipped_examples.folder,
                               strlen(mt_shipped_examples.folder)) == 0;
            for (int j = 0; j < n; j++) {
                has = has || copies[j].file == &files[k];
            }
            if (!has && strncmp(files[k].path, "init/", strlen("init/")) != 0 &&
                names(copies[i].file, &files[k])) {
                copies[n++] = (shipped_copy){&files[k], files[k].path};
            }
        }
    }
    return n;
}

static int run_examples(const mt_args *args, mt_text *out)
{
    shipped_copy copies[SHIPPED_MOST] = {{NULL, NULL}};
    mt_err err = {.code = MT_OK};
    int n = 0;
    if (args->n_operands == 0) {
        return mt_shipped_list(args, &mt_shipped_examples, out);
    }
    mt_status rc = MT_OK;
    for (int i = 0; i < args->n_operands && i < SHIPPED_MOST && rc == MT_OK; i++) {
        const mt_shipped *file = NULL;
        rc = shipped_named(&mt_shipped_examples, args->operands[i], &file, &err);
        if (rc == MT_OK) {
            copies[n++] = (shipped_copy){file, file->path};
        }
    }
    const char *const to =
        args->value[MT_OPT_OUTPUT] != NULL ? args->value[MT_OPT_OUTPUT] : ".";
    n = rc == MT_OK ? add_named(copies, n) : n;
    rc = rc == MT_OK ? shipped_write(to, copies, n, &err) : rc;
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    for (int i = 0; i < n; i++) {
        mt_text_addf(out, "%s/%s\n", to, copies[i].name);
    }
    return MT_EXIT_DONE;
}

const mt_command mt_command_examples = {
    .name = "examples",
    .operands = "[NAME...]",
    .least = 0,
    .most = -1,
    .summary = "the studies that are part of the program",
    .details =
        "Lists the studies. With names: writes these studies into DIR/studies, and the "
        "models, references and schemas that they name beside it, and prints the paths. If "
        "one of the files exists with other contents, nothing is written.",
    .answer = {NULL, MT_ANSWER_FILES},
    .run = run_examples,
};

/* modetune init: a model and a study to begin with, and the schemas that editors complete them
 * by. */

/* A file of the kind of model that is asked for (src/cli/init/KIND/; NULL: of the lever in the
 * plane). NULL: there is no such kind. */
static const mt_shipped *find_file(const char *kind, const char *name)
{
    char path[64];
    (void)mt_snprintf(path, sizeof path, "init/%s%s%s", kind == NULL ? "" : kind,
                      kind == NULL ? "" : "/", name);
    return mt_shipped_find(path);
}

static int run_init(const mt_args *args, mt_text *out)
{
    const char *const folder = args->n_operands > 0 ? args->operands[0] : ".";
    const char *const kind = args->value[MT_OPT_KIND];
    mt_err err = {.code = MT_OK};
    const shipped_copy copies[] = {
        {find_file(kind, "model.json"), "model.json"},
        {find_file(kind, "study.json"), "study.json"},
        {mt_shipped_find("schemas/model.schema.json"), "schemas/model.schema.json"},
        {mt_shipped_find("schemas/study.schema.json"), "schemas/study.schema.json"},
    };
    if (copies[0].file == NULL) {
        return mt_cli_failed(mt_fail(&err, MT_E_USAGE,
                                     "no kind of model is called \"%s\"; --kind takes stick, "
                                     "mounts, arm, updating or rotor",
                                     kind),
                             &err);
    }
    const mt_status rc = shipped_write(folder, copies, MT_COUNT(copies), &err);
    if (rc != MT_OK) {
        return mt_cli_failed(rc, &err);
    }
    for (int i = 0; i < MT_COUNT(copies); i++) {
        mt_text_addf(out, "%s/%s\n", folder, copies[i].name);
    }
    mt_terminal_talk(
        args->given[MT_OPT_QUIET],
        "%s: a model and a study to change into your own. \"modetune modes "
        "model.json\" prints its frequencies, \"modetune run study.json\" says what "
        "to change.",
        folder);
    return MT_EXIT_DONE;
}

const mt_command mt_command_init = {
    .name = "init",
    .operands = "[DIR]",
    .least = 0,
    .most = 1,
    .summary = "a model and a study to begin with",
    .details =
        "Writes model.json, study.json and their schemas, which let an editor complete "
        "them, into the folder (default: the current one), creates it if necessary, and "
        "prints the paths. Each part of the model has a description; the study asks a "
        "question that it answers within seconds. --kind chooses among models. If one of "
        "the files exists with other "
        "contents, nothing is written.",
    .run = run_init,
};

/* modetune schema: the JSON Schemas, which editors complete and check files by. */

static int run_schema(const mt_args *args, mt_text *out)
{
    mt_err err = {.code = MT_OK};
    const mt_shipped *file = NULL;
    if (args->n_operands == 0) {
        return mt_shipped_list(args, &mt_shipped_schemas, out);
    }
    const mt_status rc = shipped_named(&mt_shipped_schemas, args->operands[0], &file, &err);
    if (rc != MT_OK || file == NULL) {
        return mt_cli_failed(rc, &err);
    }
    mt_text_add_n(out, file->bytes, file->size);
    return MT_EXIT_DONE;
}

const mt_command mt_command_schema = {
    .name = "schema",
    .operands = "[NAME]",
    .least = 0,
    .most = 1,
    .summary = "the JSON Schemas of all files, and of what commands print",
    .details =
        "Lists the schemas. With a name: prints that schema, of a kind of file (model, study, "
        "aircraft, profile, result, index, progress, scene), or of what a command prints as "
        "JSON: command_modes, or the command's name alone where no kind of file has it "
        "(modes).",
    .answer = {NULL, MT_ANSWER_FILES},
    .run = run_schema,
};
