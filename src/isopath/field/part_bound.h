#pragma once

#include "isopath/field/exact_field_data.h"
#include "isopath/field/face_part.h"

namespace isopath {

/// No distance in a part of a face is larger, up to the field's accuracy; `nearest` is the way back from its centre.
///
/// The way by one window, or to one source, is a convex function of where it starts, and so is the sum of two: they are
/// largest at corners. The lesser of two is never more than half their sum. Between two passes that are parallel this
/// sum is the same everywhere, so that the bound is as good in a large part as in a small one.
double bound_in_part(const ExactFieldData& data, const FacePart& part, const WayBack& nearest);

}  // namespace isopath
