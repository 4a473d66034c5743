#!/usr/bin/env python3
"""Reference values of the room `em`, in 50 digits with mpmath (pip install mpmath), by routes other than the engine's.

    python3 em_reference.py > em_reference.inc

Half space: the linear system of continuity of the tangential fields at the surface, solved for the reflected and the
transmitted amplitude. Slab: the chain (ABCD) matrix of a line of length d whose wave impedance is that of the medium,
turned into scattering parameters between lines of the impedance of air. Both start from the exact values of the
doubles that are printed, so the only rounding is that of the last printed digit.

exp(+j w t); TE: E across the plane of incidence; TM: E in it, with the sign for which a perfect conductor has
R_te = -1 and R_tm = +1 (the tangential E of TM then reflects with -R_tm).
"""
import mpmath as mp

mp.mp.dps = 50
C0 = 299792458
EPSILON_0 = mp.mpf(float("8.8541878128e-12"))

# (relative permittivity, conductivity in S/m, frequency in Hz, thickness in m)
MEDIA = [
    (5.24, 0.66, 30e9, 0.3),         # about concrete
    (6.31, 0.34, 30e9, 0.005),       # about glass
    (1.99, 0.18, 30e9, 0.04),        # about wood
    (2.73, 0.0, 28e9, 0.013),        # plasterboard without loss
    (4.0, 0.0, 1e9, 0.07),           # near half a wavelength thick
    (1.000001, 0.0, 60e9, 0.1),      # hardly there
    (3.0, 1e-9, 1e8, 1e-6),          # far thinner than a wavelength
    (15.0, 0.035, 1e9, 1.0),         # about ground
    (1.0, 1e7, 100e9, 0.001),        # metal: exp(-2j delta) underflows
    (1.0, 1e7, 1e9, 1e-7),           # metal thinner than its skin depth
]
COSINES = [1.0, 0.999999, 0.9, 0.5, 0.25, 0.1, 1e-3, 1e-6, 0.0]


def medium(eps, sigma, frequency):
    return mp.mpc(mp.mpf(eps), -mp.mpf(sigma) / (2 * mp.pi * mp.mpf(frequency) * EPSILON_0))


def decaying(value):
    root = mp.sqrt(value)
    return -root if root.imag > 0 else root


def half_space(eta, cosine):
    q = decaying(eta - 1 + cosine * cosine)
    # TE, E_y: 1 + R = t; H_x of the waves ~ normal wave number: cos (1 - R) = q t.
    te = mp.lu_solve(mp.matrix([[1, -1], [cosine, q]]), mp.matrix([-1, cosine]))[0]
    # TM, H_y: 1 + R = t (H reflects with R_tm); tangential E ~ normal wave number over permittivity.
    tm = mp.lu_solve(mp.matrix([[1, -1], [cosine, q / eta]]), mp.matrix([-1, cosine]))[0]
    return te, tm


def slab(eta, thickness_rad, cosine):
    q = decaying(eta - 1 + cosine * cosine)
    delta = thickness_rad * q
    result = []
    # Impedances of the tangential fields, in units of that of free space. At exact grazing the limit is taken.
    c = cosine if cosine > 0 else mp.mpf(10) ** -400
    for outer, inner, sign in ((1 / c, 1 / q, 1), (c, q / eta, -1)):
        a = mp.cos(delta)
        b = 1j * inner * mp.sin(delta)
        g = 1j * mp.sin(delta) / inner
        denominator = a + b / outer + g * outer + a
        reflection = (b / outer - g * outer) / denominator
        transmission = 2 / denominator * mp.exp(1j * thickness_rad * cosine)
        result.append((sign * reflection, transmission))
    (rte, tte), (rtm, ttm) = result
    return rte, rtm, tte, ttm


def text(value):
    def part(x):
        return "0.0" if abs(x) < mp.mpf(10) ** -300 else mp.nstr(x, 20, strip_zeros=False)
    value = mp.mpc(value)
    return "{%s, %s}" % (part(value.real), part(value.imag))


print("// Made by em_reference.py; do not edit.")
print("// relative permittivity, conductivity S/m, frequency Hz, thickness m, cosine,")
print("// half space R_te, R_tm; slab R_te, R_tm, insertion T_te, T_tm")
for eps, sigma, frequency, thickness in MEDIA:
    eta = medium(eps, sigma, frequency)
    thickness_rad = 2 * mp.pi * mp.mpf(frequency) / C0 * mp.mpf(thickness)
    for cosine in COSINES:
        c = mp.mpf(cosine)
        values = list(half_space(eta, c)) + list(slab(eta, thickness_rad, c))
        print("{%r, %r, %r, %r, %r,\n %s}," % (eps, sigma, frequency, thickness, cosine,
                                            ",\n ".join(text(v) for v in values)))
