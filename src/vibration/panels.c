/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vibration/panels.h"

#include <math.h>

static const double PI = 3.14159265358979323846;
/* w^b: the ends of a panel differ by at most this factor, and w^b by exp of the other. */
static const double MOST_RATIO = 2.0;
static const double MOST_GROWTH = 4.0;
/* Newton's method on the Legendre polynomial ends at rounding after so many steps. */
enum { NEWTON_STEPS = 6 };

void mt_panels_gauss(mt_gauss *g)
{
    const int n = MT_GAUSS_NODES;
    for (int i = 0; i < n / 2; i++) {
        double x = cos(PI * (i + 0.75) / (n + 0.5)); /* the root is next to it */
        double slope = 1.0;
        for (int step = 0; step < NEWTON_STEPS; step++) {
            double p = 1.0;
            double before = 0.0;
            for (int k = 0; k < n; k++) {
                const double next = (((2 * k) + 1) * x * p - (k * before)) / (k + 1);
                before = p;
                p = next;
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        g->node[i] = -x;
        g->node[n - 1 - i] = x;
        g->weight[i] = 2.0 / ((1.0 - x * x) * slope * slope);
        g->weight[n - 1 - i] = g->weight[i];
    }
}

bool mt_panels_clears(const mt_frf *h, int k, const mt_panel *panel, double clear)
{
    const double d = panel->anchor - h->re[k];
    const double sum = hypot(d + panel->a, h->im[k]) + hypot(d + panel->b, h->im[k]);
    return sum >= (clear + (1.0 / clear)) * 0.5 * (panel->b - panel->a);
}

static bool is_smooth(const mt_panels *p, const mt_panel *panel)
{
    const double begin = panel->anchor + panel->a;
    const double width = panel->b - panel->a;
    if (p->exponent != 0.0 && (width > (MOST_RATIO - 1.0) * begin ||
                               width * fabs(p->exponent) > MOST_GROWTH * begin)) {
        return false;
    }
    for (int k = 0; k < p->h->n; k++) {
        if (!mt_panels_clears(p->h, k, panel, MT_PANEL_CLEAR)) {
            return false;
        }
    }
    return true;
}

/* The next frequency of a pole above `at`, or the interval's end. */
static double next_anchor(const mt_panels *p, double at)
{
    double next = p->upper;
    for (int k = 0; k < p->h->n; k++) {
        const double re = p->h->re[k];
        next = re > at && re < next ? re : next;
    }
    return next;
}

void mt_panels_begin(mt_panels *p, const mt_frf *h, double lower, double upper, double exponent)
{
    *p = (mt_panels){.h = h, .upper = upper, .exponent = exponent, .at = lower};
    p->next = next_anchor(p, lower);
    p->depth = 1;
    p->stack[0] = (mt_panel){lower, 0.0, 0.5 * (p->next - lower)};
    p->right = true;
}

/* Put the half that follows on the empty stack; false: there is none. */
static bool push_next_half(mt_panels *p)
{
    if (!p->right) {
        if (!(p->next < p->upper)) {
            return false;
        }
        p->at = p->next;
        p->next = next_anchor(p, p->at);
    }
    const double half = 0.5 * (p->next - p->at);
    p->stack[0] = p->right ? (mt_panel){p->next, -half, 0.0} : (mt_panel){p->at, 0.0, half};
    p->right = !p->right;
    p->depth = 1;
    return true;
}

bool mt_panels_next(mt_panels *p, mt_panel *out)
{
    while (p->depth > 0 || push_next_half(p)) {
        const mt_panel panel = p->stack[--p->depth];
        if (is_smooth(p, &panel)) {
            *out = panel;
            return true;
        }
        const double middle = 0.5 * (panel.a + panel.b);
        if (p->depth + 2 > MT_PANEL_DEPTH || !(panel.a < middle && middle < panel.b)) {
            p->narrow = true;
            return false;
        }
        p->stack[p->depth++] = (mt_panel){panel.anchor, middle, panel.b};
        p->stack[p->depth++] = (mt_panel){panel.anchor, panel.a, middle};
    }
    return false;
}

double mt_panels_bound(const mt_frf *h, const mt_panel *panel)
{
    const double half = 0.5 * (panel->b - panel->a);
    const double centre = 0.5 * (panel->a + panel->b);
    const double axis = 0.5 * (MT_PANEL_INNER + (1.0 / MT_PANEL_INNER)) * half;
    /* confocal ellipses are nearest to each other where their long axes end */
    const double gap = (0.5 * (MT_PANEL_CLEAR + (1.0 / MT_PANEL_CLEAR)) * half) - axis;
    const double most = panel->anchor + centre + axis;
    double sum = cabs(h->c[0]) + (most * (cabs(h->c[1]) + (most * cabs(h->c[2]))));
    for (int k = 0; k < h->n; k++) {
        const double distance = hypot((panel->anchor - h->re[k]) + centre, h->im[k]);
        sum += cabs(h->rho[k]) / fmax(gap, distance - axis);
    }
    return sum;
}

double mt_panels_truncation(void)
{
    const double inverse = 1.0 / MT_PANEL_INNER;
    const double square = inverse * inverse;
    return 64.0 / 15.0 * pow(square, MT_GAUSS_NODES) / (1.0 - square);
}
