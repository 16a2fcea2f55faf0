// SPDX-License-Identifier: GPL-3.0-or-later
// A view of a scene: a canvas that is turned, zoomed and asked for names, with a mode that
// moves.
//
//   const view = mt.view3d(container, scene, {camera, clock, design, configuration, caption});
//   view.setDesign(i)   view.setConfiguration(i)   view.setMode(j or null)
//   view.setDrive(k or null)   view.savePng()   view.saveSvg()
//
// Views that look through one camera (mt.camera(scene)) turn together, views with one clock
// (mt.clock()) move together: clock.play(), clock.pause(), clock.setAmplitude(share of size).
(function () {
    'use strict';
    const { make } = window.mt.dom;
    const { paint, drawing } = window.mt;

    const PERIOD = 2000; // milliseconds that one swing of any mode takes
    const REST = { mode: null, position: null, displacement: 0 };
    const AMPLITUDE = 0.08; // of the motion at first, in sizes of the scene
    const MANY = 300;    // bodies: of more than these only the lowest mode is made room for
    const FAR = 0.1;     // of the size: a joint that far from its body is worth a look

    const still = () => window.matchMedia('(prefers-reduced-motion: reduce)').matches;

    // Time and size of the motion. It stands still where people asked for that, and at the
    // quarter of a swing, where a mode is seen best.
    function makeClock() {
        const listeners = [];
        const clock = { playing: false, amplitude: AMPLITUDE, phase: Math.PI / 2 };
        let last = null;
        const tell = () => listeners.forEach((listener) => listener(clock));

        function tick(now) {
            if (!clock.playing) {
                return;
            }
            clock.phase += last === null ? 0 : 2 * Math.PI * Math.min(now - last, 100) / PERIOD;
            last = now;
            tell();
            window.requestAnimationFrame(tick);
        }

        clock.listen = (listener) => listeners.push(listener);
        clock.play = function () {
            if (!clock.playing) {
                clock.playing = true;
                last = null;
                window.requestAnimationFrame(tick);
                tell();
            }
        };
        clock.pause = function () {
            clock.playing = false;
            clock.phase = Math.PI / 2;
            tell();
        };
        clock.setAmplitude = function (amplitude) {
            clock.amplitude = amplitude;
            tell();
        };
        clock.startUnlessStill = () => (still() ? tell() : clock.play());
        clock.value = () => clock.amplitude * Math.sin(clock.phase);
        return clock;
    }

    function makeTip(figure) {
        const tip = make('div', { class: 'tip', role: 'status', '.hidden': true });
        figure.append(tip);
        return function (found, x, y, width) {
            tip.hidden = !found;
            if (!found) {
                return;
            }
            tip.replaceChildren(...found.text
                .map((line, k) => make(k === 0 ? 'b' : 'span', {}, line)));
            const left = Math.max(0, Math.min(x + 14, width - tip.offsetWidth - 4));
            tip.style.left = left + 'px';
            tip.style.top = y + 14 + 'px';
        };
    }

    function view3d(container, scene, options) {
        const given = options || {};
        const camera = given.camera || window.mt.camera(scene);
        const clock = given.clock || makeClock();
        const state = { design: given.design || 0, configuration: given.configuration || 0,
            mode: null, position: null };
        const canvas = make('canvas', { tabindex: 0, role: 'application',
            'aria-roledescription': 'view of a mechanism',
            'aria-keyshortcuts': 'ArrowLeft ArrowRight ArrowUp ArrowDown + - 0 x y z' });
        const caption = make('figcaption', {}, given.caption || '');
        const trouble = make('p', { class: 'trouble', '.hidden': true });
        const figure = make('figure', { class: 'view3d' }, canvas, caption, trouble);
        const tip = makeTip(figure);
        const view = { camera, clock, figure, canvas };
        let drawn = { items: [], finds: [] };
        let size = { width: 0, height: 0 };
        let asked = false;

        const design = () => scene.designs[state.design];
        const configuration = () => design().configurations[state.configuration];
        const lens = () => camera.lens(size.width, size.height);

        function moved() {
            const here = configuration();
            const mode = state.position === null && here.modes[state.mode] ? state.mode : null;
            return { mode, position: state.position, displacement: clock.value() * scene.size };
        }

        function compose() {
            const here = configuration();
            const through = lens();
            const now = moved();
            const posed = window.mt.pose(here, now);
            const made = drawing.make(here, posed, through, { size: scene.size,
                symbol: Math.max(0.8, Math.min(1.3, size.width / 600)),
                isFar: (joint) => joint.distance > FAR * scene.size });
            if (now.mode !== null || now.position !== null) {
                const rest = window.mt.pose(here, REST);
                made.items.push(...drawing.ghost(rest, through, scene.size));
            }
            made.items.push(...drawing.furniture(scene, posed.rotors, through, size));
            return made;
        }

        function draw() {
            asked = false;
            if (size.width === 0) {
                return;
            }
            const ratio = window.devicePixelRatio || 1;
            const context = canvas.getContext('2d');
            context.setTransform(ratio, 0, 0, ratio, 0, 0);
            context.clearRect(0, 0, size.width, size.height);
            drawn = compose();
            const colours = view.printing ? paint.LIGHT : paint.palette(figure);
            paint.toCanvas(context, drawn.items, colours);
        }

        function redraw() {
            if (!asked) {
                asked = true;
                window.requestAnimationFrame(draw);
            }
        }

        function resize() {
            const ratio = window.devicePixelRatio || 1;
            const width = canvas.clientWidth;
            const height = canvas.clientHeight;
            if (width === 0 || (width === size.width && height === size.height)) {
                return;
            }
            size = { width, height };
            canvas.width = Math.round(ratio * width);
            canvas.height = Math.round(ratio * height);
            draw();
        }

        // What the camera is to show: the configuration as drawn, where its modes take it, and
        // its drive.
        function cover() {
            const here = configuration();
            const states = [REST];
            (here.drive ? here.drive.positions : []).forEach((at, position) =>
                at.poses && states.push({ ...REST, position }));
            here.modes.map((mode, k) => k).filter((k) => here.modes[k].mode > 0)
                .slice(0, here.bodies.length > MANY ? 1 : Infinity)
                .forEach((mode) => [AMPLITUDE, -AMPLITUDE].forEach((amplitude) =>
                    states.push({ ...REST, mode, displacement: amplitude * scene.size })));
            camera.cover(view, states.flatMap((state) =>
                window.mt.poseExtent(window.mt.pose(here, state))));
        }

        function update() {
            const here = configuration();
            const position = here.drive && here.drive.positions[state.position];
            const error = here.error || (position && position.error);
            trouble.textContent = error || '';
            trouble.hidden = !error;
            canvas.setAttribute('aria-label', `${scene.model}, ${design().label}, `
                + `configuration ${here.name}; drag or arrow keys turn it, `
                + 'plus and minus zoom, 0 fits, x, y and z look along an axis');
            redraw();
        }

        view.setDesign = function (i) {
            state.design = i;
            cover();
            update();
        };
        view.setConfiguration = function (i) {
            state.configuration = i;
            state.mode = null;
            state.position = null;
            cover();
            update();
        };
        view.setMode = function (j) {
            state.mode = j;
            update();
        };
        view.setDrive = function (k) {
            state.position = k;
            update();
        };
        view.setCaption = function (text) {
            caption.textContent = text;
        };
        view.configuration = configuration;
        view.play = clock.play;
        view.pause = clock.pause;
        view.setAmplitude = clock.setAmplitude;
        const name = () => `${scene.model} ${design().label} ${configuration().name}`;
        view.savePng = () => paint.savePng(compose().items, size.width, size.height, name());
        view.saveSvg = () => paint.saveSvg(compose().items, size.width, size.height, name());
        view.svg = () => paint.toSvg(compose().items, paint.LIGHT, size.width, size.height);

        canvas.addEventListener('pointermove', (event) => {
            const at = canvas.getBoundingClientRect();
            const x = event.clientX - at.left;
            const y = event.clientY - at.top;
            tip(event.buttons === 0 ? drawing.pick(drawn.finds, x, y) : null, x, y, size.width);
        });
        canvas.addEventListener('pointerleave', () => tip(null));
        window.mt.cameraAttach(canvas, camera, lens);
        camera.listen(redraw);
        clock.listen(redraw);
        window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
        window.addEventListener('beforeprint', () => {
            view.printing = true;
            draw();
        });
        window.addEventListener('afterprint', () => {
            view.printing = false;
            redraw();
        });
        container.append(figure);
        new window.ResizeObserver(resize).observe(canvas);
        cover();
        if (!given.camera) {
            camera.home();
        }
        update();
        return view;
    }

    // Buttons for views that share a camera and a clock.
    function controls(views) {
        const { camera, clock } = views[0];
        const button = (text, label, click) =>
            make('button', { type: 'button', 'aria-label': label, title: label, click }, text);
        const play = button('Play', 'start or stop the motion',
            () => (clock.playing ? clock.pause() : clock.play()));
        clock.listen(() => {
            play.textContent = clock.playing ? 'Pause' : 'Play';
        });
        const amplitude = make('input', { type: 'range', min: 0, max: 0.3, step: 0.01,
            value: clock.amplitude, 'aria-label': 'amplitude of the motion',
            input: (event) => clock.setAmplitude(Number(event.target.value)) });
        const perspective = make('input', { type: 'checkbox',
            change: (event) => camera.setPerspective(event.target.checked) });
        const all = (method) => () => views.filter((view) => !view.figure.hidden)
            .forEach((view) => view[method]());
        const along = ['x', 'y', 'z'].map((axis, k) =>
            button(axis, 'look along ' + axis, () => camera.lookAlong(k)));
        return make('div', { class: 'controls', role: 'toolbar', 'aria-label': 'view' },
            play, make('label', {}, 'amplitude ', amplitude),
            button('Fit', 'fit all into the view', () => camera.fit()),
            button('Home', 'the view as it was at first', () => camera.home()), along,
            make('label', {}, perspective, ' perspective'),
            button('Save PNG', 'save the picture as PNG', all('savePng')),
            button('Save SVG', 'save the picture as SVG', all('saveSvg')));
    }

    window.mt.view3d = view3d;
    window.mt.clock = makeClock;
    window.mt.viewControls = controls;
    window.mt.farShare = FAR;
})();
