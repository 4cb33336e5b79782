// What passed the inlets and outlets of a run: mass flow over time, residence times, and sizes, from inserted.csv and removed.csv.
//
// The residence time distribution of an outlet is E(t) dt, the share of the mass that left after t to t + dt, and F(t), the share that left
// after at most t. Source: P. V. Danckwerts, Continuous flow systems, Chem. Eng. Sci. 2 (1953) 1. Bodies that are still inside at the end
// have no residence time: of a run that is short, the distribution lacks its long times.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "post/run/run_folder.hpp"
#include "post/statistics/block_average.hpp"

namespace scree {

/// A body that came in or went out.
struct Passage {
  double time = 0, mass = 0, diameter = 0;  ///< [s], [kg]; of the sphere of equal volume [m]
  double residence = 0;                     ///< since it came in, or since the start [s]; of what came in: 0
};

/// An inlet, an outlet, the sides of the domain, or the program that stepped the run.
struct Gate {
  std::string name;  ///< "inlet feed", "outlet chute", "sides of the domain", "inserted by the program"
  bool lets_in = false;
  std::vector<Passage> passed{};     ///< within the chosen time, in its order
  double mass = 0;                   ///< of them [kg]
  std::vector<double> cumulative{};  ///< mass that has passed by the end of each interval [kg]
  std::vector<double> rate{};        ///< in each interval [kg/s]
  Average flow{};                    ///< of the rates, in blocks of intervals [kg/s]
  Average residence{};               ///< by mass, without an interval of confidence [s]; a count of 0 where nothing has one
  double deviation = 0, median = 0;  ///< of the residence times, by mass [s]
};

struct Flow {
  double from = 0, to = 0;    ///< [s]
  double width = 0;           ///< of an interval [s]
  std::vector<double> times;  ///< ends of the intervals [s]
  std::vector<Gate> gates;    ///< those through which something can pass: inlets, outlets, the sides if bodies are removed there
  std::string missing;        ///< why there is nothing, though bodies come in or go out: a table that was not copied with the run
  bool empty() const { return gates.empty(); }
};

/// in   from, to   time [s]; bodies that passed later than `from` count, those at the start of the run included
/// in   blocks     see BlockAverage
/// Fails: InputError (a table that is damaged, or names what the scene does not have: file and line).
Flow read_flow(const Run& run, double from, double to, std::size_t blocks);

/// The share of the mass, in steps: at each value of one of `Passage`'s numbers the share of what passed that has at most that.
struct ShareCurve {
  std::vector<double> value, share;
};
ShareCurve share_curve(const Gate& gate, double Passage::*number);

/// E(t) in intervals of equal length from 0: their ends [s], densities [1/s], and F(t) at the ends.
struct Density {
  double width = 0;  ///< [s]
  std::vector<double> end, value, share;
};
Density residence_density(const Gate& gate);

nlohmann::json json_of(const Flow& flow);

}  // namespace scree
