#include "core/base/version.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <hwy/targets.h>
#include <mpi.h>

namespace scree {

namespace {

// Names of the vector instruction sets that Highway can choose from on this machine, best first.
std::string simd_targets() {
  std::string names;
  const auto supported = hwy::SupportedTargets();
  for (int bit = 0; bit < 62; ++bit) {
    const auto target = static_cast<decltype(hwy::SupportedTargets())>(1) << bit;
    if ((supported & target) == 0) continue;
    if (!names.empty()) names += ' ';
    names += hwy::TargetName(target);
  }
  return names.empty() ? "none" : names;
}

// "Open MPI v4.1.4": the first clause of what the library says; the packager follows.
std::string mpi_library() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int length = 0;
  MPI_Get_library_version(text, &length);  // one of the few calls allowed before MPI_Init
  const std::string all(text, static_cast<std::size_t>(length));
  return all.substr(0, all.find_first_of(",\n"));
}

std::string hdf5_library() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

}  // namespace

std::string version_text(const std::string& tool, const std::string& more_libraries) {
  std::string text =
      fmt::format("{} {}\ngit:       {}{}\ncompiler:  {}\nSIMD:      {}\nMPI:       {}\nHDF5:      {}", tool, kVersion, kGitHash,
                  kGitDirty ? " (with local changes)" : "", kCompiler, simd_targets(), mpi_library(), hdf5_library());
  if (!more_libraries.empty()) text += "\nlibraries: " + more_libraries;
  return text;
}

}  // namespace scree
