"""The scene of pad.json written for GetFEM: its assembly, its model bricks, its augmented Lagrangian form of contact with friction and its
Newton solver (MUMPS).

    stickslip run benches/peers/pad.json --csv pad.csv
    /usr/bin/python3 benches/peers/pad_getfem.py pad.csv     # Debian's python3-getfem

Contact stresses are multipliers at the nodes, by the trapezoidal rule on the edges. CPU times, imports apart.
"""
import sys
import time
from pathlib import Path

import getfem as gf
import numpy as np

from report import difference, read, report

HERE = Path(__file__).resolve().parent
LENGTH, HEIGHT, NX, NY = 0.08, 0.02, 32, 8
K, STEPS, GAP = 0.01, 100, 1e-5
BOTTOM = 1
LAM, TWO_MU = 2e8 * 0.3 / (1.3 * 0.4), 2e8 / 1.3

gf.util_trace_level(0)
begin = time.process_time()
corners = [(LENGTH * i / NX, HEIGHT * j / NY) for j in range(NY + 1) for i in range(NX + 1)]
centres = [(LENGTH * (i + 0.5) / NX, HEIGHT * (j + 0.5) / NY) for j in range(NY) for i in range(NX)]
cells = []
for j in range(NY):
    for i in range(NX):
        ring = [j * (NX + 1) + i, j * (NX + 1) + i + 1, (j + 1) * (NX + 1) + i + 1, (j + 1) * (NX + 1) + i]
        cells += [(ring[s], ring[(s + 1) % 4], len(corners) + j * NX + i) for s in range(4)]
places = np.array(corners + centres)
mesh = gf.Mesh("empty", 2)
mesh.add_convex(gf.GeoTrans("GT_PK(2,1)"), np.ascontiguousarray(np.transpose(places[np.array(cells)], (2, 1, 0))))
points, outer = mesh.pts(), mesh.outer_faces()
ends = np.array([[points[:, i] for i in mesh.pid_in_faces(outer[:, [j]])] for j in range(outer.shape[1])])
mesh.set_region(BOTTOM, outer[:, np.all(np.abs(ends[:, :, 1]) < 1e-12, axis=1)])

whole, scalar = gf.MeshFem(mesh, 2), gf.MeshFem(mesh, 1)
whole.set_fem(gf.Fem("FEM_PK(2,1)"))
scalar.set_fem(gf.Fem("FEM_PK(2,1)"))
nodes = whole.basic_dof_nodes()
free = np.flatnonzero(nodes[1] < HEIGHT - 1e-12)
mf = gf.MeshFem("partial", whole, free)
below = np.flatnonzero(scalar.basic_dof_nodes()[1] < 1e-12)
multipliers = gf.MeshFem("partial", scalar, below)
order = np.argsort(scalar.basic_dof_nodes()[0, below])
component = (np.arange(nodes.shape[1]) % 2)[free]
on_contact = np.abs(nodes[1, free]) < 1e-12
tangential, normal = (np.flatnonzero(on_contact & (component == c)) for c in (0, 1))
tangential, normal = (dofs[np.argsort(nodes[0, free][dofs])] for dofs in (tangential, normal))

body, edges = gf.MeshIm(mesh, gf.Integ("IM_TRIANGLE(1)")), gf.MeshIm(mesh, gf.Integ("IM_NC(2,1)"))
model = gf.Model("real")
model.add_fem_variable("w", mf)
model.add_fem_variable("pn", multipliers)
model.add_fem_variable("pt", multipliers)
model.add_fem_data("u", mf)
for name, value in {"ra": 2e5 + K * LAM, "rb": 4e5 + K * TWO_MU, "lam": LAM, "tmu": TWO_MU, "r": 1e7, "open": GAP, "v": 0.0, "k": K}.items():
    model.add_initialized_data(name, [value])
model.add_linear_term(body, "(ra*Div(w)*Id(2)+rb*Sym(Grad_w)):Grad_Test_w")
model.add_source_term(body, "-(lam*Div(u)*Id(2)+tmu*Sym(Grad_u)):Grad_Test_w")
model.add_linear_term(edges, "pt*Test_w(1)-pn*Test_w(2)", BOTTOM, False, False)
pushed = "max(0,pn-r*(w(2)+(open+u(2))/k))"
mu = "(0.3+0.15*exp(-20*abs(w(1)-v)))"
model.add_nonlinear_term(edges, f"(pn-{pushed})*Test_pn", BOTTOM, False, False)
model.add_nonlinear_term(edges, f"(pt-max(-{mu}*{pushed},min({mu}*{pushed},pt+r*(w(1)-v))))*Test_pt", BOTTOM, False, False)
set_up = time.process_time() - begin


def signal(t, table):
    return np.interp(t, *zip(*table))


begin = time.process_time()
u = np.zeros(mf.nbdof())
rows, iterations = [], []
for step in range(1, STEPS + 1):
    t = step * K
    sliding = signal(t, [(0, 0), (0.4, 0.02), (0.6, 0), (1, -0.01)])
    gap = GAP - signal(t, [(0, 0), (0.3, 8e-5), (0.7, 8e-5), (1, 0)])
    model.set_variable("u", u)
    model.set_variable("v", [sliding])
    model.set_variable("open", [gap])
    count = model.solve("max_res", 1e-9, "max_iter", 100, "lsolver", "mumps", "lsearch", "simplest", "alpha min", 1.0)[0]
    if count >= 100:
        raise SystemExit(f"GetFEM did not converge at step {step}")
    iterations.append(count)
    w = model.variable("w")
    u = u + K * w
    pt, pn = (model.variable(name)[order] for name in ("pt", "pn"))
    rows.append((w[tangential] - sliding, -pt, pn, gap + u[normal]))
step_time = (time.process_time() - begin) / STEPS

print(f"iterations: mean {np.mean(iterations):.1f}, worst {max(iterations)}")
differences = {}
if len(sys.argv) > 1:
    for i, (field, mine) in enumerate(read(sys.argv[1], ("slip_rate", "tangential_stress", "pressure", "gap"))[1].items()):
        differences[field] = difference(np.array([row[i] for row in rows]), mine[1:])
report("GetFEM", HERE / "pad.json", __file__, set_up, step_time, differences)
