/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What the readers think of the structure of files, for test_schemas.py, which compares it with
 * the schemas. Started with the name of a list, a line "model PATH" each (or "study",
 * "aircraft", "profile"), it prints for each the number of errors of structure, the number of
 * lines said, and the status. Without arguments it tests itself: that it can tell right from
 * wrong.
 */
#include <stdio.h>
#include <string.h>

#include "environment/aircraft.h"
#include "environment/vibration.h"
#include "io/file.h"
#include "io/options.h"
#include "model/read.h"
#include "mt_test.h"
#include "study/read.h"

enum { MAX_LINE = 4096, LIST_LIMIT = 1 << 24 };

typedef struct verdict {
    mt_status rc;
    int structural;
    int lines;
} verdict;

static verdict judge(const char *kind, const char *path)
{
    verdict v = {MT_OK, 0, 0};
    mt_diagnostics said = {.count = 0};
    mt_model *model = NULL;
    mt_study *study = NULL;
    mt_vibration *profile = NULL;
    const mt_io_options opt = {.root = "/", .structural = &v.structural};
    if (strcmp(kind, "aircraft") == 0) {
        mt_aircraft_list list = {0};
        mt_arena mem = {0};
        v.rc = mt_arena_init(&mem, 0, NULL);
        v.rc = v.rc == MT_OK ? mt_aircraft_load(path, &opt, &mem, &list, &said, NULL) : v.rc;
        mt_arena_free(&mem);
    } else if (strcmp(kind, "profile") == 0) {
        v.rc = mt_vibration_load(path, &opt, &profile, &said, NULL);
    } else if (strcmp(kind, "study") == 0) {
        v.rc = mt_study_load(path, &opt, &study, &said, NULL);
    } else {
        v.rc = mt_model_load(path, &opt, &model, &said, NULL);
    }
    for (const char *s = said.lines.s; s != NULL && *s != '\0'; s++) {
        v.lines += *s == '\n';
    }
    mt_model_delete(model);
    mt_study_delete(study);
    mt_vibration_delete(profile);
    mt_diagnostics_free(&said);
    return v;
}

/* Judge every file of a list; 0 where the list could be read. */
static int judge_list(const char *list)
{
    mt_file file = {0};
    if (mt_file_read(list, NULL, LIST_LIMIT, &file, NULL) != MT_OK) {
        return 2;
    }
    for (char *line = file.bytes; *line != '\0';) {
        char *const end = strchr(line, '\n');
        char *const space = strchr(line, ' ');
        if (end == NULL || space == NULL || space > end) {
            break;
        }
        *end = '\0';
        *space = '\0';
        const verdict v = judge(line, space + 1);
        printf("%d %d %s\n", v.structural, v.lines, mt_status_name(v.rc));
        line = end + 1;
    }
    mt_file_free(&file);
    return 0;
}

static void write_and_judge(mt_test *t, const char *text, mt_status rc, int structural)
{
    static const char path[] = "verdict_test.json";
    mt_test_row(t, "%s", text);
    FILE *const file = fopen(path, "w");
    REQUIRE(t, file != NULL);
    CHECK(t, fputs(text, file) >= 0 && fclose(file) == 0);
    const verdict v = judge("model", path);
    (void)remove(path);
    CHECK_INT(t, v.rc, rc);
    CHECK_INT(t, v.structural, structural);
}

static void verdict__tells_structure_from_meaning(mt_test *t)
{
    write_and_judge(t, "{\"format\": \"modetune-model/1\", \"dimension\": 2}", MT_OK, 0);
    write_and_judge(t, "{\"format\": \"modetune-model/1\", \"dimension\": 4, \"x\": 1}",
                    MT_E_INPUT, 2);
    write_and_judge(
        t,
        "{\"format\": \"modetune-model/1\", \"dimension\": 2, \"parameters\": {\"a\": \"b\"}}",
        MT_E_INPUT, 0);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {MT_TEST(verdict__tells_structure_from_meaning)};
    if (argc > 1) {
        return judge_list(argv[1]);
    }
    return cmocka_run_group_tests_name(__FILE__, tests, NULL, NULL) != 0;
}
