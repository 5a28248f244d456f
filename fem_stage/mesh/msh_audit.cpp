#include "fem_stage/mesh/msh_audit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>

#include "common/error.hpp"

namespace tailrun::fem {
namespace {

constexpr std::int64_t largest_tag = std::numeric_limits<std::int32_t>::max();
constexpr int line_type = 1, quadrilateral_type = 3;

// Nodes by gmsh's number of the element type; 0 where it is not one that a plane mesh can have.
int nodes_of_type(std::int64_t type) {
  constexpr int nodes[] = {0, 2, 3,  4,  4,  8, 6,  5,  3,  6,  9,  10, 27, 18, 14,
                           1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4,  5,  6,  20};
  return type > 0 && type < static_cast<std::int64_t>(std::size(nodes)) ? nodes[type] : 0;
}

// The words of one file, with the line for messages.
class Reader {
 public:
  Reader(const std::string& source, std::string_view text) : source_(source), text_(text) {}

  bool at_end() {
    skip_blanks();
    return at_ >= end();
  }
  std::string_view word() {
    skip_blanks();
    const std::size_t start = at_;
    while (at_ < end() && !blank(text_[at_])) ++at_;
    return text_.substr(start, at_ - start);
  }
  std::string_view rest_of_line() {
    const std::size_t start = at_;
    while (at_ < end() && text_[at_] != '\n') ++at_;
    return text_.substr(start, at_ - start);
  }
  std::int64_t integer(const char* what) {
    const auto w = word();
    std::int64_t value = 0;
    const auto result = std::from_chars(w.data(), w.data() + w.size(), value);
    if (w.empty()) fail(fmt::format("{} is missing: the section ends before what it announces", what));
    if (result.ec != std::errc() || result.ptr != w.data() + w.size())
      fail(fmt::format("found '{}', but {} (an integer) is required", std::string(w.substr(0, 40)), what));
    return value;
  }
  void coordinate() {
    const auto w = word();
    double value = 0.0;
    const auto* first = w.data() + (!w.empty() && w[0] == '+');
    const auto result = std::from_chars(first, w.data() + w.size(), value);
    if (w.empty()) fail("a coordinate is missing: the section ends before what it announces");
    const bool tiny = result.ec == std::errc::result_out_of_range && (w.find("e-") != w.npos || w.find("E-") != w.npos);
    if (result.ptr != w.data() + w.size() || (result.ec != std::errc() && !tiny) || !std::isfinite(value))
      fail(fmt::format("found '{}', but a coordinate is required", std::string(w.substr(0, 40))));
  }
  // A count that can be true: not negative, and no more than the section has bytes for.
  std::int64_t count(const char* what, std::int64_t most) {
    const std::int64_t n = integer(what);
    if (n < 0) fail(fmt::format("{} is {}, but a count cannot be negative", what, n));
    const auto room = static_cast<std::int64_t>((end() - at_) / 2 + 1);  // a digit and a blank each
    if (n > most) fail(fmt::format("{} is {}, but the section's head announces only {} more", what, n, most));
    if (n > room) fail(fmt::format("{} is {}, but the section is too short for more than {}", what, n, room));
    return n;
  }
  void limit(std::size_t section_end) { end_ = section_end; }
  void go_to(std::size_t offset) { at_ = offset; }
  std::size_t at() const { return at_; }
  [[noreturn]] void fail(const std::string& message) const {
    const auto line =
        1 + std::count(text_.begin(), text_.begin() + static_cast<long>(std::min(at_, text_.size())), '\n');
    throw InputError(
        fmt::format("{}: line {}: {}{}", source_, line, section.empty() ? "" : "$" + section + ": ", message));
  }
  std::string section;

 private:
  static bool blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  std::size_t end() const { return std::min(end_, text_.size()); }
  void skip_blanks() {
    while (at_ < end() && blank(text_[at_])) ++at_;
  }

