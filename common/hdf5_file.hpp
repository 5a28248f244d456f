// HDF5 access with owned handles. Files are written under a temporary name and take their final name in commit(), so
// that nothing half-written ever carries it. Every dataset has a `unit` and a `description` attribute.
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
  // Throws ComputationError when the file cannot be made.
  explicit Hdf5Writer(const std::filesystem::path& path);
  ~Hdf5Writer();  // an uncommitted file is removed
  Hdf5Writer(const Hdf5Writer&) = delete;
  Hdf5Writer& operator=(const Hdf5Writer&) = delete;

  void group(const std::string& name);  // parents are made as needed
  // Row-major arrays; `columns` 0 makes a vector, otherwise rows x columns. Deflated when large.
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
  std::filesystem::path final_, temporary_;
  hid_t file_ = -1;
};

class Hdf5Reader {
 public:
  // Throws InputError: missing, not HDF5, truncated.
  explicit Hdf5Reader(const std::filesystem::path& path);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  bool has(const std::string& name) const;  // dataset or group
  std::vector<std::string> members(const std::string& group) const;
  std::vector<std::size_t> shape(const std::string& name) const;
  // Any numeric type is converted. `rows` and `columns` are checked unless 0. Throws InputError.
  std::vector<double> doubles(const std::string& name, std::size_t rows = 0, std::size_t columns = 0) const;
  std::vector<std::int64_t> integers(const std::string& name, std::size_t rows = 0, std::size_t columns = 0) const;
  std::vector<std::string> texts(const std::string& name) const;
  bool has_attribute(const std::string& object, const std::string& name) const;
  std::string text_attribute(const std::string& object, const std::string& name) const;
  double number_attribute(const std::string& object, const std::string& name) const;
  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& name, const std::string& message) const;

 private:
  void require(const std::string& name) const;
  std::filesystem::path path_;
  hid_t file_ = -1;
};

}  // namespace tailrun
