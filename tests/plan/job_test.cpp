#include "isopath/plan/job.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "isopath/core/atomic_file.h"
#include "isopath/core/error.h"

namespace isopath {
namespace {

namespace fs = std::filesystem;

class JobFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::canonical(fs::path(testing::TempDir())) /
        ("isopath_job_" + std::to_string(::getpid()) + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    write_file_atomically(folder_ / name, text);
    return folder_ / name;
  }

  /// The message for a job of these lines after `mesh: part.stl`.
  std::string complaint(const std::string& lines) const {
    try {
      read_job(write("bad.yaml", "mesh: part.stl\n" + lines));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::bad_input) << error.what();
      EXPECT_EQ(error.where().file, (folder_ / "bad.yaml").string());
      return error.what();
    }
    ADD_FAILURE() << "accepted: " << lines;
    return {};
  }

  fs::path folder_;
};

TEST_F(JobFile, NeedsNoMoreThanAMesh) {
  const Job job = read_job(write("job.yaml", "mesh: part.stl\n"));
  EXPECT_EQ(job.mesh, folder_ / "part.stl");
  Job plain;
  plain.mesh = folder_ / "part.stl";
  EXPECT_EQ(job_yaml(job, folder_), job_yaml(plain, folder_));
}

TEST_F(JobFile, PathsAreRelativeToTheJobFile) {
  const fs::path file = write("sub/job.yaml", "mesh: ../parts/a.stl\nsources: ['polyline:line.csv', boundary]\n");
  const Job job = read_job(file);
  EXPECT_EQ(job.mesh, folder_ / "parts/a.stl");
  EXPECT_EQ(job.sources.at(0).file, folder_ / "sub/line.csv");
  const std::string elsewhere = job_yaml(job, folder_ / "deep/er");
  EXPECT_NE(elsewhere.find("\"../../parts/a.stl\""), std::string::npos) << elsewhere;
  EXPECT_NE(elsewhere.find("\"polyline:../../sub/line.csv\""), std::string::npos) << elsewhere;
}

TEST_F(JobFile, PathsAreRelativeToAFolderThatDoesNotExistYet) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  Job job;
  job.mesh = "part.stl";
  const std::string text = job_yaml(job, "not/yet/there");
  fs::current_path(before);
  EXPECT_NE(text.find("\"../../../part.stl\""), std::string::npos) << text;
}

Job random_job(std::mt19937_64& rng, const fs::path& folder) {
  const auto number = [&] { return std::exp(std::uniform_real_distribution<double>(-20, 20)(rng)); };
  const auto pick = [&](int n) { return std::uniform_int_distribution<int>(0, n - 1)(rng); };
  Job job;
  job.mesh = folder / "a \"quoted\" näme: #1.stl";
  job.unit = static_cast<LengthUnit>(pick(4));
  job.sources = {{.kind = SourceSpec::Kind::vertex, .indices = {pick(9), pick(9)}},
                 {.kind = SourceSpec::Kind::plane, .numbers = {number(), -number(), number(), number()}},
                 {.kind = SourceSpec::Kind::polyline, .file = folder / "x, y.csv"}};
  if (pick(5) > 0) job.pattern = static_cast<Pattern>(pick(5));
  job.planar_direction = Vec3(number(), -number(), 0);
  job.spacing = number();
  job.smooth = number();
  if (job.pattern == Pattern::planar || job.pattern == Pattern::double_spiral) job.smooth = 0;
  job.clearance = number();
  job.circle_radius = number();
  job.circle_step = number();
  job.min_radius = number();
  job.tool = {.process = static_cast<Process>(pick(3)),
              .stand_off = number(),
              .ball_diameter = number(),
              .axis_mode = static_cast<AxisMode>(pick(2)),
              .fixed_axis = Vec3(-number(), number(), number()),
              .cover_feed_mm_per_min = number(),
              .link_feed_mm_per_min = number(),
              .rapid_speed_mm_per_min = number(),
              .chord_tolerance = number(),
              .axis_tolerance = number() * 1e-9};
  if (pick(2)) job.programs = {"gcode5", "yaml"};
  job.report = pick(2) == 0;
  return job;
}

