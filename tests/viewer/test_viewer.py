#!/usr/bin/env python3
"""Opens viewer.html of a small drive in headless Chromium, uses it as a person would, and looks at the pixels.

    test_viewer.py DCEM_PROGRAM [FOLDER_FOR_SCREENSHOTS]

Exits with 77 (skipped) where Chromium is not installed, or the program has no viewer.
"""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

from devtools import Browser, find_chromium

PROGRAM = None
SHOTS = None
COLOURS = {"line of sight": "#0072B2", "reflected": "#E69F00", "transmitted": "#009E73", "diffracted": "#CC79A7",
           "diffuse": "#56B4E9"}
HOSTILE = "<img src=x onerror=document.title=1>"  # an id that would be an element if it were taken for markup


def quad(vertices, faces, *corners):
    first = len(vertices) + 1
    vertices += corners
    faces.append(" ".join(str(first + i) for i in range(4)))


def write_case(folder):
    """A street with a wall, a pane of glass and an opaque block: every mechanism occurs."""
    vertices, groups = [], {"ground": [], "wall": [], "glass": [], "block": []}
    quad(vertices, groups["ground"], (-50, -40, 0), (50, -40, 0), (50, 40, 0), (-50, 40, 0))
    quad(vertices, groups["wall"], (-50, 30, 0), (50, 30, 0), (50, 30, 12), (-50, 30, 12))
    quad(vertices, groups["glass"], (-10, -15, 0), (10, -15, 0), (10, -15, 9), (-10, -15, 9))
    x0, x1, y0, y1, z = 15, 25, -5, 5, 7
    quad(vertices, groups["block"], (x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z))
    for a, b in [((x0, y0), (x1, y0)), ((x1, y0), (x1, y1)), ((x1, y1), (x0, y1)), ((x0, y1), (x0, y0))]:
        quad(vertices, groups["block"], (*a, 0), (*b, 0), (*b, z), (*a, z))
    lines = ["v {} {} {}".format(*vertex) for vertex in vertices]
    for name, faces in groups.items():
        lines += [f"usemtl {name}", *(f"f {face}" for face in faces)]
    (folder / "street.obj").write_text("\n".join(lines) + "\n")
    isotropic = {"pattern": "isotropic", "polarization": "V"}
    scenario = {
        "format": "dcem-scenario/1", "scene": {"obj": "street.obj"}, "frequency_hz": 28e9,
        "materials": {"ground": {"model": "dielectric", "relative_permittivity": 5, "conductivity_s_per_m": 0.1, "scattering": 0.5,
                                 "scattering_pattern": "lambertian"},
                      "wall": {"model": "constant", "reflection": 0.8},
                      "block": {"model": "constant", "reflection": 0.7},
                      "glass": {"model": "constant", "reflection": 0.5, "penetration_loss_db": 5},
                      "metal": {"model": "pec"}},
        "time": {"start_s": 0, "step_s": 0.1, "frames": 40},
        "objects": [{"id": "van", "box_m": [8, 5, 4], "material": "metal",
                     "motion": {"position_m": [-40, 15, 0], "yaw_deg": 0, "velocity_mps": [15, 0, 0]}}],
        "transmitters": [{"id": "mast", "position_m": [0, 0, 6], "power_dbm": 30, "antenna": isotropic}],
        "receivers": [{"id": "behind glass", "position_m": [2, -28, 2], "antenna": isotropic},
                      {"id": "behind block", "position_m": [33, 1, 2], "antenna": isotropic},
                      {"id": HOSTILE, "position_m": [-25, -12, 3], "antenna": isotropic}],
        "propagation": {"max_reflections": 1, "max_transmissions": 1, "max_diffractions": 1, "discovery": "exact",
                        "diffuse": {"enabled": True, "list_paths": True, "tolerance_db": 3}},
        "output": {"html": True, "paths": True, "links": True}}
    (folder / "street.json").write_text(json.dumps(scenario))


class ViewerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        write_case(cls.folder)
        subprocess.run([PROGRAM, "run", cls.folder / "street.json", "-o", cls.folder / "out", "--quiet"], check=True)
        cls.browser = Browser(1280, 820)
        cls.seconds = cls.browser.open(cls.folder / "out" / "viewer.html")
        with (cls.folder / "out" / "paths.jsonl").open() as lines:
            cls.links = [json.loads(line) for line in lines]

    @classmethod
    def tearDownClass(cls):
        if hasattr(cls, "browser"):
            cls.browser.close()
        cls.temporary.cleanup()

    def setUp(self):
        self.page = self.browser
        self.page.evaluate("dcemViewer.play(false); dcemViewer.choose(null); dcemViewer.hiddenLinks.clear();"
                           "dcemViewer.viewDevices(); dcemViewer.seek(0); true")
        self.page.settle()

    def tearDown(self):
        self.assertEqual(self.page.errors, [])

    def view(self, name=None):
        return self.page.screenshot(self.page.bounds("#view"), SHOTS and name and SHOTS / f"{name}.png")

    def page_point(self, point):
        """Where a place of the scene is on the page."""
        return self.page.evaluate(
            f"(() => {{ const c = dcemViewer.head.centre_m, p = {json.dumps(point)};"
            "const at = dcemViewer.project(p.map((v, i) => v - c[i])), b = dcemViewer.canvas.getBoundingClientRect();"
            "return [at.x + b.x, at.y + b.y]; })()")

    def panel(self):
        return self.page.evaluate("document.querySelector('#chosen').innerText")

    def test_the_scene_is_there_and_nothing_came_from_a_network(self):
        picture = self.view("scene")
        counts = picture.counts()
        self.assertGreater(len(counts), 20)
        background = counts.get(bytes.fromhex("f2f4f6"), 0)
        self.assertLess(background, 0.8 * picture.width * picture.height)
        self.assertEqual([url for url in self.page.requests if not url.startswith("file://")], [])
        self.assertEqual(self.page.evaluate("performance.getEntriesByType('resource').length"), 0)

    def test_names_are_text_and_never_markup(self):
        self.assertEqual(self.page.evaluate("document.querySelectorAll('img').length"), 0)
        self.assertEqual(self.page.evaluate("document.title"), "street – DCEM")
        self.assertIn(HOSTILE, self.page.evaluate("document.querySelector('#links').innerText"))

    def test_each_mechanism_has_its_colour_and_vanishes_when_it_is_switched_off(self):
        self.page.evaluate("{ const s = document.querySelector('#strongest'); s.value = s.max;"
                           "s.dispatchEvent(new Event('input')); true }")
        before = self.view("mechanisms").counts()
        for index, (name, colour) in enumerate(COLOURS.items()):
            with self.subTest(name):
                exact = bytes.fromhex(colour[1:])
                self.assertGreater(before.get(exact, 0), 30)
                self.page.click_on(f"#mechanism_{index}")
                self.assertEqual(self.view().counts().get(exact, 0), 0)
                self.page.click_on(f"#mechanism_{index}")
                self.assertEqual(self.view().counts().get(exact, 0), before[exact])

    def test_a_link_that_is_switched_off_takes_its_rays_along(self):
        rays = "dcemViewer.pickable.length"
        before = self.page.evaluate(rays)
        self.page.click_on("#links_none")
        self.assertEqual(self.page.evaluate(rays), 0)
        self.assertEqual(self.view().count(COLOURS["line of sight"], 0), 0)
        self.page.click_on("#links input[data-link='0']")
        one = self.page.evaluate(rays)
        self.assertTrue(0 < one < before)
        self.page.click_on("#links_all")
        self.assertEqual(self.page.evaluate(rays), before)

    def test_the_van_moves_when_the_slider_moves(self):
        def van_row():
            return [row for row in self.view().rows]
        self.page.click_on("#links_none")
        first = van_row()
        box = self.page.bounds("#slider")
        self.page.click(box["x"] + box["width"] - 9, box["y"] + box["height"] / 2)
        self.assertEqual(self.page.evaluate("dcemViewer.frame"), 39)
        self.assertIn("frame 39 of 0 to 39, t = 3.900 s", self.page.evaluate("document.querySelector('#instant').innerText"))
        self.assertEqual(self.page.evaluate("dcemViewer.surfaces.objects[1].position.x + dcemViewer.head.centre_m[0]"),
                         -40 + 15 * 3.9)
        last = van_row()
        left, top = (round(value) for value in self.page_point([-40, 15, 2]))
        view = self.page.bounds("#view")
        x, y = left - round(view["x"]), top - round(view["y"])
        self.assertNotEqual(first[y][3 * x:3 * x + 3], last[y][3 * x:3 * x + 3])  # where the van stood is ground now

    def test_keys_play_and_step(self):
        self.page.evaluate("document.activeElement.blur()")
        self.page.key("ArrowRight")
        self.assertEqual(self.page.evaluate("dcemViewer.frame"), 1)
        self.page.key("End")
        self.assertEqual(self.page.evaluate("dcemViewer.frame"), 39)
        self.page.key("ArrowLeft")
        self.assertEqual(self.page.evaluate("dcemViewer.frame"), 38)
        self.page.key("Home")
        self.page.key(" ", "Space", " ")
        self.page.wait_for("dcemViewer.frame >= 3")
        self.page.key(" ", "Space", " ")
        self.assertFalse(self.page.evaluate("dcemViewer.playing"))

    def test_a_click_on_a_receiver_shows_its_links_and_their_profile(self):
        self.page.click(*self.page_point([33, 1, 2]))
        text = self.panel()
        self.assertIn("Receiver behind block", text)
        self.assertIn("33.00, 1.00, 2.00 m", text)
        link = next(one for one in self.links if one["rx"] == "behind block" and one["frame"] == 0)
        with (self.folder / "out" / "links.csv").open() as lines:
            header, *rows = [line.strip().split(",") for line in lines]
        row = next(row for row in rows if row[0] == "0" and row[3] == "behind block")
        values = dict(zip(header, row))
        self.assertIn(f"{float(values['power_dbm']):.1f}".replace("-", "−"), text)
        self.assertIn(f"{1e9 * float(values['rms_delay_spread_s']):.1f}", text)
        self.assertIn("mast", text)
        # A bar for each path, in the colour of its mechanism: the diffracted ones are there, line of sight is not.
        self.assertTrue(any("D" in path["kinds"] for path in link["paths"]))
        profile = self.page.screenshot(self.page.bounds("#profile"), SHOTS and SHOTS / "profile.png")
        self.assertGreater(profile.count(COLOURS["diffracted"], 0), 40)
        self.assertEqual(profile.count(COLOURS["line of sight"], 0), 0)
        self.page.screenshot(None, SHOTS and SHOTS / "receiver.png")

    def test_a_click_on_a_transmitter_lists_all_its_receivers(self):
        self.page.click(*self.page_point([0, 0, 6]))
        text = self.panel()
        self.assertIn("Transmitter mast", text)
        self.assertIn("30.00 dBm", text)
        for name in ("behind glass", "behind block", HOSTILE):
            self.assertIn(name, text)

    def test_a_click_on_a_ray_shows_its_numbers(self):
        link = next(one for one in self.links if one["rx"] == HOSTILE and one["frame"] == 0)
        path = next(one for one in link["paths"] if one["kinds"] == "")
        start, stop = self.page_point([0, 0, 6]), self.page_point([-25, -12, 3])
        self.page.click(*(0.4 * a + 0.6 * b for a, b in zip(start, stop)))
        text = self.panel()
        self.assertIn("LOS", text)
        self.assertIn("line of sight", text)
        self.assertIn(f"{math.dist((0, 0, 6), (-25, -12, 3)):.2f} m", text)
        self.assertIn(f"{1e9 * path['delay_s']:.2f} ns", text)
        self.assertIn(f"−{-path['path_gain_db']:.2f} dB", text)
        self.assertIn("Doppler", text)
        self.page.screenshot(None, SHOTS and SHOTS / "ray.png")

    def test_dragging_turns_and_the_wheel_comes_nearer(self):
        before = self.page.evaluate("[dcemViewer.orbit.azimuth, dcemViewer.orbit.distance]")
        box = self.page.bounds("#view")
        x, y = box["x"] + 200, box["y"] + 300
        self.page.mouse("mousePressed", x, y)
        self.page.mouse("mouseMoved", x + 80, y + 10)
        self.page.mouse("mouseReleased", x + 80, y + 10, buttons=0)
        self.page.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-300)
        self.page.settle()
        after = self.page.evaluate("[dcemViewer.orbit.azimuth, dcemViewer.orbit.distance]")
        self.assertLess(after[0], before[0])
        self.assertLess(after[1], before[1])
        self.assertTrue(self.page.evaluate("document.querySelector('#chosen').hidden"))

    def test_two_fingers_come_nearer(self):
        before = self.page.evaluate("dcemViewer.orbit.distance")
        self.page.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        touch = lambda kind, *points: self.page.call(
            "Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])
        touch("touchStart", (300, 300), (400, 300))
        touch("touchMove", (250, 300), (450, 300))
        touch("touchEnd")
        self.page.settle()
        self.page.call("Emulation.setTouchEmulationEnabled", enabled=False)
        self.assertAlmostEqual(self.page.evaluate("dcemViewer.orbit.distance") / before, 0.5, delta=0.1)

    def test_power_has_the_colours_of_its_bar(self):
        self.page.click_on("input[value=power]")
        counts = self.view("power").counts()
        self.assertEqual(counts.get(bytes.fromhex(COLOURS["line of sight"][1:]), 0), 0)
        self.assertIn("dBm", self.page.evaluate("document.querySelector('#power_bar').innerText"))
        self.page.click_on("input[value=mechanism]")
        self.assertGreater(self.view().count(COLOURS["line of sight"], 0), 30)

    def test_it_opens_soon_and_plays_fast(self):
        self.page.evaluate("{ const s = document.querySelector('#strongest'); s.value = 20;"
                           "s.dispatchEvent(new Event('input')); true }")
        rate, processor_s = played(self.page)
        print(f"\nopened in {self.seconds:.2f} s, {playing_text(rate, processor_s)}")
        self.assertLess(self.seconds, 30)  # a few seconds, on a machine with other work as well
        # Drawn in software, 20 frames per second of two processors; how many there are in a second depends on what else
        # runs on the machine, the work of a frame does not.
        self.assertLess(processor_s, 0.1)


class MapTest(unittest.TestCase):
    """The map as ground texture: its colours are those of the CSV, and they go when it is switched off."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        write_case(cls.folder)
        scenario = json.loads((cls.folder / "street.json").read_text())
        scenario["receivers"] = [{"id": "area", "grid": {"origin_m": [-48, -38, 1.5], "spacing_m": [2, 2], "count": [49, 39]}}]
        scenario["propagation"] = {"max_reflections": 1, "max_transmissions": 1, "max_diffractions": 0, "discovery": "exact"}
        scenario["time"]["frames"] = 1
        scenario["output"] = {"html": True, "map": ["csv"]}
        (cls.folder / "area.json").write_text(json.dumps(scenario))
        subprocess.run([PROGRAM, "map", cls.folder / "area.json", "-o", cls.folder / "out", "--quiet"], check=True)
        with (cls.folder / "out" / "map_area_mast.csv").open() as lines:
            cls.points = list(csv.DictReader(lines))
        cls.page = Browser(1280, 820)
        cls.page.open(cls.folder / "out" / "viewer.html")

    @classmethod
    def tearDownClass(cls):
        if hasattr(cls, "page"):
            cls.page.close()
        cls.temporary.cleanup()

    def expected_colours(self):
        """By point: viridis from the 2nd percentile to the maximum, outwards to 5 dB; grey where nothing can stand."""
        steps = self.page.evaluate("dcemViewer.head.viridis")
        powers = sorted(float(point["power_incoherent_dbm"]) for point in self.points if point["power_incoherent_dbm"])
        low, high = 5 * math.floor(powers[int(0.02 * (len(powers) - 1))] / 5), 5 * math.ceil(powers[-1] / 5)
        colours = {}
        for point in self.points:
            place = (float(point["x_m"]), float(point["y_m"]), float(point["z_m"]))
            if point["path_count"] == "":
                colours[place] = (150, 156, 162)
            elif point["power_incoherent_dbm"]:
                share = min(max((float(point["power_incoherent_dbm"]) - low) / (high - low), 0), 1) * (len(steps) - 1)
                below = min(int(share), len(steps) - 2)
                colours[place] = tuple(a + (share - below) * (b - a) for a, b in zip(steps[below], steps[below + 1]))
        return colours

    def colours_seen(self, places, name):
        """The pixel at each place, looking straight down."""
        picture = self.page.screenshot(self.page.bounds("#view"), SHOTS and SHOTS / f"{name}.png")
        pixels = self.page.evaluate(
            f"(() => {{ const c = dcemViewer.head.centre_m; return {json.dumps(places)}.map((p) => {{"
            "const at = dcemViewer.project(p.map((v, i) => v - c[i])); return [at.x, at.y]; }); })()")
        return [tuple(picture.rows[int(y)][picture.channels * int(x):][:3]) for x, y in pixels]

    def choose_map(self, index):
        self.page.evaluate(f"{{ const s = document.querySelector('#map_choice'); s.selectedIndex = {index};"
                           "s.dispatchEvent(new Event('change')); true }")
        self.page.settle()

    def test_the_map_lies_on_the_ground_in_its_colours_until_it_is_switched_off(self):
        self.page.click_on("#view_above")
        colours = self.expected_colours()
        # The symbol of the transmitter and its name hide what is under them.
        places = [place for place in colours if not (-6 < place[0] < 20 and -6 < place[1] < 6)]
        self.assertGreater(len(places), 1000)
        self.assertGreater(sum(colours[place] == (150, 156, 162) for place in places), 5)  # in the van and the block, on the wall
        self.assertGreater(len({tuple(map(round, colours[place])) for place in places}), 100)

        def alike(seen):
            return sum(max(abs(a - b) for a, b in zip(colour, colours[place])) <= 2 for colour, place in zip(seen, places))

        self.assertEqual(self.page.evaluate("document.querySelector('#map_choice').options[0].text"), "mast over area")
        with_map = self.colours_seen(places, "map")
        # Lines of walls and of the van run over some points.
        self.assertGreater(alike(with_map), 0.95 * len(places))
        self.choose_map(1)
        without = self.colours_seen(places, "map_off")
        self.assertEqual(alike(without), 0)
        self.assertLess(len(set(without)), 30)
        self.choose_map(0)
        self.assertEqual(self.colours_seen(places, "map_again"), with_map)
        self.assertEqual(self.page.errors, [])


frames_per_second = """(async () => {
  document.querySelector('#speed').value = '0';
  dcemViewer.seek(0);
  dcemViewer.play(true);
  const drawn = dcemViewer.drawn, start = performance.now();
  await new Promise((done) => setTimeout(done, 3000));
  dcemViewer.play(false);
  document.querySelector('#speed').value = '1';
  return (dcemViewer.drawn - drawn) / (performance.now() - start) * 1000;
})()"""


def played(browser):
    """Frames per second while playing, and processor seconds per frame."""
    before_s, drawn = browser.cpu_seconds(), browser.evaluate("dcemViewer.drawn")
    rate = browser.evaluate(frames_per_second)
    return rate, (browser.cpu_seconds() - before_s) / (browser.evaluate("dcemViewer.drawn") - drawn)


def playing_text(rate, processor_s):
    return f"plays at {rate:.0f} frames per second, {1e3 * processor_s:.0f} ms of processor time per frame"


def measure(path):
    """Prints how long a page takes to open and how fast it plays."""
    with Browser(1280, 820) as browser:
        seconds = browser.open(path)
        size = pathlib.Path(path).stat().st_size / 1e6
        print(f"{path}: {size:.1f} MB, opened in {seconds:.2f} s, {playing_text(*played(browser))}")
        if SHOTS:
            browser.screenshot(None, SHOTS / "measured.png")


if __name__ == "__main__":
    if find_chromium() is None:
        print("skipped: chromium is not installed")
        sys.exit(77)
    if len(sys.argv) > 2:
        SHOTS = pathlib.Path(sys.argv[2]).absolute()
        SHOTS.mkdir(parents=True, exist_ok=True)
    if sys.argv[1].endswith(".html"):
        measure(sys.argv[1])
        sys.exit(0)
    PROGRAM = pathlib.Path(sys.argv[1]).absolute()
    with tempfile.TemporaryDirectory() as empty:
        write_case(pathlib.Path(empty))
        tried = subprocess.run([PROGRAM, "run", pathlib.Path(empty) / "street.json", "--frames", "0:1", "--output", "html",
                                "-o", pathlib.Path(empty) / "out"], capture_output=True, text=True)
    if tried.returncode == 2 and "has no viewer" in tried.stderr:
        print(f"skipped: {tried.stderr.strip()}")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
