#include "pbrt/textures/image_texture.h"

namespace pbrt {
namespace {

struct Footprint {
    Point2 st;
    Vector2 dst0, dst1;
};

/// Rows are stored from the top, so t is flipped. The footprint is not flipped, as in stock pbrt-v4.
Footprint ImageFootprint(const TextureMapping2D &mapping, const TextureContext &ctx) {
    TexCoord2 c = Map(mapping, ctx);
    return {{c.st.x, 1 - c.st.y}, {c.dsdx, c.dtdx}, {c.dsdy, c.dtdy}};
}

}  // namespace

Float ImageFloatTexture::Evaluate(const TextureContext &ctx) const {
    Footprint f = ImageFootprint(overlay.mapping, ctx);
    Float v = overlay.scale * overlay.image->LookupFloat(f.st, f.dst0, f.dst1);
    return overlay.invert ? std::max(Float(0), 1 - v) : v;
}

SampledSpectrum ImageSpectrumTexture::Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const {
    Footprint f = ImageFootprint(overlay.mapping, ctx);
    Rgb rgb = overlay.scale * overlay.image->LookupRgb(f.st, f.dst0, f.dst1);
    if (overlay.invert) rgb = Rgb(1) - rgb;
    rgb = glm::max(rgb, Rgb(0));
    const ColorSpace &space = overlay.image->Space();
    switch (use_) {
        case SpectrumUse::Albedo: return space.ToPolynomial(glm::min(rgb, Rgb(1))).Sample(lambda);
        case SpectrumUse::Unbounded: return RgbUnboundedSpectrum(space, rgb).Sample(lambda);
        case SpectrumUse::Illuminant: break;
    }
    return RgbIlluminantSpectrum(space, rgb).Sample(lambda);
}

}  // namespace pbrt
