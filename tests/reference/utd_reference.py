#!/usr/bin/env python3
"""Reference values of edge diffraction and of layered walls, with mpmath (pip install mpmath), by routes other than the
engine's. One table per call:

    for table in transition half_plane wedge_plane wedge_line wedge_point double_transition double_screen close_screens \
                 three_screens walk_over_houses rows_of_houses multilayer; do
      python3 utd_reference.py $table > utd_$table.inc
    done

exp(+j w t) throughout. Everything starts from the exact values of the doubles that are printed.

transition     F(x) = sqrt(pi) z exp(z^2) erfc(z), z = exp(j pi/4) sqrt(x), by mpmath's erfc, above x = 300 by its
               asymptotic series. 40 digits.
half_plane     Sommerfeld 1896: u = e^{jkr cos b} erfc(-e^{j pi/4} sqrt(2kr) cos(b/2))/2 for b = phi - phi', and the
               same for phi + phi' with the sign of the boundary condition.
wedge_*        The perfectly conducting wedge: geometrical optics (images) plus the exact diffraction integral
                 u_d = -(1/2 pi n) int_0^inf sum_i s_i sin(t_i/n)/(cosh(x/n) - cos(t_i/n)) g(D(x)) dx,
               t_i = pi + (+-phi +-phi'), D^2 = rho^2 + rho'^2 + 2 rho rho' cosh x + z^2; g = exp(-jkD)/D for a point
               (Bowman, Senior & Uslenghi; Svensson et al., JASA 106, 1999), H0(kD) for a line, and exp(-jk rho cosh x)
               for a plane wave; on the path of steepest descent. The plane wave is compared here with the series of
               eigenfunctions, and the script stops where they differ.
double_transition  The double integral that defines T, inner one by erfc, outer one along a rotated path. 30 digits.
double_screen  Two absorbing screens, Kirchhoff's double integral in Fresnel's approximation (Vogler 1982), inner integral
               by erfc, outer one along a rotated path.
close_screens  The same from a wavelength apart to a kilometre. Heights over the line from end to end: the one nearer to
               it u radii of the first Fresnel zone, the other higher by d*sqrt(wavelength*distance apart), where that
               is less than a slope of 0.2 between them.
three_screens  Three: over the middle screen outside, both others by erfc.
walk_over_houses, rows_of_houses  Vogler's integral over any number of screens in another way: from screen to screen, each
               integral along a path turned by 45 degrees, where the kernel is a real Gaussian, by Gauss-Legendre. Over a
               flat roof between two screens the kernel has the roof's mirror image with it. The script stops where this
               differs from the two tables above, or from 1/(N + 1), by 1e-13.
multilayer     The chain (ABCD) matrix of three lines in a row, in 50 digits.
"""
import sys

import mpmath as mp

mp.mp.dps = 40
J = mp.mpc(0, 1)


def part(x):
    x = mp.mpf(x)
    return "0.0" if abs(x) < mp.mpf("4e-324") else mp.nstr(x, 20, strip_zeros=False)


def text(value):
    value = mp.mpc(value)
    return "{%s, %s}" % (part(value.real), part(value.imag))


def row(numbers, values):
    print("{%s,\n %s}," % (", ".join(repr(float(v)) for v in numbers), ", ".join(text(v) for v in values)))


# --- transition ------------------------------------------------------------------------------------------------------
def transition(x):
    if x == 0:
        return mp.mpc(0)
    if x < 300:
        with mp.workdps(200):
            z = mp.exp(J * mp.pi / 4) * mp.sqrt(x)
            return mp.sqrt(mp.pi) * z * mp.exp(J * x) * mp.erfc(z)
    # 1 - 1/y + 3/y^2 - 15/y^3 + ...; the smallest term is exp(-x).
    y = 2 * J * x
    terms = [mp.mpc(1)]
    while abs(terms[-1]) > mp.mpf(10) ** -60 and len(terms) < 200:
        terms.append(-terms[-1] * (2 * len(terms) - 1) / y)
    return mp.fsum(terms)


