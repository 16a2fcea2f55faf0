/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of SARIF ("Static Analysis Results Interchange Format", OASIS, version 2.1.0) what code hosts
 * read: tool.driver with its rules, results with rule, level, message and place. */
#include "cli/sarif.h"

#include "modetune/version.h"

#include <stdlib.h>

#include "base/base.h"
#include "base/format.h"
#include "cli/terminal.h"
#include "io/files.h"

/* id: does not change; text for people. */
#define RULES(X)                                                                             \
    X(RULE_ERROR, "bad-input", "error", "An input file is wrong",                            \
      "Something that is missing, of a wrong type, unknown, out of its range or "            \
      "contradictory: the file cannot be used before it is mended.")                         \
    X(RULE_WARNING, "hardly-meant", "warning", "A value is allowed but suspicious",          \
      "Values that look like other units, joints off their links, bands that no mode comes " \
      "near. They stand before the answer and change no grade.")                             \
    X(RULE_NOTE, "good-to-know", "note", "A fact of the model",                              \
      "Free motions, unstable directions, redundant joints, gaps that were closed: welcome " \
      "where they are meant.")                                                               \
    X(RULE_UNREAD, "not-analysed", "error", "A file could not be read or analysed",          \
      "It is not there, not readable or too large, or the mechanism cannot be analysed.")
#define RULE_ID(id, name, level, brief, whole) id,
typedef enum rule_id { RULES(RULE_ID) RULE_COUNT } rule_id;

static const struct {
    const char *name;
    const char *level;
    const char *brief;
    const char *whole;
} rules[RULE_COUNT] = {
#define RULE_TEXT(id, name, level, brief, whole) [id] = {name, level, brief, whole},
    RULES(RULE_TEXT)};

static void put_text(mt_json_writer *w, const char *member, const char *text)
{
    mt_json_open(w, member, '{');
    mt_json_put_string(w, "text", text);
    mt_json_close(w);
}

void mt_sarif_begin(mt_json_writer *w)
{
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "$schema",
                       "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/"
                       "sarif-schema-2.1.0.json");
    mt_json_put_string(w, "version", "2.1.0");
    mt_json_open(w, "runs", '[');
    mt_json_open(w, NULL, '{');
    mt_json_open(w, "tool", '{');
    mt_json_open(w, "driver", '{');
    mt_json_put_string(w, "name", "modetune");
    mt_json_put_string(w, "version", mt_version());
    mt_json_open(w, "rules", '[');
    for (int i = 0; i < RULE_COUNT; i++) {
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "id", rules[i].name);
        put_text(w, "shortDescription", rules[i].brief);
        put_text(w, "fullDescription", rules[i].whole);
        mt_json_open(w, "defaultConfiguration", '{');
        mt_json_put_string(w, "level", rules[i].level);
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_json_put_string(w, "columnKind", "unicodeCodePoints");
    mt_json_open(w, "results", '[');
}

/* A relative reference, or file:// and the path. */
static void add_uri(const char *path, mt_text *out)
{
    char *const normal = mt_files_normal(path);
    if (normal == NULL) {
        out->failed = true;
        return;
    }
    mt_text_add(out, normal[0] == '/' ? "file://" : "");
    mt_text_add_uri(out, normal);
    free(normal);
}

static rule_id rule_of(const mt_file_problem *p)
{
    switch (p->severity) {
    case MT_SEVERITY_WARNING:
        return RULE_WARNING;
    case MT_SEVERITY_NOTE:
        return RULE_NOTE;
    case MT_SEVERITY_ERROR:
    case MT_SEVERITY_COUNT:
        break;
    }
    return p->unread ? RULE_UNREAD : RULE_ERROR;
}

void mt_sarif_put(mt_json_writer *w, const mt_file_problem *p)
{
    const rule_id rule = rule_of(p);
    mt_text uri = {.s = NULL};
    add_uri(p->file, &uri);
    w->out->failed = w->out->failed || uri.failed;
    mt_json_open(w, NULL, '{');
    mt_json_put_string(w, "ruleId", rules[rule].name);
    mt_json_put_integer(w, "ruleIndex", rule);
    mt_json_put_string(w, "level", rules[rule].level);
    put_text(w, "message", p->message);
    mt_json_open(w, "locations", '[');
    mt_json_open(w, NULL, '{');
    mt_json_open(w, "physicalLocation", '{');
    mt_json_open(w, "artifactLocation", '{');
    mt_json_put_string(w, "uri", uri.s == NULL ? "" : uri.s);
    mt_json_close(w);
    mt_json_open(w, "region", '{');
    mt_json_put_integer(w, "startLine", p->line > 0 ? p->line : 1);
    if (p->line > 0) {
        mt_json_put_integer(w, "startColumn", p->column);
    }
    mt_json_close(w);
    mt_json_close(w);
    if (p->line > 0 && p->pointer != NULL && p->pointer[0] != '\0') {
        mt_json_open(w, "logicalLocations", '[');
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "fullyQualifiedName", p->pointer);
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_text_free(&uri);
}

void mt_sarif_end(mt_json_writer *w, int code, int left_out)
{
    mt_json_close(w);
    mt_json_open(w, "invocations", '[');
    mt_json_open(w, NULL, '{');
    mt_json_put_bool(w, "executionSuccessful", code == MT_EXIT_DONE || code == MT_EXIT_INPUT);
    mt_json_put_integer(w, "exitCode", code);
    if (left_out > 0) {
        char text[64];
        (void)mt_snprintf(text, sizeof text, "%d more problems are not shown", left_out);
        mt_json_open(w, "toolExecutionNotifications", '[');
        mt_json_open(w, NULL, '{');
        mt_json_put_string(w, "level", "note");
        put_text(w, "message", text);
        mt_json_close(w);
        mt_json_close(w);
    }
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
    mt_json_close(w);
}
