# SPDX-License-Identifier: GPL-3.0-or-later
"""
The Python package upon the shared library of this build; with MODETUNE_INSTALLED=1 as it is
installed for the interpreter that runs this (tests/install/packages.sh), where NumPy may be missing.
"""
import base64
import copy
import hashlib
import html.parser
import importlib.util
import io
import json
import locale
import math
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import types
import unittest
import warnings
from pathlib import Path
from unittest import mock

SOURCE = Path(os.environ["SOURCE_DIR"])
PACKAGE = SOURCE / "src/library/python"
if "MODETUNE_INSTALLED" not in os.environ:
    os.environ["MODETUNE_LIBRARY"] = str(Path(os.environ["BUILD_DIR"]) / "libmodetune.so")
    sys.path.insert(0, str(PACKAGE))
    needed = subprocess.run(["readelf", "-d", os.environ["MODETUNE_LIBRARY"]], check=True,
                            capture_output=True, text=True).stdout
    asan = re.search(r"\[(lib(?:asan|clang_rt\.asan)\S*\.so\S*)\]", needed)
    if asan and "LD_PRELOAD" not in os.environ:  # it has to come first; leaks are Python's
        asan = subprocess.run([os.environ["CC"], f"-print-file-name={asan[1]}"], check=True, capture_output=True, text=True).stdout.strip()
        os.execve(sys.executable, [sys.executable, "-B", *sys.argv],
                  dict(os.environ, LD_PRELOAD=asan, ASAN_OPTIONS="detect_leaks=0"))

import modetune  # noqa: E402
from modetune import _library, _progress  # noqa: E402

HAS_NUMPY = importlib.util.find_spec("numpy") is not None
TUNING = SOURCE / "studies/inceptor_tuning_1.json"
LONG = SOURCE / "studies/inceptor_rotor.json"  # seconds
TOLD = SOURCE / "studies/beam_identification.json"  # long enough for the progress to be told
G, LENGTH, WIDTH = 9.81, 1.0, 0.05


def pendulum_hz(length, g=G):
    return math.sqrt(g * length / 2 / (length**2 / 3 + WIDTH**2 / 12)) / (2 * math.pi)


def pendulum():
    return json.loads((SOURCE / "tests/models/pendulum.json").read_text(encoding="utf-8"))


def question():
    study = json.loads(TUNING.read_text(encoding="utf-8"))
    return study, {study["model"]: json.loads((TUNING.parent / study["model"]).read_text(encoding="utf-8"))}


def without_numpy():
    return mock.patch.dict(sys.modules, {"numpy": None})


