// Steps a scene to its end in C++, and prints its state hash; then says what a mistake is answered.
#include <cstdio>
#include <exception>

#include "scree_engine.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    scree::Engine engine(argv[1]);
    engine.run_until(engine.duration());
    std::printf("%s %lld steps\n", engine.state_hash().c_str(), static_cast<long long>(engine.steps()));
    const std::int64_t unknown = 987654;
    const double force[3] = {0, 0, 1};
    try {
      engine.set_wrench({&unknown, 1}, force);
    } catch (const scree::EngineError& error) {
      std::printf("%d %s\n", error.code(), error.what());
    }
    engine.add_force([](const scree::Engine&, std::span<double>, std::span<double>) { throw std::runtime_error("my own mistake"); });
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 0;
  }
  return 1;
}