  std::string source_;
  std::string_view text_;
  std::size_t at_ = 0, end_ = std::string_view::npos;
};

class Audit {
 public:
  Audit(Reader& reader, double version) : in_(reader), two_(version < 3.0), four_zero_(!two_ && version < 4.05) {}

  void nodes() {
    if (two_) {
      const auto n = in_.count("the number of nodes", largest_tag);
      for (std::int64_t i = 0; i < n; ++i) {
        node_tag();
        for (int k = 0; k < 3; ++k) in_.coordinate();
      }
    } else {
      blocks("nodes", [&](std::int64_t dimension, std::int64_t parametric, std::int64_t n) {
        const auto coordinates = 3 + (parametric != 0 ? dimension : 0);
        for (std::int64_t i = 0; i < n; ++i) {
          node_tag();
          if (four_zero_)
            for (std::int64_t k = 0; k < coordinates; ++k) in_.coordinate();
        }
        if (!four_zero_)
          for (std::int64_t k = 0; k < n * coordinates; ++k) in_.coordinate();
      });
    }
    end_of_section();
  }

  void elements() {
    if (two_) {
      const auto n = in_.count("the number of elements", largest_tag);
      for (std::int64_t i = 0; i < n; ++i) element_of_version_2();
      groups.known = true;
    } else {
      blocks("elements", [&](std::int64_t, std::int64_t type, std::int64_t n) {
        const int nodes = nodes_of_type(type);
        if (nodes == 0) unknown_type(type);
        for (std::int64_t i = 0; i < n; ++i) {
          in_.integer("the tag of an element");
          for (int k = 0; k < nodes; ++k) element_node();
        }
      });
    }
    end_of_section();
  }

  MshGroups groups;

 private:
  // Entity blocks of version 4: head of the section, then for each block a head of four numbers.
  template <class Rows>
  void blocks(const char* what, Rows rows) {
    const auto count = in_.count("the number of blocks", largest_tag);
    const std::string in_all = fmt::format("the number of {}", what), in_block = in_all + " of a block";
    std::int64_t left = in_.count(in_all.c_str(), largest_tag);
    if (!four_zero_) {
      in_.integer("the smallest tag");
      in_.integer("the largest tag");
    }
    for (std::int64_t b = 0; b < count; ++b) {
      const auto first = in_.integer("an entity"), second = in_.integer("an entity");
      const auto dimension = four_zero_ ? second : first;
      if (dimension < 0 || dimension > 3) in_.fail(fmt::format("found dimension {} of an entity", dimension));
      const auto kind = in_.integer("the type of a block");
      const auto n = in_.count(in_block.c_str(), left);
      left -= n;
      rows(dimension, kind, n);
    }
    if (left != 0) in_.fail(fmt::format("the head announces {} more {} than the blocks have", left, what));
  }

  void node_tag() {
    const auto tag = in_.integer("the tag of a node");
    if (tag <= 0 || tag > largest_tag)
      in_.fail(fmt::format("node tag {}: allowed are 1 to {}; renumber the nodes", tag, largest_tag));
    if (!tags_.insert(tag).second) in_.fail(fmt::format("node {} is there twice", tag));
  }
  std::int64_t element_node() {
    const auto tag = in_.integer("a node of an element");
    if (!tags_.contains(tag)) in_.fail(fmt::format("an element has node {}, which $Nodes does not have", tag));
    return tag;
  }

