/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EXPR_UNIT_LIST_H
#define EXPR_UNIT_LIST_H

/*
 * Units of parameters that are not constants of expressions, because parameters may be called t
 * or g: name, SI unit, dimension, numerator, denominator. They follow from lb = 0.45359237 kg,
 * in = 0.0254 m, ft = 12 in, g = 9.80665 m/s^2, lbf = lb g, kip = 1000 lbf, slug = lbf s^2/ft,
 * all exact (NIST SP 811), as fractions in lowest terms of exact doubles; DEG, a degree in rad,
 * is not exact.
 */
#define MT_UNIT_LIST(X)                                                      \
    X("mg", "kg", MT_OTHER, 1.0, 1e6)                                        \
    X("g", "kg", MT_OTHER, 1.0, 1000.0)                                      \
    X("t", "kg", MT_OTHER, 1000.0, 1.0)                                      \
    X("oz", "kg", MT_OTHER, 45359237.0, 16e8)                                \
    X("lb", "kg", MT_OTHER, 45359237.0, 1e8)                                 \
    X("slug", "kg", MT_OTHER, 8896443230521.0, 6096e8)                       \
    X("lbf s^2/in", "kg", MT_OTHER, 8896443230521.0, 508e8)                  \
    X("g/mm", "kg/m", MT_OTHER, 1.0, 1.0)                                    \
    X("g/m", "kg/m", MT_OTHER, 1.0, 1000.0)                                  \
    X("kg/mm", "kg/m", MT_OTHER, 1000.0, 1.0)                                \
    X("lb/in", "kg/m", MT_OTHER, 45359237.0, 254e4)                          \
    X("lb/ft", "kg/m", MT_OTHER, 45359237.0, 3048e4)                         \
    X("g/m^2", "kg/m^2", MT_OTHER, 1.0, 1000.0)                              \
    X("g/cm^2", "kg/m^2", MT_OTHER, 10.0, 1.0)                               \
    X("kg/mm^2", "kg/m^2", MT_OTHER, 1e6, 1.0)                               \
    X("lb/ft^2", "kg/m^2", MT_OTHER, 45359237.0, 9290304.0)                  \
    X("g/cm^3", "kg/m^3", MT_OTHER, 1000.0, 1.0)                             \
    X("kg/dm^3", "kg/m^3", MT_OTHER, 1000.0, 1.0)                            \
    X("t/m^3", "kg/m^3", MT_OTHER, 1000.0, 1.0)                              \
    X("g/mm^3", "kg/m^3", MT_OTHER, 1e6, 1.0)                                \
    X("kg/cm^3", "kg/m^3", MT_OTHER, 1e6, 1.0)                               \
    X("kg/mm^3", "kg/m^3", MT_OTHER, 1e9, 1.0)                               \
    X("t/mm^3", "kg/m^3", MT_OTHER, 1e12, 1.0)                               \
    X("lb/in^3", "kg/m^3", MT_OTHER, 56699046250.0, 2048383.0)               \
    X("lb/ft^3", "kg/m^3", MT_OTHER, 28349523125.0, 1769802912.0)            \
    X("slug/ft^3", "kg/m^3", MT_OTHER, 5560277019075625.0, 10788718551552.0) \
    X("g mm", "kg m", MT_OTHER, 1.0, 1e6)                                    \
    X("g cm", "kg m", MT_OTHER, 1.0, 1e5)                                    \
    X("g m", "kg m", MT_OTHER, 1.0, 1000.0)                                  \
    X("kg mm", "kg m", MT_OTHER, 1.0, 1000.0)                                \
    X("kg cm", "kg m", MT_OTHER, 1.0, 100.0)                                 \
    X("lb in", "kg m", MT_OTHER, 5760623099.0, 5e11)                         \
    X("lb ft", "kg m", MT_OTHER, 17281869297.0, 125e9)                       \
    X("g mm^2", "kg m^2", MT_OTHER, 1.0, 1e9)                                \
    X("g cm^2", "kg m^2", MT_OTHER, 1.0, 1e7)                                \
    X("kg mm^2", "kg m^2", MT_OTHER, 1.0, 1e6)                               \
    X("kg cm^2", "kg m^2", MT_OTHER, 1.0, 1e4)                               \
    X("t mm^2", "kg m^2", MT_OTHER, 1.0, 1000.0)                             \
    X("t m^2", "kg m^2", MT_OTHER, 1000.0, 1.0)                              \
    X("lb in^2", "kg m^2", MT_OTHER, 731599133573.0, 25e14)                  \
    X("lb ft^2", "kg m^2", MT_OTHER, 6584392202157.0, 15625e10)              \
    X("slug ft^2", "kg m^2", MT_OTHER, 3389544870828501.0, 25e14)            \
    X("lbf in s^2", "kg m^2", MT_OTHER, 1129848290276167.0, 1e16)            \
    X("um", "m", MT_LENGTH, 1.0, 1e6)                                        \
    X("km", "m", MT_LENGTH, 1000.0, 1.0)                                     \
    X("mm^2", "m^2", MT_OTHER, 1.0, 1e6)                                     \
    X("cm^2", "m^2", MT_OTHER, 1.0, 1e4)                                     \
    X("in^2", "m^2", MT_OTHER, 16129.0, 25e6)                                \
    X("ft^2", "m^2", MT_OTHER, 145161.0, 1562500.0)                          \
    X("mm^3", "m^3", MT_OTHER, 1.0, 1e9)                                     \
    X("cm^3", "m^3", MT_OTHER, 1.0, 1e6)                                     \
    X("in^3", "m^3", MT_OTHER, 2048383.0, 125e9)                             \
    X("ft^3", "m^3", MT_OTHER, 55306341.0, 1953125000.0)                     \
    X("mm^4", "m^4", MT_OTHER, 1.0, 1e12)                                    \
    X("cm^4", "m^4", MT_OTHER, 1.0, 1e8)                                     \
    X("in^4", "m^4", MT_OTHER, 260144641.0, 625e12)                          \
    X("ft^4", "m^4", MT_OTHER, 21071715921.0, 244140625e4)                   \
    X("ms", "s", MT_OTHER, 1.0, 1000.0)                                      \
    X("min", "s", MT_OTHER, 60.0, 1.0)                                       \
    X("kHz", "Hz", MT_SPEED, 1000.0, 1.0)                                    \
    X("mrad", "rad", MT_ANGLE, 1.0, 1000.0)                                  \
    X("mm/s", "m/s", MT_OTHER, 1.0, 1000.0)                                  \
    X("in/s", "m/s", MT_OTHER, 127.0, 5000.0)                                \
    X("ft/s", "m/s", MT_OTHER, 381.0, 1250.0)                                \
    X("km/h", "m/s", MT_OTHER, 5.0, 18.0)                                    \
    X("mm/s^2", "m/s^2", MT_OTHER, 1.0, 1000.0)                              \
    X("in/s^2", "m/s^2", MT_OTHER, 127.0, 5000.0)                            \
    X("ft/s^2", "m/s^2", MT_OTHER, 381.0, 1250.0)                            \
    X("mN", "N", MT_OTHER, 1.0, 1000.0)                                      \
    X("daN", "N", MT_OTHER, 10.0, 1.0)                                       \
    X("kN", "N", MT_OTHER, 1000.0, 1.0)                                      \
    X("MN", "N", MT_OTHER, 1e6, 1.0)                                         \
    X("lbf", "N", MT_OTHER, 8896443230521.0, 2e12)                           \
    X("kip", "N", MT_OTHER, 8896443230521.0, 2e9)                            \
    X("kgf", "N", MT_OTHER, 196133.0, 2e4)                                   \
    X("N/cm", "N/m", MT_OTHER, 100.0, 1.0)                                   \
    X("N/mm", "N/m", MT_OTHER, 1000.0, 1.0)                                  \
    X("N/um", "N/m", MT_OTHER, 1e6, 1.0)                                     \
    X("kN/m", "N/m", MT_OTHER, 1000.0, 1.0)                                  \
    X("kN/mm", "N/m", MT_OTHER, 1e6, 1.0)                                    \
    X("MN/m", "N/m", MT_OTHER, 1e6, 1.0)                                     \
    X("lbf/in", "N/m", MT_OTHER, 8896443230521.0, 508e8)                     \
    X("lbf/ft", "N/m", MT_OTHER, 8896443230521.0, 6096e8)                    \
    X("kip/in", "N/m", MT_OTHER, 8896443230521.0, 508e5)                     \
    X("kip/ft", "N/m", MT_OTHER, 8896443230521.0, 6096e5)                    \
    X("kPa", "Pa", MT_OTHER, 1000.0, 1.0)                                    \
    X("MPa", "Pa", MT_OTHER, 1e6, 1.0)                                       \
    X("GPa", "Pa", MT_OTHER, 1e9, 1.0)                                       \
    X("bar", "Pa", MT_OTHER, 1e5, 1.0)                                       \
    X("psi", "Pa", MT_OTHER, 8896443230521.0, 129032e4)                      \
    X("ksi", "Pa", MT_OTHER, 8896443230521.0, 1290320.0)                     \
    X("Msi", "Pa", MT_OTHER, 222411080763025.0, 32258.0)                     \
    X("N/mm^2", "N/m^2", MT_OTHER, 1e6, 1.0)                                 \
    X("kN/mm^2", "N/m^2", MT_OTHER, 1e9, 1.0)                                \
    X("kN/m^2", "N/m^2", MT_OTHER, 1000.0, 1.0)                              \
    X("lbf/in^2", "N/m^2", MT_OTHER, 8896443230521.0, 129032e4)              \
    X("lbf/ft^2", "N/m^2", MT_OTHER, 8896443230521.0, 18580608e4)            \
    X("N mm", "N m", MT_OTHER, 1.0, 1000.0)                                  \
    X("N cm", "N m", MT_OTHER, 1.0, 100.0)                                   \
    X("kN m", "N m", MT_OTHER, 1000.0, 1.0)                                  \
    X("kN mm", "N m", MT_OTHER, 1.0, 1.0)                                    \
    X("lbf in", "N m", MT_OTHER, 1129848290276167.0, 1e16)                   \
    X("lbf ft", "N m", MT_OTHER, 3389544870828501.0, 25e14)                  \
    X("N mm^2", "N m^2", MT_OTHER, 1.0, 1e6)                                 \
    X("kN m^2", "N m^2", MT_OTHER, 1000.0, 1.0)                              \
    X("kN mm^2", "N m^2", MT_OTHER, 1.0, 1000.0)                             \
    X("N mm/rad", "N m/rad", MT_OTHER, 1.0, 1000.0)                          \
    X("N cm/rad", "N m/rad", MT_OTHER, 1.0, 100.0)                           \
    X("kN m/rad", "N m/rad", MT_OTHER, 1000.0, 1.0)                          \
    X("kN mm/rad", "N m/rad", MT_OTHER, 1.0, 1.0)                            \
    X("MN m/rad", "N m/rad", MT_OTHER, 1e6, 1.0)                             \
    X("N m/mrad", "N m/rad", MT_OTHER, 1000.0, 1.0)                          \
    X("lbf in/rad", "N m/rad", MT_OTHER, 1129848290276167.0, 1e16)           \
    X("lbf ft/rad", "N m/rad", MT_OTHER, 3389544870828501.0, 25e14)          \
    X("N m/deg", "N m/rad", MT_OTHER, 1.0, DEG)                              \
    X("N mm/deg", "N m/rad", MT_OTHER, 1.0, 1000.0 * DEG)                    \
    X("kN m/deg", "N m/rad", MT_OTHER, 1000.0, DEG)                          \
    X("lbf in/deg", "N m/rad", MT_OTHER, 1129848290276167.0, 1e16 * DEG)     \
    X("lbf ft/deg", "N m/rad", MT_OTHER, 3389544870828501.0, 25e14 * DEG)    \
    X("N s/mm", "N s/m", MT_OTHER, 1000.0, 1.0)                              \
    X("kN s/m", "N s/m", MT_OTHER, 1000.0, 1.0)                              \
    X("kN s/mm", "N s/m", MT_OTHER, 1e6, 1.0)                                \
    X("lbf s/in", "N s/m", MT_OTHER, 8896443230521.0, 508e8)                 \
    X("lbf s/ft", "N s/m", MT_OTHER, 8896443230521.0, 6096e8)                \
    X("N mm s/rad", "N m s/rad", MT_OTHER, 1.0, 1000.0)                      \
    X("kN m s/rad", "N m s/rad", MT_OTHER, 1000.0, 1.0)                      \
    X("lbf in s/rad", "N m s/rad", MT_OTHER, 1129848290276167.0, 1e16)       \
    X("lbf ft s/rad", "N m s/rad", MT_OTHER, 3389544870828501.0, 25e14)      \
    X("N m s/deg", "N m s/rad", MT_OTHER, 1.0, DEG)                          \
    X("N mm s/deg", "N m s/rad", MT_OTHER, 1.0, 1000.0 * DEG)                \
    X("deg/s", "rad/s", MT_OTHER, DEG, 1.0)                                  \
    X("mm/rad", "m/rad", MT_OTHER, 1.0, 1000.0)                              \
    X("cm/rad", "m/rad", MT_OTHER, 1.0, 100.0)                               \
    X("in/rad", "m/rad", MT_OTHER, 127.0, 5000.0)                            \
    X("mm/deg", "m/rad", MT_OTHER, 1.0, 1000.0 * DEG)                        \
    X("rad/mm", "rad/m", MT_OTHER, 1000.0, 1.0)                              \
    X("deg/m", "rad/m", MT_OTHER, DEG, 1.0)                                  \
    X("deg/mm", "rad/m", MT_OTHER, 1000.0 * DEG, 1.0)                        \
    X("mJ", "J", MT_OTHER, 1.0, 1000.0)                                      \
    X("kJ", "J", MT_OTHER, 1000.0, 1.0)                                      \
    X("kW", "W", MT_OTHER, 1000.0, 1.0)                                      \
    X("%", "1", MT_OTHER, 1.0, 100.0)

#endif
