// Cuts weighted bodies into parts, by Zoltan, behind one small interface.
#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/partition/cut_boxes.hpp"

namespace scree {

/// How bodies are shared out. Measured side by side in docs/results/scaling.md; the default is the first.
enum class CutMethod {
  rcb,   ///< recursive coordinate bisection: boxes
  rib,   ///< recursive inertial bisection: planes across the longest principal axis
  hsfc,  ///< runs of a Hilbert curve through an octree
  body,  ///< runs of ids, wherever the bodies are: the seed's way, for comparison
};
const std::vector<std::string>& cut_method_names();
std::string cut_method_name(CutMethod method);
/// Throws UsageError that names the nearest method.
CutMethod cut_method_of(const std::string& name);

/// Cuts points into as many parts as `parts` says. Collective over the communicator; every rank gives its own
/// points (possibly none). Cut directions are locked and cuts kept, so that a small motion of the points moves
/// few of them. Every rank receives the whole cut, in an order that is a function of the geometry only (the same
/// for any number of ranks that call).
class Partitioner {
 public:
  explicit Partitioner(MPI_Comm communicator, int parts, CutMethod method = CutMethod::rcb);
  ~Partitioner();
  Partitioner(const Partitioner&) = delete;
  Partitioner& operator=(const Partitioner&) = delete;

  /// in   ids       global, unique
  /// in   points    [m]
  /// in   weights   predicted or measured work, > 0
  /// out  boxes     of the parts for rcb, and for rib and hsfc where so few points are cut by boxes; else none
  /// Throws SystemError when Zoltan fails.
  CutBoxes cut(std::span<const std::int64_t> ids, std::span<const Vec3> points, std::span<const double> weights);

  /// Part of a body by the last cut, the same on every rank.
  /// Cost: O(parts) for boxes, O(log parts) else.   Threads: one at a time.
  int part_of(std::int64_t id, const Vec3& point) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace scree
