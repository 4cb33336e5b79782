// The energies of a scene, as the log lists and balances them.
#pragma once

namespace scree {

/// Energies of the whole scene [J], at a full step.
struct Energies {
  double translational = 0, rotational = 0, potential = 0, elastic = 0, tangential_elastic = 0;
  double dissipated = 0;  ///< accumulated from the damping and friction forces, never the remainder
  double wall_work = 0;   ///< done by driven walls on the bodies
  double outer_work = 0;  ///< done by forces from outside the simulation
  double cell_work = 0;   ///< done by a periodic cell that deforms on the bodies
  double removed = 0;     ///< kinetic and potential, taken away by bodies that left the domain
  double arrived = 0;     ///< kinetic and potential, brought by bodies that joined after the start
  double bond = 0;        ///< of the bonds that hold
  double fracture = 0;    ///< of bonds as they broke, less that of the contacts that took their place
  double slept = 0;       ///< kinetic, of bodies as they fell asleep
  double balance() const {
    return translational + rotational + potential + elastic + tangential_elastic + dissipated - wall_work - outer_work - cell_work +
           removed - arrived + bond + fracture + slept;
  }
};

}  // namespace scree