def table_transition():
    print("// Made by utd_reference.py transition; do not edit. x, F")
    points = [0.0, 5e-324, 1e-310, 2.2250738585072014e-308]
    points += [10.0 ** e for e in range(-300, -20, 20)]
    points += [m * 10.0 ** e for e in range(-16, 4) for m in (1.0, 1.3, 2.1, 3.7, 4.0, 4.000001, 5.5, 8.2)]
    points += [10.0 ** e for e in list(range(4, 20)) + list(range(20, 320, 20))]
    points += [9.99e16, 1.01e17, 1.7e308]
    for x in sorted(points):
        row([x], [transition(mp.mpf(x))])


# --- half plane ------------------------------------------------------------------------------------------------------
def radians(degrees):
    return mp.mpf(degrees) * mp.pi / 180


def table_half_plane():
    print("// Made by utd_reference.py half_plane; do not edit. n, k r, phi' deg, phi deg; total soft, hard")
    for kr in (0.1, 1.0, 10.0, 1000.0):
        for source in (5.0, 40.0, 90.0, 133.0, 250.0):
            for observer in (2.0, 47.0, 89.0, 137.5, 181.0, 222.0, 271.0, 314.0, 358.0):
                def half(b):
                    return mp.exp(J * kr * mp.cos(b)) / 2 * mp.erfc(
                        -mp.exp(J * mp.pi / 4) * mp.sqrt(2 * mp.mpf(kr)) * mp.cos(b / 2))
                direct = half(radians(observer - source))
                mirror = half(radians(observer + source))
                row([2.0, kr, source, observer], [direct - mirror, direct + mirror])


# --- wedges ----------------------------------------------------------------------------------------------------------
def diffraction_integral(n, source, observer, w_to_cosh, kernel):
    """Both halves, difference and sum angles, of the integral over the steepest descent path; kernel(w) contains
    exp(-w^2), w_to_cosh(w) = (cosh x - 1, d(cosh x)/dw)."""
    angles = [(mp.pi + s1 * observer + s2 * source, 0 if s1 != s2 else 1) for s1 in (1, -1) for s2 in (1, -1)]

    def integrand(w, which):
        less_one, derivative = w_to_cosh(w)
        sinh = mp.sqrt(less_one * (less_one + 2))
        x = mp.asinh(sinh) if less_one.real > -1 else mp.log(1 + less_one + sinh)
        total = mp.mpc(0)
        for angle, group in angles:
            if group == which:
                total += mp.sin(angle / n) / (mp.cosh(x / n) - mp.cos(angle / n))
        return total * kernel(w) * derivative / sinh

    points = [mp.mpf(p) for p in ("0", "0.05", "0.25", "0.8", "1.8", "3.5", "6.5")]
    return [-mp.quad(lambda w, g=g: integrand(w, g), points, method="gauss-legendre") / (2 * mp.pi * n)
            for g in (0, 1)]


def geometrical(n, source, observer, direct, mirror):
    """Direct and reflected fields; mirror(image azimuth) and direct(azimuth) give the field of a source there."""
    incident = direct(source) if abs(observer - source) < mp.pi else mp.mpc(0)
    reflected = mp.mpc(0)
    if observer + source < mp.pi:
        reflected += mirror(-source)
    if 2 * n * mp.pi - observer - source < mp.pi:
        reflected += mirror(2 * n * mp.pi - source)
    return incident, reflected


def plane_total(n, kr, source, observer):
    def w_to_cosh(w):
        return mp.mpc(0, -w * w / kr), mp.mpc(0, -2 * w / kr)

    difference, total = diffraction_integral(n, source, observer, w_to_cosh,
                                             lambda w: mp.exp(-J * kr - w * w))
    field = lambda azimuth: mp.exp(J * kr * mp.cos(observer - azimuth))
    incident, reflected = geometrical(n, source, observer, field, field)
    return incident + difference - reflected - total, incident + difference + reflected + total


def plane_series(n, kr, source, observer):
    soft = mp.mpc(0)
    hard = mp.besselj(0, kr)
    m = 1
    while True:
        order = mp.mpf(m) / n
        wave = 2 * mp.exp(J * mp.pi * order / 2) * mp.besselj(order, kr)
        soft += wave * mp.sin(order * source) * mp.sin(order * observer)
        hard += wave * mp.cos(order * source) * mp.cos(order * observer)
        if order > kr and abs(wave) < mp.mpf(10) ** -18:
            return 2 / n * soft, 2 / n * hard
        m += 1


