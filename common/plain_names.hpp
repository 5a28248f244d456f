// Names that users give and that become parts of files: columns of a table, datasets of an HDF5 file. One that the
// file's format takes for something else would break the file in silence, for whoever reads it next.
#pragma once

#include <string>

#include "common/case_file.hpp"

namespace tailrun {

// What keeps `name` from being part of a column's name in a CSV, or empty: no character at all, a comma, a double
// quote, a line break or another control character, a blank at its ends. Readers split the first line at commas.
std::string fault_as_column(const std::string& name);

// What keeps `name` from being a dataset's name in an HDF5 file, or empty: no character at all, a slash (the path of a
// group), a dot alone (this group), a control character.
std::string fault_as_dataset(const std::string& name);

// The same for a name in the case file; `key` may be empty. `use` goes on after "the name ... is part of". Throws
// InputError.
void require_column_name(const CaseNode& node, const std::string& key, const std::string& name, const std::string& use);
void require_dataset_name(const CaseNode& node, const std::string& key, const std::string& name,
                          const std::string& use);

// For messages: quoted, with its control characters written out.
std::string shown_name(const std::string& name);

}  // namespace tailrun
