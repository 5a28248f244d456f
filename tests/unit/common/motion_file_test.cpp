// Motions as other programs and agencies write them: what the file says about units and columns is followed or refused.
#include <doctest/doctest.h>

#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "common/error.hpp"
#include "common/motion.hpp"
#include "common/warnings.hpp"

using namespace tailrun;

namespace {

std::filesystem::path written(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::temp_directory_path() / ("tailrun_motion_file_" + name);
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

Motion at2(const std::string& units, const std::string& counts, const std::string& values) {
  return read_at2(
      written("a.AT2", "PEER\nStation 12, Vs30 = 760 m/s\n" + units + "\n" + counts + "\n" + values + "\n"));
}

Motion csv(const std::string& text) {
  return read_motion_csv(written("a.csv", text));
}

std::string refusal(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool warned_of(const std::string& words) {
  for (const auto& text : warnings())
    if (text.find(words) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("units in the text above an AT2 file's values") {
  const std::string counts = "NPTS= 3, DT= .01 SEC", values = "0 2.0 -1.0";
  const auto peak = [&](const std::string& units) { return at2(units, counts, values).peak_acceleration(); };
  for (const char* g : {"ACCELERATION TIME SERIES IN UNITS OF G", "Acceleration time history in units of g.",
                        "ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=35.0 Hz",
                        "Acceleration (g)", "ACCELERATION IN G", "UNITS: G'S", "units = (g)"})
    CHECK_MESSAGE(peak(g) == 9.81 * 2.0, g);
  for (const char* cm : {"CM/SEC**2", "CM/SEC2", "CM/SEC/SEC", "cm/s/s", "cm/s^2", "CM/S**2", "GAL", "gals",
                         "cm/sec/sec.", "CM / SEC ** 2", "cm s-2", "CM PER SEC PER SEC", "cm/s\u00b2"})
    CHECK_MESSAGE(peak(std::string("ACCELERATION TIME SERIES IN UNITS OF ") + cm) == doctest::Approx(0.02), cm);
  CHECK(peak("ACCELERATION, UNITS: M/S/S") == doctest::Approx(2.0));
  CHECK(peak("UNITS OF M/SEC**2") == doctest::Approx(2.0));
  CHECK(peak("UNITS OF MM/S2") == doctest::Approx(2e-3));
  CHECK(peak("UNITS OF IN/SEC/SEC") == doctest::Approx(2.0 * 0.0254));
  CHECK(peak("UNITS OF FT/SEC2") == doctest::Approx(2.0 * 0.3048));
  CHECK(peak("UNITS OF MG") == doctest::Approx(2e-3 * 9.81));
  CHECK(peak("UNITS OF %G") == doctest::Approx(2e-2 * 9.81));
  for (const char* wrong : {"VELOCITY TIME SERIES IN UNITS OF CM/SEC", "VELOCITY TIME SERIES", "UNITS OF CM/S",
                            "UNITS OF CM", "DISPLACEMENT TIME HISTORY IN UNITS OF M",
                            "ACCELERATION IN UNITS OF FURLONGS", "ACCELERATION IN UNITS OF COUNTS", "VELOCITY (cm/s)"})
    CHECK_MESSAGE(!refusal([&] { peak(wrong); }).empty(), wrong);
  forget_warnings();
  CHECK(peak("nothing about it") == 9.81 * 2.0);
  CHECK(warned_of("g is taken"));
}

TEST_CASE("time steps: Fortran exponents, milliseconds, other places of the line") {
  const std::string g = "ACCELERATION IN UNITS OF G", values = "0 1 0";
  const auto step = [&](const std::string& counts) { return at2(g, counts, values).time_step; };
  CHECK(step("NPTS=  3, DT=  0.5000D-02 SEC") == 0.005);
  CHECK(step("NPTS=  3, DT=  1.0d-02") == 0.01);
  CHECK(step("NPTS= 3, DT= +.0050 SEC") == 0.005);
  CHECK(step("NPTS= 3, DT= 5.0 MSEC") == doctest::Approx(0.005));
  CHECK(step("NPTS= 3, DT= 5 ms,") == doctest::Approx(0.005));
  CHECK(step("DT= .02 SEC, NPTS= 3") == 0.02);
  CHECK(step("3  .0100  NPTS, DT") == 0.01);
  CHECK(step("3  1.0D-02  NPTS, DT (SEC)") == 0.01);
  for (const char* wrong : {"NPTS= 3, DT= 1.0.0 SEC", "NPTS= 3, DT= 1/200", "NPTS= 3, DT= 200 HZ", "NPTS= 3, DT= 0 SEC",
                            "NPTS= 3, DT= -.01", "NPTS= 3, DT= x"})
    CHECK_MESSAGE(!refusal([&] { step(wrong); }).empty(), wrong);
  const std::string text = "one\ntwo\nACCELERATION IN UNITS OF CM/S2\nfour\nNPTS= 2, DT= .01 SEC\n1.0 2.0\n",
                    after = "one\ntwo\nthree\nNPTS= 2, DT= .01 SEC\nUNITS: CM/S2\n1.0 2.0\n";
  for (const auto& header : {text, after}) {
    const Motion motion = read_at2(written("five.AT2", header));
    CHECK(motion.acceleration == std::vector<double>{0.01, 0.02});
  }
}

TEST_CASE("values that Fortran wrote: D exponents, columns that touch, a leading +") {
  const std::string units = "ACCELERATION IN UNITS OF M/S2";
  const auto values = [&](const std::string& line, int n) {
    return at2(units, "NPTS= " + std::to_string(n) + ", DT= .01", line).acceleration;
  };
  CHECK(values("  .1D-02 -2.5D+00", 2) == std::vector<double>{0.001, -2.5});
  CHECK(values("-.1234567E-01-.2345678E-02 .5E+00", 3) == std::vector<double>{-0.01234567, -0.002345678, 0.5});
  CHECK(values("0.5-0.25+0.125", 3) == std::vector<double>{0.5, -0.25, 0.125});
  CHECK(values("+1.5 +2", 2) == std::vector<double>{1.5, 2.0});
  CHECK(values("0.1234567E-020.2345678E-02", 2) == std::vector<double>{0.001234567, 0.002345678});
  for (const char* wrong : {"1,5 2,5", "0.1 nan", "inf 0", "0.1.2 3", "1e999 0", "0.1 *****"})
    CHECK_MESSAGE(!refusal([&] { values(wrong, 2); }).empty(), wrong);
}

TEST_CASE("columns of a table: names with units") {
  const auto motion = [](const std::string& header) { return csv(header + "\n0,0\n5,2\n10,0\n"); };
  for (const char* name : {"t,a", "time,acc", "t_s,a_m_s2", "time [s], acceleration [m/s2]",
                           "\"Time (s)\",\"Acc (m/s/s)\"", "Time,Acceleration EW", "# t s, a m/s2"}) {
    CHECK_MESSAGE(motion(name).time_step == 5.0, name);
    CHECK_MESSAGE(motion(name).peak_acceleration() == 2.0, name);
  }
  for (const char* name : {"t,a_g", "t_s,acc (g)", "t,acceleration_g", "s,g", "t,a in g"})
    CHECK_MESSAGE(motion(name).peak_acceleration() == doctest::Approx(9.81 * 2.0), name);
  for (const char* name : {"t,a_cm_s2", "t,acc [cm/s^2]", "time,gal", "t,a (Gal)", "t,a_cmps2", "t,acc_cms2"})
    CHECK_MESSAGE(motion(name).peak_acceleration() == doctest::Approx(0.02), name);
  for (const char* name : {"time_ms,a", "Time (ms),a", "t [msec],a [m/s2]"})
    CHECK_MESSAGE(motion(name).time_step == doctest::Approx(0.005), name);
  for (const char* name :
       {"t,v_m_s", "time,velocity (cm/s)", "t,velocity", "t,a [furlong]", "t [km],a", "a (g),t (s)", "t,ew,ns"})
    CHECK_MESSAGE(!refusal([&] { motion(name); }).empty(), name);
  CHECK(csv("Time (s)  Acc (g)\n0 0\n1 1\n").peak_acceleration() == doctest::Approx(9.81));
  CHECK(csv("# El Centro\n# units: gal\n0 0\n1 1\n").peak_acceleration() == doctest::Approx(0.01));
  CHECK(csv("0;0\n1;2\n").peak_acceleration() == 2.0);
  CHECK(csv("0\t0\n1\t2\n").peak_acceleration() == 2.0);
  CHECK(csv("\xEF\xBB\xBF+0,+0\r\n+1,+2.5D0\r\n\r\n").peak_acceleration() == 2.5);
}

TEST_CASE("rows of a table: nothing is left out without a word") {
  CHECK(refusal([] { csv("0,0\n1,\n2,1\n3,1\n"); }).find("line 2") != std::string::npos);
  CHECK(refusal([] { csv("t,a\n0,0\n1,1\n2,\n"); }).find("line 4") != std::string::npos);
  CHECK(refusal([] { csv("0,0\n,1\n2,1\n"); }).find("no time") != std::string::npos);
  CHECK(refusal([] { csv("0 0\n1\n2 1\n"); }).find("no acceleration") != std::string::npos);
  CHECK(refusal([] { csv("0,0,5\n1,1,5\n"); }).find("3 columns") != std::string::npos);
  CHECK(refusal([] { csv("0,0\n0,005;1,5\n"); }).find("decimal") != std::string::npos);
  CHECK(refusal([] { csv("0,0\n1,x\n"); }).find("not a number") != std::string::npos);
  CHECK(!refusal([] { csv("0,0\n1,1\n3,1\n"); }).empty());
  CHECK(csv("0,0,\n1,1,\n").acceleration.size() == 2);
  forget_warnings();
  CHECK(csv("1.0,0\n1.5,1\n2.0,0\n").duration() == 1.0);
  CHECK(warned_of("begins at 1 s"));
}

TEST_CASE("units that are none, steps that no recorder has and peaks that no ground has are refused") {
  const auto message = [](const char* line, const char* counts) {
    return refusal([&] { at2(line, counts, ".1 .2 .3"); });
  };
  const char* plain = "NPTS= 3, DT= .005 SEC";
  CHECK(message("ACCELERATION IN FURLONG/S2", plain).find("'FURLONG/S2'") != std::string::npos);
  CHECK(message("ACCELERATION TIME HISTORY (BANANA PER SEC)", plain).find("BANANA") != std::string::npos);
  CHECK(message("ACCELERATION IN TOKYO", plain) == "");
  CHECK(message("UNITS OF G", "NPTS= 3, DT= 1e-300 SEC").find("1e-300 s") != std::string::npos);
  CHECK(refusal([] { csv("t,a\n0,1\n1e-12,2\n2e-12,1\n"); }).find("1e-12 s") != std::string::npos);
  const auto huge = csv("t,a\n0,1e300\n0.01,-1e300\n0.02,0\n");
  CHECK(refusal([&] { warn_about_motion(huge, 1e300, 0.01, 1.0); }).find("1e+300 m/s2") != std::string::npos);
}

TEST_CASE("what is hardly meant gets a warning") {
  const auto motion = [](double scale) {
    Motion out{.name = "m", .time_step = 0.01, .acceleration = {}, .velocity = {}};
    for (int i = 0; i <= 400; ++i)
      out.acceleration.push_back(scale * std::sin(2.0 * 3.14159265358979 * i * out.time_step));
    out.integrate();
    return out;
  };
  forget_warnings();
  warn_about_motion(motion(2.5), 2.5, 0.01, 10.0);
  warn_about_motion(scaled_to_peak(motion(1.0), 2.5), 1.0, 0.005, 4.0);
  warn_about_late_start(motion(1.0), 0.0);
  CHECK(warnings().empty());
  warn_about_motion(scaled_to_peak(motion(2.5), 0.25), 2.5, 0.01, 4.0);
  CHECK(warned_of("write 2.4"));
  warn_about_motion(scaled_to_peak(motion(1.0), 80.0), 1.0, 0.01, 4.0);
  CHECK(warned_of("by 80"));
  CHECK(warned_of("8.15 g"));
  warn_about_motion(motion(1.0), 1.0, 0.02, 4.0);
  CHECK(warned_of("longer than that of the record"));
  Motion drifting = motion(1.0);
  for (double& a : drifting.acceleration) a += 0.05;
  drifting.integrate();
  warn_about_motion(drifting, 1.05, 0.01, 10.0);
  CHECK(warned_of("baseline drifts"));
  warn_about_late_start(motion(1.0), 100.0);
  CHECK(warned_of("nothing shakes"));
  forget_warnings();
}

TEST_CASE("numbers do not depend on the locale") {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE"})
    if (std::setlocale(LC_ALL, name)) break;
  const double peak = csv("t,a\n0.5,0.25\n1.0,1.5\n").peak_acceleration(), step = csv("0.5,0.25\n1.0,1.5\n").time_step;
  const double dt = at2("UNITS OF M/S2", "NPTS= 2, DT= .005 SEC", "0.25 1.5").time_step;
  std::setlocale(LC_ALL, before.c_str());
  CHECK(peak == 1.5);
  CHECK(step == 0.5);
  CHECK(dt == 0.005);
}
