// What a run has added up since its start besides its bodies and the state of their pairs; part of a checkpoint.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.hpp"
#include "core/storage/wall_state.hpp"
#include "solver/pairs/deep_contacts.hpp"
#include "solver/ranks/exact_sum.hpp"
#include "solver/state/effect_record.hpp"
#include "solver/state/inlet_state.hpp"

namespace scree {

/// What walls and bodies did to each other. The forces of the last step count in full; readers of a total take half of them back.
struct WallTotals {
  explicit WallTotals(std::size_t walls = 0) : impulse(walls) {}
  ExactSum work;                                 ///< of driven walls on the bodies [J]
  ExactSum dissipated;                           ///< the walls' part of what is dissipated, and what goes as necks and bridges form [J]
  std::vector<std::array<ExactSum, 3>> impulse;  ///< on each wall [N s]
};

/// What bodies took with them that were taken out: by outlets, or as they left the domain.
struct DepartureTotals {
  ExactSum count;
  ExactSum mass;        ///< [kg]
  ExactSum energy;      ///< kinetic and potential [J]
  ExactSum dissipated;  ///< what they had dissipated by then [J]
};

/// What was taken out by one outlet.
struct OutletTotals {
  ExactSum count;
  ExactSum mass;  ///< [kg]
};

/// What bodies brought that joined after the start.
struct ArrivalTotals {
  ExactSum count;
  ExactSum mass;    ///< [kg]
  ExactSum energy;  ///< kinetic and potential [J]
};

/// Of one rank, or of all.
struct RunTotals {
  RunTotals(std::size_t wall_count = 0, std::size_t outlet_count = 0, std::size_t inlet_count = 0)
      : walls(wall_count), outlets(outlet_count), inlets(inlet_count) {}
  WallTotals walls;
  DepartureTotals departed;
  ArrivalTotals arrived;
  std::vector<OutletTotals> outlets;
  std::vector<InletState> inlets;     ///< the same on every rank
  DeepTotals deep;                    ///< contacts deeper than their maximum overlap, where a run goes on with them
  std::vector<EffectRecord> effects;  ///< of all ranks, in the order of effect_kinds(), as a checkpoint holds them; empty while it runs
  std::int64_t largest_id = -1;       ///< of the bodies that joined, the same on every rank
  double max_overlap_ratio = 0;       ///< since it was last taken
  std::int64_t level = 0;             ///< of the step, see StepClock
};

/// Calls action(sum) for every sum, in the order in which checkpoints hold them; those of RunTotals without arrivals and outlets, which
/// files hold by themselves.
template <class Action>
void for_each_impulse(WallTotals& t, Action&& action) {
  for (std::array<ExactSum, 3>& of_wall : t.impulse) {
    for (ExactSum& component : of_wall) action(component);
  }
}
template <class Action>
void for_each_sum(WallTotals& t, Action&& action) {
  for (ExactSum* sum : {&t.work, &t.dissipated}) action(*sum);
  for_each_impulse(t, action);
}
template <class Action>
void for_each_sum(DepartureTotals& t, Action&& action) {
  for (ExactSum* sum : {&t.count, &t.mass, &t.energy, &t.dissipated}) action(*sum);
}
template <class Action>
void for_each_sum(ArrivalTotals& t, Action&& action) {
  for (ExactSum* sum : {&t.count, &t.mass, &t.energy}) action(*sum);
}
template <class Action>
void for_each_sum(std::vector<OutletTotals>& t, Action&& action) {
  for (OutletTotals& outlet : t) {
    for (ExactSum* sum : {&outlet.count, &outlet.mass}) action(*sum);
  }
}
template <class Action>
void for_each_sum(RunTotals& t, Action&& action) {
  for (ExactSum* sum : {&t.walls.work, &t.walls.dissipated}) action(*sum);
  for_each_sum(t.departed, action);
  for_each_impulse(t.walls, action);
}

void add(WallTotals& other, WallTotals& to);

/// The sums of all ranks, on every rank. Collective.
template <class Totals>
Totals over_ranks(MPI_Comm comm, Totals totals) {
  std::vector<ExactSum> sums;
  for_each_sum(totals, [&](const ExactSum& sum) { sums.push_back(sum); });
  add_over_ranks(comm, sums);
  auto next = sums.begin();
  for_each_sum(totals, [&](ExactSum& sum) { sum = *next++; });
  return totals;
}

/// The words of all sums, one sum after the other, as checkpoints hold them.
template <class Totals>
std::vector<std::int64_t> words_of(Totals totals) {
  std::vector<std::int64_t> words;
  for_each_sum(totals, [&](const ExactSum& sum) {
    const ExactSum::Words w = sum.words();
    words.insert(words.end(), w.begin(), w.end());
  });
  return words;
}
/// Sets all sums from such words. Throws InputError when they are not as many.
template <class Totals>
void set_words(const std::vector<std::int64_t>& words, Totals& totals) {
  std::size_t next = 0;
  for_each_sum(totals, [&](ExactSum& sum) {
    ExactSum::Words w{};
    if (next + w.size() <= words.size()) std::copy_n(words.begin() + static_cast<std::ptrdiff_t>(next), w.size(), w.begin());
    sum.set_words(w);
    next += w.size();
  });
  if (next != words.size())
    throw InputError("totals of {} numbers instead of {}; the file is damaged or of another scene", words.size(), next);
}

}  // namespace scree
