// Recursive coordinate bisection of weighted points, by Zoltan, behind one small interface.
#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry/vec3.hpp"

namespace scree {

/// Leaf boxes of a bisection: box r belongs to rank r. Outer sides are +-1e300.
struct CutBoxes {
  std::vector<Vec3> lower, upper;
  int rank_of(const Vec3& point) const;   ///< lower sides inclusive, so that every point has one owner
  /// Ranks whose box comes within `reach` of the given point box, ascending.
  void ranks_touching(const Vec3& box_lower, const Vec3& box_upper, std::vector<int>& ranks) const;
};

/// Cuts points into as many parts as `parts` says. Collective over the communicator; every rank gives its own
/// points (possibly none). Cut directions are locked and cuts kept, so that a small motion of the points moves
/// few of them. Every rank receives all boxes, in an order that is a function of the geometry only (the same
/// for any number of ranks that call).
class Partitioner {
 public:
  explicit Partitioner(MPI_Comm communicator, int parts);
  ~Partitioner();
  Partitioner(const Partitioner&) = delete;
  Partitioner& operator=(const Partitioner&) = delete;

  /// in   ids       global, unique
  /// in   points    [m]
  /// in   weights   predicted or measured work, > 0
  /// Throws SystemError when Zoltan fails.
  CutBoxes cut(std::span<const std::int64_t> ids, std::span<const Vec3> points, std::span<const double> weights);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Largest over mean of the weights per part.   1 when all weights are zero.
double imbalance(std::span<const double> work_per_part);

}  // namespace scree
