// Sums that do not depend on the order of their terms, and so on the number of ranks, threads and restarts.
#pragma once

#include <mpi.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "solver/ranks/exact_parts.hpp"

namespace scree {

/// A sum of doubles that no order of its terms can change: a fixed-point number of kWordCount - 2 words from 2^kLowest up. What a term has
/// below 2^kLowest is cut off before it is added.
///
/// How: words of 32 bits, each in a 64-bit integer, so that 2^31 terms fit before a carry is due. A term falls on at most three
/// words. Integers add in any order, also across ranks; only value() rounds, to within one unit in the last place.
/// Source: U. Kulisch, V. Snyder, The exact dot product as basic tool for long interval arithmetic, Computing 91, 2011.
/// Limits: a term that is not finite, or too large for the words, makes the value NaN.   Cost: about 5 ns a term; 8 bytes a word.
template <int kLowest, std::size_t kWordCount>
class FixedPointSum {
 public:
  static constexpr std::size_t kWords = kWordCount;
  using Words = std::array<std::int64_t, kWords>;

  void add(double term) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &term, sizeof bits);
    const auto exponent = static_cast<unsigned>(bits >> 52) & 0x7FFu;
    std::uint64_t mantissa = bits & 0xFFFFFFFFFFFFFull;
    if (exponent == 0x7FFu) {
      ++words_[kWords - 1];
      return;
    }
    if (exponent != 0) mantissa |= 1ull << 52;
    unsigned position = exponent == 0 ? 0 : exponent - 1;  // of the last bit of the mantissa, above 2^kLowest
    if constexpr (kLowest > kSmallest) {
      constexpr unsigned kBelow = kLowest - kSmallest;
      if (position < kBelow) {
        const unsigned cut = kBelow - position;
        mantissa = cut < 64 ? mantissa >> cut : 0;
        position = kBelow;
      }
      position -= kBelow;
    }
    const unsigned word = position / 32, shift = position % 32;
    if constexpr (kLowest + 32 * static_cast<int>(kWords - 2) < kLargest) {
      if (word + 3 > kWords - 2) {
        ++words_[kWords - 1];
        return;
      }
    }
    const std::uint64_t low = mantissa << shift;  // bits 0-63 of the 84 that a term can have here
    const std::uint64_t high = shift == 0 ? 0 : mantissa >> (64 - shift);
    const std::int64_t parts[3] = {static_cast<std::int64_t>(low & kMask), static_cast<std::int64_t>(low >> 32),
                                   static_cast<std::int64_t>(high)};
    const std::int64_t sign = (bits >> 63) != 0 ? -1 : 1;
    for (unsigned i = 0; i < 3; ++i) words_[word + i] += sign * parts[i];
    constexpr std::int32_t kTermsBeforeCarry = 1 << 30;
    if (++terms_ == kTermsBeforeCarry) carry();
  }

  /// Adds many terms: the same sum, to the bit, in a fifth of the time where their exponents are near each other.   in, out   terms   used
  /// up
  void add_many(ManyTerms& terms, std::size_t count) requires(kLowest == -1074) {
    constexpr std::size_t kWorthIt = 8;  // terms; fewer are added sooner one by one
    ManyTerms parts;
    const std::size_t found = count < kWorthIt ? 0 : find_exact_parts(terms, count, parts);
    const ManyTerms& added = found > 0 ? parts : terms;
    for (std::size_t i = 0; i < (found > 0 ? found : count); ++i) add(added[i]);
  }

  void add(const FixedPointSum& other) {
    const Words more = other.words();
    carry();
    for (std::size_t i = 0; i < kWords; ++i) words_[i] += more[i];
    carry();
  }

  double value() const {
    if (words_[kWords - 1] != 0) return std::nan("");
    FixedPointSum sum = *this;
    sum.carry();
    const bool negative = sum.words_[kWords - 2] < 0;
    if (negative) {
      for (std::int64_t& w : sum.words_) w = -w;
      sum.carry();
    }
    double result = 0;
    for (std::size_t i = kWords - 1; i-- > 0;) result += std::ldexp(static_cast<double>(sum.words_[i]), 32 * static_cast<int>(i) + kLowest);
    return negative ? -result : result;
  }

  /// The words as they go into files and messages, carried: each but the highest in [0, 2^32).
  Words words() const {
    FixedPointSum sum = *this;
    sum.carry();
    return sum.words_;
  }
  void set_words(const Words& words) {
    words_ = words;
    carry();
  }

 private:
  static constexpr std::uint64_t kMask = 0xFFFFFFFFull;
  static constexpr int kSmallest = -1074, kLargest = 1024;  // exponents of doubles

  void carry() {
    for (std::size_t i = 0; i + 2 < kWords; ++i) {
      const std::int64_t over = words_[i] >> 32;  // rounds down, so that what stays is not negative
      words_[i] -= over * (std::int64_t{1} << 32);
      words_[i + 1] += over;
    }
    terms_ = 0;
  }

  Words words_{};
  std::int32_t terms_ = 0;
};

/// Without any rounding, as wide as the range of all doubles: 2098 bits or 66 words; one for the carry, one to count what is not finite.
using ExactSum = FixedPointSum<-1074, 68>;

/// For what there is one of for each triangle of a wall: from 2^-160 (7e-49) to 2^95 (4e28), in 80 bytes instead of 544. No sum of impulses
/// or energies in SI units comes near either end.
using ShortSum = FixedPointSum<-160, 10>;

/// Sums over all ranks; every rank gets them. Collective.
template <class Sum>
void add_over_ranks(MPI_Comm comm, std::vector<Sum>& sums) {
  std::vector<typename Sum::Words> words;
  words.reserve(sums.size());
  for (const Sum& s : sums) words.push_back(s.words());
  MPI_Allreduce(MPI_IN_PLACE, words.data(), static_cast<int>(words.size() * Sum::kWords), MPI_INT64_T, MPI_SUM, comm);
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i].set_words(words[i]);
}

/// The same of one sum. Collective.
inline ExactSum over_ranks(MPI_Comm comm, const ExactSum& sum) {
  std::vector<ExactSum> sums{sum};
  add_over_ranks(comm, sums);
  return sums.front();
}

/// Sums the words of many sums over all ranks: to be carried by set_words(). Collective.
inline void add_words_over_ranks(MPI_Comm comm, std::vector<std::int64_t>& words) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 27;  // numbers in one message are counted by an int
  for (std::size_t first = 0; first < words.size(); first += kAtOnce) {
    MPI_Allreduce(MPI_IN_PLACE, words.data() + first, static_cast<int>(std::min(kAtOnce, words.size() - first)), MPI_INT64_T, MPI_SUM,
                  comm);
  }
}

}  // namespace scree
