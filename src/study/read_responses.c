/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

static void response_defaults(void *item, mt_addr addr, int which)
{
    (void)which;
    *(mt_study_response *)item = mt_study_response_default(addr);
}

static void response_finish(mt_reader *r, const mt_object *o, int which, void *item)
{
    mt_response_limit *const limit = &((mt_study_response *)item)->response_limit;
    (void)o;
    (void)which;
    limit->profile = mt_read_study_profile(mt_study_reader_of(r), limit->profile_name);
}

#define THIS mt_study_response
static const mt_key RESPONSE[] = {
    MT_M_REF("configuration", false, configuration_name,
             "Name of a configuration of the model. Absent: its only one."),
    MT_M_REF("input", true, response_limit.input,
             "A port as `modetune response` has it: \"grip.y\", the force along a sensor's "
             "direction; \"base.y\", the ground's acceleration, or \"base.y:displacement\".",
             .examples = "[\"base.y\"]"),
    MT_M_REF("output", true, response_limit.output,
             "A port as `modetune response` has it: a sensor's motion (\"grip.y\", its "
             "displacement, or \"grip.y:acceleration\"), a force (\"spring.NAME\", "
             "\"damper.NAME\", \"joint.NAME.x\").",
             .examples = "[\"grip.y:acceleration\"]"),
    MT_S_PAIR("band_hz", true, response_limit.lower_hz, response_limit.upper_hz, RANGE,
              "From where to where it is shown.", .examples = "[[5, 500]]"),
    MT_M_REF("profile", false, response_limit.profile_name,
             "The vibration profile that the ground follows: a file, relative to this one, or "
             "the name of one that is part of the program (`modetune profile`). The input is "
             "an acceleration of the ground."),
    MT_M_TEXT("description", description, "Free text for people."),
    MT_M_TEXT("source", source, "Where it comes from: a table, a page, a test report."),
};
#undef THIS
const mt_key_table mt_study_response_keys = {
    .what = "response",
    .keys = RESPONSE,
    .n = MT_COUNT(RESPONSE),
    .size = sizeof(mt_study_response),
    .defaults = response_defaults,
    .finish = response_finish,
    .says = "What a forced vibration is caused by, and what it is seen in."};
