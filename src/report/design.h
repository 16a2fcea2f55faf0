/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef REPORT_DESIGN_H
#define REPORT_DESIGN_H

#include "report/section.h"
#include "report/table.h"
#include "result/result.h"

/* What of a design is told: the requirements compared with it, why it is so, its numbers; the
 * whole is all of these. */
typedef enum mt_design_part {
    MT_DESIGN_REQUIREMENTS,
    MT_DESIGN_REASONS,
    MT_DESIGN_NUMBERS,
    MT_DESIGN_WHOLE
} mt_design_part;

/* The sections of a design, or of the original one. Frequencies have 6 significant digits,
 * changes 3. */
void mt_write_design(const mt_summary_writer *to, const mt_result *result,
                     const mt_recommendation *r, mt_design_part part);
/* The objectives of a design with their values. */
void mt_write_objectives(const mt_summary_writer *to, const mt_recommendation *r);
/* The first objective at this design: "mass 16.94 kg (was 11.92)"; false (and no text) where it
 * is the change. */
bool mt_report_headline(const mt_recommendation *r, mt_text *out);
/* A cell of an objective's column. */
void mt_report_objective_cell(mt_table *t, const char *unit, double value);

/* One row per mode with its neighbouring bands: the band below it and the band above it, with
 * the distance to each. */
mt_table mt_report_clearances(const mt_recommendation *r);
/* A clearance; one that equals its margin within the accuracy of searches is shown as the
 * margin. */
void mt_table_clearance(mt_table *t, double percent, double margin, int digits);
/* The deviation of a goal; for a met goal, a deviation within the accuracy of searches is 0 for
 * people. */
void mt_table_off_by(mt_table *t, double percent, bool met, int digits);

/*
 * The frequencies of a design as one line of characters per configuration, on one linear scale
 * that ends a little above the study's requirements: digits are the recommended modes, "o" the
 * original ones, "#" a band, "-" its margin, "|" a target, "[" and "]" limits. No text where no
 * goal concerns frequencies. width: of the terminal; 0: none.
 */
void mt_report_ruler(const mt_recommendation *r, int width, mt_text *out);

#endif
