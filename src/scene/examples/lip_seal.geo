// A lip that seals a shaft. Written by Gmsh 4.15.2: gmsh -2 lip_seal.geo, coordinates to 9 digits.
SetFactory("Built-in");
Mesh.ElementOrder = 2; Mesh.MshFileVersion = 4.1; Mesh.MeshSizeExtendFromBoundary = 0;
// a lip in the plane of the axis: x along the shaft, y away from it, m
a = 0.0006; b = 0.00012;
Point(1) = {-0.0012, 0.0012, 0, 0.0004};
Point(2) = {-0.0004, 0.0001, 0, b};
Point(3) = {0, 0, 0, b};
Point(4) = {0.0006, 0.0002, 0, b};
Point(5) = {0.0012, 0.0012, 0, 0.0004};
Point(6) = {0.0012, 0.0025, 0, 0.0003};
Point(7) = {0.0042, 0.0042, 0, a};
Point(8) = {0.0042, 0.0055, 0, a};
Point(9) = {0.0002, 0.0034, 0, 0.0004};
Spline(1) = {2, 3, 4};
Line(2) = {4, 5}; Line(3) = {5, 6}; Line(4) = {6, 7}; Line(5) = {7, 8}; Line(6) = {8, 9}; Line(7) = {9, 1}; Line(8) = {1, 2};
Curve Loop(1) = {1, 2, 3, 4, 5, 6, 7, 8};
Plane Surface(1) = {1};
Physical Curve("lip") = {1}; Physical Curve("case") = {5}; Physical Curve("oil") = {7, 8};
Physical Surface("elastomer") = {1};
