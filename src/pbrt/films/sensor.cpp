#include "pbrt/films/sensor.h"

#include "pbrt/spectra/rgb_primaries.h"

namespace pbrt {
namespace {

/// Response of three sensitivities to a reflectance under an illuminant, over the second's to the bare illuminant.
Vector3 Project(const Spectrum &reflectance, const Spectrum &illuminant, const Spectrum &a, const Spectrum &b,
                const Spectrum &c) {
    glm::dvec3 sum(0);
    double white = 0;
    for (int nm = int(LambdaMin); nm <= int(LambdaMax); ++nm) {
        const auto lambda = Float(nm);
        const double light = double(illuminant(lambda)), reflected = light * double(reflectance(lambda));
        sum += reflected * glm::dvec3(double(a(lambda)), double(b(lambda)), double(c(lambda)));
        white += light * double(b(lambda));
    }
    return Vector3(sum / white);
}

/// Matrix from camera values of the colour checker's patches under `light` to their XYZ under the output white, so that
/// white in `light` becomes the output white. Y = 1 in `light` stays 1.
glm::mat3 CalibrateCamera(const Spectrum &r, const Spectrum &g, const Spectrum &b, const Spectrum &light,
                          const ColorSpace &outputSpace) {
    const Float brightness = InnerProduct(light, CieY()) / InnerProduct(light, g);
    std::vector<Vector3> camera, xyz;
    for (const SpectrumPtr &patch : ColorCheckerReflectances()) {
        camera.push_back(Project(*patch, light, r, g, b));
        xyz.push_back(Project(*patch, outputSpace.Illuminant(), CieX(), CieY(), CieZ()) * brightness);
    }
    return FitLinearMap(camera, xyz);
}

}  // namespace

glm::mat3 FitLinearMap(const std::vector<Vector3> &from, const std::vector<Vector3> &to) {
    glm::dmat3 ff(0), tf(0);
    for (size_t i = 0; i < from.size(); ++i) {
        ff += glm::outerProduct(glm::dvec3(from[i]), glm::dvec3(from[i]));
        tf += glm::outerProduct(glm::dvec3(to[i]), glm::dvec3(from[i]));
    }
    return glm::mat3(tf * glm::inverse(ff));
}

std::vector<std::string> SupportedSensors() {
    std::vector<std::string> names = CameraSensorNames();
    names.insert(names.begin(), "cie1931");
    return names;
}

PixelSensor PixelSensor::Make(const SensorParams &params, const ParamSet &set, const ColorSpace &outputSpace,
                              Float exposureTime) {
    const std::string &name = params.name;
    const Float imagingRatio = exposureTime * params.iso / 100;
    Float whiteBalance = params.whiteBalance;  // K; 0: the default
    // The daylight formula, made for 4000 K and more, has poles below 1000 K.
    if (whiteBalance > 0) set.Require<Float>("whitebalance", whiteBalance, {1000, 1e6f});
    if (name == "cie1931") {
        glm::mat3 balance(1);
        if (whiteBalance > 0)
            balance =
                WhiteBalanceMatrix(Chromaticity(SpectrumToXyz(DaylightSpectrum(whiteBalance))), outputSpace.White());
        return {CieX(), CieY(), CieZ(), balance, imagingRatio};
    }
    constexpr Float kCameraWhiteBalance = 6500;
    if (whiteBalance == 0) whiteBalance = kCameraWhiteBalance;
    const DenseSpectrum r(*NamedSpectrum(name + "_r")), g(*NamedSpectrum(name + "_g")), b(*NamedSpectrum(name + "_b"));
    return {r, g, b, CalibrateCamera(r, g, b, DaylightSpectrum(whiteBalance), outputSpace), imagingRatio};
}

}  // namespace pbrt
