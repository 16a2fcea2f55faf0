/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * What is shown against closed forms: a pendulum that comes to rest below its pivot, the
 * ellipsoid of a box (radii sqrt(5/12) of its sides), energies of two masses on two springs, a
 * joint that lies five metres off, poses of a driven joint.
 */
#include "mechanics/mech.h"
#include "model/values.h"
#include "scene/items.h"
#include "scene/scene.h"

static const double TOL = 1e-9;

/* All configurations of a model, as its file has it. Takes the model; a copy of its names is in
 * the scene. */
static mt_scene *scene_of(mt_test *t, mt_model *model)
{
    enum { MOST = 20 };
    const mt_scene_query ask = {.label = "original", .n_shown = -1};
    mt_err err = {.text = ""};
    mt_scene *scene = NULL;
    int configurations[MOST];
    if (model == NULL || model->n_configurations > MOST) {
        mt_model_delete(model);
        return NULL;
    }
    for (int i = 0; i < model->n_configurations; i++) {
        configurations[i] = i;
    }
    const mt_scene_extent extent = {.n_configurations = model->n_configurations,
                                    .configurations = configurations,
                                    .work = MT_SCENE_WORK};
    if (!CHECK(t, mt_scene_new(model, 1, &ask, &extent, &scene, &err) == MT_OK)) {
        (void)fprintf(stderr, "%s\n", err.text);
    }
    mt_model_delete(model);
    return scene;
}

static const mt_scene_view *view_of(const mt_scene *scene, int i)
{
    return &scene->designs[0].views[i];
}

static void scene__pendulum_rests_below_its_pivot(mt_test *t)
{
    /* a rod of 0.8 m, drawn at 60 degrees from the vertical */
    mt_scene *const scene = scene_of(
        t, mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
                         "\"gravity_m_per_s2\": [0, -9.81],"
                         "\"parameters\": {\"l\": 0.8, \"m\": 3},"
                         "\"points\": {\"o\": [0, 0], \"tip\": [\"l*sin(pi/3)\", \"-l*0.5\"]},"
                         "\"bodies\": [{\"name\": \"rod\", \"mass_kg\": \"m\","
                         "\"inertia_kg_m2\": \"m*l^2/12\", \"centre\": [\"l/2*sin(pi/3)\","
                         "\"-l/4\"]}],"
                         "\"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\","
                         "\"bodies\": [\"ground\", \"rod\"], \"at\": \"o\"}],"
                         "\"sensors\": [{\"name\": \"s\", \"on\": \"rod\", \"at\": \"tip\","
                         "\"directions\": [\"x\"]}]}"));
    if (!CHECK(t, scene != NULL)) {
        return;
    }
    const mt_scene_view *const v = view_of(scene, 0);
    if (CHECK(t, v->error == NULL && v->n_bodies == 2 && v->n_joints == 1 && v->n_modes == 1)) {
        const mt_scene_body *const rod = &v->bodies[1];
        CHECK_NEAR_ABS(t, rod->at[0], 0.0, TOL);
        CHECK_NEAR_ABS(t, rod->at[1], -0.4, TOL);
        CHECK_NEAR_ABS(t, rod->mass, 3.0, TOL);
        CHECK_NEAR_ABS(t, rod->rotation[0], 0.5, TOL); /* turned by -60 degrees */
        CHECK_NEAR_ABS(t, rod->rotation[1], -sqrt(0.75), TOL);
        CHECK(t, rod->ellipsoid != NULL);
        CHECK_NEAR_ABS(t, rod->ellipsoid == NULL ? 0.0 : rod->ellipsoid->radii[0],
                       0.8 / sqrt(6.0), TOL);
        CHECK_NEAR_ABS(t, v->joints[0].distance, 0.0, 0.0);
        CHECK(t, v->joints[0].has_axis && v->joints[0].axis[2] == 1.0);
        CHECK_NEAR_ABS(t, v->modes[0].hz, sqrt(1.5 * 9.81 / 0.8) / (2.0 * MECH_PI), 1e-8);
        CHECK_NEAR_ABS(t, v->modes[0].body_share[1], 1.0, TOL);
        /* what moves most is the tip, l from the pivot: twice as far as the centre */
        CHECK_NEAR_ABS(t, fabs(v->modes[0].motion[6]), 0.5, TOL);
        CHECK_NEAR_ABS(t, fabs(v->modes[0].motion[6 + 5]), 1.0 / 0.8, TOL);
    }
    if (CHECK(t, v->n_points == 2 && v->n_sensors == 1)) {
        for (int i = 0; i < 2; i++) {
            const bool tip = strcmp(v->points[i].name, "tip") == 0;
            CHECK(t, v->points[i].body == 1);
            CHECK_NEAR_ABS(t, v->points[i].at[0], 0.0, TOL);
            CHECK_NEAR_ABS(t, v->points[i].at[1], tip ? -0.8 : 0.0, TOL);
        }
        CHECK_NEAR_ABS(t, v->sensors[0].at[1], -0.8, TOL);
        CHECK(t, v->sensors[0].axis[0] == 1.0);
    }
    CHECK(t, scene->has_gravity && scene->gravity[1] == -9.81);
    CHECK_NEAR_ABS(t, scene->size, 0.8, TOL);
    mt_scene_delete(scene);
}

