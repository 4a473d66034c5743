#!/usr/bin/env python3
"""Maps on the page: colours and values of powers, best servers and SINR, over a grid and along a list of points.

    test_viewer_maps.py DCEM_PROGRAM [FOLDER_FOR_SCREENSHOTS]
"""
from pages import ISOTROPIC, PageTest, main, number_text, power_range, table

OBSTRUCTED = (150, 156, 162)


def place_of(point):
    return tuple(float(point[f"{axis}_m"]) for axis in "xyz")


def place_text(point):
    return ", ".join(number_text(value, 2) for value in place_of(point)) + " m"


def power_of(point):
    """Incoherent power; None where there is none."""
    return float(point["power_incoherent_dbm"]) if point["power_incoherent_dbm"] else None


class MapsTest(PageTest):
    """Two masts and noise, seen on the plan."""

    command = "map"

    @classmethod
    def change(cls, scenario):
        scenario["transmitters"].append({"id": "corner", "position_m": [-40, -30, 8], "power_dbm": 25, "antenna": ISOTROPIC})
        scenario["receivers"] = cls.receivers()
        scenario["propagation"] = {"max_reflections": 1, "max_transmissions": 1, "max_diffractions": 0, "discovery": "exact"}
        scenario["noise"] = {"bandwidth_hz": 20e6, "noise_figure_db": 6}
        scenario["time"]["frames"] = 1
        scenario["output"] = {"html": True, "map": ["csv"]}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        read = lambda part: table(cls.out / f"map_{cls.name}_{part}.csv")
        cls.powers = {mast: read(mast) for mast in ("mast", "corner")}
        cls.servers, cls.sinr = read("best_server"), read("sinr")

    def setUp(self):
        self.page.evaluate("dcemViewer.showPlan(true); dcemViewer.viewDevices(); true")
        self.choose_option("#map_places", self.name)
        self.choose_option("#map_choice", "power of mast")

    def power_colours(self, points):
        """By place; absent where nothing arrives."""
        files = [path for path in self.out.glob("map_*.csv") if path.stem.endswith(("_mast", "_corner"))]
        low, high = power_range([power_of(point) for path in files for point in table(path) if power_of(point) is not None])
        self.check_scale("#map_scale", low, high)
        return {place_of(point): self.viridis((power_of(point) - low) / (high - low)) for point in points
                if power_of(point) is not None}

    def colours_seen(self, places, name):
        self.page.mouse("mouseMoved", 1200, 400, button="none", buttons=0)  # the box at the pointer would hide some
        picture = self.view(name)
        return [tuple(picture.rows[int(y)][picture.channels * int(x):][:3]) for x, y in self.pixels_of(list(places))]

    def share_alike(self, colours, name):
        """How many of the places show their colour."""
        seen = self.colours_seen(colours, name)
        alike = sum(max(abs(a - b) for a, b in zip(colour, colours[place])) <= 2 for colour, place in zip(seen, colours))
        return alike / len(colours)

    def in_the_open(self, colours):
        """Without the places that symbols, names and the line of the wall hide."""
        return {(x, y, z): colour for (x, y, z), colour in colours.items()
                if y != 30 and not (-6 < x < 20 and -6 < y < 6) and not (-46 < x < -15 and -36 < y < -24)}

    def hover_at(self, point):
        return self.hover(*self.page_point(place_of(point)))

    def every(self, points, step):
        return [point for point in points[::step] if power_of(point) is not None]


