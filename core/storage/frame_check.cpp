#include "core/storage/frame_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"
#include "core/storage/json_object.hpp"
#include "core/storage/written_by_program.hpp"

namespace scree {

namespace {

constexpr const char* kNotOfThisScene = "frame and scene.h5 do not belong together, or the frame is damaged";

/// Ids that a body of a frame may have.
class KnownBodies {
 public:
  KnownBodies(const Scene& scene, bool more_come) : ids_(scene.bodies.id), more_come_(more_come) {
    if (!std::is_sorted(ids_.begin(), ids_.end())) std::sort(ids_.begin(), ids_.end());
    largest_ = ids_.empty() ? -1 : ids_.back();
    for (const Wall& wall : scene.walls) largest_ = std::max(largest_, wall.id);
  }
  /// Bodies that come in have ids above all others.
  bool contains(std::int64_t id) const { return id > largest_ ? more_come_ : std::binary_search(ids_.begin(), ids_.end(), id); }

 private:
  std::vector<std::int64_t> ids_;
  bool more_come_;
  std::int64_t largest_ = -1;
};

/// Names a row, for the message of one that is wrong: a frame has millions that are not.
auto row_of(const char* table, std::size_t i) {
  return [table, i] { return fmt::format("row {} of its {}", i, table); };
}

/// More than any machine has; one more is still an int.
constexpr std::int32_t kMostRanks = 100'000'000;

class Checker {
 public:
  Checker(const Scene& scene, const std::string& path) : scene_(scene), path_(path) {}

  /// in   more_come   bodies come in that the scene does not have
  void bodies(const FrameBodies& b, bool more_come) const {
    const KnownBodies known(scene_, more_come);
    if (scene_.settings.heat && !b.has_temperature && b.size() > 0)
      throw InputError("{}: has no temperatures, which the scene asks for ([heat]); {}", path_, kNotOfThisScene);
    for (std::size_t i = 0; i < b.size(); ++i) {
      const auto who = [&] { return fmt::format("body {}", b.id[i]); };
      if (!known.contains(b.id[i])) throw InputError("{}: holds {}, which the scene does not have; {}", path_, who(), kNotOfThisScene);
      index(who, "shape", b.shape[i], scene_.shapes.size());
      index(who, "material", b.material[i], scene_.materials.size());
      if (b.rank[i] < 0 || b.rank[i] >= kMostRanks)
        throw wrong(who(), fmt::format("rank {}, the number of an MPI rank expected", b.rank[i]));
      if (!(b.scale[i] > 0) || !std::isfinite(b.scale[i])) throw wrong(who(), fmt::format("scale {:g}, a value > 0 expected", b.scale[i]));
      if (!is_finite(b.position[i]) || !is_finite(b.velocity[i]) || !is_finite(b.angular_velocity[i]))
        throw wrong(who(), "a position or velocity that is not a finite number");
      expect_unit(who, b.orientation[i]);
    }
  }

  void walls(const FrameWalls& w) const {
    for (std::size_t i = 0; i < w.size(); ++i) {
      const auto who = [&] { return fmt::format("wall {}", w.id[i]); };
      wall(w.id[i], "its walls");
      if (!is_finite(w.position[i])) throw wrong(who(), "a position that is not a finite number");
      expect_unit(who, w.orientation[i]);
    }
  }

  void cell(const FrameCell& c) const {
    if (c.size() != (scene_.settings.cell ? 1 : 0))
      throw InputError("{}: has {} periodic cells, which the scene does not ask for; {}", path_, c.size(), kNotOfThisScene);
    for (std::size_t i = 0; i < c.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        if (!(c.lower[i][k] < c.upper[i][k]) || !std::isfinite(c.upper[i][k] - c.lower[i][k]))
          throw wrong("the periodic cell", "corners that are none");
      }
      if (!is_finite(c.shear[i])) throw wrong("the periodic cell", "a shear that is not a finite number");
    }
  }

