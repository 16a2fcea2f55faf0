/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What users of the library read from a study. */
#include <math.h>

#include "study/study.h"

static const mt_variable *variable(const mt_study *study, int i)
{
    return study != NULL && i >= 0 && i < study->n_variables ? &study->variables[i] : NULL;
}

const char *mt_study_title(const mt_study *study)
{
    return study == NULL ? NULL : study->name;
}

const mt_model *mt_study_model(const mt_study *study)
{
    return study == NULL ? NULL : study->model;
}

int mt_study_variable_count(const mt_study *study)
{
    return study == NULL ? 0 : study->n_variables;
}

const char *mt_study_variable_name(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL ? NULL : v->parameter_name.s;
}

double mt_study_variable_original(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL ? nan("") : v->original;
}

double mt_study_variable_lower(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL ? nan("") : v->n_catalogue > 0 ? v->catalogue[0] : v->lower;
}

double mt_study_variable_upper(const mt_study *study, int i)
{
    const mt_variable *const v = variable(study, i);
    return v == NULL            ? nan("")
           : v->n_catalogue > 0 ? v->catalogue[v->n_catalogue - 1]
                                : v->upper;
}
