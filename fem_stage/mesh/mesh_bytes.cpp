#include "fem_stage/mesh/mesh_bytes.hpp"

#include <cstring>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

template <class T>
void put(std::string& out, const std::vector<T>& values) {
  const std::size_t n = values.size();
  out.append(reinterpret_cast<const char*>(&n), sizeof n);
  out.append(reinterpret_cast<const char*>(values.data()), n * sizeof(T));
}

void put(std::string& out, const std::string& text) {
  put(out, std::vector<char>(text.begin(), text.end()));
}

class Bytes {
 public:
  explicit Bytes(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  std::vector<T> take() {
    std::size_t n = 0;
    copy(&n, sizeof n);
    if (n > bytes_.size() / sizeof(T)) throw ComputationError("the mesh came damaged from gmsh's process");
    std::vector<T> values(n);
    copy(values.data(), n * sizeof(T));
    return values;
  }
  std::string text() {
    const auto characters = take<char>();
    return {characters.begin(), characters.end()};
  }
  std::size_t count() { return take<std::size_t>().at(0); }

 private:
  void copy(void* to, std::size_t size) {
    if (size > bytes_.size() - at_) throw ComputationError("the mesh came damaged from gmsh's process");
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::string bytes_of(const Mesh& mesh, const std::vector<std::string>& remarks) {
  std::string out;
  put(out, mesh.position);
  put(out, mesh.quads);
  put(out, mesh.region);
  put(out, std::vector{mesh.region_names.size()});
  for (const auto& name : mesh.region_names) put(out, name);
  put(out, std::vector{mesh.lines.size()});
  for (const auto& [name, edges] : mesh.lines) {
    put(out, name);
    put(out, edges);
  }
  put(out, std::vector{remarks.size()});
  for (const auto& remark : remarks) put(out, remark);
  return out;
}

std::pair<Mesh, std::vector<std::string>> mesh_of_bytes(const std::string& bytes) {
  Bytes in(bytes);
  Mesh mesh;
  mesh.position = in.take<double>();
  mesh.quads = in.take<std::int64_t>();
  mesh.region = in.take<std::int32_t>();
  for (std::size_t i = 0, n = in.count(); i < n; ++i) mesh.region_names.push_back(in.text());
  for (std::size_t i = 0, n = in.count(); i < n; ++i) {
    const std::string name = in.text();
    mesh.lines[name] = in.take<std::array<std::int64_t, 2>>();
  }
  std::vector<std::string> remarks;
  for (std::size_t i = 0, n = in.count(); i < n; ++i) remarks.push_back(in.text());
  return {std::move(mesh), std::move(remarks)};
}

}  // namespace tailrun::fem
