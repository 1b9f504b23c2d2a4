// An elastic block on elastic ground, meshes that do not match, about 20 000 degrees of freedom.
// The mesh beside this file is made by: gmsh -2 block_on_ground.geo
//
// The two bodies share no points, so the interface y = 0 has nodes of its own on either side, with no gap.
// Elements are square at the interface and grow with the distance from it.

Mesh.MshFileVersion = 4.1;

block_columns = 140; block_rows = 25; block_growth = 1.0615; // size 1/140 at the interface
slide_columns = 167;                                         // size 1.4/167, where the block slides
side_columns = 20;   side_growth = 1.153;
ground_rows = 30;    ground_growth = 1.054;

// Block: [0, 1] x [0, 0.4].
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {1, 0.4, 0};
Point(4) = {0, 0.4, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 3};
Line(4) = {1, 4};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = block_columns + 1;
Transfinite Curve{2, 4} = block_rows + 1 Using Progression block_growth;

// Ground: [-1, 2.2] x [-0.6, 0], in three columns; the block slides on the middle one, [-0.1, 1.3].
Point(11) = {-1, 0, 0};
Point(12) = {-0.1, 0, 0};
Point(13) = {1.3, 0, 0};
Point(14) = {2.2, 0, 0};
Point(21) = {-1, -0.6, 0};
Point(22) = {-0.1, -0.6, 0};
Point(23) = {1.3, -0.6, 0};
Point(24) = {2.2, -0.6, 0};
For i In {1:4}
  Line(10 + i) = {10 + i, 20 + i}; // down
EndFor
Line(21) = {12, 11};
Line(22) = {12, 13};
Line(23) = {13, 14};
Line(31) = {22, 21};
Line(32) = {22, 23};
Line(33) = {23, 24};
Curve Loop(11) = {-21, 12, 31, -11};
Curve Loop(12) = {-22, 12, 32, -13};
Curve Loop(13) = {-23, 13, 33, -14};
Plane Surface(11) = {11};
Plane Surface(12) = {12};
Plane Surface(13) = {13};
Transfinite Curve{11:14} = ground_rows + 1 Using Progression ground_growth;
Transfinite Curve{21, 31, 23, 33} = side_columns + 1 Using Progression side_growth;
Transfinite Curve{22, 32} = slide_columns + 1;

Transfinite Surface{1, 11:13};
Recombine Surface{1, 11:13};

Physical Surface("block") = {1};
Physical Curve("block_bottom") = {1};
Physical Curve("block_right") = {2};
Physical Curve("block_top") = {3};
Physical Curve("block_left") = {4};
Physical Surface("ground") = {11:13};
Physical Curve("ground_top") = {21:23};
Physical Curve("ground_bottom") = {31:33};
Physical Curve("ground_left") = {11};
Physical Curve("ground_right") = {14};
