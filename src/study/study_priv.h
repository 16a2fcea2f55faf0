/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_STUDY_PRIV_H
#define STUDY_STUDY_PRIV_H

#include "study/study.h"

/* The steps of mt_study_finish, one file each. Each notes its problems and resolves what it
 * can; what it cannot resolve stays MT_ABSENT. */
typedef struct mt_study_check { /* a shortage of memory is remembered by the study's arena */
    mt_study *study;
    const mt_model *model;
    mt_diags *diags;
} mt_study_check;

void mt_study_check_references(mt_study_check *c);   /* study_references.c */
void mt_study_check_measurements(mt_study_check *c); /* study_measurements.c */
/* the measurement that a goal is compared with; called by mt_study_check_response_limit */
void mt_study_check_measured(mt_study_check *c, mt_response_limit *s, mt_addr goal);
void mt_study_check_variables(mt_study_check *c);  /* study_variables.c */
void mt_study_check_overrides(mt_study_check *c);  /* study_variables.c; after the goals */
void mt_study_check_objectives(mt_study_check *c); /* study_objectives.c; after the goals */
void mt_study_check_published(mt_study_check *c);  /* study_published.c */
void mt_study_check_trade(mt_study_check *c);      /* study_trade.c; last of the checks */
void mt_study_fill_counted(mt_study_check *c);     /* study_counted.c; after all of them */
void mt_study_check_bounds(mt_study_check *c); /* study_bounds.c; where there are no errors */
/* study_redundant.c; after mt_study_check_bounds, where there are no errors */
void mt_study_check_redundant(mt_study_check *c);
/* study_warnings.c; after the checks; warnings that compare members only where there are no
 * errors */
void mt_study_check_warnings(mt_study_check *c);

/* Shared: names to indices, with "did you mean". An absent name gives MT_ABSENT without a
 * message. */
int mt_check_parameter(mt_study_check *c, mt_name name);
/* Note a variable of the study that an override sets. */
void mt_check_unset(mt_study_check *c, mt_name name, int parameter);
int mt_check_configuration(mt_study_check *c, const mt_model *model, mt_name name);
int mt_check_reference(mt_study_check *c, mt_name name);
int mt_check_measurement(mt_study_check *c, mt_name name);
/* The aircraft of that name. NULL where the name is absent or unknown (noted, unless the
 * catalogue itself could not be read). */
const mt_aircraft *mt_check_aircraft(mt_study_check *c, mt_name name);
/* Add a sentence to the result's warnings; text is in the study's arena (NULL: out of
 * memory). */
void mt_check_warn_result(mt_study_check *c, const char *text);
/* Index of the model's only configuration; where there are several, MT_ABSENT and a problem
 * noted at addr. */
int mt_check_only_configuration(mt_study_check *c, const mt_model *model, mt_addr addr);
/* Resolve a mode and check its index (absent: noted). Returns the index, that of a named mode
 * included; 0 where there is none. */
int mt_check_mode(mt_study_check *c, mt_mode_ref *mode);
/* Check that the reference has the mode with its shape, or, where not `shape`, with its
 * frequency. reference_mode 0: mode_index. Problems are noted at addr. */
void mt_check_reference_mode(mt_study_check *c, int reference, int reference_mode,
                             int mode_index, bool shape, mt_addr addr);
/* Number of channels of a measured mode that the model has (study_references.c). */
int mt_count_common_channels(const mt_model *model, const mt_measured_mode *mode);
/* Note at addr where the model and the reference's model have no sensor and direction in
 * common, which a shape or a MAC needs (study_references.c). */
void mt_check_common_sensors(mt_study_check *c, int reference, mt_addr addr);
/* True where a number was given, even one that could not be read: the object then has the
 * member. */
bool mt_check_given(const mt_study_check *c, double value, mt_addr object, const char *member);

#endif
