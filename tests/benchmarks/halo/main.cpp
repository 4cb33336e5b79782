// Two ways to lay ghosts out in a message: one record a body, or one array a field. Times packing and unpacking alone; the bytes
// are the same. The solver has the second. usage: scree-bench-halo-packing [GHOSTS [BODIES [REPEATS]]]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "solver/ranks/ghost_packing.hpp"

namespace {

using namespace scree;

struct Record {
  Vec3 x, v, w;
  Quat q;
};

void pack_records(const ParticleSet& p, const std::vector<std::int32_t>& rows, char* buffer) {
  auto* out = reinterpret_cast<Record*>(buffer);
  for (const std::int32_t row : rows) {
    const auto i = static_cast<std::size_t>(row);
    *out++ = {p.x[i], p.v[i], p.w[i], p.q[i]};
  }
}
void unpack_records(ParticleSet& p, std::size_t first, std::size_t count, const char* buffer) {
  const auto* in = reinterpret_cast<const Record*>(buffer);
  for (std::size_t k = 0; k < count; ++k) {
    p.x[first + k] = in[k].x;
    p.v[first + k] = in[k].v;
    p.w[first + k] = in[k].w;
    p.q[first + k] = in[k].q;
  }
}

template <class Action>
double best_of(int repeats, Action&& action) {
  double best = 1e300;
  for (int r = 0; r < repeats; ++r) {
    const auto start = std::chrono::steady_clock::now();
    action();
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int k, int otherwise) { return argc > k ? std::atoi(argv[k]) : otherwise; };
  const auto ghosts = static_cast<std::size_t>(argument(1, 2000)), bodies = static_cast<std::size_t>(argument(2, 10000));
  const int repeats = argument(3, 300);
  ParticleSet p;
  p.resize(bodies + ghosts);
  std::vector<char> buffer(ghosts * sizeof(Record));
  std::fputs("layout,rows,ghosts,pack_ns,unpack_ns\n", stdout);
  for (const bool scattered : {false, true}) {
    // bodies near a cut lie anywhere in their arrays; in the best case all in a row
    std::vector<std::int32_t> rows(ghosts);
    for (std::size_t k = 0; k < ghosts; ++k) rows[k] = static_cast<std::int32_t>(scattered ? k * bodies / ghosts : k);
    if (scattered) std::shuffle(rows.begin(), rows.end(), std::mt19937(1));
    const auto tell = [&](const char* layout, double pack, double unpack) {
      fmt::print("{},{},{},{:.2f},{:.2f}\n", layout, scattered ? "scattered" : "in a row", ghosts, 1e9 * pack / static_cast<double>(ghosts),
                 1e9 * unpack / static_cast<double>(ghosts));
    };
    tell("record", best_of(repeats, [&] { pack_records(p, rows, buffer.data()); }),
         best_of(repeats, [&] { unpack_records(p, bodies, ghosts, buffer.data()); }));
    tell("arrays", best_of(repeats, [&] { pack_ghosts(p, rows, buffer.data()); }),
         best_of(repeats, [&] { unpack_ghosts(p, bodies, ghosts, buffer.data()); }));
  }
  return 0;
}
