// Square block of 40 mm, n x n elements, for the contact problem of the GRECO group.
//   gmsh -2 -format msh41 greco.geo
DefineConstant[ n = 64 ];
Point(1) = {0, 0, 0}; Point(2) = {40, 0, 0}; Point(3) = {40, 40, 0}; Point(4) = {0, 40, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1:4} = n + 1; Transfinite Surface{1}; Recombine Surface{1};
Physical Surface("block") = {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {4};
Physical Point("corner") = {2};
