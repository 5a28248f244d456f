// When the shaking's summary advises to hand over.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "fem_stage/stage/transfer_window.hpp"

using namespace tailrun;
using namespace tailrun::fem;

namespace {

// 40 s at 1 m/s2 and then 40 s of nothing: 75 % of the Arias intensity has come at 30 s.
Motion even_motion() {
  Motion motion{.name = "even", .time_step = 0.1, .acceleration = std::vector<double>(401, 1.0), .velocity = {}};
  motion.acceleration.resize(801, 0.0);
  return motion;
}

// Mean r_u rises to `level` at `until` (s), with a swing of 0.05 twice a second; each element keeps all of its Jacobian
// until `worn_from`, and loses a tenth a second then.
std::vector<QualityRow> rows_of(double end, double until, double level, double worn_from) {
  std::vector<QualityRow> rows;
  for (int k = 0; k <= static_cast<int>(end * 50.0); ++k) {
    QualityRow row{};
    row.time = k / 50.0;
    row.smallest_jacobian = 0.1;  // a corner of the geometry
    row.jacobian_kept = std::min(1.0, 1.0 - 0.1 * (row.time - worn_from));
    row.mean_ratio = level * std::min(1.0, row.time / until) + 0.05 * std::sin(4.0 * std::numbers::pi * row.time);
    row.liquefied_depth = row.mean_ratio > 0.3 ? 10.0 + std::fmod(7.0 * k, 4.0) : 0.0;  // counts, and jumps
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("transfer window: opens when pore pressure has levelled off, if strong shaking is over by then") {
  const auto window = find_transfer_window(rows_of(60.0, 40.0, 0.8, 100.0), even_motion());
  // 95 % of the level at 38 s, and half of the second that is averaged over.
  CHECK(window.opens.value() == doctest::Approx(38.5).epsilon(0.005));
  CHECK(window.suggested == window.opens);
  CHECK_FALSE(window.closes);
  CHECK(window.shaking_left == doctest::Approx(1.5 / 40.0).epsilon(0.1));
  CHECK(window.reason.find("base_motion") == std::string::npos);
}

TEST_CASE("transfer window: waits for strong shaking, and says what is still to come") {
  const auto window = find_transfer_window(rows_of(60.0, 10.0, 0.8, 100.0), even_motion());
  CHECK(window.opens.value() == doctest::Approx(30.0).epsilon(0.01));
  CHECK(window.shaking_left == doctest::Approx(0.25).epsilon(0.02));
  CHECK(window.reason.find("25 % of the shaking is still to come") != std::string::npos);
}

TEST_CASE("transfer window: does not depend on how long the run goes on") {
  const auto early = find_transfer_window(rows_of(35.0, 10.0, 0.8, 100.0), even_motion());
  const auto late = find_transfer_window(rows_of(70.0, 10.0, 0.8, 100.0), even_motion());
  CHECK(early.opens == late.opens);
}

TEST_CASE(
    "transfer window: closes when an element has lost half of what it began with, whatever the worst one began with") {
  const auto window = find_transfer_window(rows_of(60.0, 10.0, 0.8, 40.0), even_motion());
  CHECK(window.closes.value() == doctest::Approx(45.0).epsilon(0.001));
  CHECK(window.suggested == window.opens);
  const auto worn = find_transfer_window(rows_of(60.0, 10.0, 0.8, 20.0), even_motion());
  CHECK(worn.suggested.value() == doctest::Approx(25.0).epsilon(0.001));
  CHECK(worn.reason.find("worn out") != std::string::npos);
}

TEST_CASE("transfer window: none without liquefaction, or when the run ends too early") {
  const auto firm = find_transfer_window(rows_of(60.0, 10.0, 0.1, 100.0), even_motion());
  CHECK_FALSE(firm.suggested);
  CHECK(firm.reason.find("nothing liquefied") != std::string::npos);
  const auto short_run = find_transfer_window(rows_of(25.0, 10.0, 0.8, 100.0), even_motion());
  CHECK_FALSE(short_run.suggested);
  CHECK(short_run.reason.find("75 % of the Arias intensity at 30.1 s") != std::string::npos);
  CHECK_FALSE(find_transfer_window({}, even_motion()).suggested);
}

TEST_CASE("motion: the share of the Arias intensity that is still to come") {
  const Motion motion = even_motion();
  CHECK(motion.arias_share_after(-1.0) == 1.0);
  CHECK(motion.arias_share_after(10.04) == doctest::Approx(1.0 - 10.04 / 40.0).epsilon(0.01));
  CHECK(motion.arias_share_after(500.0) == 0.0);
  CHECK(Motion{.name = "none", .time_step = 0.1, .acceleration = {}, .velocity = {}}.arias_share_after(1.0) == 0.0);
}