static void scene__ellipsoid_is_that_of_a_box(mt_test *t)
{
    /* 0.6 x 0.4 x 0.2 m, turned by 30 degrees about z: J_xx c^2 + J_yy s^2, ... */
    mt_scene *const scene = scene_of(
        t, mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 3,"
                         "\"parameters\": {\"m\": 5, \"a\": \"m*(0.4^2+0.2^2)/12\","
                         "\"b\": \"m*(0.6^2+0.2^2)/12\", \"c\": \"m*(0.6^2+0.4^2)/12\"},"
                         "\"bodies\": [{\"name\": \"box\", \"mass_kg\": \"m\","
                         "\"centre\": [1, 2, 3], \"inertia_kg_m2\": [\"0.75*a+0.25*b\","
                         "\"0.25*a+0.75*b\", \"c\", \"(a-b)*sqrt(0.75)*0.5\", 0, 0]}]}"));
    if (!CHECK(t, scene != NULL)) {
        return;
    }
    const mt_scene_view *const v = view_of(scene, 0);
    if (CHECK(t, v->n_bodies == 2 && v->bodies[1].ellipsoid != NULL)) {
        const mt_scene_ellipsoid *const e = v->bodies[1].ellipsoid;
        static const double side[3] = {0.6, 0.4, 0.2};
        const double axis[3][3] = {
            {sqrt(0.75), 0.5, 0.0}, {-0.5, sqrt(0.75), 0.0}, {0.0, 0.0, 1.0}};
        for (int i = 0; i < 3; i++) {
            double dot = 0.0;
            for (int k = 0; k < 3; k++) {
                dot += e->axes[i][k] * axis[i][k];
            }
            CHECK_NEAR_ABS(t, e->radii[i], sqrt(5.0 / 12.0) * side[i], TOL);
            CHECK_NEAR_ABS(t, fabs(dot), 1.0, TOL);
        }
    }
    CHECK(t, v->n_modes == 6 && strcmp(v->modes[0].note, "rigid-body") == 0);
    mt_scene_delete(scene);
}

/* ground - 3 N/m - a - 1 N/m - b, 1 kg each: (K - lambda) x = 0 with lambda^2 - 5 lambda + 3 =
 * 0, x = (1, 4 - lambda). */