class Solve(unittest.TestCase):
    def test_dict_and_file_have_the_answer_of_the_program(self):
        study, files = question()
        by_dict = modetune.solve(study, files=files, workers=2)
        by_path = modetune.solve(TUNING, workers=1)
        self.assertEqual(by_dict["status"], "solved")
        for part in ("recommendations", "baseline", "published", "doubts"):
            self.assertEqual(by_dict[part], by_path[part])
        said = subprocess.run([os.environ["MODETUNE"], "run", "--format", "json", "-o", tempfile.mkdtemp(), TUNING],
                              check=True, capture_output=True, text=True).stdout
        self.assertEqual(json.loads(said)["recommendations"], by_path["recommendations"])

    def test_files_are_texts_too(self):
        study, files = question()
        (name, model), = files.items()
        self.assertEqual(modetune.solve(study, files={name: json.dumps(model)})["status"], "solved")

    def test_set_and_seed_are_those_of_changed_files(self):
        study, files = question()
        (name, model), = files.items()
        asked = modetune.solve(study, files=files, set={"k_servo": "2*k_servo", "l_a": 0.03}, seed=7)
        model["parameters"]["k_servo"]["value"] *= 2
        model["parameters"]["l_a"]["value"] = 0.03
        study["search"] = {**study.get("search", {}), "seed": 7}
        self.assertEqual(asked["recommendations"], modetune.solve(study, files=files)["recommendations"])
        self.assertEqual({o["name"] for o in asked["run"]["overrides"]}, {"k_servo", "l_a", "seed"})
        for seed in (-1, 2**31):
            with self.assertRaises(ValueError):
                modetune.solve(study, files=files, seed=seed)

    def test_wrong_study_says_where(self):
        study, files = question()
        study["goals"][0]["mode"] = "first"
        study["variables"][0]["uper"] = 1
        with self.assertRaises(modetune.Error) as caught:
            modetune.solve(study, files=files)
        lines = json.dumps(study, indent=2).split("\n")
        found = {d.pointer: d for d in caught.exception.diagnostics if d.severity == "error"}
        self.assertEqual(set(found), {"/goals/0/mode", "/variables/0"})
        for pointer, word in (("/goals/0/mode", '"first"'), ("/variables/0", '"uper"')):
            place = found[pointer]
            self.assertEqual(place.file, "study.json")
            self.assertTrue(lines[place.line - 1][place.column - 1:].startswith(word), place)
            self.assertIn(f"study.json:{place.line}:{place.column}: error: ", str(caught.exception))
            self.assertIn(place.message, str(caught.exception))
        self.assertEqual(caught.exception.status, "MT_E_INPUT")
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(again), again.diagnostics), (str(caught.exception), caught.exception.diagnostics))

    def test_faults_without_a_place_are_told(self):
        study, files = question()
        for wrong, text in (({"set": {"k_sevro": 1}}, "k_servo"), ({"files": {}}, "inceptor.json")):
            with self.assertRaises(modetune.Error) as caught:
                modetune.solve(study, **{"files": files, **wrong})
            self.assertIn(text, str(caught.exception))
        with self.assertRaises(modetune.Error) as caught:
            modetune.solve(SOURCE / "studies/nothing.json")
        self.assertEqual((caught.exception.status, caught.exception.diagnostics), ("MT_E_SYSTEM", ()))

    def test_text_that_c_would_cut_is_refused(self):
        study, files = question()
        for wrong in ({"set": {"k_servo": "1\0"}}, {"files": {**files, "a\0b": {}}}, {"files": {"a": "{}\0"}}):
            with self.assertRaises(ValueError):
                modetune.solve(study, **{"files": files, **wrong})
        with self.assertRaises(ValueError):
            modetune.solve(f"{TUNING}\0.json")
        with self.assertRaises(ValueError):
            modetune.solve(dict(study, recommendations=math.nan), files=files)

    def test_threads_of_python_have_the_same_answer(self):
        answers = []
        threads = [threading.Thread(target=lambda: answers.append(modetune.solve(TUNING, workers=2)["recommendations"]))
                   for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(answers, [answers[0]] * 3)

    def test_openblas_has_its_threads_back(self):
        before = _library.lib.openblas_get_num_threads()
        try:
            _library.lib.openblas_set_num_threads(2)
            wanted = _library.lib.openblas_get_num_threads()
            with _library.one_thread, _library.one_thread:
                self.assertEqual(_library.lib.openblas_get_num_threads(), 1)
            self.assertEqual(_library.lib.openblas_get_num_threads(), wanted)
        finally:
            _library.lib.openblas_set_num_threads(before)


class Progress(unittest.TestCase):
    def test_function_is_told_in_its_own_thread(self):
        told = []
        modetune.solve(TOLD, workers=1, progress=lambda text: told.append((text, threading.current_thread())))
        self.assertGreater(len(told), 0)
        for text, thread in told:
            self.assertRegex(text, r"designs")
            self.assertIs(thread, threading.current_thread())

    def test_exception_of_it_ends_the_search(self):
        def refuse(text):
            raise KeyError(text)

        with self.assertRaises(KeyError):
            modetune.solve(TOLD, workers=2, progress=refuse)
        self.assertEqual(threading.active_count(), 1)

    def test_locale_changes_no_byte(self):
        def without_times(answer):
            told = {k: v for k, v in answer.items() if k != "timing"}
            return json.dumps(told), re.sub(r"[0-9.]+ s\b", "", modetune.report(answer).html)

        plain = without_times(modetune.solve(TUNING, progress=False))
        changed = 0
        try:
            for name in ("de_DE.UTF-8", "tr_TR.UTF-8", "ps_AF.UTF-8"):
                try:
                    locale.setlocale(locale.LC_ALL, name)
                except locale.Error:
                    continue  # installed packages are tried where nobody made them
                with self.subTest(locale=name):
                    self.assertEqual(without_times(modetune.solve(TUNING, progress=False)), plain)
                    changed += locale.localeconv()["decimal_point"] != "."
                    with self.assertRaisesRegex(modetune.Error, "No such file or directory"):
                        modetune.solve("nowhere.json", progress=False)
        finally:
            locale.setlocale(locale.LC_ALL, "C")
        self.assertTrue(changed > 0 or "MODETUNE_INSTALLED" in os.environ)

    def test_interrupt_ends_the_search(self):
        # in the background of a shell it is ignored, and that is handed on
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        main = threading.main_thread().ident
        timer = threading.Timer(0.2, signal.pthread_kill, (main, signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            modetune.solve(LONG, workers=1)
            self.fail("the search went on to its end")
        timer.join()
        self.assertEqual(threading.active_count(), 1)

    def test_interrupt_at_the_start_ends_the_search(self):
        wait, armed = threading.Event.wait, []

        def interrupted(event, timeout=None):  # where start() waits that its thread begins: what SIGINT raises there
            if armed and threading.current_thread() is threading.main_thread() and sys._getframe(1).f_code.co_name == armed[0]:
                armed.pop()
                raise KeyboardInterrupt
            return wait(event, timeout)

        with mock.patch.object(threading.Event, "wait", interrupted):
            for place in ("start", "start", "_is_over"):  # the last: again, while the end is waited for
                armed[:] = [place]
                with self.assertRaises(KeyboardInterrupt):
                    modetune.solve(LONG, workers=1, progress=self.interrupt if place == "_is_over" else False)
                self.assertEqual((armed, threading.active_count()), ([], 1), place)

    @staticmethod
    def interrupt(text):
        raise KeyboardInterrupt

    def test_interrupt_before_the_thread_is_there_waits_for_nobody(self):
        began = []
        with mock.patch.object(threading.Thread, "start", lambda thread: began.append(thread) or self.interrupt("")), \
                mock.patch.object(modetune, "MOST_START_S", 0.01), self.assertRaises(KeyboardInterrupt):
            modetune.solve(LONG, workers=1)
        with mock.patch.object(_library.lib, "mt_study_read", None):  # one that comes late leaves C alone
            began[0].run()
        self.assertEqual(threading.active_count(), 1)

    def test_interrupts_at_any_moment_leave_nothing(self):
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        code = """if 1:
            import os, random, signal, sys, threading, time
            import modetune
            draw = random.Random(int(sys.argv[1]))
            for _ in range(int(sys.argv[2])):
                timer = threading.Timer(10 ** draw.uniform(-4.5, -0.7), os.kill, (os.getpid(), signal.SIGINT))
                try:
                    timer.start()
                    modetune.solve(sys.argv[3], workers=1, progress=False)
                    timer.join()
                    time.sleep(1e-3)
                except KeyboardInterrupt:
                    pass
                timer.join()
                assert [t.name for t in threading.enumerate()] == ["MainThread"], threading.enumerate()
            """
        count = "300" if os.environ.get("MT_EVERY", "0") == "1" else "20"
        paths = os.pathsep.join(sys.path)
        done = subprocess.run([sys.executable, "-B", "-c", code, "7", count, LONG], env=dict(os.environ, PYTHONPATH=paths),
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_line_is_written_over_and_emptied(self):
        with mock.patch("sys.stderr", io.StringIO()) as said:
            line = _progress.teller(True)
            line.show("a long text")
            line.show("short")
            line.close()
        self.assertEqual(said.getvalue(), "\ra long text\rshort      \r" + " " * 5 + "\r")

    def test_nobody_is_told_who_is_no_terminal(self):
        with mock.patch("sys.stderr", io.StringIO()) as said:
            for wish in (None, False):
                shown = _progress.teller(wish)
                shown.show("text")
                shown.close()
        self.assertEqual(said.getvalue(), "")

    def test_cell_of_a_notebook_is_replaced_and_emptied(self):
        said = []
        handle = types.SimpleNamespace(update=lambda content, raw: said.append(("again", content, raw)))

        def display(content, raw, display_id):
            said.append(("first", content, raw and display_id))
            return handle

        kernel = types.ModuleType("IPython")
        kernel.get_ipython = lambda: types.SimpleNamespace(kernel=object())
        shown = types.ModuleType("IPython.display")
        shown.display = display
        with mock.patch.dict(sys.modules, {"IPython": kernel, "IPython.display": shown}):
            cell = _progress.teller(None)
            cell.show("a")
            cell.show("b")
            cell.close()
            self.assertIs(type(_progress.teller(False)), _progress.Silent)
        self.assertEqual(said, [("first", {"text/plain": "a"}, True), ("again", {"text/plain": "b"}, True),
                                ("again", {"text/plain": ""}, True)])


class Modes(unittest.TestCase):
    def check_pendulum(self, found):
        self.assertEqual(found["configuration"], "hanging")
        self.assertAlmostEqual(found["hz"][0], pendulum_hz(LENGTH), delta=1e-12)
        self.assertTrue(0 <= found["error_hz"][0] < 1e-12)
        self.assertEqual([len(found["hz"]), found["multiplicity"], found["rigid_body_modes"]], [1, [1], 0])
        self.assertEqual((found["unstable_modes"], found["undecided_modes"]), (0, 0))
        h = 1e-6  # central differences of the closed form
        slope = dict(zip(found["parameters"], found["hz_per_unit"][0]))
        self.assertAlmostEqual(slope["L"], (pendulum_hz(1 + h) - pendulum_hz(1 - h)) / (2 * h), delta=1e-8)
        self.assertAlmostEqual(slope["g"], pendulum_hz(LENGTH) / G / 2, delta=1e-12)
        self.assertAlmostEqual(slope["m"], 0.0, delta=1e-12)
        self.assertEqual(dict(zip(found["parameters"], found["units"]))["L"], "m")
        self.assertEqual(dict(zip(found["parameters"], found["values"]))["L"], LENGTH)
        self.assertEqual(len(found["shapes"][0]), len(found["channels"]))

    def test_pendulum_is_its_closed_form_in_lists(self):
        with without_numpy():
            found = modetune.modes(pendulum(), "hanging")
        self.check_pendulum(found)
        for name in ("hz", "error_hz", "values", "shapes", "hz_per_unit"):
            self.assertIs(type(found[name]), list)

    def test_arrays_are_of_numpy_where_it_is(self):
        found = modetune.modes(SOURCE / "tests/models/pendulum.json", "hanging")
        self.check_pendulum(found)
        with without_numpy():
            lists = modetune.modes(pendulum(), "hanging")
        for name in ("hz", "error_hz", "values", "shapes", "hz_per_unit"):
            if HAS_NUMPY:
                import numpy
                self.assertIs(type(found[name]), numpy.ndarray)
                self.assertEqual(found[name].dtype, float)
                self.assertEqual(found[name].tolist(), lists[name])
            else:
                self.assertEqual(found[name], lists[name])

    def test_matrices_have_a_row_for_each_mode(self):
        found = modetune.modes(SOURCE / "problems/inceptor.json", "installed", parameters=["K_T1", "m_s"])
        count = len(found["hz"])
        self.assertGreater(count, 1)
        self.assertEqual([len(found[name]) for name in ("shapes", "hz_per_unit", "multiplicity")], [count] * 3)
        self.assertTrue(all(len(row) == len(found["channels"]) > 0 for row in found["shapes"]))
        h = 1e-4
        for p, (name, value) in enumerate(zip(found["parameters"], found["values"])):
            more, less = (modetune.modes(SOURCE / "problems/inceptor.json", "installed",
                                         {name: value * (1 + s)})["hz"] for s in (h, -h))
            for mode in range(count):
                slope = (more[mode] - less[mode]) / (2 * h * value)
                self.assertAlmostEqual(found["hz_per_unit"][mode][p] * value, slope * value,
                                       delta=1e-6 * found["hz"][mode])

    def test_parameters_that_follow_others_are_taken_by_name_only(self):
        model = pendulum()
        model["parameters"]["L2"] = {"value": "2*L"}
        self.assertEqual(modetune.modes(model, "hanging")["parameters"], list(pendulum()["parameters"]))
        found = modetune.modes(model, "hanging", parameters=["L2"])
        self.assertEqual((found["parameters"], found["units"], list(found["values"])), (["L2"], [None], [2.0]))
        self.assertEqual(len(modetune.modes(model, "hanging", parameters=[])["hz_per_unit"][0]), 0)

    def test_set_takes_numbers_and_expressions(self):
        for value in (4, 4.0, "4*L"):
            found = modetune.modes(pendulum(), "hanging", {"L": value})
            self.assertAlmostEqual(found["hz"][0], pendulum_hz(4), delta=1e-12)

    def test_no_mode_is_listed_beside_an_unstable_one(self):
        found = modetune.modes(pendulum(), "hanging", set={"g": "-g"})
        self.assertEqual((len(found["hz"]), len(found["shapes"]), len(found["hz_per_unit"])), (0, 0, 0))
        self.assertEqual(found["unstable_modes"], 1)

    def test_rigid_body_modes_are_counted(self):
        model = pendulum()
        model.update(joints=[], configurations={"hanging": {}})
        self.assertEqual(modetune.modes(model, "hanging", set={"g": 0})["rigid_body_modes"], 3)

    def test_one_of_several_configurations_is_asked_for(self):
        with self.assertRaisesRegex(modetune.Error, r'the model has 4 configurations: say which \("hanging", "upside_down", '):
            modetune.modes(pendulum())
        self.assertEqual(modetune.modes(SOURCE / "problems/three_masses.json")["configuration"], "default")

    def test_names_are_those_of_the_interface(self):
        self.assertEqual([name for name in dir(modetune) if not name.startswith("__")], sorted(modetune.__all__))
        self.assertIn("__version__", dir(modetune))

    def test_wrong_names_are_told(self):
        for wrong in ({"configuration": "hangin"}, {"parameters": ["LL"]}, {"set": {"LL": 1}}):
            with self.assertRaises(modetune.Error) as caught:
                modetune.modes(pendulum(), **{"configuration": "hanging", **wrong})
            self.assertRegex(str(caught.exception), '"(hangin|LL)"')

    def test_doubts_are_warnings(self):
        model = pendulum()
        model["configurations"]["hanging"]["parameters"] = {"L": 2}
        with self.assertWarnsRegex(modetune.Doubt, r"^model\.json:\d+:\d+: warning: /conf.*changes nothing"):
            modetune.modes(model, "hanging", set={"L": 3})
        model["configurations"]["other"] = {}
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            modetune.modes(pendulum(), "hanging")
            modetune.modes(model, "other", set={"L": 3})  # the doubt is not about this one

    @unittest.skipUnless(HAS_NUMPY or "MODETUNE_INSTALLED" not in os.environ, "there is no NumPy here to give values of")
    def test_values_of_numpy_are_numbers(self):
        import numpy
        model = pendulum()
        model["parameters"]["L"]["value"] = numpy.float32(2)
        model["dimension"] = numpy.int64(2)
        model["gravity_m_per_s2"] = numpy.array([0, -G])
        self.assertAlmostEqual(modetune.modes(model, "hanging")["hz"][0], pendulum_hz(2), delta=1e-12)
        with self.assertRaises(TypeError):
            modetune.modes(dict(pendulum(), name=object()), "hanging")


class Frames(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags = []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))


class Page(unittest.TestCase):
    def test_page_is_the_programs_and_is_saved(self):
        page = modetune.report(modetune.solve(TUNING))
        self.assertTrue(page.html.startswith("<!DOCTYPE html>"))
        self.assertIn(json.loads(TUNING.read_text(encoding="utf-8"))["name"], page.html)
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([os.environ["MODETUNE"], "run", "--quiet", "-o", folder, TUNING], check=True, capture_output=True)
            (written,) = Path(folder).glob("*/result.json")
            alone = Path(folder) / "alone"  # where the model is not found: a page without the mechanism
            alone.mkdir()
            (alone / "result.json").write_bytes(written.read_bytes())
            told = subprocess.run([os.environ["MODETUNE"], "report", "--format", "html", alone / "result.json"], check=True, capture_output=True,
                                  cwd=alone, text=True).stdout
            self.assertEqual(modetune.report(json.loads(written.read_text(encoding="utf-8"))).html, told)
            # where it is found, or given, the page of `run`
            model = SOURCE / "problems" / Path(json.loads(TUNING.read_text(encoding="utf-8"))["model"]).name
            whole = written.with_name("report.html").read_text(encoding="utf-8")
            self.assertIn('id="scene"', whole)
            self.assertEqual(modetune.report(written).html, whole)
            for given in (model, json.loads(model.read_text(encoding="utf-8"))):
                self.assertEqual(modetune.report(alone / "result.json", given).html, whole)
            # what has changed since is not taken unasked, and what does not fit not shown
            other = Path(folder) / "problems" / model.name
            other.parent.mkdir()
            other.write_text(model.read_text(encoding="utf-8") + " ", encoding="utf-8")
            self.assertEqual(modetune.report(alone / "result.json").html, told)
            self.assertEqual(modetune.report(alone / "result.json", SOURCE / "problems/six_masses.json").html, told)
            to = page.save(Path(folder) / "page.html")
            self.assertEqual(to.read_text(encoding="utf-8"), page.html)

    def test_a_model_that_is_no_file_is_not_read(self):
        result = modetune.solve(TUNING, progress=False)
        with tempfile.TemporaryDirectory() as folder:
            alone = Path(folder) / "result.json"
            os.mkfifo(Path(folder) / "fifo")
            (Path(folder) / "link").symlink_to("/dev/zero")
            os.mkfifo(Path(folder) / "timing.json")
            without = modetune.report(result).html
            name = result["model"]["file"]
            for model in ("fifo", "link", str(Path(folder) / "fifo"), "/dev/zero", folder, "/proc/self/mem"):
                changed = copy.deepcopy(result)
                changed["model"]["file"] = model
                for one in changed["run"]["inputs"]:
                    one["file"] = model if one["file"] == name else one["file"]
                alone.write_text(json.dumps(changed), encoding="utf-8")
                page = modetune.report(alone).html
                self.assertEqual('id="scene"' in page, 'id="scene"' in without, model)
            for path in (Path(folder) / "fifo", "/dev/zero", folder):
                with self.assertRaises(modetune.Error):
                    modetune.report(path)

    def test_frame_has_the_page_and_no_other_tag(self):
        study, files = question()
        study["name"] = "\"><script>alert('x')</script>&amp;"
        page = modetune.report(modetune.solve(study, files=files))
        frames = Frames()
        frames.feed(page._repr_html_())
        self.assertEqual([tag for tag, _ in frames.tags], ["iframe"])
        self.assertEqual(frames.tags[0][1]["srcdoc"], page.html)
        self.assertEqual(frames.tags[0][1]["sandbox"].split(), ["allow-scripts", "allow-downloads"])
        # in the frame the name is text: data and program are all the scripts, and the policy knows the program
        inside = Frames()
        inside.feed(page.html)
        scripts = [attributes for tag, attributes in inside.tags if tag == "script"]
        self.assertEqual([a.get("type") for a in scripts if a.get("type") != "application/json"], [None])
        self.assertNotIn("<script>alert", page.html)
        (policy,) = [a["content"] for tag, a in inside.tags
                     if tag == "meta" and a.get("http-equiv") == "Content-Security-Policy"]
        program = re.search(r"<script>(.*?)</script>", page.html, re.S).group(1)
        digest = base64.b64encode(hashlib.sha256(program.encode()).digest()).decode()
        self.assertIn(f"script-src 'sha256-{digest}'", policy)
        self.assertNotIn("unsafe", policy)

    def test_what_is_no_result_is_refused_with_its_place(self):
        result = modetune.solve(TUNING)
        wrong = copy.deepcopy(result)
        wrong["recommendations"][0]["rank"] = "one"
        with self.assertRaises(modetune.Error) as caught:
            modetune.report(wrong)
        self.assertEqual([d.pointer for d in caught.exception.diagnostics], ["/recommendations/0/rank"])


class Declarations(unittest.TestCase):
    """What is written twice, in C and for ctypes, is the same."""

    def setUp(self):
        headers = "".join(p.read_text(encoding="utf-8") for p in sorted((SOURCE / "include/modetune").glob("*.h")))
        self.headers = re.sub(r"/\*.*?\*/", " ", headers, flags=re.S)

    def test_structs_have_the_members_of_c(self):
        for name, struct in (("mt_read_options", _library.ReadOptions), ("mt_solve_options", _library.SolveOptions),
                             ("mt_file_text", _library.FileText), ("mt_err", _library.ErrStruct)):
            body = re.search(rf"typedef struct {name} {{(.*?)}} {name};", self.headers, re.S).group(1)
            members = [re.search(r"\(\*(\w+)\)|(\w+)(?:\[\w+\])?$", part.strip()) for part in body.split(";")[:-1]]
            self.assertEqual([m.group(1) or m.group(2) for m in members], [field for field, *_ in struct._fields_], name)

    def test_functions_have_the_arguments_of_c(self):
        for name, (result, *arguments) in _library.FUNCTIONS.items():
            found = re.search(rf"MT_API ([^;]*?)\b{name}\(([^;]*)\)", self.headers)
            self.assertIsNotNone(found, name)
            given = [] if found.group(2) == "void" else found.group(2).split(",")
            self.assertEqual(len(given), len(arguments), name)
            for text, kind in zip(given, arguments):
                self.assertEqual("*" in text, kind not in (_library.c_int, _library.c_double), f"{name}: {text}")
            kind = re.sub(r"\s+", " ", found.group(1)).strip()
            self.assertEqual({"void": None, "int": _library.c_int, "double": _library.c_double}.get(
                kind, _library.c_char_p if "*" in kind else _library.c_int), result, name)

    def test_version_is_that_of_the_header(self):
        self.assertEqual(modetune.__version__, re.search(r'MT_VERSION_STRING "(.*)"', self.headers).group(1))

    def test_files_keep_to_the_rules(self):
        files = sorted(PACKAGE.rglob("*.py"))
        self.assertGreater(len(files), 3)
        for path in files:
            lines = path.read_text(encoding="utf-8").split("\n")
            if path.name != "types.py":  # which is written from the schemas
                self.assertLess(len(lines), 600, path)
            self.assertLessEqual(max(map(len, lines)), 96, path)
            self.assertIn("# SPDX-License-Identifier: GPL-3.0-or-later", lines[:2], path)
            compile("\n".join(lines), str(path), "exec")


if __name__ == "__main__":
    unittest.main()