TEST_F(JobFile, RoundTripKeepsEveryDigit) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 rng(seed);
    Job job = random_job(rng, folder_);
    if (seed % 3 == 1) {
      job.pattern = seed % 2 == 0 ? Pattern::spiral : Pattern::double_spiral;
      job.smooth = 0;
      job.blend = seed % 4 < 2 ? Blending::least : Blending::paper;
    }
    if (seed % 3 == 0) {
      if (job.pattern == Pattern::double_spiral) job.pattern.reset();
      job.sources = {SourceSpec{}};
      job.smooth = 0;
      job.partition = {static_cast<PartitionBy>(rng() % 4), 0.001 + 3e-19 * static_cast<double>(rng() >> 2),
                       1 + 1e-18 * static_cast<double>(rng())};
    }
    const std::string text = job_yaml(job, folder_);
    const Job again = read_job(write("job.yaml", text));
    ASSERT_EQ(job_yaml(again, folder_), text) << "seed " << seed;
    ASSERT_EQ(again.mesh, job.mesh);
    ASSERT_EQ(again.unit, job.unit);
    ASSERT_EQ(again.sources, job.sources) << "seed " << seed;
    ASSERT_EQ(again.pattern, job.pattern);
    ASSERT_EQ(again.blend, job.blend);
    ASSERT_EQ(again.planar_direction, job.planar_direction);
    ASSERT_EQ(again.spacing, job.spacing);
    ASSERT_EQ(again.smooth, job.smooth);
    ASSERT_EQ(again.clearance, job.clearance);
    ASSERT_EQ(again.circle_radius, job.circle_radius);
    ASSERT_EQ(again.circle_step, job.circle_step);
    ASSERT_EQ(again.min_radius, job.min_radius);
    ASSERT_EQ(again.partition.by, job.partition.by);
    ASSERT_EQ(again.partition.crease_angle, job.partition.crease_angle);
    ASSERT_EQ(again.partition.unevenness, job.partition.unevenness);
    ASSERT_EQ(again.tool.process, job.tool.process);
    ASSERT_EQ(again.tool.axis_mode, job.tool.axis_mode);
    ASSERT_EQ(again.tool.fixed_axis, job.tool.fixed_axis);
    ASSERT_EQ(again.tool.stand_off, job.tool.stand_off);
    ASSERT_EQ(again.tool.ball_diameter, job.tool.ball_diameter);
    ASSERT_EQ(again.tool.cover_feed_mm_per_min, job.tool.cover_feed_mm_per_min);
    ASSERT_EQ(again.tool.link_feed_mm_per_min, job.tool.link_feed_mm_per_min);
    ASSERT_EQ(again.tool.rapid_speed_mm_per_min, job.tool.rapid_speed_mm_per_min);
    ASSERT_EQ(again.tool.chord_tolerance, job.tool.chord_tolerance);
    ASSERT_EQ(again.tool.axis_tolerance, job.tool.axis_tolerance);
    ASSERT_EQ(again.programs, job.programs);
    ASSERT_EQ(again.report, job.report);
  }
}

