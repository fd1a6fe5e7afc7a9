// Cylinders, R = 10 on R = 20, touching at the origin; x = 0 is a line of symmetry.
// Each has points and curves of its own, at the origin too.
Mesh.ElementOrder = 2;
fine = 0.04;              // sides at the contact; the half-width will be 0.19

lower = 20;
Point(1) = {0, 0, 0, fine/1.4};
Point(2) = {lower, -lower, 0, 8};
Point(3) = {0, -lower, 0, 8};
Circle(1) = {1, 3, 2};
Line(2) = {2, 3};
Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};

upper = 10;
Point(11) = {0, 0, 0, fine};
Point(12) = {upper, upper, 0, 4};
Point(13) = {0, upper, 0, 4};
Circle(11) = {11, 13, 12};
Line(12) = {12, 13};
Line(13) = {13, 11};
Curve Loop(11) = {11, 12, 13};
Plane Surface(11) = {11};

Physical Surface("lower") = {1};
Physical Surface("upper") = {11};
Physical Curve("lower arc") = {1};
Physical Curve("upper arc") = {11};
Physical Curve("symmetry") = {3, 13};
Physical Curve("ground") = {2};
Physical Curve("top") = {12};
