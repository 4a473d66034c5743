#!/usr/bin/env python3
"""Rays on the page of a small drive: which are drawn, their colours, and the numbers of the one that is chosen.

    test_viewer_rays.py DCEM_PROGRAM [FOLDER_FOR_SCREENSHOTS]
"""
import json
import math
import re

from pages import BLOCK, COLOURS, HOSTILE, ISOTROPIC, VAN, PageTest, main, table


def direction(a, b):
    length = math.dist(a, b)
    return [(y - x) / length for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def degrees_of_cosine(cosine):
    return math.degrees(math.acos(min(max(cosine, -1), 1)))


def turned(vector, yaw_deg):
    c, s = math.cos(math.radians(yaw_deg)), math.sin(math.radians(yaw_deg))
    return [c * vector[0] - s * vector[1], s * vector[0] + c * vector[1], vector[2]]


class Box:
    """The block, or the van in a frame: which of its edges a point lies on, and the angles there."""

    def __init__(self, name, time_s):
        if name == "van":
            half = [size / 2 for size in VAN["size_m"]]
            self.yaw_deg = VAN["yaw_deg"]
            foot = [p + v * time_s for p, v in zip(VAN["position_m"], VAN["velocity_mps"])]
            self.centre = [foot[0], foot[1], foot[2] + half[2]]
        else:
            half = [(high - low) / 2 for low, high in BLOCK.values()]
            self.yaw_deg = 0
            self.centre = [(high + low) / 2 for low, high in BLOCK.values()]
        self.half = half
        self.axes = [turned(axis, self.yaw_deg) for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1])]

    def faces_at(self, point):
        """Normals of the faces on which a point lies."""
        away = [p - c for p, c in zip(point, self.centre)]
        normals = []
        for axis, half in zip(self.axes, self.half):
            along = dot(away, axis)
            if abs(abs(along) - half) < 1e-6:
                normals.append([math.copysign(1, along) * a for a in axis])
        return normals

    def edge_angles(self, point, before, behind):
        """To the edge, and the azimuths about it counted from either of the two faces."""
        first, second = self.faces_at(point)
        along = [first[1] * second[2] - first[2] * second[1], first[2] * second[0] - first[0] * second[2],
                 first[0] * second[1] - first[1] * second[0]]
        to_edge = degrees_of_cosine(abs(dot(before, along)))
        azimuth = lambda away: math.degrees(math.atan2(dot(away, first), -dot(away, second))) % 360
        from_first = [azimuth([-x for x in before]), azimuth(behind)]
        return to_edge, from_first, [270 - angle for angle in from_first]


