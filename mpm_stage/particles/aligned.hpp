// Vectors that start on a cache line, each on another one of its page: large arrays of one size would all start at the
// same place of a page, the two dozen columns of a particle would fall into one set of the first-level cache, which
// holds eight lines, and push each other out. Arrays of megabytes ask for large pages, of which a step touches far
// fewer.
#pragma once

#include <sys/mman.h>

#include <atomic>
#include <cstddef>
#include <cstring>
#include <new>
#include <vector>

namespace tailrun::mpm {

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(std::size_t n) {
    if (n > most) throw std::bad_array_new_length();
    // Thirteen lines from one array to the next: 64 lines of a page are visited before one comes again.
    static std::atomic<unsigned> next{0};
    const std::size_t shift = line * (1 + 13 * next++ % 64);
    const std::size_t bytes = n * sizeof(T) + shift;
    char* block = static_cast<char*>(::operator new (bytes, std::align_val_t{line}));
#ifdef MADV_HUGEPAGE
    if (bytes >= large) {
      // From the first whole page on; an advice, so a system without large pages may ignore it.
      const std::size_t page = 4096, skip = (page - reinterpret_cast<std::size_t>(block) % page) % page;
      ::madvise(block + skip, (bytes - skip) / page * page, MADV_HUGEPAGE);
    }
#endif
    std::memcpy(block + shift - sizeof block, &block, sizeof block);
    return reinterpret_cast<T*>(block + shift);
  }
  void deallocate(T* p, std::size_t) {
    char* block;
    std::memcpy(&block, reinterpret_cast<char*>(p) - sizeof block, sizeof block);
    ::operator delete (block, std::align_val_t{line});
  }
  template <class U>
  bool operator==(const CacheLineAllocator<U>&) const {
    return true;
  }

 private:
  static constexpr std::size_t most = std::size_t{1} << 40;              // entries
  static constexpr std::size_t line = 64, large = std::size_t{4} << 20;  // bytes
};

template <class T>
using AlignedVector = std::vector<T, CacheLineAllocator<T>>;

}  // namespace tailrun::mpm
