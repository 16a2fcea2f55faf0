// SPDX-License-Identifier: GPL-3.0-or-later
// A driven joint: a slider over its range, and the frequencies along it.
(function () {
    'use strict';
    const { make, digits } = window.mt.dom;

    const SVG = 'http://www.w3.org/2000/svg';
    const LEFT = 60;
    const TOP = 12;
    const RIGHT = 26;
    const BOTTOM = 34;
    const NEAR = 11; // px: numbers of modes that are closer hide each other
    const WIDE = 15; // of the highest frequency and the lowest: more is shown by logarithms

    // 1, 2 or 5 times a power of ten, so that the length has about six of it.
    function step(length) {
        const power = Math.pow(10, Math.floor(Math.log10(length / 6)));
        const lead = length / 6 / power;
        return power * (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10);
    }

    function marks(low, high) {
        const by = step(high - low);
        const list = [];
        for (let k = Math.ceil(low / by - 1e-9); k * by <= high + 1e-9 * by; k++) {
            list.push(Number((k * by).toPrecision(12)));
        }
        return list;
    }

    const shownAt = (drive, value) => (drive.unit === 'rad' ? value * 180 / Math.PI : value);
    const listOf = (position) => position.hz || [];
    const unitOf = (drive) => (drive.unit === 'rad' ? '°' : ' ' + drive.unit);

    function svg(name, attributes, text) {
        const made = document.createElementNS(SVG, name);
        Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
        if (text !== undefined) {
            made.textContent = text;
        }
        return made;
    }

    // Where frequencies stand and which of them are marked; by their logarithms where the
    // highest would flatten the others.
    function heights(all, height) {
        const high = Math.max(...all, 0) * 1.05 || 1;
        const low = Math.min(...all);
        const room = height - BOTTOM - TOP;
        if (!(low > 0) || high / low < WIDE) {
            return { marks: marks(0, high), of: (hz) => height - BOTTOM - hz / high * room };
        }
        const first = Math.floor(Math.log10(low));
        const span = Math.log10(high) - first;
        const powers = Array.from({ length: Math.floor(span) + 1 }, (_, k) => first + k);
        const leads = span < 2 ? [1, 2, 5] : [1];
        return { marks: powers.flatMap((k) => leads.map((lead) => lead * Math.pow(10, k)))
            .filter((hz) => hz <= high),
        of: (hz) => height - BOTTOM - (Math.log10(hz) - first) / span * room };
    }

    // Frequencies over the range: one line per mode; of two designs the first one is dashed.
    function chart(drives, labels, k, size) {
        const { width, height } = size;
        const at = drives[0].positions.map((position) => shownAt(drives[0], position.at));
        const all = drives.flatMap((drive) => drive.positions.flatMap(listOf))
            .filter((hz) => isFinite(hz));
        const y = heights(all, height);
        const low = Math.min(...at);
        const high = Math.max(...at) > low ? Math.max(...at) : low + 1;
        const x = (value) => LEFT + (value - low) / (high - low) * (width - LEFT - RIGHT);
        const degree = drives[0].unit === 'rad' ? '°' : '';
        const root = svg('svg', { viewBox: `0 0 ${width} ${height}`, width, height, role: 'img',
            class: 'chart' });
        root.append(svg('title', {}, `frequencies over the range of ${drives[0].joint}`));
        const text = (content, px, py, anchor) => root.append(svg('text', { x: px, y: py,
            'text-anchor': anchor, 'font-size': 11, fill: 'currentColor' }, content));
        y.marks.forEach((hz) => {
            root.append(svg('line', { x1: LEFT, x2: width - RIGHT, y1: y.of(hz), y2: y.of(hz),
                stroke: 'currentColor', 'stroke-opacity': 0.15 }));
            text(digits(hz, 3), LEFT - 6, y.of(hz) + 4, 'end');
        });
        marks(low, high).forEach((value) =>
            text(digits(value) + degree, x(value), height - BOTTOM + 15, 'middle'));
        text('Hz', 4, TOP + 2, 'start');
        text(drives[0].joint + (drives[0].unit === 'rad' ? '' : ', ' + drives[0].unit),
            (LEFT + width - RIGHT) / 2, height - 4, 'middle');
        drives.forEach((drive, d) => {
            const count = Math.max(...drive.positions.map((at) => listOf(at).length), 0);
            for (let j = 0; j < count; j++) {
                let path = '';
                let pen = false; // a position without modes leaves a gap
                drive.positions.forEach((position) => {
                    const hz = listOf(position)[j];
                    if (hz === undefined || hz === null) {
                        pen = false;
                        return;
                    }
                    path += `${pen ? 'L' : 'M'}${x(shownAt(drive, position.at)).toFixed(1)} `
                        + y.of(hz).toFixed(1);
                    pen = true;
                });
                const before = drives.length > 1 && d === 0;
                const line = svg('path', { d: path || 'M0 0', fill: 'none',
                    class: before ? 'line1' : 'line2', 'stroke-width': 1.6 });
                if (before) {
                    line.setAttribute('stroke-dasharray', '5 3');
                }
                root.append(line);
            }
        });
        const last = drives[drives.length - 1].positions[at.length - 1];
        let below = Infinity;
        (last ? listOf(last) : []).forEach((hz, j) => {
            const here = y.of(hz);
            if (below - here >= NEAR) {
                text(String(j + 1), width - RIGHT + 6, here + 4, 'start');
                below = here;
            }
        });
        if (k !== null) {
            root.append(svg('line', { x1: x(at[k]), x2: x(at[k]), y1: TOP, y2: height - BOTTOM,
                stroke: 'currentColor', 'stroke-width': 1.2 }));
        } else if (drives[0].at !== null && drives[0].at >= drives[0].positions[0].at) {
            const here = x(shownAt(drives[0], drives[0].at));
            root.append(svg('line', { x1: here, x2: here, y1: TOP, y2: height - BOTTOM,
                stroke: 'currentColor', 'stroke-width': 1, 'stroke-dasharray': '1 3' }));
        }
        return root;
    }

    // A report has frequencies along the range where its study asks for them.
    const counted = (drives) => drives.some((drive) =>
        drive.positions.some((position) => listOf(position).length > 0));

    function say(drives, labels, k) {
        if (k === null) {
            return 'as drawn';
        }
        const known = counted(drives);
        return drives.map((drive, d) => {
            const position = drive.positions[k];
            const hz = !position ? [] : listOf(position).slice(0, 6);
            const found = !position ? 'no position' : position.error
                || (known ? hz.map((x) => digits(x, 5)).join(', ') + ' Hz' : '');
            return found && (drives.length > 1 ? labels[d] + ': ' : '') + found;
        }).filter((words) => words)
            .concat(known ? [] : ['frequencies along the range: modetune show']).join('; ');
    }

    // Tells choose(k or null) which position was chosen; null: as drawn.
    function drivePanel(container, choose, heading) {
        let last = null; // position that was chosen

        // keep: that position, as for another design of the same configuration
        function show(designs, configurations, keep) {
            const all = configurations.map((configuration) => configuration.drive);
            const driven = all.find((drive) => drive);
            const kept = all.map((drive, d) => ({ drive, label: designs[d].label }))
                .filter(({ drive }) => drive && drive.positions.length > 0);
            container.replaceChildren();
            container.hidden = !driven;
            if (driven) {
                container.append(make(heading, {}, 'Drive: ' + driven.joint));
            }
            if (kept.length === 0) {
                container.append(make('p', { class: 'note' }, (driven && driven.error) || ''));
                choose(null);
                return;
            }
            const drives = kept.map(({ drive }) => drive);
            const labels = kept.map(({ label }) => label);
            const positions = drives[0].positions;
            const off = (i) => Math.abs(positions[i].at - (drives[0].at || 0));
            const nearest = positions.reduce((k, _, i) => (off(i) < off(k) ? i : k), 0);
            const out = make('output', { class: 'place' });
            const told = make('p', { class: 'note', 'aria-live': 'polite' });
            const picture = make('div', { class: 'picture' });
            const slider = make('input', { type: 'range', id: 'drive', min: 0,
                max: positions.length - 1, step: 1, '.value': nearest,
                'aria-label': 'position of ' + drives[0].joint,
                input: () => set(Number(slider.value)) });
            const back = make('button', { type: 'button', click: () => {
                slider.value = nearest;
                set(null);
            } }, 'As drawn');
            const size = () => ({ height: 220,
                width: Math.max(280, Math.min(container.clientWidth || 600, 900)) });
            let chosen = null;
            let painted = 0; // width of the chart that is there

            function paint() {
                painted = size().width;
                picture.replaceChildren(...(counted(drives)
                    ? [chart(drives, labels, chosen, size())] : []));
            }

            function set(k) {
                chosen = k;
                last = k;
                const here = k === null ? drives[0].at : positions[k].at;
                const text = here === null ? 'as drawn'
                    : digits(shownAt(drives[0], here), 4) + unitOf(drives[0])
                        + (k === null ? ' (as drawn)' : '');
                out.textContent = text;
                slider.setAttribute('aria-valuetext', text);
                told.textContent = k === null
                    ? 'Mode shapes are animated at the position drawn.'
                    : say(drives, labels, k);
                paint();
                choose(k);
            }

            container.append(
                make('div', { class: 'controls' }, slider, out, back), told, picture);
            new window.ResizeObserver(() => {
                if (size().width !== painted) {
                    paint();
                }
            }).observe(container);
            const same = keep && last !== null && last < positions.length ? last : null;
            slider.value = same === null ? nearest : same;
            set(same);
        }
        return { show };
    }

    window.mt.drivePanel = drivePanel;
})();
