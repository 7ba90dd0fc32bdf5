#pragma once
#include "pbrt/core/params.h"

/// Ranges shared by several parameters. docs/reference/parameters.md lists all ranges, docs/reference/compatibility.md
/// all other limits.
namespace pbrt {

/// Embree drops vertices beyond sqrt(largest float) / 10 = 1.844e18 and rejects rays that start there. This bound on
/// coordinates keeps arbitrarily rotated instances below Embree's, and squared distances finite.
inline constexpr Float kMaxCoordinate = 1e18f;
inline constexpr Range<Float> kCoordinateRange{-kMaxCoordinate, kMaxCoordinate};
inline constexpr Range<Float> kLengthRange = Positive(kMaxCoordinate);

/// Upper bound of radiance, intensity, and factors that scale them.
inline constexpr Float kMaxBrightness = 1e30f;
inline constexpr Range<Float> kBrightnessRange{0, kMaxBrightness};
/// Power or illuminance of a scaled light; values <= 0 leave the light unscaled.
inline constexpr Range<Float> kPowerRange{-kMaxBrightness, kMaxBrightness};

/// Nesting limit of textures, material mixes and included files.
inline constexpr int kMaxNesting = 256;

}  // namespace pbrt