class GridTest(MapsTest):
    name = "area"

    @classmethod
    def receivers(cls):
        return [{"id": "area", "grid": {"origin_m": [-48, -38, 1.5], "spacing_m": [2, 2], "count": [49, 39]}},
                {"id": "high", "grid": {"origin_m": [-40, -30, 9], "spacing_m": [4, 4], "count": [20, 15]}}]

    def test_the_map_lies_on_the_ground_in_its_colours_until_it_is_switched_off(self):
        colours = self.power_colours(self.powers["mast"])
        colours.update({place_of(point): OBSTRUCTED for point in self.powers["mast"] if point["path_count"] == ""})
        colours = self.in_the_open(colours)
        self.assertGreater(len(colours), 1000)
        self.assertGreater(sum(colour == OBSTRUCTED for colour in colours.values()), 5)  # in the van and the block, on the wall
        self.assertGreater(len({tuple(map(round, colour)) for colour in colours.values()}), 100)
        # Lines of walls and of the van run over some points.
        self.assertGreater(self.share_alike(colours, "map"), 0.97)
        with_map = self.colours_seen(colours, None)
        self.choose_option("#map_choice", "none")
        self.assertEqual(self.share_alike(colours, "map_off"), 0)
        self.assertFalse(self.is_visible("#map_scale"))
        self.assertEqual(self.hover_at(self.powers["mast"][800]), [])
        self.choose_option("#map_choice", "power of mast")
        self.assertEqual(self.colours_seen(colours, None), with_map)

    def test_each_transmitter_has_its_map(self):
        for mast in ("mast", "corner"):
            self.choose_option("#map_choice", f"power of {mast}")
            colours = self.in_the_open(self.power_colours(self.powers[mast]))
            self.assertGreater(self.share_alike(colours, f"map_{mast}"), 0.97)

    def test_the_pointer_shows_the_power_of_the_file(self):
        for mast in ("mast", "corner"):
            self.choose_option("#map_choice", f"power of {mast}")
            for point in self.every(self.powers[mast], 157):
                expected = [place_text(point), f"{mast}: {number_text(power_of(point), 2)} dBm"]
                self.assertEqual(self.hover_at(point), expected)
        self.page.screenshot(None, self.shot("map_pointer"))

    def test_the_pointer_says_so_where_nothing_arrives_or_nothing_can_stand(self):
        inside = next(point for point in self.powers["mast"] if 16 < float(point["x_m"]) < 24 and abs(float(point["y_m"])) < 4)
        self.assertEqual(inside["path_count"], "")
        self.assertEqual(self.hover_at(inside), [place_text(inside), "inside an object"])
        empty = next(point for point in self.powers["mast"] if point["path_count"] == "0")
        self.assertEqual(self.hover_at(empty), [place_text(empty), "nothing arrives"])
        x, y = self.page_point((49.5, 0, 1.5))  # beside the map
        self.assertEqual(self.hover(x, y), [])

    def test_a_roof_above_the_map_hides_its_values(self):
        point = next(point for point in self.powers["mast"] if place_of(point)[:2] == (20, 0))
        self.assertNotEqual(self.hover_at(point), [])
        self.page.evaluate("{ const s = document.querySelector('#cut'); s.value = 1000;"
                           "s.dispatchEvent(new Event('input')); true }")
        self.assertEqual(self.hover_at(point), [])
        self.assertNotEqual(self.hover_at(self.powers["mast"][800]), [])

    def test_the_pointer_shows_values_in_perspective_as_well(self):
        self.page.evaluate("dcemViewer.showPlan(false); dcemViewer.viewDevices(); true")
        for point in self.every(self.powers["mast"], 211):
            self.assertEqual(self.hover_at(point)[:1], [place_text(point)])

    def test_the_best_server_has_the_colour_of_its_name(self):
        self.choose_option("#map_choice", "best server")
        legend = self.page.evaluate("[...document.querySelectorAll('#map_legend .row')].map((row) => ["
                                    "row.querySelector('.label').innerText, getComputedStyle(row.querySelector('.swatch')).backgroundColor,"
                                    "row.querySelector('.count').innerText])")
        served = [point["tx"] for point in self.servers if point["tx"]]
        self.assertEqual([(name, share) for name, _, share in legend],
                         [(mast, f"{100 * served.count(mast) / len(served):.1f} %") for mast in ("mast", "corner")])
        colour_of = {name: tuple(int(part) for part in colour[4:-1].split(",")) for name, colour, _ in legend}
        self.assertNotEqual(colour_of["mast"], colour_of["corner"])
        colours = self.in_the_open({place_of(point): colour_of[point["tx"]] for point in self.servers if point["tx"]})
        self.assertEqual(len(set(colours.values())), 2)
        self.assertGreater(self.share_alike(colours, "best_server"), 0.97)
        self.assertFalse(self.is_visible("#map_scale"))

    def test_the_pointer_names_the_best_server(self):
        self.choose_option("#map_choice", "best server")
        for point in self.every(self.servers, 157):
            expected = [place_text(point), f"best server: {point['tx']}", f"{number_text(power_of(point), 2)} dBm"]
            self.assertEqual(self.hover_at(point), expected)

    def test_the_sinr_has_the_colours_of_its_scale_and_its_value_at_the_pointer(self):
        self.choose_option("#map_choice", "SINR")
        self.check_scale("#map_scale", -10, 30)
        self.assertIn("SINR of the best server, dB", self.text("#map_scale"))
        colours = {place_of(point): self.viridis((float(point["sinr_db"]) + 10) / 40) for point in self.sinr if point["sinr_db"]}
        self.assertGreater(self.share_alike(self.in_the_open(colours), "sinr"), 0.97)
        for point, server in list(zip(self.sinr, self.servers))[::157]:
            if point["sinr_db"]:
                self.assertEqual(self.hover_at(point), [place_text(point), f"SINR: {number_text(float(point['sinr_db']), 2)} dB",
                                                        f"{point['tx']}: {number_text(power_of(server), 2)} dBm"])

    def test_what_the_pointer_shows_follows_the_choice_and_the_camera(self):
        point, server, sinr = self.powers["mast"][800], self.servers[800], self.sinr[800]
        self.hover_at(point)
        self.choose_option("#map_choice", "SINR")
        self.assertEqual(self.text("#pointer_box").split("\n")[1], f"SINR: {number_text(float(sinr['sinr_db']), 2)} dB")
        self.choose_option("#map_choice", "best server")
        self.assertEqual(self.text("#pointer_box").split("\n")[1], f"best server: {server['tx']}")
        self.page.evaluate("dcemViewer.viewpoint.target.x += 2; dcemViewer.viewpoint.place(); true")
        self.page.settle()
        self.assertEqual(self.text("#pointer_box").split("\n")[0], place_text(self.servers[801]))

    def test_another_grid_shows_the_same_quantity(self):
        self.choose_option("#map_choice", "SINR")
        self.choose_option("#map_places", "high")
        point = next(point for point in table(self.out / "map_high_sinr.csv")[100:] if point["sinr_db"])
        self.assertEqual(self.hover_at(point)[:2], [place_text(point), f"SINR: {number_text(float(point['sinr_db']), 2)} dB"])
        self.assertGreater(self.page.evaluate("dcemViewer.surfaces.cutHeight"), 9)
        self.choose_option("#map_places", "area")
        self.assertLess(self.page.evaluate("dcemViewer.surfaces.cutHeight"), 2)


