// Sliding wedge (NAFEMS CGS-4): a block on a slope of 0.1, meshes that do not match.
//   gmsh -2 -format msh41 wedge.geo
slope = 0.1;
Point(1) = {0, 0, 0}; Point(2) = {6, 0, 0}; Point(3) = {6, 2 + 6 * slope, 0}; Point(4) = {0, 2, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 13; Transfinite Curve{2, 4} = 5;
low = 2 + 1 * slope; high = 2 + 3.5 * slope;
Point(5) = {1, low, 0}; Point(6) = {3.5, high, 0}; Point(7) = {3.5, high + 1, 0}; Point(8) = {1, low + 1, 0};
Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 5};
Curve Loop(2) = {5:8}; Plane Surface(2) = {2};
Transfinite Curve{5, 7} = 8; Transfinite Curve{6, 8} = 4;
Transfinite Surface{1, 2}; Recombine Surface{1, 2};
Physical Surface("wedge") = {1}; Physical Surface("block") = {2};
Physical Curve("wedge_bottom") = {1}; Physical Curve("wedge_top") = {3};
Physical Curve("block_bottom") = {5}; Physical Curve("block_left") = {8};
