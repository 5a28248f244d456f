// Meshes of other makes: read right, or refused for the right reason. Each kind had been read wrong in silence, refused
// for another reason, or had crashed.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "fem_stage/mesh/gmsh_mesh.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

struct Node {
  long long tag;
  double x, y, z;
};
struct Element {
  int type, group, entity;
  std::vector<long long> nodes;
};

// 4 x 4 quadrilaterals of 1 m, lines bottom, right, top, left (groups 1 to 4), region "s" (group 5).
struct Square {
  std::vector<Node> nodes;
  std::vector<Element> elements;
  std::string more;  // of each element's tags

  Square() {
    const auto tag = [](int i, int j) { return static_cast<long long>(1 + i + 5 * j); };
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) nodes.push_back({tag(i, j), 1.0 * i, 1.0 * j, 0.0});
    for (int i = 0; i < 4; ++i) {
      elements.push_back({1, 1, 1, {tag(i, 0), tag(i + 1, 0)}});
      elements.push_back({1, 2, 2, {tag(4, i), tag(4, i + 1)}});
      elements.push_back({1, 3, 3, {tag(i, 4), tag(i + 1, 4)}});
      elements.push_back({1, 4, 4, {tag(0, i), tag(0, i + 1)}});
    }
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        elements.push_back({3, 5, 5, {tag(i, j), tag(i + 1, j), tag(i + 1, j + 1), tag(i, j + 1)}});
  }
  std::string text(std::size_t promised_nodes = 0) const {
    std::string out =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n"
        "1 4 \"left\"\n2 5 \"s\"\n2 6 \"other\"\n$EndPhysicalNames\n";
    out += fmt::format("$Nodes\n{}\n", promised_nodes ? promised_nodes : nodes.size());
    for (const auto& n : nodes) out += fmt::format("{} {} {} {}\n", n.tag, n.x, n.y, n.z);
    out += fmt::format("$EndNodes\n$Elements\n{}\n", elements.size());
    int number = 0;
    for (const auto& e : elements) {
      out += fmt::format("{} {} {} {} {}{}", ++number, e.type, more.empty() ? 2 : 4, e.group, e.entity, more);
      for (const auto n : e.nodes) out += fmt::format(" {}", n);
      out += "\n";
    }
    return out + "$EndElements\n";
  }
};

Mesh read(const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_foreign_mesh.msh";
  std::ofstream(path, std::ios::binary) << text;
  return read_gmsh(path);
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool says(const std::string& text, const std::string& words) {
  const bool found = text.find(words) != std::string::npos;
  CHECK_MESSAGE(found, text);
  return found;
}

}  // namespace

TEST_CASE("format 2: an edge in several groups counts once in each") {
  Square square;
  const auto lines = square.elements;
  for (const auto& e : lines)
    if (e.type == 1) square.elements.push_back({1, 7, e.entity, e.nodes});  // all of them in an unnamed outline, too
  for (const auto& e : lines)
    if (e.type == 1 && e.group == 3) square.elements.push_back({1, 3, 3, {e.nodes[1], e.nodes[0]}});  // and once more
  const Mesh mesh = read(square.text());
  CHECK(mesh.elements() == 16);
  for (const char* name : {"bottom", "right", "top", "left"}) CHECK(mesh.lines.at(name).size() == 4);
  CHECK(mesh.lines.at("curve_7").size() == 16);
}

TEST_CASE("format 2: groups are those of the elements, whatever the entities are") {
  for (const int entity : {0, 1}) {
    Square square;
    for (auto& e : square.elements) e.entity = entity;
    for (auto& e : square.elements)
      if (e.type == 3 && e.nodes[0] > 10) e.group = 6;
    const Mesh mesh = read(square.text());
    for (const char* name : {"bottom", "right", "top", "left"}) {
      REQUIRE(mesh.lines.contains(name));
      CHECK(mesh.lines.at(name).size() == 4);
    }
    for (const auto node : mesh.nodes_of_line("top")) CHECK(mesh.y(static_cast<std::size_t>(node)) == 4.0);
    REQUIRE(mesh.region_names.size() == 2);
    for (std::size_t e = 0; e < 16; ++e)
      CHECK(mesh.region_names[static_cast<std::size_t>(mesh.region[e])] == (mesh.centre(e)[1] > 2.0 ? "other" : "s"));
  }
}

TEST_CASE("elements that are there twice, or in two regions") {
  Square twice, regions;
  for (std::size_t i = 0; i < 32; ++i)
    if (const auto e = Square().elements[i]; e.type == 3) {
      twice.elements.push_back(e);
      regions.elements.push_back({3, 6, 5, e.nodes});
    }
  says(refusal(twice.text()), "is there twice");
  says(refusal(regions.text()), "in 2 physical surfaces");
}

