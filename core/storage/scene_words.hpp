// The choices of a scene that cases and scene files name by a word. In memory they are enums; a new value is one line in its enum and
// one in its table of words.
#pragma once

#include <cstdint>

#include "core/base/words.hpp"

namespace scree {

/// How the step follows what happens: always the same, or halved where speed, spin or contacts require it.
enum class StepControl { fixed, quantised };
template <>
inline constexpr auto kWordsOf<StepControl> = std::to_array<Word<StepControl>>({{StepControl::fixed, "fixed"},
                                                                                {StepControl::quantised, "quantised"}});

/// What happens to a body that leaves the domain: the run stops, the body is taken out, or it flies on.
enum class Outside { stop, remove, keep };
template <>
inline constexpr auto kWordsOf<Outside> =
    std::to_array<Word<Outside>>({{Outside::stop, "stop"}, {Outside::remove, "remove"}, {Outside::keep, "keep"}});

/// What an inlet does when its next body finds no room: it waits until there is, or the run stops.
enum class WhenFull { wait, stop };
template <>
inline constexpr auto kWordsOf<WhenFull> = std::to_array<Word<WhenFull>>({{WhenFull::wait, "wait"}, {WhenFull::stop, "stop"}});

/// Drag of a fluid on a body (solver/bodies/fluid.hpp).
enum class Drag { haider_levenspiel, stokes };
template <>
inline constexpr auto kWordsOf<Drag> = std::to_array<Word<Drag>>({{Drag::haider_levenspiel, "haider-levenspiel"},
                                                                  {Drag::stokes, "stokes"}});

/// The law of a contact: normal force and damping. The list is contact_laws.inc.
#define SCREE_CONTACT_LAW(name, word, normal, damping) name,
enum class ContactLaw {
#include "core/storage/contact_laws.inc"
};
#undef SCREE_CONTACT_LAW
#define SCREE_CONTACT_LAW(name, word, normal, damping) {ContactLaw::name, word},
template <>
inline constexpr auto kWordsOf<ContactLaw> = std::to_array<Word<ContactLaw>>({
#include "core/storage/contact_laws.inc"
});
#undef SCREE_CONTACT_LAW

/// How contacts become the force of a pair: one potential, an elastic layer over the facing area, or one spring per pair of triangles.
enum class Gathering { potential, area, pairs };
template <>
inline constexpr auto kWordsOf<Gathering> =
    std::to_array<Word<Gathering>>({{Gathering::potential, "potential"}, {Gathering::area, "area"}, {Gathering::pairs, "pairs"}});

/// Weights of vertices in gather = "potential": by how densely they lie, or all 1 (solver/scene/density_weights.hpp).
enum class VertexWeights { density, unit };
template <>
inline constexpr auto kWordsOf<VertexWeights> = std::to_array<Word<VertexWeights>>({{VertexWeights::density, "density"},
                                                                                    {VertexWeights::unit, "unit"}});

/// Where bodies touch: where their surfaces were drawn, or one margin outside (core/surface/touch_surface.hpp).
enum class TouchAt { drawn, outside };
template <>
inline constexpr auto kWordsOf<TouchAt> = std::to_array<Word<TouchAt>>({{TouchAt::drawn, "drawn"}, {TouchAt::outside, "outside"}});

/// What happens where bodies are pressed deeper into each other than the law has room for: the run stops, or the force goes on along the
/// law's tangent and the contact is counted (solver/contact/overlap_limit.hpp).
enum class OnOverlap { stop, proceed };
template <>
inline constexpr auto kWordsOf<OnOverlap> = std::to_array<Word<OnOverlap>>({{OnOverlap::stop, "stop"}, {OnOverlap::proceed, "continue"}});

/// How a step moves the bodies (solver/bodies/motion.hpp).
enum class Integrator { kdk_dlm, rig, spiral, midpoint, euler };
template <>
inline constexpr auto kWordsOf<Integrator> = std::to_array<Word<Integrator>>({{Integrator::kdk_dlm, "kdk-dlm"},
                                                                              {Integrator::rig, "rig"},
                                                                              {Integrator::spiral, "spiral"},
                                                                              {Integrator::midpoint, "midpoint"},
                                                                              {Integrator::euler, "euler"}});

/// Rolling resistance: a spring that yields (type C), or a constant moment (type A).
enum class RollingModel { elastic_plastic, constant };
template <>
inline constexpr auto kWordsOf<RollingModel> = std::to_array<Word<RollingModel>>({{RollingModel::elastic_plastic, "elastic-plastic"},
                                                                                  {RollingModel::constant, "constant"}});

/// How the pull-off force of a contact follows from the work of adhesion: 3/2 pi w R* or 2 pi w R*.
enum class AdhesionModel { jkr, dmt };
template <>
inline constexpr auto kWordsOf<AdhesionModel> = std::to_array<Word<AdhesionModel>>({{AdhesionModel::jkr, "jkr"},
                                                                                    {AdhesionModel::dmt, "dmt"}});

/// Where a liquid bridge breaks: (1 + theta / 2) (V^(1/3) + 0.1 V^(2/3) / R) (Willett 2000), or without the last term (Lian 1993).
enum class BridgeRupture { willett, lian };
template <>
inline constexpr auto kWordsOf<BridgeRupture> = std::to_array<Word<BridgeRupture>>({{BridgeRupture::willett, "willett"},
                                                                                    {BridgeRupture::lian, "lian"}});

/// What a wall is to the heat of bodies that touch it: nothing passes; a temperature; a power; an outside temperature behind a resistance.
enum class WallHeatKind { adiabatic, isothermal, flux, exchange };
template <>
inline constexpr auto kWordsOf<WallHeatKind> = std::to_array<Word<WallHeatKind>>({{WallHeatKind::adiabatic, "adiabatic"},
                                                                                  {WallHeatKind::isothermal, "isothermal"},
                                                                                  {WallHeatKind::flux, "flux"},
                                                                                  {WallHeatKind::exchange, "exchange"}});

enum class WallKind : std::int32_t { plane = 0, box_inside = 1, cylinder_inside = 2, sphere_inside = 3, mesh = 4 };
template <>
inline constexpr auto kWordsOf<WallKind> = std::to_array<Word<WallKind>>({{WallKind::plane, "plane"},
                                                                          {WallKind::box_inside, "box_inside"},
                                                                          {WallKind::cylinder_inside, "cylinder_inside"},
                                                                          {WallKind::sphere_inside, "sphere_inside"},
                                                                          {WallKind::mesh, "mesh"}});

}  // namespace scree
