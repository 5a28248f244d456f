#include "common/hdf5_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/claimed_sizes.hpp"
#include "common/error.hpp"

namespace tailrun {
namespace {

// Owns any HDF5 identifier; `close` is the library's function for its kind.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void silence_library() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw ComputationError("HDF5: cannot " + what);
}

Handle fixed_text_type(std::size_t length) {
  const hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  return Handle(type, H5Tclose);
}

void write_attribute(hid_t object, const std::string& name, hid_t type, hid_t space, const void* data) {
  if (H5Aexists(object, name.c_str()) > 0) H5Adelete(object, name.c_str());
  Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (attribute < 0) throw ComputationError("HDF5: cannot make attribute " + name);
  check(H5Awrite(attribute, type, data), "write attribute " + name);
}

// Attribute texts are fixed-length ASCII: VTKHDF demands it for `Type`, and every reader understands it.
void write_text_attribute(hid_t object, const std::string& name, const std::string& value) {
  const Handle type = fixed_text_type(value.size());
  Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(object, name, type, space, value.c_str());
}

template <typename T>
hid_t native_type();
template <>
hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t native_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
hid_t native_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

template <typename T>
void write_array(hid_t file, const std::string& name, std::span<const T> values, std::size_t columns,
                 const std::string& unit, const std::string& description) {
  if (columns && values.size() % columns) throw std::logic_error(name + ": length is not a multiple of its columns");
  const hsize_t shape[2] = {columns ? values.size() / columns : values.size(), columns};
  const int rank = columns ? 2 : 1;
  Handle space(H5Screate_simple(rank, shape, nullptr), H5Sclose);
  Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(link, 1);
  Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (values.size() > 4096) {
    const hsize_t chunk[2] = {std::min<hsize_t>(shape[0], 16384), columns ? columns : 1};
    H5Pset_chunk(create, rank, chunk);
    H5Pset_shuffle(create);
    H5Pset_deflate(create, 1);
  }
  Handle dataset(H5Dcreate2(file, name.c_str(), native_type<T>(), space, link, create, H5P_DEFAULT), H5Dclose);
  if (dataset < 0) throw ComputationError("HDF5: cannot make dataset " + name);
  if (!values.empty())
    check(H5Dwrite(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "write " + name);
  write_text_attribute(dataset, "unit", unit);
  write_text_attribute(dataset, "description", description);
}

std::string read_text(hid_t type, hid_t attribute) {
  if (H5Tis_variable_str(type) > 0) {
    char* raw = nullptr;
    if (H5Aread(attribute, type, &raw) < 0 || !raw) return {};
    std::string value(raw);
    H5free_memory(raw);
    return value;
  }
  std::string value(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, value.data()) < 0) return {};
  return value.substr(0, value.find('\0'));
}

}  // namespace

Hdf5Writer::Hdf5Writer(const std::filesystem::path& path) : final_(path), temporary_(path) {
  silence_library();
  temporary_ += ".part";
  if (!path.parent_path().empty()) std::filesystem::create_directories(path.parent_path());
  file_ = H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  if (file_ < 0) throw ComputationError(fmt::format("{}: cannot be written", temporary_.string()));
}

