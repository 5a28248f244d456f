// A place for the numbers that only one law knows: what it read beside the parameters that laws share, and the
// constants that it makes of them. Material and MaterialConstants have one each, so that a new law adds no member to
// either.
#pragma once

#include <cstddef>
#include <cstring>
#include <type_traits>

namespace tailrun::mpm {

class OwnNumbers {
 public:
  // A law keeps one plain struct here, and reads back the same one. All bits zero before the first set.
  template <class T>
  void set(const T& numbers) {
    check<T>();
    std::memcpy(bytes_, &numbers, sizeof(T));
  }
  template <class T>
  T get() const {
    check<T>();
    T numbers;
    std::memcpy(&numbers, bytes_, sizeof(T));
    return numbers;
  }

 private:
  template <class T>
  static void check() {
    static_assert(std::is_trivially_copyable_v<T> && sizeof(T) <= sizeof(bytes_), "a plain struct of up to 16 doubles");
  }

  alignas(double) std::byte bytes_[16 * sizeof(double)] = {};
};

}  // namespace tailrun::mpm
