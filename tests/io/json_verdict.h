/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parser makes of a text. */
#ifndef TESTS_IO_JSON_VERDICT_H
#define TESTS_IO_JSON_VERDICT_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/json.h"

typedef struct verdict {
    bool accepted;
    char place[32]; /* of the first problem in the text's order */
    double number;  /* of the root, where it is one */
} verdict;

static inline verdict judge(const char *text, size_t n)
{
    verdict v = {.number = nan("")};
    mt_json *doc = NULL;
    /* of its exact size: a read past the end is seen */
    char *const exact = malloc(n > 0 ? n : 1);
    if (exact == NULL) {
        return v;
    }
    memcpy(exact, text, n);
    const mt_status rc = mt_json_parse(exact, n, &doc, NULL);
    v.accepted = doc != NULL && mt_json_diags(doc)->errors == 0;
    if (doc != NULL && v.accepted != (rc == MT_OK)) {
        v.accepted = v.accepted && rc == MT_OK; /* a name given twice is noted, and read on */
    }
    if (v.accepted && mt_json_type_of(doc, MT_JSON_ROOT) == MT_JSON_NUMBER) {
        v.number = mt_json_number(doc, MT_JSON_ROOT);
    }
    if (doc != NULL && !v.accepted) {
        mt_diagnostics said = {.count = 0};
        mt_json_report(doc, "f", &said);
        (void)snprintf(v.place, sizeof v.place, "%.*s",
                       said.lines.s == NULL ? 0 : (int)strcspn(said.lines.s + 2, " ") - 1,
                       mt_diagnostics_text(&said) + 2);
        mt_diagnostics_free(&said);
    }
    mt_json_delete(doc);
    free(exact);
    return v;
}

#endif
