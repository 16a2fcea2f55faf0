/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_CHECK_H
#define STUDY_CHECK_H

#include "study/study.h"

/* The state of checking a study. Each part notes its problems and resolves what it can; what it
 * cannot resolve stays MT_ABSENT. A shortage of memory is remembered by the study's arena. */
typedef struct mt_study_check {
    mt_study *study;
    const mt_model *model;
    mt_diags *diags;
} mt_study_check;

/* Conditions that depend on variables; the box of designs whose modes are counted alike; and
 * where there are no errors the model at the bounds of the variables, and redundant joints.
 * After all other checks. */
void mt_study_check_bounds(mt_study_check *c);
/* What is allowed and unlikely; after the checks. Warnings that compare members come only where
 * there are no errors. */
void mt_study_check_warnings(mt_study_check *c);

/* Note an unknown name, with the nearest of the n records of `size` bytes, or with all where
 * none is near and there are few. Every such record begins with its mt_name. */
void mt_check_unknown_name(mt_study_check *c, mt_name name, const char *what,
                           const void *records, int n, size_t size);
/* Names to indices, with "did you mean". An absent name gives MT_ABSENT without a
 * message. */
int mt_check_parameter(mt_study_check *c, mt_name name);
/* Note a variable of the study that an override sets. */
void mt_check_unset(mt_study_check *c, mt_name name, int parameter);
int mt_check_configuration(mt_study_check *c, const mt_model *model, mt_name name);
int mt_check_reference(mt_study_check *c, mt_name name);
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
/* True where a number was given, even one that could not be read: the object then has the
 * member. */
bool mt_check_given(const mt_study_check *c, double value, mt_addr object, const char *member);

#endif
