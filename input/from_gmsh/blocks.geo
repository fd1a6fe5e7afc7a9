// A block, 3 x 1.5, on another, 3 x 2: quadrilaterals of unlike sizes.
Mesh.Algorithm = 8;
Point(1) = {0, 0, 0, 0.5};
Point(2) = {3, 0, 0, 0.5};
Point(3) = {3, 2, 0, 0.5};
Point(4) = {0, 2, 0, 0.5};
Point(11) = {0, 2, 0, 0.7};
Point(12) = {3, 2, 0, 0.7};
Point(13) = {3, 3.5, 0, 0.7};
Point(14) = {0, 3.5, 0, 0.7};
For k In {0:10:10}
  Line(k + 1) = {k + 1, k + 2};
  Line(k + 2) = {k + 2, k + 3};
  Line(k + 3) = {k + 3, k + 4};
  Line(k + 4) = {k + 4, k + 1};
  Curve Loop(k + 1) = {k + 1, k + 2, k + 3, k + 4};
  Plane Surface(k + 1) = {k + 1};
  Recombine Surface {k + 1};
EndFor
Physical Surface("below") = {1};
Physical Surface("above") = {11};
Physical Curve("ground") = {1};
Physical Curve("face") = {3};
Physical Curve("under") = {11};
Physical Curve("top") = {13};
Physical Curve("wall") = {4, 14};
