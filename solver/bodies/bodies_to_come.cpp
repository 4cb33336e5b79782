#include "solver/bodies/bodies_to_come.hpp"

namespace scree {

std::vector<ParticleRecord> bodies_to_come(const SolverScene& scene) {
  std::vector<ParticleRecord> records;
  for (const Inlet& inlet : scene.source().inlets) {
    for (const Inlet::Share& share : inlet.shares) {
      const Shape& shape = scene.source().shapes[static_cast<std::size_t>(share.shape)];
      const auto [smallest, largest] = scales_of(inlet.size, shape);
      for (const double scale : {smallest, largest}) {
        // two of each: they may touch each other
        for (int twice = 0; twice < 2; ++twice) {
          records.push_back(make_record(scene, {kIdToCome + static_cast<std::int64_t>(records.size()),
                                                share.shape,
                                                inlet.material,
                                                false,
                                                false,
                                                scale,
                                                {},
                                                {},
                                                inlet.velocity,
                                                inlet.angular_velocity}));
        }
      }
    }
  }
  return records;
}

}  // namespace scree
