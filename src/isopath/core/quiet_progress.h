#pragma once

#include "isopath/core/progress.h"

namespace isopath {

/// Hears from another object that it should stop, and tells it nothing: for computations that are a small part of a
/// stage. That object must outlive this one.
class QuietProgress final : public Progress {
 public:
  explicit QuietProgress(const Progress& outer) : outer_(outer) {}
  bool cancelled() const override { return outer_.cancelled(); }

 private:
  const Progress& outer_;
};

}  // namespace isopath
