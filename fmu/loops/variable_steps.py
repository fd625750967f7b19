"""Variable steps: a master chooses the communication step by step doubling with rollback.

Every step is taken once as a whole and, from the saved state, as two halves; their difference estimates the error of the
halves (second order: a third of it). The halves are kept when the estimate meets the tolerance, and the next step follows
from it. `time.step` is raised so that the FMU does not cut the master's steps. Checked: the course against steps 16 times
smaller than the smallest, the number of steps against that of a fixed step of the smallest size, the rollback bit for bit.
"""

import math

from master import Pad, arguments, check, figure, save

UNTIL, TOLERANCE = 4.0, 2e-6
OUTPUT = "press.displacement"
LARGE = {"time.step": 0.5}


def press(t):
    """A pulse, then rest."""
    return -0.3 * math.exp(-(((t - 0.6) / 0.15) ** 2)) - 0.05


def advance(pad, t, h):
    pad.set("press", press(t + h))
    pad.step(t, h)


def adaptive(fmu):
    pad = Pad(fmu, parameters=LARGE, press=press(0.0))
    t, h, rejected, is_equal = 0.0, 1 / 64, [], True
    rows = [(0.0, pad.get(OUTPUT), 0.0)]
    while t < UNTIL - 1e-12:
        h = min(h, UNTIL - t)
        state = pad.save()
        advance(pad, t, h)
        whole = pad.get(OUTPUT)
        pad.restore(state)
        advance(pad, t, h / 2)
        advance(pad, t + h / 2, h / 2)
        halves = pad.get(OUTPUT)
        error = abs(whole - halves) / 3
        if error > TOLERANCE:
            rejected.append((t + h, h))
            pad.restore(state)
            advance(pad, t, h)
            is_equal &= pad.get(OUTPUT) == whole
            pad.restore(state)
        else:
            t += h
            rows.append((t, halves, h))
        pad.drop(state)
        h *= min(2.0, max(0.3, 0.9 * (TOLERANCE / max(error, 1e-300)) ** (1 / 3)))
    pad.close()
    return rows, rejected, is_equal


def fixed(fmu, instants, most):
    """The course at the same instants, each interval cut into steps no larger than `most`."""
    pad = Pad(fmu, parameters=LARGE, press=press(0.0))
    values = [pad.get(OUTPUT)]
    for a, b in zip(instants, instants[1:]):
        count = max(1, math.ceil((b - a) / most - 1e-9))
        for i in range(count):
            advance(pad, a + (b - a) * i / count, (b - a) / count)
        values.append(pad.get(OUTPUT))
    pad.close()
    return values


def main():
    options = arguments(__doc__)
    rows, rejected, is_equal = adaptive(options.fmu)
    t, sizes = [r[0] for r in rows], [r[2] for r in rows[1:]]
    fine = fixed(options.fmu, t, min(sizes) / 16)
    error = max(abs(r[1] - f) for r, f in zip(rows, fine))
    labels = ("load press, Pa", "displacement of the\nloaded side, m", "difference to\nsmall steps, m", "step, s")
    fig, axes = figure(labels, "Steps chosen by the master")
    axes[0].plot(t, [press(x) for x in t], ".-", ms=3)
    axes[1].plot(t, [r[1] for r in rows], ".", ms=4, label="variable steps")
    axes[1].plot(t, fine, "k-", lw=0.8, label="small steps")
    axes[2].semilogy(t[1:], [abs(r[1] - f) for r, f in zip(rows[1:], fine[1:])], ".-", ms=3, label="difference")
    axes[2].axhline(TOLERANCE, color="k", ls="--", lw=0.8, label="tolerance of a step")
    axes[3].semilogy(t[1:], sizes, drawstyle="steps-pre", lw=0.8, color="C0")
    axes[3].semilogy(t[1:], sizes, ".", ms=4, color="C0", label="taken")
    axes[3].semilogy(*zip(*rejected), "x", ms=5, color="C3", label="rejected and rolled back")
    save(fig, axes, options, "variable_steps.png")
    uniform = math.ceil(UNTIL / min(sizes))
    print(f"{len(sizes)} steps from {min(sizes):.4f} to {max(sizes):.4f} s, {len(rejected)} rejected; error {error:.1e} m")
    check(f"the error {error:.1e} m is near the tolerance {TOLERANCE:.0e} m of a step", error < 30 * TOLERANCE)
    check(f"{len(sizes)} steps, at most half of the {uniform} of the smallest size", len(sizes) <= uniform / 2)
    check("rejected steps were rolled back bit for bit", is_equal and len(rejected) > 0)


if __name__ == "__main__":
    main()
