#include "isopath/mesh/step_reader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "isopath/core/error.h"
#include "isopath/mesh/read_mesh.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {
namespace {

/// Writes the entities of a STEP file, numbered from 1.
class StepWriter {
 public:
  int add(const std::string& entity) {
    text_ += fmt::format("#{}={};\n", ++last_, entity);
    return last_;
  }
  int point(const Vec3& p) { return add(fmt::format("CARTESIAN_POINT('',({:#},{:#},{:#}))", p.x(), p.y(), p.z())); }
  int direction(const Vec3& d) { return add(fmt::format("DIRECTION('',({:#},{:#},{:#}))", d.x(), d.y(), d.z())); }
  std::string text() const { return text_; }

 private:
  int last_ = 0;
  std::string text_;
};

std::string joined(const std::vector<int>& ids) {
  std::string out;
  for (const int id : ids) out += fmt::format("{}#{}", out.empty() ? "" : ",", id);
  return "(" + out + ")";
}

/// A box with corners 0 and `size` as boundary representation: 8 vertices, 12 edges, 6 planes.
int add_box(StepWriter& step, const Vec3& size) {
  std::array<Vec3, 8> corner;
  std::array<int, 8> vertex{};
  for (int i = 0; i < 8; ++i) {
    corner[i] = size.cwiseProduct(Vec3(i & 1, i >> 1 & 1, i >> 2));
    vertex[i] = step.add(fmt::format("VERTEX_POINT('',#{})", step.point(corner[i])));
  }
  std::map<std::pair<int, int>, int> edges;
  const auto oriented_edge = [&](int a, int b) {
    const auto [it, fresh] = edges.try_emplace(std::minmax(a, b), 0);
    const auto [low, high] = it->first;
    if (fresh) {
      const int direction = step.direction((corner[high] - corner[low]).normalized());
      const int vector = step.add(fmt::format("VECTOR('',#{},1.)", direction));
      const int line = step.add(fmt::format("LINE('',#{},#{})", step.point(corner[low]), vector));
      it->second = step.add(fmt::format("EDGE_CURVE('',#{},#{},#{},.T.)", vertex[low], vertex[high], line));
    }
    return step.add(fmt::format("ORIENTED_EDGE('',*,*,#{},{})", it->second, a == low ? ".T." : ".F."));
  };
  std::vector<int> faces;
  for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    const Vec3 normal = (corner[b] - corner[a]).cross(corner[c] - corner[b]).normalized();
    const int loop =
        step.add("EDGE_LOOP(''," +
                 joined({oriented_edge(a, b), oriented_edge(b, c), oriented_edge(c, d), oriented_edge(d, a)}) + ")");
    const int bound = step.add(fmt::format("FACE_OUTER_BOUND('',#{},.T.)", loop));
    const int axes =
        step.add(fmt::format("AXIS2_PLACEMENT_3D('',#{},#{},#{})", step.point(corner[a]), step.direction(normal),
                             step.direction((corner[b] - corner[a]).normalized())));
    const int plane = step.add(fmt::format("PLANE('',#{})", axes));
    faces.push_back(step.add(fmt::format("ADVANCED_FACE('',(#{}),#{},.T.)", bound, plane)));
  }
  return step.add(fmt::format("MANIFOLD_SOLID_BREP('',#{})", step.add("CLOSED_SHELL(''," + joined(faces) + ")")));
}

/// A STEP file with a box, its numbers in metres when `metres` holds and in millimetres otherwise.
std::string box_file(const Vec3& size, bool metres) {
  StepWriter step;
  const int solid = add_box(step, size);
  const int length = step.add(fmt::format("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({},.METRE.))", metres ? "$" : ".MILLI."));
  const int angle = step.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int solid_angle = step.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int fuzz = step.add(fmt::format("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),#{},'','')", length));
  const int context =
      step.add(fmt::format("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{}))"
                           "GLOBAL_UNIT_ASSIGNED_CONTEXT((#{},#{},#{}))REPRESENTATION_CONTEXT('',''))",
                           fuzz, length, angle, solid_angle));
  const int shape = step.add(fmt::format("ADVANCED_BREP_SHAPE_REPRESENTATION('',(#{}),#{})", solid, context));
  const int application = step.add("APPLICATION_CONTEXT('automotive design')");
  const int mechanical = step.add(fmt::format("PRODUCT_CONTEXT('',#{},'mechanical')", application));
  const int product = step.add(fmt::format("PRODUCT('box','box','',(#{}))", mechanical));
  const int formation = step.add(fmt::format("PRODUCT_DEFINITION_FORMATION('','',#{})", product));
  const int design = step.add(fmt::format("PRODUCT_DEFINITION_CONTEXT('part definition',#{},'design')", application));
  const int definition = step.add(fmt::format("PRODUCT_DEFINITION('design','',#{},#{})", formation, design));
  const int its_shape = step.add(fmt::format("PRODUCT_DEFINITION_SHAPE('','',#{})", definition));
  step.add(fmt::format("SHAPE_DEFINITION_REPRESENTATION(#{},#{})", its_shape, shape));
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
         "FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n" +
         step.text() + "ENDSEC;\nEND-ISO-10303-21;\n";
}

class StepReader : public testing::Test {
 protected:
  void SetUp() override {
    if (!can_read_step()) GTEST_SKIP() << "built without OpenCASCADE";
  }

