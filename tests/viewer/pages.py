"""What the tests of the page share: a small street with every mechanism, a browser with a page, ways to look at it."""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

from devtools import Browser, find_chromium

COLOURS = {"line of sight": "#0072B2", "reflected": "#E69F00", "transmitted": "#009E73", "diffracted": "#CC79A7",
           "diffuse": "#56B4E9"}
HOSTILE = "<img src=x onerror=document.title=1>"  # an id that would be an element if it were taken for markup
ISOTROPIC = {"pattern": "isotropic", "polarization": "V"}
BLOCK = {"x": (15, 25), "y": (-5, 5), "z": (0, 7)}
VAN = {"size_m": (8, 5, 4), "position_m": (-40, 15, 0), "yaw_deg": 20, "velocity_mps": (15, 0, 0)}


class Settings:
    """Given on the command line."""
    program = None
    shots = None


def quad(vertices, faces, *corners):
    first = len(vertices) + 1
    vertices += corners
    faces.append(" ".join(str(first + i) for i in range(4)))


def write_street(folder):
    """A street with a wall, a pane of glass, an opaque block and a van that drives askew. Returns the scenario."""
    vertices, groups = [], {"ground": [], "wall": [], "glass": [], "block": []}
    quad(vertices, groups["ground"], (-50, -40, 0), (50, -40, 0), (50, 40, 0), (-50, 40, 0))
    quad(vertices, groups["wall"], (-50, 30, 0), (50, 30, 0), (50, 30, 12), (-50, 30, 12))
    quad(vertices, groups["glass"], (-10, -15, 0), (10, -15, 0), (10, -15, 9), (-10, -15, 9))
    (x0, x1), (y0, y1), (_, z) = BLOCK.values()
    quad(vertices, groups["block"], (x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z))
    for a, b in [((x0, y0), (x1, y0)), ((x1, y0), (x1, y1)), ((x1, y1), (x0, y1)), ((x0, y1), (x0, y0))]:
        quad(vertices, groups["block"], (*a, 0), (*b, 0), (*b, z), (*a, z))
    lines = ["v {} {} {}".format(*vertex) for vertex in vertices]
    for name, faces in groups.items():
        lines += [f"usemtl {name}", *(f"f {face}" for face in faces)]
    (folder / "street.obj").write_text("\n".join(lines) + "\n")
    return {
        "format": "dcem-scenario/1", "scene": {"obj": "street.obj"}, "frequency_hz": 28e9,
        "materials": {"ground": {"model": "dielectric", "relative_permittivity": 5, "conductivity_s_per_m": 0.1, "scattering": 0.5,
                                 "scattering_pattern": "lambertian"},
                      "wall": {"model": "constant", "reflection": 0.8},
                      "block": {"model": "constant", "reflection": 0.7},
                      "glass": {"model": "constant", "reflection": 0.5, "penetration_loss_db": 5},
                      "metal": {"model": "pec"}},
        "time": {"start_s": 0, "step_s": 0.1, "frames": 40},
        "objects": [{"id": "van", "box_m": VAN["size_m"], "material": "metal",
                     "motion": {key: VAN[key] for key in ("position_m", "yaw_deg", "velocity_mps")}}],
        "transmitters": [{"id": "mast", "position_m": [0, 0, 6], "power_dbm": 30, "antenna": ISOTROPIC}],
        "receivers": [{"id": "behind glass", "position_m": [2, -28, 2], "antenna": ISOTROPIC},
                      {"id": "behind block", "position_m": [33, 1, 2], "antenna": ISOTROPIC},
                      {"id": HOSTILE, "position_m": [-25, -12, 3], "antenna": ISOTROPIC}],
        "propagation": {"max_reflections": 1, "max_transmissions": 1, "max_diffractions": 1, "discovery": "exact",
                        "diffuse": {"enabled": True, "list_paths": True, "tolerance_db": 3}},
        "output": {"html": True, "paths": True, "links": True}}


def table(path):
    """The rows of a CSV file, by the names of its columns."""
    with path.open() as lines:
        return list(csv.DictReader(lines))


def number_text(value, digits):
    """A number as the page writes it."""
    return f"{value:.{digits}f}".replace("-", "−")


