#include "transfer_tool/inspect/file_report.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "common/error.hpp"
#include "common/hdf5_file.hpp"
#include "common/particles.hpp"
#include "example_mesh.hpp"
#include "transfer_tool/audit/particle_set.hpp"

using namespace tailrun::transfer;

namespace {

tailrun::Snapshot mesh() {
  auto made = example::rectangle(3, 2, 0.0);
  example::set_nodal(made, made.pore_pressure, 1, 0, [](double x, double) { return 100.0 * x; });
  made.time = 16.0;
  return made;
}

const FieldReport& field(const FileReport& report, const std::string& name) {
  for (const auto& candidate : report.fields)
    if (candidate.name.ends_with("/" + name)) return candidate;
  throw std::runtime_error("no field " + name);
}

}  // namespace

TEST_CASE("a snapshot's report: kind, provenance, bounds, regions with masses, fields with their range") {
  const example::TemporaryFolder folder;
  tailrun::write_snapshot(folder / "s.h5", mesh(), {"fem_stage", {}, {{"fem.json", "abc"}}});
  const FileReport report = read_file_report(folder / "s.h5");
  CHECK(report.kind == "tailrun-snapshot");
  CHECK(report.program == "fem_stage");
  CHECK(report.inputs.at(0).second == "abc");
  CHECK(report.points == 12);
  CHECK(report.cells == 6);
  CHECK(report.high == std::vector<double>{3.0, 2.0, 0.0});
  REQUIRE(report.groups.size() == 2);
  CHECK(report.groups[1].name == "upper");
  CHECK(report.groups[1].count == 3);
  CHECK(report.groups[1].mass == doctest::Approx(6000.0));
  CHECK(*report.mass == doctest::Approx(3 * 1800.0 + 3 * 2000.0));
  CHECK(field(report, "pore_pressure").most[0] == doctest::Approx(300.0));
  CHECK(field(report, "pore_pressure").mean[0] == doctest::Approx(150.0));
  CHECK(field(report, "pore_pressure").unit == "Pa");
  CHECK(field(report, "effective_stress").mean.size() == 4);
}

TEST_CASE("a particles file's report, as text and as JSON") {
  const example::TemporaryFolder folder;
  const auto snapshot = mesh();
  const auto points = example::sample_all(snapshot, Layout::gauss, 2);
  const auto state = map_state(snapshot, points, {});
  auto particles = particle_set(snapshot, points, state, assign(snapshot, points, state, {Rule{"soil", {}, {}}}));
  particles.terrain.push_back({"bed", {0, 0, 3, 0}});
  particles.notes["audit"] = R"({"integrals": 12})";
  tailrun::write_particles(folder / "p.h5", particles, {"transfer_tool", {}, {}});
  const FileReport report = read_file_report(folder / "p.h5");
  CHECK(report.kind == "tailrun-particles");
  CHECK(*report.mass == doctest::Approx(11400.0));
  const auto json = report_json(report);
  CHECK(json["time_s"] == 16.0);
  CHECK(json["materials"][0]["count"] == 24);
  CHECK(json["lines"][0]["name"] == "bed");
  CHECK(json["notes"]["audit"]["integrals"] == 12);
  const std::string text = report_text(report);
  for (const char* expected : {"made by transfer_tool", "24 points", "soil", "line bed", "pore_pressure"})
    CHECK_MESSAGE(text.find(expected) != std::string::npos, expected);
}

TEST_CASE("docs/formats.md describes every field of both formats") {
  const example::TemporaryFolder folder;
  const auto snapshot = mesh();
  const auto points = example::sample_all(snapshot, Layout::gauss, 1);
  const auto state = map_state(snapshot, points, {});
  tailrun::write_snapshot(folder / "s.h5", snapshot, {});
  tailrun::write_particles(
      folder / "p.h5", particle_set(snapshot, points, state, assign(snapshot, points, state, {Rule{"soil", {}, {}}})),
      {});
  std::ifstream stream(std::string(TAILRUN_SOURCE_DIR) + "/docs/formats.md");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const char* name : {"s.h5", "p.h5"})
    for (const auto& described : read_file_report(folder / name).fields)
      CHECK_MESSAGE(text.find("| `" + described.name + "`") != std::string::npos, described.name);
}

TEST_CASE("a program's own restart state beside a snapshot is listed") {
  const example::TemporaryFolder folder;
  tailrun::write_snapshot(folder / "geostatic.h5", mesh(), {}, [](tailrun::Hdf5Writer& file) {
    file.write("/tailrun/fem_restart/material_state", std::vector<double>{1, 2, 3, 4, 5, 6}, 2, "1", "state");
  });
  const FileReport report = read_file_report(folder / "geostatic.h5");
  const auto place = std::find_if(report.other.begin(), report.other.end(), [](const auto& entry) {
    return entry.first == "/tailrun/fem_restart/material_state";
  });
  REQUIRE(place != report.other.end());
  CHECK(place->second == std::vector<std::size_t>{3, 2});
  CHECK(report_text(report).find("3 x 2") != std::string::npos);
}

TEST_CASE("a checkpoint is called one, with what it holds and without points that it cannot have") {
  const example::TemporaryFolder folder;
  {
    tailrun::Hdf5Writer file(folder / "checkpoint.h5");
    file.group("/tailrun");
    file.attribute("/tailrun", "format", std::string("mpm_checkpoint"));
    file.attribute("/tailrun", "format_version", 1.0);
    file.write("/particles/position", std::vector<double>{1, 2, 3, 4}, 2, "m", "position");
    file.commit();
  }
  const std::string text = report_text(read_file_report(folder / "checkpoint.h5"));
  CHECK(text.find("a checkpoint: what a run that was stopped goes on from") != std::string::npos);
  CHECK(text.find("/particles/position") != std::string::npos);
  CHECK(text.find("0 points") == std::string::npos);
  CHECK(text.find("field") == std::string::npos);
}

TEST_CASE("missing, foreign and truncated files are refused with a clear message") {
  const example::TemporaryFolder folder;
  const auto message = [](const std::filesystem::path& path) {
    return example::message_of<tailrun::InputError>([&] { read_file_report(path); });
  };
  CHECK(message(folder / "none.h5").find("no such file") != std::string::npos);
  CHECK(message(folder.write("text.h5", "not HDF5 at all")).find("not an HDF5 file") != std::string::npos);
  {
    tailrun::Hdf5Writer foreign(folder / "foreign.h5");
    foreign.write("/x", std::vector<double>{1.0}, 0, "m", "somebody else's");
    foreign.commit();
  }
  CHECK(message(folder / "foreign.h5").find("not one of tailrun's") != std::string::npos);
  tailrun::write_snapshot(folder / "s.h5", mesh(), {});
  const auto size = std::filesystem::file_size(folder / "s.h5");
  for (const double share : {0.999, 0.5, 0.01}) {
    std::filesystem::resize_file(folder / "s.h5", static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    CHECK(!message(folder / "s.h5").empty());
  }
}
