#include "decomposer/packing/cell_of_run.hpp"

#include "core/base/error.hpp"

namespace scree {

namespace {

CellOfRun checked(const Vec3& lower, const Vec3& upper, const Vec3& shear, const Case& c) {
  if (!c.settings.cell)
    throw UsageError(
        "{}.run: the periodic cell of {} deforms, and its bodies fit into no other domain; add a table [cell], which may be empty",
        c.start->where, c.start->run);
  const bool adds = !c.start->goes_on && !(c.bodies.empty() && c.populations.empty());  // else the run has them
  if (!(shear == Vec3{}) && adds)
    throw UsageError(
        "{}.run: the periodic cell of {} is sheared by yz {:g}, xz {:g}, xy {:g} m; bodies and populations cannot be added to it: leave "
        "them "
        "out, or give a frame from before the shear",
        c.start->where, c.start->run, shear.x, shear.y, shear.z);
  CellOfRun cell;
  cell.box.add(lower);
  cell.box.add(upper);
  cell.shear = shear;
  return cell;
}

}  // namespace

std::optional<CellOfRun> cell_of(const Frame& frame, const Case& c) {
  if (frame.cell.size() == 0) return std::nullopt;
  return checked(frame.cell.lower[0], frame.cell.upper[0], frame.cell.shear[0], c);
}

std::optional<CellOfRun> cell_of(const h5::Group& checkpoint, const Scene& scene, const Case& c) {
  if (!checkpoint.has("cell")) return std::nullopt;
  const Domain& domain = scene.settings.domain;  // it deforms about its middle
  const Vec3 half = 0.5 * checkpoint.open_group("cell").read_vectors("length").at(0), middle = 0.5 * (domain.lower + domain.upper);
  const h5::Group cell = checkpoint.open_group("cell");
  return checked(middle - half, middle + half, cell.has("shear") ? cell.read_vectors("shear").at(0) : Vec3{}, c);
}

}  // namespace scree
