#pragma once

#include <cmath>

#include "render/base/host_device.h"

namespace gladstone::inline base {

/// Vector of two components, in the units of its user. Trivially copyable for use in device code.
template <class T>
struct Vec2 {
  T x{};
  T y{};

  GLADSTONE_HD friend constexpr bool operator==(Vec2 const& a, Vec2 const& b) { return a.x == b.x && a.y == b.y; }
  GLADSTONE_HD friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  GLADSTONE_HD friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  GLADSTONE_HD friend constexpr Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
  GLADSTONE_HD friend constexpr Vec2 operator*(T s, Vec2 a) { return {s * a.x, s * a.y}; }
  GLADSTONE_HD friend constexpr Vec2 operator*(Vec2 a, T s) { return {s * a.x, s * a.y}; }
  GLADSTONE_HD friend constexpr Vec2 operator/(Vec2 a, T s) { return {a.x / s, a.y / s}; }
  GLADSTONE_HD constexpr Vec2& operator+=(Vec2 b) { return *this = *this + b; }
  GLADSTONE_HD constexpr Vec2& operator-=(Vec2 b) { return *this = *this - b; }
  GLADSTONE_HD constexpr Vec2& operator*=(T s) { return *this = s * *this; }
};

/// Vector of three components in the world frame: X right and Y up as seen by the camera, Z towards the camera.
template <class T>
struct Vec3 {
  T x{};
  T y{};
  T z{};

  GLADSTONE_HD constexpr T& operator[](int axis) { return axis == 0 ? x : (axis == 1 ? y : z); }
  GLADSTONE_HD constexpr T const& operator[](int axis) const { return axis == 0 ? x : (axis == 1 ? y : z); }
  GLADSTONE_HD friend constexpr bool operator==(Vec3 const& a, Vec3 const& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
  GLADSTONE_HD friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  GLADSTONE_HD friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  GLADSTONE_HD friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  GLADSTONE_HD friend constexpr Vec3 operator*(T s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  GLADSTONE_HD friend constexpr Vec3 operator*(Vec3 a, T s) { return {s * a.x, s * a.y, s * a.z}; }
  GLADSTONE_HD friend constexpr Vec3 operator/(Vec3 a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  GLADSTONE_HD constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  GLADSTONE_HD constexpr Vec3& operator-=(Vec3 b) { return *this = *this - b; }
  GLADSTONE_HD constexpr Vec3& operator*=(T s) { return *this = s * *this; }
};

template <class T>
GLADSTONE_HD constexpr T dot(Vec2<T> a, Vec2<T> b) {
  return a.x * b.x + a.y * b.y;
}

template <class T>
GLADSTONE_HD constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class V>
GLADSTONE_HD auto length(V a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

template <class T>
GLADSTONE_HD Vec3<T> normalized(Vec3<T> a) {
  return a / length(a);
}

using Vec2d = Vec2<double>;
using Vec3d = Vec3<double>;

inline bool is_finite(Vec2d a) { return std::isfinite(a.x) && std::isfinite(a.y); }

}  // namespace gladstone::inline base
