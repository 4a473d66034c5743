#!/usr/bin/env python3
"""Where one looks from: the turntable, the plan from above, north.

    test_viewer_camera.py DCEM_PROGRAM [FOLDER_FOR_SCREENSHOTS]
"""
import math

from pages import PageTest, main


class CameraTest(PageTest):
    @classmethod
    def change(cls, scenario):
        scenario["propagation"]["diffuse"] = {"enabled": False}
        scenario["time"]["frames"] = 3

    def setUp(self):
        self.page.evaluate("dcemViewer.showPlan(false); Object.assign(dcemViewer.viewpoint, { azimuth: -1.9, elevation: 0.85 });"
                           "dcemViewer.viewDevices(); true")
        self.page.settle()

    def drag(self, from_x, from_y, to_x, to_y):
        self.page.mouse("mouseMoved", from_x, from_y, button="none", buttons=0)
        self.page.mouse("mousePressed", from_x, from_y)
        self.page.mouse("mouseMoved", to_x, to_y)
        self.page.mouse("mouseReleased", to_x, to_y, buttons=0)
        self.page.settle()

    def wheel(self, x, y, amount):
        self.page.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=amount)
        self.page.settle()

    def check_all_is_seen(self, points):
        box = self.page.bounds("#view")
        for x, y in self.pixels_of(points):
            self.assertTrue(0 <= x <= box["width"] and 0 <= y <= box["height"], (x, y))

    def test_dragging_turns_and_the_wheel_comes_nearer(self):
        before = self.page.evaluate("[dcemViewer.viewpoint.azimuth, dcemViewer.viewpoint.distance]")
        box = self.page.bounds("#view")
        x, y = box["x"] + 200, box["y"] + 300
        self.page.mouse("mousePressed", x, y)
        self.page.mouse("mouseMoved", x + 80, y + 10)
        self.page.mouse("mouseReleased", x + 80, y + 10, buttons=0)
        self.page.call("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-300)
        self.page.settle()
        after = self.page.evaluate("[dcemViewer.viewpoint.azimuth, dcemViewer.viewpoint.distance]")
        self.assertLess(after[0], before[0])
        self.assertLess(after[1], before[1])
        self.assertTrue(self.page.evaluate("document.querySelector('#chosen').hidden"))

    def test_two_fingers_come_nearer(self):
        before = self.page.evaluate("dcemViewer.viewpoint.distance")
        self.page.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        touch = lambda kind, *points: self.page.call(
            "Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])
        touch("touchStart", (300, 300), (400, 300))
        touch("touchMove", (250, 300), (450, 300))
        touch("touchEnd")
        self.page.settle()
        self.page.call("Emulation.setTouchEmulationEnabled", enabled=False)
        self.assertAlmostEqual(self.page.evaluate("dcemViewer.viewpoint.distance") / before, 0.5, delta=0.1)

    def test_the_view_of_all_devices_holds_each_of_them(self):
        devices = [[0, 0, 6], [2, -28, 2], [33, 1, 2], [-25, -12, 3]]
        self.check_all_is_seen(devices)
        self.page.click_on("#view_plan")
        self.page.click_on("#view_devices")
        self.check_all_is_seen(devices)

    def test_the_plan_has_no_perspective_and_north_is_up(self):
        self.assertFalse(self.page.evaluate("dcemViewer.viewpoint.camera.isOrthographicCamera === true"))
        low, high = self.pixels_of([[30, 20, 0], [30, 20, 12]])
        self.assertGreater(math.dist(low, high), 20)  # in perspective
        self.page.click_on("#view_plan")
        self.assertTrue(self.page.evaluate("dcemViewer.viewpoint.camera.isOrthographicCamera"))
        self.assertEqual(self.page.evaluate("document.querySelector('#view_plan').getAttribute('aria-pressed')"), "true")
        origin, *others = self.pixels_of([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 12], [40, 30, 0], [50, 30, 9], [40, 40, 3]])
        east, north, above, far, far_east, far_north = others
        step = east[0] - origin[0]
        self.assertGreater(step, 20)
        for seen, expected in ((east, (origin[0] + step, origin[1])), (north, (origin[0], origin[1] - step)), (above, origin),
                               (far_east, (far[0] + step, far[1])), (far_north, (far[0], far[1] - step))):
            self.assertLess(math.dist(seen, expected), 1e-3)
        scale = self.page.evaluate("dcemViewer.overlay.scale")
        self.assertAlmostEqual(scale["pixels"] / scale["metres"], step / 10, places=6)
        self.view("plan")
        self.page.click_on("#view_plan")
        self.assertLess(math.dist(self.pixels_of([[30, 20, 12]])[0], high), 1e-6)

    def test_dragging_moves_the_plan_and_the_wheel_keeps_what_is_under_the_pointer(self):
        self.page.click_on("#view_plan")
        place = [10, -20, 0]
        x, y = self.page_point(place)
        self.drag(x, y, x + 70, y - 40)
        moved = self.page_point(place)
        self.assertLess(math.dist(moved, (x + 70, y - 40)), 1e-3)
        before = self.page.evaluate("dcemViewer.viewpoint.distance")
        self.wheel(*moved, -400)
        self.assertLess(self.page.evaluate("dcemViewer.viewpoint.distance"), 0.8 * before)
        self.assertLess(math.dist(self.page_point(place), moved), 1)  # the wheel comes at whole pixels
        self.assertEqual(self.page.evaluate("dcemViewer.viewpoint.northOnScreen()"), 0)

    def needle_deg(self):
        return float(self.page.evaluate("document.querySelector('#needle').getAttribute('transform')")[len("rotate("):-1])

    def test_the_needle_points_north(self):
        for azimuth in (-1.9, 0.4, 2.5):
            self.page.evaluate(f"dcemViewer.viewpoint.azimuth = {azimuth}; dcemViewer.viewpoint.place(); true")
            self.page.settle()
            target = self.page.evaluate("dcemViewer.viewpoint.target.toArray().map((v, i) => v + dcemViewer.head.centre_m[i])")
            (x0, y0), (x1, y1) = self.pixels_of([target, [target[0], target[1] + 0.01, target[2]]])
            self.assertAlmostEqual(self.needle_deg(), math.degrees(math.atan2(x1 - x0, y0 - y1)), delta=0.2)
        self.page.click_on("#north")
        self.assertAlmostEqual(self.needle_deg(), 0, delta=0.1)
        (x0, _), (x1, _) = self.pixels_of([[0, 0, 0], [0, 10, 0]])
        self.assertLess(abs(x1 - x0), 20)


if __name__ == "__main__":
    main()
