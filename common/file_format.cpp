#include "common/file_format.hpp"

#include <fmt/core.h>

#include "common/error.hpp"
#include "common/hdf5_structure.hpp"
#include "common/log.hpp"

namespace tailrun {

void write_format(Hdf5Writer& file, const std::string& format, int format_version) {
  file.group("/tailrun");
  file.attribute("/tailrun", "format", format);
  file.attribute("/tailrun", "format_version", static_cast<double>(format_version));
}

void check_format(const Hdf5Reader& file, const std::string& format, int format_version) {
  if (!file.has("/tailrun") || !file.has_attribute("/tailrun", "format"))
    throw InputError(fmt::format("{}: not a tailrun file: it has no group /tailrun with the attribute 'format'",
                                 file.path().string()));
  const std::string found = file.text_attribute("/tailrun", "format");
  if (found != format)
    throw InputError(
        fmt::format("{}: is a '{}' file, but a '{}' file is required here", file.path().string(), found, format));
  const double found_version = file.number_attribute("/tailrun", "format_version");
  if (found_version != format_version)
    throw InputError(
        fmt::format("{}: format version {}, but this program reads version {}. Make the file again with this version.",
                    file.path().string(), found_version, format_version));
  if (superblock_version(file.path()) < 2 && file.has_attribute("/tailrun/provenance", "program"))
    log_warn("{}: has no checksums, as files of earlier versions of '{}' have none: damaged values are not noticed",
             file.path().string(), file.text_attribute("/tailrun/provenance", "program"));
}

void check_positive(const Hdf5Reader& file, const std::string& name, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] <= 0.0)
      file.fail(name, fmt::format("entry {} is {:g}, but every value must be positive", i, values[i]));
}

}  // namespace tailrun
