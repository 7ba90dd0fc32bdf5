#pragma once
#include <gtest/gtest.h>

#include "pbrt/lights/light_factory.h"
#include "pbrt/lights/light_image.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/shape_factory.h"
#include "pbrt/shapes/triangle_mesh.h"
#include "support/given_params.h"
#include "support/statistics.h"
#include "support/temporary_image.h"

namespace pbrt::test {

inline const SampledWavelengths kLambda = SampledWavelengths::SampleVisible(0.3f);

inline std::unique_ptr<Light> Make(const std::string &type, const ParamSet &params, const Transform &ctm,
                                   const Transform &renderFromWorld, DiagnosticSink &sink) {
    return Lights().Make(type, params, LightContext{ctm, renderFromWorld, ColorSpace::SRGB(), FileResolver(), sink});
}
inline std::unique_ptr<Light> Make(const std::string &type, const ParamSet &params, const Transform &ctm = {}) {
    DiagnosticSink sink;
    return Make(type, params, ctm, {}, sink);
}
inline AreaLightMaker MakeAreaMaker(const ParamSet &params, DiagnosticSink &sink, const std::string &type = "diffuse") {
    return AreaLights().Make(type, params,
                             LightContext{Transform(), Transform(), ColorSpace::SRGB(), FileResolver(), sink});
}
inline AreaLightMaker MakeAreaMaker(const ParamSet &params) {
    DiagnosticSink sink;
    return MakeAreaMaker(params, sink);
}

inline std::unique_ptr<Light> MakeAreaLight(const ParamSet &params, const Shape &shape,
                                            const FloatTexture *alpha = nullptr) {
    const Shape *const shapes[] = {&shape};
    return MakeAreaMaker(params)(shapes, alpha);
}
inline Params FileParams(const TemporaryImage &file) { return Params().String("filename", file.Path()); }
inline Params Cone(Float angle, Float edge) {
    return Params().Number("coneangle", angle).Number("conedeltaangle", edge);
}

inline Image GreyImage(int n, const std::function<Float(int, int)> &value) {
    Image image(PixelFormat::Float, {n, n}, {"Y"});
    ForEachPixel(image, [&](Point2i p) { image.Set(p, 0, value(p.x, p.y)); });
    return image;
}

/// An alpha that is 0 where u < `cut`.
class CutTexture final : public FloatTexture {
  public:
    CutTexture(Float cut, Float alpha) : cut_(cut), alpha_(alpha) {}
    Float Evaluate(const TextureContext &c) const override { return c.uv.x < cut_ ? Float(0) : alpha_; }
    std::optional<Float> Constant() const override { return cut_ > 0 ? std::optional<Float>() : alpha_; }

  private:
    Float cut_, alpha_;
};

inline std::unique_ptr<Shape> MakeShape(const std::string &type, const ParamSet &params, const Transform &ctm) {
    DiagnosticSink sink;
    const ShapeContext context{ctm, false, FileResolver(), sink, ParamReader(params)};
    return std::move(Shapes().Make(type, params, context).at(0));
}
/// One triangle, with texture coordinates.
inline std::unique_ptr<Shape> Triangle(const Transform &ctm = {}) {
    MeshData data;
    data.p = {{-1, -1, 0}, {1, -1, 0.2f}, {0.3f, 1, 0}};
    data.uv = {{0, 0}, {1, 0}, {0, 1}};
    data.indices = {0, 1, 2};
    return std::make_unique<TriangleMesh>(data, ctm, false);
}

inline SampledSpectrum Value(const LightPower &power) { return Float(power.factor) * power.spectrum; }

/// The luminous part: the integral of y-bar times the spectrum that `sample` returns for given wavelengths.
inline double Photometric(const std::function<SampledSpectrum(const SampledWavelengths &)> &sample, int n = 4000) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        auto lambda = SampledWavelengths::SampleUniform((Float(i) + Float(0.5)) / Float(n));
        sum += double(SafeDivide(sample(lambda) * CieY().Sample(lambda), lambda.Pdf()).Average());
    }
    return sum / n;
}
/// Power in lumens.
inline double Lumens(const Light &light, int n = 4000) {
    return Photometric([&](const SampledWavelengths &lambda) { return Value(light.Phi(lambda)); }, n);
}

