// SPDX-License-Identifier: BSD-3-Clause
#include "world/import/mesh_file.hpp"

#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "base/files/read_write.hpp"
#include "base/process/child_process.hpp"
#include "base/text/words.hpp"

namespace straytrace::world {
namespace {

class MemoryStream : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string bytes) : bytes_(std::move(bytes)) {}
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    std::size_t const items = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, items * size);
    at_ += items * size;
    return items;
  }
  std::size_t Write(void const*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin from) override {
    std::size_t const base = from == aiOrigin_SET ? 0 : from == aiOrigin_CUR ? at_ : bytes_.size();
    std::size_t const target = from == aiOrigin_END ? base - std::min(base, offset) : base + offset;
    if (target > bytes_.size()) return aiReturn_FAILURE;
    at_ = target;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

// The mesh file itself, and files in its folder or below that it names; never the disk.
class MemoryFiles : public Assimp::IOSystem {
 public:
  MemoryFiles(std::string main, std::string const& bytes, CompanionFile const& companion)
      : main_(std::move(main)), bytes_(bytes), companion_(companion) {}
  bool Exists(char const* name) const override { return name == main_ || !other(name).empty(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(char const* name, char const* mode) override {
    if (std::strchr(mode, 'w') || std::strchr(mode, 'a')) return nullptr;
    if (name == main_) return new MemoryStream(bytes_);
    std::string found = other(name);
    return found.empty() ? nullptr : new MemoryStream(std::move(found));
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string other(std::string name) const {
    if (name.starts_with("./")) name.erase(0, 2);
    bool const leaves = name.empty() || name.starts_with('/') || name.find('\\') != std::string::npos ||
                        name.find(':') != std::string::npos || name.find("..") != std::string::npos;
    // Material libraries and textures are not needed: the file itself contains the names of materials.
    return leaves || !name.ends_with(".bin") || !companion_ ? "" : companion_(name);
  }

  std::string main_;
  std::string const& bytes_;
  CompanionFile const& companion_;
};

constexpr char const* unnamed_in_obj = "defaultobject";  // its name in the library

std::string printable(char const* text) {
  std::string out(text);
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return out;
}

// Row-major 4 x 4 in double.
struct Transform {
  double m[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  bool identity = true;
  Transform with(aiMatrix4x4 const& local) const {
    if (local.IsIdentity()) return *this;
    Transform out;
    out.identity = false;
    for (unsigned i = 0; i < 4; ++i)
      for (unsigned j = 0; j < 4; ++j) {
        out.m[i][j] = 0;
        for (unsigned k = 0; k < 4; ++k) out.m[i][j] += m[i][k] * double(local[k][j]);
      }
    return out;
  }
  MeshVertex operator()(aiVector3D const& v) const {
    auto const plain = [](float x) { return x == 0 ? 0.0f : x; };  // no -0: equal corners have equal bits
    if (identity) return {plain(v.x), plain(v.y), plain(v.z)};
    auto const row = [&](int i) { return plain(float(m[i][0] * v.x + m[i][1] * v.y + m[i][2] * v.z + m[i][3])); };
    return {row(0), row(1), row(2)};
  }
  // Of a normal: by the cofactors, with the sign of the determinant, and of any length.
  MeshVertex normal(aiVector3D const& v) const {
    if (identity) return {v.x, v.y, v.z};
    double const side = determinant() < 0 ? -1 : 1;
    auto const row = [&](int i) {
      int const j = (i + 1) % 3, k = (i + 2) % 3;
      auto const cofactor = [&](int c) {
        int const d = (c + 1) % 3, e = (c + 2) % 3;
        return m[j][d] * m[k][e] - m[j][e] * m[k][d];
      };
      return float(side * (cofactor(0) * v.x + cofactor(1) * v.y + cofactor(2) * v.z));
    };
    return {row(0), row(1), row(2)};
  }
  double determinant() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  }
};

struct VertexHash {
  std::size_t operator()(MeshVertex const& v) const {
    std::uint64_t h = 0;
    for (float x : {v.x, v.y, v.z}) h = (h ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15ull, h ^= h >> 29;
    return std::size_t(h);
  }
};

// Collects the meshes of one file into parts by name and material.
class Parts {
 public:
  Parts(MeshFile& out, bool takes_normals, bool linear_colours)
      : out_(out), takes_normals_(takes_normals), linear_colours_(linear_colours) {}

  void walk(aiScene const& scene, aiNode const& node, Transform const& above, int depth) {
    if (depth > 1000) return;
    Transform const here = above.with(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
      aiMesh const& mesh = *scene.mMeshes[node.mMeshes[i]];
      std::string const of_node = printable(node.mName.C_Str()), of_mesh = printable(mesh.mName.C_Str());
      bool const root = &node == scene.mRootNode;
      std::string const name = !root && !of_node.empty() ? of_node : of_mesh;
      add(scene, mesh, name == unnamed_in_obj ? "" : name, here);
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) walk(scene, *node.mChildren[i], here, depth + 1);
  }
  bool finite() const { return finite_; }

 private:
  void add(aiScene const& scene, aiMesh const& mesh, std::string const& name, Transform const& here) {
    std::string material;
    if (mesh.mMaterialIndex < scene.mNumMaterials) {
      aiString given;
      if (scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, given) == aiReturn_SUCCESS)
        material = printable(given.C_Str());
      if (material == AI_DEFAULT_MATERIAL_NAME) material.clear();
    }
    std::vector<std::string> const by_face = vertex_colours(mesh);
    std::string const colour = material.empty() || !linear_colours_ ? "" : gltf_colour(scene, mesh);
    if (by_face.empty()) return add_faces(mesh, number_of(name, material, colour), here, {}, "");
    for (std::string const& one : std::set<std::string>(by_face.begin(), by_face.end()))
      add_faces(mesh, number_of(name, material, one), here, by_face, one);
  }

  std::size_t number_of(std::string const& name, std::string const& material, std::string const& colour) {
    auto const [hit, fresh] = number_.try_emplace({name, material, colour}, out_.parts.size());
    if (fresh) {
      out_.parts.push_back({name, material, colour, {}, {}, {}});
      known_.emplace_back();
    }
    return hit->second;
  }

  // All faces, or those of one colour.
  void add_faces(aiMesh const& mesh, std::size_t number, Transform const& here, std::vector<std::string> const& by_face,
                 std::string const& colour) {
    MeshPart& part = out_.parts[number];
    auto& known = known_[number];
    bool const mirrored = here.determinant() < 0;
    std::vector<char> used(mesh.mNumVertices, by_face.empty());
    for (unsigned i = 0; i < by_face.size(); ++i)
      for (unsigned k = 0; k < mesh.mFaces[i].mNumIndices && by_face[i] == colour; ++k)
        used.at(mesh.mFaces[i].mIndices[k]) = 1;
    std::vector<std::uint32_t> vertex(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      if (!used[i]) continue;
      MeshVertex const v = here(mesh.mVertices[i]);
      finite_ = finite_ && std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
      auto const [at, added] = known.try_emplace(v, std::uint32_t(part.vertices.size()));
      if (added) part.vertices.push_back(v);
      vertex[i] = at->second;
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      aiFace const& face = mesh.mFaces[i];
      if (!by_face.empty() && by_face[i] != colour) continue;
      if (face.mNumIndices != 3) {
        ++out_.left_out;
        continue;
      }
      MeshTriangle t{{vertex.at(face.mIndices[0]), vertex.at(face.mIndices[1]), vertex.at(face.mIndices[2])}};
      if (mirrored) std::swap(t.corner[1], t.corner[2]);
      part.triangles.push_back(t);
      if (takes_normals_ && mesh.HasNormals()) add_normals(mesh, face, here, mirrored, part);
    }
  }

  static void add_normals(aiMesh const& mesh, aiFace const& face, Transform const& here, bool mirrored,
                          MeshPart& part) {
    part.normals.resize(3 * (part.triangles.size() - 1));  // of faces without normals
    for (int const k : {0, mirrored ? 2 : 1, mirrored ? 1 : 2})
      part.normals.push_back(here.normal(mesh.mNormals[face.mIndices[k]]));
  }

  MeshFile& out_;
  bool takes_normals_;   // the format states normals of corners, not of faces
  bool linear_colours_;  // of materials: glTF
  std::map<std::array<std::string, 3>, std::size_t> number_;
  std::vector<std::unordered_map<MeshVertex, std::uint32_t, VertexHash>> known_;
  bool finite_ = true;
};

// Errors of the library, by a piece of their text, in our words; never with bytes of the file.
constexpr std::pair<std::string_view, char const*> explanations[] = {
    {"std::bad_alloc", "it states more points or faces than its size allows"},
    {"mNumMeshes is 0", "it contains no faces"},
    {"contains no faces", "it contains no faces"},
    {"is a POINT", "one of its faces has fewer than three corners"},
    {"is a LINE", "one of its faces has fewer than three corners"},
    {"out of range", "one of its faces names a corner that the file does not have"},
    {"Invalid face index", "one of its faces names a corner that the file does not have"},
    {"as a real number", "it contains a text that is not a number where a number must stand"},
    {"storage representation", "it is neither text nor as long as a binary file of its number of triangles"},
    {"Invalid number of vertices", "it is cut off, or one of its facets does not have three corners"},
    {"No suitable reader", "its content has another format, or is cut off"},
    {"too small", "it is cut off"},
    {"is empty", "it is empty"},
};

std::string explained(std::string const& kind, std::string const& bytes, std::string const& said) {
  if (kind == ".obj" && is_binary(bytes)) return "the file is binary, but this format is text";
  for (auto const& [piece, meaning] : explanations)
    if (said.find(piece) != said.npos) return meaning;
  return said;
}

std::string ending(std::string const& name) {
  std::size_t const dot = name.find_last_of("./");
  if (dot == std::string::npos || name[dot] == '/') return "";
  return lower_case(std::string_view(name).substr(dot));
}

}  // namespace

Box MeshFile::box() const {
  Box box;
  for (MeshPart const& p : parts)
    for (MeshVertex const& v : p.vertices) box.add(exact(v));
  return box;
}

MeshFault import_mesh(std::string const& bytes, CompanionFile const& companion, MeshFile& out) {
  std::string const kind = ending(out.name);
  if (kind != ".stl" && kind != ".obj" && kind != ".ply" && kind != ".gltf" && kind != ".glb")
    return {fmt::format("'{}' is not a kind of mesh file", kind), "use .stl, .obj, .ply, .gltf, .glb or .step"};
  std::string const fix = "check that the file is complete and that its ending matches its format";
  if (kind == ".ply" && bytes.starts_with("ply") && bytes.find("end_header") == bytes.npos)  // the library never ends
    return {"not a readable ply file: its header is cut off", fix};
  std::string const inside = out.name.substr(out.name.find_last_of('/') + 1);
  Assimp::Importer importer;
  importer.SetIOHandler(new MemoryFiles(inside, bytes, companion));  // the importer deletes it
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyInteger(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
  aiScene const* scene =
      importer.ReadFile(inside, aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_SortByPType);
  if (!scene || !scene->mRootNode) {
    std::string const why = explained(kind, bytes, printable(importer.GetErrorString()));
    return {fmt::format("not a readable {} file: {}", kind.substr(1), why), fix};
  }
  Parts parts(out, kind != ".stl", kind == ".gltf" || kind == ".glb");
  parts.walk(*scene, *scene->mRootNode, {}, 0);
  std::erase_if(out.parts, [](MeshPart const& p) { return p.triangles.empty(); });
  for (MeshPart& p : out.parts)
    if (!p.normals.empty()) p.normals.resize(3 * p.triangles.size());
  if (out.parts.empty())
    return {"the file contains no triangles", "export the faces of the parts, not only their edges"};
  if (!parts.finite()) return {"a vertex of the file is not a finite number", fix};
  if (kind == ".gltf" || kind == ".glb") out.stated_unit = 1;
  return {};
}

// Reads a mesh file in a sandboxed copy of the process, which returns the content as bytes.

namespace {

// The library takes about 20 bytes for each of a file, our parts as much again.
Bounds bounds_for(std::size_t bytes) { return {(std::size_t{1} << 30) + 100 * bytes, 60 + bytes / 100000}; }

std::string packed(MeshFault const& fault, MeshFile const& file, std::vector<std::string> const& asked) {
  Packer out;
  out.add(fault.what);
  out.add(fault.suggestion);
  out.count(asked.size());
  for (std::string const& name : asked) out.add(name);
  out.value(file.stated_unit);
  out.count(file.left_out);
  out.count(file.parts.size());
  for (MeshPart const& p : file.parts) {
    for (std::string const* text : {&p.name, &p.material, &p.colour}) out.add(*text);
    out.add(p.vertices);
    out.add(p.triangles);
    out.add(p.normals);
  }
  return out.take();
}

}  // namespace

MeshFault read_mesh_file(std::string const& bytes, CompanionFile const& companion, MeshFile& out) {
  auto const work = [&] {
    std::vector<std::string> asked;
    CompanionFile const noted = [&](std::string const& name) { return asked.push_back(name), companion(name); };
    MeshFile file;
    file.name = out.name;
    MeshFault const fault = import_mesh(bytes, companion ? noted : companion, file);
    return packed(fault, file, asked);
  };
  SandboxResult const done = run_sandboxed(work, bounds_for(bytes.size()));
  if (!done.why.empty())
    return {fmt::format("not a readable mesh file: {}", done.why), "check that the file is complete; export it again"};
  Unpacker in(done.bytes);
  MeshFault fault;
  fault.what = in.text();
  fault.suggestion = in.text();
  for (std::uint64_t n = in.count(); n > 0; --n) (void)companion(in.text());  // registers the files that the copy read
  out.stated_unit = in.value<double>();
  out.left_out = in.count();
  out.parts.resize(in.count());
  for (MeshPart& p : out.parts) {
    p.name = in.text(), p.material = in.text(), p.colour = in.text();
    p.vertices = in.values<MeshVertex>();
    p.triangles = in.values<MeshTriangle>();
    p.normals = in.values<MeshVertex>();
  }
  return fault;
}

namespace {

constexpr std::size_t most_colours = 64;

double srgb(double linear) { return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055; }

}  // namespace

std::string colour_text(double red, double green, double blue) {
  auto const byte = [](double x) { return int(std::lround(255 * std::fmin(std::fmax(x, 0), 1))); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(red), byte(green), byte(blue));
}

std::string gltf_colour(aiScene const& scene, aiMesh const& mesh) {
  if (mesh.mMaterialIndex >= scene.mNumMaterials) return "";
  aiColor4D c;
  if (scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_BASE_COLOR, c) != aiReturn_SUCCESS) return "";
  return colour_text(srgb(c.r), srgb(c.g), srgb(c.b));
}

std::vector<std::string> vertex_colours(aiMesh const& mesh) {
  aiColor4D const* const colours = mesh.mColors[0];
  if (!colours) return {};
  std::vector<std::string> of_face;
  std::set<std::string> seen;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    aiFace const& face = mesh.mFaces[i];
    bool const sound = face.mNumIndices > 0 && face.mIndices[0] < mesh.mNumVertices;
    aiColor4D const c = sound ? colours[face.mIndices[0]] : aiColor4D();
    of_face.push_back(colour_text(c.r, c.g, c.b));
    if (seen.insert(of_face.back()).second && seen.size() > most_colours) return {};
  }
  return of_face;
}

void set_library_colours(std::string const& library, MeshFile& mesh) {
  std::map<std::string, std::string> colour;
  std::istringstream lines(library);
  for (std::string line, name; std::getline(lines, line);) {
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
    line.erase(0, line.find_first_not_of(" \t"));
    if (line.starts_with("newmtl ")) name = line.substr(7);
    if (!line.starts_with("Kd ")) continue;
    std::istringstream numbers(line.substr(3));
    if (double r = 0, g = 0, b = 0; numbers >> r >> g >> b) colour[name] = colour_text(r, g, b);
  }
  for (MeshPart& p : mesh.parts)
    if (auto const hit = colour.find(p.material); hit != colour.end()) p.colour = hit->second;
}

}  // namespace straytrace::world
