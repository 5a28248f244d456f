SetFactory("Built-in");
level = DefineNumber[1, Name "Parameters/level"]; // comment
Point(1) = {0, 0, 0, 1}; /* x */
Physical Surface("soil", 1) = {1};
Printf("%g", level);