WEDGES = (1.25, 1.5, 1.75)
SOURCES = {1.25: (20.0, 75.0, 170.0), 1.5: (12.0, 60.0, 215.0), 1.75: (33.0, 100.0, 290.0)}
FRACTIONS = (0.03, 0.17, 0.31, 0.44, 0.58, 0.71, 0.83, 0.97)


def table_wedge_plane():
    mp.mp.dps = 20
    print("// Made by utd_reference.py wedge_plane; do not edit. n, k r, phi' deg, phi deg; total soft, hard")
    for n in WEDGES:
        for kr in (10.0, 40.0, 200.0):
            for source in SOURCES[n]:
                for number, fraction in enumerate(FRACTIONS):
                    observer = float(round(fraction * n * 180.0, 1))
                    values = plane_total(mp.mpf(n), mp.mpf(kr), radians(source), radians(observer))
                    if kr < 100.0 and number % 3 == 0:
                        for a, b in zip(values, plane_series(mp.mpf(n), mp.mpf(kr), radians(source), radians(observer))):
                            assert abs(a - b) < 1e-14, (n, kr, source, observer, a, b)
                    row([n, kr, source, observer], values)


def distance_path(k, rho_source, rho, z):
    nearest = mp.sqrt((rho_source + rho) ** 2 + z * z)

    def distance(w):
        return nearest - J * w * w / k

    def w_to_cosh(w):
        step = -J * w * w / k
        return step * (2 * nearest + step) / (2 * rho * rho_source), distance(w) * (-2 * J * w / k) / (rho * rho_source)

    return distance, w_to_cosh


def table_wedge_line():
    mp.mp.dps = 20
    print("// Made by utd_reference.py wedge_line; do not edit. n, k, rho', phi' deg, rho, phi deg; total soft, hard of H0(kR)")
    for n in WEDGES:
        for k, rho_source, rho in ((1.0, 20.0, 50.0), (2.0, 60.0, 15.0)):
            for source in SOURCES[n][:2]:
                for fraction in FRACTIONS[1::2]:
                    observer = float(round(fraction * n * 180.0, 1))
                    distance, w_to_cosh = distance_path(mp.mpf(k), mp.mpf(rho_source), mp.mpf(rho), mp.mpf(0))
                    a, b = radians(source), radians(observer)
                    difference, total = diffraction_integral(mp.mpf(n), a, b, w_to_cosh,
                                                             lambda w: mp.hankel2(0, k * distance(w)))
                    field = lambda azimuth: mp.hankel2(0, k * mp.sqrt(
                        rho ** 2 + rho_source ** 2 - 2 * rho * rho_source * mp.cos(b - azimuth)))
                    incident, reflected = geometrical(mp.mpf(n), a, b, field, field)
                    row([n, k, rho_source, source, rho, observer],
                        [incident + difference - reflected - total, incident + difference + reflected + total])


def table_wedge_point():
    mp.mp.dps = 20
    print("// Made by utd_reference.py wedge_point; do not edit.")
    print("// n, k, rho', phi' deg, rho, phi deg, z; total soft, hard of exp(-jkR)/R")
    for n in WEDGES + (2.0,):
        for k, rho_source, rho, z in ((3.0, 10.0, 15.0, 20.0), (10.0, 4.0, 30.0, -60.0)):
            for source in SOURCES.get(n, (30.0, 110.0))[:2]:
                for fraction in FRACTIONS[1::2]:
                    observer = float(round(fraction * n * 180.0, 1))
                    distance, w_to_cosh = distance_path(mp.mpf(k), mp.mpf(rho_source), mp.mpf(rho), mp.mpf(z))
                    a, b = radians(source), radians(observer)
                    difference, total = diffraction_integral(
                        mp.mpf(n), a, b, w_to_cosh, lambda w: mp.exp(-J * k * distance(w)) / distance(w))

                    def field(azimuth):
                        reach = mp.sqrt(mp.mpf(rho) ** 2 + mp.mpf(rho_source) ** 2 + mp.mpf(z) ** 2
                                        - 2 * mp.mpf(rho) * rho_source * mp.cos(b - azimuth))
                        return mp.exp(-J * k * reach) / reach

                    incident, reflected = geometrical(mp.mpf(n), a, b, field, field)
                    row([n, k, rho_source, source, rho, observer, z],
                        [incident + difference - reflected - total, incident + difference + reflected + total])


