Include "mesh.geo";
Merge "motion.csv";