static void scene__energies_are_those_of_the_springs(mt_test *t)
{
    mt_scene *const scene = scene_of(
        t, mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
                         "\"bodies\": [{\"name\": \"a\", \"mass_kg\": 1, \"inertia_kg_m2\": 1,"
                         "\"centre\": [1, 0]}, {\"name\": \"b\", \"mass_kg\": 1,"
                         "\"inertia_kg_m2\": 1, \"centre\": [2, 0]}],"
                         "\"joints\": [{\"name\": \"ra\", \"type\": \"prismatic\", \"bodies\":"
                         "[\"ground\", \"a\"], \"at\": [1, 0], \"axis\": [1, 0]},"
                         "{\"name\": \"rb\", \"type\": \"prismatic\", \"bodies\": [\"ground\","
                         "\"b\"], \"at\": [2, 0], \"axis\": [1, 0]}],"
                         "\"springs\": [{\"name\": \"s\", \"type\": \"axial\", \"bodies\":"
                         "[\"ground\", \"a\"], \"at\": [[0, 0], [1, 0]],"
                         "\"stiffness_n_per_m\": 3}, {\"name\": \"c\", \"type\": \"axial\","
                         "\"bodies\": [\"a\", \"b\"], \"stiffness_n_per_m\": 1}],"
                         "\"dampers\": [{\"name\": \"d\", \"type\": \"axial\", \"bodies\":"
                         "[\"ground\", \"b\"], \"at\": [[3, 0], [2, 0]],"
                         "\"damping_n_s_per_m\": 7}]}"));
    if (!CHECK(t, scene != NULL)) {
        return;
    }
    const mt_scene_view *const v = view_of(scene, 0);
    CHECK(t, v->n_springs == 2 && v->n_dampers == 1 && v->n_modes == 2);
    CHECK_NEAR_ABS(t, v->n_dampers > 0 ? v->dampers[0].stiffness : 0.0, 7.0, TOL);
    for (int i = 0; i < v->n_modes && v->n_springs == 2; i++) {
        const double lambda = 2.5 + (i == 0 ? -0.5 : 0.5) * sqrt(13.0);
        const double x = 4.0 - lambda;
        const double first = 3.0 / (3.0 + ((x - 1.0) * (x - 1.0)));
        const double largest = fmax(1.0, fabs(x));
        const mt_scene_mode *const m = &v->modes[i];
        CHECK_NEAR_ABS(t, m->spring_share[0], first, TOL);
        CHECK_NEAR_ABS(t, m->spring_share[1], 1.0 - first, TOL);
        CHECK_NEAR_ABS(t, m->body_share[1], 1.0 / (1.0 + (x * x)), TOL);
        CHECK_NEAR_ABS(t, fabs(m->motion[6]), 1.0 / largest, TOL);
        CHECK_NEAR_ABS(t, fabs(m->motion[12]), fabs(x) / largest, TOL);
    }
    mt_scene_delete(scene);
}

/* Shares of a link add up over its hinges, and a load takes from the springs. */
static void scene__shares_never_exceed_one(mt_test *t)
{
    static const char *const files[] = {"space_frame", "driven_rod", "ring", "space_stick"};
    for (int f = 0; f < MT_COUNT(files); f++) {
        mt_scene *const scene = scene_of(t, mech_load(t, files[f]));
        for (int i = 0; scene != NULL && i < scene->designs[0].n_views; i++) {
            const mt_scene_view *const v = view_of(scene, i);
            for (int k = 0; k < v->n_modes; k++) {
                double springs = 0.0;
                double bodies = 0.0;
                for (int j = 0; j < v->n_springs; j++) {
                    springs += v->modes[k].spring_share[j];
                }
                for (int j = 0; j < v->n_bodies; j++) {
                    bodies += v->modes[k].body_share[j];
                }
                mt_test_row(t, "%s", files[f]);
                CHECK(t, springs <= 1.0 + TOL && springs >= 0.0);
                mt_test_row(t, "%s", files[f]);
                CHECK(t, fabs(bodies - 1.0) <= TOL);
            }
        }
        mt_scene_delete(scene);
    }
}

