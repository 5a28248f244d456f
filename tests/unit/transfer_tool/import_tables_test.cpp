#include "transfer_tool/import/import_tables.hpp"

#include <doctest/doctest.h>

#include "common/error.hpp"
#include "common/warnings.hpp"
#include "example_mesh.hpp"

using namespace tailrun::transfer;

namespace {

// Two unit squares side by side, numbered from 11 and 5, in kPa and compression positive.
struct Tables {
  example::TemporaryFolder folder;
  Tables() {
    folder.write("nodes.csv",
                 "node,x_m,y_m,lines\n11,0,0,base|left\n12,1,0,base\n13,2,0,base\n14,0,1,left|surface\n"
                 "15,1,1,surface\n16,2,1,surface\n");
    folder.write("quads.csv", "element,n1,n2,n3,n4,region,thickness_m\n5,11,12,15,14,sand,1\n6,12,13,16,15,clay,1\n");
    folder.write("node_state.csv",
                 "node,ux_m,uy_m,vx_m_s,vy_m_s,p_kPa\n16,0,0,1,0,3\n15,0.1,0,1,0,3\n14,0,0,1,0,3\n11,0,0,0.5,0,13\n"
                 "12,0,0,0.5,0,13\n13,0,0,0.8,0,13\n");
    folder.write("nodes_before.csv", "node,p_kPa\n11,10\n12,10\n13,10\n14,0\n15,0\n16,0\n");
    folder.write("element_state.csv", "element,sxx_kPa,syy_kPa,sxy_kPa,gamma\n6,4,6,1,0.02\n5,40,60,-1,0.01\n");
    folder.write("elements_before.csv", "element,sxx_kPa,syy_kPa,sxy_kPa\n5,50,100,0\n6,50,100,0\n");
  }
  tailrun::Snapshot snapshot(const std::string& more = {}) const {
    tailrun::Provenance provenance;
    return import_tables(tailrun::CaseFile(folder.write(
                             "import.json",
                             R"({"time": 3, "nodes": "nodes.csv", "quads": "quads.csv", "node_state": "node_state.csv",
                "element_state": "element_state.csv", "initial_node_state": "nodes_before.csv",
                "initial_element_state": "elements_before.csv",
                "regions": {"sand": {"density": 1900}, "clay": {"density": 1700}})" +
                                 more + "}")),
                         provenance);
  }
};

}  // namespace

TEST_CASE("tables in any order and unit become a snapshot in SI units, tension positive") {
  const auto snapshot = Tables().snapshot();
  CHECK(snapshot.time == 3.0);
  CHECK(snapshot.region_names == std::vector<std::string>{"sand", "clay"});
  CHECK(snapshot.quads == std::vector<std::int64_t>{0, 1, 4, 3, 1, 2, 5, 4});
  CHECK(snapshot.effective_stress == std::vector<double>{-40e3, -60e3, -50e3, -1e3, -4e3, -6e3, -5e3, 1e3});
  CHECK(snapshot.total_stress[1] == doctest::Approx(-68e3));
  CHECK(snapshot.displacement[2 * 4] == 0.1);
  CHECK(snapshot.density == std::vector<double>{1900.0, 1700.0});
  CHECK(snapshot.initial_vertical_effective_stress == std::vector<double>{100e3, 100e3});
  CHECK(snapshot.excess_pore_pressure_ratio[0] == doctest::Approx(0.03));
  CHECK(snapshot.effective_stress_ratio[1] == doctest::Approx(0.94));
  CHECK(snapshot.depth[0] == doctest::Approx(0.5));
  CHECK(snapshot.shear_strain == std::vector<double>{0.01, 0.02});
}

TEST_CASE("named lines become edges, and the base's mean velocity is the base velocity") {
  const auto snapshot = Tables().snapshot();
  REQUIRE(snapshot.lines.size() == 3);
  CHECK(snapshot.lines[0].name == "base");
  CHECK(snapshot.lines[0].edges == std::vector<std::int64_t>{0, 1, 1, 2});
  CHECK(snapshot.base_velocity[0] == doctest::Approx(0.6));
}

TEST_CASE("tension-positive tables keep their signs") {
  const auto snapshot = Tables().snapshot(R"(, "normal_stress": "tension_positive")");
  CHECK(snapshot.effective_stress[1] == 60e3);
  CHECK(snapshot.effective_stress[3] == -1e3);
}

