// Friction springs of a pair, from one step to the next. Source: docs/reference/contact-law.md section 3.4.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solver/contact/hand_over.hpp"
#include "solver/contact/pair_force.hpp"
#include "solver/contact/transport.hpp"

namespace scree {

/// Share of itself by which rounding moves the stiffness of a feature, times the overlap over the distance of the two bodies: the
/// stiffness goes with powers of the overlap up to the seventh, and the overlap is a difference of places. The worst of 1e7 values in a
/// stiff heap at rest is 35 epsilon.
inline constexpr double kStiffnessRounding = 64 * std::numeric_limits<double>::epsilon();

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
  /// in   vt, vn    sliding and separation velocity [m/s]     in  push  of the feature, damping included [N]
  /// in   kappa     tangential stiffness [N/m]     in  damping  of sliding [N s/m]
  /// inout elastic  energy in springs [J]
  /// out  slid   where not null and the feature slides: the work of friction on the way that its spring did not take up [J]
  [[gnu::always_inline]] Vec3 force(const ContactFeature& f, const Vec3& vt, double vn, double push, double kappa, double damping,
                                    double& elastic, double* slid) {
    bool slides = false;
    Vec3 spring = spring_of(f, vt, vn, kappa, slides);
    slides = slides && dot(spring, vt) < 0;  // it sticks again once it no longer moves against its spring
    const double sliding = law_.friction_sliding * push, limit = slides ? sliding : law_.friction * push;
    // (of a law that pulls too, its push alone: a contact at rest under its own attraction still presses)
    // squares: the root is taken only where something slides
    const double stretched = squared_length(spring);
    if (stretched > limit * limit) {
      slides = true;
      const double stretch = std::sqrt(stretched);
      spring *= sliding / stretch;
      if (slid != nullptr && kappa > 0) *slid = sliding * (stretch - sliding) / kappa;
    }
    Vec3 tangential = spring - damping * vt;
    const double total = squared_length(tangential), cap = slides ? sliding : limit;
    if (total > cap * cap) tangential *= cap / std::sqrt(total);
    if (kappa > 0) elastic += 0.5 * squared_length(spring) / kappa;
    next_.push_back({f.key, spring, slides ? -kappa : kappa, f.n});
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

  /// out  slides   whether it did in the last step
  [[gnu::always_inline]] Vec3 spring_of(const ContactFeature& f, const Vec3& vt, double vn, double& kappa, bool& slides) {
    const FrictionSpring* const old = old_of(f);
    if (old == nullptr) {
      // a new feature has slid only since it touched; one that has not yet has no stiffness
      return (-kappa * (f.overlap > 0 && f.overlap < -vn * friction_dt_ ? f.overlap / -vn : friction_dt_)) * vt;
    }
    slides = old->stiffness < 0;
    // turn with the bodies' mean frame, and from there to the present normal
    Vec3 s = transported(turned_(old->force), turned_(old->normal), f.n);
    // Unloading gives force back in proportion; loading must not create any (passivity, docs/reference/contact-law.md 3.4). A load that
    // only rounding moves up and down is neither (docs/develop/decisions/012): springs would lose a little each time, and a stiff heap
    // would creep indefinitely.
    const double before = std::abs(old->stiffness);
    if (std::abs(kappa - before) * f.overlap <= rounding_ * before) kappa = before;
    if (kappa < before) s *= kappa / before;
    return s - (kappa * friction_dt_) * vt;
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
