// Friction springs of a pair, from one step to the next. Source: docs/reference/contact-law.md section 3.4.
#pragma once

#include <cmath>
#include <vector>

#include "solver/contact/hand_over.hpp"
#include "solver/contact/pair_force.hpp"
#include "solver/contact/transport.hpp"
#include "solver/laws/friction.hpp"

namespace scree {

/// Friction of the features of one pair, taken in ascending order of their keys.
class PairFriction {
 public:
  /// in   springs   of the last step     in  next   takes those of this one
  /// in   push      where not null, features that press on nothing keep no spring [N]
  PairFriction(const PairFeatures& features, const std::vector<double>* push, const PairLaw& law, const PairMotion& motion,
               double friction_dt, const std::vector<FrictionSpring>& springs, const MeanTurn& turned, std::vector<FrictionSpring>& next)
      : features_(features),
        push_(push),
        law_(law),
        friction_dt_(friction_dt),
        rounding_(kStiffnessRounding * length(motion.centre_b)),
        springs_(springs),
        turned_(turned),
        next_(next) {}

  /// Tangential force on A at a feature.
  ///
  /// in   vt, vn    sliding and separation velocity [m/s]     in  push  of the feature, damping included [N]; of a law that pulls too, its
  ///                push alone: a contact at rest under its own attraction still presses
  /// in   kappa     tangential stiffness [N/m]     in  damping  of sliding [N s/m]
  /// inout elastic  energy in springs [J]
  /// out  slid   where not null and the feature slides: the work of friction on the way that its spring did not take up [J]
  [[gnu::always_inline]] Vec3 force(const ContactFeature& f, const Vec3& vt, double vn, double push, double kappa, double damping,
                                    double& elastic, double* slid) {
    const FrictionSpring* const old = old_of(f);
    // turn with the bodies' mean frame, and from there to the present normal
    const Vec3 carried = old != nullptr ? transported(turned_(old->force), turned_(old->normal), f.n) : Vec3{};
    const SlidingContact contact{f.n, vt, vn, f.overlap, kappa, damping, law_.friction * push, law_.friction_sliding * push};
    ContactSpring spring{{}, old != nullptr ? old->stiffness : 0.0};
    double stretched = 0;  // squared
    const Vec3 tangential = friction_force(contact, old != nullptr, carried, rounding_, friction_dt_, spring, stretched);
    const double limit = contact.slide_limit;
    if (slid != nullptr && spring.stiffness < 0 && stretched > limit * limit)
      *slid = limit * (std::sqrt(stretched) - limit) / -spring.stiffness;
    elastic = with_energy(spring, elastic);
    next_.push_back({f.key, spring.force, spring.stiffness, f.n});
    return tangential;
  }

 private:
  [[gnu::always_inline]] const FrictionSpring* old_of(const ContactFeature& f) {
    while (old_ < springs_.size() && springs_[old_].key < f.key) ++old_;
    if (old_ < springs_.size() && springs_[old_].key == f.key) return &springs_[old_];
    return springs_.empty() || !features_.hands_over ? nullptr : handed_over(f);
  }

  /// The spring of a feature that has gone, for one that has come in its place.
  [[gnu::noinline]] const FrictionSpring* handed_over(const ContactFeature& f) {
    if (!is_handed_over(f.key)) return nullptr;
    if (handed_over_ == nullptr) handed_over_ = &find_handed_over(features_.list, push_, springs_, turned_);
    for (const HandedOver& h : *handed_over_)
      if (h.feature == f.key) return h.spring;
    return nullptr;
  }

  const PairFeatures& features_;
  const std::vector<double>* push_;
  const PairLaw& law_;
  double friction_dt_, rounding_;
  const std::vector<FrictionSpring>& springs_;
  const MeanTurn& turned_;
  std::vector<FrictionSpring>& next_;
  std::size_t old_ = 0;
  const std::vector<HandedOver>* handed_over_ = nullptr;  // once it is asked for
};

}  // namespace scree
