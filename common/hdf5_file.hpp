// HDF5 access with owned handles. Files are written under a temporary name and take their final name in commit(), so
// that nothing half-written ever carries it. Every dataset has a `unit` and a `description` attribute.
//
// What is written has checksums throughout (Fletcher32 on values, HDF5 1.10's own on headers and attributes), so that
// one flipped bit is noticed, and no times of day, so that equal runs make equal bytes. What is read need not have
// them: any HDF5 file of the right content will do.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace tailrun {

class Hdf5Writer {
 public:
  // Throws InputError when `path` exists and is no regular file, ComputationError when the file cannot be made.
  explicit Hdf5Writer(const std::filesystem::path& path);
  ~Hdf5Writer();  // an uncommitted file is removed
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  // Whether arrays of doubles are stored in single precision from here on: half the bytes, seven digits. Readers get
  // doubles again.
  void store_singles(bool yes) { singles_ = yes; }
  void group(const std::string& name);  // parents are made as needed
  // Row-major arrays; `columns` 0 makes a vector, otherwise rows x columns. Deflated when large.
  // All of these throw ComputationError, with the system's reason (no space left ...) where there is one.
  void write(const std::string& name, std::span<const double> values, std::size_t columns, const std::string& unit,
             const std::string& description);
  void write(const std::string& name, std::span<const std::int64_t> values, std::size_t columns,
             const std::string& unit, const std::string& description);
  void write(const std::string& name, std::span<const std::int32_t> values, std::size_t columns,
             const std::string& unit, const std::string& description);
  void write(const std::string& name, std::span<const std::uint8_t> values, const std::string& unit,
             const std::string& description);
  void write_texts(const std::string& name, const std::vector<std::string>& values, const std::string& description);
  void attribute(const std::string& object, const std::string& name, const std::string& value);
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values);
  void commit();  // closes, then renames to the final name

 private:
  void make_parents(const std::string& name);
  std::filesystem::path final_, temporary_;
  hid_t file_ = -1;
  bool committed_ = false, singles_ = false;
};

class Hdf5Reader {
 public:
  // Throws InputError: missing, not HDF5, truncated, damaged, or of a structure that is refused (hdf5_structure.hpp).
  explicit Hdf5Reader(const std::filesystem::path& path);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  bool has(const std::string& name) const;  // dataset or group
  bool is_group(const std::string& name) const;
  std::vector<std::string> members(const std::string& group) const;     // of a group that must be there
  std::vector<std::string> members_if(const std::string& group) const;  // none when there is no such group
  std::vector<std::size_t> shape(const std::string& name) const;        // 1 or 2 extents; anything else is refused
  // Any numeric type is converted, of integers any that is one; values are finite. `rows` and `columns` are checked
  // unless 0. Throws InputError with file and dataset.
  std::vector<double> doubles(const std::string& name, std::size_t rows = 0, std::size_t columns = 0) const;
  std::vector<std::int64_t> integers(const std::string& name, std::size_t rows = 0, std::size_t columns = 0) const;
  // As doubles(), for the few datasets in which NaN says that there is no value.
  std::vector<double> doubles_or_gaps(const std::string& name, std::size_t rows = 0, std::size_t columns = 0) const;
  std::vector<std::string> texts(const std::string& name) const;
  bool has_attribute(const std::string& object, const std::string& name) const;
  // Attributes have one value; a number is finite. Throws InputError.
  std::string text_attribute(const std::string& object, const std::string& name) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  double number_attribute_or_gap(const std::string& object, const std::string& name) const;
  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& name, const std::string& message) const;

 private:
  void require(const std::string& name) const;
  hid_t single_attribute(const std::string& object, const std::string& name) const;
  template <typename T>
  std::vector<T> read_array(const std::string& name, hid_t memory_type, bool integers_only, std::size_t rows,
                            std::size_t columns) const;
  std::filesystem::path path_;
  hid_t file_ = -1;
};

}  // namespace tailrun
