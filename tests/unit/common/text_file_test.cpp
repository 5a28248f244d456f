// Text of others: every way to end a line is read, and what is no text is refused as what it is.
#include "common/text_file.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "common/error.hpp"

using namespace tailrun;
using doctest::Contains;

namespace {

std::vector<std::string> lines_of(const std::string& bytes) {
  const auto path = std::filesystem::temp_directory_path() / "tailrun_text_file.csv";
  std::ofstream(path, std::ios::binary) << bytes;
  return read_lines(path, "a table");
}

}  // namespace

TEST_CASE("lines end with LF, CR LF or CR, the last one with nothing at all") {
  const std::vector<std::string> wanted = {"a,b", "", "1,2"};
  for (const char* text : {"a,b\n\n1,2\n", "a,b\r\n\r\n1,2\r\n", "a,b\r\r1,2\r",
                           "\xEF\xBB\xBF"
                           "a,b\n\n1,2"})
    CHECK(lines_of(text) == wanted);
}

TEST_CASE("what is no text is named") {
  CHECK_THROWS_WITH_AS(lines_of("\x89HDF\r\n\x1a\n"
                                "rest"),
                       Contains("found an HDF5 file, but a table in plain text"), InputError);
  CHECK_THROWS_WITH_AS(lines_of("PK\x03\x04"
                                "rest"),
                       Contains("plain text is required here; save it as CSV"), InputError);
  CHECK_THROWS_WITH_AS(lines_of(std::string("\xFF\xFE"
                                            "a\0",
                                            4)),
                       Contains("UTF-16"), InputError);
  CHECK_THROWS_WITH_AS(lines_of(std::string("a,b\n\0", 5)), Contains("a binary file (byte 4 is 0)"), InputError);
  CHECK_THROWS_WITH_AS(lines_of(""), Contains("empty, but a table is required"), InputError);
  CHECK_THROWS_WITH_AS(read_lines(std::filesystem::temp_directory_path(), "a table"), Contains("is a folder"),
                       InputError);
}
