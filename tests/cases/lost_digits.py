"""Writes lost_digits.json: trajectories of bodies that lose digits, by a solver with 400 bits that shares nothing with the library.

Plane scenes of linear triangles on a uniform criss-cross mesh, one load held, trapezoid. Needs python-flint:

    pip install python-flint && python3 lost_digits.py
"""
import json
import pathlib

from flint import arb, arb_mat, ctx

ctx.prec = 400


def number(x):
    return arb(float(x))


def middle(m):
    return arb_mat([[x.mid() for x in row] for row in m.table()])


def assemble(scene):
    """A and B on the free components (contact last), the load, contact weights."""
    (nx, ny), (lx, ly) = scene["mesh"]["cells"], scene["mesh"]["size"]
    # coordinates are data: the library's doubles, so that both solve one problem
    xs = [number(lx * i / nx) for i in range(nx + 1)]
    ys = [number(ly * j / ny) for j in range(ny + 1)]
    nodes = [(x, y) for y in ys for x in xs]
    corners, triangles = len(nodes), []
    for j in range(ny):
        for i in range(nx):
            at = j * (nx + 1) + i
            square = [at, at + 1, at + nx + 2, at + nx + 1]
            centre = corners + j * nx + i
            nodes.append((number(lx * (i + 0.5) / nx), number(ly * (j + 0.5) / ny)))
            triangles += [(square[s], square[(s + 1) % 4], centre) for s in range(4)]
    viscosity, elasticity = scene["material"]["viscosity"], scene["material"]["elasticity"]
    young, poisson = number(elasticity["young"]), number(elasticity["poisson"])
    forms = [
        (number(viscosity["mu1"]), number(viscosity["mu2"])),
        (young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (1 + poisson)),  # plane strain
    ]
    clamped = {j * (nx + 1) for j in range(ny + 1)}
    contact = [n for n in range(nx + 1) if n not in clamped]
    dof = {}
    for n in range(len(nodes)):
        if n not in clamped and n not in contact:
            dof[n, 0], dof[n, 1] = len(dof), len(dof) + 1
    for n in contact:
        dof[n, 0] = len(dof)
    size = len(dof)
    operators = [[[arb(0)] * size for _ in range(size)] for _ in forms]
    for t in triangles:
        (x0, y0), (x1, y1), (x2, y2) = (nodes[n] for n in t)
        det = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        g = [((y1 - y2) / det, (x2 - x1) / det), ((y2 - y0) / det, (x0 - x2) / det), ((y0 - y1) / det, (x1 - x0) / det)]
        for a in range(3):
            for b in range(3):
                dot = g[a][0] * g[b][0] + g[a][1] * g[b][1]
                for i in range(2):
                    for j in range(2):
                        row, column = dof.get((t[a], i)), dof.get((t[b], j))
                        if row is None or column is None:
                            continue
                        for k, (lam, two_mu) in zip(operators, forms):
                            shear = g[a][j] * g[b][i] + (dot if i == j else 0)
                            k[row][column] += det / 2 * (lam * g[a][i] * g[b][j] + two_mu / 2 * shear)
    load = scene["loads"][0]
    direction = [number(d) for d in load["direction"]]
    length = (direction[0] ** 2 + direction[1] ** 2).sqrt()
    top = range(ny * (nx + 1), (ny + 1) * (nx + 1))
    force, weights = [arb(0)] * size, [arb(0)] * len(contact)
    for a, b in zip(top, top[1:]):
        for n in (a, b):
            for i in range(2):
                if (n, i) in dof:
                    share = (nodes[b][0] - nodes[a][0]) / 2 * direction[i] / length
                    force[dof[n, i]] += share * number(load["start"])
    for a in range(nx):
        for n in (a, a + 1):
            if n in contact:
                weights[contact.index(n)] += (xs[a + 1] - xs[a]) / 2
    return [middle(arb_mat(k)) for k in operators], middle(arb_mat([[f] for f in force])), weights


def frozen(s, r, bounds, states):
    """Friction with given bounds: sets of sticking and slipping nodes until they are consistent."""
    m = len(bounds)
    for _ in range(200):
        slipping, w = [i for i in range(m) if states[i]], [arb(0)] * m
        if slipping:
            rows = arb_mat([[s[i, j] for j in slipping] for i in slipping])
            found = rows.solve(arb_mat([[r[i] - bounds[i] * states[i]] for i in slipping]))
            for q, i in enumerate(slipping):
                w[i] = found[q, 0].mid()
        force = [(r[i] - sum((s[i, j] * w[j] for j in range(m)), arb(0))).mid() for i in range(m)]

        def state(i):
            if states[i]:
                return states[i] if states[i] * w[i] > 0 else 0
            return 0 if abs(force[i]) <= bounds[i] * (1 + arb(2) ** -300) else (1 if force[i] > 0 else -1)

        following = [state(i) for i in range(m)]
        if following == states:
            return w, force, states
        states = following
    raise ArithmeticError("the sets do not settle")


