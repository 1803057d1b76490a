#include "isopath/field/local_geometry.h"

#include "isopath/field/local_halfedges.h"

namespace isopath {

LocalGeometry::LocalGeometry(const IntrinsicGeometry& geometry, const LocalNumbering& numbering)
    : length_(geometry.lengths()), apex_(geometry.apexes()), angle_(geometry.angles()) {
  if (numbering.is_that_of_mesh()) return;
  own_length_.resize(length_.size());
  own_apex_.resize(apex_.size());
  own_angle_.resize(angle_.size());
  const auto fetch = [&](Index later, Index) {
    __builtin_prefetch(&length_[later]);
    __builtin_prefetch(&apex_[later]);
    __builtin_prefetch(&angle_[later]);
  };
  copy_halfedges(numbering, static_cast<Index>(length_.size()), fetch, [&](Index here, Index in_mesh) {
    own_length_[here] = length_[in_mesh];
    own_apex_[here] = apex_[in_mesh];
    own_angle_[here] = angle_[in_mesh];
  });
  length_ = own_length_;
  apex_ = own_apex_;
  angle_ = own_angle_;
}

}  // namespace isopath
