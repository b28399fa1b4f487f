#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace gladstone {

/// Leaves new numbers as the memory has them.
template <class T>
struct UnsetAllocator : std::allocator<T> {
  template <class Other>
  struct rebind {
    using other = UnsetAllocator<Other>;
  };
  template <class Other>
  void construct(Other* at) {
    ::new (static_cast<void*>(at)) Other;
  }
  template <class Other, class... Values>
  void construct(Other* at, Values&&... values) {
    std::construct_at(at, std::forward<Values>(values)...);
  }
};

/// A vector whose resize() sets nothing: for many numbers that threads write right afterwards.
template <class T>
using UnsetVector = std::vector<T, UnsetAllocator<T>>;

}  // namespace gladstone
