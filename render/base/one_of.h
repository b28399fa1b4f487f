#pragma once

#include <new>
#include <type_traits>
#include <variant>

#include "render/base/host_device.h"

namespace gladstone::inline base {

/// Variant over a closed set of types, for lists of optical elements. If all types are trivially copyable, so is OneOf
/// (unlike std::variant), which allows copies to a device; a visit is a chain of comparisons that the compiler can
/// inline.
template <class First, class... Rest>
class OneOf {
 public:
  OneOf() = default;
  template <class Held>
  requires(std::is_same_v<Held, First> || (std::is_same_v<Held, Rest> || ...)) GLADSTONE_HD OneOf(Held const& held)
      : which_(index_of<Held>()) {
    new (&storage_) Held(held);
  }

  /// Calls visitor(held) and returns its result, whose type must be the same for all alternatives.
  template <class Visitor>
  GLADSTONE_HD auto visit(Visitor&& visitor) const {
    return visit_from<0, First, Rest...>(visitor);
  }

 private:
  template <class Held>
  static constexpr int index_of() {
    constexpr bool same[] = {std::is_same_v<Held, First>, std::is_same_v<Held, Rest>...};
    int index = 0;
    while (!same[index]) ++index;
    return index;
  }
  template <int Index, class Held, class... Others, class Visitor>
  GLADSTONE_HD auto visit_from(Visitor& visitor) const {
    if constexpr (sizeof...(Others) == 0) {
      return visitor(*reinterpret_cast<Held const*>(&storage_));
    } else {
      if (which_ == Index) return visitor(*reinterpret_cast<Held const*>(&storage_));
      return visit_from<Index + 1, Others...>(visitor);
    }
  }
  static constexpr unsigned long largest() {
    unsigned long size = sizeof(First);
    ((size = sizeof(Rest) > size ? sizeof(Rest) : size), ...);
    return size;
  }

  alignas(16) unsigned char storage_[largest()]{};
  int which_ = 0;
};

/// Host-only specialisation for types that are not trivially copyable, e.g. those of scalar type ceres::Jet.
template <class First, class... Rest>
requires(!(std::is_trivially_copyable_v<First> && (std::is_trivially_copyable_v<Rest> && ...)))  //
    class OneOf<First, Rest...> {
 public:
  OneOf() = default;
  template <class Held>
  requires(std::is_same_v<Held, First> || (std::is_same_v<Held, Rest> || ...)) OneOf(Held const& held) : held_(held) {}

  template <class Visitor>
  auto visit(Visitor&& visitor) const {
    return std::visit(visitor, held_);
  }

 private:
  std::variant<First, Rest...> held_;
};

}  // namespace gladstone::inline base