def friction(s, r, weights, law, w):
    m, alpha, a, b = len(weights), number(law["alpha"]), number(law["a"]), number(law["b"])

    def bound(i):
        return weights[i] * ((a - b) * (-alpha * abs(w[i])).exp() + b)

    def slope(i):
        return -weights[i] * (a - b) * alpha * (-alpha * abs(w[i])).exp()

    states = [0 if x == 0 else (1 if x > 0 else -1) for x in w]
    for _ in range(60):
        w, force, states = frozen(s, r, [bound(i).mid() for i in range(m)], states)
    slipping = [i for i in range(m) if states[i]]
    for _ in range(30 if slipping else 0):
        rows = arb_mat([[s[i, j] + (slope(i) if i == j else 0) for j in slipping] for i in slipping])
        right = arb_mat([[r[i] - bound(i) * states[i] + slope(i) * w[i]] for i in slipping])
        found, before = middle(rows.solve(right)), w
        w = [found[slipping.index(i), 0] if states[i] else arb(0) for i in range(m)]
        if max(abs(float(x - y)) for x, y in zip(w, before)) < 1e-70:
            break
    force = [(r[i] - sum((s[i, j] * w[j] for j in range(m)), arb(0))).mid() for i in range(m)]
    for i in range(m):
        w_i, force_i = w[i], abs(force[i])
        assert states[i] * w_i > 0 if states[i] else force_i <= weights[i] * a
    return w, force


def run(scene, steps):
    (a, b), load, weights = assemble(scene)
    m, size, k = len(weights), a.nrows(), number(scene["time"]["step"])
    contact = arb_mat([[arb(int(i == size - m + j)) for j in range(m)] for i in range(size)])

    def prepared(operator):
        responses = middle(operator.solve(contact))
        compliance = arb_mat([[responses[size - m + i, j] for j in range(m)] for i in range(m)])
        return operator, responses, middle(compliance.inv())

    def stage(operators, p, w):
        operator, responses, s = operators
        free = middle(operator.solve(load - b * p))
        r = middle(s * arb_mat([[free[size - m + i, 0]] for i in range(m)]))
        w, force = friction(s, [r[i, 0] for i in range(m)], weights, scene["contact"]["friction"], w)
        return middle(free - responses * arb_mat([[f] for f in force])), w, force

    u, seen = arb_mat([[arb(0)]] * size), []
    velocity, w, force = stage(prepared(a), u, [arb(0)] * m)
    operators = prepared(a + b * (k / 2))
    for n in range(steps + 1):
        if n:
            p = middle(u + velocity * (k / 2))
            velocity, w, force = stage(operators, p, w)
            u = middle(p + velocity * (k / 2))
        seen.append(([float(x) for x in w], [float((-f / o).mid()) for f, o in zip(force, weights)]))
    return seen


def scene(size, poisson, mu1, direction, a, b):
    return {
        "schema_version": 1, "name": "digits",
        "mesh": {"kind": "rectangle", "size": size, "cells": [6, 3]},
        "material": {
            "viscosity": {"law": "isotropic", "mu1": mu1, "mu2": 0.1},
            "elasticity": {"law": "isotropic", "young": 1.0, "poisson": poisson, "convention": "plane_strain"},
        },
        "clamped": ["left"],
        "contact": {"part": "bottom", "friction": {"law": "exponential", "a": a, "b": b, "alpha": 100.0}},
        "loads": [{"name": "press", "kind": "traction", "part": "top", "direction": direction, "start": -0.3}],
        "time": {"step": 0.02, "scheme": "trapezoid", "start": "consistent"},
    }


STEPS = 6
CASES = [(f"thickness {h:g}", scene([1.0, h], 0.3, 0.05, [1.0, 0.3], 0.2, 0.05))
         for h in (1e-1, 1e-2, 1e-3, 5e-4, 2e-4, 1e-4, 1e-5, 1e-6, 1e-7)]
CASES += [(f"1/2 - poisson = {d:g}", scene([1.0, 0.5], 0.5 - d, 0.05, [0.0, 1.0], 0.003, 0.001))
          for d in (1e-2, 1e-4, 1e-6, 1e-7, 2e-8, 1e-8, 1e-10, 1e-12, 1e-14)]
CASES += [(f"mu1 = {mu1:g}", scene([1.0, 0.5], 0.3, mu1, [0.0, 1.0], 0.003, 0.001))
          for mu1 in (1e2, 1e4, 1e5, 4e5, 1e6, 1e8, 1e10, 1e12)]

if __name__ == "__main__":
    found = []
    for name, body in CASES:
        seen = run(body, STEPS)
        found.append({"name": name, "scene": body, "slip_rate": [w for w, _ in seen], "tangential_stress": [t for _, t in seen]})
    path = pathlib.Path(__file__).with_suffix(".json")
    path.write_text("[\n" + ",\n".join(json.dumps(case) for case in found) + "\n]\n")
