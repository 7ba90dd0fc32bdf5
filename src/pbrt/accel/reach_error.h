#pragma once
#include "pbrt/core/error.h"

namespace pbrt {

/// An instance is so small that rays from the other end of the scene have no finite coordinates in its space. Has no
/// location: Accel does not know where instances stand in scene files.
class ReachError : public UserError {
  public:
    using UserError::UserError;
};

}  // namespace pbrt
