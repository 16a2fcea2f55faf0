/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes of style and scripts are those of files (CMakeLists.txt). */
#include "report/page.h"

#include <string.h>

#include "base/base.h"
#include "base/sha256.h"
#include "report/page_data.h"
#include "report/table.h"

enum { HASH_TEXT = 45 }; /* 32 bytes in base 64, and the terminator */

/* What the script of a page is made of, in this order; the last one begins to draw. */
static const char *const report_scripts[] = {"d3-array.js",
                                             "d3-color.js",
                                             "d3-format.js",
                                             "d3-interpolate.js",
                                             "d3-path.js",
                                             "d3-time.js",
                                             "d3-time-format.js",
                                             "d3-scale.js",
                                             "d3-scale-chromatic.js",
                                             "d3-shape.js",
                                             "d3-dsv.js",
                                             "d3-dispatch.js",
                                             "d3-timer.js",
                                             "d3-ease.js",
                                             "d3-selection.js",
                                             "d3-transition.js",
                                             "d3-drag.js",
                                             "d3-brush.js",
                                             "base.js",
                                             "text.js",
                                             "figure.js",
                                             "units.js",
                                             "designs.js",
                                             "alternatives.js",
                                             "chart_frequencies.js",
                                             "chart_parameters.js",
                                             "chart_rotor.js",
                                             "chart_drive.js",
                                             "chart_trade.js",
                                             "chart_front.js",
                                             "chart_parallel.js",
                                             "chart_tolerance.js",
                                             "chart_maps.js",
                                             "chart_published.js",
                                             "chart_search.js",
                                             "chart_history.js",
                                             "origin.js",
                                             "space.js",
                                             "camera.js",
                                             "pose.js",
                                             "symbols.js",
                                             "paint.js",
                                             "dom.js",
                                             "drawing.js",
                                             "view3d.js",
                                             "modes.js",
                                             "drive.js",
                                             "show.js",
                                             "report.js",
                                             NULL};
static const char *const report_styles[] = {"page.css", "view.css", "report.css", NULL};
static const char *const show_scripts[] = {
    "base.js",    "space.js",  "camera.js", "pose.js",  "symbols.js", "paint.js", "dom.js",
    "drawing.js", "view3d.js", "modes.js",  "drive.js", "show.js",    NULL};
static const char *const plain_styles[] = {"page.css", NULL};
static const char *const show_styles[] = {"page.css", "view.css", NULL};

static const struct {
    const char *name;
    const char *text;
} files[] = {
#define PAGE(bytes, name) {name, bytes},
    PAGE_LIST(PAGE)
#undef PAGE
};

static const char *file(const char *name)
{
    for (int i = 0; i < MT_COUNT(files); i++) {
        if (strcmp(files[i].name, name) == 0) {
            return files[i].text;
        }
    }
    return "";
}

/* A file of ours without indents and lines of comment, which are a quarter of it. (None of
 * them has a text of several lines.) */
static void add_code(const char *code, mt_text *out)
{
    while (*code != '\0') {
        code += strspn(code, " \n");
        const size_t line = strcspn(code, "\n");
        if (strncmp(code, "//", 2) != 0) {
            mt_text_add_n(out, code, line);
            mt_text_add(out, "\n");
        }
        code += line;
    }
}

/* What a report without a scene has no use for: all that shows one, but for what is shared. */
static bool is_view(const char *name)
{
    for (int i = 1; show_scripts[i] != NULL; i++) {
        if (strcmp(show_scripts[i], name) == 0) {
            return true;
        }
    }
    return false;
}

static void add_script(mt_page_kind kind, mt_text *out)
{
    static const char *const *const lists[] = {NULL, report_scripts, report_scripts,
                                               show_scripts};
    const char *const *const list = lists[kind];
    for (int i = 0; list != NULL && list[i] != NULL; i++) {
        if (kind == MT_PAGE_REPORT && is_view(list[i])) {
            continue;
        }
        if (strncmp(list[i], "d3-", 3) == 0) {
            mt_text_add(out, file(list[i])); /* with its notice of copyright */
            mt_text_add(out, "\n");
        } else {
            add_code(file(list[i]), out);
        }
    }
}

