// A brake shoe on an arc: a rim and its lining. Written by Gmsh 4.15.2: gmsh -2 brake_shoe.geo, coordinates to 9 digits.
SetFactory("Built-in");
Mesh.ElementOrder = 2; Mesh.MshFileVersion = 4.1; Mesh.MeshSizeExtendFromBoundary = 0;
h = 0.0095;
Point(1) = {0, 0, 0, h};
For i In {0:2}
  r = 0.086 + (i > 0 ? 0.006 : 0) + (i > 1 ? 0.008 : 0);
  Point(10 + i) = {r * Cos(0.5), r * Sin(0.5), 0, h};
  Point(20 + i) = {r * Cos(2.2), r * Sin(2.2), 0, h};
  Circle(30 + i) = {20 + i, 1, 10 + i};
EndFor
Line(41) = {10, 11}; Line(42) = {11, 12};
Line(51) = {21, 20}; Line(52) = {22, 21};
Curve Loop(1) = {30, 41, -31, 51}; Curve Loop(2) = {31, 42, -32, 52};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Physical Curve("face") = {32}; Physical Curve("pivot") = {51}; Physical Curve("cam") = {41};
Physical Surface("rim") = {1}; Physical Surface("lining") = {2};
