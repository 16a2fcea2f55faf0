/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What modes --damped adds. */
#include "cli/damped.h"

#include <math.h>

#include "base/format.h"

enum { DIGITS = 6, RATIO_DIGITS = 2 };

static const char *kind_name(mt_damped_kind kind)
{
    switch (kind) {
    case MT_DAMPED_OSCILLATING:
        return "oscillating";
    case MT_DAMPED_OVERDAMPED:
        return "overdamped";
    case MT_DAMPED_RIGID_BODY:
        return "rigid_body";
    case MT_DAMPED_UNDECIDED:
        return "undecided";
    case MT_DAMPED_UNSTABLE:
        break;
    }
    return "unstable";
}

/* 1-based number of an oscillating mode; 0 for the others, and where one is undecided. */
static int index_of(const mt_damped_modes *d, int i)
{
    int index = 0;
    for (int k = 0; k <= i; k++) {
        index += d->kind[k] == MT_DAMPED_OSCILLATING ? 1 : 0;
    }
    return d->kind[i] == MT_DAMPED_OSCILLATING && mt_damped_indexed(d) ? index : 0;
}

/* A value of a root, or NaN of an undecided one, which is only known to be small. */
static double decided_value(const mt_damped_modes *d, int i, double x)
{
    return d->kind[i] == MT_DAMPED_UNDECIDED ? nan("") : x;
}

static bool is_within_count(const mt_damped_modes *d, int i, int count)
{
    return count == 0 || index_of(d, i) <= count;
}

/* NaN where there is no oscillation. */
static double damped_hz(const mt_damped_modes *d, int i)
{
    return d->im[i] > 0.0 ? mt_damped_hz(d, i) : nan("");
}

void mt_damped_columns(mt_table *t, bool with_configuration)
{
    if (with_configuration) {
        mt_table_column(t, "configuration", "configuration", MT_ALIGN_LEFT);
    }
    mt_table_column(t, "damped mode", "index", MT_ALIGN_RIGHT);
    mt_table_column(t, "kind", "kind", MT_ALIGN_LEFT);
    mt_table_column(t, "natural [Hz]", "natural_frequency_hz", MT_ALIGN_POINT);
    mt_table_column(t, "damped [Hz]", "damped_frequency_hz", MT_ALIGN_POINT);
    mt_table_column(t, "damping ratio [%]", "damping_ratio_percent", MT_ALIGN_POINT);
    mt_table_column(t, "decay [1/s]", "decay_per_s", MT_ALIGN_POINT);
    mt_table_column(t, "residual", "residual", MT_ALIGN_POINT);
}

void mt_damped_rows(mt_table *t, const mt_damped_modes *d, int count, const char *configuration)
{
    for (int i = 0; i < d->count; i++) {
        char text[24];
        const int index = index_of(d, i);
        if (!is_within_count(d, i, count)) {
            continue;
        }
        (void)mt_snprintf(text, sizeof text, "%d", index);
        if (configuration != NULL) {
            mt_table_text(t, configuration);
        }
        mt_table_text(t, index > 0 ? text : NULL);
        mt_table_text(t, configuration == NULL && d->kind[i] == MT_DAMPED_RIGID_BODY
                             ? "rigid body"
                             : kind_name(d->kind[i]));
        mt_table_number(t, decided_value(d, i, mt_damped_natural_hz(d, i)), DIGITS);
        mt_table_number(t, decided_value(d, i, damped_hz(d, i)), DIGITS);
        mt_table_number(t, decided_value(d, i, 100.0 * mt_damped_ratio(d, i)), DIGITS);
        mt_table_number(t, decided_value(d, i, 0.0 - d->re[i]), DIGITS);
        mt_table_number(t, d->residual[i], RATIO_DIGITS);
    }
}

void mt_damped_print(const mt_damped_modes *d, int count, mt_text *out)
{
    mt_table t = mt_table_default();
    int overdamped = 0;
    mt_damped_columns(&t, false);
    mt_damped_rows(&t, d, count, NULL);
    mt_text_add(out, "\n");
    mt_table_print(&t, 2, mt_terminal_width(), out);
    mt_table_free(&t);
    for (int i = 0; i < d->count; i++) {
        overdamped += d->kind[i] == MT_DAMPED_OVERDAMPED ? 1 : 0;
    }
    if (overdamped > 0) {
        mt_text_addf(out, "  %d real root%s: %s without oscillation.\n", overdamped,
                     overdamped == 1 ? "" : "s", overdamped == 1 ? "it decays" : "they decay");
    }
}

void mt_damped_json(const mt_damped_modes *d, int count, mt_json_writer *w)
{
    mt_json_open(w, "damped_modes", '[');
    for (int i = 0; i < d->count; i++) {
        const int index = index_of(d, i);
        if (!is_within_count(d, i, count)) {
            continue;
        }
        mt_json_open(w, NULL, '{');
        if (index > 0) {
            mt_json_put_integer(w, "index", index);
        } else {
            mt_json_put_null(w, "index");
        }
        mt_json_put_string(w, "kind", kind_name(d->kind[i]));
        mt_json_put_number(w, "natural_frequency_hz",
                           decided_value(d, i, mt_damped_natural_hz(d, i)));
        mt_json_put_number(w, "damped_frequency_hz", decided_value(d, i, damped_hz(d, i)));
        mt_json_put_number(w, "damping_ratio_percent",
                           decided_value(d, i, 100.0 * mt_damped_ratio(d, i)));
        mt_json_put_number(w, "decay_per_s", decided_value(d, i, 0.0 - d->re[i]));
        mt_json_put_number(w, "residual", d->residual[i]);
        mt_json_close(w);
    }
    mt_json_close(w);
}
