// Hand-overs that ask for more points than a machine holds are refused before the first is made, at the key that asks.
#include "transfer_tool/sample/request_checks.hpp"

#include <doctest/doctest.h>

#include "common/error.hpp"
#include "example_mesh.hpp"
#include "transfer_tool/options/transfer_case.hpp"

using namespace tailrun;
using namespace tailrun::transfer;

namespace {

// The refusal of a hand-over with this "sampling" (and "sizes"), "" when it may go on.
std::string refusal(const std::string& keys, const std::string& size = {}, const std::string& output = {}) {
  const example::TemporaryFolder folder;
  const CaseFile file(folder.write("transfer.json", "{" + keys + R"(, "rules": [{ "material": "soil" }]})"));
  const Snapshot mesh = example::rectangle(4, 4, 0.0);
  const TransferCase wanted = read_transfer_case(file, mesh.region_names, size);
  const std::vector<bool> kept = kept_elements(mesh, wanted.sampling);
  return example::message_of<InputError>([&] { check_request(file, size, mesh, kept, wanted.sampling, output); });
}

void check(const std::string& message, const char* words) {
  CHECK_MESSAGE(message.find(words) != std::string::npos, message);
}

}  // namespace

TEST_CASE("what sample() makes is what was counted before") {
  auto mesh = example::rectangle(4, 4);
  example::set_motion(mesh);
  const std::vector<bool> kept(mesh.elements(), true);
  for (const Layout layout : {Layout::gauss, Layout::uniform})
    for (const double cell : {0.3, 0.9, 5.0}) {
      SamplingOptions options = example::sampling(layout, 0);
      options.cell_size = cell;
      options.points[1] = 3;
      CHECK(points_asked_for(mesh, kept, options) == static_cast<double>(sample(mesh, kept, options).count()));
    }
}

TEST_CASE("more points than the memory holds are refused with their number, at the key that asks for them") {
  CHECK(refusal(R"("sampling": { "layout": "uniform", "cell_size": 0.5 })") == "");
  check(refusal(R"("sampling": { "layout": "uniform", "cell_size": 1e-6 })"),
        "/sampling/cell_size: asks for 6.4e+13 points");
  check(refusal(R"("sampling": { "layout": "uniform", "cell_size": 1e-300 })"), "/sampling/cell_size: asks for");
  check(refusal(R"("sampling": { "layout": "uniform" }, "sizes": { "fine": { "cell_size": 1e-7 } })", "fine"),
        "/sizes/fine/cell_size: asks for 6.4e+15 points");
  CHECK(refusal(R"("sampling": { "layout": "uniform" }, "sizes": { "fine": { "cell_size": 1e-7 } })") == "");
  // A Gauss rule has at most 25 points in an element, whatever is asked for.
  CHECK(refusal(R"("sampling": { "cell_size": 1e-300 })") == "");
}

TEST_CASE("more points than the disk has room for are refused") {
  // /proc holds nothing.
  check(refusal(R"("sampling": { "cell_size": 1 })", "", "/proc/particles.h5"), "GB left");
}
