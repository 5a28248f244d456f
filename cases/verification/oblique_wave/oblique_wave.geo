// A quarter of a full space around a line force at the origin, and a detached column beside it.
DefineConstant[reach = {60, Name "Parameters/reach"}];
h = 1.5;
Macro soilblock
  p = newp;
  Point(p) = {x0, -reach, 0};
  Point(p + 1) = {x1, -reach, 0};
  Point(p + 2) = {x1, 0, 0};
  Point(p + 3) = {x0, 0, 0};
  l = newl;
  Line(l) = {p, p + 1};
  Line(l + 1) = {p + 1, p + 2};
  Line(l + 2) = {p + 2, p + 3};
  Line(l + 3) = {p + 3, p};
  s = newll;
  Curve Loop(s) = {l, l + 1, l + 2, l + 3};
  Plane Surface(s) = {s};
  Transfinite Curve{l, l + 2} = columns + 1;
  Transfinite Curve{l + 1, l + 3} = Round(reach / h) + 1;
  Transfinite Surface{s};
  Recombine Surface{s};
Return

x0 = 0; x1 = reach; columns = Round(reach / h);
Call soilblock;
soil = s; b0 = l; r0 = l + 1; t0 = l + 2; l0 = l + 3;
x0 = reach + 3; x1 = reach + 4.5; columns = 1;
Call soilblock;
column = s; b1 = l; r1 = l + 1; t1 = l + 2; l1 = l + 3;

Physical Surface("soil") = {soil};
Physical Surface("columns") = {column};
Physical Curve("base") = {b0, b1};
Physical Curve("plane_of_force") = {l0};
Physical Curve("plane_across") = {t0};
Physical Curve("side") = {r0};
Physical Curve("column") = {l1};
Physical Curve("column_top") = {t1};
Physical Curve("column_back") = {r1};
