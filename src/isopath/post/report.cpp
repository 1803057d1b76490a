#include "isopath/post/report.h"

#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "isopath/core/error.h"
#include "isopath/core/markup.h"
#include "isopath/post/report_blocks.h"
#include "isopath/post/viewer_assets.h"

namespace isopath {
namespace {

void check(const ReportData& data) {
  if (data.mesh == nullptr) throw Error(ErrorCode::bad_usage, "a report needs a mesh");
  if (data.shown != nullptr && data.shown->mesh.n_vertices() < data.mesh->n_vertices())
    throw Error(ErrorCode::bad_usage, "the mesh that is shown is not a refinement of the report's mesh");
  const auto n_vertices =
      static_cast<std::size_t>((data.shown != nullptr ? data.shown->mesh : *data.mesh).n_vertices());
  for (const VertexScalar& scalar : data.scalars) {
    if (scalar.values.size() == n_vertices) continue;
    throw Error(ErrorCode::bad_usage, "a scalar of the report has not one value for each vertex",
                {.element = "scalar " + scalar.name,
                 .value = fmt::format("{} values, {} vertices", scalar.values.size(), n_vertices)});
  }
}

std::string html_of(const ReportTable& table) {
  std::string html = fmt::format("<section class=\"figures\"><h2>{}</h2><table>\n", markup_escaped(table.title));
  for (const ReportFigure& row : table.rows) {
    const std::string note =
        row.explanation.empty() ? std::string() : fmt::format("<small>{}</small>", markup_escaped(row.explanation));
    html += fmt::format("<tr><th scope=\"row\">{}{}</th><td>{}</td><td class=\"unit\">{}</td></tr>\n",
                        markup_escaped(row.label), note, markup_escaped(row.value), markup_escaped(row.unit));
  }
  return html + "</table></section>\n";
}

std::string html_of_warnings(const std::vector<std::string>& warnings) {
  if (warnings.empty()) return {};
  std::string html = "<section class=\"warnings\"><h2>Warnings</h2><ul>\n";
  for (const std::string& warning : warnings) html += fmt::format("<li>{}</li>\n", markup_escaped(warning));
  return html + "</ul></section>\n";
}

std::string content_of(std::string_view place, const ReportData& data) {
  if (place == "title") return markup_escaped(data.title);
  if (place == "subtitle") return markup_escaped(data.subtitle);
  if (place == "style") return std::string(viewer_style());
  if (place == "script") return std::string(viewer_script());
  if (place == "warnings") return html_of_warnings(data.warnings);
  if (place == "data") return report_blocks(data);
  if (place == "tables") {
    std::string html;
    for (const ReportTable& table : data.tables) html += html_of(table);
    return html;
  }
  throw Error(ErrorCode::internal, "the viewer's page has a place that nothing fills", {.value = std::string(place)});
}

}  // namespace

std::string report_html(const ReportData& data) {
  check(data);
  std::string html;
  std::string_view page = viewer_page();
  for (;;) {
    const std::size_t open = page.find("{{");
    html += page.substr(0, open);
    if (open == std::string_view::npos) return html;
    const std::size_t close = page.find("}}", open);
    html += content_of(page.substr(open + 2, close - open - 2), data);
    page.remove_prefix(close + 2);
  }
}

}  // namespace isopath
