// rigid: material that stands still whatever happens (a foundation, natural ground).
//
// Its particles are left out when the scene is read, and the terrain stands in their place; so it has no parameters,
// and nothing may ask for its stress.
//
// Keys: none.
#include "common/case_file.hpp"
#include "common/error.hpp"
#include "mpm_stage/material/material.hpp"

namespace tailrun::mpm {

namespace {

void read(const CaseNode& /*node*/, Material& /*m*/) {}

template <int Dim>
double update(const MaterialConstants&, Particles<Dim>&, std::size_t, std::size_t, const double*, double) {
  throw ComputationError("a rigid material has no stress update");
}

template <int Dim>
double energy(const MaterialConstants&, const Particles<Dim>&, std::size_t, std::size_t) {
  return 0.0;
}

void set_constants(const Material& /*m*/, double /*cell_size*/, MaterialConstants& k) {
  k.plane = {update<2>, energy<2>};
  k.solid = {update<3>, energy<3>};
}

}  // namespace

namespace laws {
extern const MaterialLaw rigid = {
    .name = "rigid", .rigid = true, .moves = false, .read = read, .set_constants = set_constants};
}

}  // namespace tailrun::mpm
