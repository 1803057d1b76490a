#define EIGEN_MPL2_ONLY
#include "isopath/field/smooth_field.h"

#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "isopath/core/error.h"
#include "isopath/field/smooth_field_checks.h"

namespace isopath {
namespace {

/// Where the coefficient is below this share of the largest possible, values are held.
constexpr double least_local = 1e-12;

/// The graph that values flow on: vertices that are reached, and of the edges those between them.
class Flow {
 public:
  Flow(const SurfaceLaplacian& laplacian, std::span<const double> values, std::span<const double> local)
      : laplacian_(laplacian), values_(values.begin(), values.end()), local_(local.begin(), local.end()) {
    local_.resize(values.size(), 1.0);
    for (const auto& [a, b, t] : laplacian.added) {
      // the function is linear along the edge that the vertex was put on
      values_.push_back((1 - t) * values_[a] + t * values_[b]);
      local_.push_back((1 - t) * local_[a] + t * local_[b]);
    }
    weight_sum_.assign(values_.size(), 0);
    for (const SurfaceLaplacian::Edge& edge : laplacian.edges) {
      if (!std::isfinite(values_[edge.a]) || !std::isfinite(values_[edge.b])) continue;
      edges_.push_back(edge);
      weight_sum_[edge.a] += edge.weight;
      weight_sum_[edge.b] += edge.weight;
    }
    for (std::size_t v = 0; v < values_.size(); ++v) {
      if (!(laplacian.area[v] > 0) || !(weight_sum_[v] > 0) || local_[v] < least_local) local_[v] = 0;
    }
  }

  /// Σ w_ij (f_j - f_i) at every vertex.
  std::vector<double> inflow() const {
    std::vector<double> sum(values_.size(), 0.0);
    for (const auto& [a, b, weight] : edges_) {
      const double flow = weight * (values_[b] - values_[a]);
      sum[a] += flow;
      sum[b] -= flow;
    }
    return sum;
  }

  void forward(double step, int steps, const Progress& progress) {
    double worst = 0;
    for (std::size_t v = 0; v < values_.size(); ++v) {
      if (local_[v] > 0) worst = std::max(worst, step * local_[v] * weight_sum_[v] / laplacian_.area[v]);
    }
    if (worst > 1) {
      throw Error(ErrorCode::bad_usage, "explicit steps of diffusion are too long for the mesh to be stable",
                  {.element = "steps",
                   .value = fmt::format("{}, at least {:.0f} are needed", steps, std::ceil(worst * steps)),
                   .advice = "take the implicit scheme, which any step is fine for"});
    }
    for (int k = 0; k < steps; ++k) {
      progress.checkpoint();
      const std::vector<double> sum = inflow();
      for (std::size_t v = 0; v < values_.size(); ++v) {
        if (local_[v] > 0) values_[v] += step * local_[v] / laplacian_.area[v] * sum[v];
      }
    }
  }

  void normalized(double share, int steps, const Progress& progress) {
    for (int k = 0; k < steps; ++k) {
      progress.checkpoint();
      const std::vector<double> sum = inflow();
      for (std::size_t v = 0; v < values_.size(); ++v) {
        if (local_[v] > 0) values_[v] += share * local_[v] / weight_sum_[v] * sum[v];
      }
    }
  }

  /// (A / c + h L) (f' - f) = -h L f: rows divided by c, so that the matrix is symmetric where c varies, and solved for
  /// the change, so that a constant has none.
  void backward(double step, int steps, const Progress& progress) {
    std::vector<int> unknown(values_.size(), -1);
    int n = 0;
    for (std::size_t v = 0; v < values_.size(); ++v) {
      if (local_[v] > 0) unknown[v] = n++;
    }
    if (n == 0) return;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(edges_.size() + values_.size());
    for (const auto& [a, b, weight] : edges_) {
      const int i = unknown[a];
      const int j = unknown[b];
      if (i >= 0 && j >= 0) entries.emplace_back(std::max(i, j), std::min(i, j), -step * weight);
    }
    for (std::size_t v = 0; v < values_.size(); ++v) {
      if (unknown[v] < 0) continue;
      entries.emplace_back(unknown[v], unknown[v], laplacian_.area[v] / local_[v] + step * weight_sum_[v]);
    }
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    progress.checkpoint();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    if (solver.info() != Eigen::Success) throw Error(ErrorCode::internal, "the diffusion's matrix is not definite");
    Eigen::VectorXd change(n);
    for (int k = 0; k < steps; ++k) {
      progress.checkpoint();
      const std::vector<double> sum = inflow();
      for (std::size_t v = 0; v < values_.size(); ++v) {
        if (unknown[v] >= 0) change[unknown[v]] = step * sum[v];
      }
      change = solver.solve(Eigen::VectorXd(change));
      for (std::size_t v = 0; v < values_.size(); ++v) {
        if (unknown[v] >= 0) values_[v] += change[unknown[v]];
      }
    }
  }

