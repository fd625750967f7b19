"""Implicit loops: a mass on a spring and a damper carries the pad by an elastic mount; three ways to close the loop.

    m v' + c v + k x = f(t) - F,   F = s (x - u) + d (v - w)

x, v: displacement and velocity of the mass along the load; u, w: mean displacement and velocity of the loaded side of the
pad; F: force on the pad (the loaded side is 1 m long, so that F is also the intensity `press`). The mass is advanced by the
trapezoid, F going linearly over the step as the pad has it too. In every step F at its end is unknown:
- explicit: F follows from the last u, w; the step is taken once;
- Gauss-Seidel: pad, then mass, from the same saved state again until F stands still;
- Newton: the same with the derivatives of u and w by F, which the FMU gives.
The energy error is what the mass, the mount and the pad hold and have dissipated, less the work of f.
"""

import math

from master import Pad, arguments, check, figure, save

M, C, K = 0.05, 0.02, 0.5
S, D = 1.5, 0.15
UNTIL, H = 2.0, 1 / 64
TOLERANCE = 1e-13


def force(t):
    return -0.25 * math.sin(math.pi * t) ** 2


def mass_step(x, v, drive, last, u, w, h):
    """End of the step of the mass with the mount attached to u, w; the force there, and its derivatives by u and w."""
    a = M / h + C / 2 + K * h / 4 + (S * h / 2 + D) / 2
    free = x + h * v / 2
    b = M / h * v + drive - last / 2 - C * v / 2 - K * (x + h * v / 4) - (S * (free - u) - D * w) / 2
    v1 = b / a
    x1 = free + h * v1 / 2
    by_v1 = S * h / 2 + D
    slopes = by_v1 * S / (2 * a) - S, by_v1 * D / (2 * a) - D
    return x1, v1, S * (x1 - u) + D * (v1 - w), slopes


def run(fmu, method, h=H):
    pad = Pad(fmu, press=0.0)
    x = v = last = work = lost = u0 = w0 = 0.0
    iterations, is_repeatable, rows = [], True, []
    for i in range(round(UNTIL / h)):
        t = i * h
        drive = (force(t) + force(t + h)) / 2
        state = pad.save()
        guess, count = last, 0
        while True:
            count += 1
            if count > 1:
                pad.restore(state)
            pad.set("press", guess)
            pad.step(t, h)
            u, w = pad.get("press.displacement"), pad.get("press.velocity")
            x1, v1, found, (by_u, by_w) = mass_step(x, v, drive, last, u, w, h)
            if method == "explicit" or abs(found - guess) <= TOLERANCE or count == 200:
                break
            if method == "newton":
                du, dw = pad.derivative("press.displacement", "press"), pad.derivative("press.velocity", "press")
                guess += (found - guess) / (1 - by_u * du - by_w * dw)
            else:
                guess = found
        if i % 16 == 0:
            pad.restore(state)
            pad.set("press", guess)
            pad.step(t, h)
            is_repeatable &= pad.get("press.displacement") == u and pad.get("press.velocity") == w
        pad.drop(state)
        work += drive * (x1 - x)
        mean = (v + v1) / 2
        lost += h * C * mean**2 + D * (mean - (w0 + w) / 2) * ((x1 - x) - (u - u0))
        x, v, last, u0, w0 = x1, v1, found, u, w
        stored = M * v**2 / 2 + K * x**2 / 2 + S * (x - u) ** 2 / 2
        error = stored + lost + pad.get("energy.external_work") - work
        rows.append((t + h, x, guess, error, count, u))
        iterations.append(count)
    pad.close()
    return rows, sum(iterations) / len(iterations), max(abs(r[3]) for r in rows), is_repeatable


def main():
    options = arguments(__doc__)
    methods = ("explicit", "gauss-seidel", "newton")
    results = {method: run(options.fmu, method) for method in methods}
    labels = ("displacement of\nthe mass, m", "force on the pad, N", "energy error, J", "steps of the pad per\nstep of the loop")
    fig, axes = figure(labels, "A mass carries the pad: three ways to close the loop")
    names = {"explicit": "explicit", "gauss-seidel": "Gauss-Seidel", "newton": "Newton"}
    for (method, (rows, mean, error, _)), style in zip(results.items(), ("-", "-", ":")):
        print(f"{method:13} {mean:6.2f} steps of the pad per step of the loop, largest energy error {error:.2e} J")
        for axis, column in zip(axes, (1, 2, 3, 4)):
            # exact zeros have no place on a logarithmic axis
            values = [max(abs(r[3]), 1e-20) if column == 3 else r[column] for r in rows]
            axis.plot([r[0] for r in rows], values, style, lw=2 if style == ":" else 1.4, label=names[method])
    axes[2].set_yscale("log")
    axes[2].set_ylim(1e-20, 1e-1)
    save(fig, axes, options, "implicit_mass.png")
    explicit, seidel, newton = (results[m] for m in methods)
    distance = max(abs(a[1] - b[1]) for a, b in zip(seidel[0], newton[0]))
    check(f"Gauss-Seidel and Newton agree: {distance:.1e} m", distance < 1e-10)
    check(f"Newton needs fewer steps: {newton[1]:.2f} of {seidel[1]:.2f}", newton[1] < seidel[1])
    check(f"closing the loop keeps the energy: {newton[2]:.1e} J, explicit {explicit[2]:.1e} J", newton[2] < 0.01 * explicit[2])
    check("a step repeated from the saved state is equal bit for bit", all(r[3] for r in results.values()))


if __name__ == "__main__":
    main()
