#include "pbrt/textures/texture_mapping.h"

#include "pbrt/textures/noise.h"

namespace pbrt {
namespace {

/// Gradient of azimuth / 2 pi; 0 on the axis, where it is undefined.
Vector3 AzimuthGradient(const Point3 &p) {
    Float r2 = Sqr(p.x) + Sqr(p.y);
    if (!(r2 > 0)) return Vector3(0);
    return Vector3(-p.y, p.x, 0) * (Inv2Pi / r2);
}

/// Gradient of polar angle / pi; 0 on the axis.
Vector3 PolarGradient(const Point3 &p) {
    Float r2 = Sqr(p.x) + Sqr(p.y), r = std::sqrt(r2);
    if (!(r > 0)) return Vector3(0);
    return Vector3(p.x * p.z / r, p.y * p.z / r, -r) * (InvPi / (r2 + Sqr(p.z)));
}

Float Phase(Float x) { return x - 2 * std::floor(x / 2); }

/// Zero-mean second integral of the square wave, of period 2: one parabola up, one down.
Float TwiceIntegratedWave(Float x) {
    Float m = Phase(x);
    return m < 1 ? m * (m - 1) / 2 : (m - 1) * (2 - m) / 2;
}

Float FilterRadius(Float dx, Float dy) { return Float(1.5) * std::max(std::abs(dx), std::abs(dy)); }

constexpr Float kDotRadius = Float(0.35);

/// Noise on a plane halfway between lattice planes, where its amplitude is largest.
Float PlaneNoise(const Point2 &p) { return GradientNoise({p.x, p.y, Float(0.5)}); }

// Marble colours (sRGB, pbrt-v4's) over one period of the pattern, before brightening.
constexpr int kMarbleColors = 9;
constexpr Float kBrightening = Float(1.5);
const Rgb kMarble[kMarbleColors] = {{.58f, .58f, .6f}, {.58f, .58f, .6f}, {.58f, .58f, .6f},
                                    {.5f, .5f, .5f},   {.6f, .59f, .58f}, {.58f, .58f, .6f},
                                    {.58f, .58f, .6f}, {.2f, .2f, .33f},  {.58f, .58f, .6f}};

}  // namespace

TexCoord2 SphericalMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    Float distance = Length(c.p);
    Float theta = distance > 0 ? SafeACos(c.p.z / distance) : 0;
    Float phi = std::atan2(c.p.y, c.p.x);
    if (phi < 0) phi += 2 * Pi;
    // As in stock pbrt-v4, the derivatives are swapped: the azimuth's is returned for s, the polar angle's for t. It
    // affects only filter widths.
    Vector3 ds = AzimuthGradient(c.p), dt = PolarGradient(c.p);
    return {{theta * InvPi, phi * Inv2Pi}, Dot(ds, c.dpdx), Dot(ds, c.dpdy), Dot(dt, c.dpdx), Dot(dt, c.dpdy)};
}

TexCoord2 CylindricalMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    Vector3 ds = AzimuthGradient(c.p);
    return {{(Pi + std::atan2(c.p.y, c.p.x)) * Inv2Pi, c.p.z}, Dot(ds, c.dpdx), Dot(ds, c.dpdy), c.dpdx.z, c.dpdy.z};
}

TexCoord2 PlanarMapping::Map(const TextureContext &ctx) const {
    TexCoord3 c = point.Map(ctx);
    return {{du + Dot(c.p, vs), dv + Dot(c.p, vt)}, Dot(vs, c.dpdx), Dot(vs, c.dpdy), Dot(vt, c.dpdx), Dot(vt, c.dpdy)};
}

TextureMapping2D MappingParams::Make(const ParamSet &set, const Transform &renderFromTexture,
                                     DiagnosticSink &sink) const {
    if (mapping != "uv" && renderFromTexture.IsSingular())
        throw set.Error("", "mapping \"{}\" needs a transformation that can be inverted.", mapping);
    if (mapping == "spherical") return SphericalMapping{PointMapping(renderFromTexture)};
    if (mapping == "cylindrical") return CylindricalMapping{PointMapping(renderFromTexture)};
    if (mapping == "planar") return PlanarMapping{PointMapping(renderFromTexture), v1, v2, uv.du, uv.dv};
    if (mapping != "uv")
        set.Warn(sink, "mapping",
                 fmt::format("unknown mapping \"{}\", \"uv\" is used; {}.", mapping,
                             ListChoices(mapping, {"uv", "spherical", "cylindrical", "planar"})));
    return uv;
}

Float FilteredSquareWave(Float x, Float radius) {
    if (std::floor(x - radius) == std::floor(x + radius)) return Phase(x) < 1 ? 1 : -1;
    // The tent is the second integral of three impulses (1, -2, 1) / radius^2, so filtering is a second difference.
    x = Phase(x);
    Float difference = TwiceIntegratedWave(x + radius) - 2 * TwiceIntegratedWave(x) + TwiceIntegratedWave(x - radius);
    return std::clamp(difference / Sqr(radius), Float(-1), Float(1));
}

Float CheckerWeight(const TextureMapping2D &mapping, const TextureContext &ctx) {
    TexCoord2 c = Map(mapping, ctx);
    Float parity = FilteredSquareWave(c.st.x, FilterRadius(c.dsdx, c.dsdy)) *
                   FilteredSquareWave(c.st.y, FilterRadius(c.dtdx, c.dtdy));
    return (1 - parity) / 2;
}

Float CheckerWeight(const PointMapping &mapping, const TextureContext &ctx) {
    TexCoord3 c = mapping.Map(ctx);
    Float parity = 1;
    for (int i = 0; i < 3; ++i) parity *= FilteredSquareWave(c.p[i], FilterRadius(c.dpdx[i], c.dpdy[i]));
    return (1 - parity) / 2;
}

bool IsInDot(const Point2 &st) {
    const Point2 cell = glm::floor(st + Point2(Float(0.5)));
    if (!(PlaneNoise(cell + Point2(Float(0.5))) > 0)) return false;
    const Vector2 shift(PlaneNoise(cell + Point2(Float(1.5), Float(2.8))),
                        PlaneNoise(cell + Point2(Float(4.5), Float(9.8))));
    const Vector2 d = st - (cell + (Float(0.5) - kDotRadius) * shift);
    return Sqr(d.x) + Sqr(d.y) < Sqr(kDotRadius);
}

Float WindyNoise(const TexCoord3 &c) {
    constexpr Float kGustScale = Float(0.1);
    const Float gust = NoiseOctaves{Float(0.5), 3}.Signed(kGustScale * c.p, kGustScale * c.dpdx, kGustScale * c.dpdy);
    const Float wave = NoiseOctaves{Float(0.5), 6}.Signed(c.p, c.dpdx, c.dpdy);
    return std::abs(gust) * wave;
}

Rgb MarbleColor(Float t) {
    // Four successive colours are the control points of a cubic Bezier curve.
    constexpr int kRuns = kMarbleColors - 3;
    const Float x = t * kRuns;
    const int run = std::clamp(int(x), 0, kRuns - 1);
    const Float b = x - Float(run), a = 1 - b;
    const Rgb *c = kMarble + run;
    return kBrightening * (a * a * a * c[0] + 3 * a * a * b * c[1] + 3 * a * b * b * c[2] + b * b * b * c[3]);
}

}  // namespace pbrt
