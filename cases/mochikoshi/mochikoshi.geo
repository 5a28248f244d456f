// Mochikoshi tailings dam No. 1, plane strain. x downstream, y up, metres.
// RECONSTRUCTED from published descriptions and drawings (see README.md), not a survey.
//
//            G      A crest                         tailings   left of A-B-D-S, structured in four blocks
//   +--------+--+--+.                               embankment A-crest-F-toe-S-D-B, upper and starter dam as one
//   |        |   R  B `.                                       surface: a line D-F would make slivers at F
//   |        |  Z    `. `. F                        foundation below y = -5, structured
//   |        |  |      P D  `.                      R-P is the phreatic line y = 18.43 - 0.303 x, a mesh line
//   +--------+--X-------S-----toe----------------
//
// level: 0 coarse, 1 default, 2 fine (854, 2 818 and 11 522 quadrilaterals). From the command line
// `gmsh -2 -setnumber level 0 mochikoshi.geo`.
DefineConstant[ level = {1, Min 0, Max 2, Step 1, Name "Parameters/level"} ];

If (level < 0.5)
  layers_above = 2;   // tailings between the phreatic line and the dam
  layers_below = 8;   // tailings below it
  columns_beach = 17; // tailings, x from -340 to -25
  columns_crest = 8;  // from -25 to the crest
  columns_slope = 14; // below the upper dam
  columns_base = 22;  // under the starter dam
  columns_down = 14;  // downstream
  layers_foundation = 4;
  size_dam = 3.0;     // embankment, m
ElseIf (level < 1.5)
  layers_above = 2;
  layers_below = 16;
  columns_beach = 32;
  columns_crest = 14;
  columns_slope = 26;
  columns_base = 40;
  columns_down = 28;
  layers_foundation = 8;
  size_dam = 1.75;
Else
  layers_above = 4;
  layers_below = 32;
  columns_beach = 66;
  columns_crest = 28;
  columns_slope = 52;
  columns_base = 84;
  columns_down = 58;
  layers_foundation = 17;
  size_dam = 0.85;
EndIf
layers = layers_above + layers_below;

// Points --------------------------------------------------------------------------------------------------------------
x_left = -340; x_right = 250; free_field = 10;
y_beach = 24; y_ground = -5; y_base = -35;
x_crest_block = -25;

// Phreatic line, below the slope.
slope = 0.303; level_0 = 18.43;
// It meets the starter dam's upstream face, y = -5 + (x - 14.8) / 1.5, at P.
x_p = (level_0 + 5 + 14.8 / 1.5) / (slope + 1 / 1.5);

Point(1) = {-5, 24, 0, size_dam};        // A
Point(2) = {0, 24.5, 0, size_dam};       // crest
Point(3) = {0.4, 21, 0, size_dam};       // B
Point(4) = {37.3, 10, 0, size_dam};      // D, starter dam's crest, inner edge
Point(5) = {43.26, 10, 0, size_dam};     // F, upper dam's toe
Point(6) = {88, y_ground, 0, size_dam};  // toe of the starter dam
Point(7) = {14.8, y_ground, 0, size_dam};                          // S
Point(8) = {x_p, level_0 - slope * x_p, 0, size_dam};              // P
Point(9) = {-5, level_0 + slope * 5, 0, size_dam};                 // R, below A
Point(10) = {-12, y_ground, 0, size_dam};                          // X, below R
Point(11) = {x_crest_block, y_ground, 0, size_dam};
Point(12) = {x_crest_block, y_beach, 0, size_dam};                 // G
Point(13) = {x_left, y_ground, 0, size_dam};
Point(14) = {x_left, y_beach, 0, size_dam};
Point(15) = {x_right, y_ground, 0, size_dam};
Point(16) = {x_left, y_base, 0, size_dam};
Point(17) = {x_crest_block, y_base, 0, size_dam};
Point(18) = {-12, y_base, 0, size_dam};
Point(19) = {14.8, y_base, 0, size_dam};
Point(20) = {88, y_base, 0, size_dam};
Point(21) = {x_right, y_base, 0, size_dam};
Point(22) = {x_left - free_field, y_base, 0, size_dam};
Point(23) = {x_left - free_field, y_ground, 0, size_dam};
Point(24) = {x_left - free_field, y_beach, 0, size_dam};
Point(25) = {x_right + free_field, y_base, 0, size_dam};
Point(26) = {x_right + free_field, y_ground, 0, size_dam};
// Where the ground surface of block G-A is divided, and the left edge of the same block, at the layer of the phreatic
// line: its share of the layers.
y_share = y_ground + (y_beach - y_ground) * layers_below / layers;
Point(27) = {x_crest_block, y_share, 0, size_dam};                 // Z
Point(28) = {x_left, y_share, 0, size_dam};
Point(29) = {x_left - free_field, y_share, 0, size_dam};

