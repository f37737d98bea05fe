// SPDX-License-Identifier: BSD-3-Clause
// Curved faces of STEP files are exact: a spherical mirror focuses like the closed form, and its triangles do not.
#include "base/math/rng.hpp"
#include "step/support.hpp"
#include "world/build/read_files.hpp"
#include "world/import/mesh_file.hpp"

namespace straytrace::test {
namespace {

constexpr double R = 0.4, rim = 0.05;  // m: radius of curvature and half width of step::add_mirror

// A ray parallel to the axis of a concave sphere, at height rho, crosses the axis R - R/(2 cos phi) from the vertex,
// sin phi = rho/R: triangle of centre, hit and crossing, with the angle phi twice.
double crossing_exact(double rho) { return R - R / (2 * std::sqrt(1 - rho * rho / (R * R))); }

// Largest error of that place over many rays against x, m.
double worst_focus(WorldView const& world) {
  Rng rng(1, 0, 0, Stream::source);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    double const rho = 0.01 + 0.039 * rng.uniform(), a = 2 * pi * rng.uniform();
    Ray const in{{0.3, rho * std::cos(a), rho * std::sin(a)}, {-1, 0, 0}};
    Hit const hit = world.closest(in, {});
    if (!hit.surface.valid()) return infinity;
    Vec3 const p = world.project(hit.surface, in.origin + hit.distance * in.dir, hit.piece);
    Vec3 const out = reflected(in.dir, world.normal(hit.surface, p, hit.piece));
    double const t = -(p.y * out.y + p.z * out.z) / (out.y * out.y + out.z * out.z);
    worst = std::fmax(
        worst, std::fabs(p.x + t * out.x - crossing_exact(rho)) + length(p + t * out - Vec3{p.x + t * out.x, 0, 0}));
  }
  return worst;
}

// The spherical face as triangles with corners on it, 0.5 mm long: their chords stray by 0.08 um.
World triangulated() {
  std::vector<MeshVertex> vertices;
  std::vector<MeshTriangle> triangles;
  constexpr std::uint32_t n = 201;
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      double const y = rim * (2.0 * i / (n - 1) - 1), z = rim * (2.0 * k / (n - 1) - 1);
      vertices.push_back({float(R - std::sqrt(R * R - y * y - z * z)), float(y), float(z)});
      if (i + 1 == n || k + 1 == n) continue;
      std::uint32_t const a = i * n + k;
      triangles.push_back({{a, a + n, a + 1}});
      triangles.push_back({{a + 1, a + n, a + n + 1}});
    }
  World world;
  TriangleMesh mesh;
  mesh.content = prepare_mesh(vertices, triangles, world.storage);
  mesh.place({});
  world.add_surface(mesh, world.add_optic({}), world.add_optic({}), world.add_body("b", {}), world.add_group("m"));
  world.finish();
  return world;
}

TEST(step_mirror, focuses_like_the_closed_form) {
  Built const b = built({{"m.step", sample(step::add_mirror)}}, "file: m.step, units: from_file, material: grey");
  ASSERT_EQ(b.errors, "");
  EXPECT_LT(worst_focus(b.world.view()), 1e-9 * R);
  EXPECT_GT(worst_focus(triangulated().view()), 1e-4 * R) << "the control of triangles";
}

TEST(step_mirror, is_the_native_cap_with_its_area_and_rim) {
  CadFile const file = converted(sample(step::add_mirror));
  ASSERT_EQ(file.parts.size(), 1u);
  Storage storage;
  int caps = 0;
  for (CadFileFace const& f : file.parts[0].faces) {
    PlacedCadShape const placed = cad_shape(f, 1, storage);
    if (f.carrier != Carrier::sphere) continue;
    ASSERT_TRUE(std::holds_alternative<Cap>(placed.shape));
    Cap cap = std::get<Cap>(placed.shape);
    cap.place(placed.frame);
    ++caps;
    double const sag = R - std::sqrt(R * R - rim * rim);
    EXPECT_NEAR(cap.area(), 2 * pi * R * sag, 1e-9 * cap.area());
    EXPECT_NEAR(cap.outer_radius, rim, 1e-9 * rim);  // the power of an even beam that it takes goes with its square
    EXPECT_GT(cap.normal({0, 0, 0}).x, 1 - 1e-15) << "out of the glass, towards the centre of curvature";
  }
  EXPECT_EQ(caps, 1);
}

// A sphere that is cut by planes and holes: every hit is on the sphere of the drawing and has its normal; what the
// edges of the face take away is known to the tolerance of trimming.
TEST(step_mirror, trimmed_spheres_stay_spheres) {
  CadFile const file = converted(sample(step::add_crossing));
  Storage storage;
  int seen = 0;
  for (CadFilePart const& part : file.parts)
    for (CadFileFace const& f : part.faces) {
      if (f.carrier != Carrier::sphere) continue;
      PlacedCadShape const placed = cad_shape(f, 1, storage);
      ASSERT_TRUE(std::holds_alternative<CadFace>(placed.shape));
      CadFace face = std::get<CadFace>(placed.shape);
      face.place(placed.frame);
      Vec3 const centre{0.03, 0.03, 0.06};
      Rng rng(2, 0, 0, Stream::source);
      for (int i = 0; i < 5000; ++i) {
        double const u = rng.uniform(), v = rng.uniform();
        Vec3 const target = face.sample(u, v), from = centre + Vec3{1e-3 * u, 1e-3 * v, 0};
        Ray const ray{from, unit(target - from)};
        Vec3 const p = ray.origin + face.distance(ray, false) * ray.dir;
        ASSERT_NEAR(length(p - centre), 0.025, 1e-9 * 0.025);
        ASSERT_LT(length(face.normal(p) - unit(centre - p)), 1e-9);
        ++seen;
      }
    }
  EXPECT_EQ(seen, 5000);
}

}  // namespace
}  // namespace straytrace::test
