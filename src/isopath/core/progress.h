#pragma once

#include <string_view>

namespace isopath {

/// How a long computation tells where it is, and hears that it should stop.
/// The default object says nothing and never stops; derive from it to draw a bar. Methods may be called from any
/// thread.
class Progress {
 public:
  Progress() = default;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  virtual ~Progress() = default;

  /// A new stage begins, for example "distance field".
  virtual void stage(std::string_view) {}
  /// Fraction of the current stage that is done, in [0, 1].
  virtual void at(double) {}
  /// True once the caller wants to stop.
  virtual bool cancelled() const { return false; }

  /// Throws Error(cancelled) once cancelled() holds. Long loops call it at least every 100 ms.
  void checkpoint() const;

  /// A silent object, for callers who do not care.
  static Progress& none();
};

}  // namespace isopath
