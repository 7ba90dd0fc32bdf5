#include "pbrt/textures/noise_textures.h"

#include "pbrt/spectra/color_space.h"

namespace pbrt {

namespace {

constexpr Float kDotRadius = Float(0.35);

/// Noise on a plane halfway between lattice planes, where its amplitude is largest.
Float PlaneNoise(const Point2 &p) { return GradientNoise({p.x, p.y, Float(0.5)}); }

// Marble colours (sRGB, pbrt-v4's) over one period of the pattern, before brightening.
constexpr int kMarbleColors = 9;
constexpr Float kBrightening = Float(1.5);
const Rgb kMarble[kMarbleColors] = {{.58f, .58f, .6f}, {.58f, .58f, .6f}, {.58f, .58f, .6f},
                                    {.5f, .5f, .5f},   {.6f, .59f, .58f}, {.58f, .58f, .6f},
                                    {.58f, .58f, .6f}, {.2f, .2f, .33f},  {.58f, .58f, .6f}};

/// Colour at t in [0, 1]: four successive colours are the control points of a cubic Bezier curve.
Rgb MarbleColor(Float t) {
    constexpr int kRuns = kMarbleColors - 3;
    const Float x = t * kRuns;
    const int run = std::clamp(static_cast<int>(x), 0, kRuns - 1);
    const Float b = x - static_cast<Float>(run), a = 1 - b;
    const Rgb *c = kMarble + run;
    return kBrightening * (a * a * a * c[0] + 3 * a * a * b * c[1] + 3 * a * b * b * c[2] + b * b * b * c[3]);
}

}  // namespace

bool DotPattern::InDot(const TextureContext &ctx) const {
    const Point2 st = Map(mapping_, ctx).st;
    const Point2 cell = glm::floor(st + Point2(Float(0.5)));
    if (!(PlaneNoise(cell + Point2(Float(0.5))) > 0)) return false;
    const Vector2 shift(PlaneNoise(cell + Point2(Float(1.5), Float(2.8))),
                        PlaneNoise(cell + Point2(Float(4.5), Float(9.8))));
    const Vector2 d = st - (cell + (Float(0.5) - kDotRadius) * shift);
    return Sqr(d.x) + Sqr(d.y) < Sqr(kDotRadius);
}

Float WindyTexture::Evaluate(const TextureContext &ctx) const {
    const TexCoord3 c = mapping_.Map(ctx);
    constexpr Float kGustScale = Float(0.1);
    const Float gust = NoiseOctaves{Float(0.5), 3}.Signed(kGustScale * c.p, kGustScale * c.dpdx, kGustScale * c.dpdy);
    const Float wave = NoiseOctaves{Float(0.5), 6}.Signed(c.p, c.dpdx, c.dpdy);
    return std::abs(gust) * wave;
}

SampledSpectrum MarbleTexture::Evaluate(const TextureContext &ctx, const SampledWavelengths &lambda) const {
    const TexCoord3 c = mapping_.Map(ctx);
    const Float s = settings_.scale;
    const Point3 p = s * c.p;
    const Float phase = p.y + settings_.variation * settings_.octaves.Signed(p, s * c.dpdx, s * c.dpdy);
    return RgbAlbedoSpectrum(ColorSpace::SRGB(), MarbleColor((1 + std::sin(phase)) / 2)).Sample(lambda);
}

}  // namespace pbrt
