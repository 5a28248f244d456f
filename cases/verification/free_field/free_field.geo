// A block of soil between two detached columns of the same soil, all on one level base.
Macro soilblock
  p = newp;
  Point(p) = {x0, 0, 0};
  Point(p + 1) = {x1, 0, 0};
  Point(p + 2) = {x1, 20, 0};
  Point(p + 3) = {x0, 20, 0};
  l = newl;
  Line(l) = {p, p + 1};
  Line(l + 1) = {p + 1, p + 2};
  Line(l + 2) = {p + 2, p + 3};
  Line(l + 3) = {p + 3, p};
  s = newll;
  Curve Loop(s) = {l, l + 1, l + 2, l + 3};
  Plane Surface(s) = {s};
  Transfinite Curve{l, l + 2} = columns + 1;
  Transfinite Curve{l + 1, l + 3} = 21;
  Transfinite Surface{s};
  Recombine Surface{s};
Return

x0 = 0; x1 = 30; columns = 30;
Call soilblock;
soil = s; b0 = l; r0 = l + 1; t0 = l + 2; l0 = l + 3;
x0 = -4; x1 = -3; columns = 1;
Call soilblock;
left = s; b1 = l; r1 = l + 1; t1 = l + 2; l1 = l + 3;
x0 = 33; x1 = 34; columns = 1;
Call soilblock;
right = s; b2 = l; r2 = l + 1; t2 = l + 2; l2 = l + 3;

Physical Surface("soil") = {soil};
Physical Surface("columns") = {left, right};
Physical Curve("base") = {b0, b1, b2};
Physical Curve("left") = {l0};
Physical Curve("right") = {r0};
Physical Curve("left_column") = {r1};
Physical Curve("right_column") = {l2};
Physical Curve("surface") = {t0, t1, t2};
Physical Curve("column_backs") = {l1, r2};
