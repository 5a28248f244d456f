#include "common/hdf5_handle.hpp"

#include <string_view>

namespace tailrun {
namespace {

herr_t find_reason(unsigned, const H5E_error2_t* entry, void* data) {
  constexpr std::string_view before = "error message = '";
  const std::string_view text = entry->desc ? entry->desc : "";
  const std::size_t start = text.find(before);
  if (start == std::string_view::npos) return 0;
  const std::string_view rest = text.substr(start + before.size());
  *static_cast<std::string*>(data) = ": " + std::string(rest.substr(0, rest.find('\'')));
  return 1;
}

}  // namespace

void silence_hdf5() {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string reason_of_system() {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_reason, &reason);
  return reason;
}

hid_t access_without_locks() {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_file_locking(access, /*use_file_locking=*/false, /*ignore_when_disabled=*/true);
  return access;
}

}  // namespace tailrun
