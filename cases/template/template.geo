// A small tailings dam to start from: copy this folder, change the points below. x downstream, y up, metres.
//
//        1-------2--3           tailings    left of 2-5
//        |      /    `.         dam         2-3-4-5, slopes 1:1.5 upstream and 1:2 downstream
//   8----6-----5-------4------7 foundation  below y = 0
//
// level: 0 coarse, 1 default, 2 fine.
DefineConstant[ level = {1, Min 0, Max 2, Step 1, Name "Parameters/level"} ];

height = 6; crest = 2; upstream = 1.5; downstream = 2; beach = 40; valley = 40; depth = 6; free_field = 4;
rows = (level < 0.5) ? 5 : ((level < 1.5) ? 8 : 16);   // over the height of the dam
size = height / rows;

x_left = -beach; x_right = valley + height * (upstream + downstream) + crest;
x_crest = height * upstream;
x_toe = x_crest + crest + height * downstream;

Point(1) = {x_left, height, 0};
Point(2) = {x_crest, height, 0};
Point(3) = {x_crest + crest, height, 0};
Point(4) = {x_toe, 0, 0};
Point(5) = {0, 0, 0};
Point(6) = {x_left, 0, 0};
Point(7) = {x_right, 0, 0};
Point(8) = {x_left, -depth, 0};
Point(9) = {0, -depth, 0};
Point(10) = {x_toe, -depth, 0};
Point(11) = {x_right, -depth, 0};
Point(12) = {x_left - free_field, -depth, 0};
Point(13) = {x_left - free_field, 0, 0};
Point(14) = {x_left - free_field, height, 0};
Point(15) = {x_right + free_field, -depth, 0};
Point(16) = {x_right + free_field, 0, 0};

Line(1) = {1, 2};   Line(2) = {2, 3};    Line(3) = {3, 4};    Line(4) = {5, 4};   Line(5) = {5, 2};
Line(6) = {6, 5};   Line(7) = {6, 1};    Line(8) = {4, 7};    Line(9) = {8, 9};   Line(10) = {9, 10};
Line(11) = {10, 11}; Line(12) = {8, 6};  Line(13) = {9, 5};   Line(14) = {10, 4}; Line(15) = {11, 7};
Line(16) = {12, 8}; Line(17) = {13, 6};  Line(18) = {14, 1};  Line(19) = {12, 13}; Line(20) = {13, 14};
Line(21) = {11, 15}; Line(22) = {7, 16}; Line(23) = {15, 16};

// The dam is one structured block: its crest has as many columns as its base.
columns_beach = Floor(beach / (2 * size)); columns_dam = Floor(0.5 * (x_toe + crest) / size);
columns_valley = Floor(valley / (2.5 * size)); rows_deep = Floor(depth / (1.5 * size));
Transfinite Curve {1, 6, 9} = columns_beach + 1 Using Progression 0.96;
Transfinite Curve {2, 4, 10} = columns_dam + 1;
Transfinite Curve {8, 11} = columns_valley + 1 Using Progression 1.04;
Transfinite Curve {3, 5, 7, 20} = rows + 1;
Transfinite Curve {12, 13, 14, 15, 19, 23} = rows_deep + 1;
Transfinite Curve {16, 17, 18, 21, 22} = 3;

Curve Loop(1) = {6, 5, -1, -7};     Plane Surface(1) = {1};
Curve Loop(2) = {4, -3, -2, -5};    Plane Surface(2) = {2};
Curve Loop(3) = {9, 13, -6, -12};   Plane Surface(3) = {3};
Curve Loop(4) = {10, 14, -4, -13};  Plane Surface(4) = {4};
Curve Loop(5) = {11, 15, -8, -14};  Plane Surface(5) = {5};
Curve Loop(6) = {17, 7, -18, -20};  Plane Surface(6) = {6};
Curve Loop(7) = {16, 12, -17, -19}; Plane Surface(7) = {7};
Curve Loop(8) = {21, 23, -22, -15}; Plane Surface(8) = {8};
Transfinite Surface {1:8};
Recombine Surface {1:8};
Mesh.MshFileVersion = 4.1;

// Names that fem.json refers to.
Physical Surface("tailings") = {1};
Physical Surface("embankment") = {2};
Physical Surface("foundation") = {3:5};
Physical Surface("freefield_tailings") = {6};
Physical Surface("freefield_foundation") = {7, 8};
Physical Curve("base") = {16, 9, 10, 11, 21};
Physical Curve("left") = {19, 20};
Physical Curve("left_inner") = {12, 7};
Physical Curve("right") = {23};
Physical Curve("right_inner") = {15};
Physical Curve("surface") = {18, 1, 2, 3, 8, 22};
