// Functions of scree_engine.h: walls, measures, states, bodies that come and go.
#include <cstring>
#include <tuple>

#include "solver/engine/c_call.hpp"

using namespace scree;

namespace {

template <class Column>
const double* numbers_of(const std::vector<Column>& column) {
  static const double kNone = 0;
  return column.empty() ? &kNone : reinterpret_cast<const double*>(column.data());
}

}  // namespace

int scree_wall_count(const scree_engine* engine) { return static_cast<int>(engine->run->scene().walls.size()); }
const char* scree_wall_name(const scree_engine* engine, int wall) {
  const auto& walls = engine->run->scene().walls;
  return wall < 0 || static_cast<std::size_t>(wall) >= walls.size() ? nullptr : walls[static_cast<std::size_t>(wall)].name.c_str();
}
int scree_wall_loads(scree_engine* engine, double* loads) {
  if (const int code = need(loads != nullptr, "wall_loads: the place for the loads"); code != SCREE_DONE) return code;
  return called(engine, "wall_loads", [&](HostedRun& run) {
    const auto all = run.wall_loads();
    for (std::size_t w = 0; w < all.size(); ++w) std::copy(all[w].begin(), all[w].end(), loads + 6 * w);
    return SCREE_DONE;
  });
}
int scree_wall_state(scree_engine* engine, int wall, double* state) {
  if (wall < 0 || wall >= scree_wall_count(engine) || state == nullptr)
    return fail(SCREE_USAGE, "wall_state: the scene has no wall of this number");
  return mapped([&] {
    const auto numbers = engine->run->wall_state(static_cast<std::size_t>(wall));
    std::copy(numbers.begin(), numbers.end(), state);
    return SCREE_DONE;
  });
}

int scree_drive_wall(scree_engine* engine, int wall, double rate) {
  if (wall < 0 || wall >= scree_wall_count(engine)) return fail(SCREE_USAGE, "drive_wall: the scene has no wall of this number");
  return called(engine, "drive_wall", [&](HostedRun& run) {
    run.drive_wall(static_cast<std::size_t>(wall), rate);
    return SCREE_DONE;
  });
}
int scree_wall_way(scree_engine* engine, int wall, double* way, double* rate) {
  if (wall < 0 || wall >= scree_wall_count(engine) || way == nullptr || rate == nullptr)
    return fail(SCREE_USAGE, "wall_way: the scene has no wall of this number, or a place for a number is NULL");
  return mapped([&] {
    std::tie(*way, *rate) = engine->run->wall_way(static_cast<std::size_t>(wall));
    return SCREE_DONE;
  });
}

int scree_get_energies(scree_engine* engine, scree_energies* to) {
  if (const int code = need(to != nullptr, "energies: the place for them"); code != SCREE_DONE) return code;
  return called(engine, "energies", [&](HostedRun& run) {
    const Energies e = run.energies();
    *to = {e.translational,
           e.rotational,
           e.potential,
           e.elastic,
           e.tangential_elastic,
           e.dissipated,
           e.wall_work,
           e.outer_work + e.cell_work,
           e.removed,
           e.arrived,
           e.bond,
           e.fracture,
           e.slept,
           e.balance()};
    return SCREE_DONE;
  });
}
int scree_get_heat(scree_engine* engine, scree_heat* to) {
  if (const int code = need(to != nullptr, "heat: the place for it"); code != SCREE_DONE) return code;
  return called(engine, "heat", [&](HostedRun& run) {
    const HeatMeasures h = run.heat();
    *to = {h.stored,           h.totals[kMade], h.totals[kMadeInWalls], h.totals[kFromSources],
           h.from_program,     h.from_medium,   h.from_all_walls,       h.totals[kArrived],
           h.totals[kRemoved], h.balance,       h.critical_step,        h.biot};
    return SCREE_DONE;
  });
}
int scree_state_hash(scree_engine* engine, char* text33) {
  if (const int code = need(text33 != nullptr, "state_hash: the place for the text"); code != SCREE_DONE) return code;
  return called(engine, "state_hash", [&](HostedRun& run) {
    const std::string hash = run.state_hash();
    constexpr std::size_t kDigits = 32;
    std::memcpy(text33, hash.c_str(), kDigits + 1);
    return SCREE_DONE;
  });
}
int scree_critical_step(scree_engine* engine, double* step) {
  if (const int code = need(step != nullptr, "critical_step: the place for it"); code != SCREE_DONE) return code;
  return called(engine, "critical_step", [&](HostedRun& run) {
    *step = run.critical_step();
    return SCREE_DONE;
  });
}
int scree_contacts(scree_engine* engine, int64_t* count) {
  if (const int code = need(count != nullptr, "contacts: the place for their number"); code != SCREE_DONE) return code;
  return called(engine, "contacts", [&](HostedRun& run) {
    engine->contacts = &run.collect_contacts();
    *count = static_cast<std::int64_t>(engine->contacts->size());
    return SCREE_DONE;
  });
}
const double* scree_contact_reals(const scree_engine* engine, const char* field) {
  const std::string name = text_or_empty(field);
  if (engine->contacts != nullptr) {
    const FrameContacts& c = *engine->contacts;
    if (name == "overlap") return numbers_of(c.overlap);
    if (name == "margin") return numbers_of(c.margin);
    if (name == "normal_force") return numbers_of(c.normal_force);
    if (name == "point") return numbers_of(c.point);
    if (name == "normal") return numbers_of(c.normal);
    if (name == "tangential_force") return numbers_of(c.tangential_force);
  }
  fail(SCREE_USAGE, "contacts have no field '" + name + "' of real numbers, or were not collected by scree_contacts()");
  return nullptr;
}
const int64_t* scree_contact_integers(const scree_engine* engine, const char* field) {
  static const std::int64_t kNone = 0;
  const std::string name = text_or_empty(field);
  if (engine->contacts != nullptr) {
    const FrameContacts& c = *engine->contacts;
    const auto* column = name == "body_a" ? &c.body_a : name == "body_b" ? &c.body_b : name == "feature" ? &c.feature : nullptr;
    if (column != nullptr) return column->empty() ? &kNone : column->data();
  }
  fail(SCREE_USAGE, "contacts have no field '" + name + "' of whole numbers, or were not collected by scree_contacts()");
  return nullptr;
}

