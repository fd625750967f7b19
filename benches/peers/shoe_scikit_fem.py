"""The scene of shoe.json written for scikit-fem: the same Gmsh file, materials, friction law, scheme and steps.

    stickslip run benches/peers/shoe.json --csv shoe.csv
    python3 benches/peers/shoe_scikit_fem.py shoe.csv        # needs numpy, scipy, scikit-fem, meshio

The body is condensed on the contact once; a step is Newton with an active set. CPU times, imports apart; one thread: OMP_NUM_THREADS=1.
"""
import json
import sys
import time
from pathlib import Path

import meshio
import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from skfem import Basis, BilinearForm, ElementTriP1, ElementVector, FacetBasis, LinearForm, MeshTri
from skfem.helpers import ddot, dot, sym_grad, trace

from report import difference, read, report

HERE = Path(__file__).resolve().parent
begin = time.process_time()

# mesh: nodes that no cell uses (the centre of the arcs) are left out
file = meshio.read(HERE / json.loads((HERE / "shoe.json").read_text())["mesh"]["file"])
cells = {kind: (file.cells_dict[kind], file.cell_data_dict["gmsh:physical"][kind]) for kind in ("triangle", "line")}
used = np.unique(cells["triangle"][0])
number = np.full(len(file.points), -1)
number[used] = np.arange(len(used))
points = file.points[used, :2]
mesh = MeshTri(points.T.copy(), number[cells["triangle"][0]].T.copy())
tag = {name: int(value[0]) for name, value in file.field_data.items()}
edges = {name: number[cells["line"][0][cells["line"][1] == tag[name]]] for name in ("pivot", "drum face", "cam")}


# operators
def form(lam, two_mu, elements):
    @BilinearForm
    def stiffness(u, v, _):
        return lam * trace(sym_grad(u)) * trace(sym_grad(v)) + two_mu * ddot(sym_grad(u), sym_grad(v))

    return stiffness.assemble(Basis(mesh, ElementVector(ElementTriP1()), elements=elements)).tocsr()


def lame(young, poisson):
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (1 + poisson)


region = cells["triangle"][1]
rim, lining = (np.nonzero(region == tag[name])[0] for name in ("rim", "lining"))
a = form(2e5, 4e5, rim) + form(5e4, 1e5, lining)
b = form(*lame(2e8, 0.3), rim) + form(*lame(2e7, 0.35), lining)

# load
pairs = {tuple(sorted(pair)): i for i, pair in enumerate(mesh.facets.T)}
facets = np.array([pairs[tuple(sorted(pair))] for pair in edges["cam"]])
basis = FacetBasis(mesh, ElementVector(ElementTriP1()), facets=facets)
direction = np.array([0.573576436351046, -0.8191520442889918])
load = LinearForm(lambda v, _: dot(direction[:, None, None], v)).assemble(basis)

# contact: lumped normals, tangents along growing x, weights
normal, weight = np.zeros((len(points), 2)), np.zeros(len(points))
for i, j in edges["drum face"]:
    t = points[j] - points[i]
    middle = (points[i] + points[j]) / 2
    n = np.array([t[1], -t[0]])
    n *= np.sign(n @ (middle - points.mean(axis=0)))
    for node in (i, j):
        normal[node] += n / 2
        weight[node] += np.linalg.norm(t) / 2
clamped = np.unique(edges["pivot"])
contact = np.setdiff1d(np.unique(edges["drum face"]), clamped)
normal[contact] /= np.linalg.norm(normal[contact], axis=1)[:, None]
tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
tangent[tangent[:, 0] < 0] *= -1

# free unknowns: tangential at contact nodes, both components elsewhere
inner = np.setdiff1d(np.arange(len(points)), np.concatenate([contact, clamped]))
rows = np.concatenate([2 * inner, 2 * inner + 1, 2 * contact, 2 * contact + 1])
free = 2 * len(inner)
columns = np.concatenate([np.arange(free), free + np.arange(len(contact)), free + np.arange(len(contact))])
values = np.concatenate([np.ones(free), tangent[contact, 0], tangent[contact, 1]])
turn = sp.csr_matrix((values, (rows, columns)), shape=(2 * len(points), free + len(contact)))
a, b, f = (turn.T @ a @ turn).tocsc(), (turn.T @ b @ turn).tocsc(), turn.T @ load
w_c, omega = np.arange(free, free + len(contact)), weight[contact]


class Stage:
    """M = A + theta k B, condensed on the contact: S w + p = r."""

    def __init__(self, theta_k):
        self.lu = sla.splu((a + theta_k * b).tocsc())
        unit = np.zeros((a.shape[0], len(contact)))
        unit[w_c, np.arange(len(contact))] = 1.0
        self.answers = self.lu.solve(unit)
        self.s = la.inv(self.answers[w_c])

    def solve(self, right, w):
        free_motion = self.lu.solve(right)
        w, force = friction(self.s, self.s @ free_motion[w_c], w)
        return free_motion - self.answers @ force, w, force


def bound(rate):
    return 1e4 + (2e4 - 1e4) * np.exp(-20.0 * rate)


def friction(s, r, w):
    """Newton with an active set for S w + force = r, force in omega g(|w|) sign(w)."""
    force = r - s @ w
    for _ in range(100):
        g = omega * bound(np.abs(w))
        sign = np.where(w != 0, np.sign(w), np.where(force > g, 1, np.where(force < -g, -1, 0)))
        slips = np.nonzero(sign)[0]
        slope = -20.0 * 1e4 * np.exp(-20.0 * np.abs(w)) * omega
        residual = (s @ w + g * sign - r)[slips]
        matrix = s[np.ix_(slips, slips)] + np.diag(slope[slips])
        new = np.zeros_like(w)
        new[slips] = w[slips] - la.solve(matrix, residual)
        new[new * sign < 0] = 0.0
        change = np.abs(new - w).max()
        w = new
        force = r - s @ w
        sticks = w == 0
        if change <= 1e-13 * max(np.abs(w).max(), 1e-300) and np.all(np.abs(force[sticks]) <= (omega * bound(0.0))[sticks] * (1 + 1e-12)):
            return w, force
    raise RuntimeError("friction did not converge")


def intensity(t):
    return np.interp(t, [0.0, 0.3, 1.0], [0.0, -6e5, -6e5])


k, steps = 0.025, 40
start, stage = Stage(0.0), Stage(k / 2)
set_up = time.process_time() - begin

begin = time.process_time()
u, (v, w, force) = np.zeros(a.shape[0]), start.solve(f * intensity(0.0), np.zeros(len(contact)))
answers = [(w, u[w_c], -force / omega)]
for n in range(1, steps + 1):
    p = u + k / 2 * v
    new, w, force = stage.solve(f * intensity(n * k) - b @ p, w)
    u, v = p + k / 2 * new, new
    answers.append((w, u[w_c], -force / omega))
step = (time.process_time() - begin) / steps

differences = {}
if len(sys.argv) > 1:
    places, ours = read(sys.argv[1], ("slip_rate", "slip", "tangential_stress"))
    order = [int(np.argmin(np.linalg.norm(points[contact] - place, axis=1))) for place in places]
    for i, (field, mine) in enumerate(ours.items()):
        differences[field] = difference(np.array([answer[i][order] for answer in answers]), mine)
report("scikit-fem", HERE / "shoe.json", __file__, set_up, step, differences)
