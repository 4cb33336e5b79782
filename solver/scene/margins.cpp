// Margins of a scene: what it needs of them, and how much room they leave.
#include <algorithm>

#include "core/base/error.hpp"
#include "solver/scene/solver_scene.hpp"

namespace scree {

void SolverScene::check_margin(ShapeKind kind) const {
  if (margins_by_size()) {
    if (kind == ShapeKind::solid && !(scene_->settings.margin_ratio > 0))
      throw UsageError("contact.margin_ratio = {:g}; meshes need a margin > 0 (typically .01 to .1)", scene_->settings.margin_ratio);
    return;
  }
  if (kind != ShapeKind::sphere && !(margin_ > 0)) {
    throw UsageError("contact.margin = {:g} m; meshes need a margin > 0 (typically 1 to 3 % of the body's size)", margin_);
  }
}

void SolverScene::find_max_overlaps() {
  if (!margins_by_size()) {
    smallest_max_overlap_ = largest_max_overlap_ = 2 * margin_;
    return;
  }
  const bool has_mesh_walls =
      std::any_of(scene_->walls.begin(), scene_->walls.end(), [](const Wall& w) { return w.kind == WallKind::mesh; });
  const bool has_meshes = extremes_.largest_margin > 0, has_balls = extremes_.least_ball < BodyExtremes::kNone;
  if (has_meshes) {
    // mesh walls and balls have no margin beside that of the body
    smallest_max_overlap_ = (has_mesh_walls || has_balls ? 1 : 2) * extremes_.least_margin;
    largest_max_overlap_ = 2 * extremes_.largest_margin;
  }
  if (!has_balls || !(has_meshes || has_mesh_walls)) return;
  smallest_max_overlap_ = has_meshes ? std::min(smallest_max_overlap_, extremes_.least_ball) : extremes_.least_ball;
  largest_max_overlap_ = std::max(largest_max_overlap_, *std::max_element(extremes_.radius.begin(), extremes_.radius.end()));
}

void SolverScene::check_on_overlap() const {
  const Settings& settings = scene_->settings;
  if (!continues()) return;
  if (settings.gather != Gathering::potential)
    throw UsageError("contact.on_overlap = \"continue\" goes with contact.gather = \"potential\" only");
  if (settings.barrier > 0)
    throw UsageError("contact.on_overlap = \"continue\" does not go with contact.barrier, which lets no surfaces meet");
  // Of a case, pack asks for a wall that moves. A run that goes on where all motions have ended may begin with such contacts, and has none.
}

PairLaw SolverScene::for_max_overlap(const PairLaw& law, double max_overlap) const {
  PairLaw fitted = law;
  fitted.margin = max_overlap;
  if (scene_->settings.gather == Gathering::area && max_overlap > 0) fitted.stiffness = law.layer_modulus / max_overlap;
  return fitted;
}

}  // namespace scree
