#include "common/motion.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

#include "common/error.hpp"

using namespace tailrun;

namespace {

std::filesystem::path written(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

}  // namespace

TEST_CASE("the three header forms of AT2, odd line ends and short last lines") {
  for (const std::string header :
       {"NPTS=  5, DT= .02000 SEC", "NPTS=   5, DT=   .0200 SEC,", "5    0.0200    NPTS, DT"}) {
    const Motion motion =
        read_at2(written("tailrun_motion.AT2", "PEER\r\r\nsome 1971 text\r\r\nACCELERATION IN UNITS OF G\r\r\n" +
                                                   header + "\r\r\n  .1297E-02 -0.2 0.1\r\r\n 0.0 .05\r\r\n"));
    CHECK(motion.time_step == 0.02);
    REQUIRE(motion.acceleration.size() == 5);
    CHECK(motion.acceleration[0] == doctest::Approx(9.81 * 0.1297e-2));
    CHECK(motion.peak_acceleration() == doctest::Approx(9.81 * 0.2));
  }
}

TEST_CASE("counts that disagree: too few is an error, too many is cut") {
  const std::string head = "a\nb\nc\n";
  CHECK_THROWS_AS(read_at2(written("tailrun_short.AT2", head + "NPTS= 9, DT= .01 SEC\n1 2 3\n")), InputError);
  CHECK(read_at2(written("tailrun_long.AT2", head + "NPTS= 2, DT= .01 SEC\n1 2 3\n")).acceleration.size() == 2);
  CHECK_THROWS_AS(read_at2(written("tailrun_bad.AT2", head + "no numbers here\n1 2 3\n")), InputError);
  CHECK_THROWS_AS(read_motion("nowhere.AT2"), InputError);
}

TEST_CASE("velocity is the integral of the acceleration that is linear between points") {
  const Motion motion = read_motion_csv(written("tailrun_motion.csv", "t_s,a_m_s2\n0,0\n0.5,2\n1.0,2\n1.5,0\n"));
  CHECK(motion.velocity_at(0.25) == doctest::Approx(0.125));
  CHECK(motion.velocity_at(1.0) == doctest::Approx(1.5));
  CHECK(motion.velocity_at(9.0) == doctest::Approx(2.0));
  CHECK(motion.acceleration_at(0.25) == doctest::Approx(1.0));
  CHECK(scaled_to_peak(motion, 1.0).velocity_at(9.0) == doctest::Approx(1.0));
  CHECK(motion.arias_intensity() > 0.0);
}
