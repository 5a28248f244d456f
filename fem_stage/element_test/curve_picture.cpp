#include "fem_stage/element_test/curve_picture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tailrun::fem {

namespace {

constexpr double chart_width = 520.0, height = 400.0;
constexpr double left = 70.0, right = 20.0, top = 40.0, bottom = 60.0;
constexpr std::array<const char*, 5> colours{"#0b5fa5", "#c8501e", "#2f8f4e", "#7d4b9e", "#444444"};

struct Axis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  double share(double value) const {
    if (logarithmic) return std::log(value / low) / std::log(high / low);
    return (value - low) / (high - low);
  }
};

Axis axis_of(const CurvePicture& chart, bool is_x) {
  Axis axis;
  axis.logarithmic = is_x && chart.log_x;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Curve& curve : chart.curves) {
    for (const auto& [x, y] : curve.points) {
      const double value = is_x ? x : y;
      if (!std::isfinite(value) || (axis.logarithmic && value <= 0.0)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  if (!(high >= low)) low = 0.0, high = 1.0;
  if (axis.logarithmic) {
    axis.low = std::pow(10.0, std::floor(std::log10(low)));
    axis.high = std::pow(10.0, std::ceil(std::log10(high) + 1e-9));
  } else {
    axis.low = std::min(0.0, low);
    axis.high = high > axis.low ? high + 0.05 * (high - axis.low) : axis.low + 1.0;
  }
  return axis;
}

std::vector<double> ticks_of(const Axis& axis) {
  std::vector<double> ticks;
  if (axis.logarithmic) {
    for (double t = axis.low; t <= axis.high * 1.0001; t *= 10.0) ticks.push_back(t);
    return ticks;
  }
  const double rough = (axis.high - axis.low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double step = power * (rough / power < 1.5   ? 1.0
                               : rough / power < 3.5 ? 2.0
                               : rough / power < 7.5 ? 5.0
                                                     : 10.0);
  for (double t = std::ceil(axis.low / step) * step; t <= axis.high; t += step) ticks.push_back(t);
  return ticks;
}

std::string chart_svg(const CurvePicture& chart, double origin) {
  const Axis x_axis = axis_of(chart, true), y_axis = axis_of(chart, false);
  const double width = chart_width - left - right, depth = height - top - bottom;
  const auto px = [&](double x) { return origin + left + width * x_axis.share(x); };
  const auto py = [&](double y) { return top + depth * (1.0 - y_axis.share(y)); };
  std::string svg = fmt::format(
      "<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='none' stroke='#666'/>\n"
      "<text x='{:.1f}' y='24' text-anchor='middle' font-size='15'>{}</text>\n",
      origin + left, top, width, depth, origin + left + 0.5 * width, chart.title);
  for (const double t : ticks_of(x_axis)) {
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1:.1f}' y2='{2:.1f}' stroke='#ddd'/>"
        "<text x='{0:.1f}' y='{3:.1f}' text-anchor='middle'>{4:g}</text>\n",
        px(t), top, top + depth, top + depth + 18.0, t);
  }
  for (const double t : ticks_of(y_axis)) {
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{1:.1f}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/>"
        "<text x='{3:.1f}' y='{4:.1f}' text-anchor='end'>{5:g}</text>\n",
        origin + left, origin + left + width, py(t), origin + left - 6.0, py(t) + 4.0, t);
  }
  svg += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{}</text>\n", origin + left + 0.5 * width,
                     height - 18.0, chart.x_label);
  svg += fmt::format(
      "<text x='{0:.1f}' y='{1:.1f}' text-anchor='middle' transform='rotate(-90 {0:.1f} {1:.1f})'>{2}</text>\n",
      origin + 16.0, top + 0.5 * depth, chart.y_label);
  double legend = top + 18.0;
  for (std::size_t k = 0; k < chart.curves.size(); ++k) {
    const Curve& curve = chart.curves[k];
    const char* colour = colours[k % colours.size()];
    std::string line;
    for (const auto& [x, y] : curve.points) {
      if (!std::isfinite(x) || !std::isfinite(y) || (x_axis.logarithmic && x <= 0.0)) continue;
      svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{}' fill='{}'/>", px(x), py(y), curve.markers_only ? 5 : 2,
                         colour);
      line += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
    }
    if (!curve.markers_only)
      svg += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-width='2'/>", line, colour);
    svg += fmt::format("\n<text x='{:.1f}' y='{:.1f}' text-anchor='end' fill='{}'>{}</text>\n",
                       origin + left + width - 8.0, legend, colour, curve.label);
    legend += 16.0;
  }
  return svg;
}

}  // namespace

std::string svg_of(const std::vector<CurvePicture>& charts) {
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
      "font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' fill='white'/>\n",
      chart_width * static_cast<double>(charts.size()), height);
  for (std::size_t k = 0; k < charts.size(); ++k) svg += chart_svg(charts[k], chart_width * static_cast<double>(k));
  return svg + "</svg>\n";
}

}  // namespace tailrun::fem
