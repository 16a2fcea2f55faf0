/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/joint.h"

static const mt_joint_kind KINDS[] = {
    [MT_JOINT_FIXED] = {.in = {true, true},
                        .closes = MT_CLOSES_ALL,
                        .most_at = 2,
                        .turns = {{true, true}, {true, true}}},
    [MT_JOINT_REVOLUTE] = {.in = {true, true},
                           .coordinate = MT_COORDINATE_ANGLE,
                           .closes = MT_CLOSES_ALL,
                           .least_at = 1,
                           .most_at = 2,
                           .axis = {false, true},
                           .turns = {{false, false}, {true, true}}},
    [MT_JOINT_PRISMATIC] = {.in = {true, true},
                            .coordinate = MT_COORDINATE_DISPLACEMENT,
                            .closes = MT_CLOSES_ACROSS,
                            .least_at = 1,
                            .most_at = 2,
                            .axis = {true, true},
                            .turns = {{true, true}, {true, true}}},
    [MT_JOINT_PIN_IN_SLOT] = {.in = {true, false},
                              .coordinate = MT_COORDINATE_DISPLACEMENT,
                              .closes = MT_CLOSES_ACROSS,
                              .least_at = 1,
                              .most_at = 2,
                              .axis = {true, true},
                              .turns = {{true, false}, {true, false}}},
    [MT_JOINT_DISTANCE] = {.in = {true, true},
                           .closes = MT_CLOSES_LENGTH,
                           .least_at = 2,
                           .most_at = 2},
    [MT_JOINT_CYLINDRICAL] = {.in = {false, true},
                              .coordinate = MT_COORDINATE_ANGLE,
                              .closes = MT_CLOSES_ACROSS,
                              .least_at = 1,
                              .most_at = 2,
                              .axis = {false, true},
                              .turns = {{true, true}, {true, true}}},
    [MT_JOINT_SPHERICAL] = {.in = {false, true},
                            .closes = MT_CLOSES_ALL,
                            .least_at = 1,
                            .most_at = 2},
    [MT_JOINT_UNIVERSAL] = {.in = {false, true},
                            .closes = MT_CLOSES_ALL,
                            .least_at = 1,
                            .most_at = 2,
                            .axis = {false, true},
                            .axis_b = true,
                            .turns = {{true, true}, {true, true}}},
    [MT_JOINT_PLANAR] = {.in = {false, true},
                         .closes = MT_CLOSES_ALONG,
                         .least_at = 1,
                         .most_at = 2,
                         .axis = {false, true},
                         .turns = {{true, true}, {true, true}}},
    [MT_JOINT_POINT_ON_LINE] = {.in = {false, true},
                                .coordinate = MT_COORDINATE_DISPLACEMENT,
                                .closes = MT_CLOSES_ACROSS,
                                .least_at = 1,
                                .most_at = 2,
                                .axis = {false, true},
                                .turns = {{true, false}, {true, false}}},
    [MT_JOINT_POINT_ON_PLANE] = {.in = {false, true},
                                 .closes = MT_CLOSES_ALONG,
                                 .least_at = 1,
                                 .most_at = 2,
                                 .axis = {false, true},
                                 .turns = {{true, false}, {true, false}}},
    [MT_JOINT_ORIENTATION] = {.in = {true, true},
                              .turns = {{true, true}, {true, true}},
                              .article = "an"},
    [MT_JOINT_GEAR] = {.in = {true, true}, .couples = true},
    [MT_JOINT_RACK] = {.in = {true, true}, .couples = true},
};

const mt_joint_kind *mt_joint_kind_of(mt_joint_type type)
{
    return &KINDS[type];
}

bool mt_joint_slides(mt_joint_type type)
{
    return type == MT_JOINT_CYLINDRICAL || KINDS[type].coordinate == MT_COORDINATE_DISPLACEMENT;
}

const char *mt_joint_article(mt_joint_type type)
{
    return KINDS[type].article != NULL ? KINDS[type].article : "a";
}