  void element_of_version_2() {
    in_.integer("the number of an element");
    const auto type = in_.integer("the type of an element");
    const int nodes = nodes_of_type(type);
    if (nodes == 0) unknown_type(type);
    const auto tags = in_.count("the number of tags of an element", 10000);
    std::int64_t group = 0;
    for (std::int64_t k = 0; k < tags; ++k) {
      const auto tag = in_.integer("a tag of an element");
      if (k == 0) group = tag;
      if (k == 3) groups.partitioned = true;  // even of one partition: the file may hold one of several
    }
    std::int64_t node[4] = {};
    for (int k = 0; k < nodes; ++k) {
      const auto tag = element_node();
      if (k < 4) node[k] = tag;
    }
    if (group > largest_tag || group < -largest_tag)  // below 0: the element is turned round in it
      in_.fail(fmt::format("physical group {}: allowed are 1 to {}", group, largest_tag));
    group = std::abs(group);
    if (type == line_type)
      groups.lines[static_cast<int>(group)].insert({std::min(node[0], node[1]), std::max(node[0], node[1])});
    if (type == quadrilateral_type) {
      std::array<std::int64_t, 4> key{node[0], node[1], node[2], node[3]};
      std::sort(key.begin(), key.end());
      groups.quadrilaterals[key].insert(static_cast<int>(group));
    }
  }

  [[noreturn]] void unknown_type(std::int64_t type) const {
    in_.fail(
        fmt::format("elements of gmsh's type {} are of high order or not of a plane mesh; allowed are four-node "
                    "quadrilaterals (type 3), two-node lines and points: set Mesh.ElementOrder = 1 and mesh again",
                    type));
  }

  void end_of_section() {
    if (!in_.at_end()) in_.fail("more follows than the section's head announces");
  }

 private:
  Reader& in_;
  bool two_, four_zero_;
  std::unordered_set<std::int64_t> tags_;
};

}  // namespace

MshGroups audit_msh(const std::filesystem::path& path, const std::string& source) {
  std::ifstream stream(path, std::ios::binary);
  std::error_code ignored;
  if (!stream || !std::filesystem::is_regular_file(path, ignored))
    throw InputError(fmt::format("{}: no such file, or it cannot be read", path.string()));
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);
  Reader in(source, text);
  if (in.at_end()) in.fail("the file is empty");
  if (text[in.at()] != '$')
    in.fail(
        "this is no gmsh mesh (it does not begin with $MeshFormat); a geometry goes to /mesh/geometry, other formats "
        "can be saved as .msh by gmsh");
  double version = 0.0;
  std::size_t parts = 0;
  MshGroups unseen;
  if (const auto at = text.find("\n$PartitionedEntities"); at != std::string::npos) {
    unseen.partitioned = true;
    const auto head = text.find_first_of("\n", at + 1);
    if (std::from_chars(text.data() + std::min(head + 1, text.size()), text.data() + text.size(), unseen.partitions)
            .ec != std::errc())
      unseen.partitions = 0;
  }
  std::optional<Audit> audit;
  while (!in.at_end()) {
    in.section.clear();
    in.limit(std::string::npos);
    const auto head = in.word();
    if (head.empty() || head[0] != '$') continue;  // gmsh passes over what stands between sections
    const std::string name(head.substr(1));
    in.rest_of_line();
    const std::size_t body = in.at(), end = text.find("\n$End" + name, body == 0 ? 0 : body);
    in.section = name;
    if (end == std::string::npos) in.fail(fmt::format("$End{} is missing: the file is cut short", name));
    in.limit(end);
    if (name == "MeshFormat") {
      const auto word = in.word();
      std::from_chars(word.data(), word.data() + word.size(), version);
      if (in.integer("the file type") != 0) return unseen;  // binary
      if (!((version >= 2.0 && version < 3.0) || (version >= 4.0 && version < 4.2))) return unseen;
      audit.emplace(in, version);
    } else if (!audit) {
      return unseen;  // version 1 has no $MeshFormat
    } else if (name == "Nodes") {
      audit->nodes();
      ++parts;
    } else if (name == "Elements") {
      audit->elements();
      ++parts;
    }
    in.limit(std::string::npos);
    in.go_to(end + 1);
    in.rest_of_line();
  }
  if (parts != 2) in.fail("one $Nodes and one $Elements are required");
  audit->groups.partitioned |= unseen.partitioned;
  audit->groups.partitions = unseen.partitions;
  return std::move(audit->groups);
}

}  // namespace tailrun::fem