Hdf5Writer::~Hdf5Writer() {
  if (file_ < 0) return;
  H5Fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void Hdf5Writer::group(const std::string& name) {
  if (H5Lexists(file_, name.c_str(), H5P_DEFAULT) > 0) return;
  Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(link, 1);
  Handle made(H5Gcreate2(file_, name.c_str(), link, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  if (made < 0) throw ComputationError("HDF5: cannot make group " + name);
}

void Hdf5Writer::write(const std::string& name, std::span<const double> values, std::size_t columns,
                       const std::string& unit, const std::string& description) {
  write_array(file_, name, values, columns, unit, description);
}
void Hdf5Writer::write(const std::string& name, std::span<const std::int64_t> values, std::size_t columns,
                       const std::string& unit, const std::string& description) {
  write_array(file_, name, values, columns, unit, description);
}
void Hdf5Writer::write(const std::string& name, std::span<const std::int32_t> values, std::size_t columns,
                       const std::string& unit, const std::string& description) {
  write_array(file_, name, values, columns, unit, description);
}
void Hdf5Writer::write(const std::string& name, std::span<const std::uint8_t> values, const std::string& unit,
                       const std::string& description) {
  write_array(file_, name, values, 0, unit, description);
}

void Hdf5Writer::write_texts(const std::string& name, const std::vector<std::string>& values,
                             const std::string& description) {
  std::size_t length = 1;
  for (const auto& value : values) length = std::max(length, value.size());
  std::string packed(length * values.size(), '\0');
  for (std::size_t i = 0; i < values.size(); ++i) packed.replace(i * length, values[i].size(), values[i]);
  const Handle type = fixed_text_type(length);
  const hsize_t shape[1] = {values.size()};
  Handle space(H5Screate_simple(1, shape, nullptr), H5Sclose);
  Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(link, 1);
  Handle dataset(H5Dcreate2(file_, name.c_str(), type, space, link, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  if (dataset < 0) throw ComputationError("HDF5: cannot make dataset " + name);
  if (!values.empty()) check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()), "write " + name);
  write_text_attribute(dataset, "unit", "1");
  write_text_attribute(dataset, "description", description);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, const std::string& value) {
  Handle target(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose);
  write_text_attribute(target, name, value);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, double value) {
  Handle target(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose);
  Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(target, name, H5T_NATIVE_DOUBLE, space, &value);
}

void Hdf5Writer::attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values) {
  Handle target(H5Oopen(file_, object.c_str(), H5P_DEFAULT), H5Oclose);
  const hsize_t shape[1] = {values.size()};
  Handle space(H5Screate_simple(1, shape, nullptr), H5Sclose);
  write_attribute(target, name, H5T_NATIVE_INT64, space, values.data());
}

void Hdf5Writer::commit() {
  check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "flush " + temporary_.string());
  check(H5Fclose(file_), "close " + temporary_.string());
  file_ = -1;
  std::filesystem::rename(temporary_, final_);
}

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path) : path_(path) {
  silence_library();
  if (!std::filesystem::exists(path)) throw InputError(fmt::format("{}: no such file", path.string()));
  if (H5Fis_hdf5(path.c_str()) <= 0) throw InputError(fmt::format("{}: not an HDF5 file, or cut short", path.string()));
  file_ = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file_ < 0)
    throw InputError(
        fmt::format("{}: cannot be opened as HDF5; it is truncated, damaged or still being written. Make it again.",
                    path.string()));
  try {
    check_claimed_sizes(file_, path_);
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

std::vector<std::string> Hdf5Reader::members(const std::string& group) const {
  Handle opened(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (opened < 0 || H5Gget_info(opened, &info) < 0) fail(group, "no such group");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    char name[1024];
    if (H5Lget_name_by_idx(opened, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT) >= 0)
      names.emplace_back(name);
  }
  return names;
}

std::vector<std::size_t> Hdf5Reader::shape(const std::string& name) const {
  require(name);
  Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) fail(name, "is not a dataset");
  Handle space(H5Dget_space(dataset), H5Sclose);
  hsize_t extents[8] = {};
  const int rank = H5Sget_simple_extent_dims(space, extents, nullptr);
  if (rank < 0) fail(name, "has no simple shape");
  return {extents, extents + rank};
}

namespace {

template <typename T>
std::vector<T> read_array(const Hdf5Reader& reader, hid_t file, const std::string& name, std::size_t rows,
                          std::size_t columns) {
  const auto shape = reader.shape(name);
  if (shape.size() > 2) reader.fail(name, fmt::format("has {} dimensions, but at most 2 are expected", shape.size()));
  const std::size_t found_rows = shape.empty() ? 1 : shape[0];
  const std::size_t found_columns = shape.size() < 2 ? 1 : shape[1];
  if ((rows && rows != found_rows) || (columns && columns != found_columns))
    reader.fail(name, fmt::format("has shape {} x {}, but {} x {} is required", found_rows, found_columns,
                                  rows ? std::to_string(rows) : "any", columns ? std::to_string(columns) : "any"));
  std::vector<T> values;
  try {
    values.resize(found_rows * found_columns);
  } catch (const std::exception&) {  // bad_alloc or length_error
    reader.fail(name, fmt::format("has shape {} x {}, too large for this machine's memory", found_rows, found_columns));
  }
  Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!values.empty() && H5Dread(dataset, native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    reader.fail(name, "cannot be read; the file is truncated or damaged, or the data are not numbers");
  return values;
}

}  // namespace

std::vector<double> Hdf5Reader::doubles(const std::string& name, std::size_t rows, std::size_t columns) const {
  return read_array<double>(*this, file_, name, rows, columns);
}

std::vector<std::int64_t> Hdf5Reader::integers(const std::string& name, std::size_t rows, std::size_t columns) const {
  return read_array<std::int64_t>(*this, file_, name, rows, columns);
}

std::vector<std::string> Hdf5Reader::texts(const std::string& name) const {
  const auto extents = shape(name);
  Handle dataset(H5Dopen2(file_, name.c_str(), H5P_DEFAULT), H5Dclose);
  Handle type(H5Dget_type(dataset), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    fail(name, "is not a list of fixed-length texts");
  const std::size_t length = H5Tget_size(type);
  const std::size_t count = extents.empty() ? 1 : extents[0];
  std::string packed(length * count, '\0');
  if (count && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()) < 0)
    fail(name, "cannot be read; the file is truncated or damaged");
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

std::string Hdf5Reader::text_attribute(const std::string& object, const std::string& name) const {
  if (!has_attribute(object, name)) fail(object, fmt::format("has no attribute '{}'", name));
  Handle attribute(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  Handle type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING) fail(object, fmt::format("attribute '{}' is not a text", name));
  return read_text(type, attribute);
}

double Hdf5Reader::number_attribute(const std::string& object, const std::string& name) const {
  if (!has_attribute(object, name)) fail(object, fmt::format("has no attribute '{}'", name));
  Handle attribute(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  double value = 0.0;
  if (H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0)
    fail(object, fmt::format("attribute '{}' is not a number", name));
  return value;
}

}  // namespace tailrun
