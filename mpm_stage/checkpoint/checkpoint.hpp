// checkpoint.h5: everything that a run needs to go on bit for bit from a step between its start and its end. The file
// takes its name when it is complete, so the last good one stays until then.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/provenance.hpp"
#include "mpm_stage/output/body_series.hpp"
#include "mpm_stage/output/front.hpp"
#include "mpm_stage/output/ledger.hpp"
#include "mpm_stage/output/section_series.hpp"
#include "mpm_stage/output/summary.hpp"
#include "mpm_stage/step/solver.hpp"

namespace tailrun::mpm {

constexpr int checkpoint_format_version = 6;

// What the run loop has to remember besides the solver.
struct RunState {
  RunRecord record;
  long series_count = 0, frame_count = 0;  // events of the schedules that are over
  std::vector<std::string> frame_names;
  std::vector<double> frame_times;  // s
  std::vector<LedgerRow> ledger;
  double largest_kinetic = 0.0;  // J, of the ledger's rows
  std::vector<FrontRow> front;
  std::vector<BodyRow> bodies;
  std::vector<SectionRow> sections;
};

// Throws ComputationError when the file cannot be written.
template <int Dim>
void write_checkpoint(const std::filesystem::path& path, Solver<Dim>& solver, double cell_size, RunState run,
                      const Provenance& provenance);

// Brings `solver`, newly made from the same scene and not started, to where the checkpoint was written, and returns the
// run's own state. Throws InputError when there is no such file, it is damaged, or it belongs to other input: another
// case file, particles file or motion (by SHA-256), another cell size or dimension; or when what it says cannot be a
// state of this scene (checkpoint_checks.hpp).
template <int Dim>
RunState read_checkpoint(const std::filesystem::path& path, Solver<Dim>& solver, const Scene& scene,
                         const Provenance& provenance);

}  // namespace tailrun::mpm
