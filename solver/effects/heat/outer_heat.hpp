// Heat that a program next to the simulation gives to bodies: a source of a given power, and exchange with a medium around the body, a
// fluid that the program computes.
//
// Both are held until they are given again. A medium of temperature T_m, to which the body has the conductance G = h A, gives the power
// G (T_m - T). It enters both stages of Heun's method with the temperature of that stage (heat.hpp), as a wall does, and G counts in the
// critical step m c / (sum of H + G). What has passed from the medium to each body is kept until the program takes it, with what rounding
// takes from the sum: the fluid closes its own energy with the numbers that the bodies were heated by.
//
// Data. A step reads power, G and T_m of a body and adds to the heat that has passed: all lie in one entry of a table by ascending id, on
// the rank that owns the body, and travel with it (by_id.hpp: 64 B for each body that changes its rank, to every rank). Entries of bodies
// that have left stay on rank 0 until their heat is taken. Scenes that no program heats have no table, and bodies without an entry pay
// nothing. Sums over the scene are exact. What is held is no part of the state hash: the temperatures that follow from it are.
//
// Sleep: neither changes a force, so that no body wakes; temperatures of sleeping bodies change as those of all others.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "solver/ranks/exact_sum.hpp"
#include "solver/state/by_id.hpp"
#include "solver/state/effect_record.hpp"

namespace scree {

/// What a program gives of one body.
struct SourceOfBody {
  std::int64_t id;
  double power;  ///< [W], into the body
};
struct MediumOfBody {
  std::int64_t id;
  double conductance;  ///< h A [W/K]
  double temperature;  ///< of the medium [K]
};

class OuterHeat {
 public:
  // 1. Between two steps. Collective. Any rank may name any body.
  /// Holds sources, or media, each instead of that which its body had.
  /// Throws UsageError on every rank, and nothing is changed: a body that is unknown or named twice; a number that is not finite, a
  /// conductance below 0, a temperature that is not above 0.
  void hold(const RunState& s, const std::vector<SourceOfBody>& mine);
  void hold(const RunState& s, const std::vector<MediumOfBody>& mine);
  /// Ends sources and media of these bodies, without a list of all. What has passed can still be taken.
  void release(const RunState& s, const std::optional<std::vector<std::int64_t>>& mine);
  /// Heat that has passed from the medium to each body of `mine` since it was last taken [J]: 0 of one that never had a medium. Bodies that
  /// have left may be named once more. Throws UsageError as hold().
  std::vector<double> take(const RunState& s, const std::vector<std::int64_t>& mine);

  // 2. In a step, of the effect of heat.
  /// Sources: adds the heat of a step to each row.   in/out   given   of each owned row [J]
  void add_sources(double dt, std::vector<double>& given);
  /// Media: adds the power at these temperatures.   in/out   power   of each owned row [W]
  void add_power(const std::vector<double>& temperature, std::vector<double>& power) const;
  /// Counts what has passed in a step: the mean of both stages.
  void count_passed(double dt, const std::vector<double>& first, const std::vector<double>& second);
  /// Adds the conductance of media.   in/out   sum   of each owned row [W/K]
  void add_conductance(std::vector<double>& sum) const;
  /// [W/K]; 0: the row has no medium.
  double conductance_of(std::size_t row) const;

  // 3. As the effect asks for it.
  void after_migration(const RunState& s, bool left);
  void on_rebuild(const RunState& s);
  /// In the order of formats(). Collective.
  std::vector<StateArray> record(const RunState& s) const;
  /// Throws InputError where arrays do not belong together.
  void restore(const RunState& s, const std::vector<StateArray>& record);
  static std::vector<ArrayFormat> formats();
  static constexpr std::size_t kSums = 2;    ///< of these arrays the first are sums
  static constexpr std::size_t kArrays = 6;  ///< empty, all of them, in a scene that no program heats

  const ExactSum& from_program() const { return from_program_; }  ///< by sources, of this rank [J]
  const ExactSum& from_medium() const { return from_medium_; }    ///< the same by media
  /// Bodies with a source, and with a medium, of this rank.
  std::int64_t source_count() const;
  std::int64_t medium_count() const;

 private:
  struct Entry {
    std::int64_t id;
    double power = 0, conductance = 0;
    double medium = 0;                 ///< its temperature; 0: there is none
    double passed = 0, remainder = 0;  ///< from the medium, and what the sum lacks [J]
    std::int64_t row = -1;
    bool is_needed() const { return power != 0 || medium != 0 || passed != 0; }
  };

  const std::vector<std::int32_t>& by_id(const RunState& s);
  template <class Given, class Check>
  NamedBodies checked(const char* call, const RunState& s, const std::vector<Given>& all, const Check& fault_of);
  template <class Given, class Change>
  void change(const RunState& s, const std::vector<Given>& all, const NamedBodies& found, const Change& change_entry);
  void drop_unneeded();
  void find_rows(const RunState& s);

  std::vector<Entry> table_;     // of bodies of this rank, by ascending id
  std::vector<Entry> departed_;  // on rank 0: of bodies that have left, by ascending id
  std::vector<std::int32_t> by_id_;
  ExactSum from_program_, from_medium_;
};

}  // namespace scree
