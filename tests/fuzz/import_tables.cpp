// Tables of another program's state. The input is import.json and its CSV files, one after the other: a line "=== name"
// begins each.
#include "transfer_tool/import/import_tables.hpp"

#include <fstream>

#include "tests/fuzz/fuzz_target.hpp"

FUZZ_TARGET(import_tables, "tables", path) {
  const auto folder = path.parent_path() / "tables_of_one_input";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::ifstream all(path, std::ios::binary);
  std::ofstream table(folder / "import.json", std::ios::binary);
  for (std::string line; std::getline(all, line);) {
    if (line.starts_with("=== ") && line.find('/') == std::string::npos && line.size() > 4 && line.size() < 40) {
      table.close();
      table.open(folder / line.substr(4), std::ios::binary);
    } else {
      table << line << '\n';
    }
  }
  table.close();
  tailrun::Provenance provenance;
  tailrun::transfer::import_tables(tailrun::CaseFile(folder / "import.json"), provenance);
}
