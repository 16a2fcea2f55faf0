# SPDX-License-Identifier: GPL-3.0-or-later
"""One picture of each table. Axes are logarithmic, curves carry their names, the machine stands below."""
import math
import textwrap

# Told apart by people who do not see all colours, too (Okabe and Ito).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#56B4E9", "#E69F00", "#7F3C8D", "#8C6D31")
MARKS = "osD^v<>PX"
FLOOR = 1e-17  # an error of 0 is shown here


def sheet(head, lines, columns, size=(6.4, 4.4)):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "modetune", "axes.spines.top": False, "axes.spines.right": False, "font.size": 9})
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(lines, columns, figsize=(size[0] * columns, size[1] * lines + 0.5), squeeze=False,
                                   layout="constrained")
    figure.supxlabel("\n".join(textwrap.wrap("; ".join(head), 105 * columns)), fontsize=6.5, color="0.4", x=0.01, ha="left")
    return figure, axes


def save(path, figure):
    from matplotlib import pyplot
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)


def frame(axis, title, x, y):
    axis.set_title(title, loc="left", fontsize=10)
    axis.set(xlabel=x, ylabel=y, xscale="log", yscale="log")
    axis.grid(alpha=0.25, linewidth=0.6)


def plain_numbers(axis, numbers):
    from matplotlib import ticker
    axis.set_major_locator(ticker.FixedLocator(numbers))
    axis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))
    axis.set_minor_locator(ticker.NullLocator())


def spread_out(wanted, least):
    """Heights near those wanted, at least so far from each other."""
    order = sorted(range(len(wanted)), key=lambda i: wanted[i])
    place = list(wanted)
    for _ in range(200):
        for a, b in zip(order, order[1:]):
            short = least - (place[b] - place[a])
            if short > 1e-9:
                place[a] -= short / 2
                place[b] += short / 2
    return place


def name_ends(axis, ends):
    """(x, y, name, colour) of curves: names at the right, none upon another."""
    axis.margins(x=0.03)
    low, high = (math.log10(v) for v in axis.get_ylim())
    at = [(math.log10(y) - low) / (high - low) for _, y, _, _ in ends]
    for (x, y, name, colour), place in zip(ends, spread_out(at, 0.05)):
        axis.annotate(name, (x, y), xytext=(1.02, place), textcoords=axis.transAxes, color=colour, va="center", fontsize=8,
                      annotation_clip=False, arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.5, "alpha": 0.5})


def curves(axis, rows, x, y, by="way", styles=None, note=None):
    """One curve of each way over x; note: what stands beside a point."""
    ends = []
    for name in dict.fromkeys(r[by] for r in rows):
        points = [(r[x], max(r[y], FLOOR), r) for r in rows if r[by] == name and r.get(y) == r.get(y) and r.get(y) is not None]
        if not points:
            continue
        colour, mark = (styles or style(rows, by))[name]
        axis.plot(*zip(*[p[:2] for p in points]), marker=mark, color=colour, markersize=4, linewidth=1.2)
        for px, py, row in points if note else ():
            axis.annotate(f"{row[note]:,}", (px, py), xytext=(0, 5), textcoords="offset points", ha="center", fontsize=6.5, color=colour)
        ends.append((*points[-1][:2], name, colour))
    name_ends(axis, ends)


def style(rows, by="way"):
    return {name: (COLOURS[i % len(COLOURS)], MARKS[i % len(MARKS)]) for i, name in enumerate(dict.fromkeys(r[by] for r in rows))}


def elements(path, head, rows):
    figure, axes = sheet(head, 1, 2)
    frame(axes[0][0], "Free beam, first four frequencies: elements against error", "elements", "largest relative error")
    frame(axes[0][1], "The same springs with both ends pinned", "CPU time of one evaluation [s]", "largest relative error")
    # springs that meet the frequencies exactly say nothing by meeting them: rounding is cut off
    axes[0][0].set_ylim(1e-8, 2)
    curves(axes[0][0], [r for r in rows if r["error"] > 1e-8], "elements", "error")
    curves(axes[0][1], rows, "cpu_s", "error_pinned", note="elements")
    plain_numbers(axes[0][0].xaxis, sorted({r["elements"] for r in rows}))
    axes[0][0].text(0.02, 0.02, "identified with four springs or more: below 1e-8", transform=axes[0][0].transAxes, fontsize=7.5, color=COLOURS[1])
    axes[0][1].text(0.02, 0.02, "small numbers: elements", transform=axes[0][1].transAxes, fontsize=7.5, color="0.4")
    save(path, figure)


