// Steps a scene to its end in C++, and prints its state hash; then says what a mistake is answered, and that a closed engine is refused.
#include <cstdio>
#include <exception>
#include <functional>
#include <string>

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
    try {
      engine.set_heat_source({&unknown, 1}, {force + 2, 1});
      return 1;
    } catch (const scree::EngineError& error) {
      if (error.code() != SCREE_USAGE || std::string(error.what()).find("the scene has no heat") == std::string::npos) return 1;
    }
    scree::Engine closed(argv[1]);
    closed.close();
    closed.close();
    const std::function<void()> calls[] = {[&] { closed.step(); },
                                           [&] { (void)closed.time(); },
                                           [&] { (void)closed.reals("position", 3); },
                                           [&] { (void)closed.body_count(); },
                                           [&] { (void)closed.wall("floor"); },
                                           [&] {
                                             closed.set_wrench({&unknown, 1}, force);
                                           },
                                           [&] { closed.add_force({}); },
                                           [&] { (void)closed.heat(); },
                                           [&] { closed.set_medium({}, force, force); },
                                           [&] {
                                             (void)closed.take_medium_heat({&unknown, 1});
                                           },
                                           [&] { (void)closed.save(); },
                                           [&] { (void)closed.is_over(); }};
    for (const auto& call : calls) {
      try {
        call();
        return 1;
      } catch (const scree::EngineError& error) {
        if (error.code() != SCREE_USAGE || std::string(error.what()) != "the engine is closed; open another one") return 1;
      }
    }
    engine.add_force([](const scree::Engine&, std::span<double>, std::span<double>) { throw std::runtime_error("my own mistake"); });
  } catch (const std::exception& error) {
    std::printf("%s\n", error.what());
    return 0;
  }
  return 1;
}
