#include "fem_stage/mesh/rectangle_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>

#include "common/application.hpp"

namespace tailrun::fem {
namespace {

// A number in (-1, 1) from an index: SplitMix64 (Steele et al. 2014), so that a mesh is the same on every machine.
double scattered(std::uint64_t index) {
  std::uint64_t z = (index + 1) * 0x9E3779B97F4A7C15ull;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1.0p-52 - 1.0;
}

}  // namespace

void write_rectangle_mesh(const RectangleMesh& rectangle, const std::filesystem::path& path) {
  const int columns = rectangle.columns, across = columns + 1;
  struct Level {
    double y, spacing;
    bool between_layers;
  };
  std::vector<Level> levels = {{rectangle.origin[1], 0.0, true}};
  std::vector<std::size_t> layer_of_row;
  for (std::size_t k = 0; k < rectangle.layers.size(); ++k) {
    const RectangleLayer& layer = rectangle.layers[k];
    const double bottom = levels.back().y;
    for (int row = 1; row <= layer.rows; ++row) {
      levels.push_back({bottom + layer.height * row / layer.rows, layer.height / layer.rows, row == layer.rows});
      layer_of_row.push_back(k);
    }
  }
  std::vector<std::string> regions;
  for (const auto& layer : rectangle.layers)
    if (std::find(regions.begin(), regions.end(), layer.region) == regions.end()) regions.push_back(layer.region);
  const int first_region = 5;  // 1 to 4 are the lines
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  text += fmt::format("$PhysicalNames\n{}\n", 4 + regions.size());
  const char* lines[] = {"bottom", "right", "top", "left"};
  for (int i = 0; i < 4; ++i) text += fmt::format("1 {} \"{}\"\n", i + 1, lines[i]);
  for (std::size_t i = 0; i < regions.size(); ++i)
    text += fmt::format("2 {} \"{}\"\n", first_region + static_cast<int>(i), regions[i]);
  text += "$EndPhysicalNames\n";

  const int rows = static_cast<int>(layer_of_row.size());
  const double dx = rectangle.width / columns;
  const auto tag = [&](int i, int j) { return 1 + i + across * j; };
  text += fmt::format("$Nodes\n{}\n", across * (rows + 1));
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const Level& level = levels[static_cast<std::size_t>(j)];
      double x = rectangle.origin[0] + rectangle.width * i / columns, y = level.y;
      const auto index = static_cast<std::uint64_t>(tag(i, j));
      if (i > 0 && i < columns && j > 0 && j < rows) {
        x += rectangle.distortion * dx * scattered(2 * index);
        if (!level.between_layers) y += rectangle.distortion * level.spacing * scattered(2 * index + 1);
      }
      text += fmt::format("{} {:.17g} {:.17g} 0\n", index, x, y);
    }
  text += "$EndNodes\n";

  text += fmt::format("$Elements\n{}\n", 2 * columns + 2 * rows + columns * rows);
  int element = 0;
  const auto edge = [&](int line, int a, int b) {
    text += fmt::format("{} 1 2 {} {} {} {}\n", ++element, line, line, a, b);
  };
  for (int i = 0; i < columns; ++i) edge(1, tag(i, 0), tag(i + 1, 0));
  for (int j = 0; j < rows; ++j) edge(2, tag(columns, j), tag(columns, j + 1));
  for (int i = columns; i > 0; --i) edge(3, tag(i, rows), tag(i - 1, rows));
  for (int j = rows; j > 0; --j) edge(4, tag(0, j), tag(0, j - 1));
  for (int j = 0; j < rows; ++j) {
    const auto& name = rectangle.layers[layer_of_row[static_cast<std::size_t>(j)]].region;
    const int region =
        first_region + static_cast<int>(std::find(regions.begin(), regions.end(), name) - regions.begin());
    for (int i = 0; i < columns; ++i)
      text += fmt::format("{} 3 2 {} {} {} {} {} {}\n", ++element, region, region, tag(i, j), tag(i + 1, j),
                          tag(i + 1, j + 1), tag(i, j + 1));
  }
  text += "$EndElements\n";
  write_text_file(path.string(), text);
}

}  // namespace tailrun::fem