  void maps(const FrameLoads& loads, const FrameWear& wear) const {
    for (std::size_t i = 0; i < loads.size(); ++i)
      index(row_of("loads", i), "triangle", loads.triangle[i], mesh_of(loads.wall[i], "its loads").triangles.size());
    for (std::size_t i = 0; i < wear.size();) {
      const std::int64_t id = wear.wall[i];
      const std::size_t first = i, vertices = mesh_of(id, "its wear").vertices.size();
      for (; i < wear.size() && wear.wall[i] == id; ++i) {
        if (!is_finite(wear.vertex[i])) throw wrong(fmt::format("wall {}", id), "a worn vertex that is not a finite number");
      }
      if (i - first != vertices) throw wrong(fmt::format("wall {}", id), fmt::format("{} worn vertices, {} expected", i - first, vertices));
    }
  }

  template <class Table>
  void materials(const Table& table, const char* what) const {
    for (std::size_t i = 0; i < table.size(); ++i) {
      for (const std::int32_t m : {table.material_a[i], table.material_b[i]})
        index(row_of(what, i), "material", m, scene_.materials.size());
    }
  }

  /// All counts together are a number too: sums and differences of them cannot overflow.
  void counts(const FrameImpacts& impacts) const {
    std::int64_t normal_room = std::numeric_limits<std::int64_t>::max(), shear_room = normal_room;
    for (std::size_t i = 0; i < impacts.size(); ++i) {
      take(normal_room, impacts.normal_count[i], "normal_count", i);
      take(shear_room, impacts.shear_count[i], "shear_count", i);
    }
  }

  void bonds(const FrameBonds& b) const {
    for (std::size_t i = 0; i < b.size(); ++i) {
      index(row_of("bonds", i), "bond", b.bond[i], scene_.bonds.size());
      if (i > 0 && b.bond[i] == b.bond[i - 1]) throw InputError("{}: bond {} occurs twice; the file is damaged", path_, b.bond[i]);
    }
  }

 private:
  InputError wrong(const std::string& who, const std::string& what) const {
    return InputError("{}: {} has {}; the frame is damaged", path_, who, what);
  }
  void take(std::int64_t& room, std::int64_t count, const char* what, std::size_t row) const {
    if (count < 0 || count > room) throw wrong(row_of("impacts", row)(), fmt::format("{} {}, a number of impacts expected", what, count));
    room -= count;
  }
  template <class Who>
  void index(const Who& who, const char* what, std::int64_t value, std::size_t count) const {
    if (value >= 0 && value < static_cast<std::int64_t>(count)) return;
    throw InputError("{}: {} has {} {}, but the scene has {} {}s; {}", path_, who(), what, value, count, what, kNotOfThisScene);
  }
  template <class Who>
  void expect_unit(const Who& who, const Quat& q) const {
    if (!(std::abs(norm(q) - 1) <= kUnitTolerance)) throw wrong(who(), fmt::format("an orientation of norm {:.9g}, 1 expected", norm(q)));
  }
  const Wall& wall(std::int64_t id, const char* what) const {
    const auto found = std::find_if(scene_.walls.begin(), scene_.walls.end(), [id](const Wall& w) { return w.id == id; });
    if (found == scene_.walls.end())
      throw InputError("{}: {} name wall {}, which the scene does not have; {}", path_, what, id, kNotOfThisScene);
    return *found;
  }
  const TriangleMesh& mesh_of(std::int64_t id, const char* what) const {
    const Wall& w = wall(id, what);
    if (w.kind != WallKind::mesh) throw InputError("{}: {} name wall {}, which is no mesh; {}", path_, what, id, kNotOfThisScene);
    return scene_.shapes[static_cast<std::size_t>(w.shape)].mesh;
  }

  const Scene& scene_;
  const std::string& path_;
};

}  // namespace

void check_frame(const Scene& scene, const Frame& frame, const std::string& path, bool has_program) {
  const Checker check(scene, path);
  check.bodies(frame.bodies, !scene.inlets.empty() || has_program || is_written_by_program(*frame.provenance));
  check.walls(frame.walls);
  check.cell(frame.cell);
  check.maps(frame.loads, frame.wear);
  check.materials(frame.impacts, "impacts");
  check.counts(frame.impacts);
  check.materials(frame.losses, "losses");
  check.bonds(frame.bonds);
}

}  // namespace scree
