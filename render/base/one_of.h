#pragma once

#include <new>
#include <type_traits>
#include <variant>

#include "render/base/host_device.h"

namespace gladstone {

/// A closed set of types, one of them held at a time: what a list of optical elements is made of. Trivially copyable
/// ones, unlike those of a std::variant, can be handed to a device, and visiting is a chain of comparisons that a
/// compiler sees through.
template <class First, class... Rest>
class OneOf {
 public:
  OneOf() = default;
  template <class Held>
  requires(std::is_same_v<Held, First> || (std::is_same_v<Held, Rest> || ...)) GLADSTONE_HD OneOf(Held const& held)
      : which_(index_of<Held>()) {
    new (&storage_) Held(held);
  }

  /// Calls visitor(held) and returns what it returns; all alternatives give the same type.
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

/// The same for types of a host's scalar, such as a ceres::Jet, which no device takes.
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

}  // namespace gladstone
