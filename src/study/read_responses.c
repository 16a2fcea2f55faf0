/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/read_priv.h"

#define RESPONSE_KEYS(X)                                           \
    X(RESPONSE_CONFIGURATION, "configuration", MT_KEY_TEXT, false) \
    X(RESPONSE_INPUT, "input", MT_KEY_TEXT, true)                  \
    X(RESPONSE_OUTPUT, "output", MT_KEY_TEXT, true)                \
    X(RESPONSE_BAND, "band_hz", MT_KEY_LIST, true, RANGE)          \
    X(RESPONSE_PROFILE, "profile", MT_KEY_TEXT, false)             \
    X(RESPONSE_DESCRIPTION, "description", MT_KEY_TEXT, false)     \
    X(RESPONSE_SOURCE, "source", MT_KEY_TEXT, false)
enum { RESPONSE_KEYS(MT_STUDY_KEY_ENUM) RESPONSE_KEY_COUNT };
static const mt_key KEYS[] = {RESPONSE_KEYS(MT_STUDY_KEY)};
const mt_key_table mt_study_response_keys = {"response", KEYS, RESPONSE_KEY_COUNT};

static bool read_response(mt_study_reader *s, mt_addr value, mt_study_response *r)
{
    mt_study_object o;
    double band[2];
    *r = mt_study_response_default(value);
    if (!mt_read_study_object(s, value, &mt_study_response_keys, &o)) {
        return false;
    }
    r->configuration_name = mt_reader_ref(&s->r, o.found[RESPONSE_CONFIGURATION]);
    r->response_limit.input = mt_reader_ref(&s->r, o.found[RESPONSE_INPUT]);
    r->response_limit.output = mt_reader_ref(&s->r, o.found[RESPONSE_OUTPUT]);
    if (o.found[RESPONSE_BAND] != MT_NO_ADDR &&
        mt_read_study_pair(s, o.found[RESPONSE_BAND], o.found[RESPONSE_BAND], band)) {
        r->response_limit.lower_hz = band[0];
        r->response_limit.upper_hz = band[1];
    }
    r->response_limit.profile_name = mt_reader_ref(&s->r, o.found[RESPONSE_PROFILE]);
    r->response_limit.profile = mt_read_study_profile(s, r->response_limit.profile_name);
    r->description = mt_reader_text(&s->r, o.found[RESPONSE_DESCRIPTION]);
    r->source = mt_reader_text(&s->r, o.found[RESPONSE_SOURCE]);
    return true;
}

void mt_read_study_responses(mt_study_reader *s, mt_addr list)
{
    mt_study *const study = s->study;
    mt_items items = mt_reader_items(&s->r, list);
    study->responses = mt_reader_room(&s->r, &items, sizeof *study->responses);
    while (mt_items_next(&items)) {
        mt_study_response *const r = &study->responses[study->n_responses];
        study->n_responses += read_response(s, items.at, r) ? 1 : 0;
    }
}
