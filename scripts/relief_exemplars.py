#!/usr/bin/env python3
"""Draws the reliefs of examples/ that are made by formulas: dunes, mail, scales, knitting, bark.

    python3 scripts/relief_exemplars.py [FOLDER]

writes relief-dunes.ply, relief-mail.ply, relief-scales.ply, relief-knit.ply and relief-bark.ply: points on the unit
square with normals and colours. Needs numpy.
"""
import sys

import numpy as np

TAU = 2 * np.pi


def write(folder, name, points, normals, colours):
    """A binary PLY of what lies on the unit square, in a random order."""
    inside = np.all((points[:, :2] >= 0) & (points[:, :2] < 1), axis=1)
    points, normals, colours = points[inside], normals[inside], colours[inside]
    order = np.random.default_rng(1).permutation(len(points))
    kinds = [(n, "<f4") for n in ("x", "y", "z", "nx", "ny", "nz")] + [(n, "u1") for n in ("red", "green", "blue")]
    table = np.zeros(len(points), dtype=kinds)
    for k, axis in enumerate("xyz"):
        table[axis], table["n" + axis] = points[order, k], normals[order, k]
    for k, name_of in enumerate(("red", "green", "blue")):
        table[name_of] = np.clip(colours[order, k], 0, 255)
    names = {"<f4": "float", "u1": "uchar"}
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property {names[kind]} {n}" for n, kind in kinds] + ["end_header", ""]
    with open(f"{folder}/relief-{name}.ply", "wb") as file:
        file.write("\n".join(head).encode() + table.tobytes())
    print(f"relief-{name}.ply: {len(points)} points")


def sheet(height, count, seed):
    """Points spread evenly over the surface of a height field, steep parts included, with normals."""
    random = np.random.default_rng(seed)
    def normal(x, y, e=1e-4):
        slope = [(height(x + e, y) - height(x - e, y)) / (2 * e), (height(x, y + e) - height(x, y - e)) / (2 * e)]
        n = np.stack([-slope[0], -slope[1], np.ones_like(x)], axis=1)
        return n / np.linalg.norm(n, axis=1)[:, None]
    # Many random places, as many more as the surface is steep, then thinned to what keeps a distance.
    x, y = random.uniform(size=(2, 40 * count))
    steep = np.minimum(1 / normal(x, y)[:, 2], 4)
    kept = random.uniform(size=len(x)) < steep / 4
    x, y = x[kept], y[kept]
    points = np.stack([x, y, height(x, y)], axis=1)
    points = apart(points, 0.78 * np.sqrt(np.mean(steep) / count))
    return points, normal(points[:, 0], points[:, 1])


def apart(points, distance):
    """Points of which none is nearer to one before it than `distance`."""
    cells, kept = {}, []
    for i, p in enumerate(points):
        c = tuple((p // distance).astype(int))
        near = (j for dx in (-1, 0, 1) for dy in (-1, 0, 1) for dz in (-1, 0, 1)
                for j in cells.get((c[0] + dx, c[1] + dy, c[2] + dz), ()))
        if all(np.sum((points[j] - p) ** 2) >= distance**2 for j in near):
            cells.setdefault(c, []).append(i)
            kept.append(i)
    return points[kept]


def tube(curve, radius, spacing):
    """Points around a curve over 0 to 1, with normals."""
    t = np.linspace(0, 1, 4001)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(curve(t), axis=0), axis=1))])
    along, around = max(int(length[-1] / spacing), 4), max(round(TAU * radius / spacing), 6)
    t = np.interp((np.arange(along) + 0.5) / along * length[-1], length, t)
    way = curve(t + 1e-4) - curve(t - 1e-4)
    way /= np.linalg.norm(way, axis=1)[:, None]
    u = np.cross(way, [0, 0, 1.0])
    u /= np.linalg.norm(u, axis=1)[:, None]
    v = np.cross(u, way)
    angle = (np.arange(around)[None, :] + 0.5 * (np.arange(along) % 2)[:, None]) / around * TAU
    normal = np.cos(angle)[..., None] * u[:, None] + np.sin(angle)[..., None] * v[:, None]
    return (curve(t)[:, None] + radius * normal).reshape(-1, 3), normal.reshape(-1, 3)


def shaded(points, low, high):
    """From one colour below to another above."""
    z = points[:, 2]
    share = (z - z.min()) / (z.max() - z.min())
    return np.outer(1 - share, low) + np.outer(share, high)


def dunes(folder):
    def height(x, y):
        bent = 0.03 * np.sin(TAU * (1.1 * y + 0.3)) + 0.02 * np.sin(TAU * (1.9 * y - 0.6 * x)) + 0.012 * np.sin(TAU * (3.1 * y + 1.3 * x))
        phase = TAU * (7 * x + 7 * bent)
        crest = np.sin(phase + 0.55 * np.sin(phase))
        return (0.012 + 0.004 * np.sin(TAU * (1.2 * y + 0.8 * x))) * crest
    points, normals = sheet(height, 4200, 2)
    write(folder, "dunes", points, normals, shaded(points, (168, 120, 78), (238, 208, 150)))


