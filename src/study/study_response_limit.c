/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Goals of types "response" and "vibration": frequencies, profiles and what of them is asked,
 * and in which unit that is. Names of ports are looked up where the mechanism is known
 * (response/ports.h); their units follow from the names alone.
 */
#include "study/study_priv.h"

#include <string.h>

static const char BASE[] = "base.";
static const char AXES[] = "xyz";

/* The derivative in a port's name, "grip.x:relative_velocity": 1; without a colon: `none`. */
static int motion_of(const char *port, int none)
{
    static const char *const motions[] = {"displacement", "velocity", "acceleration"};
    const char *const colon = strchr(port, ':');
    for (int k = 0; k < MT_COUNT(motions) && colon != NULL; k++) {
        if (strstr(colon, motions[k]) != NULL) {
            return k;
        }
    }
    return none;
}

/* True where the last part of the name, before the colon, is a rotation: "grip.rx". */
static bool turns(const char *port)
{
    const size_t length = strcspn(port, ":");
    size_t at = length;
    while (at > 0 && port[at - 1] != '.') {
        at--;
    }
    return length > at && port[at] == 'r';
}

static const char *motion_unit(const char *port, int none)
{
    static const char *const units[2][3] = {{"m", "m/s", "m/s^2"}, {"rad", "rad/s", "rad/s^2"}};
    return units[turns(port) ? 1 : 0][motion_of(port, none)];
}

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* Unit of the force of "spring.NAME" or a damper, by its type; for one of joints, whose
 * rotation or sliding is not known here, and otherwise: NULL. */
static const char *force_unit(const mt_model *m, const char *name, bool damper)
{
    for (int i = 0; i < m->n_springs; i++) {
        const mt_spring *const s = &m->springs[i];
        if (s->damper == damper && s->name.s != NULL && strcmp(s->name.s, name) == 0) {
            return s->type == MT_SPRING_TORSION   ? "N m"
                   : s->type == MT_SPRING_BUSHING ? NULL
                                                  : "N";
        }
    }
    return NULL;
}

static const char *output_unit(const mt_model *m, const char *port)
{
    static const char *const springs[] = {"spring.", "damper."};
    for (int k = 0; k < MT_COUNT(springs); k++) {
        if (begins(port, springs[k])) {
            return force_unit(m, port + strlen(springs[k]), k == 1);
        }
    }
    return begins(port, "joint.") ? "N" : motion_unit(port, 0);
}

static const char *input_unit(const char *port)
{
    return begins(port, BASE) ? motion_unit(port, 2) : turns(port) ? "N m" : "N";
}

static void find_unit(mt_study_check *c, mt_response_limit *s)
{
    const char *const out = output_unit(c->model, s->output.s);
    if (out != NULL && s->profile_name.s != NULL) {
        s->unit = out;
    } else if (out != NULL) {
        s->unit = mt_arena_printf(&c->study->mem, "%s per %s", out, input_unit(s->input.s));
    }
}

void mt_check_range(mt_study_check *c, const mt_response_limit *s, mt_addr owner)
{
    if (s->lower_hz >= s->upper_hz) {
        mt_diag_error(c->diags, mt_diag_member(c->diags, owner, "band_hz"),
                      "band_hz (%g to %g) must be two frequencies in ascending order",
                      s->lower_hz, s->upper_hz);
    }
}

static void check_frequencies(mt_study_check *c, const mt_goal *goal,
                              const mt_response_limit *s)
{
    const bool single = mt_diag_member(c->diags, goal->addr, "at_hz") != goal->addr;
    if (!MT_HAS(s->lower_hz) || !MT_HAS(s->upper_hz)) {
        return; /* noted by the reader */
    }
    if (single) {
        return;
    }
    mt_check_range(c, s, goal->addr);
    for (int k = MT_SLOT_EQUALS; k <= MT_SLOT_AT_LEAST; k++) {
        if (MT_HAS(goal->number[k])) {
            mt_diag_error(c->diags, mt_check_goal_addr(c, goal, (mt_goal_slot)k),
                          "the largest response over a band is only limited from above: give "
                          "\"at_most\", or one frequency, \"at_hz\"");
        }
    }
}

/* A profile says how the ground accelerates along one axis. */
static void check_input(mt_study_check *c, const mt_goal *goal, mt_response_limit *s)
{
    const mt_vibration *const v = s->profile;
    if (s->input.s == NULL && s->input.addr == goal->addr && v->axis == MT_ABSENT) {
        mt_diag_error(c->diags, s->profile_name.addr,
                      "the profile \"%s\" names no axis: give \"input\", such as \"base.z\"",
                      s->profile_name.s);
    } else if (s->input.s == NULL && s->input.addr == goal->addr) {
        s->input.s = mt_arena_printf(&c->study->mem, "%s%c", BASE, AXES[v->axis]);
    } else if (s->input.s != NULL && !begins(s->input.s, BASE)) {
        mt_diag_error(c->diags, s->input.addr,
                      "\"%s\" is a force, and a profile says how the ground accelerates: the "
                      "input is \"base.x\", \"base.y\" or \"base.z\"",
                      s->input.s);
    } else if (s->input.s != NULL && motion_of(s->input.s, 2) != 2) {
        mt_diag_error(
            c->diags, s->input.addr,
            "\"%s\" is not an acceleration, and a profile says how the ground accelerates",
            s->input.s);
    }
}

static void check_profile(mt_study_check *c, const mt_goal *goal, mt_response_limit *s)
{
    const mt_vibration *const v = s->profile;
    const char *const lacks =
        s->quantity == MT_RESPONSE_LIMIT_RMS && v->n_random == 0   ? "random part"
        : s->quantity == MT_RESPONSE_LIMIT_SINE && v->n_tones == 0 ? "tone"
                                                                   : NULL;
    check_input(c, goal, s);
    if (lacks != NULL) {
        const mt_addr quantity = mt_diag_member(c->diags, goal->addr, "quantity");
        mt_diag_error(c->diags, quantity != goal->addr ? quantity : s->profile_name.addr,
                      "the profile \"%s\" has no %s: \"quantity\": \"%s\" is always 0",
                      s->profile_name.s, lacks, mt_response_limit_names[s->quantity]);
    }
    for (int k = MT_SLOT_EQUALS; k <= MT_SLOT_AT_LEAST && s->quantity != MT_RESPONSE_LIMIT_RMS;
         k++) {
        if (MT_HAS(goal->number[k])) {
            mt_diag_error(c->diags, mt_check_goal_addr(c, goal, (mt_goal_slot)k),
                          "the largest response to tones is only limited from above: give "
                          "\"at_most\", or \"quantity\": \"rms\"");
        }
    }
}

void mt_study_check_response_limit(mt_study_check *c, mt_goal *goal)
{
    mt_response_limit *const s = goal->response_limit;
    if (s == NULL) {
        return; /* memory is out */
    }
    if (mt_goal_member_at(mt_goal_kind_of(goal->type), MT_SLOT_MEASUREMENT) >= 0) {
        mt_study_check_measured(c, s, goal->addr);
        return; /* its number is a distance, without a unit */
    }
    if (s->quantity == MT_RESPONSE_LIMIT_RESPONSE) {
        check_frequencies(c, goal, s);
    } else if (s->profile != NULL) {
        check_profile(c, goal, s);
    }
    if (s->input.s != NULL && s->output.s != NULL) {
        find_unit(c, s);
    }
}
