#!/usr/bin/env python3
"""The page of a small drive in headless Chromium, used as a person would: time, links, devices and their numbers.

    test_viewer_drive.py DCEM_PROGRAM [FOLDER_FOR_SCREENSHOTS]
"""
import json

from pages import COLOURS, HOSTILE, VAN, PageTest, main, number_text, table


class DriveTest(PageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with (cls.out / "paths.jsonl").open() as lines:
            cls.links = [json.loads(line) for line in lines]

    def setUp(self):
        self.page.evaluate("dcemViewer.play(false); dcemViewer.choose(null); dcemViewer.viewDevices(); dcemViewer.seek(0); true")
        self.page.click_on("#links_all")

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
        self.assertIn(HOSTILE, self.text("#links"))

    def test_a_link_that_is_switched_off_takes_its_rays_along(self):
        rays = "dcemViewer.rays.pickable.length"
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
        self.page.click_on("#view_scene")
        self.page.click_on("#links_none")
        first = van_row()
        box = self.page.bounds("#slider")
        self.page.click(box["x"] + box["width"] - 9, box["y"] + box["height"] / 2)
        self.assertEqual(self.page.evaluate("dcemViewer.frame"), 39)
        self.assertIn("frame 39 of 0 to 39, t = 3.900 s", self.text("#instant"))
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
        text = self.text("#chosen")
        self.assertIn("Receiver behind block", text)
        self.assertIn("33.00, 1.00, 2.00 m", text)
        link = next(one for one in self.links if one["rx"] == "behind block" and one["frame"] == 0)
        values = next(row for row in table(self.out / "links.csv") if row["frame"] == "0" and row["rx"] == "behind block")
        self.assertIn(number_text(float(values["power_dbm"]), 1), text)
        self.assertIn(f"{1e9 * float(values['rms_delay_spread_s']):.1f}", text)
        self.assertIn("mast", text)
        # A bar for each path, in the colour of its mechanism: the diffracted ones are there, line of sight is not.
        self.assertTrue(any("D" in path["kinds"] for path in link["paths"]))
        profile = self.page.screenshot(self.page.bounds("#profile"), self.shot("profile"))
        self.assertGreater(profile.count(COLOURS["diffracted"], 0), 40)
        self.assertEqual(profile.count(COLOURS["line of sight"], 0), 0)
        self.page.screenshot(None, self.shot("receiver"))

    def test_a_click_on_a_transmitter_lists_all_its_receivers(self):
        self.page.click(*self.page_point([0, 0, 6]))
        text = self.text("#chosen")
        self.assertIn("Transmitter mast", text)
        self.assertIn("30.00 dBm", text)
        for name in ("behind glass", "behind block", HOSTILE):
            self.assertIn(name, text)

    def test_only_its_links_stay_when_a_device_asks_for_that(self):
        self.page.click(*self.page_point([33, 1, 2]))
        self.page.click_on("#only_chosen")
        ticked = "[...document.querySelectorAll('#links input')].filter((box) => box.checked).map((box) => box.nextSibling.innerText)"
        self.assertEqual(self.page.evaluate(ticked), ["mast → behind block"])
        self.assertEqual(self.text("#link_count"), "1 of 3 shown")
        receivers = "[...new Set(dcemViewer.rays.pickable.map(({ row }) => dcemViewer.data.link_rx[row]))]"
        self.assertEqual(self.page.evaluate(receivers), [1])

    def test_playing_goes_through_all_frames_and_begins_again(self):
        self.choose_option("#speed", "every frame")
        self.page.evaluate("window.seen = new Set(); { const show = dcemViewer.player.show;"
                           "dcemViewer.player.show = (frame) => { seen.add(frame); show(frame); }; } dcemViewer.play(true); true")
        self.page.wait_for("seen.size === 40")
        self.page.wait_for("dcemViewer.frame === 3")
        self.page.evaluate("dcemViewer.play(false); true")
        self.choose_option("#speed", "1 ×")


if __name__ == "__main__":
    main()
