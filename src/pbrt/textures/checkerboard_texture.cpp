#include "pbrt/textures/checkerboard_texture.h"

namespace pbrt {

namespace {

Float Phase(Float x) { return x - 2 * std::floor(x / 2); }

/// Zero-mean second integral of the square wave, of period 2: one parabola up, one down.
Float TwiceIntegratedWave(Float x) {
    Float m = Phase(x);
    return m < 1 ? m * (m - 1) / 2 : (m - 1) * (2 - m) / 2;
}

Float FilterRadius(Float dx, Float dy) { return Float(1.5) * std::max(std::abs(dx), std::abs(dy)); }

}  // namespace

Float FilteredSquareWave(Float x, Float radius) {
    if (std::floor(x - radius) == std::floor(x + radius)) return Phase(x) < 1 ? 1 : -1;
    // The tent is the second integral of three impulses (1, -2, 1) / radius^2, so filtering is a second difference.
    x = Phase(x);
    Float difference = TwiceIntegratedWave(x + radius) - 2 * TwiceIntegratedWave(x) + TwiceIntegratedWave(x - radius);
    return std::clamp(difference / Sqr(radius), Float(-1), Float(1));
}

Float CheckerPattern::SecondWeight(const TextureContext &ctx) const {
    if (const PointMapping *point = std::get_if<PointMapping>(&mapping_)) {
        TexCoord3 c = point->Map(ctx);
        Float parity = 1;
        for (int i = 0; i < 3; ++i) parity *= FilteredSquareWave(c.p[i], FilterRadius(c.dpdx[i], c.dpdy[i]));
        return (1 - parity) / 2;
    }
    TexCoord2 c = Map(std::get<TextureMapping2D>(mapping_), ctx);
    Float parity = FilteredSquareWave(c.st.x, FilterRadius(c.dsdx, c.dsdy)) *
                   FilteredSquareWave(c.st.y, FilterRadius(c.dtdx, c.dtdy));
    return (1 - parity) / 2;
}

}  // namespace pbrt