  /// The values at the mesh's vertices, with the volume they had.
  std::vector<double> take(bool conserve_volume, std::span<const double> before) {
    values_.resize(before.size());
    if (conserve_volume) restore_volume(laplacian_, before, values_);
    return std::move(values_);
  }

 private:
  const SurfaceLaplacian& laplacian_;
  std::vector<double> values_;
  std::vector<double> local_;
  std::vector<double> weight_sum_;
  std::vector<SurfaceLaplacian::Edge> edges_;
};

}  // namespace

void restore_volume(const SurfaceLaplacian& laplacian, std::span<const double> before, std::vector<double>& values) {
  const double wanted = volume_under(laplacian, before);
  const double found = volume_under(laplacian, values);
  if (!(wanted > 0 && found > 0)) return;
  for (double& value : values) value *= wanted / found;
}

void check_smoothing(const SurfaceLaplacian& laplacian, std::span<const double> values, std::span<const double> local,
                     bool conserve_volume) {
  const auto refuse = [](const char* what, std::string element, std::string value) {
    throw Error(ErrorCode::bad_usage, what, {.element = std::move(element), .value = std::move(value)});
  };
  const auto n = static_cast<std::size_t>(laplacian.n_vertices());
  if (values.size() != n) {
    refuse("smoothing needs one value for each vertex", "values",
           fmt::format("{} values for {} vertices", values.size(), n));
  }
  if (!local.empty() && local.size() != n) {
    refuse("smoothing needs one local factor for each vertex, or none at all", "local",
           fmt::format("{} factors for {} vertices", local.size(), n));
  }
  for (std::size_t v = 0; v < n; ++v) {
    const std::string element = fmt::format("vertex {}", v);
    if (std::isnan(values[v]) || values[v] == -infinity || (conserve_volume && values[v] < 0)) {
      refuse(conserve_volume ? "the volume is conserved for values from 0 up" : "values to be smoothed must be numbers",
             element, fmt::format("{}", values[v]));
    }
    if (!local.empty() && !(local[v] >= 0 && local[v] <= 1)) {
      refuse("the local factor of smoothing lies between 0 and 1", element, fmt::format("{}", local[v]));
    }
  }
}

std::vector<double> diffused(const SurfaceLaplacian& laplacian, std::span<const double> values,
                             const DiffusionOptions& options, const Progress& progress) {
  if (!(options.width > 0 && options.width < infinity)) {
    throw Error(ErrorCode::bad_usage, "the width of smoothing is not a positive length",
                {.element = "width", .value = fmt::format("{} mm", options.width)});
  }
  if (options.steps < 1) {
    throw Error(ErrorCode::bad_usage, "smoothing needs a step at least",
                {.element = "steps", .value = fmt::format("{}", options.steps)});
  }
  check_smoothing(laplacian, values, options.local, options.conserve_volume);
  Flow flow(laplacian, values, options.local);
  const double step = 0.5 * options.width * options.width / options.steps;
  if (options.scheme == DiffusionScheme::backward) {
    flow.backward(step, options.steps, progress);
  } else {
    flow.forward(step, options.steps, progress);
  }
  return flow.take(options.conserve_volume, values);
}

std::vector<double> relaxed(const SurfaceLaplacian& laplacian, std::span<const double> values,
                            const RelaxationOptions& options, const Progress& progress) {
  if (!(options.share >= 0 && options.share <= 1)) {
    throw Error(ErrorCode::bad_usage, "the share of relaxation lies between 0 and 1",
                {.element = "share", .value = fmt::format("{}", options.share)});
  }
  if (options.steps < 0) {
    throw Error(ErrorCode::bad_usage, "the number of steps is negative",
                {.element = "steps", .value = fmt::format("{}", options.steps)});
  }
  check_smoothing(laplacian, values, options.local, options.conserve_volume);
  Flow flow(laplacian, values, options.local);
  flow.normalized(options.share, options.steps, progress);
  return flow.take(options.conserve_volume, values);
}

}  // namespace isopath
