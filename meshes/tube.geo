// A rubber tube on a stiff plate, y < 0. The mesh beside this file is made by:
// gmsh -2 -format msh41 tube.geo

radius = 10; wall = 2; plate = 2; half = 18;
around = 24; // elements of a quarter
through = 4;

Point(1) = {0, radius, 0};
For i In {0:3}
  Point(10 + i) = {radius * Cos(i * Pi/2), radius + radius * Sin(i * Pi/2), 0};
  Point(20 + i) = {(radius - wall) * Cos(i * Pi/2), radius + (radius - wall) * Sin(i * Pi/2), 0};
  Line(30 + i) = {20 + i, 10 + i};
EndFor
For i In {0:3}
  Circle(10 + i) = {10 + i, 1, 10 + (i + 1) % 4};
  Circle(20 + i) = {20 + i, 1, 20 + (i + 1) % 4};
  Curve Loop(10 + i) = {30 + i, 10 + i, -(30 + (i + 1) % 4), -(20 + i)};
  Plane Surface(10 + i) = {10 + i};
EndFor
Transfinite Curve{10:13, 20:23} = around + 1;
Transfinite Curve{30:33} = through + 1;

Point(41) = {-half, -plate, 0};
Point(42) = {half, -plate, 0};
Point(43) = {half, 0, 0};
Point(44) = {-half, 0, 0};
Line(41) = {41, 42};
Line(42) = {42, 43};
Line(43) = {44, 43};
Line(44) = {41, 44};
Curve Loop(41) = {41, 42, -43, -44};
Plane Surface(41) = {41};
Transfinite Curve{41, 43} = 41;
Transfinite Curve{42, 44} = 3;

Transfinite Surface{10:13, 41};
Recombine Surface{10:13, 41};

Physical Surface("tube") = {10:13};
Physical Surface("plate") = {41};
Physical Curve("outside") = {10:13};
Physical Curve("inside") = {20:23};
Physical Curve("plate_bottom") = {41};
Physical Curve("plate_top") = {43};
Physical Point("keel") = {13};
