/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * A stranger's program: includes what is installed, links it, and sees one version. consumer
 * MODEL STUDY prints the version, the frequency of the model's first configuration, and what
 * the study says: outcome and value of its variable L.
 */
#include <modetune/mechanism.h>
#include <modetune/model.h>
#include <modetune/study.h>
#include <modetune/version.h>
#include <stdio.h>
#include <string.h>

static int ask_model(const char *path)
{
    mt_err err = {MT_OK, ""};
    mt_model *model = NULL;
    mt_mechanism *mechanism = NULL;
    int failed = 1;
    if (mt_model_read(path, NULL, &model, &err) != MT_OK ||
        mt_mechanism_new(model, "hanging", 0, NULL, &mechanism, &err) != MT_OK) {
        fprintf(stderr, "%s\n", err.text);
    } else {
        failed = printf(" %d mode %.6f Hz", mt_mechanism_vibration_modes(mechanism),
                        mt_mechanism_hz(mechanism, 1)) < 0;
    }
    mt_mechanism_delete(mechanism);
    mt_model_delete(model);
    return failed;
}

static int ask_study(const char *path)
{
    mt_err err = {MT_OK, ""};
    mt_study *study = NULL;
    mt_result *result = NULL;
    int failed = 1;
    if (mt_study_read(path, NULL, &study, &err) != MT_OK ||
        mt_study_solve(study, NULL, &result, &err) != MT_OK) {
        fprintf(stderr, "%s\n", err.text);
    } else {
        failed = printf(" %s L %.6f\n", mt_result_status_name(mt_result_outcome(result)),
                        mt_result_value(result, 1, "L")) < 0;
    }
    mt_result_delete(result);
    mt_study_delete(study);
    return failed;
}

int main(int argc, char **argv)
{
    if (argc != 3 || strcmp(mt_version(), MT_VERSION_STRING) != 0) {
        fprintf(stderr, "library %s, header %s\n", mt_version(), MT_VERSION_STRING);
        return 1;
    }
    return printf("%s", mt_version()) < 0 || ask_model(argv[1]) != 0 || ask_study(argv[2]) != 0;
}
