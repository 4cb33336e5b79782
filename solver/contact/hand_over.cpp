#include "solver/contact/hand_over.hpp"

#include <algorithm>
#include <cstddef>

#include "solver/contact/transport.hpp"

namespace scree {

namespace {

struct Possible {
  double cosine;
  std::size_t feature, spring;
};

/// A thread's lists, so that nothing is allocated for each pair.
struct HandOverWorkspace {
  std::vector<std::size_t> features, springs;  // without one of the same key
  std::vector<Possible> possible;
  std::vector<HandedOver> handed_over;
};

}  // namespace

const std::vector<HandedOver>& find_handed_over(const std::vector<ContactFeature>& features, const std::vector<double>* push,
                                                const std::vector<FrictionSpring>& springs, const MeanTurn& turned) {
  thread_local HandOverWorkspace work;
  work.features.clear();
  work.springs.clear();
  work.possible.clear();
  work.handed_over.clear();

  // what is left once equal keys have found each other
  std::size_t old = 0;
  for (std::size_t j = 0; j < features.size(); ++j) {
    for (; old < springs.size() && springs[old].key < features[j].key; ++old)
      if (is_handed_over(springs[old].key)) work.springs.push_back(old);
    if (old < springs.size() && springs[old].key == features[j].key)
      ++old;
    else if (is_handed_over(features[j].key) && (push == nullptr || (*push)[j] > 0))
      work.features.push_back(j);
  }
  for (; old < springs.size() && is_handed_over(springs[old].key); ++old) work.springs.push_back(old);

  for (const std::size_t s : work.springs) {
    const Vec3 n = turned(springs[s].normal);
    const bool any_way = squared_length(n) == 0;  // of an older checkpoint
    for (const std::size_t j : work.features) {
      if (owner_of_key(features[j].key) != owner_of_key(springs[s].key)) continue;
      const double cosine = any_way ? 1 : dot(n, features[j].n);
      if (cosine > kHandOverCosine) work.possible.push_back({cosine, j, s});
    }
  }
  std::sort(work.possible.begin(), work.possible.end(), [](const Possible& l, const Possible& r) {
    if (l.cosine != r.cosine) return l.cosine > r.cosine;
    return l.feature != r.feature ? l.feature < r.feature : l.spring < r.spring;
  });
  for (const Possible& p : work.possible) {
    const FrictionSpring* const spring = &springs[p.spring];
    const std::int64_t feature = features[p.feature].key;
    const bool taken = std::any_of(work.handed_over.begin(), work.handed_over.end(),
                                   [&](const HandedOver& h) { return h.feature == feature || h.spring == spring; });
    if (!taken) work.handed_over.push_back({feature, spring});
  }
  return work.handed_over;
}

}  // namespace scree
