// The hash of one item of a state. The state hash is the sum of all of them, modulo 2^64: no order of bodies, pairs or ranks enters.
#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>

#include "core/geometry/vec3.hpp"
#include "core/storage/checksum.hpp"

namespace scree {

struct ItemHash {
  std::uint64_t a = 1, b = 2;
  void add(std::uint64_t bits) {
    a = mix(a ^ bits);
    b = mix(b + bits);
  }
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  template <std::integral Value>
  void add(Value value) {
    add(static_cast<std::uint64_t>(value));
  }
  void add(const Vec3& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  void add(const Quat& q) {
    add(q.w);
    add(Vec3{q.x, q.y, q.z});
  }
};

}  // namespace scree
