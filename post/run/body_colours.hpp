// What bodies can be coloured by in pictures and films: kinds, each with a colour of its own, or numbers on a scale.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "post/run/run_bodies.hpp"

namespace scree {

/// A quantity of every body of a frame.
struct BodyColours {
  std::string title;                 ///< "speed [m/s]"
  bool are_kinds = false;            ///< values are 0, 1, 2 ...; else numbers, or NaN where there is none
  std::vector<double> value;         ///< by row of the frame
  std::map<int, std::string> kinds;  ///< those that bodies of the run have at any time, by value; for a legend
};

/// Names that body_colours takes, in the order of the help.
const std::vector<std::string>& body_colour_names();
/// The same as one text, "shape, material, ... or id".
std::string body_colour_list();

/// in   name   one of body_colour_names
/// Fails: UsageError where the quantity is one of contacts and the run kept none.
BodyColours body_colours(const Run& run, const RunBodies& bodies, const Frame& frame, const std::string& name);

}  // namespace scree
