// A shoe on an arc: two regions, second order, the midside nodes on the arcs. The files beside were written from it by
// Gmsh 4.15.2: gmsh -2 shoe.geo -format msh41 (and msh22, each with and without -bin) -o ...
SetFactory("Built-in");
Mesh.ElementOrder = 2;
h = 0.05;
Point(1) = {0, 0, 0, h};
For i In {0:2}
  r = 0.1 + 0.02 * i;
  Point(10 + i) = {r * Cos(0.6), r * Sin(0.6), 0, h};
  Point(20 + i) = {r * Cos(1.8), r * Sin(1.8), 0, h};
  Circle(30 + i) = {20 + i, 1, 10 + i};
EndFor
Line(41) = {10, 11};
Line(42) = {11, 12};
Line(51) = {21, 20};
Line(52) = {22, 21};
Curve Loop(1) = {30, 41, -31, 51};
Curve Loop(2) = {31, 42, -32, 52};
Plane Surface(1) = {1};
Plane Surface(2) = {2};
Physical Curve("drum face") = {32};
Physical Curve("pivot") = {51, 52};
Physical Curve("cam") = {41};
Physical Curve(7) = {30};
Physical Curve("interface") = {31};
Physical Surface("rim") = {1};
Physical Surface("lining") = {2};
