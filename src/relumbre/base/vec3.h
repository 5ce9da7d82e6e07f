/// Three-component vectors: points, directions and RGB triples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "relumbre/base/host_device.h"

namespace relumbre {

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr explicit Vec3(T v) : x(v), y(v), z(v) {}
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  template <class S>
  constexpr explicit Vec3(const Vec3<S>& o)
      : x(static_cast<T>(o.x)), y(static_cast<T>(o.y)), z(static_cast<T>(o.z)) {}

  constexpr T& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr const T& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }

  constexpr Vec3& operator+=(const Vec3& b) { return x += b.x, y += b.y, z += b.z, *this; }
  constexpr Vec3& operator-=(const Vec3& b) { return x -= b.x, y -= b.y, z -= b.z, *this; }
  constexpr Vec3& operator*=(const Vec3& b) { return x *= b.x, y *= b.y, z *= b.z, *this; }
  constexpr Vec3& operator*=(T s) { return x *= s, y *= s, z *= s, *this; }
  constexpr Vec3& operator/=(T s) { return x /= s, y /= s, z /= s, *this; }

  friend constexpr Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend constexpr Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend constexpr Vec3 operator*(Vec3 a, const Vec3& b) { return a *= b; }
  friend constexpr Vec3 operator*(Vec3 a, T s) { return a *= s; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return a *= s; }
  friend constexpr Vec3 operator/(Vec3 a, T s) { return a /= s; }
  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
/// Linear RGB, Rec. 709 primaries.
using Rgb = Vec3<float>;

struct Vec2f {
  float x{}, y{};
  friend constexpr Vec2f operator+(Vec2f a, Vec2f b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2f operator*(Vec2f a, float s) { return {a.x * s, a.y * s}; }
  friend constexpr bool operator==(const Vec2f&, const Vec2f&) = default;
};

/// Vertex indices of a triangle.
using Index3 = std::array<std::uint32_t, 3>;

template <class T>
constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
RELUMBRE_HOST_DEVICE T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}
/// a / |a|, or a itself where it has no length.
template <class T>
RELUMBRE_HOST_DEVICE Vec3<T> normalized(const Vec3<T>& a) {
  const T l = length(a);
  return l > T{} ? a / l : a;
}
template <class T>
constexpr Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class T>
constexpr Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <class T>
constexpr T max_component(const Vec3<T>& a) {
  return std::max(a.x, std::max(a.y, a.z));
}
template <class T>
RELUMBRE_HOST_DEVICE bool is_finite(const Vec3<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
/// Rec. 709 luminance of a linear RGB triple.
template <class T>
constexpr T luminance(const Vec3<T>& c) {
  return T(0.2126) * c.x + T(0.7152) * c.y + T(0.0722) * c.z;
}

/// Two unit vectors that make (t, b, n) a right-handed orthonormal frame. n must have unit length.
/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
struct Frame {
  Vec3f t, b, n;
  RELUMBRE_HOST_DEVICE explicit Frame(const Vec3f& normal) : n(normal) {
    const float sign = std::copysign(1.0F, n.z);
    const float a = -1.0F / (sign + n.z);
    const float c = n.x * n.y * a;
    t = {1.0F + sign * n.x * n.x * a, sign * c, -sign * n.x};
    b = {c, sign + n.y * n.y * a, -n.y};
  }
  [[nodiscard]] RELUMBRE_HOST_DEVICE Vec3f to_world(const Vec3f& v) const { return t * v.x + b * v.y + n * v.z; }
};

}  // namespace relumbre
