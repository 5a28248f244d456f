#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/error.hpp"
#include "common/hdf5_file.hpp"
#include "common/hdf5_handle.hpp"
#include "common/output_place.hpp"

namespace tailrun {
namespace {

constexpr hsize_t rows_of_chunk = 16384;
constexpr std::size_t worth_packing = 4096;  // values

void check(herr_t status, const std::string& what) {
  if (status >= 0) return;
  const std::string reason = reason_of_system();
  throw ComputationError("cannot " + what + reason);
}

Hdf5Handle fixed_text_type(std::size_t length) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return Hdf5Handle(type, H5Tclose);
}

// No times of day in the headers, so that two equal runs make files of equal bytes, and their SHA-256 sums say whether
// anything has changed. The values have a checksum of their own; that of the headers comes with the file's version.
Hdf5Handle dataset_properties(int rank, const hsize_t* shape, std::size_t values) {
  const hid_t create = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_obj_track_times(create, false);
  if (values > 0) {
    const hsize_t chunk[2] = {std::min(shape[0], rows_of_chunk), rank == 2 ? shape[1] : 1};
    H5Pset_chunk(create, rank, chunk);
    if (values > worth_packing) {
      H5Pset_shuffle(create);
      H5Pset_deflate(create, 1);
    }
    H5Pset_fletcher32(create);
  }
  return Hdf5Handle(create, H5Pclose);
}

Hdf5Handle with_parents() {
  const hid_t link = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(link, 1);
  return Hdf5Handle(link, H5Pclose);
}

void write_attribute(hid_t object, const std::string& name, hid_t type, hid_t space, const void* data) {
  if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
  Hdf5Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (attribute < 0) throw ComputationError("HDF5: cannot make attribute " + name);
  check(H5Awrite(attribute, type, data), "write attribute " + name);
}

// Attribute texts are fixed-length ASCII: VTKHDF demands it for `Type`, and every reader understands it.
void write_text_attribute(hid_t object, const std::string& name, const std::string& value) {
  const Hdf5Handle type = fixed_text_type(value.size());
  Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(object, name, type, space, value.c_str());
}

// `type` in memory, `stored` in the file.
void write_dataset(hid_t file, const std::string& name, hid_t type, hid_t stored, int rank, const hsize_t* shape,
                   std::size_t values, const void* data, const std::string& unit, const std::string& description) {
  Hdf5Handle space(H5Screate_simple(rank, shape, nullptr), H5Sclose);
  const Hdf5Handle link = with_parents(), create = dataset_properties(rank, shape, values);
  Hdf5Handle dataset(H5Dcreate2(file, name.c_str(), stored, space, link, create, H5P_DEFAULT), H5Dclose);
  if (dataset < 0) throw ComputationError("HDF5: cannot make dataset " + name);
  if (values > 0) check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write " + name);
  write_text_attribute(dataset, "unit", unit);
  write_text_attribute(dataset, "description", description);
}

template <typename T>
void write_array(hid_t file, const std::string& name, hid_t type, hid_t stored, std::span<const T> values,
                 std::size_t columns, const std::string& unit, const std::string& description) {
  if (columns && values.size() % columns) throw std::logic_error(name + ": length is not a multiple of its columns");
  const hsize_t shape[2] = {columns ? values.size() / columns : values.size(), columns};
  write_dataset(file, name, type, stored, columns ? 2 : 1, shape, values.size(), values.data(), unit, description);
}

}  // namespace

Hdf5Writer::Hdf5Writer(const std::filesystem::path& path) : final_(path), temporary_(temporary_name(path)) {
  silence_hdf5();
  require_replaceable(path);
  if (!path.parent_path().empty()) std::filesystem::create_directories(path.parent_path());
  // The file format of HDF5 1.10: its headers, groups and attributes have checksums.
  const Hdf5Handle access(access_without_locks(), H5Pclose), create(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_obj_track_times(create, false);  // of the root group
  file_ = H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, create, access);
  if (file_ >= 0) return;
  const std::string reason = reason_of_system();
  throw ComputationError(fmt::format("{}: cannot be written{}", temporary_.string(), reason));
}

Hdf5Writer::~Hdf5Writer() {
  if (file_ >= 0) H5Fclose(file_);
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(temporary_, ignored);
}

void Hdf5Writer::group(const std::string& name) {
  if (H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0) return;
  const Hdf5Handle link = with_parents();
  Hdf5Handle create(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(create, false);
  Hdf5Handle made(H5Gcreate2(file_, name.c_str(), link, create, H5P_DEFAULT), H5Gclose);
  if (made < 0) throw ComputationError("HDF5: cannot make group " + name);
}

void Hdf5Writer::write(const std::string& name, std::span<const double> values, std::size_t columns,
                       const std::string& unit, const std::string& description) {
  make_parents(name);
  write_array(file_, name, H5T_NATIVE_DOUBLE, singles_ ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE, values, columns, unit,
              description);
}
void Hdf5Writer::write(const std::string& name, std::span<const std::int64_t> values, std::size_t columns,
                       const std::string& unit, const std::string& description) {
  make_parents(name);
  write_array(file_, name, H5T_NATIVE_INT64, H5T_NATIVE_INT64, values, columns, unit, description);
}
void Hdf5Writer::write(const std::string& name, std::span<const std::int32_t> values, std::size_t columns,
                       const std::string& unit, const std::string& description) {
  make_parents(name);
  write_array(file_, name, H5T_NATIVE_INT32, H5T_NATIVE_INT32, values, columns, unit, description);
}
void Hdf5Writer::write(const std::string& name, std::span<const std::uint8_t> values, const std::string& unit,
                       const std::string& description) {
  make_parents(name);
  write_array(file_, name, H5T_NATIVE_UINT8, H5T_NATIVE_UINT8, values, 0, unit, description);
}

void Hdf5Writer::write_texts(const std::string& name, const std::vector<std::string>& values,
                             const std::string& description) {
  make_parents(name);
  std::size_t length = 1;
  for (const auto& value : values) length = std::max(length, value.size());
  std::string packed(length * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) packed.replace(i * length, values[i].size(), values[i]);
  const Hdf5Handle type = fixed_text_type(length);
  const hsize_t shape[1] = {values.size()};
  write_dataset(file_, name, type, type, 1, shape, values.size(), packed.data(), "1", description);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, const std::string& value) {
  Hdf5Handle target(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose);
  write_text_attribute(target, name, value);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, double value) {
  Hdf5Handle target(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose);
  Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(target, name, H5T_NATIVE_DOUBLE, space, &value);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values) {
  Hdf5Handle target(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose);
  const hsize_t shape[1] = {values.size()};
  Hdf5Handle space(H5Screate_simple(1, shape, nullptr), H5Sclose);
  write_attribute(target, name, H5T_NATIVE_INT64, space, values.data());
}

// Groups that the library would make on the way have times in them.
void Hdf5Writer::make_parents(const std::string& name) {
  for (std::size_t slash = name.find('/', 1); slash != std::string::npos; slash = name.find('/', slash + 1))
    group(name.substr(0, slash));
}

void Hdf5Writer::commit() {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "write " + temporary_.string());
  const hid_t file = std::exchange(file_, -1);
  check(H5Fclose(file), "close " + temporary_.string());
  std::filesystem::rename(temporary_, final_);
  committed_ = true;
}

}  // namespace tailrun
