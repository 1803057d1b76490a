#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isopath/core/geometry.h"
#include "isopath/impact/impact_curve.h"
#include "isopath/mesh/refine.h"
#include "isopath/mesh/triangle_mesh.h"
#include "isopath/tool/tool_path.h"

namespace isopath {

/// A value at every vertex of the mesh that is shown, which the report can colour the surface by: distance, gap,
/// thickness, curvature.
struct VertexScalar {
  std::string name;            ///< as the reader knows it, for example "gap"
  std::string unit;            ///< "mm"; empty for a plain number
  std::vector<double> values;  ///< one a vertex; a value that is not finite is drawn as "no value"
  /// Ends of the colour scale; without them, the least and the greatest finite value.
  std::optional<double> least = {};
  std::optional<double> greatest = {};
  /// Values above it are shown as faults: the greatest permitted gap, scallop or thickness.
  std::optional<double> limit = {};
  /// The sign matters: the colour scale is symmetric about zero.
  bool diverging = false;
};

/// A polyline on the surface at one level of the field.
struct ReportIsoline {
  std::vector<Vec3> points;  ///< mm
  bool closed = false;
  double level = 0;
};

/// One line of a table of figures. Text is shown as it is given.
struct ReportFigure {
  std::string label;
  std::string value;
  std::string unit = {};
  std::string explanation = {};  ///< what the figure means, one sentence
};

struct ReportTable {
  std::string title;
  std::vector<ReportFigure> rows;
};

/// How a value is distributed over the surface. Bins have one width and start at zero; the last one takes the rest.
struct ReportHistogram {
  struct Mark {
    double value = 0;
    std::string label;
  };
  std::string title;
  std::string unit = {};
  double bin_width = 1;
  std::vector<double> shares;  ///< share of the area in each bin, 0 to 1
  std::vector<Mark> marks = {};
  std::optional<double> limit = {};  ///< bins above it are shown as faults
};

/// What a report shows. What is pointed to must outlive the call; a null pointer or an empty list is left out.
struct ReportData {
  std::string title;
  std::string subtitle = {};           ///< for example the command that made the plan
  const TriangleMesh* mesh = nullptr;  ///< required
  /// A finer mesh of the same surface whose vertices the scalars belong to; without it, those of the mesh itself.
  const RefinedMesh* shown = nullptr;
  std::vector<VertexScalar> scalars = {};
  std::vector<ReportIsoline> isolines = {};
  std::string isolines_name = "Isolines";  ///< what the lines are, where they are others
  const ImpactCurve* impact = nullptr;
  const ToolPath* tool = nullptr;
  std::vector<ReportTable> tables = {};
  std::vector<ReportHistogram> histograms = {};
  std::vector<std::string> warnings = {};
};

/// The report as one HTML page that opens from disk without network: the part in three dimensions with its scalars,
/// isolines, path and moving tool, and the tables and histograms. Coordinates are stored in single precision relative
/// to the centre of the part. Throws Error(bad_usage) when the mesh is missing, the shown one is not a refinement of
/// it, or a scalar has not one value a vertex.
std::string report_html(const ReportData& data);

}  // namespace isopath