/* A gearbox 5 m off the link, and a rod whose second joint is 5 m off. */
static void scene__a_joint_far_off_is_found(mt_test *t)
{
    mt_scene *const scene = scene_of(
        t,
        mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 3,"
                      "\"links\": [{\"name\": \"arm\", \"from\": [0, 0, 0], \"to\": [1, 0, 0],"
                      "\"elements\": 2, \"mass_kg\": 1, \"stiffness_n_m_per_rad\": 100,"
                      "\"hinge_axis\": [0, 0, 1],\"radius_of_gyration_m\": 0.01}],"
                      "\"bodies\": [{\"name\": \"box\", \"mass_kg\": 1, \"centre\":"
                      "[1, 5, 0], \"inertia_kg_m2\": [0.1, 0.1, 0.1]},"
                      "{\"name\": \"rod\", \"mass_kg\": 1, \"centre\": [1.5, 5, 0],"
                      "\"inertia_kg_m2\": [0.001, 0.084, 0.084]}],"
                      "\"joints\": [{\"name\": \"root\", \"type\": \"fixed\", \"bodies\":"
                      "[\"ground\", \"arm.start\"], \"at\": [0, 0, 0]},"
                      "{\"name\": \"mount\", \"type\": \"fixed\", \"bodies\": [\"arm.end\","
                      "\"box\"], \"at\": [1, 5, 0]},"
                      "{\"name\": \"hinge\", \"type\": \"revolute\", \"bodies\": [\"box\","
                      "\"rod\"], \"at\": [1, 5, 0], \"axis\": [0, 0, 1]},"
                      "{\"name\": \"ball\", \"type\": \"point-on-plane\", \"bodies\":"
                      "[\"ground\", \"rod\"], \"at\": [7.15, 5, 0], \"axis\": [0, 1, 0]}]}"));
    if (!CHECK(t, scene != NULL)) {
        return;
    }
    const mt_scene_view *const v = view_of(scene, 0);
    /* the rod's ellipsoid: a^2 = 5 (0.084 + 0.084 - 0.001)/2 */
    const double half = sqrt(2.5 * 0.167);
    CHECK(t, v->error == NULL);
    if (CHECK(t, v->n_joints == 4 && scene->n_joints == 4)) {
        CHECK_NEAR_ABS(t, v->joints[0].distance, 0.0, 0.0);
        CHECK_NEAR_ABS(t, v->joints[1].distance, 5.0, TOL);
        CHECK_NEAR_ABS(t, v->joints[2].distance, 0.0, 0.0);
        CHECK_NEAR_ABS(t, v->joints[3].distance, 5.65 - half, TOL);
        CHECK(t,
              v->joints[1].far > 0 && strcmp(v->bodies[v->joints[1].far].name, "arm.2") == 0);
        CHECK(t, v->joints[3].far > 0 && strcmp(v->bodies[v->joints[3].far].name, "rod") == 0);
        CHECK(t, strcmp(scene->joints[0].joint->name, "ball") == 0);
        CHECK(t, strcmp(scene->joints[1].joint->name, "mount") == 0);
        CHECK(t, strcmp(scene->joints[0].body, "rod") == 0 && scene->joints[2].body == NULL);
    }
    mt_scene_delete(scene);
}

/* Nothing moves what is drawn closed and unloaded: places are those of the file. */
static void scene__places_are_those_of_the_file(mt_test *t)
{
    mt_model *const model = mech_load(t, "../../problems/inceptor");
    mt_scene *scene = NULL;
    mt_err err = {.text = ""};
    mt_arena mem;
    if (model == NULL || !CHECK(t, mt_arena_init(&mem, 0, &err) == MT_OK)) {
        return;
    }
    const mt_scene_query ask = {.label = "original", .n_shown = 0};
    const int first = 1; /* "installed" */
    double *const value = mt_arena_f64(&mem, (size_t)model->n_nums, 1);
    CHECK(t, mt_model_numbers(model, first, 0, NULL, NULL, &mem, value, &err) == MT_OK);
    const mt_scene_extent extent = {
        .n_configurations = 1, .configurations = &first, .work = MT_SCENE_WORK};
    CHECK(t, mt_scene_new(model, 1, &ask, &extent, &scene, &err) == MT_OK);
    int seen = 0;
    for (int i = 0; scene != NULL && i < view_of(scene, 0)->n_points; i++) {
        const mt_scene_point *const p = &view_of(scene, 0)->points[i];
        for (int k = 0; k < model->n_points; k++) {
            if (strcmp(model->points[k].name.s, p->name) == 0) {
                seen++;
                for (int d = 0; d < 3; d++) {
                    CHECK_NEAR_ABS(t, p->at[d], value[model->points[k].x[d]], TOL);
                }
            }
        }
    }
    CHECK_INT(t, seen, 6);
    mt_scene_delete(scene);
    mt_arena_free(&mem);
    mt_model_delete(model);
}

