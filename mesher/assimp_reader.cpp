#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/format.h>

#include <assimp/Importer.hpp>

#include "core/base/error.hpp"
#include "mesher/mesh_file.hpp"

namespace scree {

std::string assimp_version() { return fmt::format("{}.{}", aiGetVersionMajor(), aiGetVersionMinor()); }

// Normals, texture coordinates and colours are removed before anything else: they split vertices along seams.
// Vertices are welded by ourselves, by exact position, and degenerate triangles are dropped by ourselves,
// with a count. PreTransformVertices applies the nodes' placements (COLLADA keeps its unit and up axis
// there).
MeshFile read_with_assimp(const std::string& path) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                              aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                  aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                  aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                  aiComponent_MATERIALS);
  const aiScene* scene = importer.ReadFile(path, aiProcess_RemoveComponent | aiProcess_Triangulate |
                                                     aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (scene == nullptr)
    throw InputError("{}: it cannot be read as {}; the importer says: {}", path, extension_of(path),
                     importer.GetErrorString());
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
          throw InputError("{}: triangle {} names vertex {}, but its part has {} vertices", path, f,
                           face.mIndices[k], part.mNumVertices);
        }
        triangle[k] = offset + static_cast<std::int32_t>(face.mIndices[k]);
      }
      file.mesh.triangles.push_back(triangle);
    }
  }
  if (left_out > 0) file.notes.push_back(fmt::format("{} points and lines were left out", left_out));
  if (scene->mNumMeshes > 1)
    file.notes.push_back(fmt::format("{} parts of the file were joined into one mesh", scene->mNumMeshes));
  return file;
}

}  // namespace scree
