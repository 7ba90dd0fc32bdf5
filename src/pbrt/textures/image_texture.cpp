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
    Footprint f = ImageFootprint(overlay_.mapping, ctx);
    Float v = overlay_.scale * overlay_.image->LookupFloat(f.st, f.dst0, f.dst1);
    return overlay_.invert ? std::max(Float(0), 1 - v) : v;
}

std::shared_ptr<const ImageFloatTexture> ImageFloatTexture::Scaled(Float factor) const {
    ImageOverlay overlay = overlay_;
    overlay.scale *= factor;
    return std::make_shared<ImageFloatTexture>(std::move(overlay));
}

SampledSpectrum ImageSpectrumTexture::Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const {
    Footprint f = ImageFootprint(overlay_.mapping, ctx);
    Rgb rgb = overlay_.scale * overlay_.image->LookupRgb(f.st, f.dst0, f.dst1);
    if (overlay_.invert) rgb = Rgb(1) - rgb;
    rgb = glm::max(rgb, Rgb(0));
    const ColorSpace &space = overlay_.image->Space();
    switch (use_) {
        case SpectrumUse::Albedo: return space.ToPolynomial(glm::min(rgb, Rgb(1))).Sample(lambda);
        case SpectrumUse::Unbounded: return RgbUnboundedSpectrum(space, rgb).Sample(lambda);
        case SpectrumUse::Illuminant: break;
    }
    return RgbIlluminantSpectrum(space, rgb).Sample(lambda);
}

std::shared_ptr<const ImageSpectrumTexture> ImageSpectrumTexture::Scaled(Float factor) const {
    ImageOverlay overlay = overlay_;
    overlay.scale *= factor;
    return std::make_shared<ImageSpectrumTexture>(std::move(overlay), use_);
}

}  // namespace pbrt
