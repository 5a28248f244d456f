#include "fem_stage/material/material_definition.hpp"

namespace tailrun::fem {

namespace {

template <class... Parameters>
std::vector<std::string> names_of(ModelList<Parameters...>) {
  return {std::string(Parameters::model_name)...};
}

template <class... Parameters>
Models::AnyParameters read_model(ModelList<Parameters...>, const std::string& word, const CaseNode& node) {
  Models::AnyParameters found;
  const auto read_if_named = [&]<class P>(P) {
    if (word == P::model_name) found = P::read(node);
  };
  (read_if_named(Parameters{}), ...);
  return found;
}

}  // namespace

MaterialDefinition read_material(const CaseNode& node, const std::string& name) {
  const std::string word = node.choice("model", names_of(Models{}));
  return {name, read_model(Models{}, word, node)};
}

double density_of(const MaterialDefinition& material) {
  return std::visit([](const auto& p) { return p.density; }, material.model);
}

double porosity_of(const MaterialDefinition& material) {
  return std::visit([](const auto& p) { return p.porosity(); }, material.model);
}

std::string_view model_name(const MaterialDefinition& material) {
  return std::visit([](const auto& p) { return p.model_name; }, material.model);
}

}  // namespace tailrun::fem
