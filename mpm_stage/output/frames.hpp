// Frames: the particles at chosen times, as particles files (common/particles.hpp) that ParaView opens, with an index
// of all of them. Files are written on a thread of their own while the computation goes on.
#pragma once

#include <exception>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "common/particles.hpp"
#include "common/provenance.hpp"
#include "mpm_stage/scene/scene.hpp"

namespace tailrun::mpm {

// The state of `P` over the scene's initial set: rows in the order of the input, particles that left are missing.
// Materials with total stress have it as effective stress with a pore pressure of 0.
template <int Dim>
ParticleSet particle_set(const Scene& scene, const Particles<Dim>& P, double time);

class FrameWriter {
 public:
  FrameWriter(std::filesystem::path folder, Provenance provenance, Precision precision);
  ~FrameWriter();

  // Waits for the frame before, then writes this one in the background. Throws what the frame before threw.
  void write(ParticleSet set);
  void wait();
  // Goes on behind frames written before: their names and times (s).
  void restore(std::vector<std::string> names, std::vector<double> times);
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<double>& times() const { return times_; }
  std::size_t count() const { return names_.size(); }
  const std::string& last() const { return names_.back(); }

 private:
  void write_index() const;
  std::filesystem::path folder_;
  Provenance provenance_;
  Precision precision_;
  std::vector<std::string> names_;
  std::vector<double> times_;
  std::thread thread_;
  std::exception_ptr error_;
};

}  // namespace tailrun::mpm
