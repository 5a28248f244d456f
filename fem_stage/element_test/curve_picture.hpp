// A line chart as a self-contained SVG file: enough to look at a calibration without another program.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace tailrun::fem {

struct Curve {
  std::string label;
  std::vector<std::pair<double, double>> points;
  bool markers_only = false;
};

struct CurvePicture {
  std::string title, x_label, y_label;
  bool log_x = false;
  std::vector<Curve> curves;
};

// One picture with the charts side by side. Curves without two finite points are drawn as markers or left out.
std::string svg_of(const std::vector<CurvePicture>& charts);

}  // namespace tailrun::fem