class PageTest(unittest.TestCase):
    """A browser with the page of the street, or of what a subclass changes in it."""

    command, size = "run", (1280, 820)

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        scenario = write_street(cls.folder)
        cls.change(scenario)
        (cls.folder / "street.json").write_text(json.dumps(scenario))
        cls.out = cls.folder / "out"
        subprocess.run([Settings.program, cls.command, cls.folder / "street.json", "-o", cls.out, "--quiet"], check=True)
        cls.page = Browser(*cls.size)
        cls.seconds = cls.page.open(cls.out / "viewer.html")

    @classmethod
    def change(cls, scenario):
        """What is other than in the street."""

    @classmethod
    def tearDownClass(cls):
        if hasattr(cls, "page"):
            cls.page.close()
        cls.temporary.cleanup()

    def tearDown(self):
        self.assertEqual(self.page.errors, [])

    def view(self, name=None):
        return self.page.screenshot(self.page.bounds("#view"), self.shot(name))

    @staticmethod
    def shot(name):
        return Settings.shots and name and Settings.shots / f"{name}.png"

    def pixels_of(self, points):
        """Where places of the scene are on the view."""
        return self.page.evaluate(
            f"(() => {{ const c = dcemViewer.head.centre_m; return {json.dumps(points)}.map((p) => {{"
            "const at = dcemViewer.project(p.map((v, i) => v - c[i])); return [at.x, at.y]; }); })()")

    def page_point(self, point):
        """Where a place of the scene is on the page."""
        box, (x, y) = self.page.bounds("#scene"), self.pixels_of([point])[0]
        return [x + box["x"], y + box["y"]]

    def text(self, selector):
        return self.page.evaluate(f"document.querySelector({json.dumps(selector)}).innerText")

    def is_visible(self, selector):
        return self.page.evaluate(f"document.querySelector({json.dumps(selector)}).offsetParent !== null")

    def hover(self, x, y):
        """The lines of the box at the pointer; none where there is no box."""
        self.page.mouse("mouseMoved", x, y, button="none", buttons=0)
        self.page.settle()
        return self.text("#pointer_box").split("\n") if self.is_visible("#pointer_box") else []

    def choose_option(self, selector, text):
        self.page.evaluate(f"{{ const s = document.querySelector({json.dumps(selector)});"
                           f"s.selectedIndex = [...s.options].findIndex((o) => o.text === {json.dumps(text)});"
                           "s.dispatchEvent(new Event('change')); true }")
        self.page.settle()

    def viridis(self, share):
        steps = self.page.evaluate("dcemViewer.head.viridis")
        place = min(max(share, 0), 1) * (len(steps) - 1)
        below = min(int(place), len(steps) - 2)
        return tuple(a + (place - below) * (b - a) for a, b in zip(steps[below], steps[below + 1]))

    def scale(self, selector):
        """Ticks of a colour bar: their numbers, where they stand, and the colour of the bar there."""
        return self.page.evaluate(
            f"(() => {{ const s = document.querySelector({json.dumps(selector)}), bar = s.querySelector('canvas');"
            "const box = bar.getBoundingClientRect(), pen = bar.getContext('2d');"
            "return [...s.querySelectorAll('.ticks span')].map((tick) => {"
            "const b = tick.getBoundingClientRect(), share = (b.x + b.width / 2 - box.x) / box.width;"
            "const column = Math.min(Math.floor(share * bar.width), bar.width - 1);"
            "return { value: Number(tick.innerText.replace('−', '-')), share,"
            "colour: [...pen.getImageData(column, 0, 1, 1).data].slice(0, 3) }; }); })()")

    def check_scale(self, selector, low, high):
        """At least three ticks, each where its value belongs, over the colour of its value."""
        ticks = self.scale(selector)
        self.assertGreaterEqual(len(ticks), 3)
        for tick in ticks:
            self.assertTrue(low <= tick["value"] <= high)
            share = (tick["value"] - low) / (high - low)
            self.assertAlmostEqual(tick["share"], share, delta=0.01)
            self.assertLess(max(abs(a - b) for a, b in zip(tick["colour"], self.viridis(share))), 6)


def power_range(powers):
    """The ends of a scale: the 2nd percentile and the maximum, outwards to 5 dB."""
    powers = sorted(powers)
    return 5 * math.floor(powers[int(0.02 * (len(powers) - 1))] / 5), 5 * math.ceil(powers[-1] / 5)


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def main():
    """PROGRAM [FOLDER_FOR_SCREENSHOTS]; exits with 77 where there is no Chromium, or no viewer in the program."""
    if find_chromium() is None:
        skip("chromium is not installed")
    Settings.program = pathlib.Path(sys.argv[1]).absolute()
    if len(sys.argv) > 2:
        Settings.shots = pathlib.Path(sys.argv[2]).absolute()
        Settings.shots.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "street.json").write_text(json.dumps(write_street(folder)))
        tried = subprocess.run([Settings.program, "run", folder / "street.json", "--frames", "0:1", "--output", "html", "-o",
                                folder / "out"], capture_output=True, text=True)
    if tried.returncode == 2 and "has no viewer" in tried.stderr:
        skip(tried.stderr.strip())
    unittest.main(argv=sys.argv[:1], verbosity=2)
