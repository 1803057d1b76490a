#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "isopath/contour/blend.h"
#include "isopath/core/geometry.h"
#include "isopath/impact/impact_plan.h"
#include "isopath/plan/partition.h"
#include "isopath/plan/source_spec.h"
#include "isopath/tool/tool_model.h"

namespace isopath {

/// Unit of the coordinates in a mesh file.
enum class LengthUnit { millimetre, centimetre, metre, inch };
std::string_view name_of(LengthUnit unit);  ///< mm, cm, m, inch
double millimetres_in(LengthUnit unit);

/// Whether distances are blended with the medial axis, and how.
enum class Blending {
  automatic,  ///< in the least form where that makes a better spiral, see plan/spiral_choice.h, and a double spiral
  none,       ///< not at all
  least,      ///< BlendForm::least
  paper,      ///< BlendForm::paper
};
std::string_view name_of(Blending blending);  ///< auto, none, least, paper
/// The form that was asked for; none where none was, or where the planner is to choose.
std::optional<BlendForm> form_of(Blending blending);

/// Everything a planning run needs. A job file holds the same, and a run writes the job it used beside its results.
/// Lengths in mm, angles in radians, feeds in mm/min.
struct Job {
  std::filesystem::path mesh;                        ///< required; relative to the working folder
  LengthUnit unit = LengthUnit::millimetre;          ///< unit of the mesh file's coordinates
  std::vector<SourceSpec> sources = {SourceSpec{}};  ///< where distances are measured from; joined. Default: auto
  std::optional<Pattern> pattern = {};               ///< none: what suits the part, see plan/auto_pattern.h
  /// Blends the distances with the medial axis, so that the isolines of a part without holes are nested closed curves:
  /// for the patterns contour, spiral, double-spiral and two-way.
  Blending blend = Blending::automatic;
  /// planar: the direction the cutting planes follow each other in; 0 for the one that makes few long passes.
  Vec3 planar_direction = Vec3::Zero();
  double spacing = 0;  ///< between neighbouring passes; 0 takes 1/60 of the part's size
  /// Height of the cusps that the ball is to leave everywhere, mm, below its radius; 0 keeps the spacing the same
  /// instead. For planar passes the pitch is that of a flat surface, and cusps are only measured.
  double scallop = 0;
  /// Corners of the isolines are rounded by smoothing the distances over this width, mm, see `smoothed_distances`; 0
  /// keeps them exact. Not for planar passes, circles and double spirals, and not with a blend or a partition.
  double smooth = 0;
  double clearance = 0;      ///< height of lifts above the surface; 0 takes the spacing
  double circle_radius = 0;  ///< trochoidal: greatest radius of the circles; 0 takes three spacings
  double circle_step = 0;    ///< trochoidal: way of their centre in a turn; 0 takes the spacing
  /// Patches that are planned one by one, each from its own border: then the sources are `auto`, and the spacing is
  /// not given by a scallop.
  PartitionOptions partition = {};
  double min_radius = 0;  ///< smallest radius that the curve turns with on the surface; 0: see ImpactOptions
  ToolOptions tool = {};  ///< process, tool, feeds
  std::vector<std::string> programs =
      {};              ///< formats to write the program in, of `export_formats()`; none: the planner chooses
  bool report = true;  ///< write report.html

  /// Throws Error(bad_usage) naming the field, its value and its limit.
  void validate() const;
};

/// The name a job file gives a pattern: `auto` for none.
std::string_view name_of(const std::optional<Pattern>& pattern);
/// Its inverse. Throws Error(bad_usage) listing the allowed names.
std::optional<Pattern> pattern_of(std::string_view name);
/// Throw Error(bad_usage) listing the allowed names.
Process process_of(std::string_view name);
LengthUnit unit_of(std::string_view name);
Blending blending_of(std::string_view name);
PartitionBy partition_of(std::string_view name);
void check_program_format(std::string_view name);

/// Reads a job file (YAML). Paths in it are relative to its folder. Throws Error(bad_input) with file, line, key,
/// value and what is allowed, also for unknown keys and keys given twice.
Job read_job(const std::filesystem::path& path);

/// The job as YAML for a file in `folder`: paths are written relative to it, numbers with all their digits, so that
/// `read_job` gives back the same job.
std::string job_yaml(const Job& job, const std::filesystem::path& folder);

}  // namespace isopath
