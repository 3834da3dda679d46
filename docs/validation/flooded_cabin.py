"""Equilibrium of the flooded cabin by hydrostatics, and the wet frequencies of its bulkhead by potential flow.

Independent of the program: polygons cut at the waterline, and a cosine series in the half-flooded compartment.
Prints the references of the scenes flooded_cabin and half_flooded_cabin. Needs numpy and scipy.
"""

import argparse

import numpy as np
from scipy.optimize import brentq, fsolve

RHO, G = 1000.0, 9.81
HALF, HEIGHT, WALL = 0.35, 0.52, 0.04
BULKHEAD = 0.01796


def below(polygon, level):
    """Area and first moments of the part of a polygon under y = level."""
    points = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        if a[1] <= level:
            points.append(a)
        if (a[1] - level) * (b[1] - level) < 0:
            points.append(a + (b - a) * (level - a[1]) / (b[1] - a[1]))
    if len(points) < 3:
        return np.zeros(3)
    p = np.array(points)
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return np.array([cross.sum() / 2, ((p + q)[:, 0] * cross).sum() / 6, ((p + q)[:, 1] * cross).sum() / 6])


def displaced(opening):
    """Outline of what keeps water out once the left compartment is flooded, from mid-width and keel: the box without the
    left compartment and without the hole."""
    left, right, deck = -HALF, HALF, HEIGHT
    inner, top, face = -HALF + WALL, HEIGHT - WALL, -BULKHEAD / 2
    return np.array([
        [left, 0], [right, 0], [right, deck], [left, deck], [left, opening[1]], [inner, opening[1]], [inner, top],
        [face, top], [face, WALL], [inner, WALL], [inner, opening[0]], [left, opening[0]],
    ])


def equilibrium(mass, height_of_g, opening):
    """Height of the centre of gravity above the waterline and heel (counter-clockwise) at rest."""
    outline = displaced(opening) - [0.0, height_of_g]

    def residual(x):
        c, s = np.cos(x[1]), np.sin(x[1])
        turned = outline @ np.array([[c, s], [-s, c]])
        area, moment_x, _ = below(turned + [0.0, x[0]], 0.0)
        return [RHO * area / mass - 1, moment_x / area]

    solution, _, flag, message = fsolve(residual, [height_of_g - 0.25, 0.2], full_output=True)
    assert flag == 1, message
    return solution


def shapes(count, length, line_density):
    roots = [brentq(lambda a: np.cos(a) - 1 / np.cosh(a), (n + 1.4) * np.pi, (n + 1.6) * np.pi) for n in range(count)]

    def shape(a):
        sigma = (np.cosh(a) - np.cos(a)) / (np.sinh(a) - np.sin(a))
        f = lambda y: np.cosh(a * y / length) - np.cos(a * y / length) - sigma * (np.sinh(a * y / length) - np.sin(a * y / length))
        return lambda y: f(y) / np.sqrt(line_density * length)

    return roots, [shape(a) for a in roots]


def wet(modulus, thickness, length, width, depth, count=3, terms=400, density=2500.0):
    """Wet frequencies [rad/s] and static deflection at mid-length [m] of a clamped wall of a tank `width` wide."""
    line = density * thickness
    roots, phi = shapes(count, length, line)
    stiffness = np.diag([(a / length) ** 4 * modulus * thickness**3 / 12 / line for a in roots])
    y = np.linspace(0, depth, 4001)
    k = (np.arange(terms) + 0.5) * np.pi / depth
    a = np.array([[np.trapezoid(f(y) * np.cos(kn * y), y) for kn in k] for f in phi])
    added = RHO * (a * (2 / depth / (k * np.tanh(k * width)))) @ a.T
    values = np.linalg.eigvals(np.linalg.solve(np.eye(count) + added, stiffness))
    load = np.array([np.trapezoid(RHO * G * (depth - y) * f(y), y) for f in phi])
    static = np.linalg.solve(stiffness, load)
    middle = sum(q * f(length / 2) for q, f in zip(static, phi))
    return np.sort(np.sqrt(values.real)), middle


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mass", type=float, default=140.0)
    parser.add_argument("--height", type=float, nargs="*", default=[0.1], help="centre of gravity above the keel [m]")
    arguments = parser.parse_args()
    for height in arguments.height:
        x, heel = equilibrium(arguments.mass, height, (0.09, 0.25))
        upright = height - arguments.mass / RHO / (2 * HALF)
        print(f"G {height} m above the keel: {x:.5f} m above the waterline ({upright:.5f} before), heel {heel:.5f} rad")
    print("check, h = 0.3, B = 0.35, 18 mm:", wet(1.8e9, 0.018, 0.44, 0.35, 0.3, 5), "expected 281.72, 990.09, 2143.39; 9.496e-05 m")
    print("half-flooded compartment:", wet(1.8e9, BULKHEAD, 0.44, HALF - WALL - BULKHEAD / 2, 0.22))
