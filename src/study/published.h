/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_PUBLISHED_H
#define STUDY_PUBLISHED_H

#include "modetune/study.h"

#include "study/goals.h"

#define MT_ROLE_LIST(X)                 \
    X(MT_ROLE_VERIFIES, "verifies")     \
    X(MT_ROLE_CALIBRATES, "calibrates") \
    X(MT_ROLE_NOT_COMPARABLE, "not_comparable")
#define MT_ROLE_ENUM(id, name) id,
typedef enum mt_role { MT_ROLE_LIST(MT_ROLE_ENUM) MT_ROLE_COUNT } mt_role;
#undef MT_ROLE_ENUM

#define MT_PUBLISHED_LIST(X)               \
    X(MT_PUBLISHED_PARAMETER, "parameter") \
    X(MT_PUBLISHED_QUANTITY, "quantity")   \
    X(MT_PUBLISHED_FREQUENCY, "frequency") \
    X(MT_PUBLISHED_MAC, "mac")             \
    X(MT_PUBLISHED_STATUS, "status")
#define MT_PUBLISHED_ENUM(id, name) id,
typedef enum mt_published_kind {
    MT_PUBLISHED_LIST(MT_PUBLISHED_ENUM) MT_PUBLISHED_KIND_COUNT
} mt_published_kind;
#undef MT_PUBLISHED_ENUM

typedef struct mt_published {
    mt_published_kind kind;
    mt_name parameter_name;
    int parameter;
    mt_expr quantity;
    const char *quantity_text;
    mt_name configuration_name; /* frequency, mac */
    int configuration;
    mt_mode_ref mode;
    mt_name reference_name; /* mac */
    int reference;
    int reference_mode;
    const char *status; /* "solved" | "compromise" | "infeasible" | "fitted" */
    /* "design": "original": compared at the original design, not at the recommended one */
    bool original;
    /* compared within a tolerance; with limits it is only shown, and the limits are compared */
    double value;
    double tolerance; /* absolute */
    double tolerance_percent;
    double at_least;
    double at_most;
    mt_role role;
    const char *source;
    /* "label": its name in comparison tables; NULL: made from the other members */
    const char *label;
    mt_addr addr;
} mt_published;

/* The names in files: "verifies", "parameter". */
const char *mt_role_name(mt_role role);
const char *mt_published_kind_name(mt_published_kind kind);
/* The possible values of a published `status`, in the order of mt_result_status; *n is their
 * number. */
enum { MT_STUDY_STATUSES = MT_RESULT_INTERRUPTED };
extern const char *const mt_study_status_names[];

extern const mt_key_table mt_study_published_keys;
extern const mt_key_table mt_study_published_frequency_keys;
extern const mt_key_table mt_study_published_mac_keys;

struct mt_study_check;
void mt_study_check_published(struct mt_study_check *c);

#endif
