#!/usr/bin/env python3
"""The arithmetic of bench/plot_motion.py on a drive made by hand, and the file that it reads as bench_motion writes it.

    test_plot_motion.py SOURCE_DIR [BENCH_MOTION]

Drawing is skipped where Matplotlib is missing, the file of the program where no program is given.
"""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BENCH_MOTION = None
FRAMES = 30
# Of the last tenth, three frames: (update in ms, closest and occluded in ns per ray). Rays cost 100, 250 and 130 ns.
END = {"rebuild": (10.0, 120.0, 80.0), "refit": (1.0, 300.0, 200.0), "adaptive": (1.5, 150.0, 110.0)}
COLUMNS = ("cars,frame,tree,policy,update_ms,closest_ns_per_ray,occluded_ns_per_ray,closest_steps,occluded_steps,"
           "sah_cost,leaves_written,nodes_visited,reinserted,rotated,rebuilt_in_place,rebuilt").split(",")


def python_with_matplotlib():
    for candidate in [sys.executable, "/usr/bin/python3"]:
        if pathlib.Path(candidate).exists():
            if subprocess.run([candidate, "-c", "import matplotlib"], capture_output=True, check=False).returncode == 0:
                return candidate
    return None


def rows_by_hand():
    """Before the last tenth every policy costs the same; in it one frame of three is disturbed."""
    for frame in range(1, FRAMES + 1):
        for policy, (update_ms, closest_ns, occluded_ns) in END.items():
            row = dict.fromkeys(COLUMNS, 0)
            row.update(cars=7, frame=frame, tree="wide", policy=policy, rebuilt="tree" if policy == "rebuild" else "")
            row.update(update_ms=update_ms, closest_ns_per_ray=closest_ns, occluded_ns_per_ray=occluded_ns)
            if frame <= FRAMES - FRAMES // 10:
                row.update(update_ms=5.0, closest_ns_per_ray=400.0, occluded_ns_per_ray=400.0)
            if frame == FRAMES - 1:
                row.update(update_ms=90.0, closest_ns_per_ray=9000.0, occluded_ns_per_ray=9000.0)
            yield row
        # Neither another tree nor another policy may be taken for one of the three.
        yield {**row, "tree": "binary", "policy": "adaptive", "update_ms": 77.0}
        yield {**row, "policy": "reinsert", "update_ms": 88.0}


def write_series(path, rows, columns=COLUMNS):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


def draw(*arguments, python=sys.executable):
    return subprocess.run([python, SOURCE / "bench" / "plot_motion.py", *arguments], capture_output=True, text=True,
                          check=False)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.file = self.folder / "series.csv"


class Arithmetic(Folder):
    def points(self):
        write_series(self.file, rows_by_hand())
        cars, series = plot_motion.read_series(self.file)
        self.assertEqual(cars, 7)
        return series, {(plain, better): (rays, text) for plain, better, rays, text in plot_motion.break_evens(series)}

    def test_break_even_is_the_price_of_the_update_over_the_gain_per_ray(self):
        _, points = self.points()
        expected = {("refit", "rebuild"): 9.0e6 / 150.0, ("adaptive", "rebuild"): 8.5e6 / 30.0,
                    ("refit", "adaptive"): 0.5e6 / 120.0}
        self.assertEqual(set(points), set(expected))
        for pair, rays in expected.items():
            self.assertAlmostEqual(points[pair][0] / rays, 1.0, delta=1e-9)  # a few roundings of doubles
        self.assertTrue(points["refit", "rebuild"][1].startswith("rebuild cheaper than refit from 60,000 rays on"))

    def test_both_cost_the_same_at_the_break_even(self):
        series, points = self.points()
        for (plain, better), (rays, _) in points.items():
            costs = [plot_motion.frame_cost_ms(series[policy][-1], rays) for policy in (plain, better)]
            self.assertAlmostEqual(costs[0] / costs[1], 1.0, delta=1e-9)

    def test_a_policy_that_gains_nothing_per_ray_never_breaks_even(self):
        self.assertEqual(plot_motion.break_even_rays((1.0, 2e-4), (3.0, 2e-4)), math.inf)
        self.assertEqual(plot_motion.break_even_rays((1.0, 2e-4), (3.0, 3e-4)), math.inf)
        self.assertEqual(plot_motion.break_even_rays((3.0, 2e-4), (1.0, 1e-4)), 0.0)
        self.assertEqual(plot_motion.break_even_text("refit", "rebuild", math.inf, math.inf, math.inf),
                         "rebuild never cheaper than refit")

    def test_range_of_frames_that_do_not_differ_is_the_point_itself(self):
        frames = {policy: [dict(zip(plot_motion.NUMBERS, numbers))] * 5 for policy, numbers in END.items()}
        low, high = plot_motion.break_even_range(frames["refit"], frames["rebuild"])
        self.assertEqual(low, high)
        self.assertAlmostEqual(low / 60_000.0, 1.0, delta=1e-9)

    def test_range_holds_the_point_where_frames_differ(self):
        plain = [{"update_ms": 1.0, "closest_ns_per_ray": 250.0 + at, "occluded_ns_per_ray": 250.0} for at in range(20)]
        better = [{"update_ms": 10.0, "closest_ns_per_ray": 100.0, "occluded_ns_per_ray": 100.0}] * 20
        low, high = plot_motion.break_even_range(plain, better)
        # The extremes are those of resamples of nothing but the first frame, and nothing but the last.
        self.assertTrue(9.0e6 / 159.5 < low < 9.0e6 / 154.75 < high < 9.0e6 / 150.0, (low, high))

    def test_running_median_drops_a_spike_and_keeps_a_step(self):
        self.assertEqual(plot_motion.running_median([1, 1, 9, 1, 1, 5, 5, 5], 3), [1, 1, 1, 1, 1, 5, 5, 5])
        self.assertEqual(plot_motion.running_median([3, 1, 2], 1), [3, 1, 2])

    def test_deeds_tell_a_subtree_from_all_nodes_and_from_the_tree(self):
        def frame(number, reinserted=0, rebuilt_in_place=0, rebuilt=""):
            return {"frame": number, "reinserted": reinserted, "rotated": 0, "rebuilt_in_place": rebuilt_in_place, "rebuilt": rebuilt}

        frames = [frame(1), frame(2, reinserted=3), frame(3, rebuilt_in_place=2), frame(4, 1, 1, "nodes"),
                  frame(5, 0, 2, "nodes"), frame(6, rebuilt="tree")]
        self.assertEqual(plot_motion.deeds(frames),
                         {"refit only": [1], "cars reinserted": [2, 4], "subtree rebuilt_in_place": [3, 5],
                          "all nodes rebuilt_in_place": [4, 5], "tree rebuilt": [6]})
        self.assertEqual(plot_motion.runs([1, 2, 3, 7, 9, 10]), [(1, 3), (7, 1), (9, 2)])


