#include "mpm_stage/material/material_list.hpp"

#include <fmt/core.h>

#include <string>

#include "common/error.hpp"

// The list: one line per law, the name of its file and of its object there (in namespace laws).
#define TAILRUN_MATERIAL_LAWS(law) \
  law(linear_elastic);             \
  law(mohr_coulomb);               \
  law(mu_i);                       \
  law(tresca);                     \
  law(newtonian_fluid);            \
  law(rigid);

namespace tailrun::mpm {

namespace laws {
#define TAILRUN_DECLARE(name) extern const MaterialLaw name
TAILRUN_MATERIAL_LAWS(TAILRUN_DECLARE)
#undef TAILRUN_DECLARE
}  // namespace laws

const std::vector<const MaterialLaw*>& material_laws() {
  static const std::vector<const MaterialLaw*> list = [] {
    std::vector<const MaterialLaw*> all;
#define TAILRUN_APPEND(name) all.push_back(&laws::name)
    TAILRUN_MATERIAL_LAWS(TAILRUN_APPEND)
#undef TAILRUN_APPEND
    return all;
  }();
  return list;
}

std::vector<std::string> law_names() {
  std::vector<std::string> names;
  for (const MaterialLaw* law : material_laws()) names.push_back(law->name);
  return names;
}

const MaterialLaw& law_named(std::string_view name) {
  for (const MaterialLaw* law : material_laws())
    if (law->name == name) return *law;
  throw InputError(fmt::format("there is no material model '{}' (there are: {}).{}", name, joined(law_names()),
                               did_you_mean(name, law_names())));
}

}  // namespace tailrun::mpm
