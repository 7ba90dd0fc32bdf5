#pragma once
#include <functional>
#include <string>

#include "pbrt/lights/light_factory.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
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

inline SampledSpectrum Value(const LightPower &power) { return static_cast<Float>(power.factor) * power.spectrum; }

/// The luminous part: the integral of y-bar times the spectrum that `sample` returns for given wavelengths.
inline double Photometric(const std::function<SampledSpectrum(const SampledWavelengths &)> &sample, int n = 4000) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        auto lambda = SampledWavelengths::SampleUniform((static_cast<Float>(i) + Float(0.5)) / static_cast<Float>(n));
        sum += static_cast<double>(SafeDivide(sample(lambda) * CieY().Sample(lambda), lambda.Pdf()).Average());
    }
    return sum / n;
}

inline LightSampleContext At(const Point3 &p, const Normal3 &n = Normal3(0)) {
    LightSampleContext c;
    c.p = p;
    c.n = c.ns = n;
    return c;
}

}  // namespace pbrt::test
