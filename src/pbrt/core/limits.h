#pragma once
#include "pbrt/core/params.h"

/// Ranges that several parameters share. docs/reference/parameters.md lists the ranges of all parameters,
/// docs/reference/compatibility.md all other limits.
namespace pbrt {

/// Embree drops vertices beyond sqrt(largest float) / 10 = 1.844e18 and refuses rays that start there. With this bound
/// on every coordinate, vertices stay below Embree's bound when an instance rotates them by any angle, and squared
/// distances stay finite.
inline constexpr Float kMaxCoordinate = 1e18f;
inline constexpr Range<Float> kCoordinateRange{-kMaxCoordinate, kMaxCoordinate};
inline constexpr Range<Float> kLengthRange = Positive(kMaxCoordinate);

/// Upper bound of radiance, intensity, and factors that scale them.
inline constexpr Float kMaxBrightness = 1e30f;
inline constexpr Range<Float> kBrightnessRange{0, kMaxBrightness};
/// Power or illuminance that a light is scaled to; 0 or a negative value leaves the light unscaled.
inline constexpr Range<Float> kPowerRange{-kMaxBrightness, kMaxBrightness};

/// How deep textures, mixes of materials and included files may be nested.
inline constexpr int kMaxNesting = 256;

}  // namespace pbrt