/* A crank of 0.5 m is driven to 0.3 and, in another configuration, to -0.1 rad. */
static void scene__a_driven_joint_has_its_range(mt_test *t)
{
    mt_scene *const scene = scene_of(
        t, mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
                         "\"bodies\": [{\"name\": \"crank\", \"mass_kg\": 1,"
                         "\"inertia_kg_m2\": 0.1, \"centre\": [0.5, 0]},"
                         "{\"name\": \"bob\", \"mass_kg\": 1, \"inertia_kg_m2\": 0.1,"
                         "\"centre\": [1, 0]}],"
                         "\"joints\": [{\"name\": \"pivot\", \"type\": \"revolute\","
                         "\"bodies\": [\"ground\", \"crank\"], \"at\": [0, 0]},"
                         "{\"name\": \"end\", \"type\": \"revolute\", \"bodies\": [\"crank\","
                         "\"bob\"], \"at\": [1, 0]}],"
                         "\"springs\": [{\"name\": \"k\", \"type\": \"torsion\", \"joint\":"
                         "\"end\", \"stiffness_n_m_per_rad\": 10}],"
                         "\"configurations\": {\"free\": {}, \"up\": {\"drive\": {\"joint\":"
                         "\"pivot\", \"position_rad\": 0.3, \"hold\": \"lock\"}}, \"down\":"
                         "{\"drive\": {\"joint\": \"pivot\", \"position_rad\": -0.1,"
                         "\"hold\": \"lock\"}}}}"));
    if (!CHECK(t, scene != NULL)) {
        return;
    }
    for (int c = 0; c < 3 && c < scene->designs[0].n_views; c++) {
        static const double own[] = {0.0, 0.3, -0.1};
        const mt_scene_view *const v = view_of(scene, c);
        if (!CHECK(t, v->drive != NULL && v->drive->n_positions == MT_SCENE_POSITIONS)) {
            continue;
        }
        CHECK(t, c == 0 ? !isfinite(v->drive->at) : v->drive->at == own[c]);
        CHECK(t, v->drive->angle && strcmp(v->drive->joint, "pivot") == 0);
        for (int i = 0; i < v->drive->n_positions; i++) {
            const mt_scene_position *const p = &v->drive->positions[i];
            const double at = -0.1 + (0.4 * i / (MT_SCENE_POSITIONS - 1));
            CHECK_NEAR_ABS(t, p->at, at, TOL);
            if (!CHECK(t, p->why == NULL && p->pose != NULL && p->n_hz == 1)) {
                continue;
            }
            CHECK_NEAR_ABS(t, p->pose[12], 0.5 * cos(at), 1e-8);
            CHECK_NEAR_ABS(t, p->pose[13], 0.5 * sin(at), 1e-8);
            CHECK_NEAR_ABS(t, p->pose[12 + 3], cos(at - own[c]), 1e-8);
            CHECK_NEAR_ABS(t, p->pose[12 + 4], -sin(at - own[c]), 1e-8);
            CHECK_NEAR_ABS(t, p->pose[12 + 6], sin(at - own[c]), 1e-8);
            CHECK_NEAR_ABS(t, p->hz[0], sqrt(10.0 / 0.1) / (2.0 * MECH_PI), 1e-6);
        }
    }
    mt_scene_delete(scene);
}

/* One scene of the last configuration that drives a joint, of whose range so much is asked. */
static mt_scene *scene_of_range(mt_test *t, const mt_model *model, mt_scene_travel kind)
{
    enum { MOST = 40 };
    mt_scene_travel travel[MOST];
    mt_scene *scene = NULL;
    mt_err err = {.text = ""};
    int configuration = 0;
    if (!CHECK(t, model->n_joints <= MOST)) {
        return NULL;
    }
    for (int c = 0; c < model->n_configurations; c++) {
        configuration = model->configurations[c].n_drives > 0 ? c : configuration;
    }
    for (int j = 0; j < model->n_joints; j++) {
        travel[j] = kind;
    }
    const mt_scene_query ask = {.label = "original", .n_shown = 0};
    const mt_scene_extent extent = {.n_configurations = 1,
                                    .configurations = &configuration,
                                    .work = MT_SCENE_WORK,
                                    .travel = travel};
    CHECK(t, mt_scene_new(model, 1, &ask, &extent, &scene, &err) == MT_OK);
    return scene;
}

static void check_same_poses(mt_test *t, const mt_scene_drive *poses,
                             const mt_scene_drive *modes, int n)
{
    for (int i = 0; i < poses->n_positions; i++) {
        const mt_scene_position *const p = &poses->positions[i];
        const mt_scene_position *const q = &modes->positions[i];
        CHECK(t, p->n_hz == 0 && q->n_hz > 0);
        for (int k = 0; k < 12 * n && CHECK(t, p->pose != NULL && q->pose != NULL); k++) {
            CHECK_NEAR_ABS(t, p->pose[k], q->pose[k], 1e-9);
        }
    }
}

