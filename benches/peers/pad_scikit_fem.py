"""The scene of pad.json written for scikit-fem: Coulomb friction with a coefficient that falls, on a foundation that approaches, slides and
goes, by backward Euler.

    stickslip run benches/peers/pad.json --csv pad.csv
    python3 benches/peers/pad_scikit_fem.py pad.csv          # needs numpy, scipy, scikit-fem

The body is condensed on the contact once; a step is Newton with an active set (open, stick, slip) on dense matrices of contact order.
CPU times, imports apart; one thread: OMP_NUM_THREADS=1.
"""
import sys
import time
from pathlib import Path

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla
from skfem import Basis, BilinearForm, ElementTriP1, ElementVector, MeshTri
from skfem.helpers import ddot, sym_grad, trace

from report import difference, read, report

HERE = Path(__file__).resolve().parent
LENGTH, HEIGHT, NX, NY = 0.08, 0.02, 32, 8
K, STEPS, GAP = 0.01, 100, 1e-5


def criss_cross():
    corners = [(LENGTH * i / NX, HEIGHT * j / NY) for j in range(NY + 1) for i in range(NX + 1)]
    centres = [(LENGTH * (i + 0.5) / NX, HEIGHT * (j + 0.5) / NY) for j in range(NY) for i in range(NX)]
    cells = []
    for j in range(NY):
        for i in range(NX):
            ring = [j * (NX + 1) + i, j * (NX + 1) + i + 1, (j + 1) * (NX + 1) + i + 1, (j + 1) * (NX + 1) + i]
            centre = len(corners) + j * NX + i
            cells += [(ring[s], ring[(s + 1) % 4], centre) for s in range(4)]
    return MeshTri(np.array(corners + centres).T.copy(), np.array(cells).T.copy())


begin = time.process_time()
mesh = criss_cross()
basis = Basis(mesh, ElementVector(ElementTriP1()))


def form(lam, two_mu):
    @BilinearForm
    def stiffness(u, v, _):
        return lam * trace(sym_grad(u)) * trace(sym_grad(v)) + two_mu * ddot(sym_grad(u), sym_grad(v))

    return stiffness.assemble(basis).tocsr()


x, y = mesh.p
free = np.setdiff1d(np.arange(basis.N), basis.nodal_dofs[:, y == HEIGHT].ravel())
place = np.full(basis.N, -1)
place[free] = np.arange(len(free))
contact = np.flatnonzero(y == 0.0)
contact = contact[np.argsort(x[contact])]
n = len(contact)
# tangential, then normal
ports = np.concatenate([place[basis.nodal_dofs[0, contact]], place[basis.nodal_dofs[1, contact]]])
a = form(2e5, 4e5)[free][:, free]
b = form(2e8 * 0.3 / (1.3 * 0.4), 2e8 / 1.3)[free][:, free]
lu = sla.splu((a + K * b).tocsc())
unit = np.zeros((len(free), 2 * n))
unit[ports, np.arange(2 * n)] = 1.0
answers = lu.solve(unit)
s = la.inv(answers[ports])
stiffness = 1.0 / np.diag(answers[ports])
set_up = time.process_time() - begin


def coefficient(rate):
    return 0.3 + 0.15 * np.exp(-20.0 * rate), -20.0 * 0.15 * np.exp(-20.0 * rate)


def contact_step(r, closing, sliding, w):
    """S w + force = r; closing: normal velocity that closes the gap by the end of the step; sliding: velocity of the foundation."""
    force = r - s @ w
    status = None
    for _ in range(200):
        slip, push = w[:n] - sliding, -force[n:]  # push: force of the foundation on the body
        mu, slope = coefficient(np.abs(slip))
        trial = force[:n] + stiffness[:n] * slip
        is_closed = push + stiffness[n:] * (closing - w[n:]) > 0
        old, status = status, np.where(~is_closed, -1, np.where(np.abs(trial) <= mu * push, 0, 1))
        sign = np.sign(trial)
        matrix, right = s.copy(), r.copy()
        for i in range(n):
            if status[i] < 0:
                continue
            matrix[n + i], right[n + i] = 0.0, closing[i]
            matrix[n + i, n + i] = 1.0
            if status[i] == 0:
                matrix[i], right[i] = 0.0, sliding
                matrix[i, i] = 1.0
            else:  # force_t = mu push sign, linearised; push = (S w - r)_n
                matrix[i] += mu[i] * sign[i] * s[n + i]
                right[i] += mu[i] * sign[i] * r[n + i]
                matrix[i, i] += slope[i] * push[i]
                right[i] += slope[i] * push[i] * w[i]
        new = la.solve(matrix, right)
        change = np.abs(new - w).max()
        w, force = new, r - s @ new
        if old is not None and np.array_equal(old, status) and change <= 1e-12 * max(np.abs(w).max(), 1e-4):
            return w, force, status
    raise RuntimeError("contact did not converge")


def signal(t, table):
    return np.interp(t, *zip(*table))


begin = time.process_time()
u, w = np.zeros(len(free)), np.zeros(2 * n)
rows = []
for step in range(1, STEPS + 1):
    t = step * K
    sliding = signal(t, [(0, 0), (0.4, 0.02), (0.6, 0), (1, -0.01)])
    approach = signal(t, [(0, 0), (0.3, 8e-5), (0.7, 8e-5), (1, 0)])
    free_motion = lu.solve(-(b @ u))
    closing = -(GAP - approach + u[ports[n:]]) / K
    w, force, status = contact_step(s @ free_motion[ports], closing, sliding, w)
    u = u + K * (free_motion - answers @ force)
    rows.append((w[:n] - sliding, -force[:n], -force[n:], GAP - approach + u[ports[n:]], status + 1))
step_time = (time.process_time() - begin) / STEPS

differences = {}
if len(sys.argv) > 1:
    area = np.full(n, LENGTH / NX)
    area[[0, -1]] /= 2
    scales = {"slip_rate": 1, "tangential_stress": area, "pressure": area, "gap": 1, "status": 1}
    for i, (field, mine) in enumerate(read(sys.argv[1], scales)[1].items()):
        differences[field] = difference(np.array([row[i] / scales[field] for row in rows]), mine[1:])
report("scikit-fem", HERE / "pad.json", __file__, set_up, step_time, differences)
