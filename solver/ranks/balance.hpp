// When to cut again: the work of each body as it was measured, and what a cut costs against what it saves.
#pragma once

#include <span>
#include <vector>

#include "solver/neighbours/pair_list.hpp"
#include "solver/ranks/agreement.hpp"

namespace scree {

/// Measured work of the bodies of one rank, and the decision of all ranks.
///
/// How: every kSampleEvery steps each pair is timed by itself, and each of its bodies bears half. What integration, sums and
/// search take is shared out evenly. A cut is due when what the imbalance has cost since the last one exceeds what the last
/// one took: whatever happens later, the two together are then at most twice the best that could have been done. Where cuts do
/// not help, each waits for twice as much as the one before. The states of a run never depend on it.
class Balance {
 public:
  explicit Balance(int ranks) : ranks_(ranks) {}

  /// Whether the pairs of this step are to be timed, each by itself.
  bool is_sample(std::int64_t step) const { return ranks_ > 1 && step % kSampleEvery == 1; }  // never one that is measured as a whole
  /// Adds what the timed pairs took to the work of their bodies.
  void add_sample(std::span<const float> pair_seconds, const std::vector<BodyPair>& pairs, ParticleSet& p);
  /// Work of each owned body, in any unit.
  std::vector<double> work_of_bodies(const ParticleSet& p) const;

  /// Fills in what this rank worked since the last cut.
  void tell(StepReport& report) const;
  /// The same answer on every rank.
  bool is_cut_due(const StepReport& all) const;
  /// A cut was made and its bodies moved, in so many seconds of this rank.
  /// in   expected   imbalance that it leaves, by the work of the bodies; the same on every rank
  void note_cut(double seconds, double expected, ParticleSet& p);

  /// Weight of a step's processor time: some steps stand for all.
  double weight_of(std::int64_t step) const { return ranks_ > 1 && step % kMeasureEvery == 0 ? static_cast<double>(kMeasureEvery) : 0; }
  /// Processor time of this rank since the start [s]; WorkTimer adds to it.
  double& computing() { return computing_; }
  double computing() const { return computing_; }

 private:
  static constexpr std::int64_t kMeasureEvery = 4, kSampleEvery = 16;

  int ranks_;
  std::int64_t samples_ = 0;  // since the last cut
  double computing_ = 0, computing_at_cut_ = 0;
  double pair_seconds_ = 0;  // of the samples since the last cut
  double cut_cost_ = 0, patience_ = 1;
};

}  // namespace scree
