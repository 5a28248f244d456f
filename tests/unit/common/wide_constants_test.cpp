#include <doctest/doctest.h>

#include <vector>

// g++ 12 with AVX-512 gets this wrong unless it is told to keep to vectors of four (CMakeLists.txt).
TEST_CASE("constants of eight numbers are what is written, whatever the width of the machine's vectors") {
  const std::vector<double> list{3000, 3000, 3000, 3000, 0, 0, 0, 0};
  for (std::size_t k = 0; k < list.size(); ++k) CHECK(list[k] == (k < 4 ? 3000.0 : 0.0));
}
