#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace gladstone::inline base {

/// Allocator that default-initialises new elements, so that numbers are left uninitialised.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
  template <class Other>
  struct rebind {
    using other = UninitializedAllocator<Other>;
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

/// Vector whose resize() does not initialise numbers: for large arrays that threads fill right afterwards.
template <class T>
using UninitializedVector = std::vector<T, UninitializedAllocator<T>>;

}  // namespace gladstone::inline base
