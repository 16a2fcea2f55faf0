/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Dead loads as potentials: -F . x of a point, -M theta of a plane angle, -F s or -M theta of a
 * joint's coordinate s or theta. Their second derivatives are the geometric stiffness: that of
 * a force at the arm w is (F . w) I - (F w^T + w F^T)/2 on the rotation of its body
 * (measure.c), that of a plane angle is none.
 */
#include "mechanics/build.h"

static mt_status absent(mt_builder *b, const mt_load *load)
{
    return mt_fail(b->err, MT_E_INPUT,
                   "load \"%s\" acts on what is not in configuration \"%s\"", load->name.s,
                   b->model->configurations[b->sys->configuration].name.s);
}

/* Point of the load: as given, at the end or node of a link, or at the centre (-1). */
static int point_of(mt_builder *b, const mt_load *load, int body)
{
    mt_node at[3];
    const bool start = load->on.kind == MT_ATTACH_LINK_START;
    if (load->at.given) {
        mt_build_position(b, &load->at, at);
    } else if (start || load->on.kind == MT_ATTACH_LINK_END) {
        const mt_link *const link = &b->model->links[load->on.index];
        mt_build_position(b, start ? &link->from : &link->to, at);
    } else if (load->on.kind == MT_ATTACH_LINK_NODE) {
        mt_build_link_node(b, load->on.index, load->on.element, at);
    } else {
        return -1;
    }
    return mt_build_arm(b, body, at, mt_build_name(b, "point of load \"%s\"", load->name.s));
}

static void build_size(mt_builder *b, const mt_load *load, int measure, mt_node size)
{
    if (size != b->zero) {
        const mt_load_def def = {.name = load->name.s,
                                 .measure = measure,
                                 .body = MT_GROUND,
                                 .point = -1,
                                 .force = {MT_NO_NODE, MT_NO_NODE, MT_NO_NODE},
                                 .size = size};
        mt_build_load(b, &def);
    }
}

static mt_status build_on_joint(mt_builder *b, const mt_load *load)
{
    const int measure = mt_build_find_coordinate(b, load->joint, load->joint_link,
                                                 load->joint_hinge, load->has_moment);
    if (measure < 0) {
        return absent(b, load);
    }
    build_size(b, load, measure,
               mt_build_num(b, load->has_moment ? load->moment : load->force[0]));
    return MT_OK;
}

static mt_status build_load(mt_builder *b, const mt_load *load)
{
    if (load->joint_name.s != NULL) {
        return build_on_joint(b, load);
    }
    mt_load_def def = {.name = load->name.s, .measure = -1, .size = MT_NO_NODE};
    if (!mt_build_attach(b, &load->on, &def.body)) {
        return absent(b, load);
    }
    if (load->has_force) {
        bool any = false;
        mt_build_coordinates(b, load->force, def.force);
        for (int i = 0; i < 3; i++) {
            any = any || def.force[i] != b->zero;
        }
        if (any) {
            def.point = point_of(b, load, def.body);
            mt_build_load(b, &def);
        }
    }
    if (load->has_moment) { /* two dimensions */
        build_size(b, load, mt_build_angle(b, MT_GROUND, def.body, b->axis_vec[2]),
                   mt_build_num(b, load->moment));
    }
    return MT_OK;
}

mt_status mt_build_loads(mt_builder *b)
{
    for (int i = 0; i < b->model->n_loads; i++) {
        const mt_load *const load = &b->model->loads[i];
        if (mt_model_present(&load->in, b->sys->configuration)) {
            MT_TRY(build_load(b, load));
        }
    }
    return MT_OK;
}
