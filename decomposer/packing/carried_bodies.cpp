// The part of the packer that takes bodies over from a run ([start]). They lie as they lay there, pressed as they were; what is checked is
// what this case does otherwise: its domain, walls that the run did not have where they are here, and a wider margin.
#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/units.hpp"
#include "core/storage/contact_limits.hpp"
#include "core/storage/domain_side.hpp"
#include "decomposer/packing/packer.hpp"

namespace scree {

bool Packer::is_fixed(std::size_t placed) const {
  if (is_carried(placed)) return parts_.carried->from.bodies[carried_number(placed)].fixed;
  return given_[placed] >= 0 && case_.bodies[static_cast<std::size_t>(given_[placed])].fixed;
}

std::string Packer::name_of(std::size_t placed) const {
  if (!is_carried(placed)) return case_.bodies[static_cast<std::size_t>(given_[placed])].where;
  const FromRun& from = parts_.carried->from;
  return from.name_of(from.bodies[carried_number(placed)].id);
}

void Packer::keep_standing() {
  for (std::size_t i = 0; parts_.carried && i < parts_.carried->placed.size(); ++i)
    keep(parts_.carried->placed[i], kFirstCarried - static_cast<std::int32_t>(i));
  for (const CaseBody& b : case_.bodies) keep({&parts_.shape(b.shape), b.scale, b.position, b.orientation});
}

std::string Packer::advice_on_margin() const {
  const double before = parts_.carried->from.scene.settings.margin;
  return fmt::format(
      "margins are wider here ({}) than in the run ({}): give contact.margin = {:g}, or let the bodies settle with this margin",
      format_quantity(scene_.settings.margin, Dimension::length), format_quantity(before, Dimension::length), before);
}

void Packer::check_carried_at_walls(std::size_t body, bool is_wider, std::vector<std::size_t>& touching) {
  const CarriedBodies& carried = *parts_.carried;
  PlacedBody pressed = carried.placed[body];
  if (!(gap() > 0) && pressed.is_sphere()) pressed.scale *= 1 - kPressedIn;
  const std::vector<Vec3> vertices = pressed.world_vertices();
  for (std::size_t i = 0; i < parts_.walls.size(); ++i) {
    if (carried.wall_partner[i] >= 0 && !is_wider) continue;
    const auto allows = [&](double distance) {
      return wall_allows(parts_.walls[i], &parts_.wall_bodies[i], parts_.wall_is_solid[i], pressed, vertices, distance, *scratch_);
    };
    if (!allows(deepest(pressed, parts_.walls[i]))) {
      const std::string stood = carried.from.where_it_stood(scene_.walls[i].name);
      throw InputError("{}: {} overlaps {} (wall '{}'), touches it to more than {} of the margins, or lies behind it; {}",
                       case_.start->where, carried.from.name_of(carried.from.bodies[body].id), case_.walls[i].where, scene_.walls[i].name,
                       kStopOverlapRatio,
                       carried.wall_partner[i] >= 0 ? advice_on_margin()
                       : stood.empty()              ? "move the wall"
                                                    : "move the wall: " + stood);
    }
    if (!allows(gap())) ++touching[i];
  }
}

/// Of a margin that is wider than in the run.
void Packer::check_carried_pairs(std::size_t body) {
  const CarriedBodies& carried = *parts_.carried;
  const PlacedBody& placed = carried.placed[body];
  near_.clear();
  grid_.for_each_near(placed.position, placed.radius() + gap(), [&](std::int32_t j) {
    near_.push_back(j);
    return true;
  });
  std::sort(near_.begin(), near_.end());
  for (const std::int32_t n : near_) {
    const auto j = static_cast<std::size_t>(n);
    if (carried.from.bodies[body].fixed && is_fixed(j)) continue;
    if (gap_between(placed_[j], placed, gap() * kJustAbove, *scratch_) > deepest(placed, placed_[j])) continue;
    throw InputError("{}: {} touches body {} to more than {} of the margins; {}", case_.start->where,
                     carried.from.name_of(carried.from.bodies[body].id), carried.from.bodies[carried_number(j)].id, kStopOverlapRatio,
                     advice_on_margin());
  }
}

void Packer::place_carried_bodies() {
  if (!parts_.carried) return;
  const CarriedBodies& carried = *parts_.carried;
  const Settings &now = scene_.settings, &before = carried.from.scene.settings;
  const bool by_size = now.surface == TouchAt::drawn;
  const double margin = by_size ? now.margin_ratio : now.margin, margin_before = by_size ? before.margin_ratio : before.margin;
  const bool is_wider = !by_size && (margin > margin_before || before.surface == TouchAt::drawn);
  std::vector<std::size_t> touching(parts_.walls.size(), 0);
  for (std::size_t i = 0; i < carried.placed.size(); ++i) {
    BodyRow row = carried.from.bodies[i];
    if (!domain_holds(row.position))
      throw InputError("{}: {} lies outside the domain: its centre is {}; widen the domain, or leave it out with start.leave_out",
                       case_.start->where, carried.from.name_of(row.id), beyond_side(now.domain, row.position, true));
    if (!row.fixed) check_carried_at_walls(i, is_wider, touching);
    if (is_wider) check_carried_pairs(i);
    keep(carried.placed[i], kFirstCarried - static_cast<std::int32_t>(i));
    row.shape = carried.scene_shape[static_cast<std::size_t>(row.shape)];
    scene_.bodies.add(row);
  }
  for (std::size_t i = 0; i < touching.size(); ++i) {
    if (touching[i] > 0 && carried.wall_partner[i] < 0)
      report_.notices.push_back(fmt::format("{}: {} bodies of {} start in contact with wall '{}', which the run did not have there",
                                            case_.start->where, touching[i], carried.from.start.run, scene_.walls[i].name));
  }
  if (now.surface != before.surface) {
    report_.notices.push_back(fmt::format("{}: contact.surface is \"{}\" here and was \"{}\" in the run: bodies that touched start {}",
                                          case_.start->where, word_of(now.surface), word_of(before.surface),
                                          by_size ? "apart, and fall" : "pressed, which stores energy"));
    return;
  }
  if (margin == margin_before) return;
  if (by_size) {  // touch begins where it did
    report_.notices.push_back(fmt::format("{}: contact.margin_ratio is {:.4g} here and was {:.4g} in the run: edges are rounded otherwise",
                                          case_.start->where, margin, margin_before));
    return;
  }
  report_.notices.push_back(fmt::format("{}: contact.margin is {} here and was {} in the run: bodies that touched {}", case_.start->where,
                                        format_quantity(margin, Dimension::length), format_quantity(margin_before, Dimension::length),
                                        is_wider ? "start pressed, which stores energy" : "start apart by the difference, and fall"));
}

}  // namespace scree
