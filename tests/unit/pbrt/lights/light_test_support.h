#pragma once
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

#include "pbrt/images/image.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/math/frame.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "support/given_params.h"
#include "support/statistics.h"

namespace pbrt::test {

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

/// A temporary image file that is removed with the object.
class TemporaryImage {
  public:
    TemporaryImage(const std::string &name, const Image &image)
        : path_((std::filesystem::temp_directory_path() / (std::to_string(::getpid()) + name)).string()) {
        WriteImage(path_, image);
    }
    ~TemporaryImage() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    const std::string &Path() const { return path_; }

  private:
    std::string path_;
};

inline Image RgbImage(Point2i n, const std::function<Rgb(int, int)> &color) {
    Image image(PixelFormat::Float, n, {"R", "G", "B"});
    for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x)
            for (int c = 0; c < 3; ++c) image.Set({x, y}, c, color(x, y)[c]);
    return image;
}

}  // namespace pbrt::test
