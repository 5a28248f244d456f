#include "mpm_stage/output/energy_remarks.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace tailrun::mpm;

namespace {

// A block that has fallen by 1 MJ and lost that in its soil.
struct Fallen {
  LedgerRow first, last;
  double turnover = 1e6;  // J
  bool flows = true;

  Fallen() {
    first.mass = last.mass = 1e5;
    first.gravitational = 3e6;
    last.gravitational = 2e6;
    last.work.plastic = 1e6;
  }
  std::vector<std::string> remarks() const { return energy_remarks(first, last, turnover, flows); }
};

}  // namespace

TEST_CASE("a run whose losses are explained is not remarked on, with some crowding and residual too") {
  Fallen run;
  CHECK(run.remarks().empty());
  run.last.work.crowding = 0.9e6;
  run.last.residual = -0.04e6;
  CHECK(run.remarks().empty());
}

TEST_CASE("more from crowding than was set free is said; what shaking gave counts as that") {
  Fallen run;
  run.last.work.crowding = 1.2e6;
  REQUIRE(run.remarks().size() == 1);
  CHECK(run.remarks()[0].find("1.2e+06 J") != std::string::npos);
  CHECK(run.remarks()[0].find("(1e+06 J)") != std::string::npos);
  run.last.work.external = 0.3e6;
  CHECK(run.remarks().empty());
}

TEST_CASE("a residual that nothing explains is said, lost or made; unless it holds transfer and impacts") {
  Fallen run;
  run.last.residual = 0.06e6;
  REQUIRE(run.remarks().size() == 1);
  CHECK(run.remarks()[0].find("6.0 % of the energy turned over was lost") != std::string::npos);
  run.last.residual = -0.06e6;
  CHECK(run.remarks()[0].find("was made") != std::string::npos);
  run.flows = false;
  CHECK(run.remarks().empty());
  run.flows = true;
  run.last.work.transfer = std::nan("");
  CHECK(run.remarks().empty());
}

TEST_CASE("shares of next to nothing say nothing") {
  Fallen run;
  run.first.gravitational = run.last.gravitational + 0.1;
  run.last.work.plastic = 0.1;
  run.last.residual = 0.09;
  run.turnover = 0.1;
  CHECK(run.remarks().empty());
}
