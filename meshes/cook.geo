// Cook's membrane: a tapered panel, clamped at the left and sheared at the right, 16 x 16 quadrilaterals.
// The mesh beside this file is made by: gmsh -2 cook.geo

Mesh.MshFileVersion = 4.1;

elements = 16; // along each side

Point(1) = {0, 0, 0};
Point(2) = {48, 44, 0};
Point(3) = {48, 60, 0};
Point(4) = {0, 44, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1:4} = elements + 1;
Transfinite Surface{1};
Recombine Surface{1};

Physical Surface("membrane") = {1};
Physical Curve("left") = {4};
Physical Curve("right") = {2};
