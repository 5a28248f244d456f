#include "common/claimed_sizes.hpp"

#include <doctest/doctest.h>

#include "common/error.hpp"
#include "common/hdf5_file.hpp"

using namespace tailrun;

TEST_CASE("a dataset that claims more than its file can hold is refused when the file is opened") {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_claims.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t extent = 1'000'000'000'000, chunk = 1024;
  const hid_t space = H5Screate_simple(1, &extent, nullptr), create = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(create, 1, &chunk);
  const hid_t dataset = H5Dcreate2(file, "mass", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, create, H5P_DEFAULT);
  H5Dclose(dataset);
  H5Pclose(create);
  H5Sclose(space);
  H5Fclose(file);
  CHECK_THROWS_WITH_AS(Hdf5Reader{path}, doctest::Contains("'mass' claims more data than the file can hold"),
                       InputError);
  std::filesystem::remove(path);
}