# --- two edges -------------------------------------------------------------------------------------------------------
def tail(z):  # exp(j z^2) int_z^inf exp(-j t^2) dt
    q = mp.exp(J * mp.pi / 4)
    return mp.exp(J * z * z) * mp.sqrt(mp.pi) / 2 / q * mp.erfc(q * z)


def double_transition(alpha, beta, rho, s):
    turn = mp.exp(-J * mp.pi / 4)

    def integrand(r):
        return mp.exp(-2 * J * s * beta * turn * r - r * r) * tail(s * alpha - rho * turn * r)

    points = [0] + sorted([mp.mpf(x) / (1 + s * beta) for x in (0.3, 1, 3, 8, 20)] +
                          [x / s for x in (0.5, 1, 2, 3, 4, 6, 9)])
    return -4 * s * s * alpha * beta * turn * mp.quad(integrand, points)


def table_double_transition():
    print("// Made by utd_reference.py double_transition; do not edit. alpha, beta, rho, s; T")
    for s in (1e-4, 0.01, 0.2, 0.7, 0.999):
        for alpha, beta in ((1e-3, 2e-3), (0.03, 1.0), (0.5, 0.5000001), (1.7, 0.9), (2.1, 2.2), (4.0, 0.2), (3.1, 5.0),
                            (9.0, 11.0), (100.0, 0.7), (70.0, 70.1), (1500.0, 0.01), (800.0, 900.0)):
            for sign in (-1, 1):
                s_exact, a, b = mp.mpf(s), mp.mpf(alpha), mp.mpf(beta)
                rho = sign * mp.sqrt(1 - s_exact * s_exact)
                row([alpha, beta, rho, s], [double_transition(a, b, rho, s_exact)])


# --- screens ---------------------------------------------------------------------------------------------------------
def over_screen(k, height, before, after, neighbours):
    """The field over a screen between two ways; neighbours: how much of it the others pass, at each height."""
    curvature = 1 / before + 1 / after
    scale = mp.sqrt(2 / (k * curvature))
    points = [0] + [scale * 10 * mp.mpf(2) ** -n for n in range(16, -1, -1)]

    def upwards(start, sign):
        def integrand(w):
            x = start + mp.exp(-J * mp.pi / 4) * w
            return mp.exp(-J * k / 2 * curvature * x * x) * neighbours(sign * x)
        whole = mp.sqrt(J * k * curvature / (2 * mp.pi)) * mp.exp(-J * mp.pi / 4)
        return whole * mp.quad(integrand, points, method="gauss-legendre")

    if height >= 0:
        return upwards(height, 1)
    return neighbours(None) - upwards(-height, -1)  # all of it, but for what would pass below


def passes(k, height, way, other_way):
    """The share of the field from one end to a height on the next screen that passes over this one."""
    q = 1 / way + 1 / other_way
    return lambda x: mp.erfc(mp.sqrt(J * k * q / 2) * (height - x / (other_way * q))) / 2


def single_screen(k, height, before, after):
    return mp.erfc(mp.sqrt(J * k / 2 * (1 / before + 1 / after)) * height) / 2


def double_screen(k, a, b, c, height_1, height_2):
    second = passes(k, height_2, c, b)
    return over_screen(k, height_1, a, b + c,
                       lambda x: single_screen(k, height_2, a + b, c) if x is None else second(x))


def three_screens(k, a, b, c, d, height_1, height_2, height_3):
    first, third = passes(k, height_1, a, b), passes(k, height_3, d, c)
    return over_screen(k, height_2, a + b, c + d,
                       lambda x: double_screen(k, a, b + c, d, height_1, height_3) if x is None else first(x) * third(x))


def table_double_screen():
    mp.mp.dps = 30
    print("// Made by utd_reference.py double_screen; do not edit. k, legs a, b, c, heights 1, 2; field over free space")
    assert abs(double_screen(mp.mpf(600), *[mp.mpf(100)] * 3, mp.mpf(0), mp.mpf(0)) - mp.mpf(1) / 3) < 1e-15
    for a, b, c in ((100.0, 100.0, 100.0), (300.0, 50.0, 120.0), (80.0, 400.0, 60.0)):
        for first, second in ((0.0, 0.0), (1.0, 1.0), (0.5, 2.0), (2.0, 0.3), (3.0, 3.0), (0.2, 0.0)):
            values = [mp.mpf(v) for v in (600.0, a, b, c, first, second)]
            row([600.0, a, b, c, first, second], [double_screen(*values)])