class Files(Folder):
    def check_refused(self, what):
        done = draw(self.file, "--picture", self.folder / "motion")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(what, done.stderr)
        self.assertEqual([path.name for path in self.folder.iterdir() if path != self.file], [])

    def test_file_that_cannot_be_used_is_refused_in_one_line(self):
        self.check_refused("series.csv")  # not there
        write_series(self.file, rows_by_hand(), [name for name in COLUMNS if name != "rebuilt_in_place"])
        self.check_refused("rebuilt_in_place")
        write_series(self.file, [row for row in rows_by_hand() if row["policy"] != "refit"])
        self.check_refused("not every policy")
        write_series(self.file, [])
        self.check_refused("no rows")
        write_series(self.file, ({**row, "update_ms": "quick"} for row in rows_by_hand()))
        self.check_refused("frame 1, rebuild: no number")

    def test_pictures_are_drawn(self):
        python = python_with_matplotlib()
        if python is None:
            self.skipTest("no Python with Matplotlib (apt install python3-matplotlib)")
        write_series(self.file, rows_by_hand())
        done = draw(self.file, "--picture", self.folder / "motion", python=python)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("rebuild cheaper than refit from 60,000 rays on", done.stdout)
        picture = (self.folder / "motion.png").read_bytes()
        self.assertEqual(picture[:4], b"\x89PNG")
        self.assertGreater(len(picture), 20_000)
        self.assertTrue(xml.etree.ElementTree.parse(self.folder / "motion.svg").getroot().tag.endswith("svg"))


class Program(Folder):
    def setUp(self):
        super().setUp()
        if BENCH_MOTION is None:
            self.skipTest("no bench_motion")

    def drive(self, path):
        return subprocess.run([BENCH_MOTION, SOURCE / "data" / "town.obj", "--cars", "5", "--frames", "11", "--rays",
                               "8", "--series", path], capture_output=True, text=True, check=False)

    def test_series_agrees_with_the_table_of_the_drive(self):
        done = self.drive(self.file)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.file, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), COLUMNS)
        table = list(csv.DictReader(done.stdout.splitlines()))
        self.assertEqual(len(rows), 11 * len(table))
        for each in table:
            series = [row for row in rows if (row["tree"], row["policy"]) == (each["tree"], each["policy"])]
            self.assertEqual([int(row["frame"]) for row in series], list(range(1, 12)))
            update_ms = plot_motion.median([float(row["update_ms"]) for row in series])
            self.assertAlmostEqual(update_ms, float(each["update_median_ms"]), delta=6e-5)  # printed to four digits
            if each["tree"] != "embree":
                self.assertEqual(sum(int(row["nodes_visited"]) for row in series), int(each["nodes_visited"]))
                self.assertAlmostEqual(float(series[-1]["sah_cost"]), float(each["sah_cost"]), delta=6e-4)
        plot_motion.break_evens(plot_motion.read_series(self.file)[1])

    def test_path_that_cannot_be_written_is_refused_before_the_drive(self):
        for path in [self.folder / "nowhere" / "series.csv", self.folder]:
            done = self.drive(path)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(str(path), done.stderr)


if __name__ == "__main__":
    SOURCE = pathlib.Path(sys.argv[1]).resolve()
    BENCH_MOTION = sys.argv[2] if len(sys.argv) > 2 else None
    sys.path.insert(0, str(SOURCE / "bench"))
    sys.dont_write_bytecode = True
    import plot_motion

    unittest.main(argv=sys.argv[:1], verbosity=2)