  static std::filesystem::path write(const std::string& name, const std::string& content) {
    const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / ("isopath_" + name);
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
};

std::filesystem::path shared_step(const std::string& name) {
  return std::filesystem::path(ISOPATH_SHARED_DIR) / "step" / name;
}

TEST(StepOptionsTest, DefaultsAreAsDocumented) {
  EXPECT_EQ(StepOptions{}.chordal_tolerance, 0);
  EXPECT_EQ(StepOptions{}.angular_tolerance, 0.3);
  EXPECT_THROW(StepOptions{.chordal_tolerance = -1}.validate(), Error);
  EXPECT_THROW(StepOptions{.angular_tolerance = 0}.validate(), Error);
}

TEST(StepFileNames, AreToldByTheirExtension) {
  for (const char* name : {"a.step", "a.STP", "b.c.igs", "x.IGES"}) EXPECT_TRUE(is_step_file_name(name)) << name;
  for (const char* name : {"a.stl", "step", "a.step.obj"}) EXPECT_FALSE(is_step_file_name(name)) << name;
}

TEST_F(StepReader, ABoxIsClosedAndExact) {
  const TriangleMesh mesh(read_step(write("box.step", box_file({10, 20, 30}, false))));
  EXPECT_EQ(mesh.n_vertices(), 8);
  EXPECT_EQ(mesh.n_faces(), 12);
  EXPECT_TRUE(mesh.boundary_loops().empty());
  EXPECT_NEAR(mesh.area(), 2 * (200 + 300 + 600), 1e-9);
  double volume = 0;
  for (const auto& [a, b, c] : mesh.soup().triangles) {
    volume += mesh.position(a).dot(mesh.position(b).cross(mesh.position(c))) / 6;
  }
  EXPECT_NEAR(volume, 6000, 1e-9) << "a negative volume has its normals inside";
}

TEST_F(StepReader, UnitsBecomeMillimetres) {
  const TriangleMesh mesh(read_step(write("box_m.stp", box_file({0.01, 0.02, 0.03}, true))));
  EXPECT_NEAR(mesh.area(), 2 * (200 + 300 + 600), 1e-9);
}

TEST_F(StepReader, ReadMeshKnowsThem) {
  const MeshFile file = read_mesh(write("by_name.step", box_file({10, 20, 30}, false)));
  EXPECT_EQ(file.soup.triangles.size(), 12u);
  EXPECT_EQ(file.vertex_of_file_vertex.size(), 8u);
}

TEST_F(StepReader, NonsenseIsRefusedInSilence) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_THROW(read_step(write("nonsense.step", "this is no STEP file\n")), Error);
  EXPECT_THROW(read_step(write("empty.step", "")), Error);
  EXPECT_THROW(read_step(write("nonsense.igs", "this is no IGES file\n")), Error);
  const std::string box = box_file({1, 1, 1}, false);
  EXPECT_THROW(read_step(write("cut.step", box.substr(0, box.size() / 2))), Error);
  EXPECT_THROW(read_step(testing::TempDir() + "isopath_is_not_there.step"), Error);
  EXPECT_THROW(read_step(write("box.stl", box)), Error);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(StepReader, CanBeCancelled) {
  class Cancelled : public Progress {
    bool cancelled() const override { return true; }
  } progress;
  try {
    read_step(write("cancel.step", box_file({1, 1, 1}, false)), {}, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
}

TEST_F(StepReader, ClosedModelsStayClosed) {
  for (const char* name : {"featuretype.STEP", "screw.step", "eight_cylinders.stp"}) {
    if (!std::filesystem::exists(shared_step(name))) GTEST_SKIP() << "the shared data is not here";
    const TriangleMesh mesh(read_step(shared_step(name)));
    EXPECT_TRUE(mesh.boundary_loops().empty()) << name << ": " << mesh.boundary_loops().size();
  }
}

TEST_F(StepReader, AFinerToleranceComesNearerToTheTrueArea) {
  const std::filesystem::path path = shared_step("eight_cylinders.stp");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "the shared data is not here";
  const double coarse = TriangleMesh(read_step(path, {.chordal_tolerance = 1, .angular_tolerance = 1})).area();
  const double middle = TriangleMesh(read_step(path, {.chordal_tolerance = 0.1, .angular_tolerance = 0.3})).area();
  const double fine = TriangleMesh(read_step(path, {.chordal_tolerance = 0.01, .angular_tolerance = 0.1})).area();
  EXPECT_GT(middle, coarse);
  EXPECT_GT(fine, middle);
  EXPECT_LT(fine - middle, middle - coarse);
}

TEST_F(StepReader, EveryFileAtHandGivesTriangles) {
  for (const char* name : {"nacelle.stp", "d150_wing.igs", "part_45_faces.iges", "dm1_id_214.stp"}) {
    if (!std::filesystem::exists(shared_step(name))) GTEST_SKIP() << "the shared data is not here";
    testing::internal::CaptureStdout();
    const TriangleSoup soup = read_step(shared_step(name));
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << name;
    EXPECT_GT(soup.triangles.size(), 20u) << name;
    EXPECT_TRUE(bounding_box(soup).sizes().allFinite());
  }
}

}  // namespace
}  // namespace isopath
