/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words for what models and studies name otherwise. One word may stand for several names, of
 * which a list of keys or choices has one. */
#include "io/synonyms.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/base.h"

typedef struct synonym {
    const char *name;
    const char *words; /* between blanks; "_" for a blank within one */
} synonym;

static const synonym table[] = {
    /* joints */
    {"fixed", " weld welded rigid clamp clamped bolted glued encastre builtin built_in "},
    {"revolute", " hinge pin pinned pivot rotational rotation rotary bearing axle "},
    {"prismatic", " slider slide sliding translational translation linear linear_guide "},
    {"pin-in-slot", " slot pin_slot slotted "},
    {"distance", " rod massless_rod rigid_rod rope "},
    {"spherical", " ball ball_joint ball_socket ball_and_socket socket rod_end "},
    {"universal", " cardan hooke u_joint gimbal "},
    {"point-on-line", " inline in_line line "},
    {"point-on-plane", " inplane in_plane "},
    {"gear", " gears gear_pair transmission "},
    {"rack", " rack_and_pinion rack_pinion pinion "},
    /* springs and links */
    {"torsion", " torsional rotational rotation rotary angular hinge "},
    {"axial", " linear translational translation tension compression coil helical straight "},
    {"bar", " rod truss strut "},
    {"bushing", " bush mount rubber elastomer 6dof six_dof matrix "},
    {"circle", " round rod cylinder solid disc disk "},
    {"tube", " pipe hollow ring annulus "},
    {"rectangle", " rect box square flat rectangular "},
    {"beam", " euler_bernoulli bernoulli flexible fe "},
    /* members of models */
    {"centre", " center cg com cog centre_of_mass center_of_mass centre_of_gravity "
               "center_of_gravity mass_centre mass_center "},
    {"mass_kg", " m weight weight_kg "},
    {"inertia_kg_m2", " i j moment_of_inertia inertia_tensor "},
    {"at", " position location point points place between ends "},
    {"bodies",
     " connects joins connect links between joint body body_1 body_2 body1 body2 body_a body_b "
     "parts "},
    {"axis", " direction normal "},
    {"stiffness_n_per_m", " k stiffness rate spring_rate spring_constant constant "},
    {"stiffness_n_m_per_rad", " k stiffness rate spring_rate spring_constant constant kt k_t "},
    {"damping_n_s_per_m", " c damping viscosity "},
    {"damping_n_m_s_per_rad", " c damping viscosity "},
    {"loss_factor",
     " eta loss structural_damping hysteretic_damping tan_delta damping_factor "},
    {"ratio", " zeta damping_ratio modal_damping critical_damping "},
    {"ratios", " zetas damping_ratios modal_damping_ratios "},
    {"mass_per_s", " alpha rayleigh_alpha mass_coefficient "},
    {"stiffness_s", " beta rayleigh_beta stiffness_coefficient "},
    {"youngs_modulus_pa", " e youngs_modulus young_modulus elastic_modulus modulus e_modulus "},
    {"gravity_m_per_s2", " g gravity "},
    {"configurations", " states poses cases configuration "},
    {"parameters", " variables constants params values "},
    {"elements", " n segments divisions number_of_elements "},
    /* units */
    {"m", " metre meter metres meters "},
    {"mm", " millimetre millimeter millimetres millimeters "},
    {"cm", " centimetre centimeter centimetres centimeters "},
    {"in", " inch inches "},
    {"ft", " foot feet "},
    {"rad", " radian radians "},
    {"deg", " degree degrees "},
    {"Hz", " hertz "},
    {"rpm", " turns_per_minute revolutions_per_minute "},
    {"length", " lengths coordinates distance "},
    {"angle", " angles rotation "},
    {"speed", " speeds rotor rotor_speed "},
    /* studies */
    {"mass", " weight weight_kg mass_kg total_mass total_weight "},
    {"change", " redesign changes deviation modification "},
    {"misfit", " residual residuals error fit "},
    {"clearance", " margin clearances "},
    {"parameter", " name variable "},
    {"lower", " min minimum from low lower_bound at_least "},
    {"upper", " max maximum to high upper_bound at_most "},
    {"catalogue", " catalog choices options values discrete "},
    {"target_hz", " target frequency frequency_hz equals value goal "},
    {"at_least_hz", " min minimum above lower min_hz "},
    {"at_most_hz", " max maximum below upper max_hz "},
    {"target", " equals value goal "},
    {"at_least", " min minimum above lower greater_than "},
    {"at_most", " max maximum below upper less_than "},
    {"bands_hz", " bands band ranges forbidden intervals "},
    {"minimise", " minimize min objective "},
    {"objective", " objectives minimise minimize cost "},
    {"goals", " goal targets requirements constraints "},
    {"variables", " parameters design_variables params "},
    {"frequency", " target eigenfrequency natural_frequency mode "},
    {"avoid", " band bands avoidance forbidden keep_clear "},
    {"limit", " constraint inequality expression "},
    {"change", " redesign distance modification "},
    {"mass", " weight "},
    {"clearance", " margin gap separation "},
    {"misfit", " error residual fit least_squares "}};

enum { WORD_MOST = 40 };

/* As in the table: small letters, "_" for blanks and dashes. False: too long for it. */
static bool plain(const char *word, char *out)
{
    const size_t n = strlen(word);
    if (n == 0 || n >= WORD_MOST) {
        return false;
    }
    for (size_t i = 0; i <= n; i++) {
        const bool between = word[i] == ' ' || word[i] == '-';
        out[i] = (char)(between ? '_' : tolower((unsigned char)word[i]));
    }
    return true;
}

/* True where the word is among the words, as a whole. */
static bool has_word(const char *words, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = strstr(words, word); at != NULL; at = strstr(at + 1, word)) {
        if (at[-1] == ' ' && at[n] == ' ') {
            return true;
        }
    }
    return false;
}

/* "pin_joint" says no more than "pin": true where there was something to leave out. */
static bool shorten(char *word)
{
    static const char *const of[] = {"_joint", "_spring", "_section"};
    const size_t n = strlen(word);
    for (int i = 0; i < MT_COUNT(of); i++) {
        const size_t more = strlen(of[i]);
        if (n > more && strcmp(word + n - more, of[i]) == 0) {
            word[n - more] = '\0';
            return true;
        }
    }
    return false;
}

static const char *find_meant_name(const char *said, const char *const *names, int n)
{
    for (int i = 0; i < n; i++) {
        char name[WORD_MOST];
        if (plain(names[i], name) && strcmp(said, name) == 0) {
            return names[i];
        }
        for (int k = 0; k < MT_COUNT(table); k++) {
            if (strcmp(table[k].name, names[i]) == 0 && has_word(table[k].words, said)) {
                return names[i];
            }
        }
    }
    return NULL;
}

const char *mt_synonym(const char *word, const char *const *names, int n)
{
    char said[WORD_MOST];
    if (!plain(word, said)) {
        return NULL;
    }
    const char *const found = find_meant_name(said, names, n);
    return found == NULL && shorten(said) ? find_meant_name(said, names, n) : found;
}
