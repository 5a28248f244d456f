// gmsh has one state for the whole program; what it must not leave behind.
#include "fem_stage/mesh/gmsh_mesh.hpp"

#include <doctest/doctest.h>
#include <omp.h>

#include <filesystem>
#include <fstream>

using namespace tailrun::fem;

TEST_CASE("reading a mesh leaves the number of threads alone") {
  const auto folder = std::filesystem::temp_directory_path() / "tailrun_gmsh_mesh_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "square.geo") << R"(
    SetFactory("OpenCASCADE");
    Rectangle(1) = {0, 0, 0, 1, 1};
    Transfinite Curve {1, 2, 3, 4} = 3;
    Transfinite Surface {1};
    Recombine Surface {1};
    Physical Surface("soil") = {1};
    Physical Curve("outline") = {1, 2, 3, 4};)";
  const int before = omp_get_max_threads();
  omp_set_num_threads(3);
  CHECK(mesh_geometry(folder / "square.geo", {}, folder / "square.msh").elements() == 4);
  CHECK(read_gmsh(folder / "square.msh").elements() == 4);
  CHECK(omp_get_max_threads() == 3);
  omp_set_num_threads(before);
  std::filesystem::remove_all(folder);
}
