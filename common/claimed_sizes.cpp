#include "common/claimed_sizes.hpp"

#include <fmt/format.h>

#include <string>

#include "common/error.hpp"

namespace tailrun {
namespace {

struct Visit {
  double allowed = 0.0;  // bytes
  std::string culprit;   // the first object that claims more
};

bool is_too_large(hid_t space, hid_t type, double allowed) {
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  const double bytes = static_cast<double>(count) * static_cast<double>(H5Tget_size(type));
  H5Sclose(space);
  H5Tclose(type);
  return count < 0 || bytes > allowed;
}

herr_t visit_attribute(hid_t object, const char* name, const H5A_info_t*, void* data) {
  auto& visit = *static_cast<Visit*>(data);
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
  if (attribute < 0) return 0;  // whoever needs it will say so
  if (is_too_large(H5Aget_space(attribute), H5Aget_type(attribute), visit.allowed)) visit.culprit = name;
  H5Aclose(attribute);
  return visit.culprit.empty() ? 0 : 1;
}

herr_t visit_object(hid_t file, const char* name, const H5O_info_t* info, void* data) {
  auto& visit = *static_cast<Visit*>(data);
  const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
  if (object < 0) return 0;
  if (info->type == H5O_TYPE_DATASET && is_too_large(H5Dget_space(object), H5Dget_type(object), visit.allowed))
    visit.culprit = name;
  hsize_t from = 0;
  if (visit.culprit.empty()) H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, &from, visit_attribute, data);
  H5Oclose(object);
  return visit.culprit.empty() ? 0 : 1;
}

}  // namespace

void check_claimed_sizes(hid_t file, const std::filesystem::path& path) {
  std::error_code ignored;
  Visit visit;
  visit.allowed = 1100.0 * static_cast<double>(std::filesystem::file_size(path, ignored)) + 1e6;
  const herr_t walked = H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit_object, &visit, H5O_INFO_BASIC);
  if (walked < 0)
    throw InputError(fmt::format(
        "{}: its groups cannot be walked through; the file is truncated or damaged. Make it again", path.string()));
  if (!visit.culprit.empty())
    throw InputError(fmt::format("{}: '{}' claims more data than the file can hold; the file is damaged. Make it again",
                                 path.string(), visit.culprit));
}

}  // namespace tailrun
