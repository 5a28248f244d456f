// Names that a table or an HDF5 file would take for something else.
#include "common/plain_names.hpp"

#include <doctest/doctest.h>

using namespace tailrun;

TEST_CASE("names of columns: no comma, quote or line break, no blank at an end") {
  for (const char* name : {"crest", "upstream toe", "depth_2.5", "B\xC3\xB6schung", "a/b"})
    CHECK_MESSAGE(fault_as_column(name) == "", name);
  for (const char* name : {"a,b", "a\"b", "a\nb", "a\rb", "", " a", "a ", "B\xF6schung"})
    CHECK_MESSAGE(fault_as_column(name) != "", name);
}

TEST_CASE("names of datasets: no slash, no dot alone") {
  for (const char* name : {"bed", "free field", "a.b", "a,b"}) CHECK_MESSAGE(fault_as_dataset(name) == "", name);
  for (const char* name : {"a/b", ".", "", "a\nb", "B\xF6schung"}) CHECK_MESSAGE(fault_as_dataset(name) != "", name);
}

TEST_CASE("control characters are written out in messages, what is not UTF-8 is marked") {
  CHECK(shown_name("a\nb") == "\"a\\nb\"");
  CHECK(shown_name("B\xF6schung") == "\"B\xEF\xBF\xBDschung\"");
}
