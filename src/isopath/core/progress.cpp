#include "isopath/core/progress.h"

#include "isopath/core/error.h"

namespace isopath {

void Progress::checkpoint() const {
  if (cancelled()) throw Error(ErrorCode::cancelled, "stopped on request");
}

Progress& Progress::none() {
  static Progress silent;  // stateless, so sharing it is harmless
  return silent;
}

}  // namespace isopath