int scree_save(scree_engine* engine, scree_state** state) {
  if (const int code = need(state != nullptr, "save: the place for the state"); code != SCREE_DONE) return code;
  *state = nullptr;
  return called(engine, "save", [&](HostedRun& run) {
    *state = new scree_state{run.save()};
    return SCREE_DONE;
  });
}
int scree_restore(scree_engine* engine, const scree_state* state) {
  if (const int code = need(state != nullptr, "restore: the state"); code != SCREE_DONE) return code;
  return called(engine, "restore", [&](HostedRun& run) {
    run.restore(*state->state);
    return SCREE_DONE;
  });
}
void scree_free_state(scree_state* state) { delete state; }
int scree_write_checkpoint(scree_engine* engine, const char* folder) {
  if (const int code = need(folder != nullptr, "write_checkpoint: the folder"); code != SCREE_DONE) return code;
  return called(engine, "write_checkpoint", [&](HostedRun& run) {
    run.write_checkpoint(folder);
    return SCREE_DONE;
  });
}
int scree_write_frame(scree_engine* engine, const char* path) {
  if (const int code = need(path != nullptr, "write_frame: the path"); code != SCREE_DONE) return code;
  return called(engine, "write_frame", [&](HostedRun& run) {
    run.write_frame(path);
    return SCREE_DONE;
  });
}

int scree_insert(scree_engine* engine, int64_t n, const scree_new_body* bodies, int64_t* ids) {
  return scree_insert_with_temperature(engine, n, bodies, nullptr, ids);
}
int scree_insert_with_temperature(scree_engine* engine, int64_t n, const scree_new_body* bodies, const double* temperatures, int64_t* ids) {
  return called(engine, "insert", [&](HostedRun& run) {
    run.check(n >= 0 && (n == 0 || (bodies != nullptr && ids != nullptr)), "insert: n >= 0 bodies and a place for their ids are needed");
    std::vector<NewBody> mine;
    for (std::int64_t k = 0; k < n; ++k) {
      const scree_new_body& b = bodies[k];
      mine.push_back({text_or_empty(b.shape), text_or_empty(b.material), vector_at(b.position, 0),
                      Quat{b.quaternion[0], b.quaternion[1], b.quaternion[2], b.quaternion[3]}, vector_at(b.velocity, 0),
                      vector_at(b.angular_velocity, 0), b.scale, temperatures == nullptr ? std::nullopt : std::optional(temperatures[k])});
    }
    const std::vector<std::int64_t> given = run.insert(mine);
    std::copy(given.begin(), given.end(), ids);
    return SCREE_DONE;
  });
}
int scree_remove(scree_engine* engine, int64_t n, const int64_t* ids) {
  return called(engine, "remove", [&](HostedRun& run) {
    run.check(n >= 0 && (n == 0 || ids != nullptr), "remove: n >= 0 ids are needed");
    run.remove(std::vector<std::int64_t>(ids, ids + n));
    return SCREE_DONE;
  });
}
