#pragma once

namespace pbrt {
/// The renderer's real number. Values read from scene files have this precision, as in stock pbrt-v4.
using Float = float;
}  // namespace pbrt
