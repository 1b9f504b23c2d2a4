// Two equal blocks, one on the other, each held at its left side but for a strip along the interface.
//   gmsh -2 -format msh41 slip_front.geo
//   gmsh -2 -format msh41 -setnumber fine 2 slip_front.geo -o slip_front_fine.msh
DefineConstant[ length = 120, height = 40, free = 5, columns = 96, rows = 15, fine = 1 ];
// Thickness of a row over that of the one below it.
growth = 1.1 ^ (1 / fine);
Point(1) = {0, 0, 0}; Point(2) = {length, 0, 0}; Point(3) = {length, height, 0}; Point(4) = {0, height, 0};
Point(5) = {length, -height, 0}; Point(6) = {0, -height, 0}; Point(7) = {0, 0, 0}; Point(8) = {length, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {4, 3}; Line(4) = {1, 4};
Line(5) = {7, 8}; Line(6) = {8, 5}; Line(7) = {6, 5}; Line(8) = {7, 6};
Transfinite Curve{1, 3, 5, 7} = fine * columns + 1;
Transfinite Curve{2, 4, 6, 8} = fine * rows + 1 Using Progression growth;
Curve Loop(1) = {1, 2, -3, -4}; Plane Surface(1) = {1};
Curve Loop(2) = {7, -6, -5, 8}; Plane Surface(2) = {2};
Transfinite Surface{1, 2}; Recombine Surface{1, 2};

Physical Surface("block") = {1};
Physical Surface("base") = {2};
Physical Curve("block_bottom") = {1};
Physical Curve("block_right") = {2};
Physical Curve("block_top") = {3};
Physical Curve("block_left") = {4};
Physical Curve("base_top") = {5};
Physical Curve("base_right") = {6};
Physical Curve("base_bottom") = {7};
Physical Curve("base_left") = {8};
