/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every place from loading a study to its answer that asks for memory is refused once: that is
 * a failure with its name, and nothing is lost or left. */
#include "mt_alloc.h"
#include "mt_sites.h"
#include "study_kinds.h"

/* Every third place of a study; with MT_EVERY=1, which sanitizers and coverage have, all. */
static int stride(void)
{
    return getenv("MT_EVERY") != NULL ? 1 : 3;
}

static mt_status answer(const mt_study *study, mt_result **result, mt_err *err)
{
    *result = NULL;
    return mt_study_solve(study, NULL, result, err);
}

static void places__each_is_refused_once(mt_test *t)
{
    for (int i = 0; i < MT_COUNT(study_kinds); i++) {
        study_case c;
        mt_err err = {.text = ""};
        mt_test_row(t, "%s", study_kinds[i].name);
        if (!study_load(t, study_kinds[i].model, study_kinds[i].members, &c)) {
            study_free(&c);
            continue;
        }
        mt_sites_record();
        CHECK_INT(t, answer(c.study, &c.result, &err), MT_OK);
        const int n = mt_sites_stop();
        CHECK(t, n > 0 && n < MT_SITES_MOST);
        for (int k = 0; k < n; k += stride()) {
            if (mt_sites_known(k)) {
                continue;
            }
            mt_result *result = NULL;
            const long before = mt_alloc_live();
            mt_test_row(t, "%s: place %d of %d", study_kinds[i].name, k, n);
            mt_sites_fail(k);
            err.text[0] = '\0';
            const mt_status rc = answer(c.study, &result, &err);
            CHECK(t, mt_sites_failed());
            (void)mt_sites_stop();
            CHECK_INT(t, rc, MT_E_MEMORY);
            CHECK(t, result == NULL && err.text[0] != '\0');
            mt_result_delete(result);
            CHECK(t, !mt_alloc_works() || mt_alloc_live() == before);
        }
        study_free(&c);
    }
}

MT_TEST_MAIN(MT_TEST(places__each_is_refused_once))