class ListTest(MapsTest):
    """A route of points as discs, the ends of which are far from both masts."""

    name = "route"

    @classmethod
    def receivers(cls):
        return [{"id": "route", "positions_m": [[-45 + 4 * i, 12 + 0.2 * i, 1.5] for i in range(24)], "antenna": ISOTROPIC}]

    def test_points_have_the_colours_of_their_power(self):
        colours = self.power_colours(self.powers["mast"])
        self.assertEqual(len(colours), 22)  # two are in the van, where nothing arrives
        self.assertGreater(len({tuple(map(round, colour)) for colour in colours.values()}), 10)
        self.assertEqual(self.share_alike(colours, "route"), 1)
        self.choose_option("#map_choice", "none")
        self.assertEqual(self.share_alike(colours, "route_off"), 0)

    def test_the_pointer_shows_the_value_of_a_point(self):
        for point in self.powers["mast"][4::5]:
            self.assertEqual(self.hover_at(point), [place_text(point), f"mast: {number_text(power_of(point), 2)} dBm"])
        inside = self.powers["mast"][1]
        self.assertEqual(self.hover_at(inside), [place_text(inside), "nothing arrives"])
        x, y = self.page_point((0, -30, 1.5))  # far from the route
        self.assertEqual(self.hover(x, y), [])
        self.choose_option("#map_choice", "SINR")
        point = self.sinr[7]
        self.assertEqual(self.hover_at(point)[1], f"SINR: {number_text(float(point['sinr_db']), 2)} dB")

    def test_points_are_seen_in_perspective_too(self):
        self.page.evaluate("dcemViewer.showPlan(false); dcemViewer.viewDevices(); true")
        self.assertGreater(self.share_alike(self.power_colours(self.powers["mast"]), "route_perspective"), 0.7)


del MapsTest  # it has no tests of its own

if __name__ == "__main__":
    main()