def table_close_screens():
    mp.mp.dps = 45
    print("// Made by utd_reference.py close_screens; do not edit. k, legs a, b, c, heights 1, 2; field over free space")
    for wavelength, a, c in ((0.01, 200.0, 200.0), (0.1, 1000.0, 60.0)):
        k = float(2 * mp.pi / wavelength)
        for b in (b for b in (0.01, 0.1, 1.0, 10.0, 100.0, 1000.0) if b >= wavelength):
            before, after = a + b / 2, c + b / 2
            radius = (wavelength * before * after / (before + after)) ** 0.5
            for u in (-5.0, -2.0, -0.6, 0.0, 0.3, 1.0, 2.5, 5.0):
                for d in (-5.0, -1.5, -0.2, 0.0, 0.2, 1.5, 5.0):
                    step = d * (wavelength * b) ** 0.5
                    if abs(step) > 0.2 * b:
                        continue
                    first, second = u * radius, u * radius + step
                    if abs(second) < abs(first) or (d < 0 and u == 0):
                        first, second = u * radius - step, u * radius
                    if abs(first) > 0.3 * a or abs(second) > 0.3 * c:
                        continue
                    values = [mp.mpf(v) for v in (k, a, b, c, first, second)]
                    row([k, a, b, c, first, second], [double_screen(*values)])


def table_three_screens():
    mp.mp.dps = 45
    print("// Made by utd_reference.py three_screens; do not edit. k, legs a to d, heights 1 to 3; field over free space")
    assert abs(three_screens(mp.mpf(600), *[mp.mpf(100)] * 4, *[mp.mpf(0)] * 3) - mp.mpf(1) / 4) < 1e-15
    for legs in ((100.0, 100.0, 100.0, 100.0), (200.0, 2.0, 2.0, 200.0), (200.0, 2.0, 100.0, 50.0), (20.0, 300.0, 40.0, 90.0)):
        for heights in ((0.0, 0.0, 0.0), (0.3, 0.3, 0.3), (1.0, 1.0, 1.0), (0.5, 0.9, 0.6), (0.5, 0.1, 0.4), (-0.4, 0.2, 0.1),
                        (-0.5, -0.6, -0.5), (2.0, 2.1, 2.0)):
            values = [mp.mpf(v) for v in (600.0,) + legs + heights]
            row((600.0,) + legs + heights, [three_screens(*values)])


def turned_nodes(k, before, after, shortest, lift):
    """Nodes and weights along e^{-j pi/4} w: out to where the Gaussian of both ends is 1e-20, finer than the kernels."""
    scale = mp.sqrt(2 / (k / before + k / after))
    last = 7 * scale + lift * scale * scale * k
    step = min(scale, mp.sqrt(2 * shortest / k)) * 3
    pieces = int(mp.ceil(last / step))
    nodes = []
    for piece in range(pieces):
        for x, w in TWENTY_NODES:
            nodes.append((last / pieces * (piece + (1 + x) / 2), last / pieces * w / 2))
    return nodes


def gauss_legendre(count):
    with mp.workdps(50):
        slope = lambda x: count * (x * mp.legendre(count, x) - mp.legendre(count - 1, x)) / (x * x - 1)
        nodes = []
        for i in range(count):
            x = mp.cos(mp.pi * (i + mp.mpf("0.75")) / (count + mp.mpf("0.5")))
            for _ in range(8):
                x -= mp.legendre(count, x) / slope(x)
            nodes.append((x, 2 / ((1 - x * x) * slope(x) ** 2)))
        return nodes


TWENTY_NODES = gauss_legendre(20) if sys.argv[1] in ("walk_over_houses", "rows_of_houses") else []


