// Half of the section through a pile in the ground: x is the radius, y the axis.
//   gmsh -2 -format msh41 pile.geo
DefineConstant[ radius = 0.5, length = 10, width = 15, depth = 15, rows = 40, below = 10, columns = 20 ];
Point(1) = {0, -length, 0}; Point(2) = {radius, -length, 0}; Point(3) = {radius, 0, 0}; Point(4) = {0, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Transfinite Curve{1, 3} = 4 + 1;
Transfinite Curve{2, 4} = rows + 1;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};

Point(11) = {0, -depth, 0}; Point(12) = {radius, -depth, 0}; Point(13) = {width, -depth, 0};
Point(14) = {0, -length, 0}; Point(15) = {radius, -length, 0}; Point(16) = {width, -length, 0};
Point(17) = {radius, 0, 0}; Point(18) = {width, 0, 0};
Line(11) = {11, 12}; Line(12) = {12, 13}; Line(13) = {13, 16}; Line(14) = {16, 18}; Line(15) = {18, 17};
Line(16) = {17, 15}; Line(17) = {15, 14}; Line(18) = {14, 11}; Line(19) = {15, 16}; Line(20) = {12, 15};
Transfinite Curve{11, 17} = 4 + 1;
Transfinite Curve{12, 19} = columns + 1 Using Progression 1.15;
Transfinite Curve{15} = columns + 1 Using Progression 1 / 1.15;
Transfinite Curve{14, 16} = rows + 1;
Transfinite Curve{13, 20} = below + 1;
Transfinite Curve{18} = below + 1;
Curve Loop(2) = {11, 20, 17, 18}; Plane Surface(2) = {2};
Curve Loop(3) = {12, 13, -19, -20}; Plane Surface(3) = {3};
Curve Loop(4) = {19, 14, 15, 16}; Plane Surface(4) = {4};
Transfinite Surface{1, 2, 3, 4}; Recombine Surface{1, 2, 3, 4};

Physical Surface("pile") = {1};
Physical Surface("soil") = {2, 3, 4};
Physical Curve("pile_shaft") = {2};
Physical Curve("pile_head") = {3};
Physical Curve("soil_wall") = {16};
Physical Curve("soil_bottom") = {11, 12};
Physical Curve("soil_side") = {13, 14};
