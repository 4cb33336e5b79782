// method = "lattice": bodies in the cells of a regular grid, moved at random within the room that their cell leaves.
#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/base/long_work.hpp"
#include "core/base/units.hpp"
#include "core/placing/orientation.hpp"
#include "decomposer/packing/packer.hpp"

namespace scree {

void Packer::place_on_lattice(std::size_t population, Placements& placements) {
  const Region& region = parts_.regions[population];
  const CasePopulation& p = case_.populations[population];
  std::vector<std::size_t> members;
  Vec3 cell;  // holds each of the turned bodies and a gap
  for (std::size_t i = 0; i < parts_.draws.size(); ++i) {
    const Draw& d = parts_.draws[i];
    if (d.population != population) continue;
    members.push_back(i);
    PlacedBody& body = placements.body[i];
    body.orientation = draw_orientation(p.orientation, body.shape->shape, RandomNumbers(case_.settings.seed, d.id, 1), 0);
    body.position = {};
    const Vec3 extent = body.world_box().extent();
    for (int k = 0; k < 3; ++k) cell[k] = std::max(cell[k], extent[k] + gap() * kJustAbove);
  }
  if (members.empty()) return;
  // A side of the region needs no gap, a wall does: both are looked at when a body is placed. Round a periodic axis the last cell
  // meets the first.
  Box3 room = box_of_centres(region, {{0, 0, 0}, {0, 0, 0}});
  for (int k = 0; k < 3; ++k) {
    const bool around = region.is_box() && periodicity_.is_periodic(k) && room.extent()[k] >= periodicity_.period()[k];
    if (!around) room.upper[k] += gap();
  }
  const auto cells_of = [&](double factor) {
    std::array<std::int64_t, 3> cells{};
    for (int k = 0; k < 3; ++k) {
      cells[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::min(1e6, room.extent()[k] / (factor * cell[k])));
    }
    return cells;
  };
  const auto sites_of = [](const std::array<std::int64_t, 3>& cells) {
    return static_cast<double>(cells[0]) * static_cast<double>(cells[1]) * static_cast<double>(cells[2]);
  };
  // the widest grid that has enough cells, then narrower ones while walls, other bodies or the region's own form take too many
  constexpr double kNarrower = 0.98;
  double factor = std::cbrt(region.box.extent().x * region.box.extent().y * region.box.extent().z /
                            (static_cast<double>(members.size()) * cell.x * cell.y * cell.z)) /
                  kNarrower;
  std::array<std::int64_t, 3> tried{};
  while (true) {
    factor = factor > 1 ? std::max(1.0, factor * kNarrower) : 0.0;
    if (factor == 0) break;
    const std::array<std::int64_t, 3> cells = cells_of(factor);
    const bool is_narrowest = factor == 1;
    if ((cells == tried && !is_narrowest) || sites_of(cells) < static_cast<double>(members.size())) continue;
    tried = cells;
    if (fill_lattice(population, members, room, cells, is_narrowest, placements)) {
      for (const std::size_t i : members) keep(placements.body[i]);
      return;
    }
  }
  throw InputError(
      "{}: {} bodies do not fit on a lattice: cells of {} x {} x {} hold the largest of them, and the region has {:.0f}, of which {} "
      "were free. Enlarge the region, request fewer or smaller bodies, or give them an orientation that needs less room",
      p.where, members.size(), format_quantity(cell.x, Dimension::length), format_quantity(cell.y, Dimension::length),
      format_quantity(cell.z, Dimension::length), sites_of(cells_of(1)), placements.count_placed(parts_, population));
}

bool Packer::fill_lattice(std::size_t population, const std::vector<std::size_t>& members, const Box3& box,
                          const std::array<std::int64_t, 3>& cells, bool takes_all, Placements& placements) {
  const Region& region = parts_.regions[population];
  Vec3 pitch;
  for (int k = 0; k < 3; ++k) pitch[k] = box.extent()[k] / static_cast<double>(cells[static_cast<std::size_t>(k)]);
  LongWork work("lattice", static_cast<double>(members.size()));
  const double sites = static_cast<double>(cells[0]) * static_cast<double>(cells[1]) * static_cast<double>(cells[2]);
  for (const std::size_t i : members) placements.is_placed[i] = 0;
  std::size_t next = 0;
  const auto put_into = [&](const Vec3& index) {
    const Draw& d = parts_.draws[members[next]];
    PlacedBody& body = placements.body[members[next]];
    const RandomNumbers random(case_.settings.seed, d.id, 2);
    body.position = {};
    const Box3 own = body.world_box();
    Vec3 place;
    for (int k = 0; k < 3; ++k) {
      const double free = pitch[k] - own.extent()[k] - gap();
      const double within = 0.5 + case_.populations[population].jitter * (random.uniform(static_cast<std::uint64_t>(k)) - 0.5);
      place[k] = box.lower[k] + index[k] * pitch[k] - own.lower[k] + within * free;
    }
    body.position = place;
    if (!is_free(body, region)) return false;
    placements.is_placed[members[next++]] = 1;
    work.update(static_cast<double>(next));
    return true;
  };
  // First spread over all cells: one is used when the bodies placed lag behind the cells seen. Then, if all cells count, the others.
  std::vector<double> used;  // numbers of cells, ascending: as many as bodies, however many cells there are
  for (const bool takes_others : {false, true}) {
    if (takes_others && !takes_all) break;
    auto next_used = used.begin();
    double seen = 0;
    for (std::int64_t z = 0; z < cells[2]; ++z) {
      for (std::int64_t y = 0; y < cells[1]; ++y) {
        for (std::int64_t x = 0; x < cells[0] && next < members.size(); ++x) {
          seen += 1;
          if (takes_others && next_used != used.end() && *next_used == seen) {
            ++next_used;
            continue;
          }
          if (!takes_others && static_cast<double>(next) >= std::ceil(seen * static_cast<double>(members.size()) / sites)) continue;
          if (put_into({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)}) && !takes_others) used.push_back(seen);
        }
      }
    }
  }
  return next == members.size();
}

}  // namespace scree
