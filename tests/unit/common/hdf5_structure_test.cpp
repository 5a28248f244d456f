// Files that are damaged or not ours: each ends in a message with file and object, none in a crash.
#include "common/hdf5_structure.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <functional>

#include "common/error.hpp"
#include "common/hdf5_file.hpp"

using namespace tailrun;

namespace {

// A file made by the library's own functions, as foreign programs do.
class ForeignFile {
 public:
  explicit ForeignFile(const std::function<void(hid_t)>& fill)
      : path_(std::filesystem::temp_directory_path() / ("tailrun_foreign_" + std::to_string(getpid()) + ".h5")) {
    const hid_t file = H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    fill(file);
    H5Fclose(file);
  }
  ~ForeignFile() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void group(hid_t file, const char* name) {
  H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

void dataset(hid_t file, const char* name, hid_t type, const std::vector<hsize_t>& shape, const void* values = nullptr,
             hid_t create = H5P_DEFAULT) {
  const hid_t space =
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t made = H5Dcreate2(file, name, type, space, H5P_DEFAULT, create, H5P_DEFAULT);
  if (values) H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  H5Dclose(made);
  H5Sclose(space);
}

void attribute(hid_t file, const char* name, hid_t type, hsize_t count, const void* values) {
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t made = H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  H5Awrite(made, type, values);
  H5Aclose(made);
  H5Sclose(space);
}

std::string refusal(const std::function<void(hid_t)>& fill, const std::function<void(const Hdf5Reader&)>& read) {
  const ForeignFile file(fill);
  try {
    const Hdf5Reader reader(file.path());
    read(reader);
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).starts_with(file.path().string() + ": "));
    return error.what();
  }
  return "";
}

void nothing(const Hdf5Reader&) {}

}  // namespace

TEST_CASE("a dataset that claims more than its file can hold is refused when the file is opened") {
  const std::string message = refusal(
      [](hid_t file) {
        const hsize_t extent = 1'000'000'000'000, chunk = 1024;
        const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(create, 1, &chunk);
        dataset(file, "mass", H5T_NATIVE_DOUBLE, {extent}, nullptr, create);
        H5Pclose(create);
      },
      nothing);
  CHECK(message.find("/mass: claims more data than the file can hold") != std::string::npos);
}

TEST_CASE("links that lead in circles or out of the file are refused when it is opened") {
  const auto refused = [](const std::function<void(hid_t)>& fill) { return refusal(fill, nothing); };
  CHECK(refused([](hid_t file) {
          group(file, "/a");
          H5Lcreate_hard(file, "/a", file, "/a/again", H5P_DEFAULT, H5P_DEFAULT);
        }).find("a group with 2 names") != std::string::npos);
  CHECK(refused([](hid_t file) {
          group(file, "/a");
          H5Lcreate_hard(file, "/", file, "/a/top", H5P_DEFAULT, H5P_DEFAULT);
        }).find("names; every group must have one place") != std::string::npos);
  CHECK(refused([](hid_t file) {
          H5Lcreate_soft("/b", file, "b", H5P_DEFAULT, H5P_DEFAULT);
        }).find("'b' is a soft link") != std::string::npos);
  CHECK(refused([](hid_t file) {
          H5Lcreate_external("other.h5", "/x", file, "x", H5P_DEFAULT, H5P_DEFAULT);
        }).find("'x' is an external link") != std::string::npos);
  CHECK(refused([](hid_t file) {
          const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
          H5Pset_external(create, "/etc/passwd", 0, 80);
          dataset(file, "velocity", H5T_NATIVE_DOUBLE, {10}, nullptr, create);
          H5Pclose(create);
        }).find("/velocity: has its values in an external file") != std::string::npos);
}

TEST_CASE("shapes and types that do not fit are refused with what is required") {
  const double one = 1.5, nan = std::nan("");
  const auto of = [](hid_t type, const std::vector<hsize_t>& shape, const void* values,
                     const std::function<void(const Hdf5Reader&)>& read) {
    return refusal([&](hid_t file) { dataset(file, "x", type, shape, values); }, read);
  };
  const auto doubles = [](const Hdf5Reader& file) { file.doubles("/x"); };
  const auto integers = [](const Hdf5Reader& file) { file.integers("/x"); };
  const auto texts = [](const Hdf5Reader& file) { file.texts("/x"); };
  CHECK(of(H5T_NATIVE_DOUBLE, {}, &one, doubles).find("/x: is a single value") != std::string::npos);
  CHECK(of(H5T_NATIVE_DOUBLE, std::vector<hsize_t>(20, 1), &one, doubles).find("has 20 dimensions") !=
        std::string::npos);
  CHECK(of(H5T_NATIVE_DOUBLE, {1}, &one, integers).find("holds floating-point numbers, but integers are required") !=
        std::string::npos);
  CHECK(of(H5T_NATIVE_DOUBLE, {1}, &nan, doubles).find("entry 0 is nan") != std::string::npos);
  CHECK(of(H5T_NATIVE_DOUBLE, {1}, &one, texts).find("holds floating-point numbers, but fixed-length texts") !=
        std::string::npos);
  CHECK(of(H5T_C_S1, {2, 2}, "abcd", texts).find("has 2 dimensions, but a list of texts") != std::string::npos);
  CHECK(of(H5T_C_S1, {4}, "abcd", doubles).find("holds texts, but numbers are required") != std::string::npos);
  CHECK(refusal(
            [](hid_t file) {
              const hid_t space = H5Screate(H5S_NULL);
              H5Dclose(H5Dcreate2(file, "x", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
              H5Sclose(space);
            },
            doubles)
            .find("null dataset") != std::string::npos);
}

TEST_CASE("an attribute has one value, and a number is finite") {
  const std::vector<double> many(5000, 1.0);
  const double nan = std::nan("");
  const auto number = [](const Hdf5Reader& file) { file.number_attribute("/", "time_s"); };
  const auto text = [](const Hdf5Reader& file) { file.text_attribute("/", "time_s"); };
  const auto with = [](hid_t type, hsize_t count, const void* values) {
    return [=](hid_t file) { attribute(file, "time_s", type, count, values); };
  };
  CHECK(refusal(with(H5T_NATIVE_DOUBLE, 2, many.data()), number).find("'time_s' has 2 values, but one") !=
        std::string::npos);
  CHECK(refusal(with(H5T_NATIVE_DOUBLE, 5000, many.data()), number).find("has 5000 values") != std::string::npos);
  CHECK(refusal(with(H5T_NATIVE_DOUBLE, 1, &nan), number).find("is nan, but a finite number") != std::string::npos);
  CHECK(refusal(with(H5T_C_S1, 1, "a"), number).find("is not a number") != std::string::npos);
  CHECK(refusal(with(H5T_NATIVE_DOUBLE, 1, many.data()), text).find("is not a text") != std::string::npos);
  const hid_t variable = H5Tcopy(H5T_C_S1);
  H5Tset_size(variable, H5T_VARIABLE);
  const std::vector<const char*> words(500, "word");
  CHECK(refusal(with(variable, 500, words.data()), text).find("has 500 values") != std::string::npos);
  CHECK(refusal(with(variable, 1, words.data()), text) == "");
  CHECK(refusal(with(H5T_NATIVE_DOUBLE, 1, many.data()), number) == "");
  H5Tclose(variable);
}
