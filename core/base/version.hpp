// What the build knows of itself. The values come from the generated version.cpp, made again at each build.
#pragma once

#include <string>

namespace scree {
extern const char* const kVersion;
extern const char* const kGitHash;  ///< "unknown" outside a git checkout
extern const bool kGitDirty;
extern const char* const kCompiler;

/// Text of --version: version, git hash, compiler, SIMD targets, MPI, HDF5 and what the tool adds (VTK, gmsh, ...).
std::string version_text(const std::string& tool, const std::string& more_libraries = "");
}  // namespace scree
