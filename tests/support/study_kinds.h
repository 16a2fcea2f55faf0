/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small studies that together pass through every phase of an answer and every kind of search,
 * for tests that disturb them. */
#ifndef TESTS_STUDY_KINDS_H
#define TESTS_STUDY_KINDS_H

#include "study_fixture.h"

#define ROW(rest) \
    STUDY_TWO_MASSES("'k1': {'value': 3, 'unit': 'N/m'}, 'k2': 1, 'm': 1, 'n': '2*m'", rest)
#define TWO                                                                             \
    "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 5}, {'parameter': 'k2', " \
    "'lower': 0.2, 'upper': 5}],"
#define QUICK "'search': {'starts': 2, 'max_evaluations': 300},"

/* A mass held at the origin by three springs in a plane: the lightest K with its lowest
 * eigenvalue at least 1 has a repeated mode. */
#define HELD(name, x, y)                                                                     \
    "{'name': 's" name "', 'type': 'axial', 'bodies': ['ground', 'm'], 'at': [['" x "', '" y \
    "', 0], [0, 0, 0]], 'stiffness_n_per_m': 'k" name "'},"
#define STAR                                                                                 \
    "{'format': 'modetune-model/1', 'dimension': 3, 'parameters': {'ka': 1, 'kb': 3, 'kc': " \
    "5}, 'bodies': [{'name': 'm', 'mass_kg': 1, 'centre': [0, 0, 0]}], 'springs': [" HELD(   \
        "a", "1", "0") HELD("b", "0.5", "sqrt(0.75)")                                        \
        HELD("c", "-0.5", "sqrt(0.75)") "{'name': 'across', 'type': 'axial', 'bodies': "     \
                                        "['ground', 'm'], 'at': [[0, 0, 1], [0, 0, "         \
                                        "0]], 'stiffness_n_per_m': 100}]}"

/* An arm turns about the origin; a mass slides along it on k1, and k2 holds it in the global x:
 *     f(theta) = sqrt((k1 + k2 cos(theta)^2) / m) / (2 pi)
 * is greatest between positions on both sides of 0. */
#define ARM                                                                                  \
    "{'format': 'modetune-model/1', 'dimension': 2, 'parameters': {'k1': 40000, 'k2': "      \
    "5000}, 'bodies': [{'name': 'arm', 'mass_kg': 1, 'inertia_kg_m2': 0.1, 'centre': [0.5, " \
    "0]}, {'name': 'slider', 'mass_kg': 2, 'inertia_kg_m2': 0.01, 'centre': [1, 0]}], "      \
    "'joints': [{'name': 'pivot', 'type': 'revolute', 'bodies': ['ground', 'arm'], 'at': "   \
    "[0, 0]}, {'name': 'slide', 'type': 'prismatic', 'bodies': ['arm', 'slider'], 'at': "    \
    "[1, 0], 'axis': [1, 0]}], 'springs': [{'name': 'along', 'type': 'bushing', 'bodies': "  \
    "['arm', 'slider'], 'at': [1, 0], 'stiffness_n_per_m': ['k1', 0], "                      \
    "'stiffness_n_m_per_rad': 0}, {'name': 'across', 'type': 'bushing', 'bodies': "          \
    "['ground', 'slider'], 'at': [1, 0], 'stiffness_n_per_m': ['k2', 0], "                   \
    "'stiffness_n_m_per_rad': 0}], 'configurations': {'left': {'drive': {'joint': 'pivot', " \
    "'position_rad': -0.5, 'hold': 'lock'}}, 'right': {'drive': {'joint': 'pivot', "         \
    "'position_rad': 0.5, 'hold': 'lock'}}}}"

