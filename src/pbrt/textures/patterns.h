#pragma once
#include "pbrt/spectra/color_space.h"
#include "pbrt/textures/texture_mapping.h"

namespace pbrt {

/// Square wave (+1 on [0, 1), -1 on [1, 2), ...) filtered by a tent of half-width `radius` around x.
Float FilteredSquareWave(Float x, Float radius);

/// Weight of a checkerboard's second texture, in [0, 1]: 0 in the cell at the origin, alternating, filtered over the
/// footprint.
Float CheckerWeight(const TextureMapping2D &mapping, const TextureContext &ctx);
Float CheckerWeight(const PointMapping &mapping, const TextureContext &ctx);

/// True in random dots of radius 0.35, in about 40 % of the unit cells around integer (s, t).
bool IsInDot(const Point2 &st);

/// Waves with height modulated by low-frequency noise.
Float WindyNoise(const TexCoord3 &c);

/// Colour of marble (sRGB) at t in [0, 1] of a vein's period.
Rgb MarbleColor(Float t);

}  // namespace pbrt
