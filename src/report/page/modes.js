// SPDX-License-Identifier: GPL-3.0-or-later
// The modes of a configuration, of one design or of two side by side: a list to choose from
// (one group of radio buttons, so that arrow keys go through it), and where the energy of the
// chosen one is.
(function () {
    'use strict';
    const { make, table, digits } = window.mt.dom;

    const SHOWN = 8;   // bars; the rest is summed up
    const PIECES = 16; // of links: where there are more, each link is one

    // One row per mode: its places in the lists of the designs. Modes that have names are
    // paired by them, others by their index, rigid-body and unstable ones in their order.
    function pairs(lists) {
        const key = (list, j) => {
            const mode = list[j];
            if (mode.name) {
                return 'name ' + mode.name;
            }
            const before = list.slice(0, j).filter((other) => other.note === mode.note).length;
            return mode.note + ' ' + (mode.mode > 0 ? mode.mode : before);
        };
        const rows = new Map();
        lists.forEach((list, d) => list.forEach((mode, j) => {
            const k = key(list, j);
            if (!rows.has(k)) {
                rows.set(k, lists.map(() => null));
            }
            rows.get(k)[d] = j;
        }));
        return [...rows.values()];
    }

    function indexOf(mode) {
        return mode.mode > 0 ? String(mode.mode) : '–';
    }

    function hertz(mode) {
        if (!mode) {
            return '–';
        }
        return digits(mode.hz);
    }

    function change(a, b) {
        if (!a || !b || !(a.hz > 0) || !(b.hz > 0)) {
            return '–';
        }
        const percent = 100 * (b.hz / a.hz - 1);
        const text = percent.toFixed(Math.abs(percent) < 10 ? 2 : 1);
        return (percent > 0 ? '+' : '') + text.replace('-', '\u2212') + ' %';
    }

    // Shares of the energy of the chosen mode: names down, one bar per design, largest first.
    function bars(title, names, shares, labels) {
        const sums = new Map(); // pieces of one link have one name
        names.forEach((name, i) => {
            const before = sums.get(name) || shares.map(() => 0);
            sums.set(name, shares.map((list, d) => before[d] + (list[i] || 0)));
        });
        const rows = [...sums].map(([name, all]) => ({ name, shares: all }))
            .sort((a, b) => Math.max(...b.shares) - Math.max(...a.shares));
        const rest = rows.slice(SHOWN);
        const shown = rows.slice(0, SHOWN).filter((row) => Math.max(...row.shares) > 0.0005);
        if (rest.some((row) => Math.max(...row.shares) > 0.0005)) {
            const sum = (_, d) => rest.reduce((all, row) => all + row.shares[d], 0);
            shown.push({ name: rest.length + ' others', shares: shares.map(sum) });
        }
        if (shown.length === 0) {
            return make('div', {}, make('h3', {}, title), make('p', { class: 'note' }, 'none'));
        }
        const bar = (share, d) => {
            const fill = make('span', { class: d === 0 ? 'bar first' : 'bar second' });
            fill.style.width = Math.max(0, Math.min(100, 100 * share)) + '%';
            fill.toggleAttribute('data-none', !(share > 0.0005));
            return make('div', { class: 'share' }, make('span', { class: 'track' }, fill),
                make('span', { class: 'percent', 'aria-label': labels[d] },
                    (100 * share).toFixed(1) + ' %'));
        };
        return make('div', {}, make('h3', {}, title), make('table', { class: 'energy' },
            make('tbody', {}, shown.map((row) => make('tr', {},
                make('th', { scope: 'row', title: row.name }, row.name),
                make('td', {}, row.shares.map(bar)))))));
    }

    // Tells choose(list of indices, one per design) which mode was chosen.
    function modesPanel(container, choose) {
        const list = make('div', { class: 'modes' });
        const energy = make('div', { class: 'energies' });
        container.append(list, energy);
        let group = 0;
        let shown = { designs: [], configurations: [], rows: [] };
        let chosen = 0;

        function showEnergy(row) {
            const { designs, configurations } = shown;
            const of = (what) => configurations.map((configuration, d) => {
                const mode = configuration.modes[row[d]];
                return mode && mode.energy ? mode.energy[what] || [] : [];
            });
            const labels = designs.map((design) => design.label);
            const first = configurations[0];
            const many = first.bodies.filter((body) => body.kind === 'link').length > PIECES;
            const whole = (body) => (many && body.kind === 'link'
                ? body.name.replace(/\.[^.]*$/, '') : body.name);
            const names = (items) => (items || []).map(whole);
            energy.replaceChildren(
                bars('Potential energy in springs', names(first.springs), of('springs'),
                    labels),
                bars('Kinetic energy of bodies', names(first.bodies), of('bodies'), labels));
            if (labels.length > 1) {
                const swatch = (d) =>
                    make('span', { class: d === 0 ? 'swatch' : 'swatch second' });
                energy.prepend(make('p', { class: 'key' },
                    labels.map((label, d) => make('span', {}, swatch(d), label))));
            }
        }

        function select(k) {
            const input = list.querySelectorAll('input')[k];
            if (!input) {
                return;
            }
            input.checked = true;
            chosen = k;
            list.querySelectorAll('tbody tr')
                .forEach((row, i) => row.classList.toggle('chosen', i === k));
            showEnergy(shown.rows[k]);
            choose(shown.rows[k]);
        }

        // keep: the mode that was chosen, as for another design of the same configuration
        function show(designs, configurations, keep) {
            const rows = pairs(configurations.map((configuration) => configuration.modes));
            shown = { designs, configurations, rows };
            group += 1;
            const two = designs.length > 1;
            const named = configurations.some((c) => c.modes.some((m) => m.name || m.note));
            const cells = rows.map((row, k) => {
                const modes = configurations.map((configuration, d) =>
                    (row[d] === null ? null : configuration.modes[row[d]]));
                const first = modes.find((mode) => mode);
                const told = [first.name, first.note].filter((part) => part).join(', ');
                const input = make('input', { type: 'radio', name: 'mode' + group, value: k,
                    'aria-label': `mode ${indexOf(first)} ${told} ${hertz(first)} Hz`,
                    change: () => select(k) });
                return make('tr', { click: () => select(k) },
                    make('td', {}, make('label', {}, input, ' ', indexOf(first))),
                    named ? make('td', { class: 'name' }, told) : null,
                    modes.map((mode) => make('td',
                        { class: 'number', 'data-hz': mode && mode.hz }, hertz(mode))),
                    two ? make('td', { class: 'number' }, change(modes[0], modes[1])) : null);
            });
            const heads = two
                ? [...designs.map(({ label }) => label + ', Hz'), 'change'] : ['Hz'];
            if (rows.length === 0) {
                const why = configurations.map((c) => c.error).find((error) => error);
                list.replaceChildren(make('p', { class: 'note' }, why || 'no modes'));
                energy.replaceChildren();
                choose(designs.map(() => null));
                return;
            }
            list.replaceChildren(table(['mode', ...(named ? ['name'] : []), ...heads], cells,
                named ? [2, 3, 4] : [1, 2, 3]));
            const start = rows.findIndex((row) => {
                const mode = configurations[0].modes[row[0]];
                return mode && mode.mode > 0;
            });
            select(keep && chosen < rows.length ? chosen : Math.max(start, 0));
        }
        return { show, select };
    }

    window.mt.modesPanel = modesPanel;
})();
