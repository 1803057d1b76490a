#pragma once

#include <span>
#include <vector>

#include "isopath/core/progress.h"
#include "isopath/field/surface_laplacian.h"
#include "isopath/mesh/triangle_mesh.h"

namespace isopath {

/// Smoothing of functions that are given at the vertices (paper ch. 9): of distance fields above all, whose isolines
/// have corners where fronts meet. Values of infinity, at vertices that are not reached, stay; nothing flows there.
///
/// All three ways take a factor for every vertex between 0 and 1, `local`, that says how much is smoothed there; empty
/// means 1 everywhere. Where it is 0 the value is held.

enum class DiffusionScheme {
  backward,  ///< implicit: (M + h c L) f' = M f. Any step is stable, and no value leaves the range of those before
  forward,   ///< explicit: (f' - f) / h = c Δf. Many small steps
};

struct DiffusionOptions {
  DiffusionScheme scheme = DiffusionScheme::backward;
  /// How far values are averaged, mm; required, positive. After all steps a single high value has become a hill whose
  /// standard deviation in every direction is this long: c times the time is width² / 2.
  double width = 0;
  /// Number of steps of equal length, 1 or more. A single backward step leaves a peak at the middle of that hill, four
  /// are close to a Gaussian.
  int steps = 4;
  std::span<const double> local = {};  ///< of c at every vertex, in [0, 1]
  /// Multiplies the result so that Σ A f is what it was, which held values change (Desbrun, Meyer, Schröder & Barr
  /// 1999). Zeros stay zeros. For functions that are nowhere negative.
  bool conserve_volume = true;
};

/// The values after ∂f/∂t = c Δf. Throws Error(bad_usage) for options or a number of values or factors that do not
/// fit, for values below zero where the volume is to be conserved, and for forward steps too long to be stable, with
/// the least number that is; Error(cancelled) on request.
std::vector<double> diffused(const SurfaceLaplacian& laplacian, std::span<const double> values,
                             const DiffusionOptions& options, const Progress& progress = Progress::none());

struct RelaxationOptions {
  double share = 0.5;                  ///< λ in [0, 1]: how far a value moves towards the mean of its neighbours
  int steps = 10;                      ///< 0 or more
  std::span<const double> local = {};  ///< of λ at every vertex, in [0, 1]
  bool conserve_volume = true;         ///< as above
};

/// The normalised explicit form, f_i += λ Σ w_ij (f_j - f_i) with weights that add up to 1 at every vertex (Desbrun et
/// al. 1999): stable for every λ, but how far it smooths depends on the size of the triangles. Throws as `diffused`.
std::vector<double> relaxed(const SurfaceLaplacian& laplacian, std::span<const double> values,
                            const RelaxationOptions& options, const Progress& progress = Progress::none());

struct ConvolutionOptions {
  double radius = 0;                   ///< b, mm; required, positive
  std::span<const double> local = {};  ///< of the radius at every vertex, in [0, 1]
  bool conserve_volume = true;         ///< as above
};

/// The weighted mean of all vertices geodesically nearer than the radius b (paper ch. 9.1), with weights A_j (1 - d² /
/// b²)²: once differentiable, zero outside of a disc. Its standard deviation in every direction is b / √8. Distances
/// are lengths of straight ways on the surface; to vertices behind corners that none of them leads round, of ways that
/// go on along edges. Time grows with the number of triangles in all discs. Throws as `diffused`.
std::vector<double> convolved(const TriangleMesh& mesh, const SurfaceLaplacian& laplacian,
                              std::span<const double> values, const ConvolutionOptions& options,
                              const Progress& progress = Progress::none());

}  // namespace isopath
