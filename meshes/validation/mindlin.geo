// Cattaneo-Mindlin: a cylinder of radius 50, cut to 80 x 40, on a block 80 x 40 of the same material.
// Elements are uniform over the contact, |x| < 0.8 (its half-width is 0.743), and grow from there.
//   gmsh -2 -format msh41 mindlin.geo
DefineConstant[ fine = 0.012 ];
R = 50; half = 40; near = 0.9; depth = 40;

Point(1) = {-half, -depth, 0}; Point(2) = {half, -depth, 0}; Point(3) = {half, 0, 0}; Point(4) = {-half, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};

rise = R - Sqrt(R^2 - half^2);
Point(5) = {-half, rise, 0}; Point(6) = {0, 0, 0}; Point(7) = {half, rise, 0};
Point(8) = {half, depth, 0}; Point(9) = {-half, depth, 0}; Point(10) = {0, R, 0};
Circle(5) = {5, 10, 6}; Circle(6) = {6, 10, 7}; Line(7) = {7, 8}; Line(8) = {8, 9}; Line(9) = {9, 5};
Curve Loop(2) = {5:9}; Plane Surface(2) = {2};

Field[1] = Box;
Field[1].XMin = -near; Field[1].XMax = near; Field[1].YMin = -0.2; Field[1].YMax = 0.2;
Field[1].VIn = fine; Field[1].VOut = 8; Field[1].Thickness = 30;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
Mesh.RecombineAll = 1; Mesh.Algorithm = 8; Mesh.RecombinationAlgorithm = 3;

Physical Surface("block") = {1};
Physical Surface("cylinder") = {2};
Physical Curve("block_bottom") = {1};
Physical Curve("block_top") = {3};
Physical Curve("cylinder_bottom") = {5, 6};
Physical Curve("cylinder_top") = {8};
