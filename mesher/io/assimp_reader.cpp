#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>

#include "core/base/error.hpp"
#include "mesher/io/mesh_file.hpp"

namespace scree {

namespace {

/// Formats whose numbers may have more digits than assimp's; the others hold single precision themselves.
constexpr std::array kFinerFormats{".dae", ".fbx", ".x3d", ".ac"};
/// A coordinate is rounded by at most this part of itself, and by as much again where a node of the file places the part.
constexpr double kSingleRounding = 6e-8;

/// What single precision may have cost, or "" for an empty mesh.
std::string rounding_note(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return "";
  const Box3 box = bounding_box(mesh);
  const Vec3 e = box.extent();
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(box.lower[k]), std::abs(box.upper[k])});
  const double lost = kSingleRounding * largest, extent = std::max({e.x, e.y, e.z});
  if (!(extent > 0) || !std::isfinite(lost)) return "";
  return fmt::format(
      "coordinates were rounded to single precision by assimp, by up to {:.1g} ({:.1g} of the extent); formats that "
      "keep all digits: PLY, OBJ, OFF, text STL",
      lost, lost / extent);
}

/// Metres in one unit of an FBX file, which states it in centimetres; 0 when it does not.
double fbx_unit(const aiScene& scene) {
  double centimetres = 0;
  float single = 0;
  if (scene.mMetaData == nullptr) return 0;
  if (!scene.mMetaData->Get("UnitScaleFactor", centimetres) && scene.mMetaData->Get("UnitScaleFactor", single)) centimetres = single;
  return centimetres > 0 && std::isfinite(centimetres) ? 0.01 * centimetres : 0;
}

}  // namespace

std::string assimp_version() { return fmt::format("{}.{}", aiGetVersionMajor(), aiGetVersionMinor()); }

// Normals, texture coordinates and colours are removed before anything else: they split vertices along seams.
// Vertices are welded by ourselves, by exact position, and degenerate triangles are dropped by ourselves,
// with a count. PreTransformVertices applies the nodes' placements (COLLADA keeps its unit and up axis
// there).
MeshFile read_with_assimp(const std::string& path) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                          aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                                          aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                                          aiComponent_MATERIALS);
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_RemoveComponent | aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (scene == nullptr)
    throw InputError("{}: it cannot be read as {}; the importer says: {}", path, extension_of(path), importer.GetErrorString());
  MeshFile file;
  file.reader = fmt::format("assimp {}, {}", assimp_version(), extension_of(path));
  std::int64_t left_out = 0;
  for (unsigned int m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const std::int32_t offset = file.mesh.vertex_count();
    if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) {
      left_out += part.mNumFaces;
      continue;
    }
    for (unsigned int v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      file.mesh.vertices.push_back({p.x, p.y, p.z});
    }
    for (unsigned int f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) {
        ++left_out;
        continue;
      }
      Triangle triangle;
      for (unsigned int k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= part.mNumVertices) {
          throw InputError("{}: triangle {} names vertex {}, but its part has {} vertices", path, f, face.mIndices[k], part.mNumVertices);
        }
        triangle[k] = offset + static_cast<std::int32_t>(face.mIndices[k]);
      }
      file.mesh.triangles.push_back(triangle);
    }
  }
  const std::string extension = extension_of(path);
  if (std::find(kFinerFormats.begin(), kFinerFormats.end(), extension) != kFinerFormats.end()) {
    if (const std::string note = rounding_note(file.mesh); !note.empty()) file.notes.push_back(note);
  }
  if (extension == ".fbx") file.stated_unit = fbx_unit(*scene);
  if (extension == ".dae") file.stated_unit = 1;  // assimp applies the unit that the file states
  if (left_out > 0) file.notes.push_back(fmt::format("{} points and lines were left out", left_out));
  if (scene->mNumMeshes > 1) file.notes.push_back(fmt::format("{} parts of the file were joined into one mesh", scene->mNumMeshes));
  return file;
}

}  // namespace scree