static void check_same_view(mt_test *t, const mt_scene_view *a, const mt_scene_view *b)
{
    CHECK_INT(t, a->n_modes, b->n_modes);
    for (int i = 0; i < a->n_modes && i < b->n_modes; i++) {
        CHECK_NEAR(t, a->modes[i].hz, b->modes[i].hz, 1e-10);
    }
    for (int i = 0; i < a->n_bodies && CHECK_INT(t, a->n_bodies, b->n_bodies); i++) {
        CHECK_NEAR(t, a->bodies[i].mass, b->bodies[i].mass, 1e-14);
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR_ABS(t, a->bodies[i].at[k], b->bodies[i].at[k], TOL);
        }
    }
    if (!CHECK(t, (a->drive == NULL) == (b->drive == NULL)) || a->drive == NULL) {
        return;
    }
    CHECK_INT(t, a->drive->n_positions, b->drive->n_positions);
    for (int i = 0; i < a->drive->n_positions; i++) {
        const mt_scene_position *const p = &a->drive->positions[i];
        const mt_scene_position *const q = &b->drive->positions[i];
        CHECK_INT(t, p->n_hz, q->n_hz);
        for (int k = 0; k < p->n_hz && k < q->n_hz; k++) {
            CHECK_NEAR(t, p->hz[k], q->hz[k], 1e-9);
        }
        for (int k = 0; k < 12 * a->n_bodies && p->pose != NULL && q->pose != NULL; k++) {
            CHECK_NEAR_ABS(t, p->pose[k], q->pose[k], 1e-9);
        }
    }
}

/* Designs that share what was compiled and analysed, on three workers, are each what it is
 * alone. */
static void scene__designs_together_are_those_alone(mt_test *t)
{
    static const char *const names[] = {"M_SAU", "K_T1"};
    enum { MOST = 3 };
    static const double values[][2] = {{2.2635, 9795.7}, {1.2, 9795.7}, {2.9, 20000.0}};
    enum { DESIGNS = MT_COUNT(values) };
    mt_model *const model = mech_load(t, "../../problems/inceptor");
    int configurations[MOST];
    int inputs[2];
    int n = 0;
    mt_scene *all = NULL;
    mt_err err = {.text = ""};
    if (model == NULL) {
        return;
    }
    for (int i = 0; i < model->n_configurations && n < MOST; i++) { /* the first, and driven */
        if (i == 0 || model->configurations[i].n_drives > 0) {
            configurations[n++] = i;
        }
    }
    CHECK_INT(t, n, MOST);
    for (int i = 0; i < MT_COUNT(names); i++) {
        inputs[i] = mt_model_find_parameter(model, names[i]);
    }
    mt_scene_extent extent = {.n_configurations = n,
                              .configurations = configurations,
                              .work = MT_SCENE_WORK,
                              .threads = 3};
    mt_scene_query asks[DESIGNS];
    for (int d = 0; d < DESIGNS; d++) {
        asks[d] = (mt_scene_query){
            .label = "design", .rank = d, .n_inputs = 2, .inputs = inputs, .at = values[d]};
    }
    CHECK(t, mt_scene_new(model, DESIGNS, asks, &extent, &all, &err) == MT_OK);
    extent.threads = 1;
    for (int d = 0; d < DESIGNS && all != NULL; d++) {
        mt_scene *alone = NULL;
        CHECK(t, mt_scene_new(model, 1, &asks[d], &extent, &alone, &err) == MT_OK);
        for (int i = 0; i < n && alone != NULL; i++) {
            mt_test_row(t, "design %d, configuration %d", d, i);
            check_same_view(t, &all->designs[d].views[i], view_of(alone, i));
        }
        mt_scene_delete(alone);
    }
    mt_scene_delete(all);
    mt_model_delete(model);
}

/* Of the same ranges the poses alone, and nothing. */
static void scene__poses_are_those_of_the_modes(mt_test *t)
{
    static const char *const files[] = {"driven_rod", "../../problems/inceptor"};
    for (int f = 0; f < MT_COUNT(files); f++) {
        mt_model *const model = mech_load(t, files[f]);
        mt_scene *scene[MT_TRAVEL_MODES + 1] = {NULL};
        for (int kind = MT_TRAVEL_NONE; model != NULL && kind <= MT_TRAVEL_MODES; kind++) {
            scene[kind] = scene_of_range(t, model, (mt_scene_travel)kind);
        }
        mt_test_row(t, "%s", files[f]);
        if (CHECK(t, scene[MT_TRAVEL_NONE] != NULL && scene[MT_TRAVEL_POSES] != NULL &&
                         scene[MT_TRAVEL_MODES] != NULL)) {
            const mt_scene_drive *const poses = view_of(scene[MT_TRAVEL_POSES], 0)->drive;
            const mt_scene_drive *const modes = view_of(scene[MT_TRAVEL_MODES], 0)->drive;
            const int n = view_of(scene[MT_TRAVEL_POSES], 0)->n_bodies;
            CHECK(t, view_of(scene[MT_TRAVEL_NONE], 0)->drive == NULL);
            if (CHECK(t, poses != NULL && modes != NULL &&
                             poses->n_positions == modes->n_positions && n > 1)) {
                check_same_poses(t, poses, modes, n);
            }
        }
        for (int kind = MT_TRAVEL_NONE; kind <= MT_TRAVEL_MODES; kind++) {
            mt_scene_delete(scene[kind]);
        }
        mt_model_delete(model);
    }
}