class Screens:
    """Screens at given distances and heights from a source; `roofs[i]`: what a roof from screen i to i + 1 reflects."""

    def __init__(self, k, places, heights, source_height, farthest, roofs=()):
        self.k, self.places, self.heights, self.source = k, places, heights, source_height
        self.roofs = list(roofs) or [0] * (len(places) - 1)
        turn = mp.exp(-J * mp.pi / 4)
        gaps = [b - a for a, b in zip(places, places[1:])]
        self.nodes, self.points = [], []
        for i, place in enumerate(places):
            lift = max(0, (source_height - heights[i]) / place) + mp.mpf("0.02")
            self.nodes.append(turned_nodes(k, place, farthest - place, min(gaps + [farthest - places[-1]]), lift))
            self.points.append([heights[i] + turn * w for w, _ in self.nodes[i]])
        field = [self.kernel(places[0], y - source_height) for y in self.points[0]]
        for i, gap in enumerate(gaps):
            field = self.next(field, i, gap)
        self.field = field

    def kernel(self, way, climb):
        return mp.exp(-J * self.k * climb * climb / (2 * way)) / mp.sqrt(way)

    def next(self, field, i, gap):
        turn = mp.exp(-J * mp.pi / 4)
        weighted = [u * w * turn for u, (_, w) in zip(field, self.nodes[i])]
        mirror, climb = self.roofs[i], self.heights[i + 1] - self.heights[i]
        ways, rate, shift = [float(w) for w, _ in self.nodes[i]], float(self.k / (2 * gap)), float(climb) / 2 ** 0.5
        far = 160 + rate * shift * shift  # e^-160 of the rest

        def at(y, w):
            near = [j for j, v in enumerate(ways) if rate * (w - v + shift) ** 2 < far]
            total = mp.fsum(self.kernel(gap, y - self.points[i][j]) * weighted[j] for j in near)
            if mirror:
                images = [j for j, v in enumerate(ways) if rate * (w + v) ** 2 < far]
                total += mirror * mp.fsum(
                    self.kernel(gap, y + self.points[i][j] - 2 * self.heights[i]) * weighted[j] for j in images)
            return total
        return [at(y, float(w)) for y, (w, _) in zip(self.points[i + 1], self.nodes[i + 1])]

    def over_free_space(self, place, height):
        turn, way = mp.exp(-J * mp.pi / 4), place - self.places[-1]
        total = mp.fsum(u * w * turn * self.kernel(way, height - y)
                        for u, y, (_, w) in zip(self.field, self.points[-1], self.nodes[-1]))
        count = len(self.places)
        return total * mp.sqrt(J * self.k / (2 * mp.pi)) ** count / self.kernel(place, height - self.source)


def check_screens():
    hundreds = [mp.mpf(100) * i for i in range(1, 11)]
    for count in (1, 2, 3, 10):
        screens = Screens(mp.mpf(600), hundreds[:count], [mp.mpf(0)] * count, mp.mpf(0), mp.mpf(100) * (count + 1))
        assert abs(screens.over_free_space(mp.mpf(100) * (count + 1), mp.mpf(0)) - mp.mpf(1) / (count + 1)) < 1e-13
    for heights in ((1.0, 2.0), (-0.5, 0.3), (-1.0, -1.0)):
        first, second = [mp.mpf(h) for h in heights]
        screens = Screens(mp.mpf(600), [mp.mpf(100), mp.mpf(150)], [first, second], mp.mpf(0), mp.mpf(250))
        other = double_screen(mp.mpf(600), mp.mpf(100), mp.mpf(50), mp.mpf(100), first, second)
        assert abs(screens.over_free_space(mp.mpf(250), mp.mpf(0)) - other) < 1e-13


FREQUENCIES_HZ = (0.8e9, 3.5e9, 30e9)


def wave_number(frequency_hz):
    return 2 * mp.pi * mp.mpf(frequency_hz) / 299792458


def table_walk_over_houses():
    mp.mp.dps = 30
    check_screens()
    print("// Made by utd_reference.py walk_over_houses; do not edit. From a source 300 m before the first rim and 12 m over")
    print("// the rims to a receiver 6 m below them: frequency_hz, depth of the house or of the yard between two walls,")
    print("// distance behind the last rim; field over free space behind two thin walls, behind a house with E along the")
    print("// rims, with H along them, behind the last wall alone")
    for frequency in FREQUENCIES_HZ:
        k = wave_number(frequency)
        for depth in (10.0, 40.0):
            places = [mp.mpf(300), mp.mpf(300) + mp.mpf(depth)]
            heights, source, farthest = [mp.mpf(0)] * 2, mp.mpf(12), mp.mpf(700)
            all_of = [Screens(k, places, heights, source, farthest, [roof]) for roof in (0, -1, 1)]
            all_of.append(Screens(k, places[1:], heights[1:], source, farthest))
            for behind in (40.0, 50.0, 65.0, 80.0, 100.0, 120.0, 140.0, 155.0, 170.0, 190.0, 220.0, 260.0, 320.0):
                row([frequency, depth, behind],
                    [one.over_free_space(places[1] + mp.mpf(behind), mp.mpf(-6)) for one in all_of])