TEST_CASE("faults in the tables are named with file, line and column") {
  const auto message = [](const char* name, const std::string& text) {
    const Tables tables;
    tables.folder.write(name, text);
    return example::message_of<tailrun::InputError>([&] { tables.snapshot(); });
  };
  CHECK(message("quads.csv", "element,n1,n2,n3,n4,region\n5,11,12,15,99,sand\n").find("line 2, column 'n4'") !=
        std::string::npos);
  CHECK(message("quads.csv", "element,n1,n2,n3,n4,region\n5,14,15,12,11,sand\n").find("clockwise") !=
        std::string::npos);
  CHECK(message("quads.csv", "element,n1,n2,n3,n4,region\n5,11,12,15,14\n").find("line 2 has 5 cells") !=
        std::string::npos);
  CHECK(message("node_state.csv", "node,p_kPa\n11,1\n").find("node_state.csv: node 12 of the mesh has no row") !=
        std::string::npos);
  CHECK(message("node_state.csv", "node,ux_m\n11,1\n12,1\n13,1\n14,1\n15,1\n16,1\n").find("no column 'p'") !=
        std::string::npos);
  CHECK(message("element_state.csv", "element,sxx,syy,sxy\n5,1,nan,1\n6,1,1,1\n").find("found 'nan'") !=
        std::string::npos);
}

TEST_CASE("columns are converted by their header, in whichever form it names the unit") {
  const Tables tables;
  tables.folder.write(
      "node_state.csv",
      "\xEF\xBB\xBFnode,ux_mm,vx [cm/s],vy_ft_s,p (psi)\r\n11,+1,50,0,1\r\n12,1,50,0,1\r\n13,1,80,0,1\r\n"
      "14,+1.0E+00,100,1,1\r\n15,1,100,0,1\r\n16,1,100,0,1\r\n");
  const auto snapshot = tables.snapshot();
  CHECK(snapshot.displacement[0] == doctest::Approx(1e-3));
  CHECK(snapshot.velocity[0] == doctest::Approx(0.5));
  CHECK(snapshot.velocity[2 * 3 + 1] == doctest::Approx(0.3048));
  CHECK(snapshot.pore_pressure[0] == doctest::Approx(6894.757));
}

TEST_CASE("columns that are not known, units of another quantity, rows and columns that are there twice") {
  const auto message = [](const char* name, const std::string& text) {
    const Tables tables;
    tables.folder.write(name, text);
    return example::message_of<tailrun::InputError>([&] { tables.snapshot(); });
  };
  const auto state = [&](const std::string& header) {
    std::string text = header + "\n";
    for (int node = 11; node <= 16; ++node) text += std::to_string(node) + ",1,1\n";
    return message("node_state.csv", text);
  };
  CHECK(state("node,p,VX").find("unknown column 'VX'. Did you mean 'vx'?") != std::string::npos);
  CHECK(state("node,p,vx_furlong_s").find("unknown column 'vx_furlong_s'. Did you mean 'vx'?") != std::string::npos);
  CHECK(state("node,p,temperature").find("ignore_columns") != std::string::npos);
  CHECK(state("node,p,vx_kPa").find("its unit is 'kPa', but a velocity is required") != std::string::npos);
  CHECK(state("node,p,vx [knots]").find("does not know the unit 'knots'") != std::string::npos);
  CHECK(state("node,p,p_kPa").find("columns 'p' and 'p_kPa' are the same quantity") != std::string::npos);
  CHECK(message("element_state.csv", "element,sxx,syy,sxy\n5,1,1,1\n6,1,1,1\n5,2,2,2\n")
            .find("line 4, column 'element': 5 occurs twice (first in line 2)") != std::string::npos);
}

TEST_CASE("columns can be left out by name, and a base line must exist") {
  const Tables tables;
  tables.folder.write("element_state.csv", "element,sxx,syy,sxy,p_mean,r_u\n5,1,1,1,9,9\n6,1,1,1,9,9\n");
  CHECK_NOTHROW(tables.snapshot(R"(, "ignore_columns": ["p_mean", "r_u"])"));
  const auto refused = [&](const std::string& more) {
    return example::message_of<tailrun::InputError>([&] { Tables().snapshot(more); });
  };
  CHECK(refused(R"(, "base_line": "bass")").find("no edge of the mesh lies on a line 'bass'. Did you mean 'base'?") !=
        std::string::npos);
  CHECK(refused(R"(, "base_line": "base")").empty());
}

TEST_CASE("ponded water stands on lines of the tables") {
  const auto snapshot = Tables().snapshot(R"(, "ponded_water": [{"lines": ["surface", "left"], "level": 1.5}])");
  REQUIRE(snapshot.ponds.size() == 1);
  CHECK(snapshot.ponds[0].level == 1.5);
  CHECK(snapshot.ponds[0].lines == std::vector<std::string>{"surface", "left"});
  const auto refusal = example::message_of<tailrun::InputError>(
      [] { Tables().snapshot(R"(, "ponded_water": [{"lines": ["surfce"], "level": 1.5}])"); });
  CHECK(refusal.find("Did you mean 'surface'?") != std::string::npos);
  const auto twice = example::message_of<tailrun::InputError>([] {
    Tables().snapshot(
        R"(, "ponded_water": [{"lines": ["surface"], "level": 1.5}, {"lines": ["surface"], "level": 1.5}])");
  });
  CHECK(twice.find("/ponded_water/1/lines: line 'surface' is under water twice") != std::string::npos);
}

