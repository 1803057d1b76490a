// One table of what exact distance fields cost: windows, time, memory, and how they grow with the mesh.
//   field_table [CASE...]   only the cases whose name begins with one of the words
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "bumpy_ball.h"
#include "isopath/field/exact_field.h"
#include "isopath/field/list_propagation.h"
#include "support/hard_meshes.h"
#include "support/test_meshes.h"

namespace isopath {
namespace {

constexpr int repetitions = 5;

struct Cost {
  double seconds = 0;
  std::size_t propagated = 0;
  std::size_t kept = 0;
  std::size_t window_bytes = 0;  ///< behind the front, or retained
};

Cost distances_only(const TriangleMesh& mesh, const SourceSet& sources) {
  const IntrinsicGeometry geometry(mesh);
  ListPropagation propagation(mesh, geometry, false);
  propagation.start(source_fronts(mesh, geometry, sources));
  propagation.run(infinity, Progress::none());
  return {0, propagation.propagated(), 0, propagation.window_bytes()};
}

Cost retained(const TriangleMesh& mesh, const SourceSet& sources, double accuracy) {
  const ExactField field = ExactField::compute(mesh, sources, {.accuracy = accuracy * mesh.size()});
  return {0, field.windows_propagated(), field.windows_kept(), field.windows_kept() * sizeof(Window)};
}

/// The median of some runs.
Cost measure(const std::function<Cost()>& run) {
  std::vector<double> seconds;
  Cost cost;
  for (int i = 0; i < repetitions; ++i) {
    const auto start = std::chrono::steady_clock::now();
    cost = run();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + repetitions / 2, seconds.end());
  cost.seconds = seconds[repetitions / 2];
  return cost;
}

class Table {
 public:
  explicit Table(std::vector<std::string> wanted) : wanted_(std::move(wanted)) {
    std::puts(
        "| case | triangles | threads | seconds | growth | windows propagated | kept | ns a window | MB of windows |");
    std::puts("|---|---|---|---|---|---|---|---|---|");
  }

  bool wants(std::string_view name) const {
    return wanted_.empty() ||
           std::any_of(wanted_.begin(), wanted_.end(), [&](const auto& word) { return name.starts_with(word); });
  }

  /// `growth` is the exponent against the row before, when that is of the same case and number of threads.
  void add(const std::string& name, const TriangleMesh& mesh, std::size_t threads, const std::function<Cost()>& run) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Cost cost = measure(run);
    std::string growth = "–";
    if (name == last_name_ && threads == last_threads_ && mesh.n_faces() != last_faces_) {
      growth = fmt::format("{:.2f}", std::log(cost.seconds / last_seconds_) /
                                         std::log(static_cast<double>(mesh.n_faces()) / last_faces_));
    }
    fmt::print("| {} | {} | {} | {:.3f} | {} | {:.2f} M | {:.2f} M | {:.1f} | {:.1f} |\n", name, mesh.n_faces(),
               threads, cost.seconds, growth, 1e-6 * static_cast<double>(cost.propagated),
               1e-6 * static_cast<double>(cost.kept),
               1e9 * cost.seconds / static_cast<double>(std::max<std::size_t>(cost.propagated, 1)),
               1e-6 * static_cast<double>(cost.window_bytes));
    std::fflush(stdout);
    last_name_ = name;
    last_threads_ = threads;
    last_faces_ = mesh.n_faces();
    last_seconds_ = cost.seconds;
  }

 private:
  std::vector<std::string> wanted_;
  std::string last_name_;
  std::size_t last_threads_ = 0;
  Index last_faces_ = 0;
  double last_seconds_ = 0;
};

TriangleMesh wavy(int cells) { return test::wavy_sheet(cells, 1, 0.1, 6, 5, 1); }
/// The same with vertices and triangles in random order.
TriangleMesh scattered(int cells) {
  test::Rng rng(1);
  return test::renumbered(rng, wavy(cells)).mesh;
}

void fill(Table& table) {
  const auto from_vertex = [&](const std::string& name, std::initializer_list<int> sizes, const auto& make) {
    if (!table.wants(name)) return;
    for (const std::size_t threads : {1, 2}) {
      for (const int size : sizes) {
        const TriangleMesh mesh = make(size);
        SourceSet source;
        source.add_vertex(mesh, 0);
        table.add(name, mesh, threads, [&] { return distances_only(mesh, source); });
      }
    }
  };
  from_vertex("wavy-point", {158, 316, 500, 707}, wavy);
  from_vertex("blade-point", {1000}, [](int chord) { return test::lofted_blade(50, chord); });
  from_vertex("ball-point", {6, 7}, bumpy_ball);
  from_vertex("scattered-point", {316, 707}, scattered);
  const auto from_boundary = [&](const std::string& kind, double accuracy, const auto& make) {
    const std::string name = fmt::format("{}-boundary-{:g}", kind, accuracy);
    if (!table.wants(name)) return;
    for (const std::size_t threads : {1, 2}) {
      for (const int cells : {71, 224, 707}) {
        if (accuracy == 0 && cells > 224) continue;  // six million windows on a tenth of it
        const TriangleMesh mesh = make(cells);
        const SourceSet source = boundary_source(mesh);
        table.add(name, mesh, threads, [&] { return retained(mesh, source, accuracy); });
      }
    }
  };
  for (const double accuracy : {0.0, 1e-7, 1e-6, 1e-3}) from_boundary("wavy", accuracy, wavy);
  from_boundary("scattered", 1e-6, scattered);
}

}  // namespace
}  // namespace isopath

int main(int argc, char** argv) {
  isopath::Table table({argv + 1, argv + argc});
  isopath::fill(table);
}
