// When the surfaces between velocity fields (field_surfaces.hpp) are to be found again. They change as particles move,
// by a few hundredths of a cell in a step at most, and cost a third of it.
#pragma once

namespace tailrun::mpm {

class SurfaceAge {
 public:
  static constexpr double most_drift = 0.05;  // cells; contact tells gaps of 0.15 cells from none
  static constexpr int most_steps = 8;

  // Whether they are to be found from the particles' places as they are: at first, in the step in which particles may
  // have moved by most_drift since, after most_steps, and after a sort.
  bool due() const { return due_; }

  // A step is over in which no particle moved farther than `drift` (cells).
  void pass(double drift, bool sorted) {
    if (due_) {
      drift_ = 0.0;
      steps_ = 0;
    }
    drift_ += drift;
    due_ = sorted || drift_ > most_drift || ++steps_ >= most_steps;
  }

 private:
  double drift_ = 0.0;  // cells
  int steps_ = 0;
  bool due_ = true;
};

}  // namespace tailrun::mpm