def eigensolver(path, head, rows):
    figure, axes = sheet(head, 1, 2)
    frame(axes[0][0], "Cantilever of n rigid elements, four frequencies", "CPU time [s]", "largest relative error")
    frame(axes[0][1], "The same: growth with n", "elements n", "CPU time [s]")
    curves(axes[0][0], rows, "cpu_s", "error", note="elements")
    curves(axes[0][1], rows, "elements", "cpu_s")
    axes[0][0].text(0.02, 0.02, "small numbers: n", transform=axes[0][0].transAxes, fontsize=7.5, color="0.4")
    save(path, figure)


def peers(path, head, rows):
    figure, axes = sheet(head, 1, 2)
    frame(axes[0][0], "Cantilever of n beam elements, from file to four frequencies", "elements n", "CPU time [s]")
    frame(axes[0][1], "The same: time against error", "CPU time [s]", "largest relative error")
    curves(axes[0][0], rows, "elements", "cpu_s")
    curves(axes[0][1], rows, "cpu_s", "error", note="elements")
    save(path, figure)


def evaluation(path, head, rows):
    rows = [r for r in rows if r["way"] != "dsyevd"]
    names = list(dict.fromkeys(r["study"] for r in rows))[::-1]
    figure, axes = sheet(head, 1, 1, size=(8.0, 0.42 * len(names) + 0.8))
    axis = axes[0][0]
    axis.set_title("Designs per second and core", loc="left", fontsize=10)
    axis.set(xscale="log", xlabel="evaluations per second of CPU time")
    for shift, way, colour in ((0.15, "values", COLOURS[0]), (-0.15, "values and slopes", COLOURS[1])):
        for r in (r for r in rows if r["way"] == way):
            y = names.index(r["study"]) + shift
            axis.plot(r["per_second"], y, "o" if way == "values" else "s", color=colour, markersize=5)
            axis.annotate(f"  {way}  {r['per_second']:,.0f}", (r["per_second"], y), va="center", fontsize=7, color=colour)
    axis.set_yticks(range(len(names)), [f"{n}  ({next(r['freedoms'] for r in rows if r['study'] == n)} freedoms)" for n in names])
    axis.set_xlim(right=20 * max(r["per_second"] for r in rows))
    axis.grid(alpha=0.25)
    save(path, figure)


def search(path, head, rows):
    """Two panels of each study: distance over evaluations, and over time, medians of the runs that came so near; a thin line
    where fewer than half did."""
    studies = list(dict.fromkeys(r["study"] for r in rows))
    styles = style(rows, "method")
    figure, axes = sheet(head, len(studies), 2, size=(6.4, 2.9))
    for line, study in zip(axes, studies):
        for axis, x, label in zip(line, ("evaluations", "cpu_s"), ("evaluations", "CPU time [s]")):
            frame(axis, study, label, "distance from the best")
            ends = []
            for method, (colour, mark) in styles.items():
                points = [r for r in rows if r["study"] == study and r["method"] == method and r["reached"]]
                if not points:
                    continue
                half = [r for r in points if 2 * r["reached"] >= r["runs"]]
                axis.plot([r[x] for r in points], [r["distance"] for r in points], color=colour, linewidth=0.6, marker=mark, markersize=2)
                axis.plot([r[x] for r in half], [r["distance"] for r in half], color=colour, linewidth=1.5, marker=mark, markersize=3)
                ends.append((points[-1][x], points[-1]["distance"], f"{method} ({points[-1]['reached']}/{points[-1]['runs']})", colour))
            axis.set_ylim(3e-11, 3)
            name_ends(axis, sorted(ends))
    save(path, figure)
