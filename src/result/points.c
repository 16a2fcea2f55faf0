/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result/points.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

static const char TRADE[] = "\n  \"trade\": {\n";
static const char LIST[] = "\n    \"points\": [";
static const char POINT[] = "\n      {\n";
static const char POINT_END[] = "\n      }";
static const char LIST_END[] = "\n    ]";

static bool is_at(const char *text, const char *what)
{
    return strncmp(text, what, strlen(what)) == 0;
}

/* Walk over the points behind `from`, which ends behind the last of them. -1: laid out
 * otherwise. */
static int count_points(const char **from)
{
    int n = 0;
    const char *at = *from;
    while (is_at(at, POINT) && n < INT_MAX) {
        const char *const end = strstr(at + 1, POINT_END);
        if (end == NULL) {
            return -1;
        }
        at = end + strlen(POINT_END);
        n++;
        if (is_at(at, LIST_END)) {
            *from = at;
            return n;
        }
        if (*at++ != ',') {
            return -1;
        }
    }
    return -1;
}

mt_status mt_result_points_find(const char *text, size_t length, int least,
                                mt_result_points *out, mt_err *err)
{
    *out = (mt_result_points){.n = 0};
    const char *const trade = strstr(text, TRADE);
    const char *const list = trade == NULL ? NULL : strstr(trade, LIST);
    const char *const first = list == NULL ? NULL : list + strlen(LIST);
    const char *end = first;
    const int n = first == NULL ? -1 : count_points(&end);
    if (n < least || end == NULL) {
        return MT_OK;
    }
    const size_t before = (size_t)(first - text);
    const size_t after = length - (size_t)(end - text);
    char *const rest = malloc(before + after + 1);
    if (rest == NULL) {
        return mt_fail(err, MT_E_MEMORY, "%s", mt_status_text(MT_E_MEMORY));
    }
    memcpy(rest, text, before);
    memcpy(rest + before, end, after);
    rest[before + after] = '\0';
    out->n = n;
    out->at = first;
    out->rest = rest;
    out->rest_length = before + after;
    return MT_OK;
}

size_t mt_result_points_next(mt_result_points *p, const char **text)
{
    *text = p->at + 1;
    const char *const end = strstr(*text, POINT_END) + strlen(POINT_END);
    p->at = end + 1; /* behind its comma, but for the last one */
    return (size_t)(end - *text);
}

void mt_result_points_free(mt_result_points *p)
{
    free(p->rest);
    *p = (mt_result_points){.n = 0};
}
