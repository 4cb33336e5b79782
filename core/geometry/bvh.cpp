#include "core/geometry/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scree {
namespace {

constexpr int kBinCount = 16;
/// From this depth on, nodes are cut in two equal halves, so that no tree is deeper than this + 31.
constexpr int kHeuristicDepth = 40;

// volatile: GCC 12 at -O3 was seen to drop a conversion to float and back
float round_down(double x) {
  const volatile float rounded = static_cast<float>(x);
  const float f = rounded;
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float round_up(double x) {
  const volatile float rounded = static_cast<float>(x);
  const float f = rounded;
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

/// Half of the surface area; what the chance of a hit is proportional to.
double half_area(const Box3& box) {
  if (box.is_empty()) return 0;
  const Vec3 e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

class Builder {
 public:
  explicit Builder(const TriangleMesh& mesh) {
    const auto count = static_cast<std::size_t>(mesh.triangle_count());
    boxes_.resize(count);
    tree_.order.resize(count);
    for (std::int32_t t = 0; t < mesh.triangle_count(); ++t) {
      for (int k = 0; k < 3; ++k) boxes_[static_cast<std::size_t>(t)].add(mesh.corner(t, k));
      tree_.order[static_cast<std::size_t>(t)] = t;
    }
    if (count == 0) return;
    tree_.nodes.reserve(count);
    build(0, mesh.triangle_count(), 0);
    tree_.nodes.shrink_to_fit();
  }
  Bvh take() { return std::move(tree_); }

 private:
  const Box3& box(std::int32_t position) const {
    return boxes_[static_cast<std::size_t>(tree_.order[static_cast<std::size_t>(position)])];
  }

  void build(std::int32_t begin, std::int32_t end, int depth) {
    Box3 bounds, centres;
    for (std::int32_t i = begin; i < end; ++i) {
      bounds.add(box(i));
      centres.add(box(i).centre());
    }
    const std::size_t index = tree_.nodes.size();
    BvhNode node{};
    for (int c = 0; c < 3; ++c) {
      node.lower[c] = round_down(bounds.lower[c]);
      node.upper[c] = round_up(bounds.upper[c]);
    }
    node.second_child = -1;
    node.first = begin;
    node.count = end - begin;
    tree_.nodes.push_back(node);
    if (end - begin <= kBvhLeafSize) return;
    const std::int32_t middle = split(begin, end, centres, depth);
    build(begin, middle, depth + 1);
    tree_.nodes[index].second_child = static_cast<std::int32_t>(tree_.nodes.size());
    tree_.nodes[index].count = 0;
    build(middle, end, depth + 1);
  }

  /// Reorders begin..end and returns where the second half starts; both halves have something.
  std::int32_t split(std::int32_t begin, std::int32_t end, const Box3& centres, int depth) {
    const auto at = [&](std::int32_t i) { return tree_.order.begin() + i; };
    const std::int32_t half = begin + (end - begin) / 2;
    const Vec3 extent = centres.extent();
    const int longest = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
    if (!(extent[longest] > 0)) return half;
    const auto halve = [&] {
      std::nth_element(at(begin), at(half), at(end), [&](std::int32_t s, std::int32_t t) {
        const double cs = boxes_[static_cast<std::size_t>(s)].centre()[longest],
                     ct = boxes_[static_cast<std::size_t>(t)].centre()[longest];
        return cs != ct ? cs < ct : s < t;
      });
      return half;
    };
    if (depth >= kHeuristicDepth) return halve();

    // least sum of area times count over the cuts between bins, on the three axes
    double least = std::numeric_limits<double>::infinity();
    int best_axis = -1, best_cut = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0)) continue;
      std::array<Box3, kBinCount> bin_box;
      std::array<std::int32_t, kBinCount> bin_count{};
      for (std::int32_t i = begin; i < end; ++i) {
        const auto b = static_cast<std::size_t>(bin_of(box(i), centres, axis));
        bin_box[b].add(box(i));
        ++bin_count[b];
      }
      std::array<double, kBinCount> cost_above{};
      Box3 grown;
      std::int32_t count = 0;
      for (std::size_t b = kBinCount - 1; b > 0; --b) {
        grown.add(bin_box[b]);
        count += bin_count[b];
        cost_above[b] = half_area(grown) * count;
      }
      grown = {};
      count = 0;
      for (std::size_t b = 1; b < kBinCount; ++b) {
        grown.add(bin_box[b - 1]);
        count += bin_count[b - 1];
        if (count == 0 || count == end - begin) continue;
        const double cost = half_area(grown) * count + cost_above[b];
        if (cost < least) {
          least = cost;
          best_axis = axis;
          best_cut = static_cast<int>(b);
        }
      }
    }
    if (best_axis < 0) return halve();
    const auto middle = std::stable_partition(at(begin), at(end), [&](std::int32_t t) {
      return bin_of(boxes_[static_cast<std::size_t>(t)], centres, best_axis) < best_cut;
    });
    return static_cast<std::int32_t>(middle - tree_.order.begin());
  }

  static int bin_of(const Box3& b, const Box3& centres, int axis) {
    const double where = (b.centre()[axis] - centres.lower[axis]) / (centres.upper[axis] - centres.lower[axis]);
    return std::clamp(static_cast<int>(where * kBinCount), 0, kBinCount - 1);
  }

  std::vector<Box3> boxes_;
  Bvh tree_;
};

}  // namespace

Bvh build_bvh(const TriangleMesh& mesh) {
  Bvh tree = Builder(mesh).take();
  tree.wide = build_wide_bvh(mesh);
  return tree;
}

}  // namespace scree
