"""Explicit loop: an actuator with a controller presses the pad until its tip stands where a course demands it.

The actuator is a first-order lag with a proportional-integral controller, advanced by its exact solution over a
communication step with the tip displacement held at its last value (a Jacobi scheme: no step is repeated). The pad sees
the actuator's pressure as an input that goes linearly to its new value. The lag of the held value makes the scheme first
order in the communication step, which is what the loop checks against the same loop with a much smaller step.

A step that the pad refuses (its friction does not converge) is taken in halves; the loop tells how many were. Towards the end
the tip creeps, and the contact goes by turns through stick and slip, because its friction weakens with the slip rate.
"""

import math

from fmpy.fmi1 import FMICallException
from master import Pad, arguments, check, figure, save

LAG, GAIN, INTEGRAL = 0.05, 1.0, 8.0  # s, Pa/m, Pa/(m s)
UNTIL = 2.0


def demand(t):
    return 0.03 * (1 - math.cos(math.pi * min(t, 1.0)))


def advance(pad, t, h, old, new):
    """A step while the load goes from `old` to `new`; one that the FMU discards is taken as two halves. How many were."""
    pad.set("press", new)
    try:
        pad.step(t, h)
    except FMICallException as refusal:
        if refusal.status != 2 or h < 1e-6:
            raise
        middle = (old + new) / 2
        return 1 + advance(pad, t, h / 2, old, middle) + advance(pad, t + h / 2, h / 2, middle, new)
    return 0


def run(fmu, h):
    pad = Pad(fmu, press=0.0)
    pressure = integral = 0.0
    rows, refused = [], 0
    decay = math.exp(-h / LAG)
    for i in range(round(UNTIL / h) + 1):
        t = i * h
        tip = pad.get("tip.displacement")[0]  # pressing makes the pad bulge along the contact
        rows.append((t, demand(t), tip, pressure, pad.get("contact.stick_fraction"), pad.get("energy.balance_error")))
        error = demand(t) - tip
        integral += h * error
        command = -GAIN * error - INTEGRAL * integral
        old, pressure = pressure, command + (pressure - command) * decay
        refused += advance(pad, t, h, old, pressure)
    work = pad.get("energy.external_work")
    pad.close()
    return rows, work, refused


def main():
    options = arguments(__doc__)
    runs = {h: run(options.fmu, h) for h in (1 / 32, 1 / 64, 1 / 512)}
    fine = {row[0]: row[2] for row in runs[1 / 512][0]}
    errors = {h: max(abs(row[2] - fine[row[0]]) for row in rows) for h, (rows, *_) in runs.items()}
    labels = ("tip displacement, m", "difference to\nstep 1/512 s, m", "load press, Pa", "share of the contact\nthat sticks")
    fig, axes = figure(labels, "Explicit loop: an actuator with a controller presses the pad")
    for (h, (rows, *_)), style in zip(runs.items(), ("-", "-", ":")):
        t = [r[0] for r in rows]
        name = f"step 1/{round(1 / h)} s"
        axes[0].plot(t, [r[2] for r in rows], style, label=name)
        if h != 1 / 512:
            axes[1].plot(t, [r[2] - fine[r[0]] for r in rows], label=name)
        axes[2].plot(t, [r[3] for r in rows], style, label=name)
        axes[3].plot(t, [r[4] for r in rows], lw=0.8, label=name)
    axes[0].plot(t, [r[1] for r in rows], "k--", label="demand")
    save(fig, axes, options, "explicit_actuator.png")
    rows, work, _ = runs[1 / 512]
    ratio = errors[1 / 32] / errors[1 / 64]
    off, balance = abs(rows[-1][2] - rows[-1][1]), max(abs(r[5]) for r in rows)
    print(f"steps that the pad refused: {sum(refused for *_, refused in runs.values())}")
    print(f"error of the tip: {errors[1 / 32]:.2e} m at 1/32 s, {errors[1 / 64]:.2e} m at 1/64 s")
    check(f"first order in the step: ratio {ratio:.2f} between 1.6 and 2.8", 1.6 <= ratio <= 2.8)
    check(f"the demand is met at the end: {rows[-1][2]:.5f} of {rows[-1][1]:.5f} m", off < 2e-3)
    check(f"energy balance of the pad: {balance:.1e} of {work:.1e} J", balance < 1e-9 * work)


if __name__ == "__main__":
    main()
