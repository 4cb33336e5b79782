// Every contact of a busy scene on several ranks against those of one rank, and where on the cuts they lie.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <vector>

#include "tests/solver/rank_groups.hpp"
#include "tests/support/parallel_scenes.hpp"

namespace scree::test {

/// Rocks thrown about in a box that tumbles around a space diagonal: they cross all cuts, in all directions, all the time.
inline Scene tumbling_box(int n) {
  Scene scene = rock_scene();
  const double spacing = 0.108, lattice = 0.5 * n * spacing, half = lattice + 0.012;
  add_box_walls(scene, {-half, -half, -half}, {half, half, half});
  scene.walls[0].motion.kind = Rotate{.axis = normalised(Vec3{1, 1, 1}), .rate = 5};
  fill_lattice(scene, n, n, n, {-lattice, -lattice, -lattice}, spacing, {});
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> speed(-1.5, 1.5);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {  // inwards too, so that they meet soon
    scene.bodies.velocity[i] = Vec3{speed(generator), speed(generator), speed(generator)} - 3.0 * scene.bodies.position[i];
  }
  return scene;
}

/// What a step showed: the number of its contacts, and sums over hashes of the bits of each, which know no order.
struct ContactSet {
  std::int64_t count = 0, low = 0, high = 0;  // halves of the hashes: their sums have room
  bool operator==(const ContactSet&) const = default;
};

inline ContactSet contact_set(const FrameContacts& contacts) {
  ContactSet set;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    std::uint64_t hash = 0;
    const auto add = [&hash](std::uint64_t word) {  // finaliser of SplitMix64
      hash += word + 0x9e3779b97f4a7c15;
      hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9;
      hash = (hash ^ (hash >> 27)) * 0x94d049bb133111eb;
      hash ^= hash >> 31;
    };
    for (const std::int64_t word : {contacts.body_a[i], contacts.body_b[i], contacts.feature[i]}) add(static_cast<std::uint64_t>(word));
    const Vec3 &x = contacts.point[i], &n = contacts.normal[i];
    for (const double value : {contacts.overlap[i], contacts.normal_force[i], x.x, x.y, x.z, n.x, n.y, n.z})
      add(std::bit_cast<std::uint64_t>(value));
    ++set.count;
    set.low += static_cast<std::int64_t>(hash & 0xffffffff);
    set.high += static_cast<std::int64_t>(hash >> 32);
  }
  return set;
}

/// Of the contacts between bodies: how many lie where so many ranks hold both bodies. Two hold what touches near a face between two parts,
/// three and more what touches near an edge or a corner of parts.
using Places = std::map<int, std::int64_t>;

inline void add_places(const mpi::Communicator& comm, const ParticleSet& p, const FrameContacts& contacts, Places& places) {
  const auto ranks = static_cast<std::size_t>(comm.size());
  const std::vector<std::int64_t> here(p.id.begin(), p.id.end());
  std::map<std::int64_t, std::uint64_t> held;  // by id: a bit for each rank
  const auto by_rank = comm.exchange(std::vector<std::vector<std::int64_t>>(ranks, here));
  for (std::size_t r = 0; r < ranks; ++r) {
    for (const std::int64_t id : by_rank[r]) held[id] |= std::uint64_t{1} << r;
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto a = held.find(contacts.body_a[i]), b = held.find(contacts.body_b[i]);
    if (a != held.end() && b != held.end()) ++places[std::popcount(a->second & b->second)];  // else a wall
  }
}

/// Contacts of every step are those of one rank, whose lists are made again in every step, and the last states have the same bits.
inline void expect_contacts_of_one_rank(const Scene& scene, int steps, const std::vector<int>& numbers_of_ranks) {
  struct Seen {
    std::vector<ContactSet> sets;
    Places places;
    std::string hash;
    std::int64_t migrated = 0;
  };
  const auto watch = [&](int ranks, bool new_lists) {
    Seen seen;
    on_ranks(ranks, [&](const mpi::Communicator& comm) {
      TestRun run(scene, comm);
      run.start();
      for (int n = 1; n <= steps; ++n) {
        if (new_lists) run.simulation->lists().forget_candidates();
        run.simulation->advance();
        const FrameContacts contacts = run.simulation->contacts();
        const ContactSet mine = contact_set(contacts);
        seen.sets.push_back({comm.sum(mine.count), comm.sum(mine.low), comm.sum(mine.high)});
        if (n % 20 == 0) add_places(comm, run.simulation->state().particles, contacts, seen.places);
      }
      run.simulation->agree_on_failures();
      for (int k = 1; k <= ranks; ++k) seen.places[k] = comm.sum(seen.places[k]);
      seen.hash = state_hash(run.simulation->state());
      seen.migrated = comm.sum(run.simulation->decomposition().migrated());
    });
    return seen;
  };
  const Seen alone = watch(1, true);
  std::int64_t all = 0;
  for (const ContactSet& set : alone.sets) all += set.count;
  for (const int ranks : numbers_of_ranks) {
    const Seen seen = watch(ranks, false);
    if (g_comm->rank() != 0) continue;
    std::int64_t different = 0;
    std::string first;
    for (std::size_t n = 0; n < alone.sets.size(); ++n) {
      if (seen.sets[n] == alone.sets[n]) continue;
      if (different++ == 0) first = fmt::format("step {}: {} in place of {}", n + 1, seen.sets[n].count, alone.sets[n].count);
    }
    std::string where;
    std::int64_t at_cuts = 0, at_edges = 0;
    for (const auto& [holders, count] : seen.places) {
      where += fmt::format(" {} on {}", count, holders);
      if (holders >= 2) at_cuts += count;
      if (holders >= 3) at_edges += count;
    }
    std::printf(
        "%d ranks: %lld contacts in %d steps, %lld bodies handed over; contacts of bodies, every 20 steps, by ranks that hold both:%s\n",
        ranks, static_cast<long long>(all), steps, static_cast<long long>(seen.migrated), where.c_str());
    EXPECT_EQ(different, 0) << ranks << " ranks: other contacts than one rank's, first in " << first;
    EXPECT_EQ(seen.hash, alone.hash) << ranks << " ranks";
    EXPECT_GT(at_cuts, 0) << ranks << " ranks";
    EXPECT_GT(seen.migrated, 0) << ranks << " ranks";
    if (ranks >= 4) {
      EXPECT_GT(at_edges, 0) << ranks << " ranks";
    }
  }
}

}  // namespace scree::test