static void scene__what_cannot_be_analysed_is_drawn_and_says_why(mt_test *t)
{
    mt_scene *const scene =
        scene_of(t, mech_parse(t, "{\"format\": \"modetune-model/1\", \"dimension\": 2,"
                                  "\"bodies\": [{\"name\": \"ghost\", \"mass_kg\": 0,"
                                  "\"inertia_kg_m2\": 0, \"centre\": [1, 2]}]}"));
    if (CHECK(t, scene != NULL)) {
        const mt_scene_view *const v = view_of(scene, 0);
        CHECK(t, v->error != NULL && strstr(v->error, "ghost") != NULL);
        CHECK(t, v->n_modes == 0 && v->drive == NULL);
        CHECK(t, v->n_bodies == 2 && v->bodies[1].at[1] == 2.0);
        CHECK(t, v->bodies[1].ellipsoid == NULL);
    }
    mt_scene_delete(scene);
}

static void distance__to_solids_is_that_of_closed_forms(mt_test *t)
{
    static const struct {
        const char *name;
        double radii[3];
        double x[3];
        double want;
    } rows[] = {
        {"sphere", {2.0, 2.0, 2.0}, {3.0, 4.0, 0.0}, 3.0},
        {"inside", {2.0, 1.0, 1.0}, {1.0, 0.2, 0.1}, 0.0},
        {"along an axis", {3.0, 2.0, 1.0}, {0.0, 0.0, 5.0}, 4.0},
        {"over a disc", {2.0, 2.0, 0.0}, {1.0, 1.0, 0.5}, 0.5},
        {"beside a disc", {2.0, 2.0, 0.0}, {5.0, 0.0, 4.0}, 5.0},
        {"beyond a rod", {1.0, 0.0, 0.0}, {4.0, 4.0, 0.0}, 5.0},
        {"point", {0.0, 0.0, 0.0}, {3.0, 0.0, 4.0}, 5.0},
        {"its centre", {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.0},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        const double got = mt_distance_ellipsoid(rows[i].radii, rows[i].x);
        mt_test_row(t, "%s", rows[i].name);
        CHECK(t, fabs(got - rows[i].want) <= TOL);
    }
    static const double a[3] = {0.0, 0.0, 0.0};
    static const double b[3] = {2.0, 0.0, 0.0};
    static const double beyond[3] = {5.0, 4.0, 0.0};
    static const double beside[3] = {1.0, 0.0, 2.0};
    double nearest[3];
    CHECK_NEAR_ABS(t, mt_distance_segment(a, b, beyond, nearest), 5.0, TOL);
    CHECK_NEAR_ABS(t, nearest[0], 2.0, TOL);
    CHECK_NEAR_ABS(t, mt_distance_segment(a, b, beside, NULL), 2.0, TOL);
    CHECK_NEAR_ABS(t, mt_distance_segment(a, a, beside, NULL), sqrt(5.0), TOL);
}

MT_TEST_MAIN(MT_TEST(scene__pendulum_rests_below_its_pivot),
             MT_TEST(scene__ellipsoid_is_that_of_a_box),
             MT_TEST(scene__energies_are_those_of_the_springs),
             MT_TEST(scene__shares_never_exceed_one), MT_TEST(scene__a_joint_far_off_is_found),
             MT_TEST(scene__places_are_those_of_the_file),
             MT_TEST(scene__a_driven_joint_has_its_range),
             MT_TEST(scene__poses_are_those_of_the_modes),
             MT_TEST(scene__designs_together_are_those_alone),
             MT_TEST(scene__what_cannot_be_analysed_is_drawn_and_says_why),
             MT_TEST(distance__to_solids_is_that_of_closed_forms))
