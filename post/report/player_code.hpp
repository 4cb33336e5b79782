// How report.html holds the bodies of the frames that it plays: places and orientations as whole numbers.
//
// A body of a frame takes 24 bytes: three coordinates of 24 bits within the box of all frames, an orientation as the three smallest
// components of its quaternion with 15 bits each, three components of its velocity as the upper 24 bits of float32; with heat 16 bits of
// temperature and with contacts 16 bits of their number in addition. Numbers are little-endian. 16 bits for a coordinate would do for a
// packing, but not for a run whose bodies fall 100 m out of it, since the box holds them too.
#pragma once

#include <array>
#include <cstdint>

#include "core/storage/scene_file.hpp"

namespace scree {

/// Of the packed frames of a page [bytes]; a third more as text. A page with so many is still opened within seconds and sent by mail.
inline constexpr std::size_t kPlayerLimit = 15000000;

/// A packed frame.
/// in   table    bodies of all frames: a frame without some of them has a bit for each
/// in   moving   walls that move
std::size_t packed_size(const Scene& scene, std::size_t bodies, std::size_t table, std::size_t moving);

/// Whole numbers of 24 bits for places in a box.
struct PlaceCode {
  Vec3 lower;  ///< of the box [m]
  Vec3 step;   ///< [m]
  static PlaceCode of(const Box3& box);
  std::array<std::uint32_t, 3> code(const Vec3& position) const;
  Vec3 place(const std::array<std::uint32_t, 3>& code) const;
};

/// A unit quaternion as its three smallest components in steps of sqrt(2) / 32767; the index of the largest, which is made positive, is in
/// the upper bits of the first two words.
std::array<std::uint16_t, 3> turn_code(const Quat& orientation);
Quat turn_of(const std::array<std::uint16_t, 3>& code);

}  // namespace scree
