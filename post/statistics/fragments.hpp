// Fragments: bodies that bonds hold together, frame by frame.
#pragma once

#include <string>
#include <vector>

#include "post/run/run_folder.hpp"

namespace scree {

/// Bodies that are connected by bonds that hold.
struct Fragment {
  std::int64_t id = 0;      ///< the lowest of its bodies
  std::int64_t parent = 0;  ///< the lowest of the bodies that it was connected with at the start
  std::int64_t pieces = 0;
  double mass = 0;      ///< [kg]
  double diameter = 0;  ///< of the ball of equal volume [m]
};

/// Of all bodies that bonds held at the start, those that are in the frame; by parent, then falling mass.
/// in   holding   indices of the bonds that hold in the frame
/// Cost: O(bonds log bonds).
std::vector<Fragment> fragments_of(const Scene& scene, const FrameBodies& bodies, const std::vector<std::int64_t>& holding);

struct FragmentNumbers {
  std::size_t fragments = 0;
  double largest_share = 1;  ///< mass of the largest fragment of each parent over its own, mean of all parents by mass
  double t10 = 0;            ///< share of the mass in fragments of less than a tenth of the diameter of their parent
  double present = 1;        ///< share of the mass that is there: what has left counts as neither of both
};
/// in   fragments, at_start   of the same scene
FragmentNumbers numbers_of(const std::vector<Fragment>& fragments, const std::vector<Fragment>& at_start);

/// time,bonds,fragments,largest_share,t10,present: one row a frame; and of the last frame id,parent,pieces,mass,diameter: one row a
/// fragment.
/// in   sizes   second table; empty: none
///
/// Fails: InputError when the run has no bonds.
std::string write_fragments(const Run& run, const std::string& path, const std::string& sizes);

}  // namespace scree