// Lines ---------------------------------------------------------------------------------------------------------------
Line(1) = {1, 2};    // crest
Line(2) = {2, 5};    // face of the upper dam
Line(3) = {5, 6};    // face of the starter dam
Line(4) = {7, 6};    // base of the dam
Line(5) = {7, 8};    // starter dam's upstream face, below the phreatic line
Line(6) = {8, 4};    //   and above it
Line(7) = {3, 4};    // upper dam's inner boundary
Line(8) = {1, 3};
Line(9) = {9, 8};    // phreatic line
Line(10) = {9, 1};
Line(11) = {10, 9};
Line(12) = {10, 7};
Line(13) = {11, 10};
Line(14) = {11, 27};
Line(15) = {27, 12};
Line(16) = {12, 1};
Line(17) = {27, 9};
Line(18) = {13, 11};
Line(19) = {14, 12};
Line(20) = {28, 27};
Line(21) = {13, 28};
Line(22) = {28, 14};
Line(23) = {6, 15};
Line(24) = {16, 17};
Line(25) = {17, 18};
Line(26) = {18, 19};
Line(27) = {19, 20};
Line(28) = {20, 21};
Line(29) = {16, 13};
Line(30) = {17, 11};
Line(31) = {18, 10};
Line(32) = {19, 7};
Line(33) = {20, 6};
Line(34) = {21, 15};
Line(35) = {22, 16};
Line(36) = {23, 13};
Line(37) = {29, 28};
Line(38) = {24, 14};
Line(39) = {22, 23};
Line(40) = {23, 29};
Line(41) = {29, 24};
Line(42) = {21, 25};
Line(43) = {15, 26};
Line(44) = {25, 26};

// Divisions of the structured blocks --------------------------------------------------------------------------------------
// Columns of the beach and of the valley widen away from the dam, the rows of the foundation with depth; ratios of the
// largest to the smallest:
ratio_beach = 6.0^(1 / (columns_beach - 1));
ratio_down = 5.8^(1 / (columns_down - 1));
ratio_deep = 3.4^(1 / (layers_foundation - 1));
Transfinite Curve {18, 19, 20, 24} = columns_beach + 1 Using Progression 1 / ratio_beach;
Transfinite Curve {13, 16, 17, 25} = columns_crest + 1;
Transfinite Curve {9, 12, 26} = columns_slope + 1;
// The top of the strip above the phreatic line, in two lines: columns shared by length (A-B 6.18 m, B-D 38.5 m).
columns_ab = 2 * Floor(columns_slope * 0.1383 / 2 + 0.5);
Transfinite Curve {8} = columns_ab + 1;
Transfinite Curve {7} = columns_slope - columns_ab + 1;
Transfinite Curve {5, 11, 14, 21, 40} = layers_below + 1;
Transfinite Curve {6, 10, 15, 22, 41} = layers_above + 1;
Transfinite Curve {4, 27} = columns_base + 1;
Transfinite Curve {23, 28} = columns_down + 1 Using Progression ratio_down;
Transfinite Curve {29, 30, 31, 32, 33, 34, 39, 44} = layers_foundation + 1 Using Progression 1 / ratio_deep;
Transfinite Curve {35, 36, 37, 38, 42, 43} = 3;

// Surfaces ------------------------------------------------------------------------------------------------------------
Curve Loop(1) = {18, 14, -20, -21};        Plane Surface(1) = {1};    // tailings: beach, below
Curve Loop(2) = {20, 15, -19, -22};        Plane Surface(2) = {2};    //   beach, above
Curve Loop(3) = {13, 11, -17, -14};        Plane Surface(3) = {3};    //   under the crest, below
Curve Loop(4) = {17, 10, -16, -15};        Plane Surface(4) = {4};    //   above
Curve Loop(5) = {12, 5, -9, -11};          Plane Surface(5) = {5};    //   under the upper dam, below the phreatic line
Curve Loop(6) = {9, 6, -7, -8, -10};       Plane Surface(6) = {6};    //   above it
Curve Loop(17) = {4, -3, -2, -1, 8, 7, -6, -5}; Plane Surface(17) = {17};  // embankment
Curve Loop(8) = {24, 30, -18, -29};        Plane Surface(8) = {8};    // foundation
Curve Loop(9) = {25, 31, -13, -30};        Plane Surface(9) = {9};
Curve Loop(10) = {26, 32, -12, -31};       Plane Surface(10) = {10};
Curve Loop(11) = {27, 33, -4, -32};        Plane Surface(11) = {11};
Curve Loop(12) = {28, 34, -23, -33};       Plane Surface(12) = {12};
Curve Loop(13) = {36, 21, -37, -40};       Plane Surface(13) = {13};  // free field
Curve Loop(14) = {37, 22, -38, -41};       Plane Surface(14) = {14};
Curve Loop(15) = {35, 29, -36, -39};       Plane Surface(15) = {15};
Curve Loop(16) = {42, 44, -43, -34};       Plane Surface(16) = {16};

Transfinite Surface {1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13, 14, 15, 16};
Transfinite Surface {6} = {9, 8, 4, 1};
Recombine Surface {1:6, 8:17};

// The embankment: full-quad recombination (a triangulation of twice the size, paired and then split in four) leaves no
// triangle. It needs even divisions on the embankment's outline and the structured surfaces meshed before it: hence its
// tag 17, the largest. At the toe the slope itself bounds the quality: sin(18.5 deg) = 0.318.
Mesh.Algorithm = 6;
Mesh.RecombinationAlgorithm = 3;
Smoother Surface {17} = 10;
Mesh.MshFileVersion = 4.1;
Mesh.SaveAll = 0;

// Names that fem.json refers to -------------------------------------------------------------------------------------------
Physical Surface("tailings") = {1:6};
Physical Surface("embankment") = {17};
Physical Surface("foundation") = {8:12};
Physical Surface("freefield_tailings") = {13, 14};
Physical Surface("freefield_foundation") = {15, 16};
Physical Curve("base") = {35, 24:28, 42};
Physical Curve("left") = {39:41};
Physical Curve("left_inner") = {29, 21, 22};
Physical Curve("right") = {44};
Physical Curve("right_inner") = {34};
Physical Curve("surface") = {38, 19, 16, 1, 2, 3, 23, 43};
