// Means with confidence intervals from a series of frames that depend on one another.
#pragma once

#include <cstddef>
#include <vector>

namespace scree {

struct Average {
  double mean = 0;
  double ci95 = 0;  ///< half width of the 95 % confidence interval; NaN with fewer than two blocks
  double smallest = 0, largest = 0;
  std::size_t count = 0;  ///< values that were numbers
};

/// How much each frame counts in a mean over time: half of the time to its neighbours; the first and the last as much again, such that
/// frames at equal intervals count alike, and one that was written a few steps after the last adds next to nothing. in   times   of the
/// frames, ascending [s]      Returns shares that sum to 1; equal ones where all frames are of one time.
std::vector<double> frame_weights(const std::vector<double>& times);

/// Averages of many quantities at once, fed frame by frame.
///
/// How: the frames, each with its weight, are cut into blocks of equal weight; the mean of the block means with Student's t for their
/// spread is the interval. Frames in a row are correlated, so the spread of single frames would give intervals that are too narrow; blocks
/// must be longer than the correlation time, which is the user's to judge. Values that are NaN (not defined in that frame)
/// are left out. A block without a value does not count.
/// Source: H. Flyvbjerg, H. G. Petersen, Error estimates on averages of correlated data, J. Chem. Phys. 91 (1989) 461.
/// Memory: quantities x blocks, whatever the number of frames.
class BlockAverage {
 public:
  /// in   frames   that will be added      in   blocks   at most frames / 2 are made
  BlockAverage(std::size_t quantities, std::size_t frames, std::size_t blocks);
  /// in   weight   of the frame, of all that will be added (frame_weights)
  void add(const std::vector<double>& values, double weight);
  /// The same, with another weight for one of the quantities: a rate stands for the time since the frame before.
  void add(const std::vector<double>& values, double weight, std::size_t other, double weight_of_other);
  /// Of frames that all count alike.
  void add(const std::vector<double>& values) { add(values, 1 / static_cast<double>(frames_)); }
  Average of(std::size_t quantity) const;
  std::size_t blocks() const { return blocks_; }
  std::size_t frames_added() const { return added_; }

 private:
  std::size_t quantities_, frames_, blocks_, added_ = 0;
  double weight_added_ = 0;
  std::vector<double> sum_, weight_, smallest_, largest_;
  std::vector<std::size_t> count_;
};

/// Two-sided 95 % quantile of Student's distribution.
double student_95(std::size_t degrees_of_freedom);

}  // namespace scree