static const struct {
    const char *name;
    const char *model;
    const char *members;
} study_kinds[] = {
    {"targets, published of every kind",
     ROW(", 'modes': {'first': {'configuration': 'default', 'index': 1}}"),
     TWO QUICK
     "'references': {'test': {'modes': [{'frequency_hz': 0.13, 'shape': {'p1.x': 0.3, 'p2.x': "
     "1}}]},"
     " 'own': {'model': 'model.json', 'configuration': 'default'}},"
     "'goals': [{'type': 'frequency', 'mode': 'first', 'target_hz': 0.12},"
     "{'type': 'frequency', 'mode': 2, 'target_hz': 0.33},"
     "{'type': 'mac', 'mode': 1, 'reference': 'test', 'at_least': 0.5},"
     "{'type': 'limit', 'expression': 'k1 + k2', 'at_most': 50}],"
     "'published': [{'parameter': 'k1', 'value': 2, 'tolerance_percent': 1, 'source': 's'},"
     "{'quantity': 'k1/k2', 'value': 2, 'tolerance_percent': 1, 'label': 'ratio'},"
     "{'frequency': {'mode': 1}, 'value': 0.1, 'tolerance': 1},"
     "{'mac': {'mode': 1, 'reference': 'test'}, 'at_least': 0.9},"
     "{'mac': {'mode': 2, 'reference': 'own'}, 'at_least': 0.9}, {'status': 'solved'}]"},
    {"misfit with shapes, spread", ROW(""),
     TWO QUICK "'references': {'test': {'modes': [{'frequency_hz': 0.13, 'shape': {'p1.x': "
               "0.3, 'p2.x': 1}}]}},"
               "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.12, 'weight': 1},"
               "{'type': 'shape', 'mode': 1, 'reference': 'test', 'weight': 0.5},"
               "{'type': 'frequency', 'mode': 2, 'target_hz': 0.4, 'weight': 1}],"
               "'objective': {'minimise': 'misfit'}, 'spread': {'factor': 3}"},
    {"damping ratios",
     ROW(", 'modes': {'first': {'configuration': 'default', 'index': 1}}, 'dampers': [{'name': "
         "'d', 'type': 'axial', 'joint': 'r1', 'damping_n_s_per_m': 0.3}], 'damping': "
         "{'ratio': "
         "0.01, 'modes': {'first': 0.02}, 'stiffness_s': 0.01}"),
     TWO QUICK "'goals': [{'type': 'damping', 'mode': 'first', 'at_least': 0.06},"
               "{'type': 'damping', 'mode': 2, 'at_most': 0.1}]"},
    {"bands, objectives in order", ROW(""),
     TWO QUICK "'goals': [{'type': 'avoid', 'bands_hz': [[0.1, 0.14], [0.3, 0.36]], "
               "'margin_percent': 1}],"
               "'objective': [{'minimise': 'change'}, {'minimise': 'k1 + k2'}]"},
    {"clearance", ROW(""),
     TWO QUICK "'goals': [{'type': 'avoid', 'bands_hz': [[0.1, 0.14]]}], 'objective': "
               "{'maximise': 'clearance'}"},
    {"no design keeps clear", ROW(""),
     "'variables': [{'parameter': 'k1', 'lower': 2.9, 'upper': 3.1}]," QUICK
     "'goals': [{'type': 'avoid', 'bands_hz': [[0.1, 0.2]]}, {'type': 'frequency', 'mode': 2, "
     "'at_least_hz': 1}]"},
    {"limits that no design meets", ROW(""),
     TWO QUICK "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.2}, {'type': "
               "'frequency', 'mode': 2, 'at_most_hz': 0.3}]"},
    {"what would let a design meet the limits", ROW(""),
     TWO "'search': {'starts': 2, 'max_evaluations': 3000},"
         "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.2}, {'type': "
         "'frequency', 'mode': 2, 'at_most_hz': 0.3}]"},
    {"tolerances", ROW(""),
     "'variables': [{'parameter': 'k1', 'lower': 0.5, 'upper': 5, 'tolerance_percent': 2}, "
     "{'parameter': 'k2', 'lower': 0.2, 'upper': 5}]," QUICK
     "'goals': [{'type': 'avoid', 'bands_hz': [[0.1, 0.14]]}, {'type': 'frequency', 'mode': 2, "
     "'at_least_hz': 0.2},"
     "{'type': 'limit', 'expression': 'k1*k2', 'at_most': 30}]"},
    {"ratios and distances of frequencies", ROW(""),
     TWO QUICK "'goals': [{'type': 'ratio', 'mode': 2, 'of': {'mode': 1}, 'at_most': 2.6},"
               "{'type': 'apart', 'up_to_mode': 2, 'at_least_hz': 0.25}]"},
    {"a ratio that no design has", ROW(""),
     TWO QUICK "'goals': [{'type': 'ratio', 'mode': 2, 'of': {'mode': 1}, 'target': 1.5}]"},
    {"trade over a distance", ROW(""),
     TWO QUICK "'goals': [{'type': 'apart', 'modes': [1, 2], 'at_least_percent': 150}],"
               "'trade': {'vary': [{'goal': 0, 'member': 'at_least_percent', 'values': [150, "
               "250]}]}"},
    {"catalogues", ROW(""),
     "'variables': [{'parameter': 'k1', 'catalogue': [1, 2, 3, 4]}, {'parameter': 'k2', "
     "'catalogue': {'series': 'E3', 'lower': 0.5, 'upper': 5}}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1}]"},
    {"catalogue beside a continuous variable", ROW(""),
     "'variables': [{'parameter': 'k1', 'catalogue': [1, 2, 3, 4]}, {'parameter': 'k2', "
     "'lower': 0.2, 'upper': 5}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.11}, {'type': 'avoid', "
     "'bands_hz': [[0.2, 0.24]]}]"},
    {"no combination meets the goal", ROW(""),
     "'variables': [{'parameter': 'k1', 'catalogue': [1, 2, 3]}, {'parameter': 'k2', 'lower': "
     "0.2, 'upper': 5}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 1}]"},
    {"trade over a bound and a target", ROW(""),
     TWO QUICK "'goals': [{'type': 'frequency', 'mode': 1, 'target_hz': 0.12}],"
               "'trade': {'vary': [{'variable': 'k1', 'bound': 'upper', 'values': [4, 5]},"
               "{'goal': 0, 'member': 'target_hz', 'values': [0.11, 0.12]}]}"},
    {"trade over a margin and a parameter", ROW(""),
     TWO QUICK
     "'goals': [{'type': 'avoid', 'bands_hz': [[0.1, 0.14]], 'margin_percent': 1}],"
     "'trade': {'vary': [{'goal': 0, 'member': 'margin_percent', 'values': [1, 2]},"
     "{'parameter': 'm', 'values': [1, 1.1]}], 'objectives': ['change', 'clearance']}"},
    {"a repeated mode", STAR,
     "'variables': [{'parameter': 'ka', 'lower': 0.01, 'upper': 20}, {'parameter': 'kb', "
     "'lower': 0.01, 'upper': 20}, {'parameter': 'kc', 'lower': 0.01, 'upper': 20}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': '1/(2*pi)'}],"
     "'objective': {'minimise': 'ka + 1.3*kb + 0.8*kc'}"},
    {"more combinations than can be tried", ROW(""),
     "'variables': [{'parameter': 'k1', 'catalogue': {'series': 'E96', 'lower': 0.5, 'upper': "
     "5}}, {'parameter': 'm', 'catalogue': {'series': 'E96', 'lower': 0.5, 'upper': 5}}, "
     "{'parameter': 'k2', 'catalogue': {'series': 'E96', 'lower': 0.5, 'upper': 5}}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.12}, {'type': 'frequency', "
     "'mode': 2, 'at_most_hz': 0.3}]"},
    {"more combinations beside a continuous variable than are enumerated", ROW(""),
     "'variables': [{'parameter': 'k1', 'catalogue': {'series': 'E24', 'lower': 1, 'upper': "
     "9.5}}, {'parameter': 'm', 'catalogue': {'series': 'E24', 'lower': 0.5, 'upper': 5}}, "
     "{'parameter': 'k2', 'lower': 0.2, 'upper': 5}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.15}]"},
    {"tolerances of what bends stiffness both ways",
     STUDY_TWO_MASSES("'a': 1, 'k1': '2 + a*(3 - a)', 'k2': 1, 'm': 1, 'n': '2*m'", ""),
     "'variables': [{'parameter': 'a', 'lower': 0.5, 'upper': 2.5, 'tolerance_percent': 3}, "
     "{'parameter': 'k2', 'lower': 0.2, 'upper': 5, 'tolerance_percent': 2}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'at_least_hz': 0.1},"
     "{'type': 'limit', 'expression': 'a*(3 - a)*k2', 'at_most': 3}]"},
    {"driven positions in gravity", "driven_rod",
     "'variables': [{'parameter': 'k', 'lower': 20, 'upper': 80}]," QUICK
     "'goals': [{'type': 'avoid', 'configurations': ['sprung', 'trimmed'], 'bands_hz': [[1.5, "
     "1.6]]}]"},
    {"bands over a motion", ARM,
     "'variables': [{'parameter': 'k1', 'lower': 1000, 'upper': 60000}]," QUICK
     "'goals': [{'type': 'avoid', 'configurations': ['left', 'right'], 'bands_hz': [[10, 11], "
     "[23.7, 25]]}]"},
    {"a limit over a motion", ARM,
     "'variables': [{'parameter': 'k1', 'lower': 1000, 'upper': 60000}]," QUICK
     "'goals': [{'type': 'frequency', 'mode': 1, 'configurations': ['left', 'right'], "
     "'at_most_hz': 22}]"},
    {"bands over a motion, with tolerances", ARM,
     "'variables': [{'parameter': 'k1', 'lower': 1000, 'upper': 60000, 'tolerance_percent': "
     "1}]," QUICK "'goals': [{'type': 'avoid', 'configurations': ['left', 'right'], "
     "'bands_hz': [[23.7, 25]]}]"},
};

#endif
