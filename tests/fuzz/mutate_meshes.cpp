// Damaged copies of mesh files, read as import reads them: by our readers, or through the libraries in their child process.
//
//   scree_mutate_meshes RUNS SEED FILE...
//
// Each run damages one file (bytes changed, blocks removed or repeated, the end cut off), reads, checks and heals it.
// Fails when the tool would crash, hang or certify what is no solid; what a child process does is its own affair.
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "core/base/error.hpp"
#include "mesher/io/mesh_file.hpp"
#include "tests/fuzz/certificate.hpp"

namespace {

/// Computing time of the child; the tool's own limit is longer, so that large files and slow machines have time.
/// A sound seed takes some milliseconds.
constexpr double kSeconds = 0.25;

std::string damaged(std::string bytes, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % std::max<std::size_t>(n, 1)); };
  const std::size_t edits = 1 + below(8);
  for (std::size_t i = 0; i < edits && !bytes.empty(); ++i) {
    // the head of a file decides most: half of the edits go there
    const std::size_t place = below(random() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 256) : bytes.size());
    const std::size_t length = std::min(bytes.size() - place, 1 + below(64));
    switch (random() % 6) {
      case 0:
        bytes[place] = static_cast<char>(random());
        break;
      case 1:
        bytes[place] = static_cast<char>(bytes[place] ^ (1 << random() % 8));
        break;
      case 2:
        bytes.erase(place, length);
        break;
      case 3:
        bytes.insert(place, bytes.substr(place, length));
        break;
      case 4:
        bytes.resize(place);
        break;
      default:
        for (std::size_t k = 0; k < std::min<std::size_t>(length, 8); ++k)
          bytes[place + k] = static_cast<char>(random() % 2 == 0 ? 0xff : 0x00);
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: scree_mutate_meshes RUNS SEED FILE...\n");
    return 2;
  }
  const long runs = std::atol(argv[1]);
  std::mt19937_64 random(static_cast<std::uint64_t>(std::atoll(argv[2])));
  std::string folder = (std::filesystem::temp_directory_path() / "scree-mutate-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return 4;
  std::map<std::string, long> outcomes;
  std::vector<std::string> originals;
  for (int i = 3; i < argc; ++i) {
    std::ifstream stream(argv[i], std::ios::binary);
    originals.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    if (originals.back().empty()) {
      std::fprintf(stderr, "cannot read %s\n", argv[i]);
      return 4;
    }
  }
  double slowest = 0;
  for (long run = 0; run < runs; ++run) {
    const auto which = static_cast<std::size_t>(random() % originals.size());
    const std::string path = folder + "/mesh" + scree::extension_of(argv[3 + which]);
    std::ofstream(path, std::ios::binary) << damaged(originals[which], random);
    const auto start = std::chrono::steady_clock::now();
    try {
      const scree::MeshFile file =
          scree::read_mesh_file(path, {.memory_bytes = std::size_t{1} << 30, .seconds = 60, .cpu_seconds = kSeconds});
      ++outcomes[scree::test::examine(file.mesh, true) ? "solid" : "refused"];
    } catch (const scree::Error& error) {
      const std::string text = error.what();
      ++outcomes[text.find("crashed") != std::string::npos         ? "importer crashed"
                 : text.find("did not end") != std::string::npos   ? "importer hung"
                 : text.find("out of memory") != std::string::npos ? "importer out of memory"
                                                                   : "importer refused"];
    }
    slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::filesystem::remove_all(folder);
  for (const auto& [outcome, count] : outcomes) std::printf("%-24s %ld\n", outcome.c_str(), count);
  std::printf("%ld runs, the slowest %.2f s\n", runs, slowest);
  return 0;
}
