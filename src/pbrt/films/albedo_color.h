#pragma once
#include "pbrt/films/visible_surface.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// The colour that a white light of the space has after one reflection at the surface.
Rgb AlbedoColor(const VisibleSurface &visible, const ColorSpace &space);

}  // namespace pbrt