class RaysTest(PageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with (cls.out / "paths.jsonl").open() as lines:
            cls.links = [json.loads(line) for line in lines]

    def setUp(self):
        self.page.evaluate("dcemViewer.choose(null); dcemViewer.viewDevices(); dcemViewer.seek(0); true")
        self.page.click_on("#links_all")

    def drawn(self):
        """Names of the paths that are drawn, by receiver."""
        pairs = self.page.evaluate("dcemViewer.rays.pickable.map(({ row, ray }) => [dcemViewer.head.receivers["
                                   "dcemViewer.data.link_rx[row]], dcemViewer.head.paths[dcemViewer.data.ray_path[ray]][1]])")
        result = {}
        for receiver, path in pairs:
            result.setdefault(receiver, set()).add(path)
        return result

    def test_it_opens_with_the_strongest_of_each_link_and_says_of_how_many(self):
        now = [link for link in self.links if link["frame"] == 0]
        strongest = {link["rx"]: {path["id"] for path in sorted(link["paths"], key=lambda p: -p["received_power_dbm"])[:8]}
                     for link in now}
        self.assertEqual(self.drawn(), strongest)
        shown, kept, listed = self.counts()
        self.assertEqual((shown, listed), (24, sum(len(link["paths"]) for link in now)))
        self.assertTrue(100 < kept <= listed)
        # Of fewer links there are more.
        self.page.click_on("#links input[data-link='0']")
        self.page.click_on("#links input[data-link='1']")
        self.assertEqual(self.counts()[0], 12)
        self.page.click_on("#links_all")
        self.page.click_on("#strongest_all")
        shown, all_kept, _ = self.counts()
        self.assertEqual((shown, all_kept), (kept, kept))
        self.assertEqual(sum(len(paths) for paths in self.drawn().values()), kept)
        self.page.evaluate("dcemViewer.rays.perLink = undefined; true")

    def counts(self):
        """Drawn, in the page, in the results."""
        numbers = [int(text.replace(",", "")) for text in re.findall(r"[\d,]+", self.text("#ray_count"))]
        return numbers if len(numbers) == 3 else [*numbers, numbers[1]]

    def test_each_mechanism_has_its_colour_and_vanishes_when_it_is_switched_off(self):
        self.page.click_on("#strongest_all")
        before = self.view("mechanisms").counts()
        for index, (name, colour) in enumerate(COLOURS.items()):
            with self.subTest(name):
                exact = bytes.fromhex(colour[1:])
                self.assertGreater(before.get(exact, 0), 30)
                self.page.click_on(f"#mechanism_{index}")
                self.assertEqual(self.view().counts().get(exact, 0), 0)
                self.page.click_on(f"#mechanism_{index}")
                self.assertEqual(self.view().counts().get(exact, 0), before[exact])
        self.page.evaluate("dcemViewer.rays.perLink = undefined; true")

    def test_power_has_the_colours_of_its_bar(self):
        self.page.click_on("input[value=power]")
        counts = self.view("power").counts()
        self.assertEqual(counts.get(bytes.fromhex(COLOURS["line of sight"][1:]), 0), 0)
        self.assertIn("dBm", self.text("#power_scale"))
        self.check_scale("#power_scale", *self.page.evaluate("[dcemViewer.rays.range.low, dcemViewer.rays.range.high]"))
        self.page.click_on("input[value=mechanism]")
        self.assertGreater(self.view().count(COLOURS["line of sight"], 0), 30)

    def test_a_click_on_a_ray_shows_its_numbers(self):
        link = next(one for one in self.links if one["rx"] == HOSTILE and one["frame"] == 0)
        path = next(one for one in link["paths"] if one["kinds"] == "")
        start, stop = self.page_point([0, 0, 6]), self.page_point([-25, -12, 3])
        self.page.click(*(0.4 * a + 0.6 * b for a, b in zip(start, stop)))
        text = self.text("#chosen")
        self.assertIn("LOS", text)
        self.assertIn("line of sight", text)
        self.assertIn(f"{math.dist((0, 0, 6), (-25, -12, 3)):.2f} m", text)
        self.assertIn(f"{1e9 * path['delay_s']:.2f} ns", text)
        self.assertIn(f"−{-path['path_gain_db']:.2f} dB", text)
        self.assertIn("Doppler", text)
        self.page.screenshot(None, self.shot("ray"))

    def chosen_path(self, link, path):
        """Chooses a path in its frame; what the panel says: its facts, and those of each interaction with their titles."""
        found = self.page.evaluate(
            f"(() => {{ const v = dcemViewer, wanted = {json.dumps([path['kinds'], path['id']])}; v.seek({link['frame']});"
            f"const rx = v.head.receivers.indexOf({json.dumps(link['rx'])});"
            "const number = v.head.paths.findIndex(([kinds, id]) => kinds === wanted[0] && id === wanted[1]);"
            "if (number >= 0) v.choose({ link: rx, path: number }); return number >= 0 && v.panel.ray() !== undefined; })()")
        if not found:
            return None
        rows = "(table) => [...table.rows].map((row) => [...row.cells].map((cell) => cell.innerText))"
        facts, titles, tables = self.page.evaluate(
            f"(() => {{ const rows = {rows}, part = document.querySelector('#chosen_touches');"
            "return [rows(document.querySelector('#chosen_facts table')), [...part.querySelectorAll('h3')].map((h) => h.innerText),"
            "[...part.querySelectorAll('table')].map(rows)]; })()")
        return dict(facts), titles, [dict(one) for one in tables]

    def check_angle(self, text, expected_deg):
        self.assertTrue(text.endswith("°"), text)
        # The page has two digits, and points in single precision.
        self.assertAlmostEqual(float(text[:-1].replace("−", "-")), expected_deg, delta=0.011)

    def check_ends(self, facts, path):
        for end in ("departure", "arrival"):
            for angle in ("azimuth", "zenith"):
                self.check_angle(facts[f"{end} {angle}"], math.degrees(path[end][f"{angle}_rad"]))

    def check_touch(self, kind, material, box, before, behind, point, facts):
        """The angles at one interaction, from the geometry of the street alone."""
        self.assertEqual(facts["point"], ", ".join(f"{x + 0:.2f}".replace("-0.00", "0.00").replace("-", "−") for x in point) + " m")
        if kind == "D":
            to_edge, *azimuths = box.edge_angles(point, before, behind)
            self.check_angle(facts["angle to the edge"], to_edge)
            self.check_angle(facts["open about the edge"], 270)
            ways = [float(facts[f"about the edge, {way}"][:-1]) for way in ("in", "out")]
            self.assertTrue(any(max(abs(a - b) for a, b in zip(ways, one)) < 0.011 for one in azimuths), (ways, azimuths))
        elif kind == "R":  # half of what is left of a turn back
            self.check_angle(facts["incidence"], degrees_of_cosine(-dot(before, behind)) / 2)
        else:
            axis = {"glass": 1, "ground": 2}[material]
            self.check_angle(facts["incidence"], degrees_of_cosine(abs(before[axis])))
            if kind == "S":
                self.check_angle(facts["scattered"], degrees_of_cosine(abs(behind[axis])))

    def test_the_panel_has_each_interaction_of_a_ray_with_its_angles(self):
        places = {"behind glass": (2, -28, 2), "behind block": (33, 1, 2), HOSTILE: (-25, -12, 3)}
        words = {"R": "reflected at", "T": "transmitted through", "D": "diffracted at an edge of", "S": "scattered at"}
        seen, tries = set(), {}
        for link in self.links[::5]:
            for path in sorted(link["paths"], key=lambda one: -one["received_power_dbm"]):
                what = (path["kinds"], *path["objects"], *path["materials"])
                tries[what] = tries.get(what, 0) + 1
                # The weakest of a link are not in the page.
                shown = None if what in seen or tries[what] > 5 else self.chosen_path(link, path)
                if shown is None:
                    continue
                seen.add(what)
                facts, titles, tables = shown
                self.check_ends(facts, path)
                points = [(0, 0, 6), *path["points_m"], places[link["rx"]]]
                legs = [direction(a, b) for a, b in zip(points, points[1:])]
                self.assertEqual(len(tables), len(path["kinds"]))
                for i, kind in enumerate(path["kinds"]):
                    where = f" of {path['objects'][i]}" if path["objects"][i] else ""
                    self.assertEqual(titles[i], f"{i + 1}. {words[kind]} {path['materials'][i]}{where}")
                    box = Box(path["objects"][i], link["time_s"])
                    self.check_touch(kind, path["materials"][i], box, legs[i], legs[i + 1], path["points_m"][i], tables[i])
        self.assertEqual(set("".join(kinds for kinds, *_ in seen)), set("RTDS"))
        on_van = {kinds for kinds, *rest in seen if "van" in rest}
        self.assertIn("D", "".join(on_van))
        self.assertTrue(any("R" in kinds and rest[kinds.index("R")] == "van" for kinds, *rest in seen))
        self.assertGreater(len(seen), 15)
        self.page.screenshot(None, self.shot("angles"))


class ManyLinksTest(PageTest):
    """One frame with 50 receivers: the 40 strongest links are shown at first, and there is no time."""

    @classmethod
    def change(cls, scenario):
        points = [[-45 + 1.8 * i, -20 - (i % 7), 1.5] for i in range(50)]
        scenario["receivers"] = [{"id": "row", "positions_m": points, "antenna": ISOTROPIC}]
        scenario["propagation"]["diffuse"] = {"enabled": False}
        scenario["time"]["frames"] = 1

    def test_the_weakest_links_are_left_out_until_they_are_asked_for(self):
        powers = {row["rx"]: float(row["power_dbm"] or -1e9) for row in table(self.out / "links.csv")}
        weakest = sorted(powers, key=powers.get)[:10]
        hidden = "[...dcemViewer.rays.hiddenLinks].map((key) => dcemViewer.head.receivers[key])"
        self.assertEqual(sorted(self.page.evaluate(hidden)), sorted(weakest))
        self.assertEqual(self.text("#link_count"), "40 of 50 shown")
        self.assertEqual(self.page.evaluate("dcemViewer.rays.drawn"), 40)
        self.page.click_on("#links_all")
        self.assertEqual(self.page.evaluate("dcemViewer.rays.drawn"), 50)
        self.page.screenshot(None, self.shot("many_links"))

    def test_a_single_frame_has_no_bar_and_keys_of_time_do_nothing(self):
        self.assertFalse(self.is_visible("#play"))
        self.assertFalse(self.is_visible("#slider"))
        self.assertNotIn("Space", self.text("aside"))
        for key in ("ArrowRight", "End", " "):
            self.page.key(key)
        self.assertEqual(self.page.evaluate("[dcemViewer.frame, dcemViewer.playing]"), [0, False])
        bottom = self.page.evaluate("document.querySelector('#view').getBoundingClientRect().bottom - window.innerHeight")
        self.assertEqual(bottom, 0)


if __name__ == "__main__":
    main()