TEST_CASE("a porosity in per cent") {
  const Tables tables;
  tailrun::Provenance provenance;
  const auto path =
      tables.folder.write("porous.json", R"({"nodes": "nodes.csv", "quads": "quads.csv", "node_state": "node_state.csv",
      "element_state": "element_state.csv", "regions": {"sand": {"density": 1900, "porosity": 40}, "clay": {"density": 1700}}})");
  const auto refusal =
      example::message_of<tailrun::InputError>([&] { import_tables(tailrun::CaseFile(path), provenance); });
  CHECK(refusal.find("/regions/sand/porosity: found 40, but allowed is a fraction of at most 1; 40 % are 0.4") !=
        std::string::npos);
}

TEST_CASE("half a state before the shaking is refused, none is warned of when time has passed") {
  const Tables tables;
  const auto said = [&](const std::string& more) {
    tailrun::forget_warnings();
    tailrun::Provenance provenance;
    const auto path =
        tables.folder.write("half.json", R"({"nodes": "nodes.csv", "quads": "quads.csv", "node_state": "node_state.csv",
        "element_state": "element_state.csv", "regions": {"sand": {"density": 1900}, "clay": {"density": 1700}})" +
                                             more + "}");
    const std::string refusal =
        example::message_of<tailrun::InputError>([&] { import_tables(tailrun::CaseFile(path), provenance); });
    std::string all;
    for (const auto& warning : tailrun::warnings()) all += warning;
    tailrun::forget_warnings();
    return refusal.empty() ? all : "error: " + refusal;
  };
  const std::string nodes = R"(, "initial_node_state": "nodes_before.csv")",
                    elements = R"(, "initial_element_state": "elements_before.csv")";
  CHECK(said(nodes + elements + R"(, "time": 3)") == "");
  CHECK(said("") == "");
  CHECK(said(R"(, "time": 3)").find("counts as the one before the shaking, so that r_u is 0") != std::string::npos);
  CHECK(said(elements).find("/initial_node_state: missing, while 'initial_element_state' is given") !=
        std::string::npos);
  CHECK(said(nodes).starts_with("error: "));
}

TEST_CASE("a phreatic line whose x descend, water's density and gravity in other units") {
  const auto refused = [](const std::string& more) {
    return example::message_of<tailrun::InputError>([&] { Tables().snapshot(more); });
  };
  CHECK(refused(R"(, "phreatic_line": [[2, 1], [0, 1]])").find("x must ascend") != std::string::npos);
  CHECK(refused(R"(, "fluid_density": 1)").find("/fluid_density: found 1 kg/m3") != std::string::npos);
  CHECK(refused(R"(, "gravity": -9.81)").find("upwards") != std::string::npos);
}

TEST_CASE("tables that are none, and what their first line lacks") {
  const auto message = [](const char* name, const std::string& text) {
    const Tables tables;
    tables.folder.write(name, text);
    return example::message_of<tailrun::InputError>([&] { tables.snapshot(); });
  };
  CHECK(
      message("nodes.csv", "11,0,0,base\n12,1,0,base\n").find("line 1: found a number ('11,0,0,base'), but a header") !=
      std::string::npos);
  CHECK(message("nodes.csv", "node;x;y\n11;0;0\n").find("separated by semicolons") != std::string::npos);
  CHECK(message("nodes.csv", "\x89HDF\r\n\x1a\n").find("found an HDF5 file, but a table (CSV)") != std::string::npos);
  CHECK(message("quads.csv", "element,n1,n2,n3,n4,region\n5,11,12,15,15,sand\n6,12,13,16,15,clay\n")
            .find("line 2, column 'n4': node 15 is n3 already") != std::string::npos);
  CHECK(message("nodes.csv", "node,x,y,lines\n11,0,0,a/b\n12,1,0,\n13,2,0,\n14,0,1,\n15,1,1,\n16,2,1,\n")
            .find("column 'lines': the name \"a/b\" of a line has a slash") != std::string::npos);
}

TEST_CASE("lines that end with CR alone are read") {
  const Tables tables;
  tables.folder.write("nodes_before.csv", "node,p_kPa\r11,10\r12,10\r13,10\r14,0\r15,0\r16,0\r");
  CHECK(tables.snapshot().excess_pore_pressure[0] == doctest::Approx(3e3));
}
