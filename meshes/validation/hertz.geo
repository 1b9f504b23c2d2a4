// Hertz contact of a cylinder on a block, half of it (x >= 0): cylinder of radius 50 about (0, 50), block 100 x 200.
// Elements are uniform within 1.5 contact half-widths and grow from there.
//   gmsh -2 -format msh41 hertz.geo -o hertz_q4.msh
//   gmsh -2 -format msh41 -setnumber order 2 -setnumber fine 0.6 hertz.geo -o hertz_q8.msh
DefineConstant[ order = 1, fine = 0.4 ];
R = 50; near = 9;
arc = near / R;

Point(1) = {0, -200, 0};
Point(2) = {100, -200, 0};
Point(3) = {100, 0, 0};
Point(4) = {near, 0, 0};
Point(5) = {0, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 1};
Curve Loop(1) = {1:5}; Plane Surface(1) = {1};

Point(6) = {0, 0, 0};
Point(7) = {R * Sin(arc), R - R * Cos(arc), 0};
Point(8) = {R, R, 0};
Point(9) = {0, 2 * R, 0};
Point(10) = {0, R, 0};
Circle(6) = {6, 10, 7}; Circle(7) = {7, 10, 8}; Circle(8) = {8, 10, 9}; Line(9) = {9, 6};
Curve Loop(2) = {6:9}; Plane Surface(2) = {2};

Field[1] = Box;
Field[1].XMin = -1; Field[1].XMax = near; Field[1].YMin = -near / 2; Field[1].YMax = near / 2;
Field[1].VIn = fine; Field[1].VOut = 10; Field[1].Thickness = 60;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
Mesh.RecombineAll = 1; Mesh.Algorithm = 8; Mesh.RecombinationAlgorithm = 3;
Mesh.ElementOrder = order; Mesh.SecondOrderIncomplete = 1;

Physical Surface("block") = {1};
Physical Surface("cylinder") = {2};
Physical Curve("block_bottom") = {1};
Physical Curve("block_contact") = {4, 3};
Physical Curve("block_axis") = {5};
Physical Curve("cylinder_contact") = {6, 7};
Physical Curve("cylinder_axis") = {9};
Physical Point("load") = {9};
Physical Point("touch") = {5};
