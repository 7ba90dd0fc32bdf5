#pragma once

namespace pbrt {
/// Single precision, also for values read from scene files, as in stock pbrt-v4.
using Float = float;
}  // namespace pbrt