def table_rows_of_houses():
    mp.mp.dps = 30
    check_screens()
    print("// Made by utd_reference.py rows_of_houses; do not edit. Walls 40 m apart, the first 500 m from a source; a receiver")
    print("// 20 m behind the last and 6 m below the rims: frequency_hz, walls, height of the source over the rims;")
    print("// field over free space")
    for frequency in FREQUENCIES_HZ:
        for walls in (3, 10):
            for source in (2.0, 10.0, 40.0):
                if wave_number(frequency) * (mp.mpf(source) / 500) ** 2 * 40 > 60:
                    continue  # so far in the light that 30 digits cancel; the rims before the last do nothing there
                places = [mp.mpf(500) + 40 * i for i in range(walls)]
                screens = Screens(wave_number(frequency), places, [mp.mpf(0)] * walls, mp.mpf(source), places[-1] + 20)
                field = screens.over_free_space(places[-1] + 20, mp.mpf(-6))
                assert abs(field) < 1
                row([frequency, walls, source], [field])


# --- layers ----------------------------------------------------------------------------------------------------------
LAYERS = [
    ((5.24, -0.39, 30.0), (1.0, 0.0, 55.0), (6.31, -0.2, 4.0)),      # concrete, air gap, glass
    ((6.31, -0.02, 2.5), (1.0, 0.0, 10.0), (6.31, -0.02, 2.5)),      # double glazing
    ((2.73, 0.0, 8.2), (1.5, 0.0, 33.0), (2.73, 0.0, 8.2)),          # without loss
    ((1.000001, 0.0, 3.0), (1.00002, -1e-7, 2.0), (1.0, -1e-6, 1.0)),  # hardly there
    ((4.0, -1e-3, 1e-6), (9.0, -3.0, 1e-5), (2.0, 0.0, 1e-7)),       # far thinner than a wavelength
    ((2.0, -0.5, 900.0), (5.0, -2.0, 300.0), (3.0, -1.0, 40.0)),     # thick: e^-400
]
COSINES = [1.0, 0.93, 0.5, 0.2, 0.01, 1e-5, 0.0]


def multilayer(layers, cosine):
    air = cosine if cosine > 0 else mp.mpf(10) ** -400
    result = []
    for polarization in ("te", "tm"):
        a, b, c, d = mp.mpc(1), mp.mpc(0), mp.mpc(0), mp.mpc(1)
        phase = mp.mpf(0)
        for real, imaginary, thickness in layers:
            eta = mp.mpc(mp.mpf(real), mp.mpf(imaginary))
            q = mp.sqrt(eta - 1 + cosine * cosine)
            q = -q if q.imag > 0 else q
            if q == 0:
                q = mp.mpc(mp.mpf(10) ** -400)
            impedance = 1 / q if polarization == "te" else q / eta
            delta = mp.mpf(thickness) * q
            ca, cb, cc = mp.cos(delta), J * impedance * mp.sin(delta), J * mp.sin(delta) / impedance
            a, b, c, d = a * ca + b * cc, a * cb + b * ca, c * ca + d * cc, c * cb + d * ca
            phase += mp.mpf(thickness) * cosine
        outer = 1 / air if polarization == "te" else air
        denominator = a + b / outer + c * outer + d
        reflection = (a + b / outer - c * outer - d) / denominator
        result.append((reflection if polarization == "te" else -reflection, 2 / denominator * mp.exp(J * phase)))
    (rte, tte), (rtm, ttm) = result
    return rte, rtm, tte, ttm


def table_multilayer():
    mp.mp.dps = 50
    print("// Made by utd_reference.py multilayer; do not edit.")
    print("// three times (permittivity, k d), cosine; R_te, R_tm, insertion T_te, T_tm")
    for layers in LAYERS:
        for cosine in COSINES:
            # Room for the cancellation of the thick layers and of the limit at grazing.
            with mp.workdps(1000):
                values = multilayer(layers, mp.mpf(cosine))
            row([v for layer in layers for v in layer] + [cosine], values)


globals()["table_" + sys.argv[1]]()
