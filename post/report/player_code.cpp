#include "post/report/player_code.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scree {

namespace {

constexpr std::uint32_t kPlaceSteps = (1U << 24) - 1;
constexpr double kTurnSteps = 32767;                    // 15 bits
constexpr double kTurnReach = std::numbers::sqrt2 / 2;  // no component but the largest is greater
constexpr std::size_t kPlaceBytes = 9, kTurnBytes = 6, kVelocityBytes = 9, kHeatBytes = 2, kContactBytes = 2;

}  // namespace

std::size_t packed_size(const Scene& scene, std::size_t bodies, std::size_t table, std::size_t moving) {
  const std::size_t body = kPlaceBytes + kTurnBytes + kVelocityBytes + (scene.settings.heat ? kHeatBytes : 0) +
                           (scene.settings.output_contacts ? kContactBytes : 0);
  return bodies * body + (bodies < table ? (table + 7) / 8 : 0) + moving * 7 * sizeof(double);
}

PlaceCode PlaceCode::of(const Box3& box) {
  if (box.is_empty()) return {};
  return {box.lower, (1.0 / kPlaceSteps) * box.extent()};
}

std::array<std::uint32_t, 3> PlaceCode::code(const Vec3& position) const {
  std::array<std::uint32_t, 3> code{};
  for (int k = 0; k < 3; ++k) {
    const double along = step[k] > 0 ? std::round((position[k] - lower[k]) / step[k]) : 0;
    code[static_cast<std::size_t>(k)] = static_cast<std::uint32_t>(std::clamp(along, 0.0, static_cast<double>(kPlaceSteps)));
  }
  return code;
}

Vec3 PlaceCode::place(const std::array<std::uint32_t, 3>& code) const {
  return {lower.x + code[0] * step.x, lower.y + code[1] * step.y, lower.z + code[2] * step.z};
}

std::array<std::uint16_t, 3> turn_code(const Quat& q) {
  const std::array<double, 4> all{q.x, q.y, q.z, q.w};
  const auto largest = static_cast<std::size_t>(
      std::max_element(all.begin(), all.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) - all.begin());
  const double sign = all[largest] < 0 ? -1 : 1;
  std::array<std::uint16_t, 3> code{};
  std::size_t next = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == largest) continue;
    const double share = (sign * all[k] + kTurnReach) / (2 * kTurnReach);
    code[next++] = static_cast<std::uint16_t>(std::clamp(std::round(share * kTurnSteps), 0.0, kTurnSteps));
  }
  code[0] = static_cast<std::uint16_t>(code[0] | (largest & 1U) << 15);
  code[1] = static_cast<std::uint16_t>(code[1] | (largest >> 1) << 15);
  return code;
}

Quat turn_of(const std::array<std::uint16_t, 3>& code) {
  const std::size_t largest = (code[0] >> 15) + 2U * (code[1] >> 15);
  std::array<double, 4> all{};
  double rest = 1;
  std::size_t next = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (k == largest) continue;
    all[k] = 2 * kTurnReach * (code[next++] & 0x7fffU) / kTurnSteps - kTurnReach;
    rest -= all[k] * all[k];
  }
  all[largest] = std::sqrt(std::max(0.0, rest));
  return normalised(Quat{all[3], all[0], all[1], all[2]});
}

}  // namespace scree