TEST_CASE("the plane: x-z, y-z and sheets that are not plane say so; another level of z does not matter") {
  Square xz, yz, bent, tilted, level, clockwise;
  for (auto& n : xz.nodes) std::swap(n.y, n.z);
  for (auto& n : yz.nodes) n = {n.tag, 0.0, n.x, n.y};
  for (auto& n : bent.nodes) n.z = 0.1 * n.x * n.y;
  for (auto& n : tilted.nodes) n.z = 0.01 * n.x;
  for (auto& n : level.nodes) n.z = 7.0;
  for (auto& e : clockwise.elements) std::reverse(e.nodes.begin(), e.nodes.end());
  says(refusal(xz.text()), "lies in the x-z plane");
  says(refusal(yz.text()), "lies in the y-z plane");
  says(refusal(bent.text()), "not plane");
  says(refusal(tilted.text()), "not plane");
  CHECK(read(level.text()).elements() == 16);
  const Mesh turned = read(clockwise.text());
  for (const double jacobian : scaled_jacobians(turned, {})) CHECK(jacobian == 1.0);
}

TEST_CASE("second order names the order") {
  Square square;
  long long tag = 100;
  for (auto& e : square.elements) {
    e.type = e.type == 1 ? 8 : 10;
    const std::size_t more = e.type == 8 ? 1 : 5;
    for (std::size_t k = 0; k < more; ++k) {
      square.nodes.push_back({++tag, 0.5, 0.5, 0.0});
      e.nodes.push_back(tag);
    }
  }
  says(refusal(square.text()), "Mesh.ElementOrder = 1");
}

TEST_CASE("node tags: large ones are read, those beyond 2^31 refused") {
  for (const long long add : {2000000000LL, 3000000000LL, 1LL << 40}) {
    Square square;
    for (auto& n : square.nodes) n.tag += add;
    for (auto& e : square.elements)
      for (auto& n : e.nodes) n += add;
    if (add < (1LL << 31))
      CHECK(read(square.text()).nodes() == 25);
    else
      says(refusal(square.text()), "renumber the nodes");
  }
}

TEST_CASE("counts that lie and files that are cut, with the line") {
  const std::string sound = Square().text();
  says(refusal(Square().text(20)), "more follows");
  says(refusal(Square().text(30)), "ends before");
  says(refusal(Square().text(1000000000)), "too short for more than");
  says(refusal(sound.substr(0, sound.size() / 2)), "is missing: the file is cut short");
  says(refusal("SystemCall \"echo a geometry\";\n"), "this is no gmsh mesh");
  says(refusal(""), "empty");
  Square nan = Square(), unknown = Square();
  unknown.elements.back().nodes[0] = 77;
  says(refusal(unknown.text()), "node 77, which $Nodes does not have");
  std::string text = nan.text();
  text.replace(text.find("\n1 0 0 0\n"), 9, "\n1 nan 0 0\n");
  says(refusal(text), "a coordinate is required");
  const std::string four =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n2 1 0 {}\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 "
      "0\n0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n2 1 3 {}\n1 1 2 3 4\n$EndElements\n";
  for (const auto& [nodes, elements] :
       {std::pair{"1000000000", "1"}, std::pair{"-5", "1"}, std::pair{"4", "1000000000"},
        std::pair{"4", "9223372036854775807"}, std::pair{"4", "-5"}, std::pair{"3", "1"}, std::pair{"4", "0"}})
    says(refusal(fmt::format(fmt::runtime(four), nodes, elements)), "line ");
}

TEST_CASE("partitions: the whole is read, a part is refused for being one") {
  Square whole, part;
  whole.more = " 1 1";
  CHECK(read(whole.text()).elements() == 16);
  part.more = " 1 1";
  std::erase_if(part.elements, [](const Element& e) { return e.type == 3 ? (e.nodes[0] - 1) % 5 >= 2 : e.group == 2; });
  says(refusal(part.text()), "cut into partitions");
}

TEST_CASE("line elements with nodes of their own are not lost in silence") {
  Square square;
  for (int i = 0; i < 5; ++i) square.nodes.push_back({100 + i, 1.0 * i, 4.0, 0.0});
  for (auto& e : square.elements)
    if (e.type == 1 && e.group == 3)
      for (auto& n : e.nodes) n += 79;  // 21 to 25 are the top
  forget_warnings();
  says(refusal(square.text()), "belongs to no physical curve");
  CHECK(!warnings().empty());
  forget_warnings();
}