def scales(folder):
    random = np.random.default_rng(3)
    side, jitter = 1 / 6, random.uniform(-0.05, 0.05, (2, 40, 40))
    def height(x, y):
        top = np.full_like(x, -1.0)
        row, column = np.floor(y / (0.6 * side)).astype(int), np.floor(x / side).astype(int)
        for dr in range(-1, 4):
            for dc in (-1, 0, 1):
                r, c = row + dr, column + dc
                shift = jitter[:, r % 40, c % 40]
                u = (x - (c + 0.5 + 0.5 * (r % 2) + shift[0]) * side) / (0.56 * side)
                v = ((r + 0.5 + shift[1]) * 0.6 * side - y) / (1.25 * side)
                # A scale is round at its lower end and lies highest there, has a ridge, and round edges.
                edge = np.where(v > 0.35, np.hypot(u, (v - 0.35) / 0.65), np.abs(u))
                z = side * (0.34 * v + 0.10 * (1 - u * u) - 1.6 * np.maximum(edge - 0.75, 0) ** 2)
                top = np.maximum(top, np.where((edge < 1) & (v > -0.6), z, -1.0))
        return top
    # A cliff without a slope would have no points.
    def sloping(x, y, r=0.008):
        around = ((0, 0), (r, 0), (-r, 0), (0, r), (0, -r))
        return sum(height(x + dx, y + dy) for dx, dy in around) / len(around)
    points, normals = sheet(sloping, 4200, 4)
    write(folder, "scales", points, normals, shaded(points, (30, 66, 62), (110, 176, 132)))


def bark(folder):
    random = np.random.default_rng(7)
    waves = [(random.uniform(1, 3.5), random.uniform(2, 7), random.uniform(0, TAU)) for _ in range(24)]
    def height(x, y):
        noise = [np.cos(TAU * (a * (x if k % 2 else -x) + 0.35 * b * y) + c) for k, (a, b, c) in enumerate(waves)]
        bent, breaks = sum(noise[:10]) / 10, sum(noise[10:]) / 14
        ridge = np.sqrt(np.sin(TAU * (3.2 * x + 0.55 * bent)) ** 2 + 0.16)
        # Ridges are broken across in places.
        crack = np.exp(-((np.sin(TAU * (1.6 * y + 0.8 * bent + 0.5 * breaks)) / 0.4) ** 2))
        return 0.036 * ridge * (1 - 0.3 * crack) + 0.004 * breaks
    points, normals = sheet(height, 4600, 8)
    write(folder, "bark", points, normals, shaded(points, (66, 46, 32), (158, 124, 92)))


def mail(folder):
    random = np.random.default_rng(5)
    side, all_points, all_normals = 1 / 5, [], []
    for j in range(-1, 7):
        for i in range(-1, 7):
            x, y = (i + 0.5 + random.normal(0, 0.012)) * side, (j + 0.5 + random.normal(0, 0.012)) * side
            lean = (0.45 if (i + j) % 2 else -0.45) + random.normal(0, 0.02)
            def ring(t, x=x, y=y, lean=lean):
                a, b = 0.72 * side * np.cos(TAU * t), 0.72 * side * np.sin(TAU * t)
                return np.stack([x + a * np.cos(lean), y + b, a * np.sin(lean)], axis=1)
            points, normals = tube(ring, 0.115 * side, 0.0215)
            all_points.append(points)
            all_normals.append(normals)
    points = np.concatenate(all_points)
    write(folder, "mail", points, np.concatenate(all_normals), shaded(points, (96, 104, 116), (206, 212, 220)))


def knit(folder):
    random = np.random.default_rng(6)
    side, rise, all_points, all_normals = 1 / 5, 1 / 6, [], []
    for j in range(-2, 8):
        wobble = random.uniform(0, TAU, 2)
        def yarn(t, j=j, wobble=wobble):
            s = (1.3 * t - 0.15) / side
            x = side * (s + 0.23 * np.sin(2 * TAU * s)) + 0.004 * np.sin(5 * t + wobble[0])
            y = rise * (j + 0.5 - 0.68 * np.cos(TAU * s)) + 0.004 * np.sin(9 * t + wobble[1])
            z = 0.034 * np.cos(2 * TAU * s) + 0.012 * np.cos(TAU * s)
            return np.stack([x, y, z], axis=1)
        points, normals = tube(yarn, 0.0235, 0.0225)
        all_points.append(points)
        all_normals.append(normals)
    points = np.concatenate(all_points)
    write(folder, "knit", points, np.concatenate(all_normals), shaded(points, (120, 30, 42), (224, 92, 84)))


if __name__ == "__main__":
    target = sys.argv[1] if len(sys.argv) > 1 else "examples"
    for draw in (dunes, mail, scales, knit, bark):
        draw(target)