TEST_F(JobFile, ComplaintsNameLineKeyValueAndWhatIsAllowed) {
  const auto expect_all = [](const std::string& message, const std::vector<const char*>& parts) {
    for (const char* part : parts) EXPECT_NE(message.find(part), std::string::npos) << message << "\nlacks " << part;
  };
  expect_all(complaint("spacings: 3\n"), {"line 2", "spacings", "unknown key", "spacing, scallop, smooth, clearance"});
  expect_all(complaint("spacing: wide\n"), {"line 2", "spacing", "'wide'", "number"});
  expect_all(complaint("spacing: -1\n"), {"line 2", "spacing", "-1", "at least 0"});
  expect_all(complaint("spacing: [1]\n"), {"line 2", "spacing", "a list of 1", "number"});
  expect_all(complaint("spacing: .nan\n"), {"line 2", "spacing"});
  expect_all(complaint("spacing: 1\nspacing: 2\n"), {"line 3", "spacing", "twice"});
  expect_all(complaint("pattern: zigzag\n"), {"line 2", "pattern", "'zigzag'", "auto, contour, spiral"});
  expect_all(complaint("unit: furlong\n"), {"line 2", "unit", "'furlong'", "mm, cm, m, inch"});
  expect_all(complaint("sources: boundary\n"), {"line 2", "sources", "'boundary'", "list"});
  expect_all(complaint("sources: [boundary,\n  'vertex:x']\n"),
             {"line 3", "sources", "vertex:x", "'x'", "point:X,Y,Z"});
  expect_all(complaint("sources: []\n"), {"sources", "none given", "auto"});
  expect_all(complaint("blend: more\n"), {"line 2", "blend", "'more'", "none, least, paper"});
  expect_all(complaint("blend: least\npattern: meander\n"), {"blend", "meander", "double-spiral"});
  expect_all(complaint("blend: least\nscallop: 0.1\n"), {"blend", "scallop"});
  expect_all(complaint("pattern: double-spiral\nscallop: 0.1\n"), {"pattern", "scallop"});
  expect_all(complaint("blend: least\nsmooth: 2\n"), {"smooth", "no corners left"});
  expect_all(complaint("pattern: double-spiral\nblend: none\n"), {"blend", "double-spiral", "nested", "two-way"});
  expect_all(complaint("circle_radius: -2\n"), {"line 2", "circle_radius", "-2", "at least 0"});
  expect_all(complaint("pattern: trochoidal\nscallop: 0.1\n"), {"scallop", "circles"});
  expect_all(complaint("pattern: trochoidal\nsmooth: 3\n"), {"smooth", "circles"});
  expect_all(complaint("partition:\n  by: size\n"),
             {"line 3", "partition.by", "'size'", "none, creases, medial, both"});
  expect_all(complaint("partition:\n  unevenness: 1\n"), {"line 3", "partition.unevenness", "1", "above 1"});
  expect_all(complaint("partition:\n  crease_angle: 4\n"), {"crease_angle", "4", "below π"});
  expect_all(complaint("sources: [boundary]\npartition:\n  by: medial\n"), {"partition", "medial", "'boundary'"});
  expect_all(complaint("tool: 5\n"), {"line 2", "tool", "'5'", "mapping"});
  expect_all(complaint("tool:\n  process: knit\n"), {"line 3", "tool.process", "'knit'", "spray, mill, grind"});
  expect_all(complaint("tool:\n  diameter: 3\n"), {"line 3", "tool.diameter", "unknown key", "ball_diameter"});
  expect_all(complaint("tool:\n  ball_diameter: 0\n"), {"line 3", "tool.ball_diameter", "0", "above 0"});
  expect_all(complaint("planar_direction: [1, 2]\n"), {"line 2", "planar_direction", "a list of 2", "three"});
  expect_all(complaint("planar_direction: [.nan, 0, 0]\n"), {"planar_direction", "nan"});
  expect_all(complaint("programs: [apt]\n"), {"line 2", "programs", "'apt'", "gcode3, gcode5"});
  expect_all(complaint("programs: [gcode3]\ntool:\n  axis: fixed_direction\n  fixed_axis: [0, 2, 0]\n"),
             {"programs", "gcode3", "0, 1, 0", "the axis 0, 0, 1"});
  expect_all(complaint("report: yes please\n"), {"line 2", "report", "'yes please'", "true or false"});
  expect_all(complaint("spacing: [1\n"), {"line", "not a YAML file"});
}

TEST_F(JobFile, AMissingMeshOrFileIsSaid) {
  EXPECT_THROW(read_job(write("job.yaml", "spacing: 3\n")), Error);
  EXPECT_THROW(read_job(write("job.yaml", "")), Error);
  EXPECT_THROW(read_job(write("job.yaml", "- mesh\n")), Error);
  EXPECT_THROW(read_job(folder_ / "none.yaml"), Error);
}

}  // namespace
}  // namespace isopath
