// A punch with a flat face, rounded off by R = 6, on a plate with a hole; x = 0 is a line of symmetry. mm
// Each body has points and curves of its own, where they touch too.
Mesh.ElementOrder = 2;
edge = 0.05;              // sides where the flat ends, and the pressure is largest
face = 0.4;               // along the rest of the contact
bore = 0.6;

half = 2;
Point(1) = {0, 0, 0, face};
Point(2) = {half, 0, 0, edge/1.4};
Point(3) = {5, 0, 0, 2*face};
Point(4) = {20, 0, 0, 4};
Point(5) = {20, -16, 0, 4};
Point(6) = {0, -16, 0, 3};
Point(7) = {0, -11, 0, bore};
Point(8) = {0, -8, 0, bore};
Point(9) = {3, -8, 0, bore};
Point(10) = {0, -5, 0, bore};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 7};
Circle(7) = {7, 8, 9};
Circle(8) = {9, 8, 10};
Line(9) = {10, 1};
Curve Loop(1) = {1:9};
Plane Surface(1) = {1};

Point(11) = {0, 0, 0, face};
Point(12) = {half, 0, 0, edge};
Point(13) = {half, 6, 0, 1};
Point(14) = {half + 6, 6, 0, 3};
Point(15) = {half + 6, 12, 0, 3};
Point(16) = {0, 12, 0, 3};
Line(11) = {11, 12};
Circle(12) = {12, 13, 14};
Line(13) = {14, 15};
Line(14) = {15, 16};
Line(15) = {16, 11};
Curve Loop(11) = {11:15};
Plane Surface(11) = {11};

Physical Surface("plate") = {1};
Physical Surface("punch") = {11};
Physical Curve("surface") = {1, 2};
Physical Curve("nose") = {11, 12};
Physical Curve("symmetry") = {6, 9, 15};
Physical Curve("ground") = {5};
Physical Curve("top") = {14};
