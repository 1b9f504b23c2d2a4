// Ironing: a die with a round lower edge on a block 12 x 4 with the given number of columns.
//   gmsh -2 -format msh41 ironing.geo -o ironing_q4.msh
//   gmsh -2 -format msh41 -setnumber columns 108 ironing.geo -o ironing_q4_fine.msh
//   gmsh -2 -format msh41 -setnumber order 2 -setnumber columns 48 ironing.geo -o ironing_q8.msh
//   gmsh -2 -format msh41 -setnumber order 2 -setnumber columns 72 ironing.geo -o ironing_q8_fine.msh
DefineConstant[ columns = 72, order = 1 ];
Point(1) = {0, -4, 0}; Point(2) = {12, -4, 0}; Point(3) = {12, 0, 0}; Point(4) = {0, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = columns + 1;
Transfinite Curve{2, -4} = columns / 4 + 1 Using Progression 0.95;

// The arc lies in the lower edge of a mapped rectangle.
Point(5) = {0.2, 0.5, 0}; Point(6) = {1.4, 0.5, 0}; Point(7) = {1.4, 1.4, 0}; Point(8) = {0.2, 1.4, 0};
Point(9) = {0.8, 0.95, 0};
Circle(5) = {5, 9, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 5};
Curve Loop(2) = {5:8}; Plane Surface(2) = {2};
Transfinite Curve{5, 7} = columns / 6 + 1;
Transfinite Curve{6, 8} = columns / 9 + 1;
Transfinite Surface{1, 2}; Recombine Surface{1, 2};
Mesh.ElementOrder = order; Mesh.SecondOrderIncomplete = 1;

Physical Surface("block") = {1};
Physical Surface("die") = {2};
Physical Curve("block_bottom") = {1};
Physical Curve("block_top") = {3};
Physical Curve("die_contact") = {6, 5, 8};
Physical Curve("die_top") = {7};
