/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measurement/measurement.h"

#include <math.h>
#include <string.h>

#include "base/format.h"

enum { DIGITS_MOST = 9 }; /* of the number of a node */
enum { LISTED_MOST = 10, FREEDOM_TEXT = 24 };

mt_measurement mt_measurement_default(mt_name name, mt_addr addr)
{
    return (mt_measurement){.name = name, .factor = nan(""), .addr = addr};
}

static bool read_axis(const char **s, int *direction)
{
    static const char axes[] = "XYZ";
    const bool turns = (*s)[0] == 'R' || (*s)[0] == 'r';
    const char letter = (*s)[turns ? 1 : 0];
    const char upper = (char)(letter >= 'a' && letter <= 'z' ? letter - 'a' + 'A' : letter);
    const char *const at = upper == '\0' ? NULL : strchr(axes, upper);
    if (at == NULL) {
        return false;
    }
    *direction = (int)(at - axes) + (turns ? 4 : 1);
    *s += turns ? 2 : 1;
    return true;
}

static int read_sign(const char **s)
{
    const char c = **s;
    *s += c == '+' || c == '-' ? 1 : 0;
    return c == '-' ? -1 : c == '+' ? 1 : 0;
}

bool mt_measured_freedom_parse(const char *text, mt_measured_freedom *out)
{
    const char *s = text;
    *out = (mt_measured_freedom){0};
    if (*s < '0' || *s > '9') {
        return false;
    }
    for (; *s >= '0' && *s <= '9'; s++) {
        if (s - text == DIGITS_MOST) {
            return false;
        }
        out->node = (10 * out->node) + (*s - '0');
    }
    if (*s == '\0') {
        return true;
    }
    const int before = read_sign(&s);
    if (!read_axis(&s, &out->direction)) {
        return false;
    }
    const int behind = read_sign(&s);
    if (*s != '\0' || (before != 0 && behind != 0)) {
        return false;
    }
    out->direction *= before + behind < 0 ? -1 : 1;
    return true;
}

/* "12+Z": a node, and a direction with its sign in front. */
static void freedom_text(const mt_measured_freedom *f, char text[FREEDOM_TEXT])
{
    static const char *const names[] = {"", "X", "Y", "Z", "RX", "RY", "RZ"};
    const int axis = f->direction < 0 ? -f->direction : f->direction;
    (void)mt_snprintf(text, FREEDOM_TEXT, "%d%s%s", f->node,
                      f->direction < 0   ? "-"
                      : f->direction > 0 ? "+"
                                         : "",
                      axis < MT_COUNT(names) ? names[axis] : "?");
}

bool mt_measured_is_response(const mt_measured_response *r)
{
    return r->dataset == 0 || r->function == MT_FUNCTION_RESPONSE ||
           r->function == MT_FUNCTION_TRANSMISSIBILITY;
}

/* "dataset 3: 12+Z by 1+Z", "installed: grip.x:acceleration by grip.x" */
static const char *response_text(const mt_measured_response *r, mt_arena *mem)
{
    char a[FREEDOM_TEXT];
    char b[FREEDOM_TEXT];
    if (r->dataset == 0) {
        return mt_arena_printf(
            mem, "%s%s%s by %s", r->configuration == NULL ? "" : r->configuration,
            r->configuration == NULL ? "" : ": ", r->output == NULL ? "an output" : r->output,
            r->input == NULL ? "an input" : r->input);
    }
    freedom_text(&r->response, a);
    freedom_text(&r->reference, b);
    return mt_arena_printf(mem, "dataset %d: %s by %s", r->dataset, a, b);
}

const char *mt_measured_list_text(const mt_measurement *m, mt_arena *mem)
{
    const char *text = "";
    int listed = 0;
    for (int i = 0; i < m->n_responses && text != NULL && listed < LISTED_MOST; i++) {
        if (mt_measured_is_response(&m->responses[i])) {
            const char *const one = response_text(&m->responses[i], mem);
            text = mt_arena_printf(mem, "%s%s%s", text, listed++ > 0 ? "; " : "",
                                   one == NULL ? "" : one);
        }
    }
    return text == NULL ? "" : text;
}
