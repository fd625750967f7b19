"""From a mesh file to a friction curve: `python friction_curve.py shoe.msh`. The shoe of a drum brake, pressed on while the drum slows."""
import sys
import stickslip

lining = {"viscosity": {"law": "isotropic", "mu1": 5e4, "mu2": 1e5},
          "elasticity": {"law": "isotropic", "young": 2e7, "poisson": 0.3, "convention": "plane_strain"}}
stribeck = {"kind": "stribeck", "static": 0.45, "kinetic": 0.3, "velocity": 0.5, "exponent": 1.0, "viscous": 0.0}
scene = {"schema_version": 1, "name": "shoe", "mesh": {"kind": "gmsh", "file": sys.argv[1]},
         "materials": [{"region": "rim", **lining}, {"region": "lining", **lining}],
         "clamped": ["pivot"],
         "contact": {"part": "drum face", "condition": {"kind": "unilateral"}, "friction": {"law": "coulomb", "coefficient": stribeck},
                     "foundation": [{"kind": "rotation", "name": "drum", "centre": [0, 0]}]},
         "loads": [{"name": "cam", "kind": "traction", "part": "cam", "direction": [0.825, 0.565]}],
         "time": {"step": 0.02},
         "run": {"until": 2.0, "signals": {"cam": [[0, 0], [0.5, 2e5]], "drum": [[0, 40], [0.5, 40], [2, 2]]}}}
braking = stickslip.run(scene, outputs=["drum", "drum.torque", "contact.normal_force"]).sel(time=slice(0.5, None))
speed = abs(braking["drum"]) * 0.14  # m/s at the radius of the drum face
friction = abs(braking["drum.torque"]) / (0.14 * braking["contact.normal_force"])
for v, mu in zip(speed.values[::5], friction.values[::5]):
    print(f"{v:6.2f} m/s  {mu:6.4f}  " + "#" * round(100 * mu))
