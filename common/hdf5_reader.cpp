#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/hdf5_file.hpp"
#include "common/hdf5_handle.hpp"
#include "common/hdf5_structure.hpp"

namespace tailrun {
namespace {

const char* const damaged =
    "cannot be read: its checksum or its structure is wrong. The file is damaged; make it again";

std::string words_for(H5T_class_t kind) {
  switch (kind) {
    case H5T_INTEGER:
      return "integers";
    case H5T_FLOAT:
      return "floating-point numbers";
    case H5T_STRING:
      return "texts";
    case H5T_COMPOUND:
      return "compound values";
    case H5T_ENUM:
      return "an enumeration (truth values are one)";
    case H5T_VLEN:
      return "lists of variable length";
    case H5T_REFERENCE:
      return "references";
    case H5T_ARRAY:
      return "arrays";
    default:
      return "values of another kind";
  }
}

// Elements of an attribute's or dataset's space; 0 for a null space.
std::size_t count_of(hid_t space) {
  return static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : path_(path) {
  silence_hdf5();
  std::error_code failed;
  const auto status = std::filesystem::status(path, failed);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: no such file", path.string()));
  if (!std::filesystem::is_regular_file(status))
    throw InputError(fmt::format("{}: is not a file, but an HDF5 file is required here", path.string()));
  if (superblock_version(path) < 0 && H5Fis_hdf5(path.c_str()) <= 0)
    throw InputError(fmt::format("{}: not an HDF5 file, or cut short", path.string()));
  check_survives_reading(path);
  const Hdf5Handle access(access_without_locks(), H5Pclose);
  file_ = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access);
  if (file_ < 0) {
    const std::string reason = reason_of_system();
    throw InputError(
        reason.empty()
            ? fmt::format(
                  "{}: cannot be opened as HDF5; it is truncated, damaged or still being written. Make it again.",
                  path.string())
            : fmt::format("{}: cannot be opened{}", path.string(), reason));
  }
  try {
    check_structure(file_, path_);
  } catch (...) {
    H5Fclose(file_);  // the destructor of what was never made does not run
    throw;
  }
}

Hdf5Reader::~Hdf5Reader() {
  if (file_ >= 0) H5Fclose(file_);
}

void Hdf5Reader::fail(const std::string& name, const std::string& message) const {
  throw InputError(fmt::format("{}: {}: {}", path_.string(), name, message));
}

bool Hdf5Reader::has(const std::string& name) const {
  for (std::size_t slash = name.find('/', 1);; slash = name.find('/', slash + 1)) {
    const std::string part = name.substr(0, slash);
    if (part != "/" && H5Lexists(file_, part.c_str(), H5P_DEFAULT) <= 0) return false;
    if (slash == std::string::npos) return true;
  }
}

void Hdf5Reader::require(const std::string& name) const {
  if (has(name)) return;
  const std::size_t slash = name.rfind('/');
  const std::string parent = slash == 0 || slash == std::string::npos ? "/" : name.substr(0, slash);
  if (parent != "/" && !has(parent)) fail(name, "no such dataset, nor its group " + parent);
  const auto names = members(parent);
  fail(name,
       fmt::format("no such dataset.{} Found here: {}", did_you_mean(name.substr(slash + 1), names), joined(names)));
}

bool Hdf5Reader::is_group(const std::string& name) const {
  if (!has(name)) return false;
  const Hdf5Handle object(H5Oopen(file_, name.c_str(), H5P_DEFAULT), H5Oclose);
  return object >= 0 && H5Iget_type(object) == H5I_GROUP;
}

std::vector<std::string> Hdf5Reader::members(const std::string& group) const {
  Hdf5Handle opened(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (opened < 0 || H5Gget_info(opened, &info) < 0) fail(group, "no such group");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const ssize_t length = H5Lget_name_by_idx(opened, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
    if (length < 0) fail(group, damaged);
    std::string name(static_cast<std::size_t>(length) + 1, '\0');
    H5Lget_name_by_idx(opened, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

std::vector<std::string> Hdf5Reader::members_if(const std::string& group) const {
  if (!has(group)) return {};
  return members(group);
}

std::vector<std::size_t> Hdf5Reader::shape(const std::string& name) const {
  require(name);
  Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) fail(name, "is not a dataset, or its header is damaged");
  Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (H5Sget_simple_extent_type(space) == H5S_NULL) fail(name, "is empty (a null dataset), but values are required");
  if (rank == 0) fail(name, "is a single value, but a list of 1 or 2 dimensions is required");
  if (rank < 0 || rank > 2) fail(name, fmt::format("has {} dimensions, but 1 or 2 are allowed", rank));
  hsize_t extents[2] = {};
  H5Sget_simple_extent_dims(space, extents, nullptr);
  return {extents, extents + rank};
}

// Reads into `values`, which the library converts to; `integers_only` where a fraction would be cut off.
template <typename T>
std::vector<T> Hdf5Reader::read_array(const std::string& name, hid_t memory_type, bool integers_only, std::size_t rows,
                                      std::size_t columns) const {
  const auto extents = shape(name);
  const std::size_t found_rows = extents[0], found_columns = extents.size() < 2 ? 1 : extents[1];
  if ((rows && rows != found_rows) || (columns && columns != found_columns))
    fail(name, fmt::format("has shape {} x {}, but {} x {} is required", found_rows, found_columns,
                           rows ? std::to_string(rows) : "any", columns ? std::to_string(columns) : "any"));
  Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_INTEGER && (integers_only || kind != H5T_FLOAT))
    fail(name, fmt::format("holds {}, but {} are required", words_for(kind), integers_only ? "integers" : "numbers"));
  std::vector<T> values;
  try {
    values.resize(found_rows * found_columns);
  } catch (const std::exception&) {  // bad_alloc or length_error
    fail(name, fmt::format("has shape {} x {}, too large for this machine's memory", found_rows, found_columns));
  }
  if (!values.empty() && H5Dread(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail(name, damaged);
  return values;
}

std::vector<double> Hdf5Reader::doubles_or_gaps(const std::string& name, std::size_t rows, std::size_t columns) const {
  return read_array<double>(name, H5T_NATIVE_DOUBLE, false, rows, columns);
}

std::vector<double> Hdf5Reader::doubles(const std::string& name, std::size_t rows, std::size_t columns) const {
  auto values = doubles_or_gaps(name, rows, columns);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      fail(name, fmt::format("entry {} is {}, but every value must be finite", i, values[i]));
  return values;
}

std::vector<std::int64_t> Hdf5Reader::integers(const std::string& name, std::size_t rows, std::size_t columns) const {
  return read_array<std::int64_t>(name, H5T_NATIVE_INT64, true, rows, columns);
}

std::vector<std::string> Hdf5Reader::texts(const std::string& name) const {
  const auto extents = shape(name);
  if (extents.size() != 1) fail(name, "has 2 dimensions, but a list of texts (1 dimension) is required");
  Hdf5Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING)
    fail(name, fmt::format("holds {}, but fixed-length texts are required", words_for(H5Tget_class(type))));
  if (H5Tis_variable_str(type) > 0)
    fail(name, "holds texts of variable length, but fixed-length texts are required (in h5py: numpy.array([b'...']))");
  const std::size_t length = H5Tget_size(type), count = extents[0];
  std::string packed(length * count, '\0');
  if (count && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()) < 0) fail(name, damaged);
  std::vector<std::string> values;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string value = packed.substr(i * length, length);
    values.push_back(value.substr(0, value.find('\0')));
  }
  return values;
}

bool Hdf5Reader::has_attribute(const std::string& object, const std::string& name) const {
  return has(object) && H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

// An open attribute with one value; the caller closes it.
hid_t Hdf5Reader::single_attribute(const std::string& object, const std::string& name) const {
  if (!has_attribute(object, name)) fail(object, fmt::format("has no attribute '{}'", name));
  const hid_t attribute = H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0) fail(object, fmt::format("attribute '{}' {}", name, damaged));
  Hdf5Handle space(H5Aget_space(attribute), H5Sclose);
  const std::size_t count = count_of(space);
  if (count == 1) return attribute;
  H5Aclose(attribute);
  fail(object, fmt::format("attribute '{}' has {} values, but one is required", name, count));
}

std::string Hdf5Reader::text_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Handle attribute(single_attribute(object, name), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING) fail(object, fmt::format("attribute '{}' is not a text", name));
  std::string value;
  if (H5Tis_variable_str(type) > 0) {
    char* raw = nullptr;
    if (H5Aread(attribute, type, &raw) < 0) fail(object, fmt::format("attribute '{}' {}", name, damaged));
    if (raw) value = raw;
    if (raw) H5free_memory(raw);
    return value;
  }
  value.assign(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, value.data()) < 0) fail(object, fmt::format("attribute '{}' {}", name, damaged));
  return value.substr(0, value.find('\0'));
}

double Hdf5Reader::number_attribute_or_gap(const std::string& object, const std::string& name) const {
  const Hdf5Handle attribute(single_attribute(object, name), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type);
  double value = 0.0;
  if ((kind != H5T_INTEGER && kind != H5T_FLOAT) || H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0)
    fail(object, fmt::format("attribute '{}' is not a number", name));
  return value;
}

double Hdf5Reader::number_attribute(const std::string& object, const std::string& name) const {
  const double value = number_attribute_or_gap(object, name);
  if (!std::isfinite(value))
    fail(object, fmt::format("attribute '{}' is {}, but a finite number is required", name, value));
  return value;
}

}  // namespace tailrun
