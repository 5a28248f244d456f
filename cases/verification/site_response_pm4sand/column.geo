// 30 m of soil in three layers of 10 m, one element wide, elements of 1 m x 1 m.
For k In {0:3}
  Point(2 * k + 1) = {0, 10 * k, 0};
  Point(2 * k + 2) = {1, 10 * k, 0};
  Line(100 + k) = {2 * k + 1, 2 * k + 2};
EndFor
For k In {0:2}
  Line(200 + k) = {2 * k + 1, 2 * k + 3};
  Line(300 + k) = {2 * k + 2, 2 * k + 4};
  Curve Loop(k + 1) = {100 + k, 300 + k, -(101 + k), -(200 + k)};
  Plane Surface(k + 1) = {k + 1};
EndFor
Transfinite Curve {100:103} = 2;
Transfinite Curve {200:202, 300:302} = 11;
Transfinite Surface {1:3};
Recombine Surface {1:3};
Physical Surface("foundation") = {1};
Physical Surface("embankment") = {2};
Physical Surface("tailings") = {3};
Physical Curve("base") = {100};
Physical Curve("left") = {200:202};
Physical Curve("right") = {300:302};
Physical Curve("surface") = {103};
