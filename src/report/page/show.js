// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a scene: its views, drive, modes and joints.
(function () {
    'use strict';
    const mt = window.mt;
    const { make, table, digits } = mt.dom;
    const { quantity, weight } = mt.drawing;

    const LISTED = 3;   // configurations that a row names
    const LONG = 12;    // parameters that are shown without asking
    const LEGEND = 16; // half of the width of a symbol of the legend, px

    function count(n, one, many) {
        return n + ' ' + (n === 1 ? one : many || one + 's');
    }

    function choice(label, names, chosen, change) {
        const select = make('select', { change: () => change(Number(select.value)) },
            names.map((name, i) => make('option', { value: i, selected: i === chosen }, name)));
        return make('label', { class: 'choice' }, label + ' ', select);
    }

    function summary(configuration) {
        const springs = (configuration.springs || []).length;
        const dampers = (configuration.dampers || []).length;
        const bodies = configuration.bodies.filter((body) => body.kind !== 'ground');
        const mass = bodies.reduce((sum, body) => sum + (body.mass || 0), 0);
        const all = mass > 0 ? ' of ' + weight(mass) : '';
        return [count(bodies.length, 'body', 'bodies') + all,
            count((configuration.joints || []).length, 'joint'), count(springs, 'spring'),
            dampers > 0 ? count(dampers, 'damper') : null].filter((part) => part).join(', ');
    }

    // One symbol of each kind that the configuration has.
    function legend(configuration) {
        const at = [LEGEND, 11];
        const lens = { direction: (v) => [v[0], -v[1], v[2]], frame: { towards: [0, 0, 1] } };
        const ends = [[3, 11], [2 * LEGEND - 3, 11]];
        const kinds = (list) => [...new Set((list || []).map((item) => item.type))];
        const icon = (items, name) => make('li', {},
            mt.paint.toSvg(items, mt.paint.palette(document.body), 2 * LEGEND, 22), name);
        const element = (draw, type, what) => icon(
            ...(type === 'torsion' ? [draw(type, at, at, null, 3, lens)]
                : type === 'bushing' ? [draw(type, at, at, null, 4, lens)]
                    : [draw(type, ...ends, null, 4, lens)]),
            type + ' ' + what);
        const list = [
            ...kinds(configuration.joints).map((type) =>
                icon(mt.symbols.joint(type, at, 5.5), type + ' joint')),
            ...kinds(configuration.springs).filter((type) => type !== 'link').map((type) =>
                element(mt.symbols.spring, type, 'spring')),
            ...kinds(configuration.dampers).map((type) =>
                element(mt.symbols.damper, type, 'damper'))];
        if ((configuration.sensors || []).length > 0) {
            list.push(icon(mt.symbols.arrow([6, 11], [26, 11], 'sensor', 5), 'sensor'));
        }
        if (configuration.bodies.some((body) => body.ellipsoid)) {
            list.push(icon([{ ellipse: [LEGEND, 11, 12, 7, 0], fill: 'body', alpha: 0.16,
                stroke: 'body', width: 1.3 }],
            'body, as an ellipsoid of equal mass and inertia'));
        }
        return make('ul', { class: 'legend', 'aria-label': 'symbols' }, list);
    }

    function parameterTable(designs, heading) {
        const [first, second] = designs;
        const lists = designs.map((design) => design.parameters || []);
        if (lists[0].length === 0) {
            return null;
        }
        const rows = lists[0].map((parameter, i) => {
            const other = second && lists[1][i];
            const percent = other && parameter.value
                ? digits(100 * (other.value / parameter.value - 1), 3) + ' %' : '–';
            const shown = (p) => digits(p.value / (p.display_factor || 1));
            return [parameter.name, shown(parameter),
                ...(second ? [other ? shown(other) : '–', percent] : []),
                parameter.display_unit || parameter.unit || ''];
        });
        const heads = second ? [first.label, second.label, 'change'] : ['value'];
        return make('details', { open: rows.length <= LONG },
            make('summary', {}, make(heading, {}, 'Parameters')),
            table(['parameter', ...heads, 'unit'], rows, second ? [1, 2, 3] : [1]));
    }

    function jointTable(scene, heading) {
        const far = mt.farShare * scene.size;
        const all = scene.designs[0].configurations.length;
        const alike = new Map(); // the same in several configurations is told once
        (scene.joints || []).forEach((joint) => {
            const key = JSON.stringify([joint.joint, joint.type, joint.body, joint.distance]);
            alike.set(key, [...(alike.get(key) || []), joint]);
        });
        const list = [...alike.values()].sort((a, b) => b[0].distance - a[0].distance);
        if (list.length === 0) {
            return null;
        }
        const where = (same) => {
            const names = same.map((joint) => joint.configuration);
            const few = names.length <= LISTED ? names.join(', ')
                : `${names[0]} and ${names.length - 1} others`;
            return make('td', { title: names.join(', ') },
                names.length === all && all > 1 ? 'all' : few);
        };
        const rows = list.map((same) => {
            const joint = same[0];
            const marked = joint.distance > far;
            const distance = joint.distance > 0 ? quantity(joint.distance, 'm') : '0';
            return make('tr', { class: marked ? 'far' : null },
                make('th', { scope: 'row' }, joint.joint),
                make('td', {}, joint.type),
                make('td', {}, joint.body || '–'),
                make('td', { class: 'number' }, distance),
                make('td', {}, marked ? '\u25B2 far' : ''),
                where(same));
        });
        return make('section', {},
            make(heading, {}, 'Joints, by their distance from what they join'),
            make('p', { class: 'note' }, 'The distance is that of the joint\u2019s point from '
                + 'what is drawn of the body that is farther. More than '
                + `${quantity(far, 'm')} is marked: a coordinate may be wrong there.`),
            table(['joint', 'type', 'from body', 'distance', '', 'configurations'], rows, [3]));
    }

    // options: heading (the element of headings); follows (somebody else says which design is
    // compared with the original one: compare(rank), true where the scene has it).
    function show(container, scene, options) {
        const { heading, follows } = { heading: 'h2', follows: false, ...options };
        const camera = mt.camera(scene);
        const clock = mt.clock();
        const state = { configuration: 0, second: scene.designs.length > 1 ? 1 : null };
        const ids = () => (state.second === null ? [0] : [0, state.second]);
        const designs = () => ids().map((i) => scene.designs[i]);
        const configurations = () =>
            designs().map((design) => design.configurations[state.configuration]);
        const names = scene.designs[0].configurations.map(({ name }) => name);
        const facts = make('p', { class: 'note' });
        const place = make('div', { class: 'views' });
        const key = make('div', {});
        const drive = make('section', { class: 'drive' });
        const modes = make('section', { class: 'panel', 'aria-label': 'modes' });
        const parameters = make('div', {});

        const selects = make('div', { class: 'controls' });
        if (names.length > 1) {
            selects.append(choice('Configuration', names, 0, (i) => {
                state.configuration = i;
                update(true);
            }));
        }
        if (scene.designs.length > 2 && !follows) {
            const labels = scene.designs.slice(1).map((design) => design.label);
            selects.append(choice('Compared with', labels, 0, (i) => {
                state.second = i + 1;
                update(false);
            }));
        }
        container.append(facts, selects, place);
        const views = ids().map((i) => mt.view3d(place, scene,
            { camera, clock, design: i, caption: scene.designs[i].label }));
        place.classList.toggle('two', views.length > 1);
        container.append(mt.viewControls(views), key, drive,
            make(heading, {}, 'Modes'), modes,
            ...[jointTable(scene, heading)].filter((part) => part),
            parameters);
        const panel = mt.modesPanel(modes,
            (row) => views.forEach((view, d) => view.setMode(row[d])));
        const drives = mt.drivePanel(drive, (k) => views.forEach((view) => view.setDrive(k)),
            heading);

        function update(fit) {
            facts.textContent = summary(configurations()[0]);
            views.forEach((view, d) => {
                view.setDesign(ids()[d]);
                view.setConfiguration(state.configuration);
                view.setCaption(views.length > 1 ? designs()[d].label
                    : names[state.configuration]);
            });
            key.replaceChildren(legend(configurations()[0]));
            drives.show(designs(), configurations(), !fit);
            panel.show(designs(), configurations(), !fit);
            parameters.replaceChildren(
                ...[parameterTable(designs(), heading)].filter((part) => part));
            if (fit) {
                camera.home();
            }
        }

        update(true);
        clock.startUnlessStill();
        window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change',
            () => key.replaceChildren(legend(configurations()[0])));
        function compare(rank) {
            const i = scene.designs.findIndex((design) => design.rank === rank);
            if (i > 0 && i !== state.second) {
                state.second = i;
                update(false);
            }
            return i >= 0;
        }

        const compared = () => designs()[designs().length - 1].label;
        return { views, camera, clock, panel, compare, compared };
    }

    mt.show = show;
    mt.whenRead(() => {
        const given = mt.scene();
        if (given && !document.getElementById('figures')) { // a report shows it in its place
            mt.shown = show(document.querySelector('main'), given);
        }
    });
})();
