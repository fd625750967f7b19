// A wedge of tetrahedra with a curved face. The file beside was written from it by Gmsh 4.15.2:
// gmsh -3 wedge.geo -format msh41 -bin -o wedge.msh
SetFactory("Built-in");
Mesh.ElementOrder = 2;
h = 0.6;
Point(1) = {0, 0, 0, h};
Point(2) = {1, 0, 0, h};
Point(3) = {0, 1, 0, h};
Line(1) = {1, 2};
Circle(2) = {2, 1, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};
out[] = Extrude {0, 0, 0.5} { Surface{1}; };
Physical Surface("base") = {1};
Physical Surface("lid") = {out[0]};
Physical Surface("curved") = {out[3]};
Physical Volume("wedge") = {out[1]};
