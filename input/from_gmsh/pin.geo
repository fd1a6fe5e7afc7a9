// Pin, R = 10, in a hole that is larger by 0.0122335, in a lug of radius 300; x >= 0.
Mesh.ElementOrder = 2;
r = 10;  hole = r + 0.0122335;  far = 300;
fine = Pi*r/32;

Point(1) = {0, 0, 0, 4};
Point(2) = {0, -r, 0, fine};
Point(3) = {r, 0, 0, fine};
Point(4) = {0, r, 0, 4};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 1};
Line(4) = {1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Point(10) = {0, 0, 0};
Point(12) = {0, -hole, 0, fine/1.4};
Point(13) = {hole, 0, 0, fine/1.4};
Point(14) = {0, hole, 0, 4};
Point(22) = {0, -far, 0, 120};
Point(23) = {far, 0, 0, 120};
Point(24) = {0, far, 0, 120};
Circle(11) = {12, 10, 13};
Circle(12) = {13, 10, 14};
Line(13) = {14, 24};
Circle(14) = {24, 10, 23};
Circle(15) = {23, 10, 22};
Line(16) = {22, 12};
Curve Loop(11) = {11, 12, 13, 14, 15, 16};
Plane Surface(11) = {11};

Physical Surface("pin") = {1};
Physical Surface("lug") = {11};
Physical Curve("pin side") = {1};
Physical Curve("hole side") = {11};
Physical Curve("symmetry") = {3, 4, 13, 16};
Physical Curve("edge") = {14, 15};
Physical Point("centre") = {1};