inline LightSampleContext At(const Point3 &p, const Normal3 &n = Normal3(0)) {
    LightSampleContext c;
    c.p = p;
    c.n = c.ns = n;
    return c;
}

inline double Lux(const Light &light, const Point3 &p) {
    return Photometric([&](const SampledWavelengths &l) { return light.SampleLi(At(p), {}, l, false)->L; });
}
/// Luminance of an infinite light.
inline double Nits(const Light &light, const Vector3 &w = {0, 0, 1}, const Point3 &p = Point3(0)) {
    return Photometric([&](const SampledWavelengths &l) { return light.Le(p, w, l); });
}

/// Somewhere, turned, and stretched if i is a multiple of four.
inline Transform RandomPlace(Rng &rng, int i) {
    const Transform place =
        Transform::Translate({5 * rng.Uniform(), 0, 0}) * Transform::Rotate(360 * rng.Uniform(), {1, 2, 3});
    return i % 4 ? place : place * Transform::Scale({1, 0.3f + 2 * rng.Uniform(), 1});
}

/// Numbers of samples by cells of a rectangle, the last one of those without a direction, and what is expected.
struct RectangleCounts {
    std::vector<double> observed, expected;
    double mass = 0;  ///< integral of the density
};
/// Counts the directions that draw(u) returns through the rectangle from `low` to `high`, in the frame and seen from
/// its origin. So from every place equally many cells are tested. `pdf`: by solid angle. `fine`: points per side of a
/// cell, of the quadrature.
template <class Draw, class Pdf>
RectangleCounts CountThroughRectangle(const Frame &frame, const Vector3 &low, const Vector3 &high, int samples,
                                      Draw draw, Pdf pdf, int fine = 40) {
    constexpr int kCells = 12;
    const int side = kCells * fine;
    const Vector3 sides = high - low;
    RectangleCounts counts;
    counts.observed.resize(kCells * kCells + 1);
    counts.expected = counts.observed;
    Rng rng(3);
    for (int i = 0; i < samples; ++i) {
        if (const std::optional<Vector3> direction = draw(rng.Uniform2())) {
            const Vector3 w = frame.ToLocal(*direction), on = (w * (low.z / w.z) - low) / sides;
            const Point2i cell = PixelAt(Point2(on), Point2i(kCells));
            ++counts.observed[cell.y * kCells + cell.x];
        } else {
            ++counts.observed.back();
        }
    }
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Vector3 to = low + Vector3(PixelCenter(x, y, Point2i(side)), 0) * sides;
            const double solidAngle = double(sides.x * sides.y * low.z) / std::pow(double(Length(to)), 3);
            const double mass = double(pdf(frame.FromLocal(Normalize(to)))) * solidAngle / (side * side);
            counts.expected[y / fine * kCells + x / fine] += mass * samples;
            counts.mass += mass;
        }
    counts.expected.back() = std::max(samples * (1 - counts.mass), 0.0);
    return counts;
}

/// Expects that the importance is positive at p, if the light sends light there: without a normal and with one that is
/// not perpendicular to the light. Returns whether it sends light.
inline bool ExpectImportantIfLit(const Light &light, const LightBounds &bounds, const Point3 &p, Rng &rng) {
    const auto s = light.SampleLi(At(p), rng.Uniform2(), kLambda, false);
    if (!s) return false;
    const Normal3 n = SampleUniformSphere(rng.Uniform2());
    EXPECT_GT(bounds.Importance(p, Normal3(0)), 0);
    EXPECT_TRUE(AbsDot(n, s->wi) <= 1e-4f || bounds.Importance(p, n) > 0);
    return true;
}

}  // namespace pbrt::test
