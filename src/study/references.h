/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef STUDY_REFERENCES_H
#define STUDY_REFERENCES_H

#include "io/members.h"
#include "measurement/measurement.h"
#include "model/model.h"

/* Modes to compare with: another model's configuration, or measured values at sensors. */
typedef struct mt_measured_mode {
    double frequency_hz; /* NaN: not given */
    int n_values;
    mt_name *channels; /* "sensor.direction" */
    double *values;
    mt_addr addr;
} mt_measured_mode;

typedef struct mt_reference {
    mt_name name;
    mt_name model_path;    /* as written; NULL: measured */
    const mt_model *model; /* of the study's models; NULL: measured */
    mt_name configuration_name;
    int configuration;
    int n_modes;
    mt_measured_mode *modes;
    const char *source;
    mt_addr addr;
} mt_reference;

extern const mt_key_table mt_study_reference_keys;
extern const mt_key_table mt_study_measured_keys;
extern const mt_key_table mt_study_measurement_keys;

struct mt_study_reader;
struct mt_study_check;
/* Read both objects, and the files that they name. */
void mt_read_study_references(struct mt_study_reader *s, mt_addr references,
                              mt_addr measurements);
/* Check both, and keep of the measured responses those that are meant. */
void mt_study_check_references(struct mt_study_check *c);
int mt_check_measurement(struct mt_study_check *c, mt_name name);
/* Number of channels of a measured mode that the model has. */
int mt_count_common_channels(const mt_model *model, const mt_measured_mode *mode);
/* Note at addr where the model and the reference's model have no sensor and direction in
 * common, which a shape or a MAC needs. */
void mt_check_common_sensors(struct mt_study_check *c, int reference, mt_addr addr);

#endif
