"""A sweep over friction parameters with a progress bar, in parallel processes or on a Dask cluster.

`python sweep.py` uses the processors of this machine; `python sweep.py --dask tcp://scheduler:8786` the workers of a
cluster, which (like its scheduler) needs FMPy, and sees the FMU under the same path. Every process unpacks the FMU and makes its
instance once, and resets it for each point. Checked: more friction slips less and sticks
more; a point computed here again equals the one from the pool bit for bit.
"""

import os
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed

import master
from master import arguments, check, figure, save

BOUNDS = [0.0005 * i for i in range(1, 13)]  # kinetic bound b, Pa
RATIOS = (1.0, 1.5, 3.0)  # a / b
STEPS, H = 32, 1 / 32


def point(fmu, b, ratio):
    """Largest accumulated slip, frictional dissipation and final stick share for one friction law."""
    pad = master.shared(fmu)
    pad.restart(**{"contact.friction.a": b * ratio, "contact.friction.b": b})
    for i in range(STEPS):
        pad.step(i * H, H)
    return max(pad.get("contact.accumulated_slip")), pad.get("energy.friction_dissipation"), pad.get("contact.stick_fraction")


def bar(done, total):
    width = 40 * done // total
    if sys.stderr.isatty() or done == total:
        end = "\n" if done == total else ""
        print(f"\r[{'#' * width}{'.' * (40 - width)}] {done}/{total}", end=end, file=sys.stderr, flush=True)


def sweep(fmu, dask):
    jobs = [(b, ratio) for ratio in RATIOS for b in BOUNDS]
    if dask:
        from dask.distributed import Client
        from dask.distributed import as_completed as completed

        pool = Client(dask)
        pool.upload_file(master.__file__)  # the cluster has no copy of this folder
    else:
        pool, completed = ProcessPoolExecutor(max_workers=os.cpu_count()), as_completed
    results = {}
    with pool:
        futures = {pool.submit(point, fmu, *job): job for job in jobs}
        for done, future in enumerate(completed(list(futures)), 1):
            results[futures[future]] = future.result()
            bar(done, len(jobs))
    return results


def main():
    options = arguments(__doc__, ("--dask", {"help": "address of a Dask scheduler"}))
    fmu = os.path.abspath(options.fmu)
    results = sweep(fmu, options.dask)
    labels = ("largest slip\nof a node, m", "dissipation by\nfriction, J", "share of the contact\nthat sticks at the end")
    fig, axes = figure(labels, "Sweep over the friction law: the paper's example at t = 1 s", x="kinetic bound b, Pa")
    for ratio in RATIOS:
        for i, axis in enumerate(axes):
            axis.plot(BOUNDS, [results[b, ratio][i] for b in BOUNDS], ".-", label=f"a / b = {ratio}")
    axes[1].ticklabel_format(axis="y", scilimits=(0, 0))
    save(fig, axes, options, "sweep.png")
    slips = [results[b, 1.0][0] for b in BOUNDS]
    sticks = [results[b, 1.0][2] for b in BOUNDS]
    check("the largest slip falls with the bound", all(x > y for x, y in zip(slips, slips[1:])))
    check(f"more of the contact sticks: {sticks[0]:.2f} to {sticks[-1]:.2f}", sticks[-1] > sticks[0])
    job = (BOUNDS[3], RATIOS[1])
    check("a point computed here equals the one from the pool bit for bit", point(fmu, *job) == results[job])


if __name__ == "__main__":
    main()
