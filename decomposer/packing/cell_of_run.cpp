#include "decomposer/packing/cell_of_run.hpp"

#include "core/base/error.hpp"

namespace scree {

namespace {

Box3 checked(const Vec3& lower, const Vec3& upper, const Vec3& shear, const Case& c) {
  if (!c.settings.cell)
    throw UsageError(
        "{}.run: the periodic cell of {} deforms, and its bodies fit into no other domain; add a table [cell], which may be empty",
        c.start->where, c.start->run);
  if (!(shear == Vec3{}))
    throw UsageError(
        "{}.run: the periodic cell of {} is sheared by yz {:g}, xz {:g}, xy {:g} m, and a run begins in a box; give a frame from before "
        "the "
        "shear, or go on with the run itself (--restart)",
        c.start->where, c.start->run, shear.x, shear.y, shear.z);
  Box3 box;
  box.add(lower);
  box.add(upper);
  return box;
}

}  // namespace

std::optional<Box3> cell_of(const Frame& frame, const Case& c) {
  if (frame.cell.size() == 0) return std::nullopt;
  return checked(frame.cell.lower[0], frame.cell.upper[0], frame.cell.shear[0], c);
}

std::optional<Box3> cell_of(const h5::Group& checkpoint, const Scene& scene, const Case& c) {
  if (!checkpoint.has("cell")) return std::nullopt;
  const Domain& domain = scene.settings.domain;  // it deforms about its middle
  const Vec3 half = 0.5 * checkpoint.open_group("cell").read_vectors("length").at(0), middle = 0.5 * (domain.lower + domain.upper);
  return checked(middle - half, middle + half, checkpoint.open_group("cell").read_vectors("shear").at(0), c);
}

}  // namespace scree
