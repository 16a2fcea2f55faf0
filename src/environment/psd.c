/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "environment/psd.h"

#include <math.h>

static const double DB_PER_OCTAVE = 3.0102999566398120; /* 10 log10(2): of an exponent of 1 */
/* Numbers nearer to each other than this factor have the logarithm of their quotient from their
 * difference. */
static const double CLOSE = 2.0;

double mt_psd_log_ratio(double a, double b)
{
    return b < CLOSE * a && a < CLOSE * b ? log1p((b - a) / a) : log(b / a);
}

double mt_psd_exponent(const mt_psd *psd, int i)
{
    const double l = mt_psd_log_ratio(psd->hz[i], psd->hz[i + 1]);
    return l > 0.0 ? mt_psd_log_ratio(psd->level[i], psd->level[i + 1]) / l : 0.0;
}

double mt_psd_slope_db(const mt_psd *psd, int i)
{
    return DB_PER_OCTAVE * mt_psd_exponent(psd, i);
}

double mt_psd_at(const mt_psd *psd, double hz)
{
    double most = 0.0;
    for (int i = 0; i + 1 < psd->n; i++) {
        if (hz >= psd->hz[i] && hz <= psd->hz[i + 1]) {
            const double l = mt_psd_log_ratio(psd->hz[i], hz);
            most = fmax(most, hz == psd->hz[i + 1]
                                  ? psd->level[i + 1]
                                  : psd->level[i] * exp(mt_psd_exponent(psd, i) * l));
        }
    }
    return most;
}

double mt_psd_power_integral(double e, double l)
{
    const double x = e * l;
    return x == 0.0 ? l : l * (expm1(x) / x);
}

double mt_psd_area(const mt_psd *psd, double from_hz, double to_hz)
{
    double sum = 0.0;
    for (int i = 0; i + 1 < psd->n; i++) {
        const double a = fmax(from_hz, psd->hz[i]);
        const double b = fmin(to_hz, psd->hz[i + 1]);
        if (a < b) {
            const double e = mt_psd_exponent(psd, i);
            const double level = psd->level[i] * exp(e * mt_psd_log_ratio(psd->hz[i], a));
            sum += level * a * mt_psd_power_integral(e + 1.0, mt_psd_log_ratio(a, b));
        }
    }
    return sum;
}

double mt_psd_mean_square(const mt_psd *psd)
{
    return mt_psd_area(psd, psd->hz[0], psd->hz[psd->n - 1]);
}
