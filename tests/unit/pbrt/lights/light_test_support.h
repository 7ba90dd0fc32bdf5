#pragma once
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "pbrt/lights/light_factory.h"
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
