#include "decomposer/case/case_pairs.hpp"

#include <algorithm>
#include <map>

#include "core/base/error.hpp"

namespace scree {

namespace {

/// What uses a material: movers may touch everything else, fixed things only movers, and fixed bodies also walls that answer to force.
struct Users {
  double movers = 0;
  std::string mover, still, fixed_body, answering_wall;
};

std::map<std::int32_t, Users> users_of_materials(const Case& c, const std::vector<MaterialUse>& others) {
  std::map<std::int32_t, Users> users;
  for (const CaseBody& b : c.bodies) {
    Users& u = users[b.material];
    (b.fixed ? u.still : u.mover) = b.where;
    const bool falls_apart = c.shapes[static_cast<std::size_t>(b.shape)].falls_apart();
    if (!b.fixed) u.movers += falls_apart ? 2 : 1;  // pieces meet each other
    if (b.fixed) u.fixed_body = b.where;
  }
  for (const CasePopulation& p : c.populations) {
    users[p.material].mover = p.where;
    const bool fall_apart = std::any_of(p.shares.begin(), p.shares.end(),
                                        [&](const auto& s) { return c.shapes[static_cast<std::size_t>(s.first)].falls_apart(); });
    users[p.material].movers += p.amount == CasePopulation::Amount::count && !fall_apart ? p.value : 2;
  }
  for (const CaseInlet& i : c.inlets) {
    users[i.material].mover = i.where;
    users[i.material].movers += i.inlet.count == 1 ? 1 : 2;
  }
  for (const CaseWall& w : c.walls) {
    users[w.wall.material].still = w.where;
    if (w.wall.motion.drive()) users[w.wall.material].answering_wall = w.where;
  }
  for (const MaterialUse& other : others) {
    Users& u = users[other.material];
    if (other.has_fixed) u.still = u.fixed_body = other.where;
    if (other.movers > 0) u.mover = other.where;
    u.movers += other.movers;
  }
  return users;
}

/// Two materials that can touch, and what of them does.
struct Meeting {
  std::int32_t a, b;
  std::string mover, with;
};

std::vector<Meeting> meetings(const Case& c, const std::vector<MaterialUse>& others) {
  const std::map<std::int32_t, Users> users = users_of_materials(c, others);
  std::vector<Meeting> all;
  for (const auto& [a, first] : users) {
    for (const auto& [b, second] : users) {
      if (b < a) continue;
      std::string with;
      if (a == b) {
        if (first.movers >= 2) with = first.mover;
        if (first.movers >= 1 && !first.still.empty()) with = first.still;
      } else if (first.movers >= 1 && second.movers >= 1) {
        with = second.mover;
      } else if (first.movers >= 1) {
        with = second.still;
      } else if (second.movers >= 1) {
        with = first.still;
      }
      if (!with.empty()) {
        all.push_back({a, b, first.movers >= 1 ? first.mover : second.mover, with});
        continue;
      }
      for (const auto& [of_wall, of_body] : {std::pair(&first, &second), std::pair(&second, &first)}) {
        if (of_wall->answering_wall.empty() || of_body->fixed_body.empty()) continue;
        all.push_back({a, b, of_wall->answering_wall, of_body->fixed_body});
        break;
      }
    }
  }
  return all;
}

}  // namespace

void check_pairs(const Case& c, const std::vector<MaterialUse>& others) {
  std::vector<Meeting> missing;
  for (const Meeting& m : meetings(c, others)) {
    if (std::none_of(c.pairs.begin(), c.pairs.end(), [&](const CasePair& p) { return p.pair.a == m.a && p.pair.b == m.b; }))
      missing.push_back(m);
  }
  if (missing.empty()) return;
  const auto name = [&](std::int32_t material) -> const std::string& { return c.materials[static_cast<std::size_t>(material)].name; };
  std::vector<std::string> who, what;
  for (const Meeting& m : missing) {
    who.push_back(fmt::format("\"{}\" and \"{}\" can touch ({} and {})", name(m.a), name(m.b), m.mover, m.with));
    what.push_back(fmt::format("between = [\"{}\", \"{}\"]", name(m.a), name(m.b)));
  }
  if (missing.size() == 1) throw UsageError("{}: the materials {}, but no [[pairs]] says how; add one with {}", c.path, who[0], what[0]);
  throw UsageError("{}: {} pairs of materials have no [[pairs]]: {}; add one for each, with {}", c.path, missing.size(),
                   fmt::join(who, "; "), fmt::join(what, ", "));
}

void drop_pairs_that_cannot_meet(Case& c, const std::vector<MaterialUse>& others) {
  const std::vector<Meeting> needed = meetings(c, others);
  std::erase_if(c.pairs, [&](const CasePair& p) {
    return std::none_of(needed.begin(), needed.end(), [&](const Meeting& m) { return p.pair.a == m.a && p.pair.b == m.b; });
  });
}

}  // namespace scree
