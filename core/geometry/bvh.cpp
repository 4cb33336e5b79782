#include "core/geometry/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scree {
namespace {

/// Above this many triangles a median serves: the top of a large tree matters little.
constexpr std::int32_t kSweepLimit = 4096;

/// Cost of visiting a leaf in units of visiting a node. From 0.5 to 2 the trees hardly differ.
constexpr double kLeafCost = 1;

// volatile: GCC 12 at -O3 was seen to drop a conversion to float and back
float to_nearest(double x) {
  const volatile float rounded = static_cast<float>(x);
  return rounded;
}
float round_down(double x) {
  const float f = to_nearest(x);
  return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity()) : f;
}
float round_up(double x) {
  const float f = to_nearest(x);
  return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

double half_area(const Box3& box) {
  const Vec3 e = box.extent();
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

/// A node of the binary tree that is collapsed afterwards.
struct BinaryNode {
  Box3 box;
  std::int32_t begin = 0, end = 0, left = -1, right = -1;
};

/// Of a binary node: the least cost of standing for it by at most so many children of a wide node, how many are really
/// used, and how many of these stand for its left child.
struct Plan {
  std::array<double, kBvhWidth + 1> cost{};
  std::array<std::uint8_t, kBvhWidth + 1> roots{}, left_share{};  // left_share only where all roots are used
  std::uint8_t whole_share = 0;                                   // the same where the node becomes a wide node itself
};

class Builder {
 public:
  explicit Builder(const TriangleMesh& mesh) : mesh_(mesh) {
    const std::int32_t count = mesh.triangle_count();
    if (count == 0) return;
    Box3 whole;
    for (std::int32_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k) whole.add(mesh.corner(t, k));
    tree_.middle = whole.centre();
    boxes_.resize(static_cast<std::size_t>(count));
    order_.resize(static_cast<std::size_t>(count));
    for (std::int32_t t = 0; t < count; ++t) {
      for (int k = 0; k < 3; ++k) boxes_[static_cast<std::size_t>(t)].add(mesh.corner(t, k) - tree_.middle);
      order_[static_cast<std::size_t>(t)] = t;
    }
    split(0, count);
    plan();
    collapse(0);
    tree_.nodes.shrink_to_fit();
    tree_.leaves.shrink_to_fit();
    const Box3& root = binary_[0].box;
    for (int c = 0; c < 3; ++c) tree_.size = std::max({tree_.size, round_up(std::abs(root.lower[c])), round_up(std::abs(root.upper[c]))});
    double radius2 = 0;
    for (std::int32_t t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k) radius2 = std::max(radius2, squared_length(mesh.corner(t, k)));
    tree_.radius = std::nextafter(round_up(std::sqrt(radius2)), std::numeric_limits<float>::infinity());
  }
  Bvh take() { return std::move(tree_); }

 private:
  const Box3& box(std::int32_t position) const { return boxes_[static_cast<std::size_t>(order_[static_cast<std::size_t>(position)])]; }
  void sort_along(std::int32_t begin, std::int32_t end, int axis) {
    std::sort(order_.begin() + begin, order_.begin() + end, [&](std::int32_t s, std::int32_t t) {
      const double cs = boxes_[static_cast<std::size_t>(s)].centre()[axis], ct = boxes_[static_cast<std::size_t>(t)].centre()[axis];
      return cs != ct ? cs < ct : s < t;
    });
  }

  std::int32_t split(std::int32_t begin, std::int32_t end) {
    const auto index = static_cast<std::int32_t>(binary_.size());
    BinaryNode node;
    node.begin = begin;
    node.end = end;
    for (std::int32_t i = begin; i < end; ++i) node.box.add(box(i));
    binary_.push_back(node);
    if (end - begin <= kBvhWidth) return index;
    const std::int32_t middle = end - begin <= kSweepLimit ? sweep(begin, end) : median(begin, end);
    const std::int32_t left = split(begin, middle);
    const std::int32_t right = split(middle, end);
    binary_[static_cast<std::size_t>(index)].left = left;
    binary_[static_cast<std::size_t>(index)].right = right;
    return index;
  }

  std::int32_t median(std::int32_t begin, std::int32_t end) {
    Box3 centres;
    for (std::int32_t i = begin; i < end; ++i) centres.add(box(i).centre());
    const Vec3 e = centres.extent();
    const int axis = e.x >= e.y && e.x >= e.z ? 0 : (e.y >= e.z ? 1 : 2);
    const std::int32_t half = begin + (end - begin) / (2 * kBvhWidth) * kBvhWidth;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](std::int32_t s, std::int32_t t) {
      const double cs = boxes_[static_cast<std::size_t>(s)].centre()[axis], ct = boxes_[static_cast<std::size_t>(t)].centre()[axis];
      return cs != ct ? cs < ct : s < t;
    });
    return half;
  }

  /// Least sum of area times leaves over all cuts at multiples of 8 on the three axes.
  std::int32_t sweep(std::int32_t begin, std::int32_t end) {
    const std::int32_t count = end - begin;
    double least = std::numeric_limits<double>::infinity();
    int best_axis = 0;
    std::int32_t best_cut = begin + kBvhWidth;
    std::vector<double> above(static_cast<std::size_t>(count));
    for (int axis = 0; axis < 3; ++axis) {
      sort_along(begin, end, axis);
      Box3 grown;
      for (std::int32_t i = end - 1; i > begin; --i) {
        grown.add(box(i));
        above[static_cast<std::size_t>(i - begin)] = half_area(grown);
      }
      grown = {};
      for (std::int32_t i = begin; i < end; ++i) {
        const std::int32_t left = i - begin;
        if (left > 0 && left % kBvhWidth == 0) {
          const double cost = half_area(grown) * left + above[static_cast<std::size_t>(left)] * (count - left);
          if (cost < least) {
            least = cost;
            best_axis = axis;
            best_cut = i;
          }
        }
        grown.add(box(i));
      }
    }
    if (best_axis != 2) sort_along(begin, end, best_axis);
    return best_cut;
  }

  /// Least costs of making each binary node into 1 to 8 children of a wide one.
  void plan() {
    plan_.resize(binary_.size());
    for (std::size_t n = binary_.size(); n-- > 0;) {  // children come after their parents
      const BinaryNode& node = binary_[n];
      Plan& plan = plan_[n];
      const double area = half_area(node.box);
      if (node.left < 0) {
        plan.cost.fill(kLeafCost * area);
        plan.roots.fill(1);
        continue;
      }
      const Plan &left = plan_[static_cast<std::size_t>(node.left)], &right = plan_[static_cast<std::size_t>(node.right)];
      for (std::size_t roots = 2; roots <= kBvhWidth; ++roots) {
        plan.cost[roots] = std::numeric_limits<double>::infinity();
        for (std::size_t k = 1; k < roots; ++k) {
          const double cost = left.cost[k] + right.cost[roots - k];
          if (cost < plan.cost[roots]) {
            plan.cost[roots] = cost;
            plan.left_share[roots] = static_cast<std::uint8_t>(k);
          }
        }
      }
      plan.whole_share = plan.left_share[kBvhWidth];
      // one root: a node of its own; and a node may stay whole where several roots are allowed
      plan.cost[1] = area + plan.cost[kBvhWidth];
      plan.roots[1] = 1;
      for (std::size_t roots = 2; roots <= kBvhWidth; ++roots) {
        const bool fewer = plan.cost[roots - 1] <= plan.cost[roots];
        if (fewer) plan.cost[roots] = plan.cost[roots - 1];
        plan.roots[roots] = fewer ? plan.roots[roots - 1] : static_cast<std::uint8_t>(roots);
      }
    }
  }

  /// Binary nodes that stand for a node which may have so many roots.
  void gather_children(std::int32_t index, std::size_t roots, std::vector<std::int32_t>& children) const {
    const BinaryNode& node = binary_[static_cast<std::size_t>(index)];
    const Plan& plan = plan_[static_cast<std::size_t>(index)];
    roots = plan.roots[roots];
    if (roots == 1) {
      children.push_back(index);
      return;
    }
    gather_children(node.left, plan.left_share[roots], children);
    gather_children(node.right, roots - plan.left_share[roots], children);
  }

  /// Makes a wide node of a binary one and returns its index.
  std::int32_t collapse(std::int32_t root) {
    std::vector<std::int32_t> children;
    const BinaryNode& top = binary_[static_cast<std::size_t>(root)];
    if (top.left < 0) {
      children.push_back(root);
    } else {
      const std::size_t share = plan_[static_cast<std::size_t>(root)].whole_share;
      gather_children(top.left, share, children);
      gather_children(top.right, kBvhWidth - share, children);
    }
    const std::size_t index = tree_.nodes.size();
    tree_.nodes.emplace_back();
    BvhNode node;
    node.count = static_cast<std::int32_t>(children.size());
    for (std::size_t slot = 0; slot < static_cast<std::size_t>(kBvhWidth); ++slot) {
      const std::size_t k = slot < children.size() ? slot : 0;
      const BinaryNode& child = binary_[static_cast<std::size_t>(children[k])];
      for (int c = 0; c < 3; ++c) {
        node.lower[c][slot] = round_down(child.box.lower[c]);
        node.upper[c][slot] = round_up(child.box.upper[c]);
      }
      if (slot >= children.size()) {
        node.child[slot] = node.child[0];
      } else {
        node.child[slot] = child.left >= 0 ? collapse(children[k]) : ~add_leaf(child);
      }
    }
    tree_.nodes[index] = node;
    return static_cast<std::int32_t>(index);
  }

  std::int32_t add_leaf(const BinaryNode& node) {
    BvhLeaf leaf;
    leaf.count = node.end - node.begin;
    for (std::int32_t slot = 0; slot < kBvhWidth; ++slot) {
      const std::int32_t t = order_[static_cast<std::size_t>(slot < leaf.count ? node.begin + slot : node.begin)];
      leaf.triangle[slot] = t;
      for (int k = 0; k < 9; ++k) leaf.corner[k][slot] = to_nearest((mesh_.corner(t, k / 3) - tree_.middle)[k % 3]);
    }
    tree_.leaves.push_back(leaf);
    return static_cast<std::int32_t>(tree_.leaves.size()) - 1;
  }

  const TriangleMesh& mesh_;
  std::vector<Box3> boxes_;
  std::vector<std::int32_t> order_;
  std::vector<BinaryNode> binary_;
  std::vector<Plan> plan_;
  Bvh tree_;
};

}  // namespace

Bvh build_bvh(const TriangleMesh& mesh) { return Builder(mesh).take(); }

}  // namespace scree
