// Section of two rings, pressed into one another with an overlap of 0.02: x is the radius, y the axis.
Mesh.ElementOrder = 2;
bore = 20;  fit = 30;  outside = 45;  high = 10;  overlap = 0.02;

Point(1) = {bore, 0, 0, 2.5};
Point(2) = {fit + overlap, 0, 0, 2.5};
Point(3) = {fit + overlap, high, 0, 2.5};
Point(4) = {bore, high, 0, 2.5};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};

Point(11) = {fit, 0, 0, 2};
Point(12) = {outside, 0, 0, 2};
Point(13) = {outside, high, 0, 2};
Point(14) = {fit, high, 0, 2};
Line(11) = {11, 12};
Line(12) = {12, 13};
Line(13) = {13, 14};
Line(14) = {14, 11};
Curve Loop(11) = {11, 12, 13, 14};
Plane Surface(11) = {11};

Physical Surface("sleeve") = {1};
Physical Surface("hub") = {11};
Physical Curve("bore") = {4};
Physical Curve("seat") = {2};
Physical Curve("socket") = {14};
Physical Curve("foot") = {1, 11};