static void add_style(mt_page_kind kind, mt_text *out)
{
    static const char *const *const lists[] = {plain_styles, report_styles, report_styles,
                                               show_styles};
    for (const char *const *name = lists[kind]; *name != NULL; name++) {
        mt_text_add(out, file(*name));
    }
}

static int digit(char hexadecimal)
{
    return hexadecimal <= '9' ? hexadecimal - '0' : hexadecimal - 'a' + 10;
}

/* The digest as the policy wants it: base 64 (RFC 4648) of its bytes. */
static void hash(const char *text, size_t length, char out[HASH_TEXT])
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char hex[MT_SHA256_TEXT];
    unsigned bits = 0;
    int have = 0;
    int n = 0;
    mt_sha256(text, length, hex);
    for (int i = 0; hex[i] != '\0'; i++) {
        bits = (bits << 4U) | (unsigned)digit(hex[i]);
        have += 4;
        if (have >= 6) {
            have -= 6;
            out[n++] = letters[(bits >> (unsigned)have) & 63U];
        }
    }
    /* 256 bits are 42 letters and four bits more */
    out[n++] = letters[(bits << 2U) & 63U];
    out[n++] = '=';
    out[n] = '\0';
}

static void add_policy(mt_page_kind kind, mt_text *out)
{
    char digest[HASH_TEXT] = "";
    mt_text script = {.s = NULL};
    mt_text style = {.s = NULL};
    add_script(kind, &script);
    add_style(kind, &style);
    if (style.s != NULL) {
        hash(style.s, style.length, digest);
    }
    mt_text_addf(out,
                 "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
                 "style-src 'sha256-%s'; img-src data: blob:; base-uri 'none'; form-action "
                 "'none'",
                 digest);
    if (script.s != NULL) {
        hash(script.s, script.length, digest);
        mt_text_addf(out, "; script-src 'sha256-%s'", digest);
    }
    mt_text_add(out, "\">\n");
    out->failed = out->failed || script.failed || style.failed;
    mt_text_free(&script);
    mt_text_free(&style);
}

void mt_page_begin(mt_page_kind kind, const char *title, mt_text *out)
{
    mt_text_add(out, "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    add_policy(kind, out);
    mt_text_add(out, "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
                     "\n<link rel=\"icon\" href=\"data:,\">\n<title>");
    mt_html_escape(title, out);
    mt_text_add(out, "</title>\n<style>");
    add_style(kind, out);
    mt_text_add(out, "</style>\n</head>\n<body>\n<main>\n<h1>");
    mt_html_escape(title, out);
    mt_text_add(out, "</h1>\n");
}

/* JSON in which nothing can end the element: a "<" stands only in strings, where it may be
 * written as its number. White space is left out: nobody reads it here, and it is a third of a
 * large result. */
static void add_json(const char *json, mt_text *out)
{
    bool in_string = false;
    while (*json != '\0') {
        const size_t plain = strcspn(json, in_string ? "<\\\"" : "< \n\"");
        mt_text_add_n(out, json, plain);
        json += plain;
        if (*json == '<') {
            mt_text_add(out, "\\u003c");
        } else if (*json == '"') {
            mt_text_add(out, "\"");
            in_string = !in_string;
        } else if (*json == '\\' && json[1] != '\0') { /* and what it escapes */
            mt_text_add_n(out, json, 2);
            json++;
        }
        json += *json == '\0' ? 0 : 1;
    }
}

void mt_page_end(mt_page_kind kind, int n, const mt_page_data *data, mt_text *out)
{
    mt_text_add(out, "</main>\n");
    for (int i = 0; i < n; i++) {
        if (data[i].json != NULL) {
            mt_text_addf(out, "<script type=\"application/json\" id=\"%s\">", data[i].id);
            add_json(data[i].json, out);
            mt_text_add(out, "</script>\n");
        }
    }
    if (kind != MT_PAGE_PLAIN) {
        mt_text_add(out, "<script>");
        add_script(kind, out);
        mt_text_add(out, "</script>\n");
    }
    mt_text_add(out, "</body>\n</html>\n");
}
